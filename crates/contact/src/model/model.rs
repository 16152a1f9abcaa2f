//! The model: everything that is computed once from a scene and read-only afterwards.

use super::bodies::Bodies;
use super::contact_point::{ConstrainedPoint, Tangential, constrained_points};
use crate::discrete::{
    ContactPoint, Found, check_gaps, check_load, check_materials, check_motions, check_penetration,
    contact_constraints, largest_force, lower_supports,
};
use crate::error::ContactError;
use crate::plan::Plan;
use crate::scene::{Friction, Scene};
use crate::settings::Settings;
use signorini_fem_mesh::{Decomposition, History, assemble_load};
use signorini_qp::{ProductSet, RadiusSlope, Segment};
use signorini_tfeti::{LoadResponse, Tfeti, TfetiBuilder};

/// Segment numbers of the feasible set.
pub(crate) const DISCS: usize = 1;
/// Intervals of points with one tangential direction.
pub(crate) const INTERVALS: usize = 2;

/// Everything that is computed once.
#[derive(Debug)]
pub(crate) struct Model {
    pub(crate) scene: Scene,
    pub(crate) plan: Plan,
    pub(crate) decomposition: Decomposition,
    pub(crate) tfeti: Tfeti,
    pub(crate) bodies: Bodies,
    pub(crate) loads: Vec<LoadResponse>,
    /// History of each displacement case.
    pub(crate) motions: Vec<History>,
    pub(crate) points: Vec<ConstrainedPoint>,
    /// Contact surfaces, fixed nodes included, what contacts say of their nodes, and all points, those left out included.
    pub(crate) found: Found,
    /// What of that the certificate judges.
    pub(crate) judged: Vec<ContactPoint>,
    /// Set with zero radii.
    pub(crate) set: ProductSet,
    /// Stiffness of the support rows, made if supports move.
    support_stiffness: std::sync::OnceLock<Vec<f64>>,
    /// Stiffness of the copies of each node, made with the first certificate.
    copies: std::sync::OnceLock<signorini_tfeti::CopyStiffness>,
}

impl Model {
    /// What prescribed displacements in `offset` (row units) would do to their nodes with all others held: for each body the
    /// norm of these forces, N. Empty if no support moves.
    pub(crate) fn driven(&self, offset: &[f64]) -> Vec<f64> {
        if self.motions.is_empty() {
            return Vec::new();
        }
        let rows = self.tfeti.gluing().ranges().dirichlet.clone();
        let stiffness = self.support_stiffness.get_or_init(|| {
            let mut out = vec![0.0; rows.len()];
            self.tfeti.row_stiffness(rows.clone(), &mut out);
            out
        });
        let mut out = vec![0.0; self.bodies.count().max(1)];
        for (row, k) in rows.zip(stiffness) {
            out[self.bodies.of_row(row)] += (k * offset[row]).powi(2);
        }
        out.iter_mut().for_each(|v| *v = v.sqrt());
        out
    }

    /// Stiffness of the copies of each node: weighs them in the estimate of the algebraic error, and scales certificates.
    pub(crate) fn copies(&self) -> &signorini_tfeti::CopyStiffness {
        self.copies.get_or_init(|| self.tfeti.all_copy_stiffness())
    }

