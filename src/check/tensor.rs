//! Product quadrature over the unit cube, in panels.

use super::quadrature::gauss;

/// The panels of one coordinate: nodes, weights, and the panel that each belongs to.
pub(super) type Rule = Vec<(f64, f64, usize)>;

/// How often the panel of a tail is halved at most.
const HALVINGS: usize = 60;

/// Gauss' rule of `order` points between neighbours of `inner`, which are in (0, 1) and increase.
///
/// The first and the last panel hold a tail and may be many times as wide as their neighbours: they
/// are halved towards these until the parts are about as wide, and remain one panel by number.
pub(super) fn panels(inner: &[f64], order: usize) -> Rule {
    let nodes = gauss(order);
    let mut rule = Rule::new();
    let mut add = |a: f64, b: f64, k: usize| {
        rule.extend(nodes.iter().map(|(x, w)| (a + x * (b - a), w * (b - a), k)));
    };
    let [first, .., last] = inner else {
        let middle = inner.first().copied().unwrap_or(1.0);
        add(0.0, middle, 0);
        if middle < 1.0 {
            add(middle, 1.0, 1);
        }
        return rule;
    };
    let widths: Vec<f64> = inner.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let neighbour = |width: Option<&f64>| 2.0 * width.copied().unwrap_or(1.0);
    let (mut a, b) = (0.0, *first);
    for _ in 0..HALVINGS {
        if b - a <= neighbour(widths.first()) {
            break;
        }
        let middle = 0.5 * (a + b);
        add(a, middle, 0);
        a = middle;
    }
    add(a, b, 0);
    for (k, pair) in inner.windows(2).enumerate() {
        add(pair[0], pair[1], k + 1);
    }
    let (a, mut b) = (*last, 1.0);
    for _ in 0..HALVINGS {
        if b - a <= neighbour(widths.last()) {
            break;
        }
        let middle = 0.5 * (a + b);
        add(middle, b, inner.len());
        b = middle;
    }
    add(a, b, inner.len());
    rule
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
        // e^(-60 x) beyond its tenth, in one panel that is wide: halved, it is exact.
        let tail = panels(&[0.01, 0.02, 0.04], 10);
        let mass: f64 =
            tail.iter().filter(|n| n.2 == 3).map(|(x, w, _)| w * (-60.0 * x).exp()).sum();
        assert!((mass * 60.0 / (-2.4_f64).exp() - 1.0).abs() < 1e-10, "{mass}");
        for inner in [&[][..], &[0.5], &[0.1, 0.2], &[0.98, 0.99]] {
            let rule = panels(inner, 3);
            assert!((rule.iter().map(|n| n.1).sum::<f64>() - 1.0).abs() < 1e-15);
            assert_eq!(rule.iter().map(|n| n.2).max(), Some(inner.len()));
        }
        product(&[&Rule::new()], |_, _, _| panic!("there is no node"));
    }
}
