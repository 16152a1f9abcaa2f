//! Sets that grow together.

/// A partition of the numbers below a count: numbers that are joined, directly or by others, are in one set.
///
/// ```
/// let mut sets = signorini_fem_mesh::DisjointSets::new(5);
/// sets.join(4, 1);
/// sets.join(1, 2);
/// assert_eq!((sets.first(4), sets.first(3)), (1, 3));
/// assert_eq!(sets.numbers(), [0, 1, 1, 2, 1]);
/// ```
#[derive(Debug, Clone)]
pub struct DisjointSets {
    /// A smaller member of the same set, or the number itself.
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Every number alone.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self {
            parent: (0..count as u32).collect(),
        }
    }

    /// Makes one set of those of two numbers.
    ///
    /// # Panics
    /// If a number is not below the count.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }

    /// The smallest number of the set with this one.
    ///
    /// # Panics
    /// If the number is not below the count.
    pub fn first(&mut self, mut number: usize) -> usize {
        while self.parent[number] as usize != number {
            let parent = self.parent[number] as usize;
            self.parent[number] = self.parent[parent];
            number = self.parent[number] as usize;
        }
        number
    }

    /// The set of each number; sets are counted in the order of their smallest numbers.
    #[must_use]
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
    use super::DisjointSets;

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
