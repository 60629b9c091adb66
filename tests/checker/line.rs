//! Faults of a density on the line.

use mis::check::{self, Law, Options};
use mis::technique::{Exponential, InverseCdf, Technique, Uniform};

use crate::{Faulty, assert_broken, assert_size, normal, unit, width};

#[test]
fn what_is_not_spoilt_passes() {
    for report in [normal().report(), unit().report()] {
        assert!(report.passed(), "{report}");
        assert_eq!(report.findings().len(), 17, "{report}");
    }
    let with = |seed| check::inverse_cdf(&normal(), &Options::default().seed(seed));
    assert_eq!(with(1), normal().report());
    assert_ne!(with(1).findings(), with(2).findings());
}

#[test]
fn sampler_too_wide() {
    let mut p = normal();
    p.sample = |p, u| 1.05 * p.inverse_cdf(u);
    p.sample_batch = |p, xi, xs| {
        xs.clear();
        xs.extend(xi.iter().map(|u| 1.05 * p.sample(&[*u])));
    };
    let report = p.report();
    assert_broken(&report, &[Law::SampleIsInverse, Law::ChiSquared(0), Law::Kolmogorov(0)]);
    assert_size(&report, Law::ChiSquared(0), 18.0, 0.3, "% wider");
    // sup abs(Φ(x) - Φ(x / 1.05)).
    assert_size(&report, Law::Kolmogorov(0), 0.0117, 0.3, "% wider");
    // Of 1e5 samples, the quartiles' distance has the standard error 0.4 %.
    assert!((width(&report, Law::ChiSquared(0)) - 5.0).abs() < 1.6, "{report}");
}

/// The inverse CDF and the CDF belong together, and both are too wide for the pdf.
#[test]
fn sampler_and_cdf_too_wide() {
    let mut p = normal();
    p.sample = |p, u| 1.05 * p.inverse_cdf(u);
    p.inverse = |p, u| 1.05 * p.inverse_cdf(u);
    p.cdf = |p, x| p.cdf(x / 1.05);
    p.sample_batch = |p, xi, xs| {
        xs.clear();
        xs.extend(xi.iter().map(|u| 1.05 * p.sample(&[*u])));
    };
    let report = p.report();
    assert_broken(&report, &[Law::Mass, Law::TailMass, Law::ChiSquared(0)]);
    // The largest difference of both CDFs between two points.
    assert_size(&report, Law::Mass, 0.0234, 0.2, "by the cdf");
    assert_size(&report, Law::ChiSquared(0), 18.0, 0.3, "% wider");
    assert!((width(&report, Law::ChiSquared(0)) - 5.0).abs() < 1.6, "{report}");
}

#[test]
fn pdf_scaled() {
    let mut p = normal();
    p.pdf = |p, x| 1.05 * p.pdf(&x);
    p.ln_pdf = |p, x| p.ln_pdf(&x) + 1.05_f64.ln();
    p.pdf_batch = |p, xs, out| out.iter_mut().zip(xs).for_each(|(q, x)| *q = 1.05 * p.pdf(x));
    let report = p.report();
    assert_broken(&report, &[Law::Integral, Law::Mass, Law::TailMass]);
    let words = "the pdf integrates to 1.0500, 5.00 % too much";
    assert_size(&report, Law::Integral, 0.05, 1e-9, words);
    assert!(report.to_string().contains("FAIL integral of the pdf"));
}

#[test]
fn shapes_that_differ() {
    // Sampler and CDF of the uniform density, pdf of a ramp.
    let mut p = unit();
    p.pdf = |_, x| if (0.0..=1.0).contains(&x) { 2.0 * x } else { 0.0 };
    p.ln_pdf = |_, x| if (0.0..=1.0).contains(&x) { (2.0 * x).ln() } else { f64::NEG_INFINITY };
    p.pdf_batch = |_, xs, out| out.iter_mut().zip(xs).for_each(|(q, x)| *q = 2.0 * x);
    let report = p.report();
    assert_broken(&report, &[Law::Mass, Law::TailMass, Law::ChiSquared(0)]);
    assert_size(&report, Law::Mass, 0.25, 0.1, "by the cdf");
    assert_size(&report, Law::ChiSquared(0), 1000.0, 1.0, "expected");
}

