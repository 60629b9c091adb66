//! The laws of [`InverseCdf`], checked for one technique.

use super::quadrature::integral;
use mis::technique::{InverseCdf, canonical};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// The tolerances, and what is known about the technique.
#[derive(Debug, Clone)]
pub(crate) struct LawOptions {
    /// |∫ p - 1|, and every mass between two points.
    pub(crate) integral: f64,
    /// |cdf(inverse_cdf(u)) - u|, in ULP of max(u, 1 - u).
    pub(crate) round_trip: f64,
    /// The same relative to u, in the tails.
    pub(crate) tail: f64,
    /// |ln_pdf - ln pdf|, in units of 2^-52 max(1, |ln p|).
    pub(crate) ln_pdf: f64,
    /// The smallest u that has a tail law; set it where x(u) leaves the range of f64.
    pub(crate) tail_from: f64,
    /// Where the density jumps or has a kink.
    pub(crate) splits: Vec<f64>,
    /// Whether the support holds enough numbers for histograms and quadrature.
    pub(crate) resolved: bool,
    /// The seed of the random u.
    pub(crate) seed: u64,
}

impl Default for LawOptions {
    fn default() -> Self {
        Self {
            integral: 1e-10,
            round_trip: 4.0,
            tail: 1e-12,
            ln_pdf: 8.0,
            tail_from: 1e-300,
            splits: Vec::new(),
            resolved: true,
            seed: 1,
        }
    }
}

/// Every law, with `n` samples in the statistical ones.
pub(crate) fn check(p: &dyn InverseCdf, n: usize, options: &LawOptions) {
    let us = canonical_numbers(options.seed, 2000);
    ends(p);
    round_trip(p, &us, options);
    tails(p, options);
    monotone(p, &us, options);
    samples(p, &us, options);
    batches(p, &us);
    if options.resolved {
        mass(p, &us, options);
        statistics(p, n, options);
    }
}

/// `n` numbers uniform in the open unit interval, from a fixed stream.
pub(crate) fn canonical_numbers(seed: u64, n: usize) -> Vec<f64> {
    let mut stream = Pcg64Dxsm::seed_from_u64(seed);
    (0..n).map(|_| ((stream.next_u64() >> 12) as f64 + 0.5) * 2f64.powi(-52)).collect()
}

/// The distance to the next larger number of the magnitude of `x`.
pub(crate) fn ulp(x: f64) -> f64 {
    let x = x.abs().min(f64::MAX.next_down());
    x.next_up() - x
}

fn ends(p: &dyn InverseCdf) {
    let (a, b) = p.support();
    assert!(a < b, "support [{a}, {b}]");
    assert_eq!((p.inverse_cdf(0.0), p.inverse_cdf(1.0)), (a, b));
    assert_eq!((p.inverse_survival(1.0), p.inverse_survival(0.0)), (a, b));
    assert_eq!((p.cdf(a), p.cdf(b)), (0.0, 1.0), "cdf at the ends");
    assert_eq!((p.survival(a), p.survival(b)), (1.0, 0.0), "survival at the ends");
    for u in [-5e-324, -1.0, 1.0 + f64::EPSILON, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        assert!(p.inverse_cdf(u).is_nan(), "inverse_cdf({u:?})");
        assert!(p.inverse_survival(u).is_nan(), "inverse_survival({u:?})");
    }
    for (outside, mass) in
        [(a.next_down(), 0.0), (f64::NEG_INFINITY, 0.0), (b.next_up(), 1.0), (f64::INFINITY, 1.0)]
    {
        assert_eq!(p.pdf(&outside), 0.0, "pdf({outside:?})");
        assert_eq!(p.ln_pdf(&outside), f64::NEG_INFINITY, "ln_pdf({outside:?})");
        assert_eq!(p.cdf(outside), mass, "cdf({outside:?})");
        assert_eq!(p.survival(outside), 1.0 - mass, "survival({outside:?})");
    }
    // No panic, and not a density.
    let pdf = p.pdf(&f64::NAN);
    assert!(pdf.is_nan() || pdf == 0.0);
    let ln_pdf = p.ln_pdf(&f64::NAN);
    assert!(ln_pdf.is_nan() || ln_pdf == f64::NEG_INFINITY);
    let _ = (p.cdf(f64::NAN), p.survival(f64::NAN), p.sample(&[]), p.sample(&[f64::NAN]));
}

