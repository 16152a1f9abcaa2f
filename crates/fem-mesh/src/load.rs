//! Body forces, surface tractions and nodal forces as consistent nodal loads.

use std::sync::Arc;

use rayon::prelude::*;
use thiserror::Error;

use crate::decomposition::Decomposition;
use crate::mesh::{FacetTag, TetMesh, facet_area_vector, tag_list};
use crate::quadrature;
use crate::vec3::{add, is_finite, norm, scale};

/// A vector that depends on the point.
pub type PointField = Arc<dyn Fn([f64; 3]) -> [f64; 3] + Send + Sync>;

/// A vector that depends on the point and the outward unit normal there.
pub type SurfaceField = Arc<dyn Fn([f64; 3], [f64; 3]) -> [f64; 3] + Send + Sync>;

/// A load in space; a [`History`](crate::History) says how it changes in time.
#[derive(Clone)]
#[non_exhaustive]
pub enum LoadDensity {
    /// The same force per volume everywhere (F of the paper).
    Body([f64; 3]),
    /// Force per volume that depends on the point.
    BodyField(PointField),
    /// The same force per area on all facets of a tag (P of the paper).
    Traction {
        /// Loaded part of the boundary.
        tag: FacetTag,
        /// Force per area.
        value: [f64; 3],
    },
    /// Force per area that depends on the point and the outward normal.
    TractionField {
        /// Loaded part of the boundary.
        tag: FacetTag,
        /// Force per area at (point, outward unit normal).
        value: SurfaceField,
    },
    /// Pressure on all facets of a tag: the force per area is -value times the outward normal, so
    /// a positive pressure pushes into the body.
    Pressure {
        /// Loaded part of the boundary.
        tag: FacetTag,
        /// Pressure, positive into the body.
        value: f64,
    },
    /// Forces at single nodes (global numbers); forces at the same node add up.
    NodalForces(Vec<(u32, [f64; 3])>),
}

impl LoadDensity {
    /// The same force per volume everywhere.
    #[must_use]
    pub fn body(value: [f64; 3]) -> Self {
        Self::Body(value)
    }

    /// Force per volume that depends on the point.
    #[must_use]
    pub fn body_field(value: impl Fn([f64; 3]) -> [f64; 3] + Send + Sync + 'static) -> Self {
        Self::BodyField(Arc::new(value))
    }

    /// The same force per area on all facets of a tag.
    #[must_use]
    pub fn traction(tag: FacetTag, value: [f64; 3]) -> Self {
        Self::Traction { tag, value }
    }

    /// Force per area that depends on the point and the outward unit normal.
    #[must_use]
    pub fn traction_field(
        tag: FacetTag,
        value: impl Fn([f64; 3], [f64; 3]) -> [f64; 3] + Send + Sync + 'static,
    ) -> Self {
        Self::TractionField {
            tag,
            value: Arc::new(value),
        }
    }

    /// Pressure, positive into the body.
    #[must_use]
    pub fn pressure(tag: FacetTag, value: f64) -> Self {
        Self::Pressure { tag, value }
    }

    /// Forces at single nodes.
    #[must_use]
    pub fn nodal_forces(forces: Vec<(u32, [f64; 3])>) -> Self {
        Self::NodalForces(forces)
    }
}

impl std::fmt::Debug for LoadDensity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Body(value) => f.debug_tuple("Body").field(value).finish(),
            Self::BodyField(_) => f.write_str("BodyField(..)"),
            Self::Traction { tag, value } => f
                .debug_struct("Traction")
                .field("tag", tag)
                .field("value", value)
                .finish(),
            Self::TractionField { tag, .. } => f
                .debug_struct("TractionField")
                .field("tag", tag)
                .finish_non_exhaustive(),
            Self::Pressure { tag, value } => f
                .debug_struct("Pressure")
                .field("tag", tag)
                .field("value", value)
                .finish(),
            Self::NodalForces(forces) => f.debug_tuple("NodalForces").field(forces).finish(),
        }
    }
}

/// A load that cannot be applied.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The decomposition was made from another mesh.
    #[error(
        "the decomposition has {decomposed} tetrahedra and the mesh {meshed}; decompose the mesh that is loaded"
    )]
    ForeignDecomposition {
        /// Tetrahedra of the decomposition.
        decomposed: usize,
        /// Tetrahedra of the mesh.
        meshed: usize,
    },
    /// No facet has the tag.
    #[error(
        "a load is given on {tag}, but no facet has it; the mesh has {}",
        tag_list(known)
    )]
    UnknownTag {
        /// The tag.
        tag: FacetTag,
        /// The tags of the mesh.
        known: Vec<FacetTag>,
    },
    /// A nodal force is given at a node that does not exist.
    #[error("a force is given at node {node}, but there are only {nodes} nodes, numbered from 0")]
    UnknownNode {
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A load is NaN or infinite.
    #[error("the load at {place:?} is {value:?}; it must be finite")]
    NotFinite {
        /// Where: a quadrature point, a centroid or a node.
        place: [f64; 3],
        /// The load there.
        value: [f64; 3],
    },
}

