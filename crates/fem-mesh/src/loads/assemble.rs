//! Body forces, surface tractions and nodal forces as consistent nodal loads.

use rayon::prelude::*;

use crate::decomposition::{Decomposition, Subdomain};
use crate::mesh::{FacetTag, TetMesh, curved_facet, facet_area_vector, facet_shape, shape, tangents};
use crate::quadrature;
use crate::vec3::{Vec3, add, is_finite, norm, scale, tet_volume};

use super::density::{LoadDensity, LoadError};
use super::moment::traction_of_moment;

/// Turns a load into nodal forces of the subdomains, one vector each with component i of local
/// node n at 3 n + i.
///
/// The forces are consistent: the work of the load on the displacements of the elements. In a mesh of order 1 a
/// constant load gives a third of each triangle's force, a quarter of each tetrahedron's, to its nodes; in one of order
/// 2 with straight edges a third of each triangle's to its mid-nodes and nothing to its corners. Functions and curved
/// elements are integrated by rules of degree 5, along the normal at each point. Each facet and tetrahedron loads only
/// the subdomain that owns it, a nodal force only the first copy of its node.
///
/// # Errors
/// [`LoadError`] if the tag or node is unknown, a load is not finite, or the decomposition belongs
/// to another mesh.
pub fn assemble_load(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    load: &LoadDensity,
) -> Result<Vec<Vec<f64>>, LoadError> {
    expect_decomposition(mesh, decomposition)?;
    match load {
        LoadDensity::Body(value) => body(mesh, decomposition, None, Density::Constant(*value)),
        LoadDensity::BodyField(value) => body(mesh, decomposition, None, Density::Varying(&|x, _| value(x))),
        LoadDensity::BodyIn(region, value) => body(mesh, decomposition, Some(*region), Density::Constant(*value)),
        LoadDensity::BodyFieldIn(region, value) => {
            body(mesh, decomposition, Some(*region), Density::Varying(&|x, _| value(x)))
        }
        LoadDensity::Traction(tag, value) => traction(mesh, decomposition, *tag, |_| Density::Constant(*value)),
        LoadDensity::TractionField(tag, value) => traction(mesh, decomposition, *tag, |_| Density::Varying(&**value)),
        LoadDensity::Pressure(tag, value) => {
            traction(mesh, decomposition, *tag, |n| Density::Constant(scale(-value, n)))
        }
        LoadDensity::Force(tag, value) => {
            let share = scale(1.0 / tagged_area(mesh, *tag), *value);
            traction(mesh, decomposition, *tag, |_| Density::Constant(share))
        }
        LoadDensity::Moment(tag, value) => {
            let field = traction_of_moment(mesh, *tag, *value);
            traction(mesh, decomposition, *tag, |_| Density::Varying(&field))
        }
        LoadDensity::NodalForces(forces) => nodal(mesh, decomposition, forces),
    }
}

/// Checks that a decomposition is one of the mesh.
pub(super) fn expect_decomposition(mesh: &TetMesh, decomposition: &Decomposition) -> Result<(), LoadError> {
    let (decomposed, meshed) = (decomposition.parts().len(), mesh.tets().len());
    if decomposed != meshed || decomposition.nodes() != mesh.points().len() {
        return Err(LoadError::ForeignDecomposition { decomposed, meshed });
    }
    Ok(())
}

/// A region that a mesh does not have, and those that it has.
pub(super) fn missing_region(mesh: &TetMesh, region: Option<u32>) -> Option<(u32, Vec<u32>)> {
    let (region, known) = (region?, mesh.distinct_regions());
    (!known.contains(&region)).then_some((region, known))
}

fn tagged_area(mesh: &TetMesh, tag: FacetTag) -> f64 {
    let tagged = mesh.facets().iter().enumerate().filter(|(_, f)| f.tag == tag);
    if mesh.order() == 2 {
        let rule = quadrature::triangle();
        let area = |points: [Vec3; 6]| -> f64 { rule.iter().map(|(l, w)| w * norm(curved_facet(&points, l).1)).sum() };
        return tagged.map(|(facet, _)| area(mesh.quadratic_facet_points(facet))).sum();
    }
    tagged.map(|(facet, _)| norm(facet_area_vector(mesh, facet))).sum()
}

