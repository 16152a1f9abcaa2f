//! Directions that only contact touches, of bodies that are thin: eliminated like the interior where an active set
//! holds the rows that touch them.
//!
//! They are unknowns of the interior from the start. Where rows are free a large weight on their diagonal holds them,
//! so that the pattern of the factor stays. Held where nothing presses, they make long flat cells stiff.

use super::split::Split;
use crate::linalg::sparse::{Columns, FactorError, SparseCholesky, Symbolic};
use crate::tolerances::{HELD_ROWS, PIVOT, SAME_DIRECTION};
use signorini_fem_mesh::vec3;
use signorini_qp::active_set::{ActiveSetView, Freedom};
use std::collections::BTreeMap;

/// The interior of a class with those directions.
#[derive(Debug)]
pub(super) struct Released {
    interior: Columns,
    symbolic: Symbolic,
    /// What each contact row touches: the first unknown of a node in the interior, and a vector on its axes.
    rows: BTreeMap<usize, Vec<Touch>>,
    /// Largest diagonal entry.
    size: f64,
}

#[derive(Debug, Clone, Copy)]
struct Touch {
    first: usize,
    axes: usize,
    vector: [f64; 3],
}

impl Released {
    pub(super) fn new(split: &Split, contact: &[(usize, usize, [f64; 3])]) -> Result<Self, FactorError> {
        let mut rows: BTreeMap<usize, Vec<Touch>> = BTreeMap::new();
        for &(row, node, vector) in contact {
            let (first, axes) = &split.axes[node];
            let mut own = [0.0; 3];
            own.iter_mut()
                .zip(axes)
                .for_each(|(own, axis)| *own = vec3::dot(*axis, vector));
            // what else touches the node leaves nothing of some
            if vec3::norm(own) <= SAME_DIRECTION * vec3::norm(vector) {
                own = [0.0; 3];
            }
            rows.entry(row).or_default().push(Touch {
                first: *first,
                axes: axes.len(),
                vector: own,
            });
        }
        Ok(Self {
            symbolic: Symbolic::new(&split.interior, split.block)?,
            interior: split.interior.clone(),
            rows,
            size: (0..split.interior.dim)
                .map(|i| split.interior.diagonal(i))
                .fold(0.0, f64::max),
        })
    }

    /// The factor with the directions of all contact rows held.
    pub(super) fn with_all(&self) -> Option<SparseCholesky> {
        let mut matrix = self.interior.clone();
        self.rows
            .values()
            .flatten()
            .for_each(|touch| self.hold(touch, &mut matrix));
        self.factor(&matrix)
    }

    /// The factor on an active set; `None` if its rows leave the interior a rigid motion.
    pub(super) fn on_active_set(&self, view: &ActiveSetView<'_>) -> Option<SparseCholesky> {
        let mut matrix = self.interior.clone();
        let touches = |row: usize| self.rows.get(&row).into_iter().flatten();
        view.for_each(|row, count, freedom| match freedom {
            Freedom::Held => {}
            Freedom::Free => (row..row + count).for_each(|row| {
                touches(row).for_each(|touch| self.hold(touch, &mut matrix));
            }),
            Freedom::Along(tau) => {
                for a in touches(row) {
                    let b = touches(row + 1).find(|b| b.first == a.first);
                    let b = b.map_or([0.0; 3], |b| b.vector);
                    let vector = [0, 1, 2].map(|c| tau[0] * a.vector[c] + tau[1] * b[c]);
                    self.hold(&Touch { vector, ..*a }, &mut matrix);
                }
            }
        });
        self.factor(&matrix)
    }

    fn hold(&self, touch: &Touch, matrix: &mut Columns) {
        let square = vec3::dot(touch.vector, touch.vector);
        if square == 0.0 {
            return;
        }
        let unknowns = touch.first..touch.first + touch.axes;
        let size = unknowns.clone().map(|i| self.interior.diagonal(i)).fold(0.0, f64::max);
        for (i, a) in unknowns.clone().zip(touch.vector) {
            for (j, b) in unknowns.clone().zip(touch.vector) {
                if let Some(k) = matrix.find(i, j) {
                    matrix.values[k] += HELD_ROWS * size * a * b / square;
                }
            }
        }
    }

    fn factor(&self, matrix: &Columns) -> Option<SparseCholesky> {
        let factor = SparseCholesky::new(&self.symbolic, matrix).ok()?;
        (factor.pivots().0 > PIVOT * self.size).then_some(factor)
    }
}
