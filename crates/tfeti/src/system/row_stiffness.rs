//! The stiffness that a single row of `B` feels, with all other unknowns held or with its subdomains free.

use crate::linalg::{self, sparse::SolveMemory};
use crate::subdomain::inverse::Inverse;
use crate::system::tfeti::Tfeti;
use crate::tolerances::{NO_HOLD, SAMPLE, SHORT_ROWS, SOFT_BODY};
use rayon::prelude::*;
use signorini_fem_mesh::internal::distinct;
use std::collections::BTreeMap;
use std::ops::Range;

/// Subdomain, unknown and coefficient in a row.
type Entry = (usize, usize, f64);

/// What is known of the compliance of a class.
enum Compliance<'a> {
    /// The Moore-Penrose inverse on the boundary nodes.
    Block(&'a [f64]),
    /// Its diagonal times that of the stiffness, the smallest of some nodes, by direction.
    Sample([f64; 3]),
}

impl Tfeti {
    /// `out[k] = b K+ bᵀ` for the rows `b` of `B` in `rows`, in m/N: the diagonal of `F`, `K+` the Moore-Penrose
    /// inverse. Exact for subdomains with a dense inverse; for others a lower estimate from a few of their nodes.
    ///
    /// Over the inverse of [`row_stiffness`](Self::row_stiffness) it is 1 to 4 in a well shaped, compressible body. It
    /// is large where single nodes can hardly move with all others held: near incompressibility, and in thin elements.
    ///
    /// `out` has the length of `rows`; rows beyond the last are 0.
    pub fn row_compliance(&self, rows: Range<usize>, out: &mut [f64]) {
        let dual = &self.dual;
        let subdomains = &dual.subdomains;
        let mut nodes = vec![Vec::new(); subdomains.bases.len()];
        for (subdomain, dof, _) in rows.clone().flat_map(|row| self.gluing().row(row)) {
            nodes[subdomains.class(subdomain)].push(dof / 3);
        }
        let of_class = |(class, nodes): (usize, Vec<usize>)| {
            let inverse = dual.inverses[class].as_ref()?;
            Some(match &inverse.boundary {
                Some(block) => Compliance::Block(block),
                None => {
                    let nodes = distinct(nodes);
                    Compliance::Sample(self.sample_compliance(class, &inverse.full, &nodes))
                }
            })
        };
        let compliance: Vec<Option<Compliance<'_>>> = nodes.into_par_iter().enumerate().map(of_class).collect();
        self.sum_terms(rows, out, |class, first, own, terms| match &compliance[class] {
            Some(Compliance::Block(block)) => {
                let nodes = &dual.map.classes[class].nodes;
                let place = |dof: usize| {
                    let node = nodes.binary_search(&((dof / 3) as u32));
                    node.ok().map(|node| 3 * node + dof % 3)
                };
                let (_, dof, value) = own[first];
                let column = place(dof);
                let term = |second: &Entry| {
                    let (i, j) = (column?, place(second.1)?);
                    Some(value * second.2 * block[i + j * 3 * nodes.len()])
                };
                terms.extend(own.iter().map(|second| term(second).unwrap_or(0.0)));
            }
            Some(Compliance::Sample(ratios)) => {
                let (_, dof, value) = own[first];
                let diagonal = subdomains.bases[class].diagonal[dof];
                let start = terms.len();
                terms.resize(start + own.len(), 0.0);
                if diagonal > 0.0 {
                    terms[start + first] = value * value * ratios[dof % 3] / diagonal;
                }
            }
            None => terms.extend(own.iter().map(|_| 0.0)),
        });
    }

