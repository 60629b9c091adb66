//! The laws of a [`Technique`] whose points are arrays or vectors of coordinates.

use super::laws::{canonical_numbers, chi_squared, kolmogorov};
use super::quadrature::gauss;
use mis::technique::{InverseCdf, Technique};

/// Every law, given the marginal of every coordinate and a way to make a point.
///
/// `n` samples in the statistical laws. ∫ p = 1 to `integral` by product quadrature in the
/// marginals' quantiles, for up to three coordinates.
pub(crate) fn check_points<P: AsRef<[f64]> + Clone + PartialEq + std::fmt::Debug>(
    p: &dyn Technique<Point = P>,
    marginals: &[&dyn InverseCdf],
    make: &dyn Fn(&[f64]) -> P,
    n: usize,
    integral: f64,
) {
    let dimension = p.dimension();
    let mut xis = canonical_numbers(2, 2000 * dimension);
    for edge in [0.0, 2f64.powi(-54), 0.5, 1.0 - 2f64.powi(-53), 1.0] {
        xis.extend(std::iter::repeat_n(edge, dimension));
    }
    for xi in xis.chunks_exact(dimension) {
        let x = p.sample(xi);
        assert_eq!(x.as_ref().len(), marginals.len());
        assert!(p.point_len().is_none_or(|len| len == marginals.len()));
        for (x, marginal) in x.as_ref().iter().zip(marginals) {
            let (a, b) = marginal.support();
            assert!(x.is_finite() && a <= *x && *x <= b, "sample {x:?}");
        }
        let (pdf, ln_pdf) = (p.pdf(&x), p.ln_pdf(&x));
        assert!(ln_pdf.is_finite(), "ln_pdf({x:?}) = {ln_pdf}");
        assert!(pdf.is_finite() && (pdf > 0.0 || ln_pdf < -700.0), "pdf({x:?}) = {pdf}");
        let miss = (ln_pdf - pdf.ln()).abs();
        let bound = 8.0 * marginals.len() as f64 * f64::EPSILON * ln_pdf.abs().max(1.0);
        assert!(miss <= bound || !pdf.is_normal(), "ln_pdf({x:?}) is off by {miss:e}");
        let mut over = make(&vec![7.0; marginals.len()]);
        p.sample_into(xi, &mut over);
        assert_eq!(over, x, "sample_into");
    }
    outside(p, marginals, make);
    batches(p, &xis, &make(&vec![7.0; marginals.len()]));
    if marginals.len() <= 3 {
        let total = total_mass(p, marginals, make);
        assert!((total - 1.0).abs() <= integral, "∫ p - 1 = {:e}", total - 1.0);
    }
    let xis = canonical_numbers(3, n * dimension);
    let xs: Vec<P> = xis.chunks_exact(dimension).map(|xi| p.sample(xi)).collect();
    let edges: Vec<f64> = (1..32).map(|k| f64::from(k) / 32.0).collect();
    for (d, marginal) in marginals.iter().enumerate() {
        let mut ranks: Vec<f64> = xs.iter().map(|x| marginal.cdf(x.as_ref()[d])).collect();
        chi_squared(
            &[1.0 / 32.0; 32],
            ranks.iter().map(|u| edges.partition_point(|edge| edge <= u)),
        );
        kolmogorov(&mut ranks);
    }
}

/// One coordinate outside its support, or NaN, is no density.
fn outside<P>(
    p: &dyn Technique<Point = P>,
    marginals: &[&dyn InverseCdf],
    make: &dyn Fn(&[f64]) -> P,
) {
    let centre: Vec<f64> = marginals.iter().map(|m| m.inverse_cdf(0.5)).collect();
    for (d, marginal) in marginals.iter().enumerate() {
        let (a, b) = marginal.support();
        for edge in [a.next_down(), b.next_up()] {
            let mut x = centre.clone();
            x[d] = edge;
            assert_eq!(p.pdf(&make(&x)), 0.0, "pdf({x:?})");
            assert_eq!(p.ln_pdf(&make(&x)), f64::NEG_INFINITY, "ln_pdf({x:?})");
        }
        let mut x = centre.clone();
        x[d] = f64::NAN;
        let pdf = p.pdf(&make(&x));
        assert!(pdf.is_nan() || pdf == 0.0, "pdf({x:?}) = {pdf}");
    }
}

fn batches<P: Clone + PartialEq + std::fmt::Debug>(
    p: &dyn Technique<Point = P>,
    xis: &[f64],
    filler: &P,
) {
    let rows = xis.len() / p.dimension();
    for held in [0, rows / 2, rows + 3] {
        let mut xs = vec![filler.clone(); held];
        p.sample_batch(xis, &mut xs);
        assert_eq!(xs.len(), rows);
        let mut pdfs = vec![0.0; rows];
        p.pdf_batch(&xs, &mut pdfs);
        for ((xi, x), pdf) in xis.chunks_exact(p.dimension()).zip(&xs).zip(&pdfs) {
            assert_eq!(*x, p.sample(xi), "batch and scalar at {xi:?}");
            assert_eq!(pdf.to_bits(), p.pdf(x).to_bits(), "batch and scalar pdf at {x:?}");
        }
    }
}

/// ∫ p dx = ∫ p(x(u)) / Π m_d(x_d(u_d)) du, x_d the quantile of the marginal m_d.
fn total_mass<P>(
    p: &dyn Technique<Point = P>,
    marginals: &[&dyn InverseCdf],
    make: &dyn Fn(&[f64]) -> P,
) -> f64 {
    let rule = gauss(8);
    let mut total = 0.0;
    for k in 0..rule.len().pow(u32::try_from(marginals.len()).unwrap_or(0)) {
        let mut index = k;
        let mut weight = 1.0;
        let mut x = Vec::with_capacity(marginals.len());
        for marginal in marginals {
            let (u, w) = rule[index % rule.len()];
            index /= rule.len();
            x.push(marginal.inverse_cdf(u));
            weight *= w / marginal.pdf(&x[x.len() - 1]);
        }
        total += weight * p.pdf(&make(&x));
    }
    total
}
