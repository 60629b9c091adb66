//! The variance of every estimator, from one pilot's samples.

use nalgebra::DMatrix;

use super::data::Data;
use super::method::Method;
use crate::error::ArgumentError;
use crate::estimator::{Controls, Regression, Solution};
use crate::run::k_hat;
use crate::weighting::{Densities, Weighting};

/// What a pilot says of a method with certain shares.
#[derive(Debug, Clone)]
pub(super) struct Forecast {
    /// N times the variance of an estimate from N samples, for each component.
    pub(super) variance: Vec<f64>,
    /// Its standard error, over it.
    pub(super) uncertainty: Vec<f64>,
    /// How the variance falls as a technique gets more samples, -∂V/∂α_k, all components together;
    /// `None` where the weights change with the shares.
    pub(super) gradient: Option<Vec<f64>>,
    /// How that changes, ∂²V/∂α_k ∂α_l; if it was asked for.
    pub(super) curvature: Option<DMatrix<f64>>,
    /// Whose means the variances are.
    terms: Vec<Vec<f64>>,
    /// A technique that is relied on where it does not reach.
    pub(super) uncovered: Option<usize>,
}

/// How heavy the tail of the terms of a variance may be: their own variance is infinite from 1/2 on.
const HEAVY: f64 = 0.5;

/// A variance over the mean square that is rounding, and nothing to choose by: contributions are good to
/// some 2⁻⁴⁴.
const ROUNDING: f64 = 1.0 / ((1_u64 << 44) as f64 * (1_u64 << 44) as f64);

impl Forecast {
    /// The components' variances over their scales, added up; of each, at least what rounding leaves.
    pub(super) fn total(&self, scales: &[f64]) -> f64 {
        let floor = |s: f64| if s > 0.0 { ROUNDING } else { 0.0 };
        self.variance.iter().zip(scales).map(|(v, s)| (v * s).max(floor(*s))).sum()
    }

    /// Whether few samples make up a variance, so that it may be far larger than it looks.
    pub(super) fn is_heavy(&self, scales: &[f64]) -> bool {
        self.terms.iter().enumerate().any(|(c, terms)| {
            if self.is_exact(c, scales) {
                return false;
            }
            let mut positive: Vec<f64> = terms.iter().copied().filter(|t| *t > 0.0).collect();
            let n = positive.len();
            // More than it ever looks at.
            let tail = n.saturating_sub(300);
            if tail > 0 {
                positive.select_nth_unstable_by(tail, f64::total_cmp);
            }
            k_hat(&positive[tail..], n as u64).is_some_and(|k| k >= HEAVY)
        })
    }

    /// Whether the variance of a component is known to less than the part `least` of it.
    pub(super) fn is_certain(&self, least: f64, scales: &[f64]) -> bool {
        let mut all = self.uncertainty.iter().enumerate();
        all.all(|(c, uncertainty)| *uncertainty <= least || self.is_exact(c, scales))
    }

    /// Whether nothing but rounding is left of a variance.
    fn is_exact(&self, c: usize, scales: &[f64]) -> bool {
        self.variance[c] * scales[c] <= ROUNDING
    }
}

