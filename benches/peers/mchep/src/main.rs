//! mchep's VEGAS and VEGAS+, with integrands in Rust.

#[allow(dead_code)] // the widths of peaks are for `mis`
#[path = "../../integrand.rs"]
mod integrand;

use integrand::Integrand;
use mchep::integrand::Integrand as Scalar;
use mchep::vegas::{Vegas, VegasResult};
use mchep::vegasplus::VegasPlus;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// mchep leaves the first iteration out of its result.
const ITERATIONS: usize = 10;
/// Of VEGAS, and of VEGAS+, which pays for them in every stratum; of 50 and 500, what did better.
const BINS: [usize; 2] = [500, 50];
/// As in mchep's documentation.
const DAMPING: f64 = 0.5;
const STRATIFICATION: f64 = 0.75;

/// Counts the evaluations, on the only thread.
struct Counted<'a>(&'a Integrand, AtomicU64);

impl Scalar for Counted<'_> {
    fn dim(&self) -> usize {
        self.0.d
    }

    fn eval(&self, x: &[f64]) -> f64 {
        self.1.store(self.1.load(Relaxed) + 1, Relaxed);
        self.0.eval(x)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, suite, seeds, evaluations] = arguments.as_slice() else {
        return Err("usage: peers-mchep SUITE SEEDS EVALUATIONS".into());
    };
    let (seeds, evaluations): (u64, usize) = (seeds.parse()?, evaluations.parse()?);
    let each = evaluations / ITERATIONS;
    println!("# mchep 0.2.0");
    for integrand in integrand::read(suite)? {
        let cube = vec![(0.0, 1.0); integrand.d];
        // As many strata as leave 16 samples to each; 4 suit d = 2 and 32 suit d = 8 better.
        let fits = |k: &usize| 16 * vec![*k; integrand.d].iter().product::<usize>() <= each;
        let strata = (1..=each).take_while(fits).last().unwrap_or(1);
        let vegas = |f: &Counted, seed| {
            let mut vegas = Vegas::new(ITERATIONS, each, BINS[0], DAMPING, &cube);
            vegas.set_seed(seed);
            vegas.integrate(f, None)
        };
        let plus = |f: &Counted, seed| {
            let mut vegas =
                VegasPlus::new(ITERATIONS, each, BINS[1], DAMPING, strata, STRATIFICATION, &cube);
            vegas.set_seed(seed);
            vegas.integrate(f, None)
        };
        measure("mchep VEGAS", &integrand, seeds, vegas);
        measure("mchep VEGAS+", &integrand, seeds, plus);
    }
    Ok(())
}

/// Times `integrate` for seed after seed.
fn measure(
    method: &str,
    integrand: &Integrand,
    seeds: u64,
    integrate: impl Fn(&Counted<'_>, u64) -> VegasResult,
) {
    for seed in 1..=seeds {
        let counted = Counted(integrand, AtomicU64::new(0));
        let start = Instant::now();
        let result = integrate(&counted, seed);
        let seconds = start.elapsed().as_secs_f64();
        let n = counted.1.load(Relaxed);
        integrand::print(&integrand.name, method, seed, (result.value, result.error), n, seconds);
    }
}
