//! From counters to random words.

/// The word that stands for these words, and for the purpose `lane`.
pub(super) fn hash(lane: u64, words: &[u64]) -> u64 {
    words.iter().fold(mix(lane), |h, w| mix(h ^ w))
}

/// Word `k` of the `SplitMix64` sequence that starts at `key`.
pub(super) fn word(key: u64, k: u64) -> u64 {
    mix(key.wrapping_add(k.wrapping_mul(GAMMA)))
}

/// The golden gamma.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// `SplitMix64`: add the golden gamma, then the finaliser.
fn mix(word: u64) -> u64 {
    let z = word.wrapping_add(GAMMA);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
