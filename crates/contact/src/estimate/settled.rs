//! The best places of points that share too few nodes, as beside couplings: a contact problem of its own.
//!
//! Of all displacements that do not penetrate, that with the smallest gap, with the diagonal of the stiffness in the
//! place of the stiffness: `1/2 |v - v0|²` and what the forces `lambda` of the points leave where they are open or
//! slip. It is `v0 + C P^T (y - lambda)` with the contact forces `y`, within the slip bounds of the step, of a problem
//! with the matrix `P C P^T`. Where the step is solved it is `v0`.

use super::shared::{SharedNodes, Target};
use signorini_qp::problem::{BlockState, ConvexSet};
use signorini_qp::{ProductSet, Segment, SymmetricOperator, vector};

impl SharedNodes {
    /// Moves the displacement `v` there. `forces` of the points, along the normal and along the surface, with slip
    /// bounds, N; `touching` is what their rows measure where they touch and stick, m. Comes back with what to hold
    /// there.
    pub(crate) fn settle(
        &self,
        forces: Vec<([f64; 3], f64)>,
        mut touching: Vec<f64>,
        offset: &[f64],
        v: &mut [f64],
    ) -> Vec<Target> {
        let (n, fixed) = (self.rows.len(), self.fixed.len());
        let (mut segments, mut lambda, mut is_normal) = (Vec::new(), Vec::with_capacity(n), vec![false; n]);
        for (&count, (force, bound)) in self.counts.iter().zip(&forces) {
            segments.push(Segment::upper(vec![0.0]));
            segments.push(match count {
                1 => Segment::Free(0),
                2 => Segment::bounds(vec![-bound], vec![*bound]),
                _ => Segment::discs(vec![*bound]),
            });
            is_normal[lambda.len()] = true;
            lambda.extend_from_slice(&force[..count]);
        }
        segments.push(Segment::Free(fixed));
        lambda.resize(n, 0.0);
        touching.extend(self.fixed.iter().map(|&row| offset[row]));
        let at = |touching: Vec<f64>| touching.into_iter().map(Target::At).collect();
        let Ok(mut set) = ProductSet::new(segments) else {
            return at(touching);
        };
        let mut linear = vec![0.0; n];
        self.apply(&lambda, &mut linear, &mut self.scratch());
        for ((linear, row), touching) in linear.iter_mut().zip(&self.rows).zip(&touching) {
            *linear += touching - row.iter().map(|&(at, c)| c * v[at]).sum::<f64>();
        }
        let mut y = lambda.clone();
        set.project(&mut y);
        if self.solve(&linear, &mut set, &mut y).is_none() {
            return at(touching);
        }
        let mut targets = Vec::with_capacity(n);
        set.for_each_block(&y, &mut |block| {
            let target = match block.state {
                BlockState::Free | BlockState::Interior => Target::At,
                BlockState::AtUpper if is_normal[block.start] => Target::Below,
                _ => |_| Target::Any,
            };
            targets.extend(
                touching[block.start..block.start + block.len]
                    .iter()
                    .map(|value| target(*value)),
            );
        });
        vector::axpy(-1.0, &lambda, &mut y);
        let mut moved = vec![0.0; v.len()];
        self.spread(&y, &mut moved);
        vector::axpy(1.0, &moved, v);
        targets
    }
}
