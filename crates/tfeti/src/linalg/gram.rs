//! Gram matrices of sparse rows.

use super::sparse::Columns;
use rayon::prelude::*;
use signorini_fem_mesh::internal::Lists;
use std::collections::HashMap;

impl Columns {
    /// The Gram matrix of sparse rows of `(unknown, coefficient)`, with a weight for each unknown. In column `k` also
    /// the entry of row `stored(k)` is there, if only as a zero.
    pub(crate) fn gram(
        rows: &[Vec<(usize, f64)>],
        weight: impl Fn(usize) -> f64,
        stored: impl Fn(usize) -> Option<usize> + Sync,
    ) -> Self {
        // unknowns by their first entries
        let (mut numbers, mut weights) = (HashMap::new(), Vec::new());
        let entries = rows
            .iter()
            .zip(0_u32..)
            .flat_map(|(row, k)| row.iter().map(move |&(at, v)| (k, at, v)));
        let entries: Vec<(u32, u32, f64)> = entries
            .map(|(k, at, v)| {
                let number = *numbers.entry(at).or_insert(weights.len() as u32);
                if number as usize == weights.len() {
                    weights.push(weight(at));
                }
                (k, number, v)
            })
            .collect();
        let keys: Vec<u32> = entries.iter().map(|entry| entry.1).collect();
        let users = Lists::by_key(weights.len(), &keys);
        let column = |place: &mut Vec<usize>, k: usize, own: &[(u32, u32, f64)]| {
            let mut column: Vec<(usize, f64)> = Vec::new();
            let mut add = |other: usize, value: f64| {
                if place.len() <= other {
                    place.resize(rows.len(), usize::MAX);
                }
                match column.get_mut(place[other]) {
                    Some((_, sum)) => *sum += value,
                    None => {
                        place[other] = column.len();
                        column.push((other, 0.0 + value));
                    }
                }
            };
            if let Some(other) = stored(k) {
                add(other, 0.0);
            }
            for &(_, at, v) in own {
                let factor = v * weights[at as usize];
                for &user in users.of(at as usize) {
                    let (other, _, w) = entries[user as usize];
                    add(other as usize, factor * w);
                }
            }
            column.iter().for_each(|entry| place[entry.0] = usize::MAX);
            column.sort_unstable_by_key(|entry| entry.0);
            column
        };
        let mut starts = vec![0];
        starts.extend(rows.iter().scan(0, |sum, row| {
            *sum += row.len();
            Some(*sum)
        }));
        let columns: Vec<Vec<(usize, f64)>> = (0..rows.len())
            .into_par_iter()
            .map_init(Vec::new, |place, k| {
                column(place, k, &entries[starts[k]..starts[k + 1]])
            })
            .collect();
        let mut gram = Self::empty(rows.len());
        for column in columns {
            gram.rows.extend(column.iter().map(|entry| entry.0));
            gram.values.extend(column.iter().map(|entry| entry.1));
            gram.pointers.push(gram.rows.len());
        }
        gram
    }
}