/// A density as a function of point and normal (the latter zero inside the body).
#[derive(Clone, Copy)]
enum Density<'a> {
    Constant([f64; 3]),
    Varying(&'a (dyn Fn([f64; 3], [f64; 3]) -> [f64; 3] + Sync)),
}

/// What an integral over an element needs at a point: values of its shape functions, the place, the normal (zero inside
/// the body), and its measure (area or volume) there.
type At<const N: usize> = ([f64; N], Vec3, Vec3, f64);

/// Forces of the nodes of an element with `N` nodes, from each point with its weight.
fn forces<'a, const N: usize>(
    points: impl Iterator<Item = (At<N>, f64)>,
    density: impl Fn(Vec3) -> Density<'a>,
) -> Result<[Vec3; N], LoadError> {
    let mut sums = [[0.0; 3]; N];
    for ((shape, place, normal, measure), weight) in points {
        let value = match density(normal) {
            Density::Constant(value) => value,
            Density::Varying(of) => of(place, normal),
        };
        let value = finite(place, value)?;
        for (sum, value_of_shape) in sums.iter_mut().zip(shape) {
            *sum = add(*sum, scale(measure * weight * value_of_shape, value));
        }
    }
    Ok(sums)
}

impl Density<'_> {
    /// Forces of the nodes of a quadratic tetrahedron.
    fn quadratic_forces(&self, points: &[Vec3; 10], rule: &[([f64; 4], f64)]) -> Result<[Vec3; 10], LoadError> {
        let at = |(l, weight): &([f64; 4], f64)| {
            let shape = shape(l);
            let volume = tet_volume(&tangents(points, l));
            ((shape, quadrature::at(points, &shape), [0.0; 3], volume), *weight)
        };
        forces(rule.iter().map(at), |_| *self)
    }

    /// Forces of the nodes of a simplex of the given measure (area or volume).
    fn nodal_forces<const N: usize>(
        &self,
        points: &[[f64; 3]; N],
        normal: [f64; 3],
        measure: f64,
        rule: &[([f64; N], f64)],
    ) -> Result<[[f64; 3]; N], LoadError> {
        match self {
            Self::Constant(value) => {
                let place = quadrature::at(points, &[1.0 / N as f64; N]);
                let value = finite(place, *value)?;
                Ok([scale(measure / N as f64, value); N])
            }
            Self::Varying(_) => {
                let at = |(l, weight): &([f64; N], f64)| ((*l, quadrature::at(points, l), normal, measure), *weight);
                forces(rule.iter().map(at), |_| *self)
            }
        }
    }
}

/// Forces of the corners, and of the mid-nodes if there are any, of a tetrahedron under a force per volume.
///
/// # Errors
/// [`LoadError::NotFinite`] if the force is not finite somewhere.
pub fn tet_forces(
    corners: &[Vec3; 4],
    mids: Option<&[Vec3; 6]>,
    density: impl Fn(Vec3) -> Vec3 + Sync,
) -> Result<Vec<Vec3>, LoadError> {
    let rule = quadrature::tetrahedron();
    let density = |place: Vec3, _: Vec3| density(place);
    let density = Density::Varying(&density);
    let Some(mids) = mids else {
        let forces = density.nodal_forces(corners, [0.0; 3], tet_volume(corners), &rule)?;
        return Ok(forces.into());
    };
    let points = std::array::from_fn(|k| if k < 4 { corners[k] } else { mids[k - 4] });
    Ok(density.quadratic_forces(&points, &rule)?.into())
}

fn finite(place: [f64; 3], value: [f64; 3]) -> Result<[f64; 3], LoadError> {
    if is_finite(value) { Ok(value) } else { Err(LoadError::NotFinite { place, value }) }
}

pub(super) fn accumulate<const N: usize>(vector: &mut [f64], nodes: &[u32; N], forces: [[f64; 3]; N]) {
    for (&node, force) in nodes.iter().zip(forces) {
        (0..3).for_each(|i| vector[3 * node as usize + i] += force[i]);
    }
}

