//! Confidence intervals.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// A confidence interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Interval {
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

impl Interval {
    /// Whether `x` lies in the interval, ends included.
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        self.lower <= x && x <= self.upper
    }

    const LINE: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// `value` ± t · error; the whole line without an error. `error` comes with its degrees of
    /// freedom.
    pub(super) fn student(value: f64, error: Option<(f64, f64)>, level: f64) -> Self {
        Self::hall(value, error, 0.0, level)
    }

    /// The interval of Student's t, its ends moved for the skewness of the estimate.
    ///
    /// `skewness` is g, the third cumulant of the value over its standard error cubed: for the
    /// mean of n contributions their sample skewness over √n, in general
    /// Σ α_i³ m_i / n_i² / V^(3/2), with m_i the third central moment of technique i's
    /// contributions and V the variance of the value. The studentised error T is skewed by -2 g,
    /// and h(T) = T + g T²/3 + g² T³/27 + g/6 is not, to second order. h increases everywhere, so
    /// the interval is the values for which |h(T)| ≤ t,
    /// [value - error · h⁻¹(t), value - error · h⁻¹(-t)].
    /// |g| is less than 1 for any contributions; the value lies inside for t ≥ |g|/6. The whole
    /// line where g is not a number.
    ///
    /// Source: P. Hall, *On the Removal of Skewness by Transformation*, 1992, with t for the
    /// normal quantile.
    pub(super) fn hall(value: f64, error: Option<(f64, f64)>, skewness: f64, level: f64) -> Self {
        let (error, freedom) = match error {
            Some((0.0, _)) => return Self { lower: value, upper: value },
            Some(error) if skewness.is_finite() => error,
            _ => return Self::LINE,
        };
        let t = quantile(freedom, level);
        if !t.is_finite() {
            return Self::LINE;
        }
        // h⁻¹(t) = 3/g (c - 1), where c³ = 1 + g (t - g/6), without the cancellation at small g.
        let inverse = |t: f64| {
            let t = t - skewness / 6.0;
            let c = (1.0 + skewness * t).cbrt();
            t * (3.0 / (c * c + c + 1.0))
        };
        Self { lower: value - error * inverse(t), upper: value - error * inverse(-t) }
    }

    /// The empirical Bernstein interval: for contributions within stated bounds it covers with at
    /// least the probability `level` for any number of samples, whatever the contributions.
    ///
    /// With δ = (1 - level) / K for K techniques, technique i is off by more than
    /// s_i √(2 ln(4/δ) / n_i) + 7 (b_i - a_i) ln(4/δ) / (3 (n_i - 1))
    /// with probability at most δ; α_i times that, summed, is the half-width. The interval ends
    /// at Σ α_i a_i and Σ α_i b_i, where the truth must lie too. Contributions beyond the bounds
    /// are for the caller to refuse: then the interval says nothing, and may be empty.
    ///
    /// Source: A. Maurer and M. Pontil, *Empirical Bernstein Bounds and Sample Variance
    /// Penalization*, 2009, arXiv:0907.3740, theorem 4, used on either side.
    pub(super) fn bernstein(value: f64, techniques: &[Bounded], level: f64) -> Self {
        let active = || techniques.iter().filter(|technique| technique.alpha > 0.0);
        let delta = (1.0 - level) / active().count() as f64;
        let log = (4.0 / delta).ln();
        let (mut half_width, mut lower, mut upper) = (0.0, 0.0, 0.0);
        for Bounded { alpha, samples, deviation, bounds: (a, b) } in active() {
            let n = *samples as f64;
            let known =
                deviation * (2.0 * log / n).sqrt() + 7.0 * (b - a) * log / (3.0 * (n - 1.0));
            half_width += alpha * if n > 1.0 { known } else { f64::INFINITY };
            lower += alpha * a;
            upper += alpha * b;
        }
        Self { lower: (value - half_width).max(lower), upper: (value + half_width).min(upper) }
    }
}

/// What a technique's samples say about its contributions, whose mean over techniques, weighted
/// by α_i, is the value; and what is known of them beforehand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounded {
    /// α_i.
    pub(super) alpha: f64,
    /// n_i.
    pub(super) samples: u64,
    /// s_i, the square root of the unbiased sample variance.
    pub(super) deviation: f64,
    /// No contribution is less than the first or greater than the second.
    pub(super) bounds: (f64, f64),
}

/// The t with P(|T| ≤ t) = `level`.
///
/// Accurate to 1e-9 relative for levels from 0.1 to 0.999999. From 1000 degrees of freedom on,
/// statrs loses digits (6e-5 relative at 1e6), and an expansion about the normal quantile z takes
/// over: M. Abramowitz and I. A. Stegun, *Handbook of
/// Mathematical Functions*, 1964, formula 26.7.5.
fn quantile(freedom: f64, level: f64) -> f64 {
    let u = 0.5 + 0.5 * level;
    if freedom < 1000.0 {
        return StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(u));
    }
    let z = Normal::standard().inverse_cdf(u);
    let (z2, n) = (z * z, freedom);
    let g1 = (z2 + 1.0) / 4.0;
    let g2 = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let g3 = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z * (1.0 + (g1 + (g2 + g3 / n) / n) / n)
}

