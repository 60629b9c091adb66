//! Masses by product quadrature, for techniques of few coordinates.

use std::fmt::Debug;

use super::bins::{Binned, Edges, Total};
use super::points::{Points, Stream};
use super::statistics::Weighted;
use super::tensor::{panels, product};

/// Two orders of quadrature: in few panels, and in many or with three coordinates.
const ORDERS: [[usize; 2]; 2] = [[6, 3], [10, 5]];

/// Masses by quadrature, where it converges: of a whole, of bins and of cells.
pub(super) struct Exact {
    pub(super) total: Option<f64>,
    pub(super) marginals: Vec<Option<Vec<f64>>>,
    pub(super) joints: Vec<Option<Vec<f64>>>,
}

impl<P: Debug> Points<'_, P> {
    /// Masses by quadrature in the canonical numbers of the reference, which the coordinates must
    /// be. What two orders do not agree on is left out.
    pub(super) fn exact(
        &self,
        edges: &[Edges],
        pairs: &[(usize, usize)],
        inner: usize,
        estimate: &Total,
    ) -> Exact {
        let mut exact = Exact {
            total: None,
            marginals: vec![None; edges.len()],
            joints: vec![None; pairs.len()],
        };
        let wanted = self.options.quadrature && edges.len() <= 3 && inner == edges.len();
        if !wanted || !self.inverts(inner) {
            return exact;
        }
        let unit: Vec<Edges> = edges.iter().map(Edges::in_unit).collect();
        if edges.iter().zip(&unit).any(|(all, unit)| all != unit) {
            return exact;
        }
        let n = self.options.samples as f64;
        // The masses are as good as known if their error adds little to χ².
        let agreed = |coarse: &[f64], fine: &[f64]| {
            let miss: f64 = coarse
                .iter()
                .zip(fine)
                .map(|(a, b)| if a == b { 0.0 } else { n * (a - b).powi(2) / b.abs() })
                .sum();
            miss <= 1e-2
        };
        let both = self.row(&[], || ORDERS.map(|orders| self.product_masses(&unit, pairs, orders)));
        let Some([low, high]) = both else { return exact };
        let miss = (high.total - estimate.mean()).abs();
        if !(miss <= 6.0 * estimate.error() + self.options.integral) {
            return exact;
        }
        let agrees = (low.total - high.total).abs() <= self.options.integral;
        exact.total = agrees.then_some(high.total);
        for (to, (a, b)) in exact.joints.iter_mut().zip(low.joints.iter().zip(&high.joints)) {
            *to = agreed(&a.sum, &b.sum).then(|| b.sum.clone());
        }
        exact
    }

    /// Whether the coordinates of the reference's samples are its canonical numbers.
    fn inverts(&self, dimension: usize) -> bool {
        let mut inverts = true;
        self.rows(Stream::Laws, 256, dimension, |xi| {
            let mut c = Vec::new();
            self.row(xi, || self.coordinates(&self.sample(self.reference, xi), &mut c));
            inverts &= c.len() == xi.len() && xi.iter().zip(&c).all(|(u, c)| (u - c).abs() <= 1e-7);
        });
        inverts
    }

    fn product_masses(
        &self,
        edges: &[Edges],
        pairs: &[(usize, usize)],
        [order, lower]: [usize; 2],
    ) -> ProductMasses {
        let order = if edges.len() < 3 { order } else { lower };
        let weight = |xi: &[f64]| self.ratio(&self.sample(self.reference, xi)).1;
        let joint: Vec<_> = edges.iter().map(|e| panels(&e.joint, order)).collect();
        let empty = Binned::new(edges, pairs);
        let mut masses =
            ProductMasses { total: 0.0, marginals: empty.marginals, joints: empty.joints };
        product(&joint.iter().collect::<Vec<_>>(), |xi, cell, w| {
            let mass = w * weight(xi);
            masses.total += mass;
            for (&(d, e), joint) in pairs.iter().zip(&mut masses.joints) {
                joint.push(cell[d] * (edges[e].joint.len() + 1) + cell[e], mass);
            }
        });
        // The other coordinates in fewer panels, and many panels with fewer nodes.
        let (skip, step) = if edges.len() < 3 { (1, 3) } else { (4, 9) };
        let few = |v: &[f64]| v.iter().copied().skip(skip).step_by(step).collect::<Vec<f64>>();
        let others: Vec<_> = edges.iter().map(|e| panels(&few(&e.joint), order)).collect();
        let lower = if edges.len() == 1 { order } else { lower };
        for (d, edges) in edges.iter().enumerate() {
            let fine = panels(&edges.fine, lower);
            let mut rules: Vec<_> = others.iter().collect();
            rules[d] = &fine;
            let mut total = 0.0;
            product(&rules, |xi, bin, w| {
                let mass = w * weight(xi);
                total += mass;
                masses.marginals[d].push(bin[d], mass);
            });
            if rules.len() == 1 {
                masses.total = total;
            }
        }
        masses
    }
}

/// What product quadrature finds.
struct ProductMasses {
    total: f64,
    marginals: Vec<Weighted>,
    joints: Vec<Weighted>,
}