fn round_trip(p: &dyn InverseCdf, us: &[f64], options: &LawOptions) {
    let (a, b) = p.support();
    let grid = (1..1024).map(|k| f64::from(k) / 1024.0);
    for u in grid.chain(us.iter().copied()) {
        if u < options.tail_from || 1.0 - u < options.tail_from {
            continue;
        }
        let bound = options.round_trip * ulp(u.max(1.0 - u));
        let x = p.inverse_cdf(u);
        assert!(a <= x && x <= b, "inverse_cdf({u}) = {x}");
        let miss = (p.cdf(x) - u).abs();
        assert!(miss <= bound + grain(p, x), "cdf(inverse_cdf({u})) misses by {miss:e}, x = {x:?}");
        let miss = (p.cdf(x) + p.survival(x) - 1.0).abs();
        assert!(miss <= options.round_trip * f64::EPSILON, "cdf + survival at {x:?}: {miss:e}");
        let x = p.inverse_survival(u);
        assert!(a <= x && x <= b, "inverse_survival({u}) = {x}");
        let miss = (p.survival(x) - u).abs();
        assert!(miss <= bound + grain(p, x), "survival(inverse_survival({u})) misses by {miss:e}");
    }
}

/// The change of the CDF over the spacing of f64 at `x`: no inverse can do better.
fn grain(p: &dyn InverseCdf, x: f64) -> f64 {
    let (a, b) = p.support();
    let pdf = |x: f64| p.pdf(&x.clamp(a, b));
    ulp(x) * pdf(x).max(pdf(x.next_up())).max(pdf(x.next_down()))
}

fn tails(p: &dyn InverseCdf, options: &LawOptions) {
    let exponents = [3.0, 3.7, 5.0, 8.3, 12.0, 17.1, 25.0, 40.0, 80.0, 150.0, 230.5, 300.0];
    for v in exponents.map(|e: f64| 10f64.powf(-e)) {
        if v < options.tail_from {
            continue;
        }
        let x = p.inverse_cdf(v);
        let miss = (p.cdf(x) - v).abs();
        assert!(
            miss <= options.tail * v + grain(p, x),
            "lower tail at {v:e}: x = {x:?}, cdf misses by {:e} of it",
            miss / v
        );
        let x = p.inverse_survival(v);
        let miss = (p.survival(x) - v).abs();
        assert!(
            miss <= options.tail * v + grain(p, x),
            "upper tail at {v:e}: x = {x:?}, survival misses by {:e} of it",
            miss / v
        );
    }
}

/// To rounding: neighbouring numbers may swap by the error of the round trip.
fn monotone(p: &dyn InverseCdf, us: &[f64], options: &LawOptions) {
    let mut sorted = us.to_vec();
    sorted.extend((1..=53).map(|k| 2f64.powi(-k)));
    sorted.extend((1..=53).map(|k| 1.0 - 2f64.powi(-k)));
    sorted.sort_by(f64::total_cmp);
    for pair in sorted.windows(2) {
        let (x, y) = (p.inverse_cdf(pair[0]), p.inverse_cdf(pair[1]));
        assert!(x <= y, "inverse_cdf decreases between {} and {}", pair[0], pair[1]);
        let (low, high) = (p.cdf(x), p.cdf(y));
        let slack = options.round_trip * ulp(low);
        assert!(low <= high + slack, "cdf decreases between {x:?} and {y:?}");
        let (high, low) = (p.survival(x), p.survival(y));
        let slack = options.round_trip * ulp(high);
        assert!(low <= high + slack, "survival grows between {x:?} and {y:?}");
    }
}

