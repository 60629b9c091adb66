//! Predicted variances against realised ones.

use mis::plan::{Caution, Planner};

use crate::measure::{Known, measure, parallel};
use crate::problems::problems;

#[test]
#[ignore = "minutes in release"]
fn explore() {
    let seeds: u64 = std::env::var("SEEDS").map_or(4, |s| s.parse().unwrap());
    let samples: u64 = std::env::var("SAMPLES").map_or(1 << 17, |s| s.parse().unwrap());
    let only = std::env::var("ONLY").unwrap_or_default();
    let kind =
        crate::problems::KINDS[std::env::var("KIND").map_or(0, |s| s.parse::<usize>().unwrap())];
    let (mut rows, mut flagged, mut off) = (0, 0, 0);
    let mut problems = problems();
    problems.retain(|p| p.name.contains(&only));
    for problem in &problems {
        let known = Known::default();
        let planner = Planner::new().samples(4096).unwrap();
        let all = parallel(seeds as usize, |seed| {
            measure(problem, &planner, kind, seed as u64, samples, &known)
        });
        let (mut r, mut fl, mut of, mut recommended, mut bad) = (0, 0, 0, Vec::new(), 0);
        for m in &all {
            let known = m.rows[0].efficiency.is_finite();
            let relative = if known { m.recommended() } else { 1.0 };
            if relative < 0.9 {
                bad += 1;
                let b = m.rows.iter().max_by(|a, b| {
                    let key = |r: &crate::measure::Row| {
                        if r.efficiency.is_finite() && r.noise <= 0.1 { r.efficiency } else { 0.0 }
                    };
                    key(a).total_cmp(&key(b))
                });
                println!(
                    "    BAD seed {} {:.3}: {} opt {} {:?}; best {} opt {} pred {:.3e} real {:?} {:?}",
                    m.seed,
                    relative,
                    m.rows[0].prediction.method,
                    m.rows[0].prediction.optimised,
                    m.rows[0].prediction.caution,
                    b.unwrap().prediction.method,
                    b.unwrap().prediction.optimised,
                    b.unwrap().prediction.variance[0],
                    b.unwrap().realised,
                    b.unwrap().prediction.caution
                );
            }
            recommended.push(relative);
            for row in &m.rows {
                r += 1;
                if row.prediction.caution.is_some() {
                    fl += 1;
                } else if !m.is_within(row, 0.2) {
                    of += 1;
                    println!(
                        "    OFF seed {} {} opt {}: predicted {:?} (±{:.3?}) realised {:?} noise {:.3} shares {:.3?}",
                        m.seed,
                        row.prediction.method,
                        row.prediction.optimised,
                        row.prediction.variance,
                        row.prediction.uncertainty,
                        row.realised,
                        row.noise,
                        row.prediction.shares
                    );
                }
            }
        }
        let heavy = |m: &crate::measure::Measured| {
            m.rows.iter().filter(|r| r.prediction.caution == Some(Caution::HeavyTail)).count()
        };
        let heavies: usize = all.iter().map(heavy).sum();
        println!(
            "{:<28} rows {r:>4} flagged {fl:>4} (heavy {heavies}) off {of:>3}  recommended min {:.3} bad {bad}",
            problem.name,
            recommended.iter().copied().fold(f64::INFINITY, f64::min)
        );
        (rows, flagged, off) = (rows + r, flagged + fl, off + of);
    }
    println!("rows {rows} flagged {flagged} off {off}");
}
