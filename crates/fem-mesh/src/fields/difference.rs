//! Compares displacements of two meshes of the same body.

use crate::element::{Piece, integral};
use crate::material::Materials;
use crate::mesh::{EDGES, TetMesh, extent, shape, tangents};
use crate::quadrature;
use crate::tolerances::{CONVERGED, OUTSIDE, PLACED, PLACINGS};
use crate::vec3::{add, scale, sub, tet_volume};

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
            let (low, high) = extent(hull(mesh, tet));
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
    /// mesh. On faces the tetrahedron with the smallest number.
    fn locate(&self, point: [f64; 3]) -> Option<(usize, [f64; 4])> {
        let candidates = &self.tets[self.place(self.grid_box(point))];
        candidates.iter().find_map(|&tet| {
            let weights = self.coordinates(tet as usize, point);
            let inside = weights.iter().all(|w| *w >= -OUTSIDE);
            inside.then_some((tet as usize, weights))
        })
    }

    /// The barycentric coordinates of a point in a tetrahedron, of a curved one by Newton's method: outside if this does
    /// not converge.
    fn coordinates(&self, tet: usize, point: [f64; 3]) -> [f64; 4] {
        let mut l = barycentric(&self.mesh.tet_points(tet), point);
        if self.mesh.order() == 1 {
            return l;
        }
        let nodes = self.mesh.quadratic_points(tet);
        let mut last = f64::INFINITY;
        for _ in 0..PLACINGS {
            let missing = sub(point, quadrature::at(&nodes, &shape(&l)));
            let [own, others @ ..] = barycentric(&tangents(&nodes, &l), missing);
            let change = [own - 1.0, others[0], others[1], others[2]];
            last = change.iter().map(|c| c.abs()).sum();
            if last <= PLACED {
                break;
            }
            l = std::array::from_fn(|i| l[i] + change[i]);
        }
        if last <= CONVERGED { l } else { [-1.0; 4] }
    }
}

/// Points in whose convex hull a tetrahedron is: of a curved one the control points of its edges.
fn hull(mesh: &TetMesh, tet: usize) -> Vec<[f64; 3]> {
    let corners = mesh.tet_points(tet);
    let control = |(&[a, b], &mid): (&[usize; 2], &u32)| {
        let straight = scale(0.5, add(corners[a], corners[b]));
        sub(scale(2.0, mesh.points()[mid as usize]), straight)
    };
    let mids = mesh.mids().get(tet).into_iter().flatten();
    corners.into_iter().chain(EDGES.iter().zip(mids).map(control)).collect()
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
        let law = laws[tet];
        let piece = Piece::new(mesh, tet, &u).with_law(law);
        let (locator, v) = (&locator, &v);
        move |l: &[f64; 4]| {
            let strain = match locator.locate(piece.place(l)) {
                Some((place, there)) => Piece::new(other, place, v).with_law(law).strain(&there),
                None => [0.0; 6],
            };
            let own = piece.strain(l);
            law.energy_density(&std::array::from_fn(|i| own[i] - strain[i]))
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_pcg::Pcg64Mcg;

    /// Of strongly curved tetrahedra, in which Newton's method also cycles.
    #[test]
    fn a_place_that_is_found_is_there() {
        let mut dice = Pcg64Mcg::new(0x9e37_79b9_7f4a_7c15);
        let mut draw = |size: f64| [0; 3].map(|_| size * (2.0 * dice.random::<f64>() - 1.0));
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (mut meshes, mut found) = (0, 0);
        for _ in 0..3000 {
            let mids = EDGES.map(|[a, b]| add(scale(0.5, add(corners[a], corners[b])), draw(0.14)));
            let points = [&corners[..], &mids].concat();
            let Ok(mesh) = TetMesh::quadratic(points, vec![[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]], Vec::new()) else {
                continue;
            };
            meshes += 1;
            let (locator, nodes) = (Locator::new(&mesh), mesh.quadratic_points(0));
            for _ in 0..100 {
                let place = add([0.5; 3], draw(1.0));
                if let Some((_, l)) = locator.locate(place) {
                    found += 1;
                    let off = crate::vec3::norm(sub(quadrature::at(&nodes, &shape(&l)), place));
                    assert!(off < 1e-8, "{off}");
                }
            }
        }
        assert!(meshes > 300 && found > 300, "{meshes} {found}");
    }
}
