//! The canonical numbers of a tile.

use crate::points::{PointSource, PointsExhausted, Random};

/// Random numbers for the samples at the ends of rays.
///
/// Every technique has the same number of samples at each ray. Their numbers depend on that of the ray
/// in the whole picture, not on the tile. Of a row of canonical numbers, the last three are the ray,
/// which is not random, and the direction; before it may be one that selects a light or a lobe, which is
/// stratified over the samples at a ray, and one that selects a technique.
#[derive(Debug)]
pub(super) struct Numbers<'a> {
    pub(super) random: Random,
    /// The numbers of the rays in the picture, in ascending order.
    pub(super) rays: &'a [u64],
    /// How many samples of each technique a ray has; of all together, if samples select theirs.
    pub(super) per_ray: Vec<u64>,
    /// How many groups the rays are dealt to, which are then replicates.
    pub(super) replicates: u64,
    /// Whether the first number of a row selects a technique.
    pub(super) selects: bool,
}

impl PointSource for Numbers<'_> {
    fn fill(
        &self,
        stream: usize,
        first: u64,
        dimension: usize,
        xi: &mut [f64],
    ) -> Result<(), PointsExhausted> {
        let (technique, group) = (stream as u64 / self.replicates, stream as u64 % self.replicates);
        let technique = usize::try_from(technique).unwrap_or(usize::MAX);
        let exhausted = |sample| PointsExhausted { stream, sample, dimension, available: 0 };
        let per_ray = *self.per_ray.get(technique).ok_or_else(|| exhausted(first))?;
        let place = |sample: u64| group + self.replicates * (sample / per_ray);
        let number = |sample| self.rays.get(usize::try_from(place(sample)).ok()?).copied();
        let (mut sample, mut rest) = (first, &mut *xi);
        while !rest.is_empty() {
            // Consecutive samples of consecutive rays have consecutive numbers.
            let ray = number(sample).ok_or_else(|| exhausted(sample))?;
            let end = sample + (rest.len() / dimension) as u64;
            let mut next = sample - sample % per_ray + per_ray;
            while next < end
                && number(next).is_some_and(|n| n - ray == (next - sample).div_ceil(per_ray))
            {
                next += per_ray;
            }
            let rows = usize::try_from(next.min(end) - sample).unwrap_or(usize::MAX);
            let (rows, tail) = rest.split_at_mut(rows * dimension);
            self.random.fill(technique, ray * per_ray + sample % per_ray, dimension, rows)?;
            (sample, rest) = (next, tail);
        }
        // One that selects a light or a lobe is before the last three.
        let stratified = dimension == 4 && !self.selects;
        let (rays, part) = ((self.rays.len() as f64).recip(), (per_ray as f64).recip());
        let (mut at, mut of_ray) = (place(first), first % per_ray);
        for row in xi.chunks_exact_mut(dimension) {
            if let [.., ray_number, _, _] = row {
                *ray_number = (at as f64 + 0.5) * rays;
            }
            if stratified && let [select, ..] = row {
                *select = (of_ray as f64 + *select) * part;
            }
            of_ray += 1;
            if of_ray == per_ray {
                (at, of_ray) = (at + self.replicates, 0);
            }
        }
        Ok(())
    }

    fn replicates(&self) -> usize {
        usize::try_from(self.replicates).unwrap_or(1)
    }
}
