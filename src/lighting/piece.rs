//! A rectangle in front of the origin whose coordinates do not change sign.
//!
//! Everything here is a sum, product or quotient of positive numbers.

use std::f64::consts::TAU;

use glam::DVec3;

use super::turn::sin_cos_of_turn;

/// An interval on an axis, with its width as given: `high - low` has lost it to rounding where
/// the interval is narrow and far out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
    width: f64,
    /// -1 for the mirror image of an interval on the negative side.
    sign: f64,
}

impl Interval {
    pub(super) fn around(centre: f64, half: f64) -> Self {
        Self { low: centre - half, high: centre + half, width: 2.0 * half, sign: 1.0 }
    }

    /// One or two intervals on the positive side that make up this one, with their signs.
    pub(super) fn same_signed(self) -> impl Iterator<Item = Self> {
        let Self { low, high, width, .. } = self;
        let (first, second) = if low >= 0.0 {
            (Some(self), None)
        } else if high <= 0.0 {
            (Some(Self { low: -high, high: -low, width, sign: -1.0 }), None)
        } else {
            (
                Some(Self { low: 0.0, high: -low, width: -low, sign: -1.0 }),
                Some(Self { low: 0.0, high, width: high, sign: 1.0 }),
            )
        };
        first.into_iter().chain(second)
    }

    /// The smallest magnitude in the interval.
    pub(super) fn nearest(self) -> f64 {
        self.low.max(-self.high).max(0.0)
    }

    /// The largest magnitude in the interval.
    pub(super) fn farthest(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }
}

/// The rectangle x × y at the height h, all coordinates at least 0, mirrored by the signs.
///
/// Solid angles are of right-angled pieces: with b = y / √(h² + y²) and c = x / √(h² + x²), that
/// of \[0, x\] × \[0, y\] is asin(b c). Hence A = asin(b₁ c) - asin(b₀ c) for \[0, x\] × \[y₀,
/// y₁\]; solved for x, with B the solid angle of \[x, ∞) × \[y₀, y₁\] and γ = atan(h / y₁),
///
/// x = h sin A / (2 √(sin(B/2) sin(A + B/2) sin(γ + B/2) sin(γ + A + B/2))).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    x: Interval,
    y: Interval,
    height: f64,
    /// The solid angles of \[0, x₀\], \[x₀, x₁\] and \[x₁, ∞), each times \[y₀, y₁\].
    before: f64,
    within: f64,
    beyond: f64,
    /// The sine and the cosine of γ = atan(h / y₁).
    gamma: (f64, f64),
}

impl Piece {
    pub(super) fn new(x: Interval, y: Interval, height: f64) -> Self {
        let start = Interval { low: 0.0, high: x.low, width: x.low, sign: 1.0 };
        let (a, b) = (DVec3::new(x.high, y.low, height), DVec3::new(x.high, y.high, height));
        let (la, lb) = (a.length(), b.length());
        let beyond = 2.0 * (height * y.width).atan2(la * lb + a.dot(b) + x.high * (la + lb));
        Self {
            x,
            y,
            height,
            before: if x.low == 0.0 { 0.0 } else { solid_angle(start, y, height) },
            within: solid_angle(x, y, height),
            beyond,
            gamma: {
                let length = (height * height + y.high * y.high).sqrt();
                (height / length, y.high / length)
            },
        }
    }

    pub(super) fn solid_angle(&self) -> f64 {
        self.within
    }

    /// The point of the rectangle that (ξ₀, ξ₁) map to: x by the solid angle left of it, then y,
    /// whose density given x is proportional to (x² + h² + y²)^(-3/2).
    #[inline(always)]
    pub(super) fn point(&self, xi0: f64, xi1: f64) -> DVec3 {
        let h = self.height;
        let a = self.before + xi0 * self.within;
        let half_b = 0.5 * (self.beyond + (1.0 - xi0) * self.within);
        // All these angles are at most 90°: every product is positive.
        let (sin_a, cos_a) = sin_cos(a);
        let (sin_b, cos_b) = sin_cos(half_b);
        let (sin_gamma, cos_gamma) = self.gamma;
        let (sin_ab, cos_ab) = (sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b);
        let sin_gamma_b = sin_gamma * cos_b + cos_gamma * sin_b;
        let sin_gamma_ab = sin_gamma * cos_ab + cos_gamma * sin_ab;
        // The product of the first two would underflow for a solid angle below 1e-162.
        let product = sin_b.sqrt() * sin_ab.sqrt() * (sin_gamma_b * sin_gamma_ab).sqrt();
        let x = (0.5 * h * sin_a / product).clamp(self.x.low, self.x.high);

        // sin β = y / √(d² + y²) is uniform; both it and 1 - sin β are kept, for 1 - sin² β.
        let d2 = x * x + h * h;
        let (sin0, rest0) = sin_and_rest(self.y.low, d2);
        let (sin1, rest1) = sin_and_rest(self.y.high, d2);
        let d = d2.sqrt();
        let sin = sin0 + xi1 * (sin1 - sin0);
        let rest = rest1 + (1.0 - xi1) * (rest0 - rest1);
        let y = (d * sin / (rest * (2.0 - rest)).sqrt()).clamp(self.y.low, self.y.high);
        DVec3::new(self.x.sign * x, self.y.sign * y, h)
    }
}

