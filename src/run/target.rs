//! When a run may end.

use std::time::Duration;

use crate::error::{ArgumentError, finite};
use crate::estimate::Estimate;
use crate::integrand::Value;

/// What a run is to reach: a tolerance, a number of samples, a time, or whichever of them comes
/// first.
///
/// Without any, a run draws the samples that the estimator was made with. With a tolerance alone, it
/// may never end: where every contribution is 0, where the variance is infinite, and, if the
/// tolerance is relative, where the integral is 0. Set a number of samples or a time as well.
///
/// ```
/// use mis::Target;
/// use std::time::Duration;
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // 0.1 % at 95 %, at most 10 minutes.
/// let target = Target::new().relative(1e-3)?.confidence(0.95)?.time(Duration::from_secs(600));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    absolute: f64,
    relative: f64,
    confidence: f64,
    norm: Norm,
    samples: Option<u64>,
    time: Option<Duration>,
}

/// What the tolerance of a [`Target`] bounds, where the integrand has several components.
///
/// With e_c the half-width of the interval of component c and F_c its value, a tolerance is
/// reached if this holds. Components without any contribution that is not 0 are left out as long as another has one: they
/// may be 0, or rare beyond the samples, and their error is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Norm {
    /// e_c ≤ max(absolute, relative · |F_c|) for every c.
    #[default]
    Each,
    /// max e_c ≤ max(absolute, relative · max |F_c|).
    Largest,
    /// √Σ e_c² ≤ max(absolute, relative · √Σ F_c²).
    Euclidean,
    /// Σ e_c ≤ max(absolute, relative · Σ |F_c|).
    Sum,
    /// e_c ≤ max(absolute, relative · |F_c|) for this c alone.
    Component(usize),
}

impl Default for Target {
    fn default() -> Self {
        Self::new()
    }
}

impl Target {
    /// The samples that the estimator was made with.
    #[must_use]
    pub fn new() -> Self {
        Self {
            absolute: 0.0,
            relative: 0.0,
            confidence: 0.95,
            norm: Norm::Each,
            samples: None,
            time: None,
        }
    }

    /// The error is to be at most `tolerance`, at the [confidence](Target::confidence). If there is
    /// a relative tolerance as well, the larger of the two counts.
    ///
    /// # Errors
    ///
    /// `tolerance` must be finite and greater than 0.
    pub fn absolute(self, tolerance: f64) -> Result<Self, ArgumentError> {
        Ok(Self { absolute: tolerance_of("absolute", tolerance)?, ..self })
    }

    /// The error is to be at most `tolerance` times the value, at the
    /// [confidence](Target::confidence). If there is an absolute tolerance as well, the larger of
    /// the two counts.
    ///
    /// # Errors
    ///
    /// `tolerance` must be finite and greater than 0.
    pub fn relative(self, tolerance: f64) -> Result<Self, ArgumentError> {
        Ok(Self { relative: tolerance_of("relative", tolerance)?, ..self })
    }

    /// The part of runs whose error is within the tolerance; 0.95 by default. Also the level of
    /// the interval that a report prints.
    ///
    /// # Errors
    ///
    /// `level` must be greater than 0 and less than 1.
    pub fn confidence(self, level: f64) -> Result<Self, ArgumentError> {
        if level > 0.0 && level < 1.0 {
            Ok(Self { confidence: level, ..self })
        } else {
            let rule = "it must be greater than 0 and less than 1";
            Err(ArgumentError::new("Target::confidence", "level", level, rule))
        }
    }

    /// What the tolerance bounds, where the integrand has several components; each of them by
    /// default.
    #[must_use]
    pub fn norm(self, norm: Norm) -> Self {
        Self { norm, ..self }
    }

    /// At most this many samples, over all techniques.
    ///
    /// # Errors
    ///
    /// `samples` must be at least 1 and at most 2⁵³.
    pub fn samples(self, samples: u64) -> Result<Self, ArgumentError> {
        if (1..=1 << 53).contains(&samples) {
            Ok(Self { samples: Some(samples), ..self })
        } else {
            let rule = "it must be at least 1 and at most 2^53";
            Err(ArgumentError::new("Target::samples", "samples", samples, rule))
        }
    }

    /// At most this much time, by the clock on the wall, since the run or its continuation began.
    ///
    /// No block of samples, up to 512 of one technique, is begun after that; those that are being
    /// evaluated are waited for. How far a run
    /// comes depends on the machine; its report says how many samples it took, and a run of that
    /// many gives the same bits.
    #[must_use]
    pub fn time(self, time: Duration) -> Self {
        Self { time: Some(time), ..self }
    }

    pub(crate) fn level(&self) -> f64 {
        self.confidence
    }

    pub(crate) fn has_tolerance(&self) -> bool {
        self.absolute > 0.0 || self.relative > 0.0
    }

