//! Arguments, faults, techniques of every number, and what is printed.

use mis::technique::{Linear, Normal, Uniform};
use mis::{Controls, EstimateError, Estimator, Fit, MultiSample, OnFault, OptimalMis, Technique};

use crate::ensembles::FITS;

fn pair() -> (Uniform, Linear) {
    (Uniform::unit(), Linear::new(0.0, 1.0, 0.0, 2.0).unwrap())
}

#[track_caller]
fn assert_names<T>(result: Result<T, mis::ArgumentError>, owner: &str, argument: &str) {
    let Err(error) = result else { panic!("accepted") };
    assert_eq!((error.owner(), error.argument()), (owner, argument), "{error}");
}

#[test]
fn wrong_arguments() {
    let (flat, ramp) = pair();
    let new = || OptimalMis::new(&[(&flat, 10), (&ramp, 10)]).unwrap();
    assert_names(OptimalMis::<f64>::new(&[]), "MultiSample", "techniques");
    assert_names(OptimalMis::new(&[(&flat, 0)]), "MultiSample", "samples");
    for folds in [0, 1] {
        assert_names(new().fit(Fit::CrossFit { folds }), "OptimalMis::fit", "folds");
    }
    assert!(new().fit(Fit::CrossFit { folds: 2 }).is_ok());
    assert!(
        new().fit(Fit::CrossFit { folds: u64::MAX }).unwrap().estimate(&|x: &f64| *x, 1).is_ok()
    );
    for integral in [f64::NAN, f64::INFINITY] {
        let h = |x: &f64| *x;
        let found = new().control_variates([(&h as _, integral)]);
        assert_names(found, "OptimalMis::control_variates", "integral");
    }
    assert_names(Controls::new(2, [[0.0, 1.0]]), "Controls", "reference");
    assert_names(Controls::new(0, [vec![0.0, 1.0], vec![0.0]]), "Controls", "coefficients");
    assert_names(Controls::new(0, [[0.0, f64::NAN]]), "Controls", "coefficients");
    let mis = || MultiSample::new(&[(&flat, 10), (&ramp, 10)]).unwrap();
    let three = Controls::new(0, [[0.0, 1.0, 2.0]]).unwrap();
    assert_names(mis().controls(three), "Controls", "coefficients");
    assert!(mis().controls(Controls::new(1, [[0.0, 1.0]]).unwrap()).is_ok());
}

/// Found by one estimate, applied to others: nothing of a combination is left to these.
#[test]
fn controls_of_one_estimate_serve_another() {
    let (flat, ramp) = pair();
    let f = |x: &f64| [1.0 + x, 2.0 - 5.0 * x];
    let list: [(&dyn Technique<Point = f64>, u64); 2] = [(&flat, 100), (&ramp, 50)];
    let pilot = OptimalMis::new(&list).unwrap().estimate(&f, 1).unwrap();
    let mis = MultiSample::new(&list).unwrap().controls(pilot.controls().clone()).unwrap();
    let found = mis.estimate(&f, 2).unwrap().value();
    assert!((found[0] - 1.5).abs() < 1e-13 && (found[1] + 0.5).abs() < 1e-13, "{found:?}");
}

#[test]
fn faults_are_errors_or_counted() {
    let (flat, ramp) = pair();
    let f = |x: &f64| if *x > 0.9 { f64::NAN } else { 1.0 + x * x };
    let exact = 0.9 + 0.9_f64.powi(3) / 3.0;
    for fit in FITS {
        let new = || OptimalMis::new(&[(&flat, 2000), (&ramp, 2000)]).unwrap().fit(fit).unwrap();
        let Err(EstimateError::Value { .. }) = new().estimate(&f, 1) else { panic!("{fit:?}") };
        let few = OnFault::count_as_zero(0.01).unwrap();
        let Err(EstimateError::Faults { faults, samples: 4000, .. }) =
            new().on_fault(few).estimate(&f, 1)
        else {
            panic!("{fit:?}")
        };
        let found = new().on_fault(OnFault::count_as_zero(0.5).unwrap()).estimate(&f, 1).unwrap();
        assert_eq!(found.estimate().non_finite(), faults);
        assert!((450..700).contains(&faults), "{faults}");
        let error = found.standard_error().unwrap();
        let z = (found.value() - exact) / error;
        assert!(z.abs() < 5.0 && error < 0.02, "{fit:?}: {found} {z}");
        assert_eq!(found.uncontrolled() == 0, fit != Fit::Progressive);
    }
}

#[test]
fn techniques_without_samples_take_no_part() {
    let (flat, ramp) = pair();
    let none = Linear::new(0.0, 1.0, 3.0, 0.0).unwrap();
    let f = |x: &f64| x.exp();
    for fit in FITS {
        let of = |list: &[(&dyn Technique<Point = f64>, u64)]| {
            OptimalMis::new(list).unwrap().fit(fit).unwrap().estimate(&f, 1).unwrap()
        };
        let two = of(&[(&flat, 100), (&ramp, 100)]);
        let three = of(&[(&flat, 100), (&ramp, 100), (&none, 0)]);
        assert_eq!((two.value(), two.rank()), (three.value(), three.rank()));
        assert_eq!(two.standard_error(), three.standard_error());
        assert_eq!(three.controls().coefficients()[0][2], 0.0);
        let last = of(&[(&none, 0), (&flat, 100), (&ramp, 100)]);
        assert_eq!(last.controls().reference(), 1);
        let z = (last.value() - (1f64.exp() - 1.0)) / last.standard_error().unwrap();
        assert!(z.abs() < 5.0, "{last}");
        let parts: Vec<u64> = last.estimate().techniques().map(|t| t.samples).collect();
        assert_eq!(parts, [0, 100, 100]);
    }
}