/// y / √(d² + y²), and 1 less that.
#[inline(always)]
fn sin_and_rest(y: f64, d2: f64) -> (f64, f64) {
    let length = (d2 + y * y).sqrt();
    let inverse = (length * (length + y)).recip();
    (y * (length + y) * inverse, d2 * inverse)
}

/// The sine and the cosine of an angle in radians.
#[inline(always)]
fn sin_cos(angle: f64) -> (f64, f64) {
    sin_cos_of_turn(angle * TAU.recip())
}

/// The solid angle of x × y at the height h, from two triangles, each by the formula of
/// A. Van Oosterom and J. Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on
/// Biomedical Engineering 30(2), 1983.
pub(super) fn solid_angle(x: Interval, y: Interval, h: f64) -> f64 {
    let [a, b, c, d] = [(x.low, y.low), (x.high, y.low), (x.high, y.high), (x.low, y.high)]
        .map(|(x, y)| DVec3::new(x, y, h));
    let determinant = h * x.width * y.width;
    let [la, lb, lc, ld] = [a, b, c, d].map(DVec3::length);
    let ac = a.dot(c);
    let abc = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + ac * lb;
    let acd = la * lc * ld + ac * ld + c.dot(d) * la + d.dot(a) * lc;
    // Both at once, by the arctangent of a sum; scaled, for squares may leave the range.
    let (p, q) = (determinant / abc, determinant / acd);
    2.0 * (p + q).atan2(1.0 - p * q)
}

#[cfg(test)]
mod tests {
    use super::{Interval, Piece};

    fn interval(low: f64, high: f64) -> Interval {
        Interval { low, high, width: high - low, sign: 1.0 }
    }

    #[test]
    fn x_inverts_the_solid_angle_over_many_decades() {
        let mut worst = 0.0_f64;
        for h in [1e-12, 1e-6, 1.0, 1e6, 1e12] {
            for x0 in [0.0, 1e-9, 1.0, 1e5] {
                for y0 in [0.0, 1e-9, 1.0, 1e5] {
                    for w in [1e-6, 1.0, 1e12] {
                        let y = interval(y0, y0 + w);
                        let whole = Piece::new(interval(x0, x0 + w), y, h);
                        for xi in [0.1, 0.5, 0.9] {
                            let x = whole.point(xi, 0.5).x;
                            let part = Piece::new(interval(x0, x), y, h).within;
                            // x itself is rounded: to 1 part in (x - x0) / (x ε).
                            let rounding = 1e-15 * (1.0 + x / (x - x0));
                            let error = (part / (xi * whole.within) - 1.0).abs() / rounding;
                            worst = worst.max(error);
                        }
                    }
                }
            }
        }
        assert!(worst < 8.0, "{worst}");
    }

    #[test]
    fn y_halves_the_strip_for_any_x() {
        // A strip that is narrow in x: the median of y splits its solid angle in two.
        for (h, y0, y1) in [(1.0, 0.0, 1.0), (1e-9, 1.0, 2.0), (1.0, 1e6, 2e6), (1.0, 0.0, 1e12)] {
            let x = Interval { low: 1.0, high: 1.0, width: 1e-9, sign: 1.0 };
            let whole = Piece::new(x, interval(y0, y1), h);
            let at = whole.point(0.5, 0.5);
            let y = at.y;
            assert_eq!(at.x, 1.0);
            let turned = Piece::new(interval(y0, y1), x, h);
            assert_eq!(turned.point(0.5, 0.5).y, 1.0);
            let part = Piece::new(x, interval(y0, y), h).within;
            assert!((part / whole.within - 0.5).abs() < 1e-15 * (1.0 + y / (y - y0)), "{h} {y}");
        }
    }

    #[test]
    fn a_straddling_interval_is_cut_at_zero() {
        let cut: Vec<_> = Interval::around(1.0, 3.0).same_signed().collect();
        assert_eq!(cut.len(), 2);
        assert_eq!((cut[0].sign, cut[0].high, cut[1].sign, cut[1].high), (-1.0, 2.0, 1.0, 4.0));
        let far: Vec<_> = Interval::around(-1e9, 1e-9).same_signed().collect();
        assert_eq!((far.len(), far[0].width, far[0].sign), (1, 2e-9, -1.0));
    }
}
