//! Compares displacements of two meshes of the same body.

use crate::element::{Piece, integral};
use crate::material::Materials;
use crate::mesh::{TetMesh, extent};
use crate::tolerances::OUTSIDE;
use crate::vec3::{sub, tet_volume};

use super::strain::{FieldError, nodal_vectors};

/// Tetrahedra sorted into a grid of boxes, to find the one at a point.
struct Locator<'m> {
    mesh: &'m TetMesh,
    low: [f64; 3],
    width: [f64; 3],
    boxes: [usize; 3],
    tets: Vec<Vec<u32>>,
}

impl<'m> Locator<'m> {
    /// Sorts the tetrahedra of a mesh; about one box a tetrahedron.
    fn new(mesh: &'m TetMesh) -> Self {
        let (low, high) = mesh.extent();
        let lengths = sub(high, low);
        let volume: f64 = lengths.iter().product();
        let edge = (volume / mesh.tets().len() as f64).cbrt();
        let boxes = lengths.map(|l| ((l / edge) as usize).clamp(1, 1000));
        let width: [f64; 3] = std::array::from_fn(|d| lengths[d] / boxes[d] as f64);
        let mut locator = Self {
            mesh,
            low,
            width,
            boxes,
            tets: vec![Vec::new(); boxes.iter().product()],
        };
        for tet in 0..mesh.tets().len() {
            let (low, high) = extent(mesh.tet_points(tet));
            let (from, to) = (locator.grid_box(low), locator.grid_box(high));
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    for k in from[2]..=to[2] {
                        let place = locator.place([i, j, k]);
                        locator.tets[place].push(tet as u32);
                    }
                }
            }
        }
        locator
    }

    fn grid_box(&self, point: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|d| {
            let position = (point[d] - self.low[d]) / self.width[d];
            // negative and NaN positions become 0
            (position as usize).min(self.boxes[d] - 1)
        })
    }

    fn place(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.boxes[1] + j) * self.boxes[2] + k
    }

    /// The tetrahedron at a point with the point's barycentric coordinates; `None` outside of the
    /// mesh. On faces the tetrahedron with the smallest number. Tetrahedra count as straight.
    fn locate(&self, point: [f64; 3]) -> Option<(usize, [f64; 4])> {
        let candidates = &self.tets[self.place(self.grid_box(point))];
        candidates.iter().find_map(|&tet| {
            let weights = barycentric(&self.mesh.tet_points(tet as usize), point);
            let inside = weights.iter().all(|w| *w >= -OUTSIDE);
            inside.then_some((tet as usize, weights))
        })
    }
}

fn barycentric(points: &[[f64; 3]; 4], x: [f64; 3]) -> [f64; 4] {
    let all = tet_volume(points);
    std::array::from_fn(|a| {
        let mut p = *points;
        p[a] = x;
        tet_volume(&p) / all
    })
}

/// Energy of the difference between displacements of two meshes of the same body, half of error
/// stress times error strain, J: by quadrature on the tetrahedra of the first mesh, best the finer.
///
/// Points outside of the second mesh, which a curved boundary can have, count with strain 0 there.
///
/// # Errors
/// [`FieldError`] if a displacement has the wrong length or is not finite, or a region of the first
/// mesh has no material.
pub fn energy_of_difference(
    mesh: &TetMesh,
    materials: &Materials,
    u: &[f64],
    other: &TetMesh,
    v: &[f64],
) -> Result<f64, FieldError> {
    let laws = materials.of_tets(mesh.regions())?;
    let (u, v) = (nodal_vectors(mesh, u)?, nodal_vectors(other, v)?);
    let locator = Locator::new(other);
    Ok(integral(mesh, |tet| {
        let (piece, law) = (Piece::new(mesh, tet, &u), laws[tet]);
        let (locator, v) = (&locator, &v);
        move |l: &[f64; 4]| {
            let strain = match locator.locate(piece.place(l)) {
                Some((place, there)) => Piece::new(other, place, v).strain(&there),
                None => [0.0; 6],
            };
            let own = piece.strain(l);
            law.energy_density(&std::array::from_fn(|i| own[i] - strain[i]))
        }
    }))
}