/// The forecast for a method. `scales` weigh the components in the gradient.
///
/// The variance is N V = Σ α_i Var_i(y_i), with y_i = w_i f / (α_i p_i) and Var_i the variance under p_i.
/// That is estimated by the samples of all techniques, weighted by p_i over their mixture, about
/// the mean under p_i: they show what p_i's own samples would miss, and a contribution that does not
/// vary has a variance of 0 to the last digit.
pub(super) fn forecast(
    data: &Data,
    method: &Method,
    shares: &[f64],
    scales: &[f64],
    bends: bool,
) -> Result<Forecast, ArgumentError> {
    let weighting = method.weighting()?;
    let n = data.samples;
    let s = data.mixture(shares);
    let mut result = Forecast {
        variance: Vec::new(),
        uncertainty: Vec::new(),
        gradient: None,
        curvature: None,
        terms: Vec::new(),
        uncovered: None,
    };
    let mut gradient = vec![0.0; data.techniques];
    let mut curvature = DMatrix::zeros(data.techniques, data.techniques);
    for (c, scale) in scales.iter().enumerate().take(data.components()) {
        let mut terms = vec![0.0; n];
        match method {
            _ if shares_one_contribution(method) => {
                let mut g: Vec<f64> = data.y(c).iter().zip(&s).map(|(y, s)| y / s).collect();
                if let Method::Optimal(controls) = method {
                    subtract(&mut g, controls, c, data, &s);
                }
                for (j, g) in g.iter_mut().enumerate().filter(|(j, _)| !(s[*j] > 0.0)) {
                    if data.y(c)[j] != 0.0 {
                        let missing = (0..data.techniques).find(|k| shares[*k] > 0.0);
                        result.uncovered = result.uncovered.or(missing);
                    }
                    *g = 0.0;
                }
                shared(data, method, shares, &g, &s, &mut terms);
                if bends {
                    incline(data, method, shares, &g, &s, *scale, &mut gradient);
                    bend(data, method, shares, &g, &s, *scale, &mut curvature);
                }
            }
            _ => {
                for i in (0..data.techniques).filter(|i| shares[*i] > 0.0) {
                    let g = own(data, &*weighting, i, shares, c);
                    let mean = data.expected(i, &g);
                    let alpha = shares[i];
                    let own = |(g, d): (&f64, &f64)| {
                        if *d > 0.0 { d * (g - mean).powi(2) } else { 0.0 }
                    };
                    let own: Vec<f64> = g.iter().zip(data.d(i)).map(own).collect();
                    terms.iter_mut().zip(&own).for_each(|(t, own)| *t += alpha * own);
                    let slope = scale * data.mean(&own).0;
                    gradient[i] += slope;
                    curvature[(i, i)] += 2.0 * slope / alpha;
                    if matches!(method, Method::Constant(weights) if weights[i] > 0.0) {
                        let misses = |(d, y): (&f64, &f64)| *d == 0.0 && *y != 0.0;
                        let uncovered = data.d(i).iter().zip(data.y(c)).any(misses);
                        result.uncovered = result.uncovered.or(uncovered.then_some(i));
                    }
                }
            }
        }
        let (variance, error) = data.mean(&terms);
        result.variance.push(variance);
        // Equal contributions have no variance that could be wrong.
        result.uncertainty.push(if variance > 0.0 { error / variance } else { 0.0 });
        result.terms.push(terms);
    }
    let fixed = matches!(method, Method::Constant(_)) || shares_one_contribution(method);
    result.gradient = (fixed && bends).then_some(gradient);
    result.curvature = (fixed && bends).then_some(curvature);
    Ok(result)
}

/// Whether a sample contributes the same, whatever technique drew it.
fn shares_one_contribution(method: &Method) -> bool {
    use Method::{Balance, OneSample, Optimal, Single};
    matches!(method, Balance | Single(_) | OneSample | Optimal(_))
}

/// E_k\[g\] for every technique (0 for those without samples unless it is `of_all`), and μ, the mean under the mixture.
fn means(data: &Data, shares: &[f64], g: &[f64], of_all: bool) -> (Vec<f64>, f64) {
    let one = |(k, alpha): (usize, &f64)| {
        if of_all || *alpha > 0.0 { data.expected(k, g) } else { 0.0 }
    };
    let means: Vec<f64> = shares.iter().enumerate().map(one).collect();
    let mu = means.iter().zip(shares).map(|(mean, alpha)| alpha * mean).sum();
    (means, mu)
}

