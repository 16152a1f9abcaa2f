//! Lists of positions by key, one behind the other.

/// Sorts the positions of `keys`, which are below `count`, into one bucket for each key, ascending in each. Returns the
/// start of each bucket (and the end of the last) and the positions.
///
/// ```
/// let (starts, positions) = signorini_fem_mesh::buckets(3, &[2, 0, 2]);
/// assert_eq!((starts, positions), (vec![0, 1, 1, 3], vec![1, 0, 2]));
/// ```
///
/// # Panics
/// If a key is not below `count`.
#[must_use]
pub fn buckets(count: usize, keys: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; count + 1];
    for &key in keys {
        starts[key as usize + 1] += 1;
    }
    for k in 0..count {
        starts[k + 1] += starts[k];
    }
    let (mut next, mut positions) = (starts.clone(), vec![0; keys.len()]);
    for (position, &key) in keys.iter().enumerate() {
        let at = &mut next[key as usize];
        positions[*at as usize] = position as u32;
        *at += 1;
    }
    (starts, positions)
}

/// The range of one bucket, from the starts.
pub(crate) fn range(starts: &[u32], bucket: usize) -> std::ops::Range<usize> {
    starts[bucket] as usize..starts[bucket + 1] as usize
}

#[cfg(test)]
mod tests {
    use super::{buckets, range};

    #[test]
    fn buckets_keep_the_order_of_positions() {
        let (starts, positions) = buckets(4, &[2, 0, 2, 3, 0]);
        assert_eq!(starts, [0, 2, 2, 4, 5]);
        assert_eq!(positions, [1, 4, 0, 2, 3]);
        assert!(range(&starts, 0) == (0..2) && range(&starts, 1).is_empty());
        assert_eq!(buckets(0, &[]), (vec![0], vec![]));
    }
}
