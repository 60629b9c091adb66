//! Ensembles of estimates of one integral, and the figures they must meet.

use std::fmt::Debug;

use mis::{Estimate, Estimator, Integrand, LnValue, MultiSample, OneSample, Technique, Value};

use crate::ensemble::{Any, Spread, Z};

/// How large an ensemble is.
#[derive(Clone, Copy)]
pub(crate) struct Size {
    pub(crate) seeds: u64,
    pub(crate) samples: u64,
}

pub(crate) const QUICK: Size = Size { seeds: 200, samples: 100 };
pub(crate) const FULL: Size = Size { seeds: 2000, samples: 1000 };

/// Values whose components can be listed.
pub(crate) trait Listed: Value {
    fn list<U>(each: Self::Each<U>) -> Vec<U>;
}

impl Listed for f64 {
    fn list<U>(each: U) -> Vec<U> {
        vec![each]
    }
}

impl Listed for LnValue {
    fn list<U>(each: U) -> Vec<U> {
        vec![each]
    }
}

impl<const K: usize> Listed for [f64; K] {
    fn list<U>(each: [U; K]) -> Vec<U> {
        each.into()
    }
}

/// An integrand, its integral and the techniques for it.
pub(crate) struct Case<'a, P, F> {
    pub(crate) name: &'static str,
    pub(crate) f: F,
    pub(crate) integral: &'a [f64],
    pub(crate) techniques: &'a [&'a dyn Technique<Point = P>],
    /// Whether every technique alone has a finite variance, so that constant weights do.
    pub(crate) covered: bool,
    /// The largest standard deviation of a sample's contribution over the integral (over 1 for an
    /// integral of 0) that any estimator may have.
    pub(crate) spread: f64,
}

/// The extremes of all that was checked.
#[derive(Default)]
pub(crate) struct Battery {
    pub(crate) figures: usize,
    pub(crate) largest_z: f64,
    pub(crate) calibration: Option<[f64; 2]>,
    /// The largest deviation of a calibration ratio from 1, in units of its standard error.
    pub(crate) largest_calibration_z: f64,
}

impl Battery {
    pub(crate) fn report(&self, group: &str) {
        println!(
            "{group}: {} ensembles, largest |z| {:.2}, calibration {:.3?} (largest |z| {:.2})",
            self.figures,
            self.largest_z,
            self.calibration.unwrap_or_default(),
            self.largest_calibration_z,
        );
    }

    /// Every weighting with both estimators.
    pub(crate) fn check<P, F>(&mut self, size: Size, case: &Case<'_, P, F>)
    where
        P: Debug,
        F: Integrand<P>,
        F::Value: Listed,
    {
        let mut weightings = vec![
            Any::balance(),
            Any::power(2.0),
            Any::power(1.5),
            Any::cutoff(0.3),
            Any::maximum(),
            Any::variance_aware(
                &[10.0, 1.0, 3.0].repeat(case.techniques.len())[..case.techniques.len()],
            ),
        ];
        if case.covered {
            weightings.push(Any::equal());
        }
        // Unequal: 1 : 2 : ... for counts, ... : 2 : 1 for probabilities.
        let techniques = case.techniques;
        let parts = techniques.len() * (techniques.len() + 1) / 2;
        let counts: Vec<_> =
            (1..).map(|k| (k * size.samples).div_ceil(parts as u64)).collect_for(techniques);
        let shares: Vec<_> = (0..techniques.len())
            .map(|k| (techniques.len() - k) as f64 / parts as f64)
            .collect_for(techniques);
        for weighting in &weightings {
            let multi = MultiSample::new(&counts).unwrap().weighting(weighting).unwrap();
            self.ensemble(size, case, &format!("multi-sample, {}", weighting.0), &multi);
            let one =
                || OneSample::new(&shares, size.samples).unwrap().weighting(weighting).unwrap();
            self.ensemble(size, case, &format!("one-sample, {}", weighting.0), &one());
            let equal = one().weights_without_probabilities();
            self.ensemble(size, case, &format!("without probabilities, {}", weighting.0), &equal);
        }
    }

    pub(crate) fn ensemble<P, F, M>(
        &mut self,
        size: Size,
        case: &Case<'_, P, F>,
        how: &str,
        mis: &M,
    ) where
        P: Debug,
        F: Integrand<P>,
        F::Value: Listed,
        M: Estimator<P>,
    {
        // Every ensemble has seeds of its own.
        let first = case
            .name
            .bytes()
            .chain(how.bytes())
            .fold(0, |h: u64, byte| (h ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
        let estimates: Vec<Estimate<F::Value>> = (0..size.seeds)
            .map(|seed| mis.estimate(&case.f, first.wrapping_add(seed)).unwrap())
            .collect();
        for (c, integral) in case.integral.iter().enumerate() {
            let values = |e: &Estimate<F::Value>| F::Value::list(e.value())[c];
            let variances = |e: &Estimate<F::Value>| F::Value::list(e.variance())[c].unwrap();
            let values: Vec<f64> = estimates.iter().map(values).collect();
            let variances: Vec<f64> = estimates.iter().map(variances).collect();
            let name = format!("{}, component {c}, {how}", case.name);
            self.figures(size, &name, *integral, case.spread, &values, &variances);
        }
    }

    fn figures(
        &mut self,
        size: Size,
        name: &str,
        integral: f64,
        spread: f64,
        values: &[f64],
        variances: &[f64],
    ) {
        let (values, variances) = (Spread::of(values), Spread::of(variances));
        let scale = if integral == 0.0 { 1.0 } else { integral.abs() };
        let relative = values.error() / scale;
        let bound = spread / ((size.seeds * size.samples) as f64).sqrt();
        assert!(relative <= bound, "{name}: relative standard error {relative}, not {bound}");
        self.figures += 1;
        // Where a weighting makes the estimate exact, there is no spread to compare with.
        if relative < 1e-15 {
            assert!((values.mean / scale - integral / scale).abs() < 1e-13, "{name}: {values:?}");
            assert!(variances.mean.sqrt() < 1e-13 * scale, "{name}: {variances:?}");
            return;
        }
        let z = (values.mean - integral) / values.error();
        assert!(z.abs() <= Z, "{name}: {}, not {integral}, z = {z:.2}", values.mean);

        let ratio = variances.mean / values.variance;
        let of_reports = variances.error() / variances.mean;
        let error = ((values.kurtosis.max(3.0) - 1.0) / values.count).sqrt().hypot(of_reports);
        let deviation = (ratio - 1.0) / error;
        assert!(deviation.abs() <= Z, "{name}: reported over actual variance {ratio} ± {error}");
        self.largest_z = self.largest_z.max(z.abs());
        self.largest_calibration_z = self.largest_calibration_z.max(deviation.abs());
        let [low, high] = self.calibration.unwrap_or([ratio; 2]);
        self.calibration = Some([low.min(ratio), high.max(ratio)]);
    }
}

/// Numbers, one a technique.
pub(crate) trait CollectFor<U>: Iterator<Item = U> + Sized {
    fn collect_for<'a, P>(
        self,
        techniques: &[&'a dyn Technique<Point = P>],
    ) -> Vec<(&'a dyn Technique<Point = P>, U)> {
        techniques.iter().copied().zip(self).collect()
    }
}

impl<U, I: Iterator<Item = U>> CollectFor<U> for I {}
