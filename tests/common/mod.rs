//! What the integration tests share.
#![allow(dead_code)] // every test binary uses its own part of it

pub(crate) mod quadrature;

use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// `n` numbers uniform in the open unit interval, from a fixed stream.
pub(crate) fn canonical_numbers(seed: u64, n: usize) -> Vec<f64> {
    let mut stream = Pcg64Dxsm::seed_from_u64(seed);
    (0..n).map(|_| ((stream.next_u64() >> 12) as f64 + 0.5) * 2f64.powi(-52)).collect()
}
