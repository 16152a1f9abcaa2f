//! Springs at the nodes of the mesh.

use super::creases::area_vector;
use super::overflow::check_spring;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::{Place, Scene, Spring};
use crate::tolerances::NO_SPRING;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use signorini_fem_mesh::{Surface, TetMesh, vec3};
use signorini_tfeti::NodalSpring;
use std::collections::BTreeMap;

/// The springs of a scene, node by node.
#[derive(Debug, Default)]
pub(crate) struct Springs {
    /// Those of all foundations together, along their principal directions.
    pub(crate) nodal: Vec<NodalSpring>,
    /// Of each foundation of the scene the stiffness at its nodes, N/m, between what supports leave free.
    pub(crate) by_spring: Vec<BTreeMap<u32, Matrix3<f64>>>,
}

impl Springs {
    pub(super) fn new(scene: &Scene, supports: &Supports) -> Result<Self, ContactError> {
        let mut springs = Self::default();
        let mut sum: BTreeMap<u32, Matrix3<f64>> = BTreeMap::new();
        for (index, spring) in scene.springs.iter().enumerate() {
            let mut own = at_nodes(&scene.mesh, spring)?;
            for (node, stiffness) in &mut own {
                check_spring(index, *node, stiffness.amax())?;
                *sum.entry(*node).or_default() += *stiffness;
                let free = free_part(supports, *node);
                *stiffness = free * *stiffness * free;
            }
            springs.by_spring.push(own);
        }
        for (node, whole) in sum {
            let free = free_part(supports, node);
            let moved = supports.merged.prescribed(node);
            let eigen = SymmetricEigen::new(free * whole * free);
            for (&stiffness, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
                if stiffness > NO_SPRING * whole.amax() {
                    // what supports move an inclined spring by pulls along what they leave free
                    let pulled = whole * direction;
                    let rest = |(case, by): &(u32, [f64; 3])| {
                        let force = pulled.dot(&Vector3::from(*by));
                        let counts = force.abs() > NO_SPRING * whole.amax() * vec3::norm(*by);
                        counts.then(|| (*case, -force / stiffness))
                    };
                    springs.nodal.push(NodalSpring {
                        node,
                        direction: [direction[0], direction[1], direction[2]],
                        stiffness,
                        rest: moved.iter().filter_map(rest).collect(),
                    });
                }
            }
        }
        Ok(springs)
    }
}

/// The stiffness of a spring at its nodes, N/m.
fn at_nodes(mesh: &TetMesh, spring: &Spring) -> Result<BTreeMap<u32, Matrix3<f64>>, ContactError> {
    let mut own: BTreeMap<u32, Matrix3<f64>> = BTreeMap::new();
    let tag = match &spring.place {
        Place::Tag(tag) => *tag,
        Place::Nodes(nodes) => {
            let stiffness = spring.matrix([0.0; 3]);
            for node in nodes {
                *own.entry(*node).or_default() += stiffness;
            }
            return Ok(own);
        }
    };
    let surface = Surface::new(mesh, &[tag])?;
    for (triangle, &facet) in surface.triangles().iter().zip(surface.facets()) {
        let vector = area_vector(mesh, &surface, triangle);
        let area = vec3::norm(vector);
        let share = spring.matrix(vector.map(|c| c / area)) * (area / 3.0);
        // what a uniform stress does to nodes: nothing to the corners of a quadratic facet
        let mids = mesh.facet_mids(facet as usize);
        for node in mids.unwrap_or(mesh.facets()[facet as usize].nodes) {
            *own.entry(node).or_default() += share;
        }
    }
    Ok(own)
}

/// The projection of a node on the directions that no support fixes.
fn free_part(supports: &Supports, node: u32) -> Matrix3<f64> {
    let fixed = supports.merged.directions(node).iter();
    fixed.fold(Matrix3::identity(), |free, fixed| {
        let direction = Vector3::from(fixed.direction);
        free - direction * direction.transpose()
    })
}
