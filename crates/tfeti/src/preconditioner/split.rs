//! The unknowns of a class as those that rows of `B` touch and the others, which a Schur complement eliminates.
//!
//! Supports on planes and contact without friction touch a node in one direction or two. The others are eliminated
//! with the interior: held, they make a thin body between two planes stiff in bending, by the square of its length
//! over its thickness.

use crate::linalg::sparse::Columns;
use crate::system::tfeti::Tfeti;
use crate::tolerances::SAME_DIRECTION;
use signorini_fem_mesh::vec3;

/// Orthonormal axes of a node, of which rows touch the first `count`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Directions {
    axes: [[f64; 3]; 3],
    count: usize,
}

/// What rows touch of the nodes of a class in some member.
#[derive(Debug, Clone)]
pub(super) struct ClassRows {
    /// By gluing, supports and springs; by node.
    pub(super) always: Vec<Directions>,
    /// By contact: row, node, direction.
    pub(super) contact: Vec<(usize, usize, [f64; 3])>,
}

impl Directions {
    const NONE: Self = Self {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        count: 0,
    };
    const ALL: Self = Self { count: 3, ..Self::NONE };

    fn touch(&mut self, vector: [f64; 3]) {
        let (axis, beside) = self.beside(vector);
        if self.count == 3 || beside <= SAME_DIRECTION * vec3::norm(vector) {
            return;
        }
        self.axes[self.count] = axis;
        self.count += 1;
        if self.count == 3 {
            *self = Self::ALL;
        }
    }

    /// What a vector has beside the axes that rows touch, of unit length, and its length.
    fn beside(&self, mut vector: [f64; 3]) -> ([f64; 3], f64) {
        // the second time takes out what rounding left
        for _ in 0..2 {
            for &axis in &self.axes[..self.count] {
                let along = vec3::dot(axis, vector);
                (0..3).for_each(|c| vector[c] -= along * axis[c]);
            }
        }
        let length = vec3::norm(vector);
        (vector.map(|v| v / length), length)
    }

    /// Orthonormal axes that no row touches.
    pub(super) fn others(&self) -> Vec<[f64; 3]> {
        let mut all = *self;
        while all.count < 3 {
            let axes = Self::NONE.axes.map(|axis| all.beside(axis));
            let longest = axes.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a });
            all.axes[all.count] = longest.map_or([0.0; 3], |l| l.0);
            all.count += 1;
        }
        all.axes[self.count..].to_vec()
    }

    /// The projector to the directions that rows touch.
    fn projector(&self) -> [[f64; 3]; 3] {
        let entry = |i: usize, j: usize| self.axes[..self.count].iter().map(|a| a[i] * a[j]).sum();
        match self.count {
            3 => Self::ALL.axes,
            _ => std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
        }
    }
}

impl ClassRows {
    /// Of each class.
    pub(super) fn of_classes(system: &Tfeti) -> Vec<Self> {
        let (classes, gluing) = (system.classes(), system.gluing());
        let rows = |nodes: usize| Self {
            always: vec![Directions::NONE; nodes],
            contact: Vec::new(),
        };
        let mut out: Vec<Self> = classes.classes().iter().map(|c| rows(c.nodes)).collect();
        let place = |subdomain: u32, local: u32| (classes.place(subdomain as usize).0, local as usize);
        for block in 0..gluing.blocks() {
            for e in gluing.block(block) {
                let (class, node) = place(e.subdomain, e.local);
                out[class].always[node] = Directions::ALL;
            }
        }
        let contact = gluing.ranges().contact().end;
        for nodal in 0..gluing.nodal_rows() {
            for e in gluing.nodal(nodal) {
                let (class, node) = place(e.subdomain, e.local);
                if nodal < contact {
                    out[class].contact.push((nodal, node, e.vector))
                } else {
                    out[class].always[node].touch(e.vector)
                }
            }
        }
        out
    }

    /// What all rows touch, by node.
    pub(super) fn all(&self) -> Vec<Directions> {
        let mut all = self.always.clone();
        self.contact
            .iter()
            .for_each(|(_, node, vector)| all[*node].touch(*vector));
        all
    }
}