#[test]
fn hole_in_the_sampler() {
    // Nothing between 0.4 and 0.5.
    let hole = |u: f64| if (0.4..0.5).contains(&u) { u + 0.1 } else { u };
    let mut p = unit();
    p.sample = |_, u| if (0.4..0.5).contains(&u) { u + 0.1 } else { u };
    p.sample_batch = |_, xi, xs| {
        xs.clear();
        xs.extend(xi.iter().map(|u| if (0.4..0.5).contains(u) { u + 0.1 } else { *u }));
    };
    assert_eq!(hole(0.45), p.sample(&[0.45]));
    let report = p.report();
    assert_broken(&report, &[Law::SampleIsInverse, Law::ChiSquared(0), Law::Kolmogorov(0)]);
    assert_size(&report, Law::SampleIsInverse, 0.1, 1e-9, "inverse_cdf of it");
    assert_size(&report, Law::Kolmogorov(0), 0.1, 0.05, "");
    // Of the bins of 3125 in the hole, [0.4063, 0.4375) and the like hold none.
    assert_size(&report, Law::ChiSquared(0), 100.0, 1.0, " expected");
}

#[test]
fn no_density_at_own_samples() {
    let mut p = unit();
    p.pdf = |p, x| if (0.2..0.21).contains(&x) { 0.0 } else { p.pdf(&x) };
    p.ln_pdf = |_, x| {
        if (0.2..0.21).contains(&x) || !(0.0..=1.0).contains(&x) { f64::NEG_INFINITY } else { 0.0 }
    };
    p.pdf_batch = |_, xs, out| {
        out.iter_mut()
            .zip(xs)
            .for_each(|(q, x)| *q = f64::from(u8::from(!(0.2..0.21).contains(x))));
    };
    let report = p.report();
    // 102 005 samples are looked at, 1 % of them in the gap; the first is named.
    assert_size(&report, Law::SampleDensity, 1020.0, 0.2, ")) = 0.0, x = 0.20");
    assert_size(&report, Law::Integral, 0.01, 0.05, "% too little");
    assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
}

#[test]
fn negative_infinite_and_nan_densities() {
    for (spoilt, words) in
        [(-0.5, ")) = -0.5"), (f64::NAN, ")) = NaN"), (f64::INFINITY, ")) = inf")]
    {
        let mut p = unit();
        p.pdf = match spoilt {
            x if x < 0.0 => |p, x| if x > 0.9 { -0.5 } else { p.pdf(&x) },
            x if x > 0.0 => |p, x| if x > 0.9 { f64::INFINITY } else { p.pdf(&x) },
            _ => |p, x| if x > 0.9 { f64::NAN } else { p.pdf(&x) },
        };
        let report = p.report();
        assert_size(&report, Law::SampleDensity, 10_200.0, 0.05, words);
        assert!(!report.get(Law::Integral).unwrap().passed(), "{report}");
        assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
        assert!(!report.get(Law::LnPdf).unwrap().passed(), "{report}");
        let square = |x: &f64| [*x];
        let report = check::technique(&p, &Uniform::unit(), square, &Options::default());
        // 100 000 samples, 4000 of two pilots, 2000 and a few at the edges: of the former, 10 %.
        assert!(!report.get(Law::SampleDensity).unwrap().passed(), "{report}");
        // An infinite density may be one that has overflowed: the logarithm, here 0, decides.
        assert_eq!(report.get(Law::Integral).unwrap().passed(), spoilt > 0.0, "{report}");
        assert_eq!(report.get(Law::Density).unwrap().passed(), spoilt > 0.0, "{report}");
    }
}

#[test]
fn samples_outside_the_support() {
    let mut p = unit();
    p.sample = |_, u| if u > 0.99 { u + 1.0 } else { u };
    let report = p.report();
    assert_size(&report, Law::SampleSupport, 1020.0, 0.2, "outside [0.0, 1.0]");
    assert_size(&report, Law::SampleDensity, 1020.0, 0.2, ")) = 0.0, x = ");
    assert_size(&report, Law::SampleIsInverse, 1.0, 1e-9, "sample(");
    let report = check::technique(&p, &Uniform::unit(), |x| [*x], &Options::default());
    assert!(report.get(Law::Reference).unwrap().measured() > 900.0, "{report}");
    let report =
        check::technique(&p, &Uniform::new(0.0, 2.0).unwrap(), |x| [*x], &Options::default());
    assert_size(&report, Law::SampleDensity, 1120.0, 0.2, "x = 1.99");
}

