//! Loops written by hand for one integrand alone, to compare with.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Dxsm;
use wide::f64x4;

#[inline(never)]
fn f(x: f64) -> f64 {
    x.sin() * x.cos()
}

#[inline(never)]
fn p1(x: f64) -> f64 {
    x.cos()
}

#[inline(never)]
fn p2(x: f64) -> f64 {
    x.sin()
}

/// The two inverse CDFs.
pub(crate) fn sample(technique: u64, xi: f64) -> f64 {
    if technique == 0 { xi.asin() } else { 2.0 * (xi / 2.0).sqrt().asin() }
}

/// (sin x, cos x) at the x that ξ maps to, without x.
#[inline]
pub(crate) fn algebraic(technique: u64, xi: f64) -> (f64, f64) {
    if technique == 0 { (xi, (1.0 - xi * xi).sqrt()) } else { ((xi * (2.0 - xi)).sqrt(), 1.0 - xi) }
}

fn uniform(generator: &mut Pcg64Dxsm) -> f64 {
    f64::from_bits(generator.next_u64() >> 12 | 1_f64.to_bits()) - (1.0 - f64::EPSILON / 2.0)
}

/// The balance estimate by a plain loop; `contribution` is f/c.
fn plain(n: u64, contribution: impl Fn(u64, f64, f64) -> f64) -> f64 {
    let mut value = 0.0;
    let mut variance = 0.0;
    let per_technique = (n / 2) as f64;
    for technique in 0..2_u64 {
        let mut generator = Pcg64Dxsm::seed_from_u64(technique);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n / 2 {
            let y = contribution(technique, uniform(&mut generator), per_technique);
            sum += y;
            squares += y * y;
        }
        value += sum;
        variance += squares - sum * sum / per_technique;
    }
    value + variance
}

pub(crate) fn separate(n: u64) -> f64 {
    plain(n, |technique, xi, n| {
        let x = sample(technique, xi);
        f(x) / (n * p1(x) + n * p2(x))
    })
}

pub(crate) fn shared(n: u64) -> f64 {
    plain(n, |technique, xi, n| {
        let (sin, cos) = sample(technique, xi).sin_cos();
        sin * cos / (n * cos + n * sin)
    })
}

pub(crate) fn without_angles(n: u64) -> f64 {
    plain(n, |technique, xi, n| {
        let (sin, cos) = algebraic(technique, xi);
        sin * cos / (n * cos + n * sin)
    })
}

/// The same, four samples at a time.
pub(crate) fn in_lanes(n: u64) -> f64 {
    let (mut value, mut variance) = (0.0, 0.0);
    let per_technique = f64x4::splat((n / 2) as f64);
    let one = f64x4::ONE;
    for technique in 0..2_u64 {
        let mut generator = Pcg64Dxsm::seed_from_u64(technique);
        let (mut sum, mut squares) = (f64x4::ZERO, f64x4::ZERO);
        for _ in 0..n / 8 {
            let xi = f64x4::new(std::array::from_fn(|_| uniform(&mut generator)));
            let (sin, cos) = if technique == 0 {
                (xi, (one - xi * xi).sqrt())
            } else {
                ((xi * (f64x4::splat(2.0) - xi)).sqrt(), one - xi)
            };
            let y = sin * cos / (per_technique * cos + per_technique * sin);
            sum += y;
            squares += y * y;
        }
        let (sum, squares) = (sum.reduce_add(), squares.reduce_add());
        value += sum;
        variance += squares - sum * sum / (n / 2) as f64;
    }
    value + variance
}
