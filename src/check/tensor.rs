//! Product quadrature over the unit cube, in panels.

use super::quadrature::gauss;

/// The panels of one coordinate: nodes, weights, and the panel that each belongs to.
pub(super) type Rule = Vec<(f64, f64, usize)>;

/// Gauss' rule of `order` points between neighbours of `inner`, which are in (0, 1) and increase.
pub(super) fn panels(inner: &[f64], order: usize) -> Rule {
    let nodes = gauss(order);
    let lower = std::iter::once(0.0).chain(inner.iter().copied());
    let upper = inner.iter().copied().chain([1.0]);
    let panels = lower.zip(upper).enumerate();
    panels
        .flat_map(|(k, (a, b))| {
            nodes.iter().map(move |(x, w)| (a + x * (b - a), w * (b - a), k)).collect::<Rule>()
        })
        .collect()
}

/// Calls `visit` with every node of the product of `rules`, its panels and its weight.
pub(super) fn product(rules: &[&Rule], mut visit: impl FnMut(&[f64], &[usize], f64)) {
    let mut index = vec![0; rules.len()];
    let mut node = vec![0.0; rules.len()];
    let mut panel = vec![0; rules.len()];
    if rules.iter().any(|rule| rule.is_empty()) {
        return;
    }
    loop {
        let mut weight = 1.0;
        for (d, rule) in rules.iter().enumerate() {
            let (x, w, k) = rule[index[d]];
            (node[d], panel[d]) = (x, k);
            weight *= w;
        }
        visit(&node, &panel, weight);
        let mut d = 0;
        loop {
            if d == rules.len() {
                return;
            }
            index[d] += 1;
            if index[d] < rules[d].len() {
                break;
            }
            index[d] = 0;
            d += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_their_mass() {
        let (x, y) = (panels(&[0.25], 3), panels(&[0.5, 0.75], 3));
        let mut mass = [[0.0; 3]; 2];
        product(&[&x, &y], |at, cell, weight| {
            mass[cell[0]][cell[1]] += weight * 4.0 * at[0] * at[1];
        });
        for (row, dx) in mass.iter().zip([0.0625, 0.9375]) {
            for (cell, dy) in row.iter().zip([0.25, 0.3125, 0.4375]) {
                assert!((cell / (dx * dy) - 1.0).abs() < 1e-14);
            }
        }
        product(&[&Rule::new()], |_, _, _| panic!("there is no node"));
    }
}
