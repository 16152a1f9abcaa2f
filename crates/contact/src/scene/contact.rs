//! The contact surface of a scene: where it is, how far the obstacle or the other body, and with which friction.

use super::friction::Friction;
use super::gap::Gap;
use super::obstacle::Obstacle;
use super::pose::{Pose, Rotation};
use super::span::Span;
use crate::error::ContactError;
use crate::tolerances::FACING;
use crate::vec3::norm;
use signorini_fem_mesh::loads::Function;
use signorini_fem_mesh::{FacetTag, History};
use signorini_qp::vector;
use std::sync::Arc;

/// Direction in which the contact surface meets the obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ContactNormal {
    /// The body's outward normal at each node.
    Body,
    /// One unit vector into the obstacle, e.g. (0, 0, -1) for a floor: the usual choice for a plane obstacle
    /// under a curved body.
    Fixed([f64; 3]),
    /// The normal of the [`Obstacle`] at each node, pointing into it, against the gradient of its distance.
    Obstacle,
}

/// Which measured gaps count as none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Closing {
    /// Overlaps that straight facets of a hollow side make.
    Faceted,
    Nothing,
    /// Those up to a length, m.
    UpTo(f64),
}

/// A part of the boundary that may touch a rigid obstacle, or another body.
#[derive(Debug, Clone)]
#[must_use]
pub struct Contact {
    pub(crate) tags: Vec<FacetTag>,
    /// Facets of the other body; none for a rigid obstacle.
    pub(crate) partner: Vec<FacetTag>,
    pub(crate) gap: Gap,
    /// Whether a constant gap and a gap field were given.
    pub(super) given: [bool; 2],
    /// The half-space across whose plane its gap is measured.
    pub(super) plane: Option<Obstacle>,
    pub(crate) normal: ContactNormal,
    pub(crate) friction: Friction,
    /// Whether a law of friction was given, be it none.
    pub(super) law_given: bool,
    /// Axis along which the law of friction holds, and how many times as much there is at right angles to it.
    pub(crate) friction_axis: Option<([f64; 3], f64)>,
    /// Angle of a crease, degrees.
    pub(crate) crease: f64,
    /// Displacement of the obstacle, m, and its factor in time.
    pub(crate) motions: Vec<([f64; 3], History)>,
    pub(crate) closing: Closing,
    /// Factor of the gap in time.
    pub(crate) gap_history: Option<History>,
    pub(crate) rotation: Option<Rotation>,
    /// Its shape, from which gap and normal follow.
    pub(crate) shape: Option<Obstacle>,
    /// Whether both sides are bonded.
    pub(crate) tied: bool,
    /// Along the normal and along the surface, m/Pa.
    pub(crate) compliance: [f64; 2],
    pub(crate) span: Span,
}

/// Angle between the normals of two neighbouring facets from which on their edge is a crease, degrees.
pub(super) const CREASE: f64 = 60.0;

impl Contact {
    /// Contact of the facets with a tag with a rigid obstacle: touching, along the body's normals, no friction.
    pub fn rigid(tag: FacetTag) -> Self {
        Self {
            tags: vec![tag],
            partner: Vec::new(),
            gap: Gap::None,
            given: [false; 2],
            plane: None,
            normal: ContactNormal::Body,
            friction: Friction::None,
            law_given: false,
            friction_axis: None,
            crease: CREASE,
            motions: Vec::new(),
            closing: Closing::Faceted,
            gap_history: None,
            rotation: None,
            shape: None,
            tied: false,
            compliance: [0.0; 2],
            span: Span::default(),
        }
    }

    /// Contact with a rigid obstacle of any shape: at each node the normal is that of the obstacle, against the
    /// gradient of its distance, and the gap is the distance. On an edge or corner of a [surface](Obstacle::surface),
    /// of all directions between the normals of the adjacent facets, that nearest to the body's normal is taken. Nodes
    /// that do not face the obstacle (the cosine between the normals is below a tenth) have no point, so that a flat
    /// side can slide over an edge beside it.
    ///
    /// [`with_normal`](Self::with_normal) and [`with_body_normals`](Self::with_body_normals) choose another direction,
    /// along which the gap is then measured; [`with_gap`](Self::with_gap) prescribes the gap. Normals are those of the
    /// undeformed state: slips and motions must be small against the radius of curvature. Motions that turn the
    /// obstacle's normal at a node by more than 0.1 radians are refused ([`TurnedNormal`](ContactError::TurnedNormal));
    /// displacements that do so at a touching node cause a [warning](crate::Warning::TurnedNormal).
    pub fn obstacle(tag: FacetTag, obstacle: Obstacle) -> Self {
        Self {
            gap: Gap::Obstacle,
            normal: ContactNormal::Obstacle,
            shape: Some(obstacle),
            ..Self::rigid(tag)
        }
    }

