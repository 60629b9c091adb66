//! The direction numbers of Sobol' points.

use std::sync::LazyLock;

use sobol::SobolParams;
use sobol::params::JoeKuoD6;

/// Column l of a generator matrix, the digits of a coordinate from the highest bit down, is what
/// digit l of the index adds to the coordinate.
pub(super) type Columns = [u64; 64];

/// The most dimensions that there are direction numbers for.
pub(super) const MOST: usize = 21_201;

/// The columns of the first `dimensions` dimensions; `None` if there are not as many.
///
/// They are unpacked when they are first asked for, all of them in some milliseconds, to 11 MB.
pub(super) fn columns(dimensions: usize) -> Option<&'static [Columns]> {
    static HUNDRED: LazyLock<Vec<Columns>> = LazyLock::new(|| unpacked(&JoeKuoD6::minimal()));
    static THOUSAND: LazyLock<Vec<Columns>> = LazyLock::new(|| unpacked(&JoeKuoD6::standard()));
    static ALL: LazyLock<Vec<Columns>> = LazyLock::new(|| unpacked(&JoeKuoD6::extended()));
    let known = match dimensions {
        0..=100 => &HUNDRED,
        101..=1000 => &THOUSAND,
        _ => &ALL,
    };
    known.get(..dimensions)
}

/// The first dimension is van der Corput's sequence. Each other one has a primitive polynomial
/// x^s + a_1 x^(s-1) + ... + 1 over GF(2) and s odd numbers m to begin with; column l is
/// v_l = a_1 v_(l-1) + ... + a_(s-1) v_(l-s+1) + v_(l-s) + v_(l-s) / 2^s, sums without carry.
fn unpacked(parameters: &JoeKuoD6) -> Vec<Columns> {
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
    use super::{MOST, columns};
    use sobol::Sobol;
    use sobol::params::JoeKuoD6;

    /// Against the points that the crate with the parameters makes of them: 32 bits of them.
    #[test]
    fn agree_with_another_generator() {
        for (dimensions, parameters) in [(100, JoeKuoD6::minimal()), (1000, JoeKuoD6::standard())] {
            let directions = columns(dimensions).unwrap();
            let mut x = vec![0_u64; dimensions];
            for (n, point) in (1_u64..).zip(Sobol::<u32>::new(dimensions, &parameters).take(300)) {
                let top: Vec<u32> = x.iter().map(|x| u32::try_from(x >> 32).unwrap()).collect();
                assert_eq!(top, point, "{n}");
                for (x, columns) in x.iter_mut().zip(directions) {
                    *x ^= columns[n.trailing_zeros() as usize];
                }
            }
        }
    }

    /// Every column has its lowest digit on the diagonal: the points of a coordinate fill all
    /// intervals of length 2^-m, 2^m at a time.
    #[test]
    fn matrices_are_triangular() {
        for matrix in columns(MOST).unwrap() {
            for (l, v) in matrix.iter().enumerate() {
                assert_eq!(v.trailing_zeros() as usize, 63 - l);
            }
        }
    }

    #[test]
    fn tables_agree_and_end() {
        let all = columns(MOST).unwrap().to_vec();
        assert_eq!(columns(1000).unwrap(), &all[..1000]);
        assert_eq!(columns(100).unwrap(), &all[..100]);
        assert_eq!(columns(3).unwrap(), &all[..3]);
        assert!(columns(MOST + 1).is_none());
        assert_eq!(columns(0).unwrap().len(), 0);
    }
}
