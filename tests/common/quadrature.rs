//! Quadrature as an oracle: independent of every technique and every estimator.

/// Nodes and weights of the 4-point Gauss rule on `panels` equal parts of the unit interval.
pub(crate) fn gauss(panels: usize) -> Vec<(f64, f64)> {
    const RULE: [(f64, f64); 4] = [
        (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    ];
    let width = 1.0 / panels as f64;
    (0..panels)
        .flat_map(|k| RULE.map(|(x, w)| ((k as f64 + 0.5 + 0.5 * x) * width, 0.5 * w * width)))
        .collect()
}
