//! What samples would leave if each were left out of the fit.

use nalgebra::DVector;

use crate::estimator::kept::{Kept, Origin, controlled};
use crate::estimator::regression::{Factored, Solution};

/// Contributions whose variance is that of the value, although coefficients are fitted to them.
///
/// The value is Σ ω_j y_j / N, with weights ω_j that depend on the regressors alone. Sample j leaves
/// r_j, but r_j / (1 - h_j) of a fit without it, where h_j is its leverage. So it enters the variance
/// as ω_j r_j / (1 - h_j). The mean over a technique stays what it is.
#[derive(Debug)]
pub(super) struct LeftOut {
    /// ω_j / (1 - h_j).
    factors: Vec<f64>,
    /// The value of each component.
    values: Vec<f64>,
    /// What is added to those of a technique; a row for each component.
    shifts: Vec<Vec<f64>>,
}

impl LeftOut {
    pub(super) fn new(
        kept: &Kept,
        factored: &Factored,
        solution: &Solution,
        techniques: usize,
    ) -> Self {
        let n = kept.len() as f64;
        // The mean of all regressors is known to be 0.
        let truth = factored.whitened(&[]);
        let factor = |z: &[f64]| {
            let row: DVector<f64> = factored.whitened(z);
            let influence = 1.0 + n * truth.dot(&row);
            let left = 1.0 - 1.0 / n - row.norm_squared();
            // A coefficient that is this sample's alone leaves nothing to divide.
            if left > 0.0 { influence / left } else { influence }
        };
        let mut counts = vec![0.0; techniques];
        kept.samples().for_each(|(of, _, _)| counts[of.technique] += 1.0);
        // The leverages account for the means of the techniques; a variance within one does it again.
        let within: Vec<f64> =
            counts.iter().map(|n: &f64| (1.0 - 1.0 / n).max(0.0).sqrt()).collect();
        let factors: Vec<f64> =
            kept.samples().map(|(of, z, _)| factor(z) * within[of.technique]).collect();
        let mut values = Vec::new();
        let mut shifts = Vec::new();
        for (c, beta) in solution.coefficients.iter().enumerate() {
            let left =
                || kept.samples().map(|(of, z, y)| (of.technique, controlled(y[c], z, beta)));
            let value = left().map(|(_, y)| y / n).sum::<f64>();
            let mut shift = vec![0.0; techniques];
            for ((technique, y), factor) in left().zip(&factors) {
                shift[technique] += (y - value) * (1.0 - factor) / counts[technique];
            }
            values.push(value);
            shifts.push(shift);
        }
        Self { factors, values, shifts }
    }

    /// That of sample j, of component `c`, for what it leaves.
    pub(super) fn contribution(&self, j: usize, of: &Origin, c: usize, left: f64) -> f64 {
        let (value, shift) = (self.values[c], self.shifts[c][of.technique]);
        value + (left - value) * self.factors[j] + shift
    }
}

#[cfg(test)]
mod tests {
    use super::LeftOut;
    use crate::estimator::kept::{Kept, controlled};
    use crate::estimator::regression::Regression;
    use crate::estimator::{Buffers, Draw, MultiSample, Sums};
    use crate::part::Part;
    use crate::points::Random;
    use crate::technique::{Linear, Uniform};

    /// Samples of e^x from 1 and 2x.
    fn kept(n: u64) -> Kept {
        let (flat, ramp) = (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap());
        let mis = MultiSample::new(&[(&flat, n), (&ramp, n)]).unwrap();
        let (mut kept, mut part) = (Kept::new(1, 1), Part::empty(2, 1, 1));
        let sums = Sums { part: &mut part, evidence: None };
        let mut z = [0.0; 2];
        mis.draw(&|x: &f64| x.exp(), &Random::new(1), 0..2 * n, &mut Buffers::new(), sums, |s| {
            s.differences(0, &mut z);
            kept.push(s, |row| row.push(z[1]));
        })
        .unwrap();
        kept
    }

    fn fitted(kept: &Kept, without: usize) -> Regression {
        let mut fit = Regression::new(1, 1);
        let rows = kept.samples().enumerate().filter(|(j, _)| *j != without);
        rows.for_each(|(_, (_, z, y))| fit.push(1.0, z.iter().copied(), y.iter().copied()));
        fit
    }

    /// What is left of the mean and the coefficients when one sample is removed.
    fn value(kept: &Kept, without: usize) -> (f64, f64) {
        let beta = fitted(kept, without).solve().unwrap().coefficients.remove(0);
        let rows = kept.samples().enumerate().filter(|(j, _)| *j != without);
        let left: Vec<f64> = rows.map(|(_, (_, z, y))| controlled(y[0], z, &beta)).collect();
        (left.iter().sum::<f64>() / left.len() as f64, beta[0])
    }

    /// The value moves by ω r / (1 - h) / N when a sample is removed: this is the jackknife.
    #[test]
    fn contributions_are_what_the_value_loses_with_a_sample() {
        let n = 6;
        let kept = kept(n);
        let factored = fitted(&kept, usize::MAX).factored();
        let solution = factored.solution().unwrap();
        let left_out = LeftOut::new(&kept, &factored, &solution, 2);
        let (all, _) = value(&kept, usize::MAX);
        let within = (1.0 - 1.0 / n as f64).sqrt();
        for (j, (of, z, y)) in kept.samples().enumerate() {
            let left = controlled(y[0], z, &solution.coefficients[0]);
            let found =
                left_out.contribution(j, of, 0, left) - left_out.shifts[0][of.technique] - all;
            let lost = all - value(&kept, j).0;
            let expected = within * 2.0 * n as f64 * lost;
            assert!((found - expected).abs() < 1e-12, "{j}: {found} {expected}");
        }
    }

    #[test]
    fn means_of_techniques_stay() {
        let kept = kept(50);
        let factored = fitted(&kept, usize::MAX).factored();
        let solution = factored.solution().unwrap();
        let left_out = LeftOut::new(&kept, &factored, &solution, 2);
        for technique in 0..2 {
            let (mut before, mut after) = (0.0, 0.0);
            for (j, (of, z, y)) in kept.samples().enumerate() {
                if of.technique == technique {
                    let left = controlled(y[0], z, &solution.coefficients[0]);
                    before += left / 50.0;
                    after += left_out.contribution(j, of, 0, left) / 50.0;
                }
            }
            assert!((before / after - 1.0).abs() < 1e-14, "{technique}: {before} {after}");
        }
    }
}
