//! Bins of coordinates, and samples in them.

use super::statistics::Weighted;

/// Bins of a coordinate in which Kolmogorov's distance is taken.
const FINE: usize = 128;
/// How many of them make a bin of χ².
pub(super) const COARSE: usize = 4;
/// Bins of a coordinate in the cells of two coordinates.
const JOINT: usize = 10;

/// How many pairs of coordinates are looked at.
const PAIRS: usize = 100;

/// The inner edges of one coordinate's bins.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Edges {
    pub(super) fine: Vec<f64>,
    pub(super) joint: Vec<f64>,
}

impl Edges {
    /// Bins of equal share of weighted `values`, as far as ties allow.
    pub(super) fn new(mut values: Vec<(f64, f64)>) -> Self {
        values.retain(|(x, w)| x.is_finite() && *w > 0.0);
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = values.iter().map(|v| v.1).sum();
        let (mut fine, mut below) = (Vec::with_capacity(FINE), 0.0);
        let mut next = 1;
        for (x, weight) in values {
            below += weight;
            while next < FINE && below >= total * next as f64 / FINE as f64 {
                fine.push(x);
                next += 1;
            }
        }
        fine.dedup();
        let joint = (1..JOINT).filter_map(|k| fine.get(k * (fine.len() + 1) / JOINT).copied());
        let mut joint: Vec<f64> = joint.collect();
        joint.dedup();
        Self { fine, joint }
    }

    /// Only the edges within the unit interval.
    pub(super) fn in_unit(&self) -> Self {
        let inner = |v: &[f64]| v.iter().copied().filter(|x| 0.0 < *x && *x < 1.0).collect();
        Self { fine: inner(&self.fine), joint: inner(&self.joint) }
    }
}

/// Pairs of coordinates whose dependence is looked at: all of up to six coordinates, neighbours of
/// more, evenly chosen where these are many.
pub(super) fn pairs(coordinates: usize) -> Vec<(usize, usize)> {
    if coordinates <= 6 {
        return (0..coordinates).flat_map(|d| (d + 1..coordinates).map(move |e| (d, e))).collect();
    }
    let step = (coordinates - 1).div_ceil(PAIRS);
    (0..coordinates - 1).step_by(step).map(|d| (d, d + 1)).collect()
}

/// Weighted samples in the bins of every coordinate and the cells of every pair.
pub(super) struct Binned {
    pub(super) marginals: Vec<Weighted>,
    pub(super) joints: Vec<Weighted>,
    pub(super) total: Total,
}

/// Sums of weights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Total {
    pub(super) count: f64,
    pub(super) sum: f64,
    pub(super) square: f64,
    pub(super) largest: f64,
}

impl Total {
    pub(super) fn push(&mut self, weight: f64) {
        self.count += 1.0;
        self.sum += weight;
        self.square += weight * weight;
        self.largest = self.largest.max(weight.abs());
    }

    pub(super) fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// The standard error of the mean.
    pub(super) fn error(&self) -> f64 {
        let variance = self.square / self.count - self.mean() * self.mean();
        (variance.max(0.0) / self.count).sqrt()
    }

    /// The largest weight's share of the sum.
    pub(super) fn share(&self) -> f64 {
        self.largest / self.sum
    }

    /// (Σ w)² / Σ w².
    pub(super) fn effective(&self) -> f64 {
        self.sum * self.sum / self.square
    }
}

impl Binned {
    pub(super) fn new(edges: &[Edges], pairs: &[(usize, usize)]) -> Self {
        let cells = |d: usize| edges.get(d).map_or(1, |e| e.joint.len() + 1);
        Self {
            marginals: edges.iter().map(|e| Weighted::new(e.fine.len() + 1)).collect(),
            joints: pairs.iter().map(|&(d, e)| Weighted::new(cells(d) * cells(e))).collect(),
            total: Total::default(),
        }
    }

    pub(super) fn push(
        &mut self,
        edges: &[Edges],
        pairs: &[(usize, usize)],
        x: &[f64],
        weight: f64,
    ) {
        self.total.push(weight);
        for ((x, edges), marginal) in x.iter().zip(edges).zip(&mut self.marginals) {
            marginal.push(edges.fine.partition_point(|edge| edge <= x), weight);
        }
        let cell = |d: usize| edges[d].joint.partition_point(|edge| *edge <= x[d]);
        for (&(d, e), joint) in pairs.iter().zip(&mut self.joints) {
            joint.push(cell(d) * (edges[e].joint.len() + 1) + cell(e), weight);
        }
    }
}

/// Every [`COARSE`] bins in one.
pub(super) fn coarse(values: &[f64]) -> Vec<f64> {
    values.chunks(COARSE).map(|bins| bins.iter().sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_quantiles() {
        let values = (0..12_800).map(|k| (f64::from(k), 1.0)).collect();
        let edges = Edges::new(values);
        assert_eq!((edges.fine.len(), edges.fine[0], edges.fine[126]), (127, 99.0, 12_699.0));
        assert_eq!((edges.joint.len(), edges.joint[4]), (9, 6499.0));
        let tied = Edges::new((0..100).map(|k| (f64::from(k % 3), 1.0)).collect());
        assert_eq!(tied.fine, [0.0, 1.0, 2.0]);
        assert!(Edges::new(vec![(f64::NAN, 1.0), (1.0, f64::NAN)]).fine.is_empty());
    }

    #[test]
    fn pairs_of_few_and_of_many() {
        assert_eq!(pairs(3), [(0, 1), (0, 2), (1, 2)]);
        assert_eq!(pairs(1), []);
        assert_eq!(pairs(0), []);
        assert_eq!((pairs(6).len(), pairs(7).len(), pairs(101).len()), (15, 6, 100));
        assert_eq!((pairs(1000).len(), pairs(1000)[99]), (100, (990, 991)));
    }
}
