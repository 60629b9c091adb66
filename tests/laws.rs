//! Every technique, in every shape, against the laws.
//!
//! `cargo test --test laws` uses 1e5 samples a technique; the battery at 1e6 is
//! `cargo test --release --test laws -- --ignored`.

mod common;

use common::laws::{LawOptions, check};
use common::point_laws::check_points;
use mis::technique::{
    Cauchy, Exponential, InverseCdf, Linear, Normal, PowerLaw, Technique, TruncatedCauchy,
    TruncatedNormal, Uniform, canonical,
};

const INF: f64 = f64::INFINITY;

/// One line a technique: a name, the technique, and the options that differ from the default.
macro_rules! laws {
    ($($name:ident: $technique:expr $(, $field:ident: $value:expr)*;)*) => {$(
        mod $name {
            use super::*;

            fn options() -> LawOptions {
                LawOptions { $($field: $value,)* ..LawOptions::default() }
            }

            #[test]
            fn laws() {
                check(&$technique.unwrap(), 100_000, &options());
            }

            #[test]
            #[ignore = "1e6 samples: run in release"]
            fn battery() {
                check(&$technique.unwrap(), 1_000_000, &options());
            }
        }
    )*};
}

laws! {
    uniform: Uniform::new(-1.0, 3.0);
    uniform_unit: Some(Uniform::unit());
    uniform_tiny: Uniform::new(0.0, 1e-300);
    uniform_huge: Uniform::new(-8e307, 8e307);
    uniform_far: Uniform::new(1e9, 1e9 + 1.0);
    uniform_one_ulp: Uniform::new(1.0, 1.0 + f64::EPSILON), resolved: false;
}

// Compositions and wrappers.

use common::laws::{canonical_numbers, chi_squared, kolmogorov};
use mis::technique::{
    Affine, FnTechnique, Mixture, NumericInverse, PiecewiseConstant, Product, ProductVec, Statrs,
    Truncated, UniformBox,
};
use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_2};

laws! {
    piecewise_one_bin: PiecewiseConstant::new(&[-1.0, 2.0], &[3.0]);
    piecewise: PiecewiseConstant::new(&[0.0, 0.5, 2.0, 2.25, 7.0], &[1.0, 3.0, 0.5, 2.0]),
        splits: vec![0.5, 2.0, 2.25];
    piecewise_with_gaps: PiecewiseConstant::new(
        &[-9.0, -1.0, 0.5, 2.0, 2.25, 7.0, 8.0], &[0.0, 1.0, 0.0, 0.5, 2.0, 0.0]
    ), splits: vec![0.5, 2.0, 2.25];
    piecewise_ratios: PiecewiseConstant::new(&[0.0, 1.0, 2.0, 3.0], &[1e-200, 1.0, 1e-100]),
        splits: vec![1.0, 2.0];
    piecewise_edges_of_all_sizes: PiecewiseConstant::new(&[0.0, 1e-300, 1.0, 1e290], &[1.0, 2.0, 1.0]),
        splits: vec![1e-300, 1.0], tail_from: 1e-15;
    piecewise_table: PiecewiseConstant::tabulate(0.0, FRAC_PI_2, 16, f64::sin),
        splits: (1..16).map(|k| FRAC_PI_2 * (f64::from(k) / 16.0)).collect();
    piecewise_one_ulp: PiecewiseConstant::new(&[1.0, 1.0 + f64::EPSILON], &[1.0]), resolved: false;
}

/// The closures of p = sin x on \[0, π/2\], without cancellation at 0.
fn sine() -> Result<FnTechnique<F, F, F>, mis::ArgumentError> {
    FnTechnique::new(
        [0.0, FRAC_PI_2],
        f64::sin,
        |x| 2.0 * (0.5 * x).sin().powi(2),
        |u| 2.0 * (0.5 * u).sqrt().asin(),
    )
}

type F = fn(f64) -> f64;

const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn numeric_cauchy() -> Result<NumericInverse<F, F, F>, mis::ArgumentError> {
    let pdf: F = |x| FRAC_1_PI / (1.0 + x * x);
    let cdf: F = |x| FRAC_1_PI * 1.0_f64.atan2(-x);
    let survival: F = |x| FRAC_1_PI * 1.0_f64.atan2(x);
    Ok(NumericInverse::new(WHOLE, pdf, cdf)?.with_survival(survival))
}

