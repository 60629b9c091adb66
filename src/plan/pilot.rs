//! A few samples of every technique, kept apart from any result.

use super::allocation::{self, Allocation};
use super::combining::cost_of;
use super::cost::Costs;
use super::data::Data;
use super::method::Method;
use super::newton::{Look, newton};
use super::predict::{Forecast, controls, forecast};
use super::prediction::{Caution, Prediction};
use super::{Plan, counted, counts};
use crate::error::ArgumentError;
use crate::estimator::OnFault;
use crate::weighting::VarianceAware;

/// A variance whose standard error is more than this part of it is uncertain.
const UNCERTAIN: f64 = 0.07;

/// What an optimisation of the shares may look at: densities, times what the method takes for each.
const OPERATIONS: usize = 1 << 15;

/// Up to so many techniques, shares are optimised for each weighting.
const FEW: usize = 4;

/// Evaluations of such an optimisation, at most.
const STEPS: usize = 12;

/// The densities that a method which weighs each technique's samples on its own looks at, times K.
const ROOM: usize = 1 << 19;

/// A few samples of every technique, with their pdfs and what they cost.
#[derive(Debug, Clone)]
pub struct Pilot {
    pub(super) data: Data,
    pub(super) costs: Costs,
    /// What combining costs, by kind of method; empty if costs are declared.
    pub(super) combining: Vec<(Method, f64)>,
    /// What the variance of a component counts for.
    pub(super) scales: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) floor: f64,
    pub(super) on_fault: OnFault,
}

impl Pilot {
    /// What samples cost.
    #[must_use]
    pub fn costs(&self) -> &Costs {
        &self.costs
    }