    /// `out[k]` is a sum over all pairs of entries of row `k` in one subdomain; `each` is told its class, which it must
    /// hold, and the place of the first entry among all there, and adds a term for each of these.
    fn sum_terms(
        &self,
        rows: Range<usize>,
        out: &mut [f64],
        each: impl Fn(usize, usize, &[Entry], &mut Vec<f64>) + Sync,
    ) {
        let subdomains = &self.dual.subdomains;
        let ownership = &subdomains.ownership;
        let terms_of = |row: usize, terms: &mut Vec<f64>, piece: &mut dyn FnMut(usize, Range<usize>)| {
            let entries = self.gluing().row(row);
            let mut by_subdomain: Vec<(usize, (usize, Vec<Entry>))> = Vec::new();
            for &entry in &entries {
                linalg::entry(&mut by_subdomain, entry.0, (0, Vec::new())).1.push(entry);
            }
            for &(subdomain, ..) in &entries {
                let (class, start) = (subdomains.class(subdomain), terms.len());
                let (next, own) = linalg::entry(&mut by_subdomain, subdomain, (0, Vec::new()));
                each(class, *next, own, terms);
                *next += 1;
                piece(class, start..terms.len());
            }
        };
        let sum = |terms: &[f64]| terms.iter().fold(0.0, |sum, term| sum + term);
        let count = rows.len().min(out.len());
        if ownership.exchange.ranks() == 1 {
            let rows = rows.into_par_iter().zip(&mut out[..count]);
            rows.for_each_init(Vec::new, |terms, (row, target)| {
                terms.clear();
                terms_of(row, terms, &mut |_, _| {});
                *target = sum(terms);
            });
            return;
        }
        let (mut terms, mut ends, mut pieces) = (Vec::new(), Vec::new(), Vec::new());
        for row in rows {
            terms_of(row, &mut terms, &mut |class, range| {
                pieces.push((ownership.rank_of(class, 0), range))
            });
            ends.push(terms.len());
        }
        ownership.exchange.complete(&mut terms, &pieces);
        let mut start = 0;
        for (end, target) in ends.into_iter().zip(out) {
            *target = sum(&terms[start..end]);
            start = end;
        }
    }

    /// Smallest diagonal entry of `K+` times that of `K` at some of these nodes, by direction.
    fn sample_compliance(&self, class: usize, inverse: &Inverse, nodes: &[usize]) -> [f64; 3] {
        let base = &self.dual.subdomains.bases[class];
        let mut memory = SolveMemory::new(inverse.need(1));
        let mut out = [f64::INFINITY; 3];
        let count = nodes.len().min(SAMPLE);
        let mut x = vec![0.0; base.diagonal.len()];
        for k in 0..count {
            let node = nodes[(2 * k + 1) * nodes.len() / (2 * count)];
            for (c, smallest) in out.iter_mut().enumerate() {
                let dof = 3 * node + c;
                x.fill(0.0);
                x[dof] = 1.0;
                inverse.apply(&base.kernel, &mut x, 1, &mut memory);
                *smallest = smallest.min(x[dof] * base.diagonal[dof]);
            }
        }
        out
    }

    /// `out[k] = b K bᵀ` for the rows `b` of `B` in `rows`, in N/m: the diagonal of the lumped preconditioner without
    /// scaling. Its inverse is the scale on which displacements of that row turn into multipliers.
    ///
    /// `out` has the length of `rows`; rows beyond the last are 0.
    pub fn row_stiffness(&self, rows: Range<usize>, out: &mut [f64]) {
        self.sum_terms(rows, out, |class, first, own, terms| {
            let (_, dof, value) = own[first];
            let Some(base) = self.dual.subdomains.held(class) else {
                terms.extend(own.iter().map(|_| 0.0));
                return;
            };
            let (rows, values) = base.stiffness.column(dof);
            // the unknowns of a node follow one another
            let mut next = 0;
            terms.extend(own.iter().map(|&(_, other, factor)| {
                if rows.get(next) != Some(&other) {
                    match rows.binary_search(&other) {
                        Ok(at) => next = at,
                        Err(_) => return 0.0,
                    }
                }
                next += 1;
                value * values[next - 1] * factor
            }));
        });
    }

