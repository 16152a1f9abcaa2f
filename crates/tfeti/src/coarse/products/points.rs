//! Rigid motions at single points: rows that are no interface rows.
//!
//! The normal and tangential rows of a contact point, or the rows of a supported node, act on the same copies, whose
//! displacements are computed once for all of them.

use crate::rows::gluing::Gluing;
use crate::subdomain::kernel::{add_wrench, displacement};
use std::collections::HashMap;
use std::ops::Range;

/// Consecutive rows, grouped by the copies on which they act.
#[derive(Debug, Default)]
pub(crate) struct PointTables {
    points: Vec<Point>,
    /// Subdomain and arm.
    copies: Vec<[u32; 2]>,
    /// Counted from the first of the consecutive rows.
    rows: Vec<u32>,
    /// What multiplies the displacement: for each row of a point one vector for each copy.
    vectors: Vec<[f64; 3]>,
}

/// Ends of a point's part of the tables; those of the point before are the beginnings.
#[derive(Debug, Clone, Copy, Default)]
struct Point {
    copies: usize,
    rows: usize,
    vectors: usize,
}

/// Copies of a point whose displacements are kept.
const KEPT: usize = 8;

impl PointTables {
    /// For `all` these nodal rows; `copy` gives subdomain and arm from subdomain and local node.
    pub(crate) fn new(gluing: &Gluing, all: Range<usize>, copy: impl Fn(u32, u32) -> [u32; 2]) -> Self {
        let places = |nodal: usize| {
            let entries = gluing.nodal(nodal).iter();
            entries.map(|e| (e.subdomain, e.local))
        };
        // group of the last row with this first copy
        let mut numbers: HashMap<Option<(u32, u32)>, usize> = HashMap::new();
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for nodal in all.clone() {
            let number = numbers.entry(places(nodal).next()).or_insert(groups.len());
            match groups.get_mut(*number) {
                Some(group) if places(group[0]).eq(places(nodal)) => group.push(nodal),
                _ => {
                    *number = groups.len();
                    groups.push(vec![nodal]);
                }
            }
        }
        let mut out = Self::default();
        for group in groups {
            let copies = places(group[0]).map(|(subdomain, local)| copy(subdomain, local));
            out.copies.extend(copies);
            for nodal in group {
                out.rows.push((nodal - all.start) as u32);
                out.vectors.extend(gluing.nodal(nodal).iter().map(|e| e.vector));
            }
            out.points.push(Point {
                copies: out.copies.len(),
                rows: out.rows.len(),
                vectors: out.vectors.len(),
            });
        }
        out
    }

    /// Adds the wrenches of the rows `x` on the subdomains, about their means.
    pub(crate) fn add_wrenches(&self, arms: &[[f64; 3]], x: &[f64], wrenches: &mut [[f64; 6]]) {
        let mut start = Point::default();
        for &end in &self.points {
            let copies = &self.copies[start.copies..end.copies];
            let rows = &self.rows[start.rows..end.rows];
            let vectors = &self.vectors[start.vectors..end.vectors];
            start = end;
            if rows.iter().all(|&row| x[row as usize] == 0.0) {
                continue;
            }
            for (k, &[subdomain, arm]) in copies.iter().enumerate() {
                let mut force = [0.0; 3];
                let own = vectors.iter().skip(k).step_by(copies.len());
                for (&row, v) in rows.iter().zip(own) {
                    (0..3).for_each(|c| force[c] += v[c] * x[row as usize]);
                }
                add_wrench(&mut wrenches[subdomain as usize], &arms[arm as usize], force);
            }
        }
    }

    /// Hands each row to `each(row, x, value)` with the displacement that the motions of the subdomains give it.
    pub(crate) fn motions(
        &self,
        motions: &[[f64; 6]],
        arms: &[[f64; 3]],
        x: &mut [f64],
        each: &impl Fn(usize, &mut f64, f64),
    ) {
        let mut start = Point::default();
        for &end in &self.points {
            let copies = &self.copies[start.copies..end.copies];
            let at = |&[subdomain, arm]: &[u32; 2]| displacement(&motions[subdomain as usize], &arms[arm as usize]);
            let rows = &self.rows[start.rows..end.rows];
            let vectors = &self.vectors[start.vectors..end.vectors];
            start = end;
            if let [copy] = copies {
                let u = at(copy);
                for (&row, v) in rows.iter().zip(vectors) {
                    let value = v[0] * u[0] + v[1] * u[1] + v[2] * u[2];
                    each(row as usize, &mut x[row as usize], value);
                }
                continue;
            }
            let mut kept = [[0.0; 3]; KEPT];
            for (kept, copy) in kept.iter_mut().zip(copies) {
                *kept = at(copy);
            }
            let mut vectors = vectors.iter();
            for &row in rows {
                let mut sum = 0.0;
                for (k, (copy, v)) in copies.iter().zip(&mut vectors).enumerate() {
                    let u = kept.get(k).copied().unwrap_or_else(|| at(copy));
                    sum += v[0] * u[0] + v[1] * u[1] + v[2] * u[2];
                }
                each(row as usize, &mut x[row as usize], sum);
            }
        }
    }
}
