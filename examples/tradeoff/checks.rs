//! Whether the numbers are right.

use mis::Fit;

use crate::entries::Way;
use crate::measure::{ROUNDING, Results};
use crate::predictions::comparable;

/// Every estimator that is unbiased is within 5 standard errors of the exact value; four of five
/// predictions that are not flagged are within 20 %, but for the statistical error of what is compared; and
/// nothing that is recommended has a larger variance than balance.
pub(crate) fn all(results: &[Results]) -> Result<String, String> {
    let (mut unbiased, mut worst) = (0, 0.0_f64);
    let (mut near, mut within, mut total, mut flagged) = (0, 0, 0, 0);
    for r in results {
        for series in &r.series {
            let name = format!("{}, {}", r.name, series.entry.name);
            if !matches!(series.entry.way, Way::Fitted(Fit::Direct)) {
                unbiased += 1;
                worst = worst.max(series.z.abs());
                if !(series.z.abs() < 5.0) {
                    return Err(format!("{name}: the mean is off by {} errors", series.z));
                }
            }
            let Some((predicted, uncertainty, caution)) = comparable(series) else { continue };
            if caution.is_some() {
                flagged += 1;
                continue;
            }
            let (value, error) = series.variance;
            let allowed = 0.2 * predicted + 2.0 * error.hypot(uncertainty * predicted);
            total += 1;
            within += usize::from((value / predicted - 1.0).abs() <= 0.2);
            near += usize::from((value - predicted).abs() <= allowed);
        }
        let (Some(plan), Some(balance)) = (r.plan(), r.named("balance")) else { continue };
        let active = plan.entry.shares.iter().filter(|share| **share > 0.0).count();
        let (value, error) = plan.variance;
        if active > 1 && value - 3.0 * error > balance.variance.0 + ROUNDING {
            return Err(format!("{}: the plan's variance is above balance's", r.name));
        }
    }
    if 5 * near < 4 * total {
        return Err(format!("{near} of {total} predictions are within 20 %"));
    }
    Ok(format!(
        "{unbiased} ensembles of unbiased estimators: the mean error is within 5 standard errors, at most \
         {worst:.2}.\n{near} of {total} predicted variances are within 20 % of the realised ones, but for the \
         statistical error of both\n({within} outright); {flagged} more are flagged by the pilot."
    ))
}