fn numeric_normal() -> Result<NumericInverse<F, F, F>, mis::ArgumentError> {
    let pdf: F = |x| (-0.5 * x * x).exp() * (0.5 * FRAC_1_PI).sqrt();
    let cdf: F = |x| 0.5 * libm::erfc(-x * FRAC_1_SQRT_2);
    let survival: F = |x| 0.5 * libm::erfc(x * FRAC_1_SQRT_2);
    Ok(NumericInverse::new(WHOLE, pdf, cdf)?.with_survival(survival))
}

// Closures without a survival function have the precision of 1 - P in the upper tail.
laws! {
    fn_cosine: FnTechnique::new([0.0, FRAC_PI_2], f64::cos, f64::sin, f64::asin), tail: 1e-12,
        tail_from: 9e-4;
    fn_sine: sine(), tail_from: 9e-4;
    numeric_raised_cosine: NumericInverse::new(
        [0.0, 2.0 * FRAC_PI_2],
        |x: f64| FRAC_1_PI * (1.0 + x.cos()),
        |x: f64| FRAC_1_PI * (x + x.sin()),
    ), tail_from: 9e-4;
    numeric_cauchy: numeric_cauchy();
    numeric_normal: numeric_normal();
    numeric_pole: NumericInverse::new([0.0, 1.0], |x: f64| 0.25 * x.powf(-0.75), |x: f64| x.powf(0.25)),
        tail_from: 9e-4;
}

laws! {
    affine: Affine::new(Uniform::unit(), 3.0, 0.1);
    affine_mirrored: Affine::new(sine().unwrap(), 0.0, -2.5), tail_from: 9e-4;
    affine_normal: Affine::new(numeric_normal().unwrap(), 0.0, -1e100);
    affine_of_affine: Affine::new(Affine::new(Uniform::unit(), 1.0, -1.0).unwrap(), -5.0, 1e-3);
    truncated_uniform: Truncated::new(Uniform::new(-1.0, 3.0).unwrap(), 0.25, 10.0), tail_from: 9e-4;
    truncated_steps: Truncated::new(
        PiecewiseConstant::new(&[0.0, 1.0, 2.0, 3.0], &[1.0, 0.0, 3.0]).unwrap(), 0.5, 2.75
    ), splits: vec![1.0, 2.0];
    truncated_upper_tail: Truncated::new(numeric_normal().unwrap(), 8.0, 9.0), tail_from: 9e-4;
    truncated_lower_tail: Truncated::new(numeric_normal().unwrap(), f64::NEG_INFINITY, -8.0), tail_from: 9e-4;
    truncated_across: Truncated::new(numeric_normal().unwrap(), -1.5, f64::INFINITY), tail_from: 9e-4;
    truncated_nothing: Truncated::new(numeric_cauchy().unwrap(), f64::NEG_INFINITY, f64::INFINITY);
}

#[test]
fn product_of_two_and_three() {
    let p = Product::new([numeric_normal().unwrap(), numeric_normal().unwrap()]).unwrap();
    let normal = numeric_normal().unwrap();
    check_points(&p, &[&normal, &normal], &|x| [x[0], x[1]], 100_000, 1e-12);

    let (steps, sine) = (steps().unwrap(), sine().unwrap());
    let unit = Uniform::unit();
    let coordinates: [&dyn InverseCdf; 3] = [&steps, &sine, &unit];
    let p = Product::new(coordinates).unwrap();
    check_points(&p, &coordinates, &|x| [x[0], x[1], x[2]], 100_000, 1e-12);
}

#[test]
fn product_of_run_time_length() {
    let coordinates: Vec<Box<dyn InverseCdf>> =
        vec![Box::new(Uniform::unit()), Box::new(sine().unwrap()), Box::new(steps().unwrap())];
    let p = ProductVec::new(coordinates).unwrap();
    let marginals: [&dyn InverseCdf; 3] = [&Uniform::unit(), &sine().unwrap(), &steps().unwrap()];
    check_points(&p, &marginals, &|x| x.to_vec(), 100_000, 1e-12);
}

#[test]
fn product_in_a_thousand_dimensions() {
    let side = Uniform::new(0.0, 10.0).unwrap();
    let p = ProductVec::new(vec![side; 1000]).unwrap();
    let marginals = vec![&side as &dyn InverseCdf; 1000];
    check_points(&p, &marginals, &|x| x.to_vec(), 1000, 0.0);
}

