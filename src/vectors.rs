//! Vector instructions of the processor at hand, found out when the program runs.
//!
//! The default target of x86-64 has vectors of two numbers; nearly every processor has four. No
//! result depends on it: products and sums are never contracted.

#![expect(clippy::inline_always, reason = "what is not inlined is not compiled for the vectors")]

use fearless_simd::Level;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use fearless_simd::Simd;

/// Runs `work`, whose loops become vector instructions where they can.
///
/// What `work` calls takes part only if it is inlined.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(avx2) = Level::new().as_avx2() {
        return avx2.vectorize(work);
    }
    work()
}