    pub(crate) fn new(scene: Scene, settings: &Settings) -> Result<Self, ContactError> {
        scene.validate()?;
        settings.validate()?;
        let decomposition = scene.decompose()?;
        let (plan, found) = Plan::with_decomposition(&scene, settings, &decomposition)?;
        check_materials(&scene)?;
        check_motions(&scene)?;
        let (supports, motions) = lower_supports(&scene)?;
        let candidates = &found.points;
        check_gaps(&scene, &found)?;
        check_penetration(&scene, candidates, &supports, &motions)?;
        let nodes =
            (!scene.contacts.is_empty()).then(|| contact_constraints(&scene, candidates.iter()));
        let mut builder = TfetiBuilder::new(&scene.mesh, &decomposition, &scene.materials)
            .with_supports(&supports)
            .with_row_scaling(settings.row_scaling)
            .with_sharing(settings.sharing)
            .with_inverse(settings.inverse);
        if let Some(nodes) = &nodes {
            builder = builder.with_contact(nodes);
        }
        let tfeti = builder.build()?;
        let mut loads = Vec::with_capacity(scene.loads.len());
        for (index, load) in scene.loads.iter().enumerate() {
            let local = assemble_load(&scene.mesh, &decomposition, &load.density)
                .map_err(|source| ContactError::Load { index, source })?;
            check_load(&scene, index, largest_force(&local))?;
            loads.push(tfeti.load_response(&local)?);
        }
        let points = constrained_points(&scene, candidates, tfeti.gluing());
        let ranges = tfeti.gluing().ranges();
        let set = ProductSet::new(vec![
            Segment::upper(vec![0.0; ranges.normal.len()]),
            Segment::discs(vec![0.0; ranges.discs.len() / 2]),
            Segment::bounds(
                vec![0.0; ranges.intervals.len()],
                vec![0.0; ranges.intervals.len()],
            ),
            Segment::Free(ranges.interface.len() + ranges.dirichlet.len()),
        ])
        .map_err(signorini_qp::QpError::from)?;
        Ok(Self {
            bodies: Bodies::new(&tfeti, &decomposition, candidates),
            judged: found.judged(points.iter().map(|p| p.place)),
            scene,
            plan,
            decomposition,
            tfeti,
            loads,
            motions,
            points,
            found,
            set,
            support_stiffness: std::sync::OnceLock::new(),
            copies: std::sync::OnceLock::new(),
        })
    }

    /// Friction law of a point.
    pub(crate) fn law(&self, point: &ConstrainedPoint) -> &Friction {
        self.scene.contacts[point.surface].friction()
    }

    /// Whether the law of some contact surface is such.
    pub(crate) fn any_law(&self, such: impl Fn(&Friction) -> bool) -> bool {
        self.scene.contacts.iter().any(|c| such(c.friction()))
    }

    /// Tangential rows.
    pub(crate) fn tangential_rows(&self) -> usize {
        self.tfeti.gluing().ranges().tangential().len()
    }

    /// First tangential row.
    pub(crate) fn tangential_start(&self) -> usize {
        self.tfeti.gluing().ranges().tangential().start
    }

    /// Writes slip bounds (forces in N, one a point) into the set.
    pub(crate) fn set_slip_bounds(
        &self,
        set: &mut ProductSet,
        bound: impl Fn(usize, &ConstrainedPoint) -> f64,
    ) {
        let ranges = self.tfeti.gluing().ranges();
        for (k, point) in self.points.iter().enumerate() {
            match point.tangential {
                Tangential::None => {}
                Tangential::Plane { row, scale } => {
                    let disc = (row - ranges.discs.start) / 2;
                    if let Ok(radii) = set.radii_mut(DISCS) {
                        radii[disc] = bound(k, point) / scale;
                    }
                }
                Tangential::Line { row, scale, .. } => {
                    let interval = row - ranges.intervals.start;
                    if let Ok((lower, upper)) = set.bounds_mut(INTERVALS) {
                        let radius = bound(k, point) / scale;
                        lower[interval] = -radius;
                        upper[interval] = radius;
                    }
                }
            }
        }
    }

    /// How the slip bounds that [`set_slip_bounds`](Self::set_slip_bounds) writes to discs follow the normal rows, for a
    /// bound of `coefficient(point)` times the normal force.
    pub(crate) fn slip_slopes(&self, coefficient: impl Fn(usize) -> f64) -> Vec<RadiusSlope> {
        let slope = |(k, point): (usize, &ConstrainedPoint)| match point.tangential {
            Tangential::Plane { row, scale } => Some(RadiusSlope {
                disc: row,
                component: point.row,
                // normal multipliers are negative where pressed
                slope: -coefficient(k) * point.scale / scale,
            }),
            Tangential::None | Tangential::Line { .. } => None,
        };
        self.points.iter().enumerate().filter_map(slope).collect()
    }
}
