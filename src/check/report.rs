//! What a check found.

use std::fmt::{self, Display};

/// A law that a technique can break.
///
/// What [`Finding::measured`] and [`Finding::allowed`] mean is said for each. Where it is a
/// number of violations, none is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Law {
    /// No method panics, for any argument: the number of panics.
    Panics,
    /// A sample uses at least one canonical number, every point has as many coordinates as the
    /// first: the number of violations.
    Dimension,
    /// The support is \[a, b\] with a < b; the CDF is 0 and 1 there and beyond, its inverse a and b
    /// at 0 and 1, NaN for what is no probability, and the pdf 0 outside: violations.
    Ends,
    /// `cdf(inverse_cdf(u)) = u` and `survival(inverse_survival(u)) = u`: the largest miss.
    RoundTrip,
    /// `cdf(x) + survival(x) = 1`: the largest miss.
    Survival,
    /// The round trip with a small error relative to u: the largest miss over u.
    Tails,
    /// `inverse_cdf` and `cdf` do not decrease, `survival` does not grow: the largest step the
    /// wrong way, infinite for that of the inverse.
    Monotone,
    /// `sample(ξ) = inverse_cdf(canonical(ξ))`: the largest distance.
    SampleIsInverse,
    /// A sample is finite and within the support: violations.
    SampleSupport,
    /// The pdf of a sample is finite and greater than 0: violations.
    SampleDensity,
    /// The pdf at any point is neither negative nor NaN: violations.
    Density,
    /// The same ξ give the same sample, also written over another point: violations.
    Pure,
    /// `ln_pdf = ln pdf`: the largest miss.
    LnPdf,
    /// Batches have the length asked for, and the bits of single calls: violations.
    Batch,
    /// ∫ p = 1: the miss.
    Integral,
    /// `cdf` is the integral of the pdf between any two points: the largest miss.
    Mass,
    /// The same below and above points far out, relative to the mass: the largest miss.
    TailMass,
    /// The reference has a density where the technique samples, and its samples suffice to tell
    /// masses: violations, or the largest share that one of them has of the integral.
    Reference,
    /// Samples per bin of a coordinate are as the pdf says: χ² as a standard score.
    ChiSquared(usize),
    /// The same for the cells of two coordinates: dependence that the pdf does not know.
    JointChiSquared(usize, usize),
    /// The distribution function of the samples in a coordinate is that of the pdf: the largest
    /// distance.
    Kolmogorov(usize),
}

impl Display for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Panics => "no panic",
            Self::Dimension => "dimension",
            Self::Ends => "ends of the support",
            Self::RoundTrip => "cdf of inverse",
            Self::Survival => "cdf + survival",
            Self::Tails => "tails, relative",
            Self::Monotone => "monotone",
            Self::SampleIsInverse => "sample is inverse",
            Self::SampleSupport => "sample in support",
            Self::SampleDensity => "pdf at samples",
            Self::Density => "pdf anywhere",
            Self::Pure => "sample is pure",
            Self::LnPdf => "ln_pdf is ln pdf",
            Self::Batch => "batch is scalar",
            Self::Integral => "integral of the pdf",
            Self::Mass => "cdf is integral",
            Self::TailMass => "mass in the tails",
            Self::Reference => "reference suffices",
            Self::ChiSquared(d) => return f.pad(&format!("chi2 of x[{d}]")),
            Self::JointChiSquared(d, e) => return f.pad(&format!("chi2 of x[{d}], x[{e}]")),
            Self::Kolmogorov(d) => return f.pad(&format!("Kolmogorov of x[{d}]")),
        };
        f.pad(name)
    }
}

/// What became of one law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Verdict {
    /// The measured number is within what is allowed.
    Holds,
    /// It is not, or it is NaN.
    Broken,
    /// The check could not tell; the detail says what it lacks.
    Unresolved,
}

/// One law: what was measured, what is allowed, and where it is worst.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    pub(super) law: Law,
    pub(super) verdict: Verdict,
    pub(super) measured: f64,
    pub(super) allowed: f64,
    pub(super) detail: String,
}

impl Finding {
    /// The law.
    #[must_use]
    pub fn law(&self) -> Law {
        self.law
    }

    /// Whether it holds.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Whether the law holds.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.verdict == Verdict::Holds
    }

    /// How large the violation is, in the unit that the [`Law`] names.
    #[must_use]
    pub fn measured(&self) -> f64 {
        self.measured
    }

    /// How large it may be.
    #[must_use]
    pub fn allowed(&self) -> f64 {
        self.allowed
    }

    /// Where it is worst, in words.
    #[must_use]
    pub fn detail(&self) -> &str {
        &self.detail
    }
}

/// What a check found: a [`Finding`] for each law, and the settings.
///
/// `Display` is a table of all laws, in which `FAIL` marks those that are broken.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub(super) technique: &'static str,
    pub(super) samples: usize,
    pub(super) seed: u64,
    pub(super) false_alarms: f64,
    pub(super) findings: Vec<Finding>,
}

