//! The brick: a box of cells, each cut into five tetrahedra.
//!
//! ```
//! use signorini_fem_mesh::brick::{Brick, Z_MIN};
//!
//! let mesh = Brick::new([3.0, 1.0, 1.0], [15, 5, 5]).build()?;
//! assert_eq!(mesh.tets().len(), 5 * 15 * 5 * 5);
//! assert_eq!(mesh.nodes_on(Z_MIN).len(), 16 * 6);
//! # Ok::<(), signorini_fem_mesh::brick::BrickError>(())
//! ```

use super::check::numbered;
use super::error::MeshError;
use super::tet_mesh::{Facet, FacetTag, TetMesh};

/// The side of smallest x.
pub const X_MIN: FacetTag = FacetTag(1);
/// The side of largest x.
pub const X_MAX: FacetTag = FacetTag(2);
/// The side of smallest y.
pub const Y_MIN: FacetTag = FacetTag(3);
/// The side of largest y.
pub const Y_MAX: FacetTag = FacetTag(4);
/// The side of smallest z.
pub const Z_MIN: FacetTag = FacetTag(5);
/// The side of largest z.
pub const Z_MAX: FacetTag = FacetTag(6);

/// Tags of the sides: `SIDES[direction][0]` at the smallest, `[1]` at the largest coordinate.
pub const SIDES: [[FacetTag; 2]; 3] = [[X_MIN, X_MAX], [Y_MIN, Y_MAX], [Z_MIN, Z_MAX]];

/// Largest amplitude of [`Brick::perturbed`], relative to a cell. Beyond 1/6 a tetrahedron could
/// turn inside out.
const MAX_PERTURBATION: f64 = 0.15;

/// A box of `cells` cells, each cut into five tetrahedra.
///
/// The central tetrahedron of each cell joins the four vertices whose sum of global grid indices
/// i + j + k is even, so the faces of neighbouring cells match, and boxes of cells that are
/// translates by an even number of cells are cut in the same way. Nodes are numbered with x
/// fastest, then y, then z; cells likewise, and the tetrahedra of a cell one after the other.
///
/// With an even number of cells in a direction (equal cells, no perturbation) the mesh is
/// symmetric about its middle plane in that direction. With an odd number it is not: a cell and
/// its mirror image are cut differently, so that a symmetric scene has slightly different results
/// on both sides, by the discretisation error.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Brick {
    /// The corner of smallest coordinates. Default: the origin.
    pub origin: [f64; 3],
    /// Lengths of the edges, positive.
    pub lengths: [f64; 3],
    /// Number of cells along each edge, positive.
    pub cells: [usize; 3],
    /// Length of the last cell over that of the first along each edge; sizes in between follow a
    /// geometric series. Default: 1, equal cells.
    pub grading: [f64; 3],
    /// Largest displacement of inner nodes along each axis, relative to the shorter of the cells
    /// beside, from 0 to 0.15. Default: 0.
    pub perturbation: f64,
    /// Seed of the perturbation. Default: 0.
    pub seed: u64,
}

errors! {
    /// A brick that cannot be built.
    #[derive(Clone, PartialEq)]
    BrickError {
        OutOfRange { field: &'static str, axis: &'static str, value: f64, required: &'static str } =
            "brick: {field} along {axis} is {value}; it must be {required}";
        Mesh(MeshError) = "brick: {0}";
    }
}

impl From<MeshError> for BrickError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

/// Vertices of the unit cell by number: bit 0 is x, bit 1 is y, bit 2 is z.
/// The five tetrahedra of a cell whose vertex 0 has an even index sum; the central one is last.
const EVEN_CELL: [[usize; 4]; 5] = [[1, 0, 5, 3], [2, 3, 6, 0], [4, 5, 0, 6], [7, 6, 3, 5], [0, 3, 6, 5]];

/// The five tetrahedra of a cell whose vertex 0 has an odd index sum: the mirror image.
const ODD_CELL: [[usize; 4]; 5] = [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]];

impl Brick {
    /// A brick with its corner of smallest coordinates at the origin.
    pub fn new(lengths: [f64; 3], cells: [usize; 3]) -> Self {
        Self {
            origin: [0.0; 3],
            lengths,
            cells,
            grading: [1.0; 3],
            perturbation: 0.0,
            seed: 0,
        }
    }

    /// Moves the corner of smallest coordinates.
    #[must_use]
    pub fn with_origin(mut self, origin: [f64; 3]) -> Self {
        self.origin = origin;
        self
    }

    /// Sets the ratio of the last to the first cell along each edge.
    #[must_use]
    pub fn graded(mut self, grading: [f64; 3]) -> Self {
        self.grading = grading;
        self
    }

    /// Displaces inner nodes at random, so that no two cells are equal. The same seed gives the
    /// same mesh on every machine; the boundary stays plane.
    #[must_use]
    pub fn perturbed(mut self, amplitude: f64, seed: u64) -> Self {
        self.perturbation = amplitude;
        self.seed = seed;
        self
    }

