//! What can be said against a scene without nodes and rows.

use super::contact::{Closing, Contact, ContactNormal};
use super::friction::Friction;
use super::gap::Gap;
use super::obstacle::Obstacle;
use super::pose::Rotation;
use super::scene::Scene;
use super::support::Place;
use crate::error::ContactError;
use crate::part::Part;
use crate::tolerances::MOST_STRETCH;
use signorini_fem_mesh::internal::tag_list;
use signorini_fem_mesh::vec3::{is_finite, norm};
use signorini_fem_mesh::{FacetTag, History};

impl Scene {
    /// Nodes of the support at a position, checked; as many displacements as nodes, if it has not one for all.
    pub(crate) fn support_nodes(&self, support: usize) -> Result<Vec<u32>, ContactError> {
        let count = self.mesh.points().len();
        let own = &self.supports[support];
        let nodes = own.place.nodes(&self.mesh);
        if let (Place::Tag(tag), []) = (&own.place, &nodes[..]) {
            return Err(self.unknown_tag(Part::Support(support), *tag));
        }
        if let Some(&node) = nodes.iter().find(|&&n| n as usize >= count) {
            return Err(ContactError::UnknownNode {
                support,
                node,
                nodes: count,
            });
        }
        let values = own.motion.as_ref().map_or(1, |(values, _)| values.len());
        if values != 1 && values != nodes.len() {
            return Err(ContactError::ValueCount {
                support,
                values,
                nodes: nodes.len(),
            });
        }
        Ok(nodes)
    }

    pub(crate) fn unknown_tag(&self, part: Part, tag: FacetTag) -> ContactError {
        ContactError::UnknownTag {
            part,
            tag: tag.0,
            known: tag_list(&self.mesh.tags()),
        }
    }