#[test]
fn an_unbounded_support_whose_ends_are_sampled() {
    struct Careless;
    impl Technique for Careless {
        type Point = f64;
        fn dimension(&self) -> usize {
            1
        }
        fn sample(&self, xi: &[f64]) -> f64 {
            -(1.0 - xi.first().copied().unwrap_or(0.5)).ln()
        }
        fn pdf(&self, x: &f64) -> f64 {
            if *x >= 0.0 { (-x).exp() } else { 0.0 }
        }
    }
    impl InverseCdf for Careless {
        fn cdf(&self, x: f64) -> f64 {
            if x > 0.0 { -(-x).exp_m1() } else { 0.0 }
        }
        fn inverse_cdf(&self, u: f64) -> f64 {
            if (0.0..=1.0).contains(&u) { -(-u).ln_1p() } else { f64::NAN }
        }
    }
    let report = check::inverse_cdf(&Careless, &Options::default());
    assert_size(&report, Law::SampleSupport, 1.0, 0.0, "sample(1.0) = inf outside [0.0, inf]");
}

#[test]
fn an_inverse_that_is_none() {
    let mut p = unit();
    p.inverse = |p, u| {
        let x = p.inverse_cdf(u);
        if 0.0 < x && x < 0.5 { x + 0.02 * x * (0.5 - x) } else { x }
    };
    let report = p.report();
    assert_size(&report, Law::RoundTrip, 0.00125, 0.01, "cdf(inverse_cdf(0.2");
    assert!(!report.get(Law::SampleIsInverse).unwrap().passed());
    assert!(report.get(Law::Monotone).unwrap().passed(), "{report}");
}

#[test]
fn a_cdf_that_falls() {
    let mut p = unit();
    p.cdf = |p, x| if (0.5..0.75).contains(&x) { p.cdf(x) - 0.125 } else { p.cdf(x) };
    let report = p.report();
    assert_size(
        &report,
        Law::Monotone,
        0.125,
        0.05,
        "cdf(0.4989589382386793) = 0.4989589382386793, cdf(0.5) = 0.375",
    );
    assert_size(&report, Law::RoundTrip, 0.125, 1e-9, "survival(inverse_survival(");
    p.inverse = |p, u| if 0.0 < u && u < 1.0 { p.inverse_cdf(1.0 - u) } else { p.inverse_cdf(u) };
    let report = p.report();
    assert_size(&report, Law::Monotone, f64::INFINITY, 0.0, "inverse_cdf(");
}

#[test]
fn ends_and_odd_arguments() {
    let mut p = unit();
    p.inverse = |_, u| u;
    assert_size(&p.report(), Law::Ends, 5.0, 0.0, "inverse_cdf(-5e-324) = -5e-324, not NaN");
    let mut p = unit();
    p.cdf = |_, x| x;
    assert!(
        p.report().get(Law::Ends).unwrap().detail().contains(" cdf(-5e-324) = -5e-324, not 0.0")
    );
    let mut p = unit();
    p.pdf = |_, _| 1.0;
    assert!(p.report().get(Law::Ends).unwrap().detail().contains("pdf(-5e-324) = 1.0, not 0.0"));
}

#[test]
fn tails_without_relative_precision() {
    // The survival function is 1 - P: absolute precision only.
    let right = Exponential::new(1.0, 0.0, f64::INFINITY).unwrap();
    let p = Faulty::of(right);
    let report = check::inverse_cdf(&p, &Options::strict());
    assert_broken(&report, &[Law::Tails, Law::TailMass]);
    assert_size(&report, Law::Tails, 1.0, 0.0, "survival(inverse_survival(");
    assert!(check::inverse_cdf(&right, &Options::strict()).passed());
    assert!(p.report().passed());
}

#[test]
fn ln_pdf_off() {
    let mut p = normal();
    p.ln_pdf = |p, x| p.ln_pdf(&x) + 1e-9;
    let report = p.report();
    assert_broken(&report, &[Law::LnPdf]);
    assert_size(&report, Law::LnPdf, 1e-9, 1e-5, "ln_pdf(");
}