    /// Weights of the rows for projectors where copies differ in stiffness: `1 / sum_d b_d² / K_dd`, relative to the
    /// largest. A row between a stiff and a soft copy carries forces in proportion to the soft one, and a row that
    /// gives way in proportion to both together: a soft spring takes no part in what friction holds. Bodies that differ
    /// by more than a thousand weigh as if they differed by that. `None` where all copies [count
    /// alike](Self::copy_stiffness) and no row gives way. Without contact that is so only where the factor is not small
    /// (there weights save a product), and always on springs, whose small forces weights would hide.
    pub fn row_weights(&self) -> Option<Vec<f64>> {
        let (ranges, springs) = (self.gluing().ranges(), self.gluing().springs());
        let contact = !ranges.contact().is_empty();
        if !contact && !springs.is_empty() {
            return None;
        }
        let saves = !contact && self.subdomains() > 1 && self.coarse().rows() < SHORT_ROWS;
        let (plain, given) = (
            !saves && springs.is_empty() && self.copy_stiffness().is_plain(),
            self.gluing().contact_compliance(),
        );
        if plain && given.is_empty() {
            return None;
        }
        let compliance = |&(subdomain, dof, value): &Entry| {
            let diagonal = self.dual.subdomains.of(subdomain).diagonal[dof];
            (diagonal > 0.0).then(|| value * value / diagonal)
        };
        // and whether all sides give way
        let weight = |row: usize| {
            let terms: Vec<Option<f64>> = self.gluing().row(row).iter().map(compliance).collect();
            let sum: f64 = terms.iter().map(|term| term.unwrap_or(0.0)).sum();
            (if sum > 0.0 { 1.0 / sum } else { 0.0 }, !terms.contains(&None))
        };
        if plain {
            let soft = given.iter().enumerate().map(|(row, c)| 1.0 / (1.0 + c * weight(row).0));
            let rest = self.dual_dim() - given.len();
            return Some(soft.chain(std::iter::repeat_n(1.0, rest)).collect());
        }
        let (mut weights, give): (Vec<f64>, Vec<bool>) = (0..self.dual_dim()).map(weight).unzip();
        // equations of little but places would hide all others, and so would rows of little but rigid sides; half
        // rigid, a row is twice as stiff
        let hides = |row: &usize| ranges.equations.contains(row) || !give[*row];
        let (hiding, others): (Vec<usize>, Vec<usize>) = (0..weights.len()).partition(hides);
        let most = others.iter().fold(0.0_f64, |most, &row| most.max(weights[row]));
        for row in hiding {
            match ranges.equations.contains(&row) {
                true => weights[row] = weights[row].min(most),
                false if most > 0.0 => weights[row] = weights[row].min(2.0 * most),
                false => {}
            }
        }
        for (row, compliance) in self.gluing().compliance() {
            weights[row] /= 1.0 + compliance * weights[row];
        }
        self.compare_weights(&mut weights);
        for (row, spring) in self.gluing().spring_rows().zip(springs) {
            if weights[row] * spring.scale.powi(2) < NO_HOLD {
                weights[row] = 0.0;
            }
        }
        self.weigh_rigid(&mut weights);
        Some(weights)
    }

    /// Divides the weights by the largest, but those of much softer bodies only until their own largest is `SOFT_BODY`.
    /// A row between bodies is one of the softer.
    fn compare_weights(&self, weights: &mut [f64]) {
        let body = &self.coarse().0.mobility.part_of;
        // of a single body no row is asked for its own
        let several = body.iter().any(|body| *body > 0);
        let rows = |row: usize| if several { self.gluing().row(row) } else { Vec::new() };
        let bodies = |row: usize| rows(row).into_iter().map(|entry| body[entry.0] as usize);
        let mut largest = vec![0.0_f64; body.len()];
        for (row, weight) in weights.iter().enumerate() {
            bodies(row).for_each(|body| largest[body] = largest[body].max(*weight));
        }
        let most = weights.iter().fold(0.0_f64, |m, w| m.max(*w));
        for (row, weight) in weights.iter_mut().enumerate() {
            let own = bodies(row).map(|body| largest[body]).fold(most, f64::min);
            *weight = if *weight > 0.0 { *weight / most.min(own / SOFT_BODY) } else { 1.0 };
        }
    }

    /// Rows that hold a rigid subdomain take what its others leave: they are longer, and weigh as much as the largest
    /// of these.
    fn weigh_rigid(&self, weights: &mut [f64]) {
        let gluing = self.gluing();
        let rigid = gluing.ranges().rigid.clone();
        let of = |row: usize| gluing.row(row).into_iter().map(|entry| entry.0);
        let mut largest: BTreeMap<usize, f64> = rigid.clone().flat_map(of).map(|s| (s, 0.0)).collect();
        if largest.is_empty() {
            return;
        }
        for row in 0..rigid.start {
            for subdomain in of(row) {
                if let Some(largest) = largest.get_mut(&subdomain) {
                    *largest = largest.max(weights[row]);
                }
            }
        }
        for row in rigid {
            // a place that nothing else reaches
            let most = of(row).map(|s| largest[&s]).fold(0.0, f64::max);
            weights[row] = if most > 0.0 { most } else { 1.0 };
        }
    }
}
