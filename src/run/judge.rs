//! What speaks for and against an estimate.

use super::k_hat::k_hat;
use super::state::Leaf;
use super::status::{Doubt, Status, Stop};
use super::target::Target;
use crate::estimate::Estimate;
use crate::estimator::{Design, Frame, Seen};
use crate::integrand::Value;
use crate::tail::Tail;

/// How many contributions that are not 0 a technique must have, if it matters.
const CONTRIBUTIONS: u64 = 30;

/// A technique matters if it makes up this part of the variance.
const MATTERS: f64 = 0.01;

/// Beyond this standard score, samples and pdfs do not agree. Of sound runs, 1e-5 are, if they have
/// thousands of samples. The scores of a few hundred are skewed where a density stands out over
/// little mass: of a Cauchy density among two normal ones, 5e-4 of 512, 2e-4 of 1100 samples.
const DENSITY: f64 = 4.42;

/// How closely a pdf that is in order integrates to 1. Without it, densities that are proportional
/// to each other, whose ratio does not vary, would be held to the last digit.
const NORMALISED: f64 = 1e-9;

/// An estimate with the evidence on it.
#[derive(Debug, Clone)]
pub(super) struct Judged<V> {
    pub(super) estimate: Estimate<V>,
    /// A row of components for each technique that matters to them.
    k_hats: Vec<Option<f64>>,
    /// One for each technique.
    pub(super) density_scores: Vec<Option<f64>>,
    /// Contributions that are not 0, of each technique.
    contributions: Vec<u64>,
}

/// How strict a judgement is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gate {
    /// Of samples as they come.
    NearNormal,
    /// Of fresh samples, as many as those that were near normal.
    Confirming,
}

impl<V: Value> Judged<V> {
    pub(super) fn new(frame: &Frame<'_>, leaf: Leaf) -> Self {
        let contributions = leaf.node.part.counts.iter().map(|n| n.samples - n.zero).collect();
        let density_scores = density_scores(frame, &leaf);
        let estimate = Estimate::new(frame.design, frame.shares, leaf.node.part);
        let mut judged = Self { estimate, k_hats: Vec::new(), density_scores, contributions };
        judged.k_hats = judged.fit_tails(leaf.tails, &leaf.node.seen);
        judged
    }

    fn fit_tails(&self, mut tails: Vec<Tail>, seen: &[Seen]) -> Vec<Option<f64>> {
        let rows = tails.chunks_mut(V::COMPONENTS.max(1)).zip(seen).enumerate();
        rows.flat_map(|(i, (row, seen))| {
            let one = move |(c, tail): (usize, &mut Tail)| {
                if self.matters(i, c) { k_hat(tail.magnitudes(), seen.contributions) } else { None }
            };
            row.iter_mut().enumerate().map(one)
        })
        .collect()
    }

    /// Whether technique `i` makes up a part of the variance of component `c` that counts.
    fn matters(&self, i: usize, c: usize) -> bool {
        self.estimate.share_of_variance(i, c).is_some_and(|share| share >= MATTERS)
    }