    /// The pilot's own estimate of each component.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// How many samples it has.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.data.samples as u64
    }

    /// What is to be expected of a method with these shares of the samples. For
    /// [`Method::Optimal`], any controls stand for the best.
    ///
    /// # Errors
    ///
    /// There must be a share for each technique, at least 0 and not all 0; the method must fit them.
    pub fn predict(&self, method: &Method, shares: &[f64]) -> Result<Prediction, ArgumentError> {
        const OWNER: &str = "Pilot::predict";
        let sum: f64 = shares.iter().sum();
        let fits = shares.len() == self.data.techniques && shares.iter().all(|s| *s >= 0.0);
        if !(fits && sum > 0.0 && sum.is_finite()) {
            let rule = format!(
                "there must be one for each of {} techniques, at least 0, and one greater than 0",
                self.data.techniques
            );
            return Err(ArgumentError::new(OWNER, "shares", shares, rule));
        }
        let shares: Vec<f64> = shares.iter().map(|share| share / sum).collect();
        method.check(self.data.techniques)?;
        if matches!(method, Method::Single(i) if !(shares[*i] == 1.0)) {
            let rule = "only the technique alone may have a share";
            return Err(ArgumentError::new(OWNER, "shares", shares, rule));
        }
        method.weighting()?.check(&shares)?;
        self.prediction(method, shares, false)
    }

    /// The shares of the samples with the least variance times cost, from equal ones on.
    ///
    /// # Errors
    ///
    /// The method must fit the techniques.
    pub fn allocate(&self, method: &Method) -> Result<Allocation, ArgumentError> {
        let k = self.data.techniques;
        let equal = vec![1.0 / k as f64; k];
        method.check(k)?;
        method.weighting()?.check(&equal)?;
        if let Method::Single(i) = method {
            return Ok(Allocation { shares: alone(*i, k), objective: Vec::new() });
        }
        if method.keeps_contributions() {
            let data = self.data.thinned(OPERATIONS);
            let own = self.newton(&data, method, &equal, &self.costs);
            // With unequal costs, there may be several minima: others are found from the best shares
            // without costs, and from shares in proportion to 1 / c_k.
            let each = self.costs.of(method, &equal, self.combining(method));
            let inverse: f64 = each.iter().map(|cost| cost.recip()).sum();
            let cheap: Vec<f64> = each.iter().map(|cost| cost.recip() / inverse).collect();
            if cheap.iter().all(|share| share * k as f64 > 0.7) {
                return Ok(own);
            }
            let free = Costs { sampling: vec![1.0; k], ..self.costs.clone() };
            let free = self.newton(&data, method, &equal, &free).shares;
            let others = [free, cheap].map(|start| self.newton(&data, method, &start, &self.costs));
            let last = |a: &Allocation| a.objective.last().copied().unwrap_or(f64::INFINITY);
            let better = |a, b| if last(&b) < last(&a) { b } else { a };
            return Ok(others.into_iter().fold(own, better));
        }
        if k > FEW {
            // Each step would take K² looks: the shares that are best for the balance heuristic.
            let shares = self.allocate(&Method::Balance)?.shares;
            return Ok(Allocation { shares, objective: Vec::new() });
        }
        // Each evaluation takes longer, and a slope takes K + 1 of them.
        let data = self.data.thinned(OPERATIONS / (4 * k));
        let total = |shares: &[f64]| -> Option<f64> {
            let (_, forecast) = forecasted(&data, method, shares, &self.scales, false).ok()?;
            Some(forecast.total(&self.scales))
        };
        Ok(allocation::optimise(&equal, self.floor, STEPS, |shares| {
            let v = total(shares)?;
            let costs = self.costs.of(method, shares, self.combining(method));
            Some((v, slope(shares, v, total)?, costs))
        }))
    }

    fn newton(&self, data: &Data, method: &Method, start: &[f64], costs: &Costs) -> Allocation {
        newton(start, self.floor, |shares| {
            let costs = costs.of(method, shares, self.combining(method));
            look(data, method, shares, &self.scales, costs)
        })
    }

    /// The best plan, and what all others would come to.
    ///
    /// # Errors
    ///
    /// None that is known of: the methods fit the techniques.
    pub fn plan(&self) -> Result<Plan, ArgumentError> {
        let mut predictions = self.predictions()?;
        predictions.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        let best = predictions.first().cloned();
        let faults_at_most = match self.on_fault {
            OnFault::CountAsZero { at_most } => Some(at_most),
            OnFault::Error => None,
        };
        let (method, shares) =
            best.map_or((Method::Balance, Vec::new()), |best| (best.method, best.shares));
        Ok(Plan {
            method,
            counts: counts(&shares),
            predictions,
            costs: self.costs.clone(),
            pilot_samples: self.samples(),
            pilot_value: self.values.clone(),
            faults_at_most,
        })
    }

    /// Of all methods, with equal and with optimised shares.
    fn predictions(&self) -> Result<Vec<Prediction>, ArgumentError> {
        let k = self.data.techniques;
        let singles = (0..k)
            .map(|i| self.prediction(&Method::Single(i), alone(i, k), false))
            .collect::<Result<Vec<_>, _>>()?;
        if k == 1 {
            return Ok(singles);
        }
        let mut methods =
            vec![Method::Balance, Method::Power(2.0), Method::Cutoff(0.1), Method::Maximum];
        methods.push(Method::OneSample);
        methods.push(Method::VarianceAware(self.factors(&singles)));
        methods.push(Method::Constant(vec![1.0 / k as f64; k]));
        methods.extend(self.inverse_variance(&singles));
        let equal = vec![1.0 / k as f64; k];
        if let Some((controls, _)) = controls(&self.data, &equal) {
            methods.push(Method::Optimal(controls));
        }
        let mut all = singles;
        for method in &methods {
            let before = self.prediction(method, equal.clone(), false)?;
            if !matches!(before.caution, Some(Caution::Biased { .. } | Caution::NoSignal)) {
                let optimised = counted(&self.allocate(method)?.shares);
                all.push(self.prediction(method, optimised, true)?);
            }
            all.push(before);
        }
        Ok(all)
    }

    fn prediction(
        &self,
        method: &Method,
        shares: Vec<f64>,
        optimised: bool,
    ) -> Result<Prediction, ArgumentError> {
        // A method that weighs each technique's samples on its own takes K times as long.
        let most = ROOM / self.data.techniques;
        let thinned = matches!(
            method,
            Method::Power(_) | Method::Cutoff(_) | Method::Maximum | Method::VarianceAware(_)
        )
        .then(|| self.data.thinned(most));
        let data = thinned.as_ref().unwrap_or(&self.data);
        let (method, forecast) = forecasted(data, method, &shares, &self.scales, false)?;
        let of = self.costs.of(&method, &shares, self.combining(&method));
        let cost: f64 = shares.iter().zip(of).map(|(share, cost)| share * cost).sum();
        let efficiency = (forecast.total(&self.scales) * cost).recip();
        let signal = self.scales.iter().any(|scale| *scale > 0.0);
        let caution = match forecast.uncovered {
            _ if !signal => Some(Caution::NoSignal),
            Some(technique) => Some(Caution::Biased { technique }),
            None if forecast.is_heavy(&self.scales) => Some(Caution::HeavyTail),
            None if !forecast.is_certain(UNCERTAIN, &self.scales) => Some(Caution::Uncertain),
            None => None,
        };
        let Forecast { variance, uncertainty, .. } = forecast;
        Ok(Prediction {
            method,
            shares,
            optimised,
            variance,
            uncertainty,
            cost,
            efficiency,
            caution,
        })
    }

    fn combining(&self, method: &Method) -> f64 {
        cost_of(&self.combining, method).unwrap_or(self.costs.combining)
    }

    /// Variance-aware factors, from the variances of the techniques alone; of the first component that
    /// counts.
    fn factors(&self, singles: &[Prediction]) -> Vec<f64> {
        let c = self.scales.iter().position(|scale| *scale > 0.0).unwrap_or(0);
        let mean = self.values.get(c).copied().unwrap_or(0.0);
        let one = |single: &Prediction| match single.caution {
            Some(Caution::Biased { .. }) => 1.0,
            _ => VarianceAware::factor(mean, single.variance[c]),
        };
        singles.iter().map(one).collect()
    }

    /// Constant weights in proportion to 1 / V_i, without techniques whose variance is not known;
    /// `None` if fewer than two are left.
    fn inverse_variance(&self, singles: &[Prediction]) -> Option<Method> {
        let total = |p: &Prediction| -> f64 {
            p.variance.iter().zip(&self.scales).map(|(v, scale)| v * scale).sum()
        };
        let of = |p: &Prediction| {
            let known = !matches!(p.caution, Some(Caution::Biased { .. } | Caution::HeavyTail));
            if known && total(p) > 0.0 { total(p).recip() } else { 0.0 }
        };
        let inverse: Vec<f64> = singles.iter().map(of).collect();
        let sum: f64 = inverse.iter().sum();
        let several = inverse.iter().filter(|v| **v > 0.0).count() > 1;
        (several && sum.is_finite())
            .then(|| Method::Constant(inverse.iter().map(|v| v / sum).collect()))
    }
}

