//! How much the final state depends on the loading history.

use std::fmt;

use crate::run::Outcome;

/// Differences of two final states under the same loads, relative to the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dependence {
    /// Subdomains along the short edges.
    pub n: usize,
    /// Sums of the pressing forces, N.
    pub normal: [f64; 2],
    /// Sums of the friction forces along x1, N.
    pub tangential: [f64; 2],
    /// Norm of the difference of the fields `|lambda_T|` on the contact surface over the norm of the first.
    pub friction_field: f64,
    /// Norm of the difference of the fields `lambda_nu` over the norm of the first.
    pub normal_field: f64,
    /// Norm of the difference of the displacements of all nodes over the norm of the first.
    pub displacement: f64,
}

impl Dependence {
    /// Compares two runs of the same brick; `None` if the meshes differ or a run has no step.
    #[must_use]
    pub fn new(first: &Outcome, second: &Outcome) -> Option<Self> {
        let (a, b) = (&first.snapshot, &second.snapshot);
        let last = [first.record.steps.last()?, second.record.steps.last()?];
        if a.points != b.points || a.contact.nodes != b.contact.nodes {
            return None;
        }
        let flat =
            |u: &[[f64; 3]]| -> Vec<f64> { u.iter().flat_map(|v| v.iter().copied()).collect() };
        Some(Self {
            n: first.record.n,
            normal: last.map(|s| s.normal_force),
            tangential: last.map(|s| s.tangential_force[0]),
            friction_field: distance(&a.contact.friction(), &b.contact.friction()),
            normal_field: distance(&a.contact.normal_force, &b.contact.normal_force),
            displacement: distance(&flat(&a.displacement), &flat(&b.displacement)),
        })
    }
}

/// Euclidean norm of `a - b` over that of `a`; 0 if both vanish.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
    let own: f64 = a.iter().map(|x| x * x).sum();
    if squares == 0.0 {
        0.0
    } else {
        (squares / own).sqrt()
    }
}

impl fmt::Display for Dependence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |pair: [f64; 2]| 100.0 * (pair[1] - pair[0]) / pair[0];
        write!(
            f,
            "n = {}: friction force along x1 {:.4e} N (b), {:.4e} N (c): {:+.2} %; normal force {:.4e} N, {:+.2} %; \
             fields b - c over b: |lambda_T| {:.2} %, lambda_nu {:.2} %, u {:.3} %",
            self.n,
            self.tangential[0],
            self.tangential[1],
            percent(self.tangential),
            self.normal[0],
            percent(self.normal),
            100.0 * self.friction_field,
            100.0 * self.normal_field,
            100.0 * self.displacement,
        )
    }
}