    /// The heaviest tail of the contributions to component `c`, with its technique.
    pub(super) fn k_hat(&self, c: usize) -> Option<(usize, f64)> {
        let column = self.k_hats.iter().skip(c).step_by(V::COMPONENTS.max(1)).enumerate();
        column.filter_map(|(i, k)| k.map(|k| (i, k))).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Whether a component that the target counts has a contribution that is not 0.
    fn has_signal(&self, target: &Target) -> bool {
        (0..V::COMPONENTS).any(|c| target.counts(c) && self.estimate.has_signal(c))
    }

    /// What speaks against the value or its error, in the components that the target counts.
    pub(super) fn doubts(&self, frame: &Frame<'_>, target: &Target, gate: Gate) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        let components = || {
            let signal = |c: &usize| target.counts(*c) && self.estimate.has_signal(*c);
            (0..V::COMPONENTS).filter(signal)
        };
        for (technique, (summary, alpha)) in
            self.estimate.techniques().zip(frame.shares).enumerate()
        {
            let samples = summary.samples;
            let least = self.estimate.replicates().max(2) as u64;
            if frame.design == Design::Stratified && *alpha > 0.0 && samples < least {
                doubts.push(Doubt::Samples { technique, samples });
            }
        }
        let (samples, replicates) = (self.estimate.samples(), self.estimate.replicates());
        if frame.design == Design::Pooled && replicates > 1 && samples < replicates as u64 {
            doubts.push(Doubt::EmptyReplicates { samples, replicates });
        }
        for (technique, &contributions) in self.contributions.iter().enumerate() {
            let all = frame.design == Design::Pooled;
            let matters = components().any(|c| self.matters(technique, c));
            if !all && matters && contributions < CONTRIBUTIONS {
                doubts.push(Doubt::FewContributions { technique: Some(technique), contributions });
            }
        }
        let contributions = self.contributions.iter().sum();
        if contributions < CONTRIBUTIONS {
            doubts.push(Doubt::FewContributions { technique: None, contributions });
        }
        for component in components() {
            let kappa = self.estimate.kappa_of(component).unwrap_or(f64::INFINITY);
            let (technique, k_hat) = self.k_hat(component).unwrap_or((0, 0.0));
            let (near_symmetric, light) = gate.judge(kappa, k_hat, self.estimate.replicates());
            // An infinite κ is for want of samples, of which there is a doubt already.
            if !near_symmetric && kappa.is_finite() {
                doubts.push(Doubt::Skewed { component, kappa });
            }
            if !light {
                doubts.push(Doubt::HeavyTail { technique, component, k_hat });
            }
        }
        for (technique, z) in self.density_scores.iter().enumerate() {
            if let Some(z) = z.filter(|z| z.abs() > DENSITY) {
                doubts.push(Doubt::Density { technique, z });
            }
        }
        doubts
    }

    /// The judgement on a run that ended like this.
    pub(super) fn status(&self, frame: &Frame<'_>, target: &Target, stop: Stop) -> Status {
        let gate = if stop == Stop::Tolerance { Gate::Confirming } else { Gate::NearNormal };
        let samples = self.estimate.samples();
        if samples > 0 && !self.has_signal(target) {
            return Status::NoSignal { at_most: (3.0 / samples as f64).min(1.0) };
        }
        let mut doubts = self.doubts(frame, target, gate);
        let equal = |c: &usize| target.counts(*c) && self.estimate.error_of(*c) == Some(0.0);
        let at_most = (3.0 / samples as f64).min(1.0);
        let constant = |component| Doubt::Constant { component, at_most };
        doubts.extend((0..V::COMPONENTS).filter(equal).map(constant));
        match stop {
            Stop::Cancelled | Stop::Fault if samples == 0 => Status::Cancelled,
            _ if !doubts.is_empty() => Status::Suspect(doubts),
            Stop::Tolerance => Status::Converged,
            Stop::Samples | Stop::Time => Status::BudgetSpent,
            Stop::Cancelled | Stop::Fault => Status::Cancelled,
        }
    }
}