#[test]
fn uniform_box() {
    let p = UniformBox::uniform([0.0, -1e9, 1e-9], [1e-300, 1e9, 2e-9]).unwrap();
    let [a, b, c] = *p.coordinates();
    check_points(&p, &[&a, &b, &c], &|x| [x[0], x[1], x[2]], 100_000, 1e-12);
    let p = ProductVec::uniform(&[0.0, -1.0], &[1.0, 3.0]).unwrap();
    let (a, b) = (p.coordinates()[0], p.coordinates()[1]);
    check_points(&p, &[&a, &b], &|x| x.to_vec(), 100_000, 1e-12);
}

/// A mixture on the line: its CDF is the mixture of the CDFs.
#[test]
fn mixture_on_the_line() {
    let parts = [
        (Uniform::new(0.0, 4.0).unwrap(), 0.5),
        (Uniform::new(1.0, 2.0).unwrap(), 0.0),
        (Uniform::new(3.0, 3.5).unwrap(), 0.3),
        (Uniform::new(-7.0, -6.0).unwrap(), 0.2),
    ];
    let p = Mixture::new(parts.to_vec()).unwrap();
    let xis = canonical_numbers(4, 2 * 100_000);
    let mut xs = Vec::new();
    p.sample_batch(&xis, &mut xs);
    let mut pdfs = vec![0.0; xs.len()];
    p.pdf_batch(&xs, &mut pdfs);
    for (x, pdf) in xs.iter().zip(&pdfs) {
        assert!(*pdf > 0.0 && pdf.to_bits() == p.pdf(x).to_bits());
        assert!((p.ln_pdf(x) - pdf.ln()).abs() <= 8.0 * f64::EPSILON * pdf.ln().abs().max(1.0));
    }
    let cdf = |x: f64| parts.iter().map(|(part, p)| p * part.cdf(x)).sum::<f64>();
    let edges: Vec<f64> = (0..=44).map(|k| -7.0 + 0.25 * f64::from(k)).collect();
    let masses: Vec<f64> = edges.windows(2).map(|e| cdf(e[1]) - cdf(e[0])).collect();
    let densities = edges.windows(2).map(|e| (e[1] - e[0]) * p.pdf(&(0.5 * (e[0] + e[1]))));
    assert!(masses.iter().zip(densities).all(|(m, d)| (m - d).abs() <= 4.0 * f64::EPSILON));
    chi_squared(&masses, xs.iter().map(|x| edges.partition_point(|e| e <= x) - 1));
    kolmogorov(&mut xs.iter().map(|&x| cdf(x)).collect::<Vec<f64>>());
}

fn steps() -> Result<PiecewiseConstant, mis::ArgumentError> {
    PiecewiseConstant::new(&[0.0, 0.5, 2.0, 3.0], &[1.0, 0.0, 3.0])
}

/// The laws of distributions of `statrs`, with the bound that [`Statrs`] states.
macro_rules! statrs_laws {
    ($($name:ident: $type:ident($($argument:expr),*) $(, $field:ident: $value:expr)*;)*) => {
        laws! {$(
            $name: Statrs::new(statrs::distribution::$type::new($($argument),*).unwrap()),
                round_trip: 2000.0 $(, $field: $value)*;
        )*}
    };
}

statrs_laws! {
    statrs_normal: Normal(1.0, 2.0);
    statrs_log_normal: LogNormal(0.5, 1.0);
    statrs_gamma: Gamma(2.5, 3.0);
    statrs_erlang: Erlang(4, 2.0);
    statrs_exp: Exp(0.5), tail_from: 9e-4;
    statrs_chi_squared: ChiSquared(3.0);
    statrs_chi: Chi(4);
    statrs_beta: Beta(2.0, 5.0);
    statrs_students_t: StudentsT(0.5, 2.0, 3.0);
    statrs_fisher_snedecor: FisherSnedecor(5.0, 7.0), tail_from: 1e-12;
    statrs_weibull: Weibull(1.5, 2.0);
    statrs_gumbel: Gumbel(1.0, 2.0);
    statrs_laplace: Laplace(-1.0, 3.0);
    statrs_triangular: Triangular(0.0, 2.0, 0.5);
    statrs_pareto: Pareto(2.0, 1.5), tail_from: 9e-4;
    statrs_inverse_gamma: InverseGamma(2.0, 3.0);
    statrs_levy: Levy(0.0, 1.0), tail_from: 1e-149;
    statrs_cauchy: Cauchy(0.0, 2.0), tail_from: 9e-4;
}

