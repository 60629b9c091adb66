//! The checker finds every fault, names it and says how large it is; and it lets right techniques
//! pass.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::f64::consts::{PI, TAU};

use mis::check::{self, Finding, Law, Options, Report, Verdict};
use mis::technique::{
    Exponential, InverseCdf, Normal, Product, Technique, Uniform, UniformBox, canonical,
};

/// A technique on the line, to be spoilt one function at a time.
#[derive(Clone, Copy)]
struct Faulty<T> {
    right: T,
    sample: fn(&T, f64) -> f64,
    inverse: fn(&T, f64) -> f64,
    pdf: fn(&T, f64) -> f64,
    ln_pdf: fn(&T, f64) -> f64,
    cdf: fn(&T, f64) -> f64,
    sample_batch: fn(&T, &[f64], &mut Vec<f64>),
    pdf_batch: fn(&T, &[f64], &mut [f64]),
}

impl<T: InverseCdf> Faulty<T> {
    fn of(right: T) -> Self {
        Self {
            right,
            sample: |p, u| p.sample(&[u]),
            inverse: T::inverse_cdf,
            pdf: |p, x| p.pdf(&x),
            ln_pdf: |p, x| p.ln_pdf(&x),
            cdf: T::cdf,
            sample_batch: T::sample_batch,
            pdf_batch: T::pdf_batch,
        }
    }

    fn report(&self) -> Report {
        check::inverse_cdf(self, &Options::default())
    }
}

impl<T: InverseCdf> Technique for Faulty<T> {
    type Point = f64;

    fn dimension(&self) -> usize {
        1
    }