/// All samples of one technique.
fn alone(i: usize, techniques: usize) -> Vec<f64> {
    (0..techniques).map(|k| f64::from(u8::from(k == i))).collect()
}

/// What an optimisation of the shares looks at.
pub(super) fn look(
    data: &Data,
    method: &Method,
    shares: &[f64],
    scales: &[f64],
    costs: Vec<f64>,
) -> Option<Look> {
    let (_, forecast) = forecasted(data, method, shares, scales, true).ok()?;
    let variance = forecast.total(scales);
    Some(Look { variance, slope: forecast.gradient?, curvature: forecast.curvature?, costs })
}

/// By what a prediction is preferred: its efficiency, as far as it is known.
fn worth(prediction: &Prediction) -> f64 {
    let uncertainty = prediction.uncertainty.iter().copied().fold(0.0, f64::max);
    let sure = prediction.efficiency / (1.0 + 2.0 * uncertainty);
    // What relies on every technique to reach all of f has to be better for that.
    let relied = if prediction.method.evaluates_all() { 1.0 } else { 1.05 };
    match prediction.caution {
        Some(Caution::Biased { .. }) => -1.0,
        Some(Caution::NoSignal) => f64::from(prediction.method == Method::Balance),
        Some(Caution::HeavyTail) => 0.5 * sure / relied,
        _ => sure / relied,
    }
}

/// The forecast for a method; for optimal MIS, with the controls that are best for the shares.
pub(super) fn forecasted(
    data: &Data,
    method: &Method,
    shares: &[f64],
    scales: &[f64],
    bends: bool,
) -> Result<(Method, Forecast), ArgumentError> {
    if !matches!(method, Method::Optimal(_)) {
        return Ok((method.clone(), forecast(data, method, shares, scales, bends)?));
    }
    let Some((controls, rank)) = controls(data, shares) else {
        return Ok((method.clone(), forecast(data, method, shares, scales, bends)?));
    };
    let method = Method::Optimal(controls);
    let mut forecast = forecast(data, &method, shares, scales, bends)?;
    // Residuals of a fit are smaller than those of other samples.
    let (n, rank) = (data.samples as f64, rank as f64);
    forecast.variance.iter_mut().for_each(|v| *v *= (n + rank) / (n - rank));
    Ok((method, forecast))
}

/// -∂V/∂α_k by differences, for V as it falls with numbers of samples: 1/s if all shares grow by s.
fn slope(shares: &[f64], v: f64, total: impl Fn(&[f64]) -> Option<f64>) -> Option<Vec<f64>> {
    const STEP: f64 = 1e-3;
    let one = |k: usize| {
        let mut more = shares.to_vec();
        more[k] *= 1.0 + STEP;
        let sum: f64 = more.iter().sum();
        for share in &mut more {
            *share /= sum;
        }
        // V of shares that do not sum to 1 is less by their sum.
        Some((v - total(&more)? / sum) / (STEP * shares[k]))
    };
    (0..shares.len()).map(one).collect()
}