    /// Contact of two elastic bodies: facets with `tag`, and facets of the other body with the tag `partner`.
    ///
    /// Where the meshes match, a node of the first side is a contact point, and its partner is the node of the other
    /// side on its normal, to within a fiftieth of the size of its facets, and a little more across a gap. Where they
    /// do not, the side with the larger facets has the points, whichever is named first (in meshes of order 2 the
    /// curved side of a Poisson's ratio above 0.45, if the other's is below; of flat sides in meshes of order 1 the
    /// softer one, if the other is ten times as stiff in shear and reaches beyond it), and the partner of each is a
    /// weighted mean of nodes (mortar method with dual multipliers): uniform pressure is transferred exactly, for any
    /// ratio of mesh sizes and for sides that overlap only in part. Nodes with nothing opposite have no point, nor
    /// where it is more than four times as far as the farthest that is found up to there, and than a few facets: give
    /// far steps a contact of their own. Put flat sides that meet at an edge into separate contacts. Those that go on
    /// smoothly in one another on both sides, without motions, act as one: each node is in the contact whose partner it
    /// sees most of.
    ///
    /// All quantities of a contact point are those of the body of its [node](crate::result::PointState::node): the
    /// outward normal, the force on it, its displacement *relative* to the partner; sums over a contact are those of
    /// the body with `tag`. The gap is measured between the sides, unless [`with_gap`](Self::with_gap) or
    /// [`with_gap_field`](Self::with_gap_field) prescribes it; sides may coincide, and
    /// [overlaps press](Self::with_measured_overlaps) unless facets alone make them. Sliding is small: a node keeps its
    /// partner, however far it slides.
    pub fn between(tag: FacetTag, partner: FacetTag) -> Self {
        Self {
            partner: vec![partner],
            gap: Gap::Measured,
            ..Self::rigid(tag)
        }
    }

    /// Bonds two bodies, or two parts of one with non-matching meshes: both sides have the same displacement where they
    /// face each other, exactly where their nodes are the same, else in the mean of facets. A distance between them, or
    /// between facets of curved sides, is bridged by linear extrapolation, so that rigid rotations stay free.
    /// [`with_motion`](Self::with_motion) prescribes a jump, [`Coupling::relative`](crate::Coupling::relative) any
    /// rigid motion between the sides: bolts, hinges. Sides that penetrate each other by more than a facet size are
    /// refused.
    pub fn tied(tag: FacetTag, partner: FacetTag) -> Self {
        Self {
            partner: vec![partner],
            tied: true,
            ..Self::rigid(tag)
        }
    }

    /// Adds facets of the other body. A rigid contact without a given gap becomes one [between](Self::between) bodies.
    pub fn with_partner(mut self, tag: FacetTag) -> Self {
        if self.partner.is_empty() && matches!(self.gap, Gap::None) && !self.tied {
            self.gap = Gap::Measured;
        }
        self.partner.push(tag);
        self
    }

    /// Contact with the half-space below a plane: gap and normal follow from the plane.
    ///
    /// `point` lies on the plane, `outward` points out of the obstacle (up for a floor). A later
    /// [`with_gap`](Self::with_gap) or [`with_gap_field`](Self::with_gap_field) takes the place of the distance to the
    /// plane; move `point` instead. With another direction of contact the distance is measured along it, as that of an
    /// [`obstacle`](Self::obstacle).
    pub fn half_space(tag: FacetTag, point: [f64; 3], outward: [f64; 3]) -> Self {
        let length = norm(&outward);
        // what has no direction stays as it is, and is refused with the scene
        let unit = outward.map(|c| if length > 0.0 { c / length } else { c });
        let gap = move |x: [f64; 3]| (0..3).map(|c| (x[c] - point[c]) * unit[c]).sum();
        Self {
            gap: Gap::Field(Function(Arc::new(gap))),
            normal: ContactNormal::Fixed(unit.map(|c| -c)),
            plane: Some(Obstacle::half_space(point, outward)),
            ..Self::rigid(tag)
        }
    }