#[test]
fn one_technique_is_plain_importance_sampling() {
    let (flat, _) = pair();
    let f = |x: &f64| x.exp();
    let plain = MultiSample::new(&[(&flat, 100)]).unwrap().estimate(&f, 1).unwrap();
    for fit in FITS {
        let mis = OptimalMis::new(&[(&flat, 100)]).unwrap().fit(fit).unwrap();
        let found = mis.estimate(&f, 1).unwrap();
        assert!((found.value() / plain.value() - 1.0).abs() < 1e-14, "{fit:?}: {found} {plain}");
        let [error, expected] =
            [found.standard_error(), plain.standard_error()].map(Option::unwrap);
        let same = if fit == Fit::Direct { 1e-12 } else { 0.2 };
        assert!((error / expected - 1.0).abs() < same, "{fit:?}: {error} {expected}");
        assert_eq!(found.rank(), 0);
    }
}

#[test]
fn sixty_four_techniques() {
    let bumps: Vec<Normal> = (0..64).map(|m| Normal::new(f64::from(m), 0.8).unwrap()).collect();
    let list: Vec<(&dyn Technique<Point = f64>, u64)> =
        bumps.iter().map(|b| (b as _, 20)).collect();
    let narrow = Normal::new(31.4, 0.75).unwrap();
    for fit in FITS {
        let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
        let found = mis.estimate(&|x: &f64| narrow.pdf(x), 1).unwrap();
        let error = found.standard_error().unwrap();
        let z = (found.value() - 1.0) / error;
        assert!(z.abs() < 5.0 && error < 0.2, "{fit:?}: {found} {z}");
        assert_eq!(found.rank(), 63);
        if fit != Fit::Progressive {
            let sum = mis.estimate(&|x: &f64| bumps.iter().map(|b| b.pdf(x)).sum::<f64>(), 1);
            assert!((sum.unwrap().value() / 64.0 - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn without_a_signal_the_error_is_unknown() {
    let (flat, ramp) = pair();
    for fit in FITS {
        let mis = OptimalMis::new(&[(&flat, 100), (&ramp, 100)]).unwrap().fit(fit).unwrap();
        let found = mis.estimate(&|_: &f64| 0.0, 1).unwrap();
        assert_eq!((found.value(), found.standard_error()), (0.0, None));
        assert_eq!(found.estimate().zero(), 200);
    }
}

#[test]
fn very_unequal_numbers_of_samples() {
    let (flat, ramp) = pair();
    let f = |x: &f64| x.exp();
    for (few, fit) in [1, 2, 3, 4, 7, 20].into_iter().flat_map(|n| FITS.map(|fit| (n, fit))) {
        for list in [
            [(&flat as &dyn Technique<Point = f64>, 1000), (&ramp, few)],
            [(&flat, few), (&ramp, 1000)],
        ] {
            let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
            let found = mis.estimate(&f, 1).unwrap();
            let what = format!("{few} {fit:?}: {found}");
            assert_eq!(found.standard_error().is_some(), few > 1, "{what}");
            assert!((found.value() - (1f64.exp() - 1.0)).abs() < 0.3, "{what}");
        }
    }
}

#[test]
fn what_is_printed() {
    let (flat, ramp) = pair();
    let of = |n, fit| {
        let mis = OptimalMis::new(&[(&flat, n), (&ramp, n)]).unwrap().fit(fit).unwrap();
        mis.estimate(&|x: &f64| 1.0 + x * x, 1).unwrap()
    };
    let plain = of(100, Fit::Direct);
    assert_eq!(plain.to_string(), plain.estimate().to_string());
    let few = of(1, Fit::Direct);
    let expected = format!("{}, by the balance heuristic: too few samples", few.estimate());
    assert_eq!(few.to_string(), expected);
    let past = of(160, Fit::Progressive);
    let expected = format!("{}, 20 samples by the balance heuristic", past.estimate());
    assert_eq!((past.uncontrolled(), past.to_string()), (20, expected));
    let h = |x: &f64| *x;
    let mis = OptimalMis::new(&[(&flat, 3)]).unwrap().control_variates([(&h as _, 0.5)]).unwrap();
    let debug = format!("{mis:?}");
    for part in ["OptimalMis", "samples: [3]", "CrossFit { folds: 5 }", "control_variates: 1"] {
        assert!(debug.contains(part), "{debug}");
    }
}

/// The pdf of a technique without samples is not evaluated: a control of it would be a bias.
#[test]
fn controls_of_techniques_without_samples_are_refused() {
    let (flat, ramp) = pair();
    let none = Linear::new(0.0, 1.0, 3.0, 0.0).unwrap();
    let with = |reference, betas: [f64; 3]| {
        let mis = MultiSample::new(&[(&flat, 10), (&ramp, 10), (&none, 0)]).unwrap();
        let controls = mis::Controls::new(reference, [betas]).unwrap();
        mis.controls(controls).err().map(|error| error.to_string())
    };
    assert_eq!(with(0, [0.0, 2.0, 0.0]), None);
    let message = with(0, [0.0, 2.0, 1.0]).unwrap();
    assert!(message.contains("technique 2 has no samples"), "{message}");
    let message = with(2, [0.0, 2.0, 0.0]).unwrap();
    assert!(message.contains("`reference` is 2"), "{message}");
}
