//! The direction numbers of Sobol' points.

use std::sync::OnceLock;

use sobol::SobolParams;
use sobol::params::JoeKuoD6;

/// Column l of a generator matrix, the digits of a coordinate from the highest bit down, is what
/// digit l of the index adds to the coordinate.
pub(super) type Columns = [u64; 64];

/// The most dimensions that there are direction numbers for.
pub(super) const MOST: usize = 21_201;

/// The direction numbers of as many dimensions as were asked for yet: unpacking them all takes
/// some milliseconds and 11 MB.
#[derive(Clone, Default)]
pub(super) struct Directions {
    hundred: OnceLock<Vec<Columns>>,
    thousand: OnceLock<Vec<Columns>>,
    all: OnceLock<Vec<Columns>>,
}

impl Directions {
    /// Those of the first `dimensions` dimensions; `None` if there are not as many.
    pub(super) fn first(&self, dimensions: usize) -> Option<&[Columns]> {
        let known = match dimensions {
            0..=100 => self.hundred.get_or_init(|| columns(&JoeKuoD6::minimal())),
            101..=1000 => self.thousand.get_or_init(|| columns(&JoeKuoD6::standard())),
            _ => self.all.get_or_init(|| columns(&JoeKuoD6::extended())),
        };
        known.get(..dimensions)
    }
}

/// The first dimension is van der Corput's sequence. Each other one has a primitive polynomial
/// x^s + a_1 x^(s-1) + ... + 1 over GF(2) and s odd numbers m to begin with; column l is
/// v_l = a_1 v_(l-1) + ... + a_(s-1) v_(l-s+1) + v_(l-s) + v_(l-s) / 2^s, sums without carry.
fn columns(parameters: &JoeKuoD6) -> Vec<Columns> {
    let first = std::array::from_fn(|l| 1 << (63 - l));
    let others = (2..=parameters.max_dims()).map(|dimension| {
        let parameters = parameters.get_dim(dimension);
        let s = parameters.s();
        let mut v = [0; 64];
        for (l, v) in v.iter_mut().enumerate().take(s) {
            *v = u64::from(parameters.m(l)) << (63 - l);
        }
        for l in s..64 {
            let terms = (1..s).filter(|k| parameters.coefficient(s - k - 1) == 1);
            v[l] = terms.fold(v[l - s] ^ (v[l - s] >> s), |sum, k| sum ^ v[l - k]);
        }
        v
    });
    std::iter::once(first).chain(others).collect()
}

#[cfg(test)]
mod tests {
    use super::{Directions, MOST};
    use sobol::Sobol;
    use sobol::params::JoeKuoD6;

    /// Against the points that the crate with the parameters makes of them: 32 bits of them.
    #[test]
    fn agree_with_another_generator() {
        let directions = Directions::default();
        for (dimensions, parameters) in [(100, JoeKuoD6::minimal()), (1000, JoeKuoD6::standard())] {
            let columns = directions.first(dimensions).unwrap();
            let mut x = vec![0_u64; dimensions];
            for (n, point) in (1_u64..).zip(Sobol::<u32>::new(dimensions, &parameters).take(300)) {
                let top: Vec<u32> = x.iter().map(|x| u32::try_from(x >> 32).unwrap()).collect();
                assert_eq!(top, point, "{n}");
                for (x, columns) in x.iter_mut().zip(columns) {
                    *x ^= columns[n.trailing_zeros() as usize];
                }
            }
        }
    }

    /// Every column has its lowest digit on the diagonal: the points of a coordinate fill all
    /// intervals of length 2^-m, 2^m at a time.
    #[test]
    fn matrices_are_triangular() {
        let directions = Directions::default();
        for columns in directions.first(MOST).unwrap() {
            for (l, v) in columns.iter().enumerate() {
                assert_eq!(v.trailing_zeros() as usize, 63 - l);
            }
        }
    }

    #[test]
    fn tables_agree_and_end() {
        let directions = Directions::default();
        let all = directions.first(MOST).unwrap().to_vec();
        assert_eq!(directions.first(1000).unwrap(), &all[..1000]);
        assert_eq!(directions.first(100).unwrap(), &all[..100]);
        assert_eq!(directions.first(3).unwrap(), &all[..3]);
        assert!(directions.first(MOST + 1).is_none());
        assert_eq!(directions.first(0).unwrap().len(), 0);
    }
}