#[cfg(test)]
mod tests {
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Dxsm;

    use super::{Bounded, Interval, quantile};

    /// Printed tables of Student's t.
    #[test]
    fn quantiles_agree_with_tables() {
        for (freedom, level, t) in [
            (1.0, 0.5, 1.0),
            (1.0, 0.95, 12.706_204_736_432_1),
            (2.0, 0.95, 4.302_652_729_911_28),
            (5.0, 0.95, 2.570_581_835_636_31),
            (30.0, 0.99, 2.749_995_653_567_23),
            (999.0, 0.95, 1.962_341_461_133_45),
            (1000.0, 0.95, 1.962_339_080_826_41),
            (1e6, 0.95, 1.959_966_356_814_11),
            (1e9, 0.95, 1.959_963_986_912_33),
            (f64::INFINITY, 0.682_689_492_137_086, 1.0),
        ] {
            let q = quantile(freedom, level);
            assert!((q / t - 1.0).abs() < 1e-9, "{freedom} {level}: {q} {t}");
        }
    }

    #[test]
    fn an_unknown_error_leaves_the_whole_line() {
        for interval in [
            Interval::student(1.0, None, 0.95),
            Interval::hall(1.0, None, 0.5, 0.95),
            Interval::hall(1.0, Some((0.1, 9.0)), f64::NAN, 0.95),
            Interval::hall(1.0, Some((0.1, f64::NAN)), 0.5, 0.95),
            Interval::hall(1.0, Some((0.1, 0.0)), 0.0, 0.95),
        ] {
            assert_eq!(interval, Interval::LINE);
            assert!(interval.contains(-1e300) && interval.contains(1e300));
        }
        assert_eq!(
            Interval::hall(1.0, Some((0.0, f64::NAN)), f64::NAN, 0.95),
            Interval { lower: 1.0, upper: 1.0 }
        );
    }

    /// From roots of h in another language.
    #[test]
    fn hall_inverts_his_transformation() {
        for (value, error, freedom, g, level, lower, upper) in [
            (2.0, 0.5, 99.0, 0.3, 0.95, 1.176_107_911_502_277_7, 3.347_756_072_592_509_3),
            (-1.0, 2.0, 9.0, -0.8, 0.99, -17.462_579_173_230_267, 2.879_831_208_604_187),
            (0.0, 1.0, 500.0, 1e-9, 0.95, -1.964_719_836_013_992_8, 1.964_719_838_920_742_3),
            (0.0, 1.0, 3.0, 0.9, 0.5, -0.527_136_241_472_675_9, 1.463_197_690_620_742_5),
            (1.0, 1.0, 63.0, 0.99, 0.1, 1.039_339_567_563_302_8, 1.324_722_827_286_960_7),
        ] {
            let interval = Interval::hall(value, Some((error, freedom)), g, level);
            let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
            assert!(close(interval.lower, lower) && close(interval.upper, upper), "{interval:?}");
            // A contribution's sign is the user's choice.
            let mirrored = Interval::hall(-value, Some((error, freedom)), -g, level);
            assert_eq!((-mirrored.upper, -mirrored.lower), (interval.lower, interval.upper));
        }
    }

    #[test]
    fn without_skewness_it_is_students() {
        for (freedom, level) in [(1.0, 0.95), (7.5, 0.5), (200.0, 0.99), (1e7, 0.682_7)] {
            let t = quantile(freedom, level);
            let expected = Interval { lower: 3.0 - 0.2 * t, upper: 3.0 + 0.2 * t };
            assert_eq!(Interval::student(3.0, Some((0.2, freedom)), level), expected);
            // An ulp or two beside it, not a division by almost 0.
            let hall = Interval::hall(0.0, Some((1.0, freedom)), f64::MIN_POSITIVE, level);
            assert!(
                (hall.lower / -t - 1.0).abs() <= 1e-15 && (hall.upper / t - 1.0).abs() <= 1e-15
            );
        }
    }

    #[test]
    fn a_higher_level_widens_the_interval_on_both_sides() {
        let bounded = [Bounded { alpha: 1.0, samples: 1000, deviation: 0.1, bounds: (-1.0, 1.0) }];
        for g in [-0.99, -0.3, 0.0, 0.1, 0.99] {
            let levels = [0.01, 0.1, 0.5, 0.682_7, 0.9, 0.95, 0.99, 0.999, 0.999_999];
            for pair in levels.windows(2) {
                let hall = |level| Interval::hall(0.0, Some((1.0, 20.0)), g, level);
                let bernstein = |level| Interval::bernstein(0.0, &bounded, level);
                for (narrow, wide) in
                    [(hall(pair[0]), hall(pair[1])), (bernstein(pair[0]), bernstein(pair[1]))]
                {
                    assert!(wide.lower < narrow.lower && narrow.upper < wide.upper, "{g} {pair:?}");
                }
            }
        }
    }

