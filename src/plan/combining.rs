//! What combining samples costs, for each kind of method.

use std::fmt::Debug;
use std::marker::PhantomData;
use std::mem::discriminant;
use std::time::Instant;

use super::cost::{Nothing, TimedTechnique};
use super::method::{Method, Planned};
use crate::estimator::{Buffers, Draw, OnFault, Sums};
use crate::integrand::Value;
use crate::part::Part;
use crate::points::Random;
use crate::run::RunFault;
use crate::technique::Technique;

/// That of the kind of `method`.
pub(super) fn cost_of(combining: &[(Method, f64)], method: &Method) -> Option<f64> {
    let kind = discriminant(method);
    combining.iter().find(|(known, _)| discriminant(known) == kind).map(|(_, cost)| *cost)
}

/// What combining costs, for each kind of method: the time of drawing samples of an integrand that takes
/// none, less that of the techniques.
pub(super) fn combining<P: Debug, V: Value>(
    techniques: &[&dyn Technique<Point = P>],
) -> Result<Vec<(Method, f64)>, RunFault> {
    let k = techniques.len();
    let equal = vec![1.0 / k as f64; k];
    let controls = crate::Controls::new(0, (0..V::COMPONENTS).map(|_| equal.clone()))?;
    let methods = [
        Method::Balance,
        Method::Single(0),
        Method::Constant(equal.clone()),
        Method::Power(2.0),
        Method::Cutoff(0.1),
        Method::Maximum,
        Method::OneSample,
        Method::VarianceAware(vec![1.0; k]),
        Method::Optimal(controls),
    ];
    let each = (4096 / k as u64).clamp(32, 512);
    let mut all = Vec::with_capacity(methods.len());
    for method in methods {
        let mut least = f64::INFINITY;
        let mut buffers = Buffers::new();
        for repetition in 0..4 {
            let timed: Vec<_> =
                techniques.iter().map(|inner| TimedTechnique::new(*inner)).collect();
            let list: Vec<&dyn Technique<Point = P>> = timed.iter().map(|t| t as _).collect();
            let mut counts = vec![each; k];
            if let Method::Single(_) = method {
                counts[1..].fill(0);
            }
            let samples: u64 = counts.iter().sum();
            let on_fault = OnFault::count_as_zero(1.0)?;
            let estimator = Planned::new(&method, &list, &counts, on_fault)?;
            let mut part = Part::empty(k, 1, V::COMPONENTS);
            let sums = Sums { part: &mut part, evidence: None };
            let nothing = Nothing::<V>(PhantomData);
            let points = Random::new(repetition);
            let start = Instant::now();
            estimator.draw(&nothing, &points, 0..samples, &mut buffers, sums, |_| ())?;
            let elapsed = start.elapsed().as_secs_f64();
            let own: f64 = timed.iter().map(|t| t.sampling.total() + t.pdf.total()).sum();
            least = least.min((elapsed - own).max(0.0) / samples as f64);
        }
        all.push((method, least.max(1e-12)));
    }
    Ok(all)
}