/// Turns a load into nodal forces of the subdomains, one vector each with component i of local
/// node n at 3 n + i.
///
/// The forces are consistent: the work of the load on the piecewise linear displacements. A
/// constant load gives a third of each triangle's force, a quarter of each tetrahedron's, to its
/// nodes; functions are integrated by rules of degree 5. Each facet and tetrahedron loads only the
/// subdomain that owns it, a nodal force only the first copy of its node.
///
/// # Errors
/// [`LoadError`] if the tag or node is unknown, a load is not finite, or the decomposition belongs
/// to another mesh.
pub fn assemble_load(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    load: &LoadDensity,
) -> Result<Vec<Vec<f64>>, LoadError> {
    let (decomposed, meshed) = (decomposition.parts().len(), mesh.tets().len());
    if decomposed != meshed || decomposition.nodes() != mesh.points().len() {
        return Err(LoadError::ForeignDecomposition { decomposed, meshed });
    }
    match load {
        LoadDensity::Body(value) => body(mesh, decomposition, Density::Constant(*value)),
        LoadDensity::BodyField(value) => {
            body(mesh, decomposition, Density::Varying(&|x, _| value(x)))
        }
        LoadDensity::Traction { tag, value } => {
            traction(mesh, decomposition, *tag, |_| Density::Constant(*value))
        }
        LoadDensity::TractionField { tag, value } => {
            traction(mesh, decomposition, *tag, |_| Density::Varying(&**value))
        }
        LoadDensity::Pressure { tag, value } => traction(mesh, decomposition, *tag, |n| {
            Density::Constant(scale(-value, n))
        }),
        LoadDensity::NodalForces(forces) => nodal(mesh, decomposition, forces),
    }
}

/// A density as a function of point and normal (the latter zero inside the body).
enum Density<'a> {
    Constant([f64; 3]),
    Varying(&'a (dyn Fn([f64; 3], [f64; 3]) -> [f64; 3] + Sync)),
}

impl Density<'_> {
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
            Self::Varying(density) => {
                let mut forces = [[0.0; 3]; N];
                for (barycentric, weight) in rule {
                    let place = quadrature::at(points, barycentric);
                    let value = finite(place, density(place, normal))?;
                    for a in 0..N {
                        let share = scale(measure * weight * barycentric[a], value);
                        forces[a] = add(forces[a], share);
                    }
                }
                Ok(forces)
            }
        }
    }
}

fn finite(place: [f64; 3], value: [f64; 3]) -> Result<[f64; 3], LoadError> {
    if is_finite(value) {
        Ok(value)
    } else {
        Err(LoadError::NotFinite { place, value })
    }
}

fn accumulate(vector: &mut [f64], node: u32, force: [f64; 3]) {
    for i in 0..3 {
        vector[3 * node as usize + i] += force[i];
    }
}

fn body(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    density: Density<'_>,
) -> Result<Vec<Vec<f64>>, LoadError> {
    let rule = quadrature::tetrahedron();
    let of_subdomain = |subdomain: &crate::Subdomain| {
        let mut vector = vec![0.0; subdomain.dofs()];
        for (&element, tet) in subdomain.elements.iter().zip(&subdomain.tets) {
            let points = mesh.tet_points(element as usize);
            let volume = mesh.volume(element as usize);
            let forces = density.nodal_forces(&points, [0.0; 3], volume, &rule)?;
            for (&node, force) in tet.iter().zip(forces) {
                accumulate(&mut vector, node, force);
            }
        }
        Ok(vector)
    };
    first_error(
        decomposition
            .subdomains()
            .par_iter()
            .map(of_subdomain)
            .collect(),
    )
}

fn traction<'a>(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    tag: FacetTag,
    density: impl Fn([f64; 3]) -> Density<'a> + Sync,
) -> Result<Vec<Vec<f64>>, LoadError> {
    let mut facets = vec![Vec::new(); decomposition.subdomains().len()];
    for (facet, _) in mesh
        .facets()
        .iter()
        .enumerate()
        .filter(|(_, f)| f.tag == tag)
    {
        facets[decomposition.part_of(mesh.facet_owner(facet)) as usize].push(facet);
    }
    if facets.iter().all(Vec::is_empty) {
        return Err(LoadError::UnknownTag {
            tag,
            known: mesh.tags(),
        });
    }
    let rule = quadrature::triangle();
    let of_subdomain = |(subdomain, facets): (&crate::Subdomain, &Vec<usize>)| {
        let mut vector = vec![0.0; subdomain.dofs()];
        for &facet in facets {
            let points = mesh.facet_points(facet);
            let vector_area = facet_area_vector(mesh, facet);
            let area = norm(vector_area);
            let normal = scale(1.0 / area, vector_area);
            let forces = density(normal).nodal_forces(&points, normal, area, &rule)?;
            for (&node, force) in mesh.facets()[facet].nodes.iter().zip(forces) {
                if let Some(local) = subdomain.local(node) {
                    accumulate(&mut vector, local as u32, force);
                }
            }
        }
        Ok(vector)
    };
    let pairs = decomposition.subdomains().par_iter().zip(&facets);
    first_error(pairs.map(of_subdomain).collect())
}

fn nodal(
    mesh: &TetMesh,
    decomposition: &Decomposition,
    forces: &[(u32, [f64; 3])],
) -> Result<Vec<Vec<f64>>, LoadError> {
    let nodes = mesh.points().len();
    let zero = |s: &crate::Subdomain| vec![0.0; s.dofs()];
    let mut vectors: Vec<_> = decomposition.subdomains().iter().map(zero).collect();
    for &(node, force) in forces {
        let place = mesh.points().get(node as usize).copied();
        let place = place.ok_or(LoadError::UnknownNode { node, nodes })?;
        let force = finite(place, force)?;
        if let Some(copy) = decomposition.copies(node as usize).first() {
            accumulate(&mut vectors[copy.subdomain as usize], copy.local, force);
        }
    }
    Ok(vectors)
}

/// The error of the lowest subdomain, whichever thread met one first.
fn first_error(results: Vec<Result<Vec<f64>, LoadError>>) -> Result<Vec<Vec<f64>>, LoadError> {
    results.into_iter().collect()
}
