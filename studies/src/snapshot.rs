//! The last state of a run: surface, displacement, and what the contact surface carries.

use signorini::contact::{ContactState, PointState};
use signorini::fem_mesh::{Surface, brick};
use signorini::prelude::Simulation;

use crate::Failure;
use crate::run::Header;

/// Surface and contact of a brick at one time. Units SI.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Loading or scene.
    pub loading: String,
    /// Time.
    pub time: f64,
    /// Nodes of the mesh.
    pub points: Vec<[f64; 3]>,
    /// Their displacements.
    pub displacement: Vec<[f64; 3]>,
    /// Triangles of the whole surface, outward.
    pub triangles: Vec<[u32; 3]>,
    /// The contact surface.
    pub contact: ContactPatch,
}

/// Values at the nodes of the contact surface. Nodes that are fixed carry zeros and no state.
#[derive(Debug, Clone, Default)]
pub struct ContactPatch {
    /// Mesh nodes, ascending.
    pub nodes: Vec<u32>,
    /// Coordinates.
    pub points: Vec<[f64; 3]>,
    /// Triangles by places in `nodes`.
    pub triangles: Vec<[u32; 3]>,
    /// Pressing force, N.
    pub normal_force: Vec<f64>,
    /// Friction force in space, N.
    pub friction_force: Vec<[f64; 3]>,
    /// Area, m2.
    pub area: Vec<f64>,
    /// Slip rate of nodes in contact, m/s.
    pub slip_rate: Vec<f64>,
    /// Distance to the floor, m.
    pub gap: Vec<f64>,
    /// What the node does.
    pub state: Vec<Option<ContactState>>,
}

/// The first contact surface of a scene that has been stepped; the bottom of the brick if there is none.
pub fn contact_surface(simulation: &Simulation) -> Result<Surface, Failure> {
    let first = simulation.result().and_then(|r| r.surfaces().first().cloned());
    match first {
        Some(surface) => Ok(surface),
        None => Ok(Surface::new(simulation.scene().mesh(), &[brick::Z_MIN])?),
    }
}

impl ContactPatch {
    /// Spreads the contact points over the nodes of a surface.
    pub fn new(surface: &Surface, mesh_points: &[[f64; 3]], points: &[PointState]) -> Self {
        let n = surface.nodes().len();
        let mut patch = Self {
            nodes: surface.nodes().to_vec(),
            points: surface.nodes().iter().map(|&node| mesh_points[node as usize]).collect(),
            triangles: surface.triangles().to_vec(),
            normal_force: vec![0.0; n],
            friction_force: vec![[0.0; 3]; n],
            area: surface.areas().to_vec(),
            slip_rate: vec![0.0; n],
            gap: vec![0.0; n],
            state: vec![None; n],
        };
        // the scenes of the studies that are drawn have one contact surface
        for point in points.iter().filter(|p| p.surface == 0) {
            let Some(k) = surface.local(point.node) else {
                continue;
            };
            patch.normal_force[k] = -point.normal_force;
            patch.friction_force[k] = point.friction_force;
            patch.gap[k] = point.gap;
            patch.state[k] = Some(point.state);
            if point.state != ContactState::Open {
                patch.slip_rate[k] = point.slip_rate;
            }
        }
        patch
    }

    /// Lengths of the friction forces, N.
    pub fn friction(&self) -> Vec<f64> {
        let length = |f: &[f64; 3]| f.iter().map(|c| c * c).sum::<f64>().sqrt();
        self.friction_force.iter().map(length).collect()
    }

    /// Forces over areas, Pa.
    pub fn stress(&self, forces: &[f64]) -> Vec<f64> {
        forces.iter().zip(&self.area).map(|(f, a)| f / a).collect()
    }
}

impl Snapshot {
    /// The state after the last step solved.
    pub fn new(simulation: &Simulation, header: &Header) -> Result<Self, Failure> {
        let mesh = simulation.scene().mesh();
        let result = simulation.result().ok_or("no step is solved yet")?;
        let surface = contact_surface(simulation)?;
        Ok(Self {
            loading: header.loading.clone(),
            time: result.time(),
            points: mesh.points().to_vec(),
            displacement: result.displacement(),
            triangles: mesh.facets().iter().map(|f| f.nodes).collect(),
            contact: ContactPatch::new(&surface, mesh.points(), result.points()),
        })
    }
}