    /// Checks what needs neither nodes nor computation.
    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        self.analysis.validate()?;
        if !self.materials.listed().is_empty() {
            self.materials.of_tets(&self.mesh.distinct_regions())?;
        }
        let mut times = self.analysis.times().iter();
        times.try_for_each(|&time| self.check_histories(time))?;
        for (index, contact) in self.contacts.iter().enumerate() {
            // what it is at rest, too
            let value = contact.gap_history.as_ref().map_or(0.0, |h| h.value(0.0));
            check_value(Part::Contact(index), 0.0, value)?;
        }
        if let Some((part, span)) = self.spans().find(|(_, span)| !span.is_good()) {
            let (start, end) = (span.start.unwrap_or(0.0), span.end.unwrap_or(f64::INFINITY));
            return Err(ContactError::Span { part, start, end });
        }
        let mut supports = self.supports.iter();
        if let Some(index) = supports.position(|s| s.fading.is_some() && s.span.start.is_none()) {
            return Err(ContactError::Idle {
                part: Part::Support(index),
                setting: "with_fading",
                needs: "with_start",
            });
        }
        for (index, spring) in self.springs.iter().enumerate() {
            spring.validate(index, self.mesh.points().len())?;
            if let Place::Tag(tag) = spring.place
                && self.mesh.nodes_on(tag).is_empty()
            {
                return Err(self.unknown_tag(Part::Spring(index), tag));
            }
        }
        let mut contacts = self.contacts.iter().enumerate();
        contacts.try_for_each(|(index, c)| self.check(index, c))?;
        match self.same_pair() {
            Some((first, second, tags)) => Err(ContactError::SamePair { first, second, tags }),
            None => Ok(()),
        }
    }

    /// Two contacts of one step that are between the same sides, and the tags of these.
    fn same_pair(&self) -> Option<(usize, usize, [u32; 2])> {
        let all = || self.contacts.iter().enumerate();
        let common = |a: &[FacetTag], b: &[FacetTag]| a.iter().find(|tag| b.contains(tag)).map(|tag| tag.0);
        let ends = self.analysis.times();
        all().find_map(|(second, b)| {
            all().take(second).find_map(|(first, a)| {
                let both = |[x, y]: [&[FacetTag]; 2]| Some([common(&a.tags, x)?, common(&a.partner, y)?]);
                let tags = both([&b.tags, &b.partner]).or_else(|| both([&b.partner, &b.tags]))?;
                a.span.meets(&b.span, ends).then_some((first, second, tags))
            })
        })
    }

    /// Checks that all histories have a value at a time.
    pub(crate) fn check_histories(&self, time: f64) -> Result<(), ContactError> {
        self.histories()
            .try_for_each(|(part, history)| check_value(part, time, history.value(time)))
    }

    /// All that acts, with its history.
    pub(crate) fn histories(&self) -> impl Iterator<Item = (Part, &History)> {
        let loads = self.loads.iter().enumerate();
        let supports = self.supports.iter().enumerate();
        let contacts = self.contacts.iter().enumerate();
        let couplings = self.couplings.iter().enumerate();
        let couplings = couplings.flat_map(|(k, c)| c.motions.iter().map(move |(_, h)| (Part::Coupling(k), h)));
        let equations = self.equations.iter().enumerate();
        (loads.map(|(k, l)| (Part::Load(k), &l.history)))
            .chain(supports.flat_map(|(k, s)| {
                let motion = s.motion.as_ref().map(|(_, history)| history);
                motion.into_iter().chain(&s.fading).map(move |h| (Part::Support(k), h))
            }))
            .chain(contacts.flat_map(|(k, c)| {
                let motions = c.motions.iter().map(|(_, history)| history);
                let turn = c.rotation.as_ref().map(|rotation| &rotation.angle);
                (motions.chain(turn).chain(&c.gap_history)).map(move |h| (Part::Contact(k), h))
            }))
            .chain(couplings)
            .chain(equations.filter_map(|(k, e)| Some((Part::Equation(k), &e.value.as_ref()?.1))))
    }

    fn check(&self, index: usize, contact: &Contact) -> Result<(), ContactError> {
        for tag in contact.side_tags() {
            if self.mesh.nodes_on(tag).is_empty() {
                return Err(self.unknown_tag(Part::Contact(index), tag));
            }
        }
        if let ContactNormal::Fixed(normal) = contact.normal {
            let length: f64 = normal.iter().map(|c| c * c).sum();
            if !(length.is_finite() && length > 0.0) {
                return Err(ContactError::ObstacleNormal { contact: index, normal });
            }
        }
        let gap = !matches!(contact.gap, Gap::None | Gap::Constant(0.0)) || contact.gap_history.is_some();
        let loose = contact.friction.is_some() || gap || contact.compliance != [0.0; 2];
        let turned = contact.normal != ContactNormal::Body || contact.rotation.is_some();
        if contact.tied && (loose || turned) {
            return Err(ContactError::Tied { contact: index });
        }
        let shaped = contact.shape.is_some() || contact.plane.is_some();
        if (contact.moves() && !contact.tied || shaped) && !contact.partner.is_empty() {
            return Err(ContactError::MovedPartner { contact: index });
        }
        let check = |good: bool, name, value, range| {
            let error = ContactError::ContactValue {
                contact: index,
                name,
                value,
                range,
            };
            good.then_some(()).ok_or(error)
        };
        for (displacement, _) in &contact.motions {
            let name = "displacement of the obstacle";
            let mut values = displacement.iter();
            values.try_for_each(|c| check(c.is_finite(), name, *c, "of finite numbers"))?;
        }
        if let Some(Rotation { point, axis, .. }) = &contact.rotation {
            let name = "length of the axis of rotation of an obstacle";
            let length = norm(*axis);
            let good = length.is_finite() && length > 0.0 && is_finite(*point);
            check(good, name, length, "(0, inf), through a finite point")?;
        }
        if let Some((name, value)) = contact.shape.as_ref().and_then(Obstacle::flaw) {
            check(false, name, value, "(0, inf)")?;
        }
        if let Some(&value) = contact.compliance.iter().find(|c| !(c.is_finite() && **c >= 0.0)) {
            return Err(ContactError::Compliance { contact: index, value });
        }
        let measured = matches!(contact.gap, Gap::Measured) && !contact.tied;
        if contact.closing == Closing::Nothing && !measured && !matches!(contact.gap, Gap::Obstacle) {
            return Err(ContactError::Idle {
                part: Part::Contact(index),
                setting: "with_measured_overlaps",
                needs: "a gap that is measured between bodies or from a shape",
            });
        }
        let none = matches!(contact.gap, Gap::None | Gap::Constant(0.0));
        if contact.gap_history.is_some() && none && !contact.tied {
            return Err(ContactError::Idle {
                part: Part::Contact(index),
                setting: "with_gap_history",
                needs: "a gap that is not zero, as of with_gap",
            });
        }
        if let Closing::UpTo(reach) = contact.closing {
            let good = measured && reach.is_finite() && reach >= 0.0;
            check(
                good,
                "reach of closed gaps",
                reach,
                "[0, inf), of gaps measured between bodies",
            )?;
        }
        let crease = contact.crease;
        check(crease > 0.0 && crease <= 180.0, "crease", crease, "(0, 180]")?;
        if contact.given == [true; 2] {
            return Err(ContactError::TwoGaps { contact: index });
        }
        if contact.friction_axis.is_some() && !contact.law_given {
            return Err(ContactError::Idle {
                part: Part::Contact(index),
                setting: "with_friction_axis",
                needs: "with_friction",
            });
        }
        if let Some((_, ratio)) = contact.friction_axis {
            let name = "ratio of friction across its axis";
            let good = (1.0 / MOST_STRETCH..=MOST_STRETCH).contains(&ratio);
            check(good, name, ratio, "[0.001, 1000]: an ellipse has two axes")?;
        }
        if let Friction::Coulomb(coefficient) = &contact.friction {
            coefficient.validate(index)?;
        }
        Ok(())
    }
}

/// Refuses a value of a history that is none.
fn check_value(part: Part, time: f64, value: f64) -> Result<(), ContactError> {
    let error = ContactError::HistoryValue { part, time, value };
    value.is_finite().then_some(()).ok_or(error)
}