impl Report {
    /// Whether every law holds; one that could not be resolved does not.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.findings.iter().all(Finding::passed)
    }

    /// All laws, in the order in which they were checked.
    #[must_use]
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// The laws that do not hold.
    pub fn failures(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| !finding.passed())
    }

    /// The finding on `law`, if it was checked.
    #[must_use]
    pub fn get(&self, law: Law) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.law == law)
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (all, failed) = (self.findings.len(), self.failures().count());
        writeln!(f, "{}: {} of {all} laws hold", self.technique, all - failed)?;
        writeln!(
            f,
            "{} samples, seed {}, false alarms {:e}",
            self.samples, self.seed, self.false_alarms
        )?;
        writeln!(f, "     {:<22} {:>9} {:>9}", "law", "measured", "allowed")?;
        for finding in &self.findings {
            let mark = match finding.verdict {
                Verdict::Holds => "  ok",
                Verdict::Broken => "FAIL",
                Verdict::Unresolved => "   ?",
            };
            let (measured, allowed) = (short(finding.measured), short(finding.allowed));
            let line = format!("{mark} {:<22} {measured:>9} {allowed:>9}  ", finding.law);
            writeln!(f, "{}", (line + &finding.detail).trim_end())?;
        }
        Ok(())
    }
}

/// Three digits.
fn short(x: f64) -> String {
    if x == 0.0 || (x.fract() == 0.0 && x.abs() < 1e6) {
        format!("{x}")
    } else if (1e-2..1e6).contains(&x.abs()) {
        format!("{x:.3}")
    } else {
        format!("{x:.2e}")
    }
}

/// Collects what a law says at many places; keeps the worst.
#[derive(Debug)]
pub(super) struct Tally {
    law: Law,
    checked: u64,
    broken: u64,
    /// Of the measured number over the allowed one.
    worst: f64,
    measured: f64,
    allowed: f64,
    detail: String,
}

impl Tally {
    pub(super) fn new(law: Law) -> Self {
        let detail = String::new();
        Self { law, checked: 0, broken: 0, worst: -1.0, measured: 0.0, allowed: 0.0, detail }
    }

    /// `measured` must be at most `allowed`; NaN is not.
    pub(super) fn limit(&mut self, measured: f64, allowed: f64, place: impl FnOnce() -> String) {
        self.checked += 1;
        let holds = measured <= allowed;
        self.broken += u64::from(!holds);
        let ratio = match (holds, measured / allowed) {
            (true, ratio) if ratio.is_nan() => 0.0,
            (true, ratio) => ratio,
            (false, ratio) if ratio.is_nan() => f64::INFINITY,
            (false, ratio) => ratio.max(1.0),
        };
        if ratio > self.worst {
            (self.worst, self.measured, self.allowed) = (ratio, measured, allowed);
            self.detail = if holds { String::new() } else { place() };
        }
    }

    /// What must be true; the violations are counted and the first is described.
    pub(super) fn holds(&mut self, holds: bool, place: impl FnOnce() -> String) {
        self.checked += 1;
        if !holds {
            self.broken += 1;
            if self.broken == 1 {
                self.detail = place();
            }
            self.measured = self.broken as f64;
        }
    }

    pub(super) fn finding(self) -> Finding {
        let verdict = if self.broken > 0 { Verdict::Broken } else { Verdict::Holds };
        let Self { broken, checked, detail, .. } = self;
        let detail =
            if broken > 1 { format!("{broken} of {checked}, such as {detail}") } else { detail };
        let (law, measured, allowed) = (self.law, self.measured, self.allowed);
        Finding { law, verdict, measured, allowed, detail }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_keeps_the_worst_and_takes_nan_for_broken() {
        let mut tally = Tally::new(Law::RoundTrip);
        tally.limit(1.0, 2.0, || "half".into());
        tally.limit(0.0, 0.0, || "nothing".into());
        tally.limit(3.0, 2.0, || "three".into());
        tally.limit(2.5, 2.0, || "two and a half".into());
        let finding = tally.finding();
        assert_eq!((finding.measured, finding.allowed, finding.passed()), (3.0, 2.0, false));
        assert_eq!(finding.detail, "2 of 4, such as three");
        let mut tally = Tally::new(Law::RoundTrip);
        tally.limit(9.0, 2.0, || "nine".into());
        tally.limit(f64::NAN, 2.0, || "NaN".into());
        let finding = tally.finding();
        assert!(finding.measured.is_nan() && finding.detail.ends_with("NaN"));
    }

    #[test]
    fn a_table_marks_what_fails() {
        let mut tally = Tally::new(Law::Density);
        tally.holds(false, || "pdf(3.0) = -1.0".into());
        let findings = vec![Tally::new(Law::JointChiSquared(0, 12)).finding(), tally.finding()];
        let report =
            Report { technique: "Own", samples: 10, seed: 3, false_alarms: 1e-4, findings };
        assert_eq!(
            report.to_string(),
            "Own: 1 of 2 laws hold\n10 samples, seed 3, false alarms 1e-4\n     \
             law                     measured   allowed\n  \
             ok chi2 of x[0], x[12]            0         0\n\
             FAIL pdf anywhere                   1         0  pdf(3.0) = -1.0\n"
        );
        assert!(!report.passed() && report.failures().count() == 1);
        assert!(report.get(Law::Density).is_some() && report.get(Law::Mass).is_none());
    }
}