/// In a region, or everywhere.
fn body(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    region: Option<u32>,
    density: Density<'_>,
) -> Result<Vec<Vec<f64>>, LoadError> {
    if let Some((region, known)) = missing_region(mesh, region) {
        return Err(LoadError::UnknownRegion { region, known });
    }
    let is_inside = |element: u32| region.is_none_or(|region| mesh.regions()[element as usize] == region);
    let rule = quadrature::tetrahedron();
    let of_subdomain = |subdomain: &Subdomain| {
        let mut vector = vec![0.0; subdomain.dofs()];
        let quadratic = subdomain.quadratic_tets();
        let elements = subdomain.elements.iter().enumerate();
        for (local, &element) in elements.filter(|(_, element)| is_inside(**element)) {
            let element = element as usize;
            if mesh.order() == 2 {
                let forces = density.quadratic_forces(&mesh.quadratic_points(element), &rule)?;
                accumulate(&mut vector, &quadratic[local], forces);
            } else {
                let (points, volume) = (mesh.tet_points(element), mesh.volume(element));
                let forces = density.nodal_forces(&points, [0.0; 3], volume, &rule)?;
                accumulate(&mut vector, &subdomain.tets[local], forces);
            }
        }
        Ok(vector)
    };
    let each: Vec<_> = decomposition.subdomains().par_iter().map(of_subdomain).collect();
    // the error of the lowest subdomain, whichever thread met one first
    each.into_iter().collect()
}

fn traction<'a>(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    tag: FacetTag,
    density: impl Fn([f64; 3]) -> Density<'a> + Sync,
) -> Result<Vec<Vec<f64>>, LoadError> {
    let mut facets = vec![Vec::new(); decomposition.subdomains().len()];
    for (facet, _) in mesh.facets().iter().enumerate().filter(|(_, f)| f.tag == tag) {
        facets[decomposition.parts()[mesh.facet_owner(facet)] as usize].push(facet);
    }
    if facets.iter().all(Vec::is_empty) {
        return Err(LoadError::UnknownTag {
            tag,
            known: mesh.tags(),
        });
    }
    let rule = quadrature::triangle();
    let of_subdomain = |(subdomain, facets): (&Subdomain, &Vec<usize>)| {
        let mut vector = vec![0.0; subdomain.dofs()];
        // nodes of a facet are nodes of its owner
        let local = |node: u32| subdomain.local(node).unwrap_or_default() as u32;
        for &facet in facets {
            if mesh.order() == 2 {
                let points = mesh.quadratic_facet_points(facet);
                let at = |(l, weight): &([f64; 3], f64)| {
                    let (place, area) = curved_facet(&points, l);
                    let size = norm(area);
                    ((facet_shape(l), place, scale(1.0 / size, area), size), *weight)
                };
                let nodes = mesh.quadratic_facet(facet).map(local);
                accumulate(&mut vector, &nodes, forces(rule.iter().map(at), &density)?);
                continue;
            }
            let points = mesh.facet_points(facet);
            let vector_area = facet_area_vector(mesh, facet);
            let area = norm(vector_area);
            let normal = scale(1.0 / area, vector_area);
            let nodes = mesh.facets()[facet].nodes.map(local);
            accumulate(
                &mut vector,
                &nodes,
                density(normal).nodal_forces(&points, normal, area, &rule)?,
            );
        }
        Ok(vector)
    };
    let pairs = decomposition.subdomains().par_iter().zip(&facets);
    let each: Vec<_> = pairs.map(of_subdomain).collect();
    each.into_iter().collect()
}

fn nodal(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    forces: &[(u32, [f64; 3])],
) -> Result<Vec<Vec<f64>>, LoadError> {
    let nodes = mesh.points().len();
    let zero = |s: &Subdomain| vec![0.0; s.dofs()];
    let mut vectors: Vec<_> = decomposition.subdomains().iter().map(zero).collect();
    for &(node, force) in forces {
        let place = mesh.points().get(node as usize).copied();
        let place = place.ok_or(LoadError::UnknownNode { node, nodes })?;
        let force = finite(place, force)?;
        if let Some(copy) = decomposition.copies(node as usize).first() {
            accumulate(&mut vectors[copy.subdomain as usize], &[copy.local], [force]);
        }
    }
    Ok(vectors)
}
