//! Shares of the samples, against optima by quadrature.

use mis::Technique;
use mis::plan::{Costs, Method, Pilot, Planner};
use mis::technique::{Linear, TruncatedNormal, Uniform};
use mis::weighting::{Balance, Cutoff, Maximum, Power, Weighting, weights};

use crate::problems::{Techniques, one};
use crate::suite::{DOMAIN_D, f_a, f_d, family_a, family_d};
use std::f64::consts::FRAC_PI_2;

/// Family A, D or E, on nodes of a rule: the width of a node, f, and the densities.
struct Family {
    name: char,
    techniques: Techniques<f64>,
    nodes: Vec<(f64, f64, Vec<f64>)>,
    f: fn(&f64) -> f64,
}

fn families() -> [Family; 3] {
    let family = |name, techniques: Techniques<f64>, [a, b]: [f64; 2], f: fn(&f64) -> f64| {
        let nodes = crate::quadrature::gauss(150)
            .into_iter()
            .map(|(u, w)| {
                let x = a + (b - a) * u;
                ((b - a) * w, f(&x), techniques.iter().map(|t| t.pdf(&x)).collect())
            })
            .collect();
        Family { name, techniques, nodes, f }
    };
    [
        family('A', family_a(), [0.01, FRAC_PI_2], |x| f_a(*x)),
        family('D', family_d(), DOMAIN_D, |x| f_d(*x, 1.0)),
        family('E', family_d(), DOMAIN_D, |x| f_d(*x, 30.0)),
    ]
}

impl Family {
    fn pilot(&self, costs: Costs, seed: u64) -> Pilot {
        Planner::new().costs(costs).pilot(&self.f, &self.techniques, seed).unwrap()
    }

    /// N times the variance with these shares.
    fn variance(&self, method: &Method, shares: &[f64]) -> f64 {
        let weighting: Box<dyn Weighting> = match method {
            Method::Power(beta) => Box::new(Power::new(*beta).unwrap()),
            Method::Cutoff(a) => Box::new(Cutoff::new(*a).unwrap()),
            Method::Maximum => Box::new(Maximum),
            _ => Box::new(Balance),
        };
        let k = shares.len();
        let (mut squares, mut means) = (0.0, vec![0.0; k]);
        for (width, f, p) in &self.nodes {
            let q: Vec<f64> = p.iter().zip(shares).map(|(p, alpha)| p * alpha).collect();
            let w = weights(&weighting, &q).unwrap();
            for i in 0..k {
                squares += width * (w[i] * f).powi(2) / q[i];
                means[i] += width * w[i] * f;
            }
        }
        let mu: f64 = means.iter().sum();
        match method {
            Method::OneSample => squares - mu * mu,
            _ => squares - means.iter().zip(shares).map(|(m, alpha)| m * m / alpha).sum::<f64>(),
        }
    }

    /// The least variance times cost over a grid of shares.
    fn least(&self, method: &Method, floor: f64, cost: impl Fn(&[f64]) -> f64) -> f64 {
        let (k, steps) = (self.techniques.len(), if self.techniques.len() == 2 { 100 } else { 40 });
        let least = floor / k as f64;
        let mut best = f64::INFINITY;
        for i in 0..=steps {
            for j in 0..=steps - i {
                if k == 2 && i + j != steps {
                    continue;
                }
                let grid = [i, j, steps - i - j].map(|n| f64::from(n) / f64::from(steps));
                let shares: Vec<f64> =
                    grid[..k].iter().map(|g| least + (1.0 - floor) * g).collect();
                best = best.min(self.variance(method, &shares) * cost(&shares));
            }
        }
        best
    }
}

/// Sampling costs these; nothing else costs anything to speak of.
fn costs(sampling: &[f64]) -> Costs {
    Costs::declared(sampling, vec![1e-9; sampling.len()], 1e-9, 1e-9).unwrap()
}

