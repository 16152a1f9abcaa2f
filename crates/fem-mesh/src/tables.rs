//! Lists of positions by key, and sets of numbers that grow together.

/// Sorts the positions of `keys`, which are below `count`, into one bucket for each key, ascending in each. Returns the
/// start of each bucket (and the end of the last) and the positions.
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

/// A partition of the numbers below a count: numbers that are joined, directly or by others, are in one set.
#[derive(Debug, Clone)]
pub struct DisjointSets {
    /// A smaller member of the same set, or the number itself.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every number alone.
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
        }
    }

    /// Makes one set of those of two numbers.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }

    /// The smallest number of the set with this one.
    pub fn first(&mut self, mut number: usize) -> usize {
        while self.parent[number] as usize != number {
            let parent = self.parent[number] as usize;
            self.parent[number] = self.parent[parent];
            number = self.parent[number] as usize;
        }
        number
    }

    /// The set of each number; sets are counted in the order of their smallest numbers.
    pub fn numbers(&mut self) -> Vec<u32> {
        let mut out = vec![0; self.parent.len()];
        let mut count = 0;
        for number in 0..out.len() {
            let first = self.first(number);
            out[number] = if first == number {
                count += 1;
                count - 1
            } else {
                out[first]
            };
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_keep_the_order_of_positions() {
        let (starts, positions) = buckets(4, &[2, 0, 2, 3, 0]);
        assert_eq!(starts, [0, 2, 2, 4, 5]);
        assert_eq!(positions, [1, 4, 0, 2, 3]);
        assert!(range(&starts, 0) == (0..2) && range(&starts, 1).is_empty());
        assert_eq!(buckets(0, &[]), (vec![0], vec![]));
    }

    #[test]
    fn chains_of_any_order_are_one_set() {
        for pairs in [[(0, 3), (3, 5), (5, 1)], [(5, 1), (3, 5), (0, 3)]] {
            let mut sets = DisjointSets::new(7);
            for (a, b) in pairs {
                sets.join(a, b);
                sets.join(b, a);
            }
            assert_eq!(sets.numbers(), [0, 0, 1, 0, 2, 0, 3]);
            assert_eq!(sets.first(5), 0);
        }
        assert!(DisjointSets::new(0).numbers().is_empty());
    }
}