/// The terms of a variance, where samples of all techniques contribute the same g.
fn shared(data: &Data, method: &Method, shares: &[f64], g: &[f64], s: &[f64], terms: &mut [f64]) {
    let (means, mu) = means(data, shares, g, false);
    if *method == Method::OneSample {
        for ((t, g), s) in terms.iter_mut().zip(g).zip(s) {
            *t += s * (g - mu).powi(2);
        }
        return;
    }
    for k in (0..data.techniques).filter(|k| shares[*k] > 0.0) {
        for ((t, g), d) in terms.iter_mut().zip(g).zip(data.d(k)) {
            *t += shares[k] * d * (g - means[k]).powi(2);
        }
    }
}

/// The gradient of such a variance.
fn incline(
    data: &Data,
    method: &Method,
    shares: &[f64],
    g: &[f64],
    s: &[f64],
    scale: f64,
    gradient: &mut [f64],
) {
    let (means, mu) = means(data, shares, g, true);
    if *method == Method::OneSample {
        let squares: Vec<f64> = g.iter().map(|g| (g - mu) * (g + mu)).collect();
        for (k, gradient) in gradient.iter_mut().enumerate() {
            *gradient += scale * data.expected(k, &squares);
        }
        return;
    }
    // V = ∫ f²/p_α - Σ α_i b_i² with b_i = E_i[g], and more samples of k change the b_i, too:
    // -∂V/∂α_k = E_k[g² - 2 g u] + b_k², with u = Σ α_i p_i b_i / p_α. About μ, for the digits, with
    // g, u and b less μ, it is E_k[g² - 2 g u] + b_k² + 2 μ (b_k - E_k[u]).
    let mut u = vec![0.0; data.samples];
    for k in (0..data.techniques).filter(|k| shares[*k] > 0.0) {
        for (u, d) in u.iter_mut().zip(data.d(k)) {
            *u += shares[k] * (means[k] - mu) * d;
        }
    }
    for (u, s) in u.iter_mut().zip(s) {
        *u = if *s > 0.0 { *u / s } else { 0.0 };
    }
    let both = g.iter().zip(&u).map(|(g, u)| (g - mu) * (g - mu - 2.0 * u));
    let both: Vec<f64> = both.collect();
    for (k, gradient) in gradient.iter_mut().enumerate() {
        let b = means[k] - mu;
        let products = data.expected(k, &both);
        let shift = 2.0 * mu * (b - data.expected(k, &u));
        *gradient += scale * (products + b * b + shift);
    }
}

/// The curvature of the variance, where samples of all techniques contribute the same g.
///
/// With r_k = p_k / p_α, that of ∫ f²/p_α is 2 ∫ g² r_k r_l p_α; for one-sample, that of μ² / Σ α_k is
/// to be subtracted. For the balance heuristic V is the least Σ α_i E_i\[(g - b_i)²\] over the b_i, which
/// makes it 2 ∫ g (g + b_k + b_l - 2u) r_k r_l p_α - 2 Σ α_i G_ik G_il, with G_ik = ∫ g r_i r_k p_α. For
/// optimal MIS, the coefficients are taken as fixed: more than there is, so that steps are too short
/// rather than too long.
fn bend(
    data: &Data,
    method: &Method,
    shares: &[f64],
    g: &[f64],
    s: &[f64],
    scale: f64,
    curvature: &mut DMatrix<f64>,
) {
    let k = data.techniques;
    let (means, mu) = means(data, shares, g, true);
    let balance = *method == Method::Balance;
    let (mut squares, mut products) = (DMatrix::<f64>::zeros(k, k), DMatrix::<f64>::zeros(k, k));
    let mut r = vec![0.0; k];
    let n = data.samples as f64;
    for (j, (g, s)) in g.iter().zip(s).enumerate().filter(|(_, (_, s))| **s > 0.0) {
        let mut u = 0.0;
        for (i, r) in r.iter_mut().enumerate() {
            *r = data.d(i)[j] / s;
            u += shares[i] * *r * means[i];
        }
        let (g, weight) =
            if let Method::Optimal(_) = method { (g - mu, s / n) } else { (*g, s / n) };
        let square = if balance { g * (g - 2.0 * u) } else { g * g };
        for a in (0..k).filter(|a| r[*a] > 0.0) {
            let (square, product) = (weight * r[a] * square, weight * r[a] * g);
            for b in 0..=a {
                squares[(a, b)] += square * r[b];
                products[(a, b)] += product * r[b];
            }
        }
    }
    let of = |m: &DMatrix<f64>, a: usize, b: usize| m[(a.max(b), a.min(b))];
    for a in 0..k {
        for b in 0..k {
            let mut own = of(&squares, a, b);
            if balance {
                own += (means[a] + means[b]) * of(&products, a, b);
                own -= (0..k)
                    .map(|i| shares[i] * of(&products, i, a) * of(&products, i, b))
                    .sum::<f64>();
            } else if *method == Method::OneSample {
                own -= mu * mu;
            }
            curvature[(a, b)] += 2.0 * scale * own;
        }
    }
}