fn samples(p: &dyn InverseCdf, us: &[f64], options: &LawOptions) {
    let (a, b) = p.support();
    let edges = [0.0, 2f64.powi(-54), 0.5, 1.0 - 2f64.powi(-53), 1.0];
    for &u in edges.iter().chain(us) {
        let x = p.sample(&[u]);
        assert!(x.is_finite() && a <= x && x <= b, "sample({u}) = {x}");
        assert_eq!(x, p.inverse_cdf(canonical(&[u], 0)), "sample({u}) is the inverse CDF");
        let (pdf, ln_pdf) = (p.pdf(&x), p.ln_pdf(&x));
        assert!(pdf.is_finite() && pdf > 0.0, "pdf(sample({u})) = {pdf}, x = {x:?}");
        assert!(ln_pdf.is_finite(), "ln_pdf(sample({u})) = {ln_pdf}");
        let miss = (ln_pdf - pdf.ln()).abs();
        let bound = options.ln_pdf * f64::EPSILON * ln_pdf.abs().max(1.0);
        assert!(miss <= bound || pdf.is_subnormal(), "ln_pdf({x:?}) is {ln_pdf}, off by {miss:e}");
    }
}

fn batches(p: &dyn InverseCdf, us: &[f64]) {
    for held in [0, us.len() / 2, us.len() + 3] {
        let mut xs = vec![7.0; held];
        p.sample_batch(us, &mut xs);
        assert_eq!(xs.len(), us.len());
        let mut pdfs = vec![0.0; xs.len()];
        p.pdf_batch(&xs, &mut pdfs);
        for ((u, x), pdf) in us.iter().zip(&xs).zip(&pdfs) {
            assert_eq!(x.to_bits(), p.sample(&[*u]).to_bits(), "batch and scalar at {u}");
            assert_eq!(pdf.to_bits(), p.pdf(x).to_bits(), "batch and scalar pdf at {x:?}");
        }
    }
}

/// ∫ p between `lower` and `upper`, split where the mass halves and where the density jumps.
fn quadrature_mass(p: &dyn InverseCdf, lower: f64, upper: f64, splits: &[f64]) -> f64 {
    let f = |x: f64| p.pdf(&x);
    let centre = p.inverse_cdf(0.5);
    let mut cuts = vec![lower, upper];
    let inner = splits.iter().copied();
    cuts.extend(inner.filter(|x| lower < *x && *x < upper));
    cuts.sort_by(f64::total_cmp);
    let pieces = cuts.windows(2);
    pieces
        .map(|cut| {
            let scale = (cut[0].max(-f64::MAX) - centre).abs();
            let scale = scale.min((cut[1].min(f64::MAX) - centre).abs());
            integral(&f, cut[0], cut[1], scale)
        })
        .sum()
}

const TAIL: [f64; 4] = [1e-25, 1e-12, 1e-6, 1e-3];

/// Where quadrature starts anew: quantiles, and the splits that the options name.
fn splits(p: &dyn InverseCdf, options: &LawOptions) -> Vec<f64> {
    let mut splits: Vec<f64> = (1..32).map(|k| p.inverse_cdf(f64::from(k) / 32.0)).collect();
    splits.extend(TAIL.map(|v| p.inverse_cdf(v)));
    splits.extend(TAIL.map(|v| p.inverse_survival(v)));
    splits.extend(&options.splits);
    splits.sort_by(f64::total_cmp);
    splits.dedup();
    splits
}