    /// Number of the node at a grid point, counted from 0 to `cells` along each axis; none beyond the brick, or
    /// if that cannot be built.
    #[must_use]
    pub fn node(&self, grid: [usize; 3]) -> Option<u32> {
        let is_inside = grid.iter().zip(self.cells).all(|(k, cells)| *k <= cells);
        (is_inside && self.check().is_ok()).then(|| self.number(grid))
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> u32 {
        (i + (self.cells[0] + 1) * (j + (self.cells[1] + 1) * k)) as u32
    }

    /// Builds the mesh with all six sides tagged.
    ///
    /// # Errors
    /// [`BrickError`] if a number is out of range or the mesh would be too large.
    pub fn build(&self) -> Result<TetMesh, BrickError> {
        self.check()?;
        let mesh = TetMesh::new(self.nodes(), self.tets(), self.sides())?;
        Ok(mesh)
    }

    fn check(&self) -> Result<(), BrickError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        for (d, axis) in ["x", "y", "z"].into_iter().enumerate() {
            let fields = [
                ("origin", self.origin[d], self.origin[d].is_finite(), "finite"),
                (
                    "lengths",
                    self.lengths[d],
                    positive(self.lengths[d]),
                    "positive and finite",
                ),
                ("cells", self.cells[d] as f64, self.cells[d] > 0, "at least 1"),
                (
                    "grading",
                    self.grading[d],
                    positive(self.grading[d]),
                    "positive and finite",
                ),
            ];
            for (field, value, good, required) in fields {
                if !good {
                    return Err(BrickError::OutOfRange {
                        field,
                        axis,
                        value,
                        required,
                    });
                }
            }
        }
        if !(0.0..=MAX_PERTURBATION).contains(&self.perturbation) {
            return Err(BrickError::OutOfRange {
                field: "perturbation",
                axis: "all axes",
                value: self.perturbation,
                required: "between 0 and 0.15",
            });
        }
        // Before any allocation: the product itself may overflow.
        let cells = self.cells.iter().try_fold(1usize, |n, &c| n.checked_mul(c));
        let tets = cells.and_then(|c| c.checked_mul(5)).unwrap_or(usize::MAX);
        Ok(numbered("tetrahedra", tets)?)
    }

    /// Coordinates of the grid planes along one axis.
    fn planes(&self, d: usize) -> Vec<f64> {
        let n = self.cells[d];
        // Ratio of neighbouring cells, and the positions as partial sums of the series.
        let ratio = self.grading[d].powf(1.0 / (n.max(2) - 1) as f64);
        let mut sums = vec![0.0; n + 1];
        let mut size = 1.0;
        for i in 0..n {
            sums[i + 1] = sums[i] + size;
            size *= ratio;
        }
        let place = |i: usize| self.origin[d] + self.lengths[d] * sums[i] / sums[n];
        let mut planes: Vec<f64> = (0..n).map(place).collect();
        planes.push(self.origin[d] + self.lengths[d]);
        planes
    }

    fn nodes(&self) -> Vec<[f64; 3]> {
        let planes = [self.planes(0), self.planes(1), self.planes(2)];
        let mut nodes = Vec::with_capacity(planes.iter().map(Vec::len).product());
        for place in grid(self.cells.map(|n| n + 1)) {
            let mut p = [0, 1, 2].map(|d| planes[d][place[d]]);
            let inner = (0..3).all(|d| 0 < place[d] && place[d] < self.cells[d]);
            if inner && self.perturbation > 0.0 {
                for d in 0..3 {
                    let at = &planes[d][place[d] - 1..=place[d] + 1];
                    let size = (at[1] - at[0]).min(at[2] - at[1]);
                    let random = noise(self.seed, 3 * nodes.len() as u64 + d as u64);
                    p[d] += self.perturbation * size * random;
                }
            }
            nodes.push(p);
        }
        nodes
    }

    fn tets(&self) -> Vec<[u32; 4]> {
        let mut tets = Vec::with_capacity(5 * self.cells.iter().product::<usize>());
        for [i, j, k] in grid(self.cells) {
            let vertex = |v: usize| self.number([i + (v & 1), j + (v >> 1 & 1), k + (v >> 2)]);
            let cut = if (i + j + k) % 2 == 0 { &EVEN_CELL } else { &ODD_CELL };
            tets.extend(cut.iter().map(|tet| tet.map(vertex)));
        }
        tets
    }

    /// Facets of the six sides; [`TetMesh::new`] turns them outward.
    fn sides(&self) -> Vec<Facet> {
        let mut facets = Vec::new();
        for d in 0..3 {
            let (a, b) = ((d + 1) % 3, (d + 2) % 3);
            for (end, tag) in SIDES[d].into_iter().enumerate() {
                for jb in 0..self.cells[b] {
                    for ja in 0..self.cells[a] {
                        let corner = |da: usize, db: usize| {
                            let mut grid = [0; 3];
                            grid[d] = end * self.cells[d];
                            grid[a] = ja + da;
                            grid[b] = jb + db;
                            (self.number(grid), grid.iter().sum::<usize>() % 2 == 0)
                        };
                        let square = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                        let [n0, n1, n2, n3] = square.map(|(node, _)| node);
                        // The diagonal joins the two even corners, as in the tetrahedra.
                        let halves =
                            if square[0].1 { [[n0, n1, n2], [n0, n2, n3]] } else { [[n0, n1, n3], [n1, n2, n3]] };
                        facets.extend(halves.map(|nodes| Facet { nodes, tag }));
                    }
                }
            }
        }
        facets
    }
}

/// All places of a grid with so many along each axis, x fastest.
fn grid([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

/// A number from -1 to 1 that depends only on its arguments (the SplitMix64 generator).
fn noise(seed: u64, index: u64) -> f64 {
    let mut z = seed.wrapping_add((index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^= z >> 31;
    (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
