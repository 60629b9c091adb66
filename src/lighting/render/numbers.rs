//! The canonical numbers of a tile.

use crate::points::{PointSource, PointsExhausted, Random};

/// Random numbers for the samples at the ends of rays.
///
/// Every technique has the same number of samples at each ray. Their numbers depend on that of the ray
/// in the whole picture, not on the tile. Of a row of canonical numbers, the last three are the ray,
/// which is not random, and the direction; before it may be one that selects a light or a lobe, which is
/// stratified over the samples at a ray, and one that selects a technique.
#[derive(Debug)]
pub(super) struct Numbers {
    pub(super) random: Random,
    /// The number of the tile's first ray in the picture.
    pub(super) first: u64,
    pub(super) rays: u64,
    /// How many samples of each technique a ray has; of all together, if samples select theirs.
    pub(super) per_ray: Vec<u64>,
    /// How many groups the rays are dealt to, which are then replicates.
    pub(super) replicates: u64,
    /// Whether the first number of a row selects a technique.
    pub(super) selects: bool,
}

impl PointSource for Numbers {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let (technique, group) = (stream as u64 / self.replicates, stream as u64 % self.replicates);
        let technique = usize::try_from(technique).unwrap_or(usize::MAX);
        let exhausted = PointsExhausted { stream, sample: first, dimension, available: 0 };
        let per_ray = *self.per_ray.get(technique).ok_or(exhausted)?;
        // Samples of consecutive rays are consecutive, too; those of a group are so at one ray only.
        let run = if self.replicates == 1 { u64::MAX } else { per_ray };
        let ray = |sample: u64| group + self.replicates * (sample / per_ray);
        let (mut sample, mut rest) = (first, &mut *xi);
        while !rest.is_empty() {
            let left = usize::try_from(run - sample % run).unwrap_or(usize::MAX);
            let (rows, tail) = rest.split_at_mut(rest.len().min(left.saturating_mul(dimension)));
            let start = (self.first + ray(sample)) * per_ray + sample % per_ray;
            self.random.fill(technique, start, dimension, rows)?;
            sample += (rows.len() / dimension) as u64;
            rest = tail;
        }
        let selection = usize::from(self.selects);
        for (row, sample) in xi.chunks_exact_mut(dimension).zip(first..) {
            if let [.., ray_number, _, _] = row {
                *ray_number = (ray(sample) as f64 + 0.5) / self.rays as f64;
            }
            if dimension == 4 + selection
                && !self.selects
                && let [select, ..] = row
            {
                *select = ((sample % per_ray) as f64 + *select) / per_ray as f64;
            }
        }
        Ok(())
    }

    fn replicates(&self) -> usize {
        usize::try_from(self.replicates).unwrap_or(1)
    }
}
