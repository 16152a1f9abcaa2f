//! The model: everything that is computed once from a scene and read-only afterwards.

use crate::bodies::Bodies;
use crate::candidates::{ContactPoint, Found, contact_nodes};
use crate::driven;
use crate::error::ContactError;
use crate::law::Friction;
use crate::magnitude;
use crate::plan::Plan;
use crate::precheck;
use crate::scene::Scene;
use crate::settings::Settings;
use signorini_fem_mesh::{Decomposition, History, StrainRecovery, SurfaceFrame, assemble_load};
use signorini_qp::{ProductSet, RadiusSlope, Segment};
use signorini_tfeti as tfeti;
use signorini_tfeti::{Gluing, LoadResponse, TangentialRows, Tfeti, TfetiBuilder};

/// A node that can touch an obstacle or a node of another body. A node in an edge or a corner is several, with other normals.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ConstrainedPoint {
    /// Mesh node.
    pub node: u32,
    /// Its partner on another body; `None` for a rigid obstacle.
    pub partner: Option<u32>,
    /// Position of its contact surface in [`Scene::contacts`].
    pub surface: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// Normal into the obstacle and two tangents.
    pub frame: SurfaceFrame,
    /// A third of the areas of the adjacent facets, m².
    pub area: f64,
    /// Initial distance to the obstacle, m.
    pub gap: f64,
    /// Place among all points of the scene.
    pub(crate) place: usize,
    /// Normal row.
    pub(crate) row: usize,
    /// Row value over normal displacement, and nodal force over multiplier.
    pub(crate) scale: f64,
    pub(crate) tangential: Tangential,
}

impl ConstrainedPoint {
    /// Directions of all rows of the point, with row and scale: the normal, then the tangential ones.
    pub(crate) fn directions(&self) -> impl Iterator<Item = ([f64; 3], usize, f64)> + use<> {
        std::iter::once((self.frame.normal, self.row, self.scale)).chain(self.along())
    }

    /// Directions of the tangential rows, with row and scale.
    pub(crate) fn along(&self) -> impl Iterator<Item = ([f64; 3], usize, f64)> + use<> {
        let [a, b] = self.frame.tangents;
        let list = match self.tangential {
            Tangential::None => [None, None],
            Tangential::Line {
                row,
                direction,
                scale,
            } => [Some((direction, row, scale)), None],
            Tangential::Plane { row, scale } => [Some((a, row, scale)), Some((b, row + 1, scale))],
        };
        list.into_iter().flatten()
    }
}

/// Tangential rows of a point, as positions among all tangential rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Tangential {
    None,
    /// One row along a direction.
    Line {
        row: usize,
        direction: [f64; 3],
        scale: f64,
    },
    /// Rows `row` and `row + 1` along the tangents of the frame.
    Plane {
        row: usize,
        scale: f64,
    },
}