/// Whether far more nodes are touched in part than not at all: a thin body between two planes.
pub(super) fn is_thin(touched: &[Directions]) -> bool {
    let partly = touched.iter().filter(|d| matches!(d.count, 1 | 2)).count();
    2 * partly > 3 * touched.iter().filter(|d| d.count == 0).count()
}

/// What a Schur complement eliminates besides the nodes that no row touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Eliminated {
    /// Nothing.
    Nodes,
    /// Directions that no row touches.
    Directions,
    /// And those that only contact touches, for an active set may not.
    Contact,
}

/// The blocks of a stiffness matrix by boundary and interior.
pub(super) struct Split {
    /// All components of the boundary nodes; zero where rows do not touch them.
    pub(super) boundary: Columns,
    pub(super) interior: Columns,
    /// Interior rows by boundary columns.
    pub(super) coupling: Columns,
    /// Unknowns of a full block of the interior.
    pub(super) block: usize,
    /// Axes of each node in the interior, and the place of the first.
    pub(super) axes: Vec<(usize, Vec<[f64; 3]>)>,
}

impl Split {
    /// From what all rows touch, and what those that are no contact rows do.
    pub(super) fn new(
        stiffness: &Columns,
        (mut touched, always): (Vec<Directions>, &[Directions]),
        eliminated: Eliminated,
    ) -> Self {
        let on_boundary: Vec<bool> = touched.iter().map(|d| d.count > 0).collect();
        if eliminated == Eliminated::Nodes {
            touched
                .iter_mut()
                .filter(|d| d.count > 0)
                .for_each(|d| *d = Directions::ALL);
        }
        let free = match eliminated {
            Eliminated::Contact => always,
            _ => &touched,
        };
        let projectors: Vec<_> = touched.iter().map(Directions::projector).collect();
        let (mut axes, mut first) = (Vec::with_capacity(touched.len()), Vec::with_capacity(touched.len()));
        let [mut boundary, mut interior] = [0; 2];
        for (directions, on_boundary) in free.iter().zip(&on_boundary) {
            let others = directions.others();
            first.push(boundary);
            boundary += if *on_boundary { 3 } else { 0 };
            interior += others.len();
            axes.push((interior - others.len(), others));
        }
        let plain = axes.iter().all(|(_, axes)| matches!(axes.len(), 0 | 3));
        let [mut bb, mut ii, mut ib] = [boundary, interior, boundary].map(Columns::empty);
        for column in 0..touched.len() {
            let [a, b, c] = [0, 1, 2].map(|k| stiffness.column(3 * column + k));
            // the block of each node that this one has a stiffness with, by columns
            let blocks = || {
                let of = |k: usize, values: &[f64]| [0, 1, 2].map(|i| values[3 * k + i]);
                let nodes = a.0.chunks_exact(3).map(|rows| rows[0] / 3);
                nodes
                    .enumerate()
                    .map(move |(k, node)| (node, [of(k, a.1), of(k, b.1), of(k, c.1)]))
            };
            if on_boundary[column] {
                for right in &projectors[column] {
                    for (row, block) in blocks() {
                        if on_boundary[row] {
                            bb.push_part(first[row], &projectors[row], &block, right);
                        }
                        ib.push_part(axes[row].0, &axes[row].1, &block, right);
                    }
                    bb.end_column();
                    ib.end_column();
                }
            }
            for right in &axes[column].1 {
                blocks().for_each(|(row, block)| ii.push_part(axes[row].0, &axes[row].1, &block, right));
                ii.end_column();
            }
        }
        Self {
            boundary: bb,
            interior: ii,
            coupling: ib,
            block: if plain { 3 } else { 1 },
            axes,
        }
    }
}

impl Columns {
    /// Entries of the present column from row `first` on: each of `left` times the columns of the block times `right`.
    fn push_part(&mut self, first: usize, left: &[[f64; 3]], block: &[[f64; 3]; 3], right: &[f64; 3]) {
        for (i, left) in left.iter().enumerate() {
            self.rows.push(first + i);
            self.values
                .push((0..3).map(|j| vec3::dot(*left, block[j]) * right[j]).sum());
        }
    }

    fn end_column(&mut self) {
        self.pointers.push(self.rows.len());
    }
}