    /// Adds facets to this contact. For another gap, normal or friction law add another contact to the scene
    /// ([`Scene::with_contact`](crate::Scene::with_contact)).
    pub fn with_tag(mut self, tag: FacetTag) -> Self {
        self.tags.push(tag);
        self
    }

    /// A constant gap in m; 0 for surfaces that touch, whatever their coordinates. It takes the place of the distance
    /// to an obstacle or another body; beside a [field](Self::with_gap_field) it is refused.
    pub fn with_gap(mut self, gap: f64) -> Self {
        self.gap = Gap::Constant(gap);
        self.leave_plane();
        self.given[0] = true;
        self
    }

    /// A gap in m that depends on position: the distance of a point from the obstacle along the contact normal. If the
    /// obstacle [moves](Self::with_motion) along the surface, it is also evaluated beside the surface. With quadratic
    /// elements it is a mean around a corner, and where it jumps there the value in the middle.
    pub fn with_gap_field(mut self, gap: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Self {
        self.gap = Gap::Field(Function(Arc::new(gap)));
        self.leave_plane();
        self.given[1] = true;
        self
    }

    /// Of the gaps measured between two bodies, with quadratic elements node by node, those of at most `reach` (m, not
    /// negative) are closed: there the sides touch without stress, as if nodes had been moved onto each other. Overlaps
    /// are, too. For facets that deviate from the curves that they stand for. Of this and
    /// [`with_measured_overlaps`](Self::with_measured_overlaps) the last one counts.
    pub fn with_closed_gaps(mut self, reach: f64) -> Self {
        self.closing = Closing::UpTo(reach);
        self
    }

    /// Measured overlaps press as they are; between linear meshes that do not match they are measured to the curves
    /// that facets stand for. Without it, those of bodies that touch but for straight facets of a hollow side, as of a
    /// bolt in its bore, or of quadratic ones around an obstacle, are closed, which
    /// [`ClosedOverlaps`](crate::Warning::ClosedOverlaps) tells.
    pub fn with_measured_overlaps(mut self) -> Self {
        self.closing = Closing::Nothing;
        self
    }

    /// The gap changes in time: `history(t)` multiplies the gap given by [`with_gap`](Self::with_gap), a field, a shape
    /// or the coordinates, but not the opening by motions of the obstacle. A press fit is a negative gap with a ramp;
    /// [measured overlaps](Self::with_measured_overlaps) are then meant.
    /// Before the first step the factor is that at time 0. For obstacles and between bodies. The work of the growing
    /// interference is part of [`obstacle_work`](crate::result::ContactSummary::obstacle_work).
    pub fn with_gap_history(mut self, history: History) -> Self {
        self.gap_history = Some(history);
        self
    }

    /// One contact normal for all nodes, pointing into the obstacle, and out of the body at one contact node at least.
    pub fn with_normal(self, into_obstacle: [f64; 3]) -> Self {
        self.along(ContactNormal::Fixed(into_obstacle))
    }

    /// The body's outward normals as contact normals, as in [`rigid`](Self::rigid).
    pub fn with_body_normals(self) -> Self {
        self.along(ContactNormal::Body)
    }

    fn along(mut self, normal: ContactNormal) -> Self {
        self.normal = normal;
        if let Some(plane) = &self.plane {
            (self.gap, self.shape) = (Gap::Obstacle, Some(plane.clone()));
        }
        self
    }

    /// Its gap is told.
    fn leave_plane(&mut self) {
        if self.plane.take().is_some() {
            self.shape = None;
        }
    }

    /// The angle between the normals of adjacent facets, in degrees, from which on their common edge is a crease (60 by
    /// default; in (0, 180], 180 for none). At a crease a node has one contact point for each side, so that an edge can
    /// touch both floor and wall; elsewhere, and between bodies, it has one point with the mean normal. Put flat sides
    /// that meet at a smaller angle, or between bodies, into separate contacts. No effect where one normal or an
    /// obstacle says the direction.
    pub fn with_crease(mut self, degrees: f64) -> Self {
        self.crease = degrees;
        self
    }

    /// The obstacle moves: its displacement at time `t` is `history(t) * displacement` (m), and zero
    /// before the first step. Along the normal it opens or closes the gap; along the surface it drags the body by
    /// friction.
    ///
    /// A [gap field](Self::with_gap_field) moves with it: where the obstacle has moved by `w`, the
    /// gap at `x` with the normal `n` is `field(x - w_T) + n . w` with `w_T = w - (n . w) n`. This is exact along flat
    /// sides, with [`with_normal`](Self::with_normal), and along sides that the motion maps onto themselves; elsewhere
    /// motions that are long against the radius of curvature are refused ([`MovedField`](ContactError::MovedField)).
    /// Friction laws that depend on position stay with the nodes of the body.
    ///
    /// Of [tied](Self::tied) sides the first one moves relative to the other. Several such motions add up.
    pub fn with_motion(mut self, displacement: [f64; 3], history: History) -> Self {
        self.motions.push((displacement, history));
        self
    }

    /// The obstacle turns about the axis through `point`: at time `t` by `angle(t)` radians, right-handed about `axis`,
    /// and by none before the first step. The axis moves with a [motion](Self::with_motion). The obstacle drags the
    /// body by friction, however far it turns; if its shape is not round about the axis, gaps change. It replaces a
    /// rotation that was told before.
    ///
    /// The gap of an [obstacle](Self::obstacle) is measured at its current position in each step. A
    /// [gap field](Self::with_gap_field) turns with the obstacle. Other obstacles are assumed to have the shape of the
    /// body's surface, and their normals must not turn by more than 0.1 radians.
    pub fn with_rotation(mut self, point: [f64; 3], axis: [f64; 3], angle: History) -> Self {
        self.rotation = Some(Rotation { point, axis, angle });
        self
    }

    /// Sets the friction law. A bound or coefficient that is a constant zero means no friction.
    pub fn with_friction(mut self, friction: Friction) -> Self {
        self.friction = if friction.is_zero() { Friction::None } else { friction };
        self.law_given = true;
        self
    }

    /// Orthotropic friction: the law holds along `axis`, projected to the surface; at right angles to it friction is
    /// `ratio` times as large. Friction forces are bounded by an ellipse, and points slide along its normal (associated
    /// rule), not against the force. [`PointState::slip_bound`](crate::PointState::slip_bound)
    /// is the bound along the axis. It needs a [law](Self::with_friction), be it zero.
    pub fn with_friction_axis(mut self, axis: [f64; 3], ratio: f64) -> Self {
        self.friction_axis = Some((axis, ratio));
        self
    }

    /// Compliance of rough surfaces: in contact the gap is `-compliance` (m/Pa) times the pressure, so it is negative
    /// in [`PointState`](crate::PointState). Zero, the default, is the exact law. The inverse is the contact stiffness
    /// of other codes (N/m³, the slope of a linear pressure-overclosure).
    ///
    /// Contacts that meet at a node with the same normal need the same compliances and gaps. A node that a support
    /// holds along the normal must still not be inside the obstacle, since no pressure is known there; one that
    /// [starts](crate::Support::with_start) holds nodes as deep as it finds them.
    pub fn with_normal_compliance(mut self, compliance: f64) -> Self {
        self.compliance[0] = compliance;
        self
    }

    /// Elastic slip: below the slip bound a point moves along the surface by `compliance` (m/Pa) times the friction
    /// stress, and recovers with it. The inverse is the stick slope of other codes (N/m³). Zero, the default, is
    /// Coulomb's law as it stands. Without friction it has no effect.
    ///
    /// Differences, slip rates and friction work in results contain only the irreversible slip beyond it.
    pub fn with_tangential_compliance(mut self, compliance: f64) -> Self {
        self.compliance[1] = compliance;
        self
    }

    /// It acts at steps that end later than a time, s; before, there is nothing that could be touched. Friction then
    /// acts against displacements from where the sides were at the last step without it. What has moved into each other
    /// is pressed apart at once, and [tied](Self::tied) sides are drawn together.
    pub fn with_start(mut self, time: f64) -> Self {
        self.span.start = Some(time);
        self
    }

    /// It acts at steps until a time, s; its forces are gone at once, as those of a
    /// [support](crate::Support::with_end). For one that comes back add another that [starts](Self::with_start) later.
    pub fn with_end(mut self, time: f64) -> Self {
        self.span.end = Some(time);
        self
    }

    /// The time from which it acts, s; `None` from the beginning.
    pub fn start(&self) -> Option<f64> {
        self.span.start
    }

    /// The time until which it acts, s; `None` for ever.
    pub fn end(&self) -> Option<f64> {
        self.span.end
    }

    /// Compliance along the normal and along the surface, m/Pa; zero for the exact law.
    pub fn compliance(&self) -> [f64; 2] {
        self.compliance
    }

    /// The friction law.
    pub fn friction(&self) -> &Friction {
        &self.friction
    }

    /// The tags of its facets.
    pub fn tags(&self) -> &[FacetTag] {
        &self.tags
    }

    /// The tags of both sides.
    pub(crate) fn side_tags(&self) -> impl Iterator<Item = FacetTag> {
        self.tags.iter().chain(&self.partner).copied()
    }

    /// The contact normal.
    pub(crate) fn normal(&self) -> ContactNormal {
        self.normal
    }

    /// The gap at a place, m, checked; `contact` is the position of the surface in the scene, `measured` the distance
    /// to the partner of the node. The normal is asked only where the gap is measured along it.
    pub(crate) fn gap_at(
        &self,
        contact: usize,
        node: u32,
        position: [f64; 3],
        normal: &[f64; 3],
        measured: f64,
    ) -> Result<f64, ContactError> {
        let value = match (&self.gap, &self.shape) {
            (Gap::Constant(value), _) => *value,
            (Gap::Field(field), _) => field(position),
            (Gap::Measured, _) if matches!(self.closing, Closing::UpTo(reach) if measured <= reach) => 0.0,
            (Gap::Measured, _) => measured,
            (Gap::Obstacle, Some(shape)) if self.normal == ContactNormal::Obstacle => {
                shape.see(position, *normal).level
            }
            (Gap::Obstacle, Some(shape)) => shape.along(position, *normal),
            (Gap::None | Gap::Obstacle, _) => 0.0,
        };
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ContactError::Gap {
                contact,
                node,
                position,
                value,
            })
        }
    }

    /// The distance to the obstacle, m, where a side of it that the normal leads towards has ended before a place.
    pub(crate) fn beyond(&self, place: [f64; 3], normal: &[f64; 3]) -> Option<f64> {
        let shape = self.shape.as_ref().filter(|_| matches!(self.gap, Gap::Obstacle))?;
        let seen = shape.see(place, *normal);
        let leads = || self.normal != ContactNormal::Obstacle && shape.reach(place, *normal).is_ok();
        (seen.ends && seen.level < seen.distance && !leads()).then_some(seen.distance)
    }

    /// Whether the obstacle moves and takes a gap with it that depends on the place.
    pub(crate) fn carries_field(&self) -> bool {
        self.moves() && matches!(self.gap, Gap::Field(_) | Gap::Obstacle)
    }

    /// Whether the gap changes otherwise than by what an obstacle opens.
    pub(crate) fn changes_gap(&self) -> bool {
        self.carries_field() || self.gap_history.is_some()
    }

    /// Whether a direction of the body leads to no shape of an obstacle, wherever that has moved: its distance is none
    /// along it.
    pub(crate) fn never_faces(&self, place: [f64; 3], normal: &[f64; 3], poses: &[Pose]) -> bool {
        let Some(shape) = self.shape.as_ref().filter(|_| self.normal == ContactNormal::Body) else {
            return false;
        };
        let faces = |pose: &Pose| {
            let (_, gradient) = shape.distance(pose.origin(&place));
            -vector::dot(&gradient, &pose.back(normal)) > FACING
        };
        !faces(&Pose::default()) && !poses.iter().any(faces)
    }

    /// The gap at a node, m, that is `initial` at first, where the obstacle has moved, times its factor. The part of
    /// its way along the normal, which opens the gap, is not in it.
    pub(crate) fn gap_brought(
        &self,
        contact: usize,
        node: u32,
        position: [f64; 3],
        normal: &[f64; 3],
        (initial, pose): (f64, &Pose),
    ) -> Result<f64, ContactError> {
        let at = |place: [f64; 3], normal: &[f64; 3]| self.gap_at(contact, node, place, normal, initial);
        let opened = |way: [f64; 3]| vector::dot(&way, normal) - vector::dot(&pose.drag(&position), normal);
        match &self.gap {
            Gap::Obstacle => {
                let whole = at(pose.origin(&position), &pose.back(normal))?;
                Ok(pose.brings(whole, &position, normal))
            }
            Gap::Field(_) => {
                let way = pose.way(&position);
                let out = vector::dot(&way, normal);
                let from = [0, 1, 2].map(|c| position[c] - (way[c] - out * normal[c]));
                let brought = pose.factor * at(from, normal)?;
                Ok(if pose.turns() { brought + opened(way) } else { brought })
            }
            _ if pose.turns() => Ok(pose.factor * initial + opened(pose.small(&position))),
            _ => Ok(pose.factor * initial),
        }
    }
}