impl Tangential {
    /// First row, number of rows, scale.
    pub(crate) fn rows(&self) -> Option<(usize, usize, f64)> {
        match *self {
            Self::None => None,
            Self::Line { row, scale, .. } => Some((row, 1, scale)),
            Self::Plane { row, scale } => Some((row, 2, scale)),
        }
    }
}

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
    /// Weights of the estimate of the algebraic error; made when it is first asked for.
    pub(crate) weights: std::sync::OnceLock<crate::algebraic::Weights>,
    /// Stiffness of the support rows, made if supports move.
    support_stiffness: std::sync::OnceLock<Vec<f64>>,
    /// Stiffness of the copies of each node, made with the first certificate.
    copies: std::sync::OnceLock<signorini_tfeti::internal::CopyStiffness>,
    /// Patches of the estimate of the discretisation error; made when it is first asked for.
    pub(crate) recovery: std::sync::OnceLock<StrainRecovery>,
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
    pub(crate) fn copies(&self) -> &signorini_tfeti::internal::CopyStiffness {
        self.copies.get_or_init(|| self.tfeti.all_copy_stiffness())
    }

    pub(crate) fn new(scene: Scene, settings: &Settings) -> Result<Self, ContactError> {
        Self::build(scene, settings, None, None)
    }

    /// The model with rows at some contact points only (ascending places); the plan is that of the whole scene.
    pub(crate) fn with_points(
        scene: Scene,
        settings: &Settings,
        kept: &[usize],
    ) -> Result<Self, ContactError> {
        Self::build(scene, settings, Some(kept), None)
    }

    /// The same scene with rows at other contact points; what does not depend on them is taken over.
    pub(crate) fn with_other_points(
        &self,
        settings: &Settings,
        kept: &[usize],
    ) -> Result<Self, ContactError> {
        Self::build(self.scene.clone(), settings, Some(kept), Some(self))
    }

    fn build(
        scene: Scene,
        settings: &Settings,
        kept: Option<&[usize]>,
        earlier: Option<&Self>,
    ) -> Result<Self, ContactError> {
        let (decomposition, (plan, found)) = match earlier {
            Some(model) => (
                model.decomposition.clone(),
                (model.plan.clone(), model.found.clone()),
            ),
            None => {
                scene.validate()?;
                settings.validate()?;
                let decomposition = scene.decompose()?;
                let plan = Plan::with_decomposition(&scene, settings, &decomposition)?;
                magnitude::check_materials(&scene)?;
                magnitude::check_motions(&scene)?;
                (decomposition, plan)
            }
        };
        let (supports, motions) = supports(&scene)?;
        let candidates = &found.points;
        if earlier.is_none() {
            magnitude::check_gaps(&scene, &found)?;
            driven::check(&scene, candidates, &supports, &motions)?;
        }
        let places: Vec<usize> = match kept {
            Some(kept) => kept.to_vec(),
            None => (0..candidates.len()).collect(),
        };
        let nodes = (!scene.contacts.is_empty())
            .then(|| contact_nodes(&scene, places.iter().map(|&k| &candidates[k])));
        let mut builder = TfetiBuilder::new(&scene.mesh, &decomposition, &scene.materials)
            .with_supports(&supports)
            .with_share_translates(settings.share_translates)
            .with_inverse(settings.inverse);
        if let Some(nodes) = &nodes {
            builder = builder.with_contact(nodes);
        }
        let tfeti = builder.build()?;
        let mut loads = Vec::with_capacity(scene.loads.len());
        for (index, load) in scene.loads.iter().enumerate() {
            let local = assemble_load(&scene.mesh, &decomposition, &load.density)
                .map_err(|source| ContactError::Load { index, source })?;
            magnitude::check_load(&scene, index, precheck::largest_force(&local))?;
            loads.push(tfeti.load_response(&local)?);
        }
        let points = constrained_points(&scene, candidates, &places, tfeti.gluing());
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
            weights: std::sync::OnceLock::new(),
            support_stiffness: std::sync::OnceLock::new(),
            copies: std::sync::OnceLock::new(),
            recovery: std::sync::OnceLock::new(),
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

/// The supports, and the history of each displacement case. Equal histories are one case, so that equal displacements of
/// a node that two supports share are recognised as equal.
pub(crate) fn supports(
    scene: &Scene,
) -> Result<(Vec<tfeti::NodeSupport>, Vec<History>), ContactError> {
    let mut motions: Vec<History> = Vec::new();
    let mut out = Vec::with_capacity(scene.supports.len());
    for (index, support) in scene.supports.iter().enumerate() {
        let nodes = scene.support_nodes(index)?;
        let mut one = tfeti::NodeSupport::partial(nodes, support.directions.clone());
        if let Some((values, history)) = &support.motion {
            let case = match motions.iter().position(|known| known == history) {
                Some(case) => case,
                None => {
                    motions.push(history.clone());
                    motions.len() - 1
                }
            };
            one = one.with_motion(tfeti::Motion {
                case: case as u32,
                values: values.clone(),
            });
        }
        out.push(one);
    }
    Ok((out, motions))
}

/// The points that have rows; `places` are those of the points that `gluing` was made from.
pub(crate) fn constrained_points(
    scene: &Scene,
    candidates: &[ContactPoint],
    places: &[usize],
    gluing: &Gluing,
) -> Vec<ConstrainedPoint> {
    let point = |info: &tfeti::ContactRows| {
        let place = places[info.point];
        let candidate = &candidates[place];
        let tangential = match info.tangential {
            TangentialRows::Disc { row, scale } => Tangential::Plane { row, scale },
            TangentialRows::Interval {
                row,
                direction,
                scale,
            } => Tangential::Line {
                row,
                direction,
                scale,
            },
            _ => Tangential::None,
        };
        ConstrainedPoint {
            node: candidate.node,
            partner: candidate.partner,
            surface: candidate.surface,
            position: scene.mesh.points()[candidate.node as usize],
            frame: candidate.frame,
            area: candidate.area,
            gap: candidate.gap,
            place,
            row: info.row,
            scale: info.scale,
            tangential,
        }
    };
    gluing.contact().iter().map(point).collect()
}

/// A scene for unit tests of what works on rows.
#[cfg(test)]
pub(crate) mod example {
    use super::Model;
    use crate::contact_surface::Contact;
    use crate::law::Friction;
    use crate::level::StepProblem;
    use crate::scene::{Scene, Support};
    use crate::settings::Settings;
    use crate::state::State;
    use signorini_fem_mesh::{Brick, Hooke, Materials, brick};

    /// A block on a rough floor at a distance.
    pub(crate) fn block(gap: f64, friction: Friction) -> Scene {
        let mesh = Brick::new([1.0; 3], [2; 3]).build().expect("brick");
        let elastic = Hooke::isotropic(1e6, 0.3).expect("Hooke");
        let floor = Contact::rigid(brick::Z_MIN).with_gap(gap);
        Scene::new(mesh, Materials::uniform(elastic))
            .with_support(Support::fixed(brick::Z_MAX))
            .with_contact(floor.with_friction(friction))
            .with_boxes([2, 1, 1])
    }

    /// Its model and first level.
    pub(crate) fn first_level(scene: Scene) -> (Model, StepProblem) {
        let model = Model::new(scene, &Settings::default()).expect("model");
        let mut level = StepProblem::default();
        level.prepare(&model, &State::default(), 0).expect("level");
        (model, level)
    }
}
