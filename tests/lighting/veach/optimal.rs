//! Optimal MIS in every cell.

use super::{Cell, Node, PLATES, TABLE};
use mis::lighting::Direction;
use mis::{Controls, Estimator, Fit, MultiSample, OptimalMis, Technique};

/// The coefficient β of p_bsdf - p_light that leaves the least of f - (μ (p_light + p_bsdf) / 2 + …),
/// in the norm ∫ (…)² / c; and μ and what is left.
pub(super) fn optimal(nodes: &[Node]) -> (f64, f64, f64) {
    let sum = |of: &dyn Fn(&Node) -> f64| nodes.iter().map(|n| n.weight * of(n)).sum::<f64>();
    // Outside of the cone, where f and p_light are 0, is the rest of p_bsdf.
    let outside = 1.0 - sum(&|n| n.p[1]);
    let c = |n: &Node| n.p[0] + n.p[1];
    let entry = |i: usize, k: usize| {
        sum(&|n| n.p[i] * n.p[k] / c(n)) + if i + k == 2 { outside } else { 0.0 }
    };
    let [a, b, d] = [entry(0, 0), entry(0, 1), entry(1, 1)];
    let [s, t] = [0, 1].map(|i| sum(&|n| n.f * n.p[i] / c(n)));
    let det = a * d - b * b;
    let (x, y) = ((d * s - b * t) / det, (a * t - b * s) / det);
    let left = sum(&|n| (n.f - x * n.p[0] - y * n.p[1]).powi(2) / c(n)) + y * y * outside;
    (0.5 * (y - x), x + y, left)
}

#[test]
fn optimal_mis_has_the_variances_of_the_table() {
    for (plate, expected) in TABLE.map(|rows| rows.map(|row| row[9])).into_iter().enumerate() {
        for (light, expected) in expected.into_iter().enumerate() {
            let cell = Cell::new(plate, light);
            let (beta, integral, _) = optimal(&cell.nodes(PLATES[plate].2));
            let (f, lobe) = (cell.integrand(), cell.lobe());
            let list: [(&dyn Technique<Point = Direction>, u64); 2] =
                [(cell.light(), 6000), (&lobe, 6000)];
            let relative = |estimate: &mis::Estimate, what: &str| {
                let error = estimate.standard_error().unwrap();
                let z = (estimate.value() - integral) / error;
                assert!(z.abs() < 5.0, "{plate} {light} {what}: {estimate} for {integral}, {z}");
                6e3 * (error / integral).powi(2) / expected
            };
            let controls = Controls::new(0, [[0.0, beta]]).unwrap();
            let exact = MultiSample::new(&list).unwrap().controls(controls).unwrap();
            let mut ratios = vec![relative(&exact.estimate(&f, 7).unwrap(), "exact")];
            for fit in [Fit::default(), Fit::Direct] {
                let mis = OptimalMis::new(&list).unwrap().fit(fit).unwrap();
                let found = mis.estimate(&f, 7).unwrap();
                ratios.push(relative(found.estimate(), "fitted"));
            }
            // The variance itself has an error of a few percent.
            assert!(
                ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.15),
                "{plate} {light} {ratios:?}"
            );
        }
    }
}