    #[test]
    fn bernstein_agrees_with_the_formula() {
        let one =
            |samples, deviation| Bounded { alpha: 1.0, samples, deviation, bounds: (0.0, 1.0) };
        let two = [
            Bounded { alpha: 0.25, samples: 1000, deviation: 0.3, bounds: (0.0, 1.0) },
            // Without samples and without weight, it is not one of K.
            Bounded { alpha: 0.0, samples: 0, deviation: 0.0, bounds: (0.0, 1.0) },
            Bounded { alpha: 0.75, samples: 3000, deviation: 0.1, bounds: (-1.0, 4.0) },
        ];
        for (interval, lower, upper) in [
            (
                Interval::bernstein(0.4, &[one(1000, 0.3)], 0.95),
                0.361_680_079_497_051,
                0.438_319_920_502_949,
            ),
            (
                Interval::bernstein(1.5, &two, 0.99),
                1.462_914_827_858_629_3,
                1.537_085_172_141_370_7,
            ),
            // Cut at the lower bound.
            (Interval::bernstein(0.02, &[one(100, 0.1)], 0.95), 0.0, 0.152_884_232_778_733_68),
        ] {
            assert!((interval.lower - lower).abs() < 1e-14, "{interval:?}");
            assert!((interval.upper - upper).abs() < 1e-14, "{interval:?}");
        }
        // A sample or none says nothing beyond the bounds.
        for samples in [0, 1] {
            let interval = Interval::bernstein(0.5, &[one(samples, f64::NAN)], 0.95);
            assert_eq!(interval, Interval { lower: 0.0, upper: 1.0 });
        }
        // Without a deviation, only the bounds' term is left: no zero is an error of 0.
        let none = Interval::bernstein(0.0, &[one(1000, 0.0)], 0.95);
        assert!((none.upper - 7.0 * 80_f64.ln() / 2997.0).abs() < 1e-15);
    }

    /// Mean, its error, and skewness of `n` numbers.
    fn summary(ys: &[f64]) -> (f64, f64, f64) {
        let n = ys.len() as f64;
        let mean = ys.iter().sum::<f64>() / n;
        let central = |power| ys.iter().map(|y| (y - mean).powi(power)).sum::<f64>() / n;
        let error = (central(2) / (n - 1.0)).sqrt();
        (mean, error, central(3) / (n * n) / error.powi(3))
    }

    /// How often of `runs` the truth lies below the interval, and above.
    fn misses(
        runs: u32,
        n: usize,
        truth: f64,
        draw: impl Fn(f64) -> f64,
        interval: impl Fn(f64, f64, f64) -> Interval,
    ) -> (f64, f64) {
        let mut rng = Pcg64Dxsm::seed_from_u64(1);
        let (mut below, mut above) = (0.0, 0.0);
        for _ in 0..runs {
            let xi = |rng: &mut Pcg64Dxsm| (f64::from(rng.next_u32()) + 0.5) / 4_294_967_296.0;
            let ys: Vec<f64> = (0..n).map(|_| draw(xi(&mut rng))).collect();
            let (mean, error, g) = summary(&ys);
            let interval = interval(mean, error, g);
            below += f64::from(u8::from(truth < interval.lower)) / f64::from(runs);
            above += f64::from(u8::from(truth > interval.upper)) / f64::from(runs);
        }
        (below, above)
    }

    /// Exponential contributions, n = 64: Student's t misses 1.1 % below and 5.5 % above, Hall's
    /// interval 2.2 % and 3.1 %.
    #[test]
    fn halls_interval_misses_on_both_sides_alike() {
        let draw = |xi: f64| -(-xi).ln_1p();
        let runs = 4000;
        let student = |mean, error, _| Interval::student(mean, Some((error, 63.0)), 0.95);
        let hall = |mean, error, g| Interval::hall(mean, Some((error, 63.0)), g, 0.95);
        let deviation = |p: f64| (p * (1.0 - p) / f64::from(runs)).sqrt();
        for (misses, below, above) in [
            (misses(runs, 64, 1.0, draw, student), 0.0113, 0.0547),
            (misses(runs, 64, 1.0, draw, hall), 0.022, 0.031),
        ] {
            assert!((misses.0 - below).abs() < 4.42 * deviation(below), "{misses:?}");
            assert!((misses.1 - above).abs() < 4.42 * deviation(above), "{misses:?}");
        }
    }

    /// A rare indicator, where the other intervals fail: 50 samples, p = 0.02.
    #[test]
    fn bernstein_covers_what_the_others_miss() {
        let draw = |xi: f64| f64::from(u8::from(xi < 0.02));
        let hall = |mean, error, g| Interval::hall(mean, Some((error, 49.0)), g, 0.95);
        let bernstein = |mean, error: f64, _| {
            let deviation = error * 50_f64.sqrt();
            let bounds = (0.0, 1.0);
            Interval::bernstein(
                mean,
                &[Bounded { alpha: 1.0, samples: 50, deviation, bounds }],
                0.95,
            )
        };
        let (below, above) = misses(1000, 50, 0.02, draw, bernstein);
        assert!(below + above <= 0.05, "{below} {above}");
        let (below, above) = misses(1000, 50, 0.02, draw, hall);
        assert!(below + above > 0.3, "{below} {above}");
    }
}
