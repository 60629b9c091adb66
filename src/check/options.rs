//! What a check takes for granted, and how strict it is.

/// The settings of a check: tolerances, samples, seed and false-alarm rate.
///
/// [`Options::default`] suits a technique written with care and without special functions for the
/// tails; [`Options::strict`] is what the techniques of this crate are held to.
///
/// ```
/// use mis::check::Options;
/// let options = Options::strict().samples(1_000_000).seed(7);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    pub(super) samples: usize,
    pub(super) seed: u64,
    pub(super) false_alarms: f64,
    pub(super) integral: f64,
    pub(super) round_trip: f64,
    pub(super) tail: f64,
    pub(super) tail_from: f64,
    pub(super) ln_pdf: f64,
    pub(super) splits: Vec<f64>,
    pub(super) resolved: bool,
    pub(super) quadrature: bool,
}

impl Default for Options {
    /// 1e5 samples, false alarms 1e-4; the integral to 1e-10, the round trip to 64 ULP, the tails
    /// down to 9e-4.
    fn default() -> Self {
        Self {
            samples: 100_000,
            seed: 1,
            false_alarms: 1e-4,
            integral: 1e-10,
            round_trip: 64.0,
            tail: 1e-12,
            tail_from: 9e-4,
            ln_pdf: 8.0,
            splits: Vec::new(),
            resolved: true,
            quadrature: true,
        }
    }
}

impl Options {
    /// The default, but the round trip to 4 ULP and the tails down to 1e-300.
    #[must_use]
    pub fn strict() -> Self {
        Self { round_trip: 4.0, tail_from: 1e-300, ..Self::default() }
    }

    /// How many samples the statistical laws draw; of a reference they draw four times as many.
    #[must_use]
    pub fn samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// The seed of every number ξ and u that a check draws.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// The probability that a right technique fails any of the statistical laws of one report.
    ///
    /// Each of T statistical laws is tested at the level of this over T (Bonferroni).
    #[must_use]
    pub fn false_alarms(self, probability: f64) -> Self {
        Self { false_alarms: probability, ..self }
    }

    /// The largest |∫ p - 1|, and the largest error of the mass between two points, where
    /// quadrature can tell.
    #[must_use]
    pub fn integral(self, tolerance: f64) -> Self {
        Self { integral: tolerance, ..self }
    }

    /// The largest |cdf(inverse_cdf(u)) - u|, in ULP of max(u, 1 - u).
    #[must_use]
    pub fn round_trip(self, ulp: f64) -> Self {
        Self { round_trip: ulp, ..self }
    }

    /// The largest |cdf(inverse_cdf(v)) - v| / v in the tails.
    #[must_use]
    pub fn tail(self, relative: f64) -> Self {
        Self { tail: relative, ..self }
    }

    /// The smallest v at which the tails are tested.
    ///
    /// Set it to where the tails lose their relative precision or x(v) leaves the range of `f64`.
    /// A survival function computed as 1 - P has about 1e-16 / v.
    #[must_use]
    pub fn tail_from(self, v: f64) -> Self {
        Self { tail_from: v, ..self }
    }

    /// The largest |ln_pdf - ln pdf|, in units of 2⁻⁵² max(1, |ln p|) for each coordinate.
    #[must_use]
    pub fn ln_pdf(self, units: f64) -> Self {
        Self { ln_pdf: units, ..self }
    }

    /// Where a density on the line jumps or has a kink: quadrature starts anew there.
    #[must_use]
    pub fn splits(self, splits: Vec<f64>) -> Self {
        Self { splits, ..self }
    }

    /// Whether the support holds enough numbers of `f64` for quadrature and histograms; otherwise
    /// a density on the line is checked without them.
    #[must_use]
    pub fn resolved(self, resolved: bool) -> Self {
        Self { resolved, ..self }
    }

    /// Whether product quadrature may be used for a technique of up to three coordinates.
    ///
    /// It is tried first, and left where two orders disagree. Without it, all masses come from
    /// the reference's samples.
    #[must_use]
    pub fn quadrature(self, quadrature: bool) -> Self {
        Self { quadrature, ..self }
    }

    /// The level at which each of `laws` statistical laws is tested.
    pub(super) fn level(&self, laws: usize) -> f64 {
        self.false_alarms.clamp(1e-300, 1.0) / laws.max(1) as f64
    }
}