    fn sample(&self, xi: &[f64]) -> f64 {
        (self.sample)(&self.right, canonical(xi, 0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        (self.pdf)(&self.right, *x)
    }

    fn ln_pdf(&self, x: &f64) -> f64 {
        (self.ln_pdf)(&self.right, *x)
    }

    fn sample_batch(&self, xi: &[f64], xs: &mut Vec<f64>) {
        (self.sample_batch)(&self.right, xi, xs);
    }

    fn pdf_batch(&self, xs: &[f64], out: &mut [f64]) {
        (self.pdf_batch)(&self.right, xs, out);
    }
}

impl<T: InverseCdf> InverseCdf for Faulty<T> {
    fn cdf(&self, x: f64) -> f64 {
        (self.cdf)(&self.right, x)
    }

    fn inverse_cdf(&self, u: f64) -> f64 {
        (self.inverse)(&self.right, u)
    }
}

fn normal() -> Faulty<Normal> {
    Faulty::of(Normal::standard())
}

fn unit() -> Faulty<Uniform> {
    Faulty::of(Uniform::unit())
}

/// The laws that do not hold, and no other.
fn assert_broken(report: &Report, laws: &[Law]) {
    let broken: Vec<Law> = report.failures().map(Finding::law).collect();
    assert_eq!(broken, laws, "{report}");
    assert!(!report.passed());
    for law in laws {
        assert_eq!(report.get(*law).unwrap().verdict(), Verdict::Broken);
    }
}

/// The law is broken by about this much, and the detail says so.
fn assert_size(report: &Report, law: Law, size: f64, relative: f64, words: &str) {
    let finding = report.get(law).unwrap();
    assert!(!finding.passed(), "{report}");
    let miss = (finding.measured() / size - 1.0).abs();
    assert!(
        miss <= relative || finding.measured() == size,
        "{} for {size}\n{report}",
        finding.measured()
    );
    assert!(finding.detail().contains(words), "{words:?} is not in\n{report}");
}

/// The relative width that a detail reports, in per cent.
fn width(report: &Report, law: Law) -> f64 {
    let detail = report.get(law).unwrap().detail();
    let words = "the middle half of the samples is ";
    let number = detail.split(words).nth(1).and_then(|rest| rest.split(' ').next());
    number.unwrap_or_else(|| panic!("{report}")).parse().unwrap()
}

#[test]
fn what_is_not_spoilt_passes() {
    for report in [normal().report(), unit().report()] {
        assert!(report.passed(), "{report}");
        assert_eq!(report.findings().len(), 17, "{report}");
    }
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
    for (k, spoil) in all.into_iter().enumerate() {
        let mut p = unit();
        spoil(&mut p);
        let report = p.report();
        assert!(!report.get(Law::Panics).unwrap().passed(), "{report}");
        let report = check::technique(&p, &Uniform::unit(), |x| [*x], &Options::default());
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

/// A point in the unit square, by a map of the unit square and a density.
struct Square {
    map: fn([f64; 2]) -> [f64; 2],
    pdf: fn(&[f64; 2]) -> f64,
}

impl Technique for Square {
    type Point = [f64; 2];

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> [f64; 2] {
        (self.map)([canonical(xi, 0), canonical(xi, 1)])
    }

    fn pdf(&self, x: &[f64; 2]) -> f64 {
        if x.iter().all(|x| (0.0..=1.0).contains(x)) { (self.pdf)(x) } else { 0.0 }
    }
}

fn square() -> UniformBox<2> {
    UniformBox::uniform([0.0, 0.0], [1.0, 1.0]).unwrap()
}

/// By quadrature, and by the reference's samples.
fn both(p: &Square) -> [Report; 2] {
    [true, false].map(|quadrature| {
        check::technique(p, &square(), |x| *x, &Options::default().quadrature(quadrature))
    })
}

#[test]
fn correlation_that_the_pdf_ignores() {
    // Both marginals are uniform; y follows x a little.
    let map = |[u, v]: [f64; 2]| [u, (v + 0.05 * (TAU * u).sin()).rem_euclid(1.0)];
    let right = Square { map, pdf: |_| 1.0 };
    for report in both(&right) {
        assert!(report.passed(), "{report}");
    }
    // y is x in one of 20 samples.
    let map = |[u, v]: [f64; 2]| [u, if v < 0.05 { u } else { (v - 0.05) / 0.95 }];
    for report in both(&Square { map, pdf: |_| 1.0 }) {
        assert_broken(&report, &[Law::JointChiSquared(0, 1)]);
        // χ² grows by n (0.05)² 9.
        assert_size(&report, Law::JointChiSquared(0, 1), 40.0, 0.5, " samples, ");
    }
}

#[test]
fn points_whose_pdf_is_scaled_or_of_another_shape() {
    for report in both(&Square { map: |x| x, pdf: |_| 1.05 }) {
        assert_broken(&report, &[Law::Integral]);
        assert_size(&report, Law::Integral, 0.05, 1e-9, "integrates to 1.0500, 5.00 % too much");
    }
    for report in both(&Square { map: |x| x, pdf: |x| 1.0 + 0.1 * (x[0] - 0.5) }) {
        assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
        assert!(!report.get(Law::Kolmogorov(0)).unwrap().passed(), "{report}");
        assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
        assert!(report.get(Law::Integral).unwrap().passed(), "{report}");
    }
}

#[test]
fn a_hole_in_two_dimensions() {
    // Where both are below a half, only those with x < y: samples move, the pdf does not.
    let map = |[u, v]: [f64; 2]| if u < 0.1 && v < 0.1 { [u + 0.1, v] } else { [u, v] };
    for report in both(&Square { map, pdf: |_| 1.0 }) {
        assert!(!report.get(Law::JointChiSquared(0, 1)).unwrap().passed(), "{report}");
        assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
        assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
    }
}

#[test]
fn dimensions_that_are_none() {
    struct Flat(usize);
    impl Technique for Flat {
        type Point = Vec<f64>;
        fn dimension(&self) -> usize {
            self.0
        }
        fn sample(&self, xi: &[f64]) -> Vec<f64> {
            xi.iter().copied().filter(|u| *u > 0.1).collect()
        }
        fn pdf(&self, _: &Vec<f64>) -> f64 {
            1.0
        }
    }
    for dimension in [0, usize::MAX] {
        let p = Flat(dimension);
        let report = check::technique(&p, &p, Vec::clone, &Options::default());
        assert_size(&report, Law::Dimension, 1.0, 0.0, &format!("dimension() = {dimension}"));
    }
    // As many coordinates as it likes.
    let report = check::technique(&Flat(2), &Flat(2), Vec::clone, &Options::default());
    assert!(!report.get(Law::Dimension).unwrap().passed(), "{report}");
    let nothing = |_: &Vec<f64>| -> [f64; 0] { [] };
    assert!(!check::technique(&Flat(2), &Flat(2), nothing, &Options::default()).passed());
}

#[test]
fn samples_that_change_from_call_to_call() {
    use std::sync::atomic::{AtomicU64, Ordering};
    struct Restless(AtomicU64);
    impl Technique for Restless {
        type Point = f64;
        fn dimension(&self) -> usize {
            1
        }
        fn sample(&self, xi: &[f64]) -> f64 {
            let k = self.0.fetch_add(1, Ordering::Relaxed);
            (canonical(xi, 0) + k as f64 * 1e-3).fract()
        }
        fn pdf(&self, _: &f64) -> f64 {
            1.0
        }
    }
    let p = Restless(AtomicU64::new(0));
    let report = check::technique(&p, &Uniform::unit(), |x| [*x], &Options::default());
    assert!(!report.get(Law::Pure).unwrap().passed(), "{report}");
    assert!(!report.get(Law::Batch).unwrap().passed(), "{report}");
}

/// A direction of a user's own.
#[derive(Debug, Clone, Copy)]
struct Unit {
    z: f64,
    azimuth: f64,
}

/// Directions about the pole with the density `pdf` in z.
struct Polar {
    z: fn(f64) -> f64,
    pdf: fn(f64) -> f64,
}

impl Technique for Polar {
    type Point = Unit;

    fn dimension(&self) -> usize {
        2
    }

    fn sample(&self, xi: &[f64]) -> Unit {
        Unit { z: (self.z)(canonical(xi, 0)), azimuth: TAU * canonical(xi, 1) }
    }

    fn pdf(&self, w: &Unit) -> f64 {
        (self.pdf)(w.z)
    }
}

/// Of the disc seen at 45°, to rounding.
const RIM: f64 = std::f64::consts::FRAC_1_SQRT_2 * (1.0 - 1e-15);

const SPHERE: Polar = Polar { z: |u| 1.0 - 2.0 * u, pdf: |_| 0.25 / PI };

fn on_the_sphere(p: &Polar) -> Report {
    let coordinates = |w: &Unit| [0.5 * (1.0 - w.z), w.azimuth / TAU];
    check::technique(p, &SPHERE, coordinates, &Options::default())
}

#[test]
fn directions_with_a_wrong_jacobian() {
    let lambert = Polar { z: f64::sqrt, pdf: |z| z.max(0.0) / PI };
    let report = on_the_sphere(&lambert);
    assert!(report.passed(), "{report}");
    // Uniform per steradian above the horizon, without the cosine in the sampler.
    let report = on_the_sphere(&Polar { z: |u| u, pdf: |z| z.max(0.0) / PI });
    assert!(report.get(Law::Integral).unwrap().passed(), "{report}");
    assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
    assert!(report.get(Law::ChiSquared(1)).unwrap().passed(), "{report}");
    // A disc of radius 1 at the height 1: its pdf per area, not per steradian.
    let z = |u: f64| (1.0 + u).sqrt().recip();
    let per_area = |z: f64| if z >= RIM { 1.0 / PI } else { 0.0 };
    let report = on_the_sphere(&Polar { z, pdf: per_area });
    // ∫ dω / π = 2 (1 - √½).
    assert_size(&report, Law::Integral, 1.0 - 2.0 * (1.0 - 0.5_f64.sqrt()), 0.02, "% too little");
    assert!(!report.get(Law::ChiSquared(0)).unwrap().passed(), "{report}");
    let per_steradian = |z: f64| if z >= RIM { 1.0 / (PI * z.powi(3)) } else { 0.0 };
    let report = on_the_sphere(&Polar { z, pdf: per_steradian });
    assert!(report.passed(), "{report}");
}

#[test]
fn a_reference_that_does_not_suffice() {
    let narrow = Normal::new(0.5, 1e-5).unwrap();
    let wide = Uniform::new(-1.0, 2.0).unwrap();
    let options = Options::default();
    let report = check::technique(&narrow, &wide, |x| [*x], &options);
    assert_eq!(report.get(Law::Reference).unwrap().verdict(), Verdict::Unresolved, "{report}");
    assert!(report.failures().all(|f| f.verdict() == Verdict::Unresolved), "{report}");
    assert!(!report.passed());
    // Half of the samples are where the reference has no density.
    let half = Uniform::new(0.5, 1.0).unwrap();
    let report = check::technique(&Uniform::unit(), &half, |x| [*x], &options);
    // Of 1e5 samples and a pilot's 1e4.
    assert_size(&report, Law::Reference, 55_000.0, 0.02, "the reference has the density 0.0");
    // Few samples say little, and nothing panics.
    for samples in [0, 1, 7, 50] {
        let report = check::technique(&half, &wide, |x| [*x], &options.clone().samples(samples));
        assert!(!report.passed(), "{report}");
        let _ = check::inverse_cdf(&half, &options.clone().samples(samples)).to_string();
    }
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

type Case = Box<dyn Fn(u64) -> Report>;

/// How many of `seeds` reports a right technique fails.
fn false_alarms(seeds: u64, report: impl Fn(u64) -> Report) -> f64 {
    (0..seeds).map(|seed| f64::from(u8::from(!report(seed).passed()))).sum()
}

/// At a rate of 5 %, so that there is something to count.
#[test]
fn false_alarms_are_within_their_rate() {
    let (seeds, rate) = (300, 0.05_f64);
    let allowed = 300.0 * rate + 4.42 * (300.0 * rate * (1.0 - rate)).sqrt();
    let options = move |seed| Options::default().seed(seed).samples(2000).false_alarms(rate);
    let exponential = Exponential::new(1.0, 0.0, f64::INFINITY).unwrap();
    let cases: [(&str, Case); 4] = [
        ("line", Box::new(move |seed| check::inverse_cdf(&exponential, &options(seed)))),
        (
            "quadrature",
            Box::new(move |seed| {
                let p = Product::new([Normal::standard(); 2]).unwrap();
                let r = Product::new([Normal::new(0.0, 1.5).unwrap(); 2]).unwrap();
                let ranks = |x: &[f64; 2]| [0, 1].map(|d| r.coordinates()[d].cdf(x[d]));
                check::technique(&p, &r, ranks, &options(seed))
            }),
        ),
        (
            "samples of the reference",
            Box::new(move |seed| {
                let p = Product::new([Normal::standard(); 2]).unwrap();
                let r = Product::new([Normal::new(0.0, 1.5).unwrap(); 2]).unwrap();
                check::technique(&p, &r, |x| *x, &options(seed))
            }),
        ),
        (
            "reference of another shape",
            Box::new(move |seed| {
                let r = Exponential::new(0.5, 0.0, f64::INFINITY).unwrap();
                check::technique(&exponential, &r, |x| [*x], &options(seed))
            }),
        ),
    ];
    for (name, report) in cases {
        let failed = false_alarms(seeds, report);
        println!("{name}: {failed} of {seeds}");
        assert!(failed <= allowed, "{name}: {failed} of {seeds}, {allowed} allowed");
    }
}

#[test]
fn right_techniques_pass_with_any_seed() {
    let options = |seed| Options::default().seed(seed).samples(5000);
    let normal = Normal::new(-3.0, 0.2).unwrap();
    assert_eq!(false_alarms(250, |seed| check::inverse_cdf(&normal, &options(seed))), 0.0);
    let bent =
        Square { map: |[u, v]| [u, (v + 0.2 * (TAU * u).sin()).rem_euclid(1.0)], pdf: |_| 1.0 };
    assert_eq!(
        false_alarms(250, |seed| check::technique(&bent, &square(), |x| *x, &options(seed))),
        0.0
    );
}
