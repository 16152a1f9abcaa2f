//! A moment as a traction that grows linearly from the centroid of the facets.

use nalgebra::{Matrix3, Vector3};

use crate::mesh::{FacetTag, TetMesh, curved_facet, facet_area_vector};
use crate::quadrature;
use crate::vec3::{Vec3, add, cross, norm, scale, sub};

/// The traction `w x (x - c)` on the facets of a tag, at places and normals, whose moment is the given one: `c` is
/// their centroid, and their second moments of area about it times `w` are the moment. Not a number without facets.
pub(super) fn traction_of_moment(mesh: &TetMesh, tag: FacetTag, moment: Vec3) -> impl Fn(Vec3, Vec3) -> Vec3 {
    let areas = areas(mesh, tag);
    let whole: f64 = areas.iter().map(|(_, area)| area).sum();
    // twice, so that rounding is that of the arms and not of the coordinates
    let nearer = |centre: Vec3| {
        let arms = areas.iter().map(|(x, area)| scale(*area, sub(*x, centre)));
        add(centre, scale(1.0 / whole, arms.fold([0.0; 3], add)))
    };
    let centroid = nearer(nearer([0.0; 3]));
    let mut second = Matrix3::zeros();
    for (x, area) in areas {
        let arm = Vector3::from(sub(x, centroid));
        second += area * (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose());
    }
    let solved = second.cholesky().map(|c| c.solve(&Vector3::from(moment)));
    let spin = solved.map_or([f64::NAN; 3], Into::into);
    move |x, _| cross(spin, sub(x, centroid))
}

/// The points at which tractions are integrated, each with its share of the area: the same rule as that of the nodal
/// forces, so that these have the moment to rounding.
fn areas(mesh: &TetMesh, tag: FacetTag) -> Vec<(Vec3, f64)> {
    let rule = quadrature::triangle();
    let mut out = Vec::new();
    for (facet, _) in mesh.facets().iter().enumerate().filter(|(_, f)| f.tag == tag) {
        if mesh.order() == 2 {
            let points = mesh.quadratic_facet_points(facet);
            out.extend(rule.iter().map(|(l, weight)| {
                let (place, area) = curved_facet(&points, l);
                (place, weight * norm(area))
            }));
            continue;
        }
        let (points, area) = (mesh.facet_points(facet), norm(facet_area_vector(mesh, facet)));
        out.extend(
            rule.iter()
                .map(|(l, weight)| (quadrature::at(&points, l), weight * area)),
        );
    }
    out
}
