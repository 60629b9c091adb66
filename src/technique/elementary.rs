//! Elementary functions without branches: loops over slices that call them compile to vector
//! instructions.
//!
//! Only additions, multiplications, divisions, square roots, comparisons and operations on bits
//! are used, none of them fused, so a number's bits depend neither on its place in a slice nor on
//! the target. Coefficients are of minimax approximations, fitted with 50 digits. Exponentials and
//! logarithms are within 1 ULP of those of `std`, quotients of [`tan_pi`] within 3,
//! [`normal_quantile`] within 5 of that of `statrs`.

use std::f64::consts::{LOG2_E, PI};

/// 1.5 · 2⁵²: what is added to it is rounded to an integer, which ends up in the lowest bits.
pub(crate) const SHIFT: f64 = 6_755_399_441_055_744.0;

/// ln 2 in two parts; products of the first with integers of 20 bits are exact.
const LN_2: [f64; 2] =
    [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];

/// [`f64::clamp`] without the branch of its check.
#[inline(always)]
pub(super) fn clamp(x: f64, low: f64, high: f64) -> f64 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

/// e^y; beyond the range of normal numbers a subnormal one, 0 or infinity.
#[inline(always)]
pub(super) fn exp(y: f64) -> f64 {
    times_exp(1.0, y)
}

/// c e^y for |y| <= 1417; no intermediate result leaves the range of normal numbers where c and
/// the product are in it.
///
/// e^y = 2^k e^r with |r| <= ln 2 / 2.
#[inline(always)]
pub(super) fn times_exp(c: f64, y: f64) -> f64 {
    // Beyond, 2^k is more than two factors hold. NaN stays NaN.
    let y = clamp(y, -1417.0, 1417.0);
    let shifted = y * LOG2_E + SHIFT;
    let k = shifted - SHIFT;
    let r = (y - k * LN_2[0]) - k * LN_2[1];
    let r2 = r * r;
    let r4 = r2 * r2;
    // Pairs of coefficients shorten the chain of operations that wait for each other.
    let low = (0.500_000_000_000_000_1 + r * 0.166_666_666_666_666_43)
        + r2 * (0.041_666_666_666_623_61 + r * 0.008_333_333_333_356_56);
    let high = (0.001_388_888_891_748_456_2 + r * 0.000_198_412_697_840_220_65)
        + r2 * (2.480_152_086_387_809_5e-5 + r * 2.755_735_575_390_77e-6);
    let top = 2.762_029_786_013_184e-7 + r * 2.506_824_795_454_329e-8;
    let excess = r + r2 * (low + r4 * (high + r4 * top));
    // 2^k in two factors: it may leave the range. Twice the bias of exponents keeps k + 2046
    // positive.
    let biased = shifted.to_bits().wrapping_sub(SHIFT.to_bits() - 2046);
    let first = biased >> 1;
    let second = biased.wrapping_sub(first);
    let scaled = c * f64::from_bits(first << 52);
    (scaled + scaled * excess) * f64::from_bits(second << 52)
}

/// ln(s + c), where s is a positive normal number and c at most a rounding error of s.
///
/// s + c = 2^k (1 + f) with √½ <= 1 + f < √2, and ln(1 + f) = f - t (f - R) with
/// t = f / (2 + f), 2 t + t R the series of 2 artanh t.
#[inline(always)]
pub(super) fn ln_sum(s: f64, c: f64) -> f64 {
    const ROOT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;
    const MANTISSA: u64 = (1 << 52) - 1;
    const TWO_52: u64 = 0x4330_0000_0000_0000;
    let shifted = s.to_bits().wrapping_add(1_f64.to_bits() - ROOT_HALF);
    let biased = shifted >> 52;
    let k = f64::from_bits(biased | TWO_52) - (f64::from_bits(TWO_52) + 1023.0);
    let m = f64::from_bits((shifted & MANTISSA) + ROOT_HALF);
    let scale = f64::from_bits(2046_u64.wrapping_sub(biased) << 52);
    let f = (m - 1.0) + c * scale;
    let t = f / (2.0 + f);
    let t2 = t * t;
    let t4 = t2 * t2;
    let even = 0.666_666_666_666_667
        + t4 * (0.285_714_286_289_570_6
            + t4 * (0.181_829_238_937_804_5 + t4 * 0.146_305_004_755_642_7));
    let odd =
        0.399_999_999_998_928_5 + t4 * (0.222_222_106_531_151_4 + t4 * 0.153_305_757_491_568_6);
    let series = t2 * (even + t2 * odd);
    k * LN_2[0] + (f - (t * (f - series) - k * LN_2[1]))
}

/// Numbers whose quotient is tan(π v), for |v| <= 1/4.
#[inline(always)]
pub(crate) fn tan_pi(v: f64) -> [f64; 2] {
    let v2 = v * v;
    let sine = v
        * (PI
            + v2 * (-3.977_592_998_685_887_4
                + v2 * (0.858_666_459_368_745_9 + v2 * -0.022_602_795_257_554_44)));
    let cosine = 1.0
        + v2 * (-4.555_975_308_393_572
            + v2 * (2.274_001_203_402_950_6 + v2 * -0.200_399_806_980_494_63));
    [sine, cosine]
}