/// y_i = w_i f / (α_i p_i) at all samples.
fn own(data: &Data, weighting: &dyn Weighting, i: usize, shares: &[f64], c: usize) -> Vec<f64> {
    let mut factors = vec![0.0; data.samples];
    if let Some(w) = weighting.constant_weight(i, shares) {
        for (factor, d) in factors.iter_mut().zip(data.d(i)) {
            *factor = w / (shares[i] * d);
        }
    } else {
        let mut room = vec![0.0; data.techniques];
        let q = Densities::new(shares, data.densities(), data.samples);
        weighting.weight_over_density_batch(i, &q, &mut room, &mut factors);
    }
    for ((factor, y), d) in factors.iter_mut().zip(data.y(c)).zip(data.d(i)) {
        *factor = if *d > 0.0 && *y != 0.0 { *factor * y } else { 0.0 };
    }
    factors
}

/// Subtracts controls from contributions g.
fn subtract(g: &mut [f64], controls: &Controls, c: usize, data: &Data, s: &[f64]) {
    let Some(row) = controls.coefficients().get(c) else { return };
    let from = data.d(controls.reference());
    for (k, beta) in row.iter().enumerate().filter(|(_, beta)| **beta != 0.0) {
        for (((g, d), from), s) in g.iter_mut().zip(data.d(k)).zip(from).zip(s) {
            *g -= beta * (d - from) / s;
        }
    }
}

/// The controls that leave the least variance with these shares, and how many coefficients they have.
/// `None` if there is none to be had.
///
/// The regression is that of [`OptimalMis`](crate::OptimalMis) for samples of Σ α_k p_k; those of the
/// pilot's mixture stand for them with the weight Σ α_k d_k.
pub(super) fn controls(data: &Data, shares: &[f64]) -> Option<(Controls, usize)> {
    let active: Vec<usize> = (0..data.techniques).filter(|k| shares[*k] > 0.0).collect();
    let (reference, others) = active.split_first()?;
    let s = data.mixture(shares);
    let mut fit = Regression::new(others.len(), data.components());
    for (j, s) in s.iter().enumerate().filter(|(_, s)| **s > 0.0) {
        let from = data.d(*reference)[j];
        let differences = others.iter().map(|k| (data.d(*k)[j] - from) / s);
        let y = (0..data.components()).map(|c| data.y(c)[j] / s);
        fit.push(s.sqrt(), differences, y);
    }
    if fit.rows() <= 10 * active.len() as u64 {
        return None;
    }
    let Solution { coefficients, rank } = fit.solve()?;
    let all = |row: Vec<f64>| {
        let mut all = vec![0.0; data.techniques];
        others.iter().zip(row).for_each(|(k, beta)| all[*k] = beta);
        all
    };
    let rows: Vec<Vec<f64>> = coefficients.into_iter().map(all).collect();
    Some((Controls::new(*reference, rows).ok()?, rank))
}
