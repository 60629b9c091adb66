//! Never worse than the balance heuristic.

use crate::cases;
use crate::ensembles::{FITS, Mean, ensemble, name, ratio, squares};

#[test]
#[ignore = "takes minutes"]
fn explore() {
    let only = std::env::var("CASE").unwrap_or_default();
    let seeds: u64 = std::env::var("SEEDS").map_or(2000, |s| s.parse().unwrap());
    let per: Vec<u64> = std::env::var("PER")
        .unwrap_or("50,200".into())
        .split(',')
        .map(|s| s.parse().unwrap())
        .collect();
    for case in cases::all() {
        if !case.name.contains(&only) {
            continue;
        }
        for per in &per {
            let n = per * case.techniques;
            let balance = ensemble(&case, None, n, seeds);
            print!("{:28} N={:5} ", case.name, n);
            for fit in FITS {
                let found = ensemble(&case, Some(fit), n, seeds);
                let r = ratio(&squares(&case, &found, &balance));
                let bias = Mean::of(found.iter().map(|f| f.value)).z(case.integral);
                let cal: Vec<_> = found
                    .iter()
                    .map(|f| ((f.value - case.integral).powi(2), f.variance.unwrap_or(0.0)))
                    .collect();
                let cal = ratio(&cal);
                let cover = found.iter().filter(|f| f.holds).count() as f64 / seeds as f64;
                let kappa = Mean::of(found.iter().map(|f| f.kappa.unwrap_or(9.0)));
                let unc = found.iter().filter(|f| f.uncontrolled == n).count();
                print!(
                    "| {:5} r {:.4}({:.3}) bias {:5.1} cal {:.3}({:.3}) cov {:.3} k {:.3} u{} ",
                    &name(Some(fit))[..5],
                    r.mean,
                    r.error,
                    bias,
                    cal.mean,
                    cal.error,
                    cover,
                    kappa.mean,
                    unc
                );
            }
            println!();
        }
    }
}
