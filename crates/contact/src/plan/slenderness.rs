//! How slender subdomains are: decides how many products a plan expects.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::{Decomposition, Subdomain, TetMesh};

/// Most subdomains that are looked at.
const SAMPLE: usize = 64;

/// Largest over smallest extent of the subdomains, the mean weighted by their tetrahedra; of many every so many.
pub(crate) fn slenderness(mesh: &TetMesh, decomposition: &Decomposition) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let subdomains = decomposition.subdomains();
    for subdomain in subdomains
        .iter()
        .step_by(subdomains.len().div_ceil(SAMPLE).max(1))
    {
        let weight = subdomain.elements.len() as f64;
        sum += weight * of_one(mesh, subdomain);
        count += weight;
    }
    if count > 0.0 { sum / count } else { 1.0 }
}

/// Ratio of the axes of the ellipsoid with the same second moments: that of the edges of a brick, however it lies.
fn of_one(mesh: &TetMesh, subdomain: &Subdomain) -> f64 {
    let place = |tet: usize| mesh.tet_points(tet).map(Vector3::from);
    let Some(&first) = subdomain.elements.first() else {
        return 1.0;
    };
    // far from the origin moments would cancel
    let origin = place(first as usize)[0];
    let (mut volume, mut moment) = (0.0, Vector3::zeros());
    let mut second = Matrix3::zeros();
    for &tet in &subdomain.elements {
        let points = place(tet as usize).map(|p| p - origin);
        let v = mesh.volume(tet as usize);
        let sum: Vector3<f64> = points.iter().sum();
        // exact for a tetrahedron
        let squares: Matrix3<f64> = points.iter().map(|p| p * p.transpose()).sum();
        second += (squares + sum * sum.transpose()) * (v / 20.0);
        moment += sum * (v / 4.0);
        volume += v;
    }
    let centre = moment / volume;
    let spread = second / volume - centre * centre.transpose();
    let axes = SymmetricEigen::new(spread).eigenvalues;
    let ratio = (axes.max() / axes.min()).sqrt();
    if ratio.is_finite() { ratio } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_fem_mesh::Brick;

    #[test]
    fn bricks_have_the_ratio_of_their_edges() {
        let mesh = Brick::new([8.0, 1.0, 0.5], [8, 2, 1]).build().unwrap();
        let whole = Decomposition::whole(&mesh);
        assert!((slenderness(&mesh, &whole) - 16.0).abs() < 1e-9);
        let cut = Decomposition::boxes(&mesh, [8, 1, 1]).unwrap();
        assert!((slenderness(&mesh, &cut) - 2.0).abs() < 0.1);
        // turned and far away
        let turned = mesh
            .map_points(|[x, y, z]| [0.6 * x - 0.8 * y + 1e4, 0.8 * x + 0.6 * y, z - 1e4])
            .unwrap();
        assert!((slenderness(&turned, &Decomposition::whole(&turned)) - 16.0).abs() < 1e-6);
    }
}
