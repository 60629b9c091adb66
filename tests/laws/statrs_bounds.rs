//! The bound that `Statrs` states, for every continuous distribution of the library.

use mis::technique::{InverseCdf, Statrs};
use statrs::distribution as d;

const LARGEST: f64 = 1.0 - f64::EPSILON / 2.0;

fn zoo() -> Vec<(&'static str, Box<dyn InverseCdf>)> {
    macro_rules! zoo {
        ($($name:literal $e:expr),* $(,)?) => {
            vec![$(($name, Box::new(Statrs::new($e.unwrap()).unwrap()) as Box<dyn InverseCdf>)),*]
        };
    }
    zoo![
        "Normal" d::Normal::new(1.0, 2.0),
        "LogNormal" d::LogNormal::new(0.5, 1.5),
        "Gamma" d::Gamma::new(2.5, 3.0),
        "Gamma(0.3)" d::Gamma::new(0.3, 1.0),
        "Gamma(200)" d::Gamma::new(200.0, 0.01),
        "Erlang" d::Erlang::new(4, 2.0),
        "Exp" d::Exp::new(0.5),
        "ChiSquared" d::ChiSquared::new(3.0),
        "Chi" d::Chi::new(4),
        "Beta" d::Beta::new(2.0, 5.0),
        "Beta(0.5, 0.5)" d::Beta::new(0.5, 0.5),
        "StudentsT" d::StudentsT::new(0.5, 2.0, 3.0),
        "FisherSnedecor" d::FisherSnedecor::new(5.0, 7.0),
        "Weibull" d::Weibull::new(1.5, 2.0),
        "Gumbel" d::Gumbel::new(1.0, 2.0),
        "Laplace" d::Laplace::new(-1.0, 3.0),
        "Triangular" d::Triangular::new(0.0, 2.0, 0.5),
        "Triangular at a" d::Triangular::new(0.0, 1.0, 0.0),
        "Triangular at b" d::Triangular::new(0.0, 1.0, 1.0),
        "Pareto" d::Pareto::new(2.0, 1.5),
        "InverseGamma" d::InverseGamma::new(2.0, 3.0),
        "Levy" d::Levy::new(0.0, 1.0),
        "Cauchy" d::Cauchy::new(0.0, 2.0),
        "Uniform" d::Uniform::new(-1.0, 3.0),
    ]
}

/// How far `tail(x)` is from `target`, beyond what the spacing of the floats at x explains.
fn miss(p: &dyn InverseCdf, tail: f64, target: f64, x: f64) -> f64 {
    let (a, b) = p.support();
    if x.next_down() <= a || x.next_up() >= b {
        return 0.0;
    }
    let grain = p.pdf(&x) * (x.abs().next_up() - x.abs());
    ((tail - target).abs() - grain).max(0.0)
}

#[test]
fn the_inverse_meets_its_bound() {
    for (name, p) in zoo() {
        let grid = (1..1000).map(|k| f64::from(k) / 1000.0);
        for u in grid.chain([1e-300, 1e-100, 1e-20, 1e-10, 1.0 - 1e-10, LARGEST]) {
            let x = p.inverse_cdf(u);
            let off = miss(&p, p.cdf(x), u, x);
            assert!(off <= 2e-13, "{name}: u = {u:e}, x = {x:e}: off by {off:e}");
            let x = p.inverse_survival(u);
            let off = miss(&p, p.survival(x), u, x);
            assert!(off <= 2e-13, "{name}: v = {u:e}, x = {x:e}: off by {off:e}");
        }
    }
}

#[test]
fn tails_are_as_precise_as_the_library() {
    const LOWER: &[&str] =
        &["Exp", "Beta(0.5, 0.5)", "Triangular at a", "Triangular at b", "Pareto", "Cauchy"];
    const UPPER: &[&str] =
        &["Beta(0.5, 0.5)", "FisherSnedecor", "Triangular at a", "Triangular at b", "Cauchy"];
    for (name, p) in zoo() {
        for e in [3.0, 5.0, 8.3, 12.0, 16.0, 25.0, 40.0, 80.0, 150.0, 230.5, 300.0] {
            let v = 10_f64.powf(-e);
            if !LOWER.contains(&name) {
                let x = p.inverse_cdf(v);
                let off = miss(&p, p.cdf(x), v, x) / v;
                assert!(off <= 1e-12, "{name}: u = {v:e}, x = {x:e}: off by {off:e} u");
            }
            if !UPPER.contains(&name) {
                let x = p.inverse_survival(v);
                let off = miss(&p, p.survival(x), v, x) / v;
                assert!(off <= 1e-12, "{name}: v = {v:e}, x = {x:e}: off by {off:e} v");
            }
        }
    }
}

#[test]
fn every_sample_is_inside_and_has_a_density() {
    for (name, p) in zoo() {
        let (a, b) = p.support();
        for u in [0.0, 5e-324, 1e-300, 2.0_f64.powi(-54), 0.1, 0.5, 0.9, LARGEST, 1.0] {
            let x = p.sample(&[u]);
            assert!(a < x && x < b && x.is_finite(), "{name}: u = {u:e}: x = {x:e}");
            assert!(p.pdf(&x) > 0.0 && p.pdf(&x).is_finite(), "{name}: u = {u:e}: x = {x:e}");
            assert!((p.ln_pdf(&x) - p.pdf(&x).ln()).abs() < 1e-13, "{name}");
        }
        for u in [-1.0, 2.0, f64::NAN] {
            assert!(p.inverse_cdf(u).is_nan() && p.inverse_survival(u).is_nan());
        }
        assert!(p.sample(&[]).is_nan() && p.cdf(f64::NAN).is_nan() && p.pdf(&f64::NAN) == 0.0);
    }
}