impl Gate {
    /// Whether κ is small enough, and whether k̂ is.
    ///
    /// [`NearNormal`](Gate::NearNormal): κ ≤ 0.07 (1 - 2 max(k̂, 0)), k̂ < 1/2. Where k̂ is greater
    /// than 0, the sample skewness of a heavy tail is less than the skewness more often than not,
    /// all the more so the closer k̂ is to 1/2, where the variance becomes infinite. The numbers
    /// were found by simulation of 82 kinds of contributions, n from 64 to 100 000.
    ///
    /// [`Confirming`](Gate::Confirming): κ ≤ 0.1, k̂ ≤ 0.7. Wider, so that the samples that are
    /// reported are hardly selected by it; with the same bounds, their intervals would no longer
    /// hold their level.
    ///
    /// Of R replicates, κ says little: it is as large as 0.25 in a twentieth of cases if they are
    /// normal, for R = 16. Beyond what that explains, 3.5 standard deviations of the sample skewness
    /// of R normal values over √R, some replicates have seen what others have not. Up to 0.07, as of
    /// more than 120 replicates, intervals hold their level nevertheless. The farthest
    /// part of a tail, a single point of each replicate, is as random as ever: where k is 1/5, such
    /// intervals of 95 % cover 92 to 93 %, whatever n. So k̂ ≤ 0.12, which most samples of an exponential
    /// tail pass, and hardly any of one with k = 1/5.
    fn judge(self, kappa: f64, k_hat: f64, replicates: usize) -> (bool, bool) {
        if replicates > 1 {
            let r = replicates as f64;
            // √(6 R (R - 1) / ((R - 2) (R + 1) (R + 3))) is the deviation of the skewness.
            let deviation = (6.0 * (r - 1.0) / ((r - 2.0) * (r + 1.0) * (r + 3.0))).sqrt();
            return (kappa <= (3.5 * deviation).max(0.07), k_hat <= 0.12);
        }
        match self {
            Self::NearNormal => {
                (kappa <= 0.07 * (1.0 - 2.0 * k_hat.max(0.0)).max(0.0), k_hat < 0.5)
            }
            Self::Confirming => (kappa <= 0.1, k_hat <= 0.7),
        }
    }
}

/// How many samples of the largest p_k / Σ α_m p_m that there can be are taken to be uncertain,
/// whatever the samples show.
const UNSEEN: f64 = 10.0;