#[test]
fn batches_that_differ() {
    let mut p = unit();
    p.sample_batch = |_, xi, xs| {
        xs.clear();
        xs.extend(xi.iter().map(|u| if *u > 0.5 { u.next_up() } else { *u }));
    };
    let report = p.report();
    assert_broken(&report, &[Law::Batch]);
    assert_size(&report, Law::Batch, 3000.0, 0.1, "sample_batch gives 0.");
    let mut p = unit();
    p.pdf_batch = |_, xs, out| {
        out.iter_mut()
            .zip(xs)
            .for_each(|(q, x)| *q = if *x < 0.1 { 1.0 + f64::EPSILON } else { 1.0 });
    };
    let report = p.report();
    assert_broken(&report, &[Law::Batch]);
    assert_size(&report, Law::Batch, 600.0, 0.2, "pdf_batch gives 1.0000000000000002");
}

#[test]
fn batches_of_too_few_points() {
    let mut p = unit();
    p.sample_batch = |p, xi, xs| {
        xs.clear();
        xs.extend(xi.iter().skip(1).map(|u| p.sample(&[*u])));
    };
    let words = "sample_batch made 1999 points of 2000";
    assert!(p.report().get(Law::Batch).unwrap().detail().contains(words));
    let report = check::technique(&p, &Uniform::unit(), |x| [*x], &Options::default());
    let finding = report.get(Law::Batch).unwrap();
    assert!(finding.detail().contains("sample_batch made 2009 points of 2010"), "{report}");
    p.sample_batch = |_, _, xs| xs.clear();
    assert!(p.report().get(Law::Batch).unwrap().detail().contains("made 0 points of 2000"));
}

#[test]
fn panics_are_findings() {
    let mut p = unit();
    p.cdf = |_, x| if x.is_nan() { panic!("no {x}, please") } else { x.clamp(0.0, 1.0) };
    let report = p.report();
    assert_broken(&report, &[Law::Panics]);
    let words = "cdf(NaN) panicked: no NaN, please";
    assert!(report.get(Law::Panics).unwrap().detail().starts_with(words), "{report}");

    let all: [fn(&mut Faulty<Uniform>); 7] = [
        |p| p.cdf = |_, _| panic!("cdf"),
        |p| p.inverse = |_, _| panic!("inverse"),
        |p| p.sample = |_, _| panic!("sample"),
        |p| p.pdf = |_, _| panic!("pdf"),
        |p| p.ln_pdf = |_, _| panic!("ln_pdf"),
        |p| p.sample_batch = |_, _, _| panic!("sample_batch"),
        |p| p.pdf_batch = |_, _, _| panic!("pdf_batch"),
    ];
    let few = Options::default().samples(2000);
    for (k, spoil) in all.into_iter().enumerate() {
        let mut p = unit();
        spoil(&mut p);
        let report = check::inverse_cdf(&p, &few);
        assert!(!report.get(Law::Panics).unwrap().passed(), "{report}");
        let report = check::technique(&p, &Uniform::unit(), |x| [*x], &few);
        // The last of the laws know nothing of a CDF.
        assert_eq!(report.get(Law::Panics).unwrap().passed(), k < 2, "{report}");
    }
    let report = check::technique(
        &Uniform::unit(),
        &Uniform::unit(),
        |x| if *x > 0.5 { panic!("coordinates") } else { [*x] },
        &Options::default(),
    );
    assert!(!report.get(Law::Panics).unwrap().passed(), "{report}");
}

#[test]
fn no_number_makes_a_check_panic() {
    // Constants of all kinds for each method.
    macro_rules! all {
        ($($x:expr),*) => {[$({
            let mut p = unit();
            p.sample = |_, _| $x;
            p.inverse = |_, _| $x;
            p.pdf = |_, _| $x;
            p.cdf = |_, _| $x;
            let mut q = unit();
            q.sample = |_, _| $x;
            let mut r = unit();
            r.pdf = |_, _| $x;
            let mut s = unit();
            s.inverse = |_, _| $x;
            let mut t = unit();
            t.cdf = |_, _| $x;
            [p, q, r, s, t]
        }),*]};
    }
    let options = Options::default().samples(2000);
    for p in all!(f64::NAN, f64::INFINITY, -f64::INFINITY, 0.0, -1.0, 1e308, 5e-324).concat() {
        let report = check::inverse_cdf(&p, &options);
        assert!(!report.passed(), "{report}");
        let report = check::technique(&p, &Uniform::unit(), |x| [*x, 2.0 * x], &options);
        assert!(report.to_string().len() > 100);
    }
}
