//! Tables, wrappers, closures, numerical inversion, and the distributions of `statrs`.

use mis::technique::{
    Affine, FnTechnique, NumericInverse, PiecewiseConstant, Statrs, Truncated, Uniform,
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
    piecewise_compensated: PiecewiseConstant::new(&[0.0, 0.5, 2.0, 2.25, 7.0], &[1.0, 3.0, 0.5, 2.0])
        .unwrap().compensated(1.0), splits: vec![2.0, 2.25];
    piecewise_table_compensated: PiecewiseConstant::tabulate(0.0, FRAC_PI_2, 16, |x| (3.0 * x).cos().abs())
        .unwrap().compensated(0.75), splits: (1..16).map(|k| FRAC_PI_2 * (f64::from(k) / 16.0)).collect();
    piecewise_one_ulp: PiecewiseConstant::new(&[1.0, 1.0 + f64::EPSILON], &[1.0]), resolved: false;
}

/// The closures of p = sin x on \[0, π/2\], without cancellation at 0.
pub(super) fn sine() -> Result<FnTechnique<F, F, F>, mis::ArgumentError> {
    FnTechnique::new(
        [0.0, FRAC_PI_2],
        f64::sin,
        |x| 2.0 * (0.5 * x).sin().powi(2),
        |u| 2.0 * (0.5 * u).sqrt().asin(),
    )
}

pub(super) type F = fn(f64) -> f64;

const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn numeric_cauchy() -> Result<NumericInverse<F, F, F>, mis::ArgumentError> {
    let pdf: F = |x| FRAC_1_PI / (1.0 + x * x);
    let cdf: F = |x| FRAC_1_PI * 1.0_f64.atan2(-x);
    let survival: F = |x| FRAC_1_PI * 1.0_f64.atan2(x);
    Ok(NumericInverse::new(WHOLE, pdf, cdf)?.with_survival(survival))
}

pub(super) fn numeric_normal() -> Result<NumericInverse<F, F, F>, mis::ArgumentError> {
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

pub(super) fn steps() -> Result<PiecewiseConstant, mis::ArgumentError> {
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
