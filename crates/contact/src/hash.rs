//! Numbers for lists of words, to tell one from another. They depend on bits only, not on threads, processor or byte
//! order.

/// The finaliser of SplitMix64: a bijection that spreads every bit.
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A number for a list of them.
pub(crate) fn hash(words: impl Iterator<Item = u64>) -> u64 {
    words.fold(1, |hash, word| mix(hash ^ word).wrapping_add(1))
}

/// The bits of a number, with one zero.
pub(crate) fn number(x: f64) -> u64 {
    (x + 0.0).to_bits()
}