#[track_caller]
fn well_formed(allocation: &mis::plan::Allocation, floor: f64) {
    let k = allocation.shares.len() as f64;
    assert!((allocation.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    for share in &allocation.shares {
        assert!(*share >= floor / k * (1.0 - 1e-12), "{allocation:?}");
    }
    assert!(allocation.objective.windows(2).all(|two| two[1] <= two[0]), "{allocation:?}");
}

#[test]
fn optima_of_three_families() {
    reach_optima(0..1);
}

#[test]
#[ignore = "seconds in release"]
fn optima_of_three_families_from_many_pilots() {
    reach_optima(0..20);
}

fn reach_optima(seeds: std::ops::Range<u64>) {
    let optima: [&[f64]; 3] =
        [&[0.2756, 0.7244], &[0.3116, 0.5664, 0.1220], &[0.9314, 0.0564, 0.0122]];
    for (family, optimum) in families().iter().zip(optima) {
        let k = optimum.len();
        for seed in seeds.clone() {
            let pilot = family.pilot(costs(&vec![1.0; k]), seed);
            for method in [Method::OneSample, Method::Balance] {
                let found = pilot.allocate(&method).unwrap();
                well_formed(&found, 0.01);
                let (name, rounds) = (family.name, found.objective.len() - 1);
                println!("{name} {method} {seed}: {rounds} rounds, {:?}", found.shares);
                assert!(rounds <= 10, "{name} {method}: {:?}", found.objective);
                let v = family.variance(&method, &found.shares);
                if family.name == 'A' {
                    let least = if method == Method::OneSample {
                        0.091_006_20
                    } else {
                        family.least(&method, 0.01, |_| 1.0)
                    };
                    assert!(v <= 1.05 * least, "{v} {least} {found:?}");
                    assert!(v >= least * (1.0 - 1e-3), "{v} {least}");
                } else {
                    let equal = family.variance(&method, &vec![1.0 / k as f64; k]);
                    assert!(v <= 1e-6 * equal, "{name} {method}: {v} {equal} {found:?}");
                    for (share, best) in found.shares.iter().zip(optimum) {
                        assert!((share - best).abs() < 2e-4, "{found:?} {optimum:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn unequal_costs_beat_equal_samples() {
    let [family, ..] = families();
    beat_equal_samples(&[family], &[100.0], &[Method::Balance, Method::OneSample]);
}

#[test]
#[ignore = "seconds in release"]
fn unequal_costs_beat_equal_samples_for_every_method() {
    let methods = [
        Method::Balance,
        Method::OneSample,
        Method::Power(2.0),
        Method::Cutoff(0.1),
        Method::Maximum,
    ];
    beat_equal_samples(&families(), &[1.0, 3.0, 10.0, 30.0, 100.0], &methods);
}

fn beat_equal_samples(families: &[Family], ratios: &[f64], methods: &[Method]) {
    for family in families {
        let k = family.techniques.len();
        for ratio in ratios {
            for expensive in 0..k {
                let mut sampling = vec![1.0; k];
                sampling[expensive] = *ratio;
                let pilot = family.pilot(costs(&sampling), 1);
                let cost =
                    |shares: &[f64]| shares.iter().zip(&sampling).map(|(a, c)| a * c).sum::<f64>();
                for method in methods {
                    let found = pilot.allocate(method).unwrap();
                    well_formed(&found, 0.01);
                    let equal = vec![1.0 / k as f64; k];
                    let at_equal = family.variance(method, &equal) * cost(&equal);
                    let at_found = family.variance(method, &found.shares) * cost(&found.shares);
                    let what = format!("{} {method} {sampling:?} {found:?}", family.name);
                    println!("{what}: {:.4}", at_found / at_equal);
                    assert!(at_found <= 1.02 * at_equal, "{what}");
                    if matches!(method, Method::Balance | Method::OneSample) && k == 2 {
                        let least = family.least(method, 0.01, cost);
                        assert!(at_found <= 1.05 * least, "{what}: {at_found} {least}");
                    }
                }
            }
        }
    }
}

#[test]
fn constant_weights_get_neymans_shares() {
    let [family, ..] = families();
    let (weights, c) = ([0.3, 0.7], [1.0, 9.0]);
    let pilot = family.pilot(costs(&c), 3);
    let found = pilot.allocate(&Method::Constant(weights.to_vec())).unwrap();
    well_formed(&found, 0.01);
    let sd = |i: usize| {
        let mut alone = [0.0; 2];
        alone[i] = 1.0;
        pilot.predict(&Method::Single(i), &alone).unwrap().variance[0].sqrt()
    };
    let parts = [0, 1].map(|i| weights[i] * sd(i) / c[i].sqrt());
    for (share, part) in found.shares.iter().zip(parts) {
        assert!((share - part / (parts[0] + parts[1])).abs() < 1e-4, "{found:?} {parts:?}");
    }
}

#[test]
fn nothing_to_go_by_keeps_equal_shares() {
    let techniques: Techniques<f64> =
        vec![one(Uniform::unit()), one(Linear::new(0.0, 1.0, 0.0, 2.0).unwrap())];
    let pilot =
        Planner::new().costs(costs(&[1.0, 5.0])).pilot(&|_: &f64| 0.0, &techniques, 1).unwrap();
    for method in
        [Method::Balance, Method::OneSample, Method::Maximum, Method::Constant(vec![0.5; 2])]
    {
        let found = pilot.allocate(&method).unwrap();
        assert!(found.shares.iter().all(|share| (share - 0.5).abs() < 1e-12), "{found:?}");
    }
    let plan = pilot.plan().unwrap();
    assert_eq!(plan.method, Method::Balance);
    assert_eq!(plan.counts[0], plan.counts[1]);
}

#[test]
fn one_technique_and_many() {
    let single: Techniques<f64> = vec![one(Uniform::unit())];
    let pilot = Planner::new().costs(costs(&[1.0])).pilot(&|x: &f64| *x, &single, 1).unwrap();
    assert_eq!(pilot.allocate(&Method::Balance).unwrap().shares, [1.0]);
    assert_eq!(pilot.plan().unwrap().method, Method::Single(0));

    let k = 64;
    let normal =
        |i: usize| one(TruncatedNormal::new((i as f64 + 0.5) / 64.0, 0.05, 0.0, 1.0).unwrap());
    let many: Techniques<f64> = (0..k).map(normal).collect();
    let pilot = Planner::new().samples(64).unwrap().costs(costs(&[1.0; 64]));
    let pilot = pilot.pilot(&|x: &f64| (-8.0 * x).exp(), &many, 1).unwrap();
    for method in [Method::Balance, Method::OneSample] {
        let found = pilot.allocate(&method).unwrap();
        well_formed(&found, 0.01);
        assert!(found.shares[0] > 10.0 * found.shares[63], "{found:?}");
        assert!(found.objective.len() > 1);
    }
}

/// f has 1 % of its integral where only the second technique reaches, which looks like the first one
/// otherwise.
#[test]
fn a_technique_that_is_alone_somewhere_keeps_samples() {
    let techniques: Techniques<f64> =
        vec![one(Uniform::unit()), one(Uniform::new(0.99, 2.0).unwrap())];
    let f = |x: &f64| if *x < 1.01 { 1.0 } else { 0.0 };
    for floor in [1e-9, 0.01, 0.2] {
        let planner = Planner::new().costs(costs(&[1.0, 100.0])).floor(floor).unwrap();
        let pilot = planner.pilot(&f, &techniques, 1).unwrap();
        let found = pilot.allocate(&Method::Balance).unwrap();
        well_formed(&found, floor);
        assert!(found.shares[1] > 0.005, "{found:?}");
        if floor < 1e-3 {
            continue;
        }
        let plan = pilot.plan().unwrap();
        let estimator = plan.estimator(&techniques).unwrap();
        let target = mis::Target::new().samples(1 << 14).unwrap();
        let report = mis::Run::new(target).execute(&estimator, &f, 5).unwrap();
        let error = report.standard_error().unwrap();
        assert!((report.value() - 1.01).abs() < 5.0 * error && error < 0.02, "{report}");
    }
}

#[test]
fn costs_are_checked() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Costs::declared([1.0, bad], [1.0, 1.0], 1.0, 1.0).is_err());
        assert!(Costs::declared([1.0, 1.0], [bad, 1.0], 1.0, 1.0).is_err());
        assert!(Costs::declared([1.0, 1.0], [1.0, 1.0], bad, 1.0).is_err());
        let message = Costs::declared([1.0], [1.0], 1.0, bad).unwrap_err().to_string();
        assert!(message.contains("combining") && message.contains(&bad.to_string()), "{message}");
    }
    assert!(Costs::declared([1.0], [1.0, 1.0], 1.0, 1.0).is_err());
    // As many as techniques.
    let single: [&dyn Technique<Point = f64>; 1] = [&Uniform::unit()];
    let planner = Planner::new().costs(costs(&[1.0, 1.0]));
    let error = planner.pilot(&|x: &f64| *x, &single, 1).unwrap_err().to_string();
    assert!(error.contains("sampling"), "{error}");
    for floor in [0.0, -1.0, 1.5, f64::NAN] {
        assert!(Planner::new().floor(floor).is_err());
    }
    for samples in [0, 15, (1 << 20) + 1] {
        assert!(Planner::new().samples(samples).is_err());
    }
}
