//! Lists of positions by key, and sets of numbers that grow together.

/// Lists one after another, with less than 2^32 items in all: the checked numbers of nodes and tetrahedra bound those of
/// meshes, the check of the entries of B those of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lists<T> {
    /// Start of each list, and the end of the last.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T> Default for Lists<T> {
    fn default() -> Self {
        let (starts, items) = (vec![0], Vec::new());
        Self { starts, items }
    }
}

/// How many there are if numbers run from 0 without gaps: one more than the largest.
pub fn count_of(numbers: &[u32]) -> usize {
    numbers.iter().max().map_or(0, |last| *last as usize + 1)
}

impl Lists<u32> {
    /// The positions of some numbers in a list for each number up to the largest, ascending in each.
    pub fn by_number(numbers: &[u32]) -> Self {
        Self::by_key(count_of(numbers), numbers)
    }

    /// The positions of `keys`, less than 2^32 of numbers below `count`, in a list for each key, ascending in each.
    pub fn by_key(count: usize, keys: &[u32]) -> Self {
        let mut starts = vec![0; count + 1];
        for &key in keys {
            starts[key as usize + 1] += 1;
        }
        for k in 0..count {
            starts[k + 1] += starts[k];
        }
        let (mut next, mut items) = (starts.clone(), vec![0; keys.len()]);
        for (position, &key) in keys.iter().enumerate() {
            let at = &mut next[key as usize];
            items[*at as usize] = position as u32;
            *at += 1;
        }
        Self { starts, items }
    }
}

impl<T> Lists<T> {
    /// Start of each list among all items, and the end of the last.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Adds a list behind the others.
    pub fn push(&mut self, list: impl IntoIterator<Item = T>) {
        self.items.extend(list);
        self.starts.push(self.items.len() as u32);
    }

    /// Number of lists.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// All items, list by list.
    pub fn items(&self) -> &[T] {
        &self.items
    }

    fn range(&self, list: usize) -> std::ops::Range<usize> {
        self.starts[list] as usize..self.starts[list + 1] as usize
    }

    /// One of the lists.
    pub fn of(&self, list: usize) -> &[T] {
        &self.items[self.range(list)]
    }

    /// The lists.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[T]> {
        (0..self.count()).map(|list| self.of(list))
    }

    pub(crate) fn of_mut(&mut self, list: usize) -> &mut [T] {
        let range = self.range(list);
        &mut self.items[range]
    }

    /// The same lists of what is made of the items.
    pub fn map<U>(self, of: impl FnMut(T) -> U) -> Lists<U> {
        Lists {
            starts: self.starts,
            items: self.items.into_iter().map(of).collect(),
        }
    }
}

/// The corners of a face, by which it is known however they are listed.
pub fn ascending<const N: usize>(mut nodes: [u32; N]) -> [u32; N] {
    nodes.sort_unstable();
    nodes
}

/// The different ones among some things, ascending.
pub fn distinct<T: Ord>(things: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut out: Vec<T> = things.into_iter().collect();
    out.sort_unstable();
    out.dedup();
    out
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

    /// Makes one set of those of some numbers.
    pub fn join_all(&mut self, numbers: impl IntoIterator<Item = usize>) {
        let mut numbers = numbers.into_iter();
        if let Some(first) = numbers.next() {
            numbers.for_each(|other| self.join(first, other));
        }
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
    fn lists_keep_the_order_of_positions() {
        let lists = Lists::by_key(4, &[2, 0, 2, 3, 0]);
        let expected: [&[u32]; 4] = [&[1, 4], &[], &[0, 2], &[3]];
        assert!((0..4).all(|key| lists.of(key) == expected[key]));
        assert_eq!((lists.count(), Lists::by_key(0, &[]).count()), (4, 0));
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