/// Below this 4 Φ (1 - Φ), [`normal_quantile`] does not hold.
pub(super) const NORMAL_TAIL: f64 = 0.006_737_946_999_085_467;

/// The z with the mass Φ of the standard normal density below it, given `difference` = Φ - (1 - Φ)
/// and `product` = 4 Φ (1 - Φ), at least [`NORMAL_TAIL`].
///
/// A rational function of w = -ln(1 - difference²) approximates z / difference, as in M. Giles,
/// *Approximating the erfinv function*, GPU Computing Gems Jade Edition, 2012, pages 109-116,
/// where it is a polynomial.
#[inline(always)]
pub(super) fn normal_quantile(difference: f64, product: f64) -> f64 {
    let w = -ln_sum(product, 0.0);
    let w2 = w * w;
    let w4 = w2 * w2;
    let p = (1.253_314_137_315_500_3 + w * 0.494_306_817_895_235_8)
        + w2 * (0.132_100_679_651_623_57 + w * 0.025_433_195_594_374_987)
        + w4 * ((0.003_620_812_514_673_808 + w * 0.000_389_880_906_233_439_1)
            + w2 * (3.091_596_256_682_324e-5 + w * 1.645_423_941_274_532_5e-6)
            + w4 * 4.542_852_996_011_359e-8);
    let q = (1.0 + w * 0.132_600_390_499_053_36)
        + w2 * (0.057_654_354_761_355_34 + w * 0.006_105_706_173_207_858)
        + w4 * ((0.001_033_034_091_299_297_3 + w * 7.953_769_494_899_674e-5)
            + w2 * (5.546_211_299_468_485e-6 + w * 2.363_658_438_017_668_3e-7)
            + w4 * 1.951_766_770_520_585_5e-9);
    difference * (p / q)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest difference in units of 2⁻⁵² of the second, at 2e5 points of [a, b].
    fn worst(a: f64, b: f64, pair: impl Fn(f64) -> (f64, f64)) -> f64 {
        let at = |k: u32| a + (b - a) * f64::from(k) / 2e5;
        let off = |(y, exact): (f64, f64)| (y - exact).abs() / exact.abs() / f64::EPSILON;
        (0..=200_000).map(|k| off(pair(at(k)))).fold(0.0, f64::max)
    }

    #[test]
    fn exponentials_to_an_ulp() {
        for (a, b) in [(-1.0, 1.0), (-40.0, 0.0), (-708.0, 709.0), (-1e-9, 1e-9)] {
            let worst = worst(a, b, |y| (exp(y), y.exp()));
            assert!(worst <= 1.0, "{worst} in [{a}, {b}]");
        }
        for (y, expected) in [
            (0.0, 1.0),
            (f64::NEG_INFINITY, 0.0),
            (-1e9, 0.0),
            (-746.0, 0.0),
            (710.0, f64::INFINITY),
            (1e300, f64::INFINITY),
        ] {
            assert_eq!(exp(y), expected, "{y}");
        }
        assert!(exp(f64::NAN).is_nan());
        for y in [-744.0_f64, -730.5, -710.0] {
            assert!((exp(y) - y.exp()).abs() <= 5e-324, "{y}"); // subnormal
        }
        // e^y overflows, and underflows, but the product does not.
        assert!((times_exp(1e-300, 1380.0) / 2.120_240_014_296_853e299 - 1.0).abs() < 1e-12);
        assert!((times_exp(1e300, -1380.0) / 4.716_447_162_854_039e-300 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn logarithms_to_an_ulp() {
        for (a, b) in [(1e-3, 1.0), (0.5, 2.0), (0.999, 1.001), (1e-300, 1e-299), (1e300, 1e308)] {
            let worst = worst(a, b, |s| (ln_sum(s, 0.0), s.ln()));
            assert!(worst <= 1.0, "{worst} in [{a}, {b}]");
        }
        // With what the sum has lost, ln(1 + y) keeps its relative precision.
        for scale in [1.0, 1e-3, 1e-10, 1e-300] {
            let worst = worst(-0.7 * scale, 0.9 * scale, |y| {
                let s = 1.0 + y;
                let y = if y == 0.0 { 1e-20 } else { y };
                (ln_sum(s, y - (s - 1.0)), y.ln_1p())
            });
            assert!(worst <= 1.5, "{worst} at {scale}");
        }
    }

    #[test]
    fn tangents_to_two_ulp() {
        let worst = worst(1e-20, 0.25, |v| {
            let [sine, cosine] = tan_pi(v);
            (sine / cosine, (PI * v).tan())
        });
        assert!(worst <= 3.0, "{worst}"); // of which π v has one and more
        assert_eq!(tan_pi(0.0)[0], 0.0);
    }

    #[test]
    fn quantiles_to_a_few_ulp() {
        use super::super::normal_tail::inverse_upper_tail;
        let worst = worst(0.001_688, 0.498, |u| {
            (normal_quantile(2.0 * u - 1.0, 4.0 * u * (1.0 - u)), -inverse_upper_tail(u))
        });
        assert!(worst <= 5.0, "{worst}");
        // SciPy 1.17, `ndtri`.
        let z = normal_quantile(0.5, 0.75);
        assert!((z / 0.674_489_750_196_081_7 - 1.0).abs() <= 2.0 * f64::EPSILON, "{z}");
    }
}