fn mass(p: &dyn InverseCdf, us: &[f64], options: &LawOptions) {
    let (a, b) = p.support();
    let splits = splits(p, options);

    let total = quadrature_mass(p, a, b, &splits);
    assert!((total - 1.0).abs() <= options.integral, "∫ p - 1 = {:e}", total - 1.0);
    for pair in us[..100].chunks_exact(2) {
        let (x, y) = (p.inverse_cdf(pair[0]), p.inverse_cdf(pair[1]));
        let (x, y) = (x.min(y), x.max(y));
        let mass = quadrature_mass(p, x, y, &splits);
        let miss = (p.cdf(y) - p.cdf(x) - mass).abs();
        let bound = options.integral + grain(p, x) + grain(p, y);
        assert!(miss <= bound, "∫ p over [{x:?}, {y:?}] and the cdf differ by {miss:e}");
    }
    for v in TAIL {
        if v < options.tail_from {
            continue;
        }
        let (x, y) = (p.inverse_cdf(v), p.inverse_survival(v));
        let below = quadrature_mass(p, a, x, &splits);
        let above = quadrature_mass(p, y, b, &splits);
        let bound = 100.0 * options.integral.max(options.tail) * v;
        let miss = (p.cdf(x) - below).abs();
        assert!(miss <= bound + 2.0 * grain(p, x), "mass below {x:?}: {below:e}, off by {miss:e}");
        let miss = (p.survival(y) - above).abs();
        assert!(miss <= bound + 2.0 * grain(p, y), "mass above {y:?}: {above:e}, off by {miss:e}");
    }
}

fn statistics(p: &dyn InverseCdf, n: usize, options: &LawOptions) {
    const BINS: usize = 32;
    let (a, b) = p.support();
    let us = canonical_numbers(options.seed ^ 0x5EED, n);
    let xs: Vec<f64> = us.iter().map(|u| p.sample(&[*u])).collect();

    let inner: Vec<f64> = (1..BINS).map(|k| p.inverse_cdf(k as f64 / BINS as f64)).collect();
    let edges: Vec<f64> = std::iter::once(a).chain(inner.iter().copied()).chain([b]).collect();
    let splits = splits(p, options);
    let masses: Vec<f64> =
        edges.windows(2).map(|cell| quadrature_mass(p, cell[0], cell[1], &splits)).collect();
    let cells = xs.iter().map(|x| {
        assert!(p.pdf(x) > 0.0, "a sample where the pdf is 0: {x:?}");
        inner.partition_point(|edge| edge <= x)
    });
    chi_squared(&masses, cells);

    let mut ranks: Vec<f64> = xs.iter().map(|x| p.cdf(*x)).collect();
    kolmogorov(&mut ranks);
}

/// Pearson's statistic of the counts per cell, as a standard score (Wilson and Hilferty's cube
/// root) within 5.
pub(crate) fn chi_squared(masses: &[f64], cells: impl Iterator<Item = usize>) {
    let mut counts = vec![0_u32; masses.len()];
    for cell in cells {
        counts[cell] += 1;
    }
    let n: f64 = counts.iter().map(|&k| f64::from(k)).sum();
    let mut statistic = 0.0;
    let mut freedom = -1.0;
    for (&count, mass) in counts.iter().zip(masses) {
        let expected = n * mass;
        assert!(expected > 0.0 || count == 0, "{count} samples in a cell without mass");
        if expected > 0.0 {
            statistic += (f64::from(count) - expected).powi(2) / expected;
            freedom += 1.0;
        }
    }
    let spread = 2.0 / (9.0 * freedom);
    let z = ((statistic / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
    assert!(z.abs() < 5.0, "chi squared {statistic} on {freedom} degrees of freedom: z = {z}");
}

/// Kolmogorov's distance between `ranks` and the uniform law, at the level 1e-5.
pub(crate) fn kolmogorov(ranks: &mut [f64]) {
    ranks.sort_by(f64::total_cmp);
    let n = ranks.len() as f64;
    let distance = ranks.iter().enumerate().fold(0.0_f64, |d, (k, u)| {
        let k = k as f64;
        d.max(u - k / n).max((k + 1.0) / n - u)
    });
    assert!(distance <= 2.47 / n.sqrt(), "Kolmogorov distance {distance} at n = {n}");
}
