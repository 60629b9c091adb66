//! `mis` on the suite: the uniform technique everywhere, one technique for each peak or factor
//! where the integrand has such; random and quasi-random points.

mod batch;
#[path = "../../integrand.rs"]
mod integrand;
mod techniques;

use batch::Batched;
use integrand::{Integrand, Shape};
use mis::points::Sobol;
use mis::technique::{Normal, Product, TruncatedNormal, UniformBox};
use mis::weighting::Power;
use mis::{Estimate, Estimator, MultiSample, Technique};
use std::error::Error;
use std::fmt::Debug;
use std::time::Instant;
use techniques::{Cosine, Disk, Sine};

type Failure = Box<dyn Error>;

/// Where ξ come from.
#[derive(Clone, Copy)]
enum Points {
    Random,
    /// In so many replicates.
    Sobol(usize),
}

/// Points, and whether techniques are combined by the power heuristic with exponent 2 instead of
/// the balance heuristic. 8 replicates are scipy's default, 16 that of `mis`.
const METHODS: [(Points, bool); 4] = [
    (Points::Random, false),
    (Points::Sobol(8), false),
    (Points::Sobol(16), false),
    (Points::Sobol(8), true),
];

impl Points {
    fn name(self) -> String {
        match self {
            Self::Random => "random".to_string(),
            Self::Sobol(replicates) => format!("Sobol' {replicates}"),
        }
    }

    /// How many of `evaluations` to use: a power of two where the points want that.
    fn samples(self, evaluations: u64) -> u64 {
        match self {
            Self::Random => evaluations,
            Self::Sobol(_) => 1 << evaluations.max(1).ilog2(),
        }
    }

    fn estimate<P: Debug>(
        self,
        seed: u64,
        mis: &impl Estimator<P>,
        f: &impl mis::Integrand<P, Value = f64>,
    ) -> Result<Estimate, Failure> {
        Ok(match self {
            Self::Random => mis.estimate(f, seed)?,
            Self::Sobol(replicates) => {
                mis.estimate_from(f, &Sobol::new(seed).with_replicates(replicates)?)?
            }
        })
    }
}

/// The seeds and evaluations of every measurement.
struct Plan {
    seeds: u64,
    evaluations: u64,
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, suite, seeds, evaluations] = arguments.as_slice() else {
        return Err("usage: peers-mis SUITE SEEDS EVALUATIONS".into());
    };
    let plan = Plan { seeds: seeds.parse()?, evaluations: evaluations.parse()? };
    for integrand in &integrand::read(suite)? {
        match integrand.d {
            1 => plan.dimension::<1>(integrand)?,
            2 => plan.dimension::<2>(integrand)?,
            4 => plan.dimension::<4>(integrand)?,
            5 => plan.dimension::<5>(integrand)?,
            8 => plan.dimension::<8>(integrand)?,
            d => return Err(format!("no integrand of dimension {d} expected").into()),
        }
    }
    Ok(())
}

impl Plan {
    /// Every method for an integrand in D dimensions.
    fn dimension<const D: usize>(&self, integrand: &Integrand) -> Result<(), Failure> {
        self.measure(integrand, "uniform", || {
            Ok(vec![Box::new(UniformBox::uniform([0.0; D], [1.0; D])?)])
        })?;
        match &integrand.shape {
            &Shape::SinCos { b } => {
                self.measure(integrand, "own", || Ok(vec![Box::new(Cosine(b)), Box::new(Sine(b))]))
            }
            Shape::Peaks(peaks) => self.measure(integrand, "own", || {
                let mut techniques: Techniques<[f64; D]> = Vec::new();
                for peak in peaks {
                    let side = TruncatedNormal::new(peak.centre, 1.25 * peak.sd, 0.0, 1.0)?;
                    techniques.push(Box::new(Product::new([side; D])?));
                }
                Ok(techniques)
            }),
            Shape::LobeAndDisk(g) => self.measure(integrand, "own", || {
                let [x, y] = g.centre;
                let lobe = Product::new([Normal::new(x, g.sd)?, Normal::new(y, g.sd)?])?;
                let disk = Disk { centre: g.disk, radius: g.radius };
                Ok(vec![Box::new(lobe), Box::new(disk)])
            }),
            _ => Ok(()),
        }
    }

    /// Times the estimate with the techniques that `set_up` makes, for all kinds of points and all
    /// seeds.
    fn measure<P: Debug>(
        &self,
        integrand: &Integrand,
        techniques: &str,
        set_up: impl Fn() -> Result<Techniques<P>, Failure>,
    ) -> Result<(), Failure>
    where
        for<'a> Batched<'a>: mis::Integrand<P, Value = f64>,
    {
        let f = Batched(integrand);
        for (points, squared) in METHODS {
            if squared && techniques == "uniform" {
                continue; // all weights are 1
            }
            let power = if squared { " power" } else { "" };
            let method = format!("mis {techniques} {}{power}", points.name());
            for seed in 1..=self.seeds {
                let start = Instant::now();
                let techniques = set_up()?;
                let each = points.samples(self.evaluations) / techniques.len() as u64;
                let list: Vec<(&dyn Technique<Point = P>, u64)> =
                    techniques.iter().map(|technique| (technique.as_ref(), each)).collect();
                let mis = MultiSample::new(&list)?;
                let estimate = if squared {
                    points.estimate(seed, &mis.weighting(Power::squared())?, &f)?
                } else {
                    points.estimate(seed, &mis, &f)?
                };
                let seconds = start.elapsed().as_secs_f64();
                let error = estimate.standard_error().unwrap_or(f64::INFINITY);
                let result = (estimate.value(), error);
                integrand::print(
                    &integrand.name,
                    &method,
                    seed,
                    result,
                    estimate.samples(),
                    seconds,
                );
            }
        }
        Ok(())
    }
}

type Techniques<P> = Vec<Box<dyn Technique<Point = P>>>;
