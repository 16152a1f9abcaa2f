//! The mesh that an error asks for: edge lengths such that all tetrahedra have the same part in the error.
//!
//! Edges of a tetrahedron `h` times as long change the error energy on its place by `h^(2p)` with displacements of
//! order `p`, that of each new tetrahedron by `h^(2p+3)`. With `e` the error energy of an old tetrahedron and `c` that
//! of each new one,
//!
//! ```text
//! h^(2p+3) = c / e,    sum of e h^(2p) = target,    so c^(2p/(2p+3)) = target / sum of e^(3/(2p+3))
//! ```
//!
//! which takes the fewest tetrahedra (Li and Bettess, *Theoretical mesh optimization criteria*, Communications in
//! Numerical Methods in Engineering 11, 1995). At re-entrant edges the error falls more slowly: go round twice.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::estimate::DiscretisationError;
use crate::fields::{FieldError, expect_entries};
use crate::mesh::{EDGES, TetMesh};
use crate::tables::distinct;
use crate::tolerances::{COARSENED, EDGE_GROWTH, REFINED};
use crate::vec3::{norm, sub};

/// Volume of a regular tetrahedron over the cube of its edge, upside down: 6 times the root of 2.
const REGULAR: f64 = 6.0 * std::f64::consts::SQRT_2;

impl DiscretisationError {
    /// The edge length at each node, m, of a mesh whose [`relative`](Self::relative) error is `target`, with the fewest
    /// tetrahedra. Edges become at most four times shorter or twice longer, and grow by at most half the distance.
    /// [`write_sizes`](crate::gmsh::write_sizes) hands them to Gmsh.
    ///
    /// ```
    /// use signorini_fem_mesh::{Brick, Hooke, Materials, recovery::discretisation_error};
    ///
    /// let mesh = Brick::new([1.0; 3], [4; 3]).build()?;
    /// let materials = Materials::uniform(Hooke::isotropic(1e3, 0.3)?);
    /// let u: Vec<f64> = mesh.points().iter().flat_map(|p| [p[0].powi(4), 0.0, 0.0]).collect();
    /// let error = discretisation_error(&mesh, &materials, &u)?;
    /// let sizes = error.wanted_sizes(&mesh, 0.5 * error.relative())?;
    /// assert!(sizes[4] < 0.7 * sizes[0]); // at x = 1, where the strain changes most
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FieldError::Length`] if the mesh has another number of tetrahedra, [`FieldError::Target`] if the target is not
    /// positive.
    pub fn wanted_sizes(&self, mesh: &TetMesh, target: f64) -> Result<Vec<f64>, FieldError> {
        expect_entries("table of tetrahedra", self.energies.len(), mesh.tets().len())?;
        if !(target.is_finite() && target > 0.0) {
            return Err(FieldError::Target { value: target });
        }
        let twice = 2.0 * mesh.order() as f64;
        let whole = twice + 3.0;
        let parts: f64 = self.energies.iter().map(|e| e.powf(3.0 / whole)).sum();
        let each = (target * target * self.elastic_energy / parts).powf(whole / twice);
        let mut logs = vec![(0.0, 0.0); mesh.points().len()];
        for (tet, (nodes, energy)) in mesh.tets().iter().zip(&self.energies).enumerate() {
            let factor = if *energy > 0.0 {
                (each / energy).powf(whole.recip()).clamp(1.0 / REFINED, COARSENED)
            } else {
                COARSENED
            };
            let edge = factor * (REGULAR * mesh.volume(tet)).cbrt();
            for &node in nodes {
                logs[node as usize].0 += edge.ln();
                logs[node as usize].1 += 1.0;
            }
        }
        let mut sizes: Vec<f64> = logs
            .into_iter()
            .map(|(sum, count): (f64, f64)| (sum / count).exp())
            .collect();
        limit_growth(mesh, &mut sizes);
        for (nodes, mids) in mesh.tets().iter().zip(mesh.mids()) {
            for (mid, edge) in mids.iter().zip(EDGES) {
                let [a, b] = edge.map(|corner| sizes[nodes[corner] as usize]);
                sizes[*mid as usize] = 0.5 * (a + b);
            }
        }
        Ok(sizes)
    }
}

/// Makes sizes smaller where they grow too fast along edges, the smallest first (Dijkstra).
fn limit_growth(mesh: &TetMesh, sizes: &mut [f64]) {
    let mut ends: Vec<[u32; 2]> = Vec::with_capacity(12 * mesh.tets().len());
    for tet in mesh.tets() {
        for a in 0..4 {
            ends.extend((1..4).map(|k| [tet[a], tet[(a + k) % 4]]));
        }
    }
    let ends = distinct(ends);
    // positive numbers are ordered as their bits
    let entry = |node: u32, size: f64| Reverse((size.to_bits(), node));
    let mut queue: BinaryHeap<_> = (0..).zip(&*sizes).map(|(node, size)| entry(node, *size)).collect();
    while let Some(Reverse((bits, node))) = queue.pop() {
        let size = f64::from_bits(bits);
        if size > sizes[node as usize] {
            continue;
        }
        let first = ends.partition_point(|e| e[0] < node);
        for [_, other] in ends[first..].iter().take_while(|e| e[0] == node) {
            let [a, b] = [node, *other].map(|n| mesh.points()[n as usize]);
            let most = size + EDGE_GROWTH * norm(sub(a, b));
            if sizes[*other as usize] > most {
                sizes[*other as usize] = most;
                queue.push(entry(*other, most));
            }
        }
    }
}