/// Whether ∫ p_k = 1, as the samples of all techniques have it: the standard score of
/// Σ α_i mean_i(p_k / Σ α_m p_m) - 1. `None` where it cannot be said.
///
/// p_k / Σ α_m p_m is at most 1/α_k, and where p_k is narrow, the samples of the other techniques
/// come to that rarely or not yet: the mean is then too low, and the variance far too small. So the
/// variance of ten samples of that magnitude is added. None where twelve are expected, which
/// happens in less than 1e-5 of runs, is so within 4.42.
///
/// The numbers of samples are taken as given where they are random, too.
fn density_scores(frame: &Frame<'_>, leaf: &Leaf) -> Vec<Option<f64>> {
    let techniques = frame.shares.len();
    let one = |(k, share): (usize, &f64)| {
        let (mut mean, mut variance, mut all, mut event) = (0.0, 0.0, 0.0, 0.0_f64);
        let column = leaf.node.densities.iter().skip(k).step_by(techniques);
        for (([sum, squares], alpha), seen) in column.zip(frame.shares).zip(&leaf.node.seen) {
            if *alpha > 0.0 {
                let n = seen.samples as f64;
                mean += alpha * sum / n;
                variance += alpha * alpha * (squares - sum * sum / n).max(0.0) / (n - 1.0) / n;
                all += squares;
                event = event.max(alpha / share / n);
            }
        }
        // Of too few samples, these are infinite or NaN.
        let floor = UNSEEN * event * event + NORMALISED * NORMALISED;
        let z = mean / (variance + floor).sqrt();
        (all > 0.0 && z.is_finite()).then_some(z)
    };
    frame.shares.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::{Gate, density_scores};
    use crate::estimator::{Design, Frame, OnFault, Seen};
    use crate::part::Part;
    use crate::run::state::Leaf;
    use crate::run::tally::Cells;
    use crate::run::tree::Node;
    use crate::weighting::Balance;

    /// The scores of two techniques with the deviations d_0, d_1 at the samples of each.
    fn scores(shares: [f64; 2], d: [&[[f64; 2]]; 2]) -> Vec<Option<f64>> {
        let sums = |i: usize, k: usize| {
            let column = || d[i].iter().map(move |d: &[f64; 2]| d[k]);
            [column().sum(), column().map(|d| d * d).sum()]
        };
        let densities = vec![sums(0, 0), sums(0, 1), sums(1, 0), sums(1, 1)];
        let seen = d.map(|d| Seen { samples: d.len() as u64, contributions: 0 }).to_vec();
        let node = Node { part: Part::default(), seen, densities, cells: Cells::default() };
        let on_fault = OnFault::Error;
        let design = Design::Stratified;
        let frame = Frame {
            design,
            shares: &shares,
            samples: 7,
            on_fault,
            weighting: &Balance,
            controls: None,
        };
        density_scores(&frame, &Leaf { node, tails: Vec::new() })
    }

    #[test]
    fn density_scores_by_hand() {
        let d: [&[[f64; 2]]; 2] =
            [&[[0.5, -0.25], [0.25, 0.0], [0.75, -0.5]], &[[-0.5, 0.5], [-1.0, 0.75]]];
        let found = scores([0.25, 0.75], d);
        // Means 0.5 and -0.75, variances 1/16 and 1/8; -0.25 and 0.625, 1/16 and 1/32.
        // Ten times the squares of 0.75 / 0.25 / 2 and 0.75 / 0.75 / 2 are added.
        let first =
            (0.125 - 0.5625) / (1.0 / 16.0 / 16.0 / 3.0 + 9.0 / 16.0 / 8.0 / 2.0 + 22.5_f64).sqrt();
        let second = (-0.0625 + 0.75 * 0.625)
            / (1.0 / 16.0 / 16.0 / 3.0 + 9.0 / 16.0 / 32.0 / 2.0 + 2.5_f64).sqrt();
        for (found, expected) in found.iter().zip([first, second]) {
            assert!((found.unwrap() / expected - 1.0).abs() < 1e-12, "{found:?} {expected}");
        }
    }

    #[test]
    fn densities_whose_ratio_does_not_vary() {
        let of = |d: f64| {
            let d = vec![[d, 0.0]; 3000];
            scores([0.5, 0.5], [&d, &d])
        };
        // Within rounding of each other, off by 1 %, and the same.
        assert!(of(3e-16)[0].unwrap().abs() < 1e-6);
        assert!(of(-0.01)[0].unwrap() < -9.0);
        assert_eq!((of(0.0)[0], of(1.0)[1], of(f64::NAN)[0]), (None, None, None));
    }

    #[test]
    fn the_bounds_of_the_gates_for_replicates() {
        for gate in [Gate::NearNormal, Gate::Confirming] {
            assert_eq!(gate.judge(0.49, 0.0, 16), (true, true));
            assert_eq!(gate.judge(0.50, 0.0, 16), (false, true));
            assert_eq!(gate.judge(0.5, 0.12, 8), (true, true));
            assert_eq!(gate.judge(0.5, 0.13, 8), (true, false));
            // A little skewness shows in many replicates, and does no harm.
            assert_eq!(gate.judge(0.07, 0.0, 1024), (true, true));
            assert_eq!(gate.judge(0.071, 0.0, 1024), (false, true));
            // Of two, skewness is 0, whatever they are.
            assert_eq!(gate.judge(0.0, 0.0, 2), (true, true));
            assert!(!gate.judge(f64::NAN, 0.0, 16).0);
        }
    }

    #[test]
    fn the_bounds_of_the_gates() {
        for (kappa, k_hat, near, confirm) in [
            (0.07, 0.0, true, true),
            (0.071, 0.0, false, true),
            (0.1, -1.0, false, true),
            (0.101, 0.0, false, false),
            (0.07, -1.0, true, true),
            (0.034, 0.25, true, true),
            (0.036, 0.25, false, true),
            (0.0, 0.49, true, true),
            (0.0, 0.5, false, true),
            (0.0, 0.71, false, false),
            (f64::NAN, 0.0, false, false),
            (0.1, f64::INFINITY, false, false),
        ] {
            for (gate, passes) in [(Gate::NearNormal, near), (Gate::Confirming, confirm)] {
                let (near_symmetric, light) = gate.judge(kappa, k_hat, 1);
                assert_eq!(near_symmetric && light, passes, "{kappa} {k_hat}");
            }
        }
    }
}