laws! {
    linear: Linear::new(-1.0, 3.0, 1.0, 2.0);
    linear_up: Linear::new(0.0, 1.0, 0.0, 1.0);
    linear_down: Linear::new(2.0, 5.0, 3.0, 0.0);
    linear_level: Linear::new(0.0, 1.0, 0.7, 0.7);
    linear_nearly_level: Linear::new(0.0, 1.0, 1.0, 1.0 + 1e-15);
    linear_steep: Linear::new(0.0, 1.0, 1e-300, 1e300);
    linear_steep_down: Linear::new(-1.0, 0.0, 1e160, 1e-160);
    linear_subnormal_values: Linear::new(0.0, 1.0, 5e-324, 1e-323);
    linear_tiny: Linear::new(0.0, 1e-300, 0.0, 1.0);
    linear_huge: Linear::new(-8e307, 8e307, 1.0, 2.0);
    linear_one_ulp: Linear::new(1.0, 1.0 + f64::EPSILON, 0.0, 1.0), resolved: false;
}

laws! {
    exponential: Exponential::new(1.0, 0.0, INF);
    exponential_shifted: Exponential::new(0.3, -2.0, INF);
    exponential_cut: Exponential::new(2.0, 1.0, 3.0);
    exponential_growing: Exponential::new(-2.0, 1.0, 3.0);
    exponential_growing_to_0: Exponential::new(-2.0, -3.0, 0.0);
    exponential_level: Exponential::new(0.0, 1.0, 3.0);
    exponential_nearly_level: Exponential::new(1e-17, 0.0, 3.0);
    exponential_nearly_level_growing: Exponential::new(-1e-9, 0.0, 3.0);
    exponential_subnormal_rate: Exponential::new(1e-320, 0.0, 3.0);
    exponential_steep: Exponential::new(1e5, 0.0, 3.0);
    exponential_steep_growing: Exponential::new(-1e5, 0.0, 3.0);
    exponential_depth_700: Exponential::new(700.0, -1.0, 0.0);
    exponential_tiny: Exponential::new(1e300, 0.0, INF);
    exponential_tiny_window: Exponential::new(1e300, 0.0, 1e-300);
    exponential_huge: Exponential::new(1e-280, 0.0, INF);
    exponential_one_ulp: Exponential::new(1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    power_law_flat: PowerLaw::new(0.0, 0.0, 2.0);
    power_law_ramp: PowerLaw::new(1.0, 0.0, 1.0);
    power_law_root: PowerLaw::new(-0.5, 0.0, 1.0), tail_from: 1e-150;
    power_law_singular: PowerLaw::new(-0.9, 0.0, 1.0), tail_from: 1e-20;
    power_law_nearly_log: PowerLaw::new(-0.99, 0.0, 1.0), tail_from: 2e-3, integral: 9e-4;
    power_law_steep: PowerLaw::new(1e6, 0.0, 1.0);
    power_law_cut: PowerLaw::new(2.5, 0.5, 2.0);
    power_law_falling: PowerLaw::new(-3.0, 1.0, 1e3);
    power_law_log: PowerLaw::new(-1.0, 0.5, 4.0);
    power_law_log_wide: PowerLaw::new(-1.0, 1e-300, 1e300);
    power_law_almost_log: PowerLaw::new(-1.0 + 1e-12, 0.5, 4.0);
    power_law_almost_log_wide: PowerLaw::new(-1.01, 1e-290, 1e290);
    power_law_steep_falling: PowerLaw::new(-1e6, 1.0, 2.0);
    power_law_narrow: PowerLaw::new(2.0, 1.0, 1.0 + 1e-9);
    power_law_tiny: PowerLaw::new(2.0, 0.0, 1e-300), tail_from: 1e-20;
    power_law_huge: PowerLaw::new(2.0, 0.0, 1e290);
    power_law_one_ulp: PowerLaw::new(2.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    normal: Some(Normal::standard());
    normal_shifted: Normal::new(-3.0, 0.2);
    normal_far: Normal::new(1e9, 1.0);
    normal_tiny: Normal::new(0.0, 1e-300);
    normal_huge: Normal::new(0.0, 1e290);
    normal_below_one_ulp: Normal::new(1e20, 1e-3), resolved: false;
}

laws! {
    cauchy: Cauchy::new(0.0, 1.0);
    cauchy_shifted: Cauchy::new(91.2, 1.25);
    cauchy_tiny: Cauchy::new(0.0, 1e-300);
    cauchy_huge: Cauchy::new(0.0, 1e270), tail_from: 1e-20;
    truncated_cauchy: TruncatedCauchy::new(91.2, 1.25, 60.0, 120.0);
    truncated_cauchy_line: TruncatedCauchy::new(1.0, 2.0, -INF, INF);
    truncated_cauchy_lower_half: TruncatedCauchy::new(0.0, 1.0, -INF, 0.0);
    truncated_cauchy_upper_half: TruncatedCauchy::new(0.0, 1.0, 0.0, INF);
    truncated_cauchy_tail: TruncatedCauchy::new(0.0, 1.0, 1e6, INF);
    truncated_cauchy_lower_tail: TruncatedCauchy::new(0.0, 1.0, -INF, -1e6);
    truncated_cauchy_ending_at_0: TruncatedCauchy::new(-1e9, 1.0, 0.0, 1e-3), tail_from: 1e-280;
    truncated_cauchy_far_window: TruncatedCauchy::new(0.0, 1.0, 1e9, 1e9 + 1.0);
    truncated_cauchy_far_off: TruncatedCauchy::new(0.0, 1.0, 1e200, 2e200);
    truncated_cauchy_wide: TruncatedCauchy::new(0.0, 1.0, -1e200, 1e100), tail_from: 1e-150;
    truncated_cauchy_narrow: TruncatedCauchy::new(0.0, 1e300, 1.0, 2.0);
    truncated_cauchy_tiny: TruncatedCauchy::new(0.0, 1e-300, -1e-300, 3e-300);
    truncated_cauchy_needle: TruncatedCauchy::new(0.0, 1e-30, -1.0, 1.0);
    truncated_cauchy_one_ulp: TruncatedCauchy::new(0.0, 1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    truncated_normal: TruncatedNormal::new(0.0, 1.0, -1.0, 2.0);
    truncated_normal_line: TruncatedNormal::new(1.0, 2.0, -INF, INF);
    truncated_normal_lower_half: TruncatedNormal::new(0.0, 1.0, -INF, 0.0);
    truncated_normal_upper_half: TruncatedNormal::new(0.0, 1.0, 0.0, INF);
    truncated_normal_starting_at_0: TruncatedNormal::new(2.0, 1.0, 0.0, INF);
    truncated_normal_ending_at_0: TruncatedNormal::new(-2.0, 1.0, -INF, 0.0);
    truncated_normal_above_0: TruncatedNormal::new(-2.0, 1.0, 0.0, INF);
    truncated_normal_straddling: TruncatedNormal::new(0.0, 1.0, -30.0, 40.0);
    truncated_normal_one_sd_off: TruncatedNormal::new(0.0, 1.0, 1.0, 4.0);
    truncated_normal_three_sd_off: TruncatedNormal::new(0.0, 1.0, -INF, -3.0);
    truncated_normal_four_sd_off: TruncatedNormal::new(0.0, 1.0, 4.5, 4.8);
    truncated_normal_38_sd_off: TruncatedNormal::new(0.0, 1.0, 38.0, INF);
    truncated_normal_100_sd_off: TruncatedNormal::new(0.0, 1.0, 100.0, 101.0);
    truncated_normal_100_sd_below: TruncatedNormal::new(0.0, 1.0, -101.0, -100.0);
    truncated_normal_far_at_0: TruncatedNormal::new(-1e5, 1.0, 0.0, INF);
    truncated_normal_narrow: TruncatedNormal::new(0.0, 1.0, 0.5, 0.5 + 1e-9);
    truncated_normal_narrow_far: TruncatedNormal::new(0.0, 1.0, 100.0, 100.0 + 1e-9);
    truncated_normal_flat: TruncatedNormal::new(0.0, 1e300, -1.0, 2.0);
    truncated_normal_tiny: TruncatedNormal::new(0.0, 1e-300, -1e-300, 3e-300);
    truncated_normal_needle: TruncatedNormal::new(0.0, 1e-30, -1.0, 1.0);
    truncated_normal_one_ulp: TruncatedNormal::new(0.0, 1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

/// The laws of points, on the smallest example.
#[test]
fn points() {
    struct Square(PowerLaw);

    impl Technique for Square {
        type Point = [f64; 2];

        fn dimension(&self) -> usize {
            2
        }

        fn sample(&self, xi: &[f64]) -> [f64; 2] {
            [0, 1].map(|d| self.0.inverse_cdf(canonical(xi, d)))
        }

        fn pdf(&self, x: &[f64; 2]) -> f64 {
            self.0.pdf(&x[0]) * self.0.pdf(&x[1])
        }
    }

    let p = PowerLaw::new(1.0, 0.5, 2.0).unwrap();
    check_points(&Square(p), &[&p, &p], &|x| [x[0], x[1]], 100_000, 1e-6);
}