    pub(crate) fn limit_of_time(&self) -> Option<Duration> {
        self.time
    }

    /// The most samples, where the estimator has `own`.
    pub(crate) fn limit(&self, own: u64) -> u64 {
        let endless = self.has_tolerance() || self.time.is_some();
        self.samples.unwrap_or(if endless { 1 << 53 } else { own })
    }

    /// Whether component `c` of the value counts.
    pub(crate) fn counts(&self, c: usize) -> bool {
        match self.norm {
            Norm::Component(only) => only == c,
            _ => true,
        }
    }

    /// # Errors
    ///
    /// There is no component at all, or not the one that the norm is of.
    pub(crate) fn check(&self, components: usize) -> Result<(), ArgumentError> {
        if components == 0 {
            let rule = "the values of an integrand must have at least one component";
            return Err(ArgumentError::new("Run", "Value::COMPONENTS", components, rule));
        }
        match self.norm {
            Norm::Component(c) if c >= components => {
                let rule = format!("the integrand has {components} components");
                Err(ArgumentError::new("Target::norm", "Norm::Component", c, rule))
            }
            _ => Ok(()),
        }
    }

    /// The half-width of the interval over the tolerance, by the norm; at most 1 where the
    /// tolerance is reached. Infinite where an error is unknown.
    ///
    /// Components in which no sample had a contribution are left out, if others have one.
    pub(super) fn excess<V: Value>(&self, estimate: &Estimate<V>) -> f64 {
        let one = |c| {
            let ends = (estimate.half_width(c, self.confidence), estimate.value_of(c).abs());
            estimate.has_signal(c).then_some(ends)
        };
        self.excess_of((0..V::COMPONENTS).map(one))
    }

    /// The same, of half-widths and values; none of a component without a contribution.
    pub(crate) fn excess_of(&self, ends: impl Iterator<Item = Option<(f64, f64)>>) -> f64 {
        let over = |(error, value): (f64, f64)| {
            let tolerance = self.absolute.max(self.relative * value);
            if error == 0.0 { 0.0 } else { error / tolerance }
        };
        let counted = ends.enumerate().filter(|(c, _)| self.counts(*c));
        let all: Vec<(f64, f64)> = counted.filter_map(|(_, ends)| ends).collect();
        if all.is_empty() || all.iter().any(|(error, value)| !(error + value).is_finite()) {
            return f64::INFINITY;
        }
        let combine = |combine: fn(f64, f64) -> f64| {
            let sum = all.iter().fold((0.0, 0.0), |s, e| (combine(s.0, e.0), combine(s.1, e.1)));
            over(sum)
        };
        match self.norm {
            Norm::Each | Norm::Component(_) => all.iter().copied().map(over).fold(0.0, f64::max),
            Norm::Largest => combine(f64::max),
            Norm::Euclidean => combine(f64::hypot),
            Norm::Sum => combine(|a, b| a + b),
        }
    }
}

/// In words: "relative 0.001 at 95 %, at most 600 s".
impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut words = Vec::new();
        if self.relative > 0.0 {
            words.push(format!("relative error {}", self.relative));
        }
        if self.absolute > 0.0 {
            words.push(format!("absolute error {}", self.absolute));
        }
        let mut tolerance = words.join(" or ");
        if self.has_tolerance() {
            tolerance = format!("{tolerance} at {} %", 100.0 * self.confidence);
            if self.norm != Norm::Each {
                tolerance = format!("{tolerance} ({:?})", self.norm);
            }
        }
        let limits = [
            self.samples.map(|samples| format!("at most {samples} samples")),
            self.time.map(|time| format!("at most {} s", time.as_secs_f64())),
        ];
        let parts = [(!tolerance.is_empty()).then_some(tolerance)].into_iter().chain(limits);
        let text = parts.flatten().collect::<Vec<_>>().join(", ");
        f.write_str(if text.is_empty() { "the samples of the estimator" } else { &text })
    }
}

fn tolerance_of(argument: &'static str, tolerance: f64) -> Result<f64, ArgumentError> {
    if finite("Target", argument, tolerance)? > 0.0 {
        Ok(tolerance)
    } else {
        Err(ArgumentError::new("Target", argument, tolerance, "it must be greater than 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::{Norm, Target};
    use crate::estimate::Estimate;
    use crate::estimator::Design;
    use crate::moments::Moments;
    use crate::part::{Contributions, Counts, Extreme, Part};
    use std::time::Duration;

    /// The estimate from these contributions of one technique, a row for each component.
    fn estimate<const K: usize>(rows: [&[f64]; K]) -> Estimate<[f64; K]> {
        let contributions = rows.map(|ys| Contributions {
            moments: Moments::of_block(ys),
            extreme: Extreme { y: ys[0], index: 0 },
        });
        let counts = vec![Counts { samples: rows[0].len() as u64, ..Counts::default() }];
        let part = Part { contributions: contributions.to_vec(), counts };
        Estimate::new(Design::Stratified, &[1.0], part)
    }

    #[test]
    fn excess_by_every_norm() {
        // Values 2, -8 and 0; symmetric, so that intervals are.
        let rows: [&[f64]; 3] = [&[1.0, 2.0, 2.0, 3.0], &[-6.0, -8.0, -10.0, -8.0], &[0.0; 4]];
        let estimate = estimate(rows);
        let target = Target::new().confidence(0.9).unwrap();
        let e = |c| estimate.half_width(c, 0.9);
        let (a, b) = (e(0), e(1));
        assert!(a > 0.0 && (b / a - 2.0).abs() < 1e-12);
        let relative = target.relative(0.1).unwrap();
        let absolute = target.absolute(0.3).unwrap();
        let either = relative.absolute(0.3).unwrap();
        for (target, norm, expected) in [
            (relative, Norm::Each, (a / 0.2_f64).max(b / 0.8)),
            (absolute, Norm::Each, b / 0.3),
            (either, Norm::Each, (a / 0.3_f64).max(b / 0.8)),
            (relative, Norm::Component(0), a / 0.2),
            (relative, Norm::Component(1), b / 0.8),
            (relative, Norm::Component(2), f64::INFINITY),
            (relative, Norm::Largest, b / 0.8),
            (relative, Norm::Euclidean, a.hypot(b) / (0.1 * 68_f64.sqrt())),
            (relative, Norm::Sum, (a + b) / 1.0),
            (absolute, Norm::Sum, (a + b) / 0.3),
            (either, Norm::Sum, (a + b) / 1.0),
            (target, Norm::Each, f64::INFINITY),
        ] {
            let found = target.norm(norm).excess(&estimate);
            assert!(
                found == expected || (found / expected - 1.0).abs() < 1e-12,
                "{norm:?} {found}"
            );
        }
    }

    #[test]
    fn excess_where_an_error_is_0_or_unknown() {
        let target = Target::new().relative(0.1).unwrap();
        let constant = estimate([&[3.0; 4], &[0.0; 4]]);
        assert_eq!(target.excess(&constant), 0.0);
        assert_eq!(target.excess(&estimate([&[0.0; 4]])), f64::INFINITY);
        assert_eq!(target.excess(&estimate([&[3.0]])), f64::INFINITY);
        // A value of 0 has no relative error.
        assert_eq!(target.excess(&estimate([&[1.0, -1.0]])), f64::INFINITY);
    }

    #[test]
    fn in_words() {
        let target = Target::new();
        let second = Duration::from_millis(1500);
        for (target, text) in [
            (target, "the samples of the estimator"),
            (target.samples(7).unwrap(), "at most 7 samples"),
            (target.time(second), "at most 1.5 s"),
            (target.relative(0.01).unwrap(), "relative error 0.01 at 95 %"),
            (
                target.absolute(2.0).unwrap().confidence(0.5).unwrap().norm(Norm::Sum),
                "absolute error 2 at 50 % (Sum)",
            ),
            (
                target
                    .absolute(2.0)
                    .unwrap()
                    .relative(0.5)
                    .unwrap()
                    .time(second)
                    .samples(9)
                    .unwrap(),
                "relative error 0.5 or absolute error 2 at 95 %, at most 9 samples, at most 1.5 s",
            ),
        ] {
            assert_eq!(target.to_string(), text);
        }
    }

    #[test]
    fn limits() {
        let target = Target::new();
        assert_eq!(target.limit(77), 77);
        assert_eq!(target.relative(0.1).unwrap().limit(77), 1 << 53);
        assert_eq!(target.absolute(0.1).unwrap().limit(77), 1 << 53);
        assert_eq!(target.time(Duration::ZERO).limit(77), 1 << 53);
        assert_eq!(target.time(Duration::ZERO).samples(5).unwrap().limit(77), 5);
        assert_eq!(Target::default(), target);
        assert!(!target.has_tolerance() && target.absolute(1.0).unwrap().has_tolerance());
    }

    #[test]
    fn arguments() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Target::new().absolute(bad).is_err() && Target::new().relative(bad).is_err());
        }
        for bad in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
            assert!(Target::new().confidence(bad).is_err());
        }
        for (samples, good) in [(0, false), (1, true), (1 << 53, true), ((1 << 53) + 1, false)] {
            assert_eq!(Target::new().samples(samples).is_ok(), good);
        }
        let second = Target::new().norm(Norm::Component(1));
        assert!(second.check(1).is_err() && second.check(2).is_ok());
        for target in [Target::new(), second] {
            let message = target.check(0).unwrap_err().to_string();
            let rule = "the values of an integrand must have at least one component";
            assert_eq!(message, format!("Run: `Value::COMPONENTS` is 0, but {rule}"));
        }
        assert!(second.counts(1) && !second.counts(0) && Target::new().counts(9));
    }
}
