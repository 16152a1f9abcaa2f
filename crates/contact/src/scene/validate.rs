//! What can be said against a scene without any computation.

use super::contact::{Contact, ContactNormal};
use super::friction::Friction;
use super::scene::Scene;
use super::support::Place;
use crate::error::ContactError;
use signorini_fem_mesh::FacetTag;

impl Scene {
    /// Nodes of the support at a position, checked.
    pub(crate) fn support_nodes(&self, support: usize) -> Result<Vec<u32>, ContactError> {
        match &self.supports[support].place {
            Place::Tag(tag) => {
                let nodes = self.mesh.nodes_on(*tag);
                if nodes.is_empty() {
                    return Err(self.unknown_tag("support", support, *tag));
                }
                Ok(nodes)
            }
            Place::Nodes(nodes) => {
                let count = self.mesh.points().len();
                match nodes.iter().find(|&&n| n as usize >= count) {
                    Some(&node) => Err(ContactError::UnknownNode {
                        support,
                        node,
                        nodes: count,
                    }),
                    None => Ok(nodes.clone()),
                }
            }
        }
    }

    fn unknown_tag(&self, what: &'static str, index: usize, tag: FacetTag) -> ContactError {
        let known: Vec<String> = self.mesh.tags().iter().map(|t| t.0.to_string()).collect();
        ContactError::UnknownTag {
            what,
            index,
            tag: tag.0,
            known: match &known[..] {
                [] => "no tags".into(),
                known => format!("the tags {}", known.join(", ")),
            },
        }
    }

    /// Checks what needs no computation.
    pub(crate) fn validate(&self) -> Result<(), ContactError> {
        self.analysis.validate()?;
        for (index, support) in self.supports.iter().enumerate() {
            let nodes = self.support_nodes(index)?;
            if let Some((values, _)) = &support.motion
                && values.len() != 1
                && values.len() != nodes.len()
            {
                let (values, nodes) = (values.len(), nodes.len());
                return Err(ContactError::ValueCount {
                    support: index,
                    values,
                    nodes,
                });
            }
        }
        for level in 0..self.analysis.steps() {
            let time = self.analysis.time(level).unwrap_or(0.0);
            let histories = (self
                .loads
                .iter()
                .enumerate()
                .map(|(i, l)| ("load", i, &l.history)))
            .chain(
                self.supports
                    .iter()
                    .enumerate()
                    .filter_map(|(i, s)| s.motion.as_ref().map(|m| ("support", i, &m.1))),
            )
            .chain(
                self.contacts
                    .iter()
                    .enumerate()
                    .filter_map(|(i, c)| c.motion.as_ref().map(|m| ("contact", i, &m.1))),
            );
            for (what, index, history) in histories {
                let value = history.value(time);
                if !value.is_finite() {
                    return Err(ContactError::HistoryValue {
                        what,
                        index,
                        time,
                        value,
                    });
                }
            }
        }
        let mut contacts = self.contacts.iter().enumerate();
        contacts.try_for_each(|(index, c)| self.check(index, c))
    }

    fn check(&self, index: usize, contact: &Contact) -> Result<(), ContactError> {
        for &tag in contact.tags.iter().chain(&contact.partner) {
            if self.mesh.nodes_on(tag).is_empty() {
                return Err(self.unknown_tag("contact", index, tag));
            }
        }
        if let ContactNormal::Fixed(normal) = contact.normal {
            let length: f64 = normal.iter().map(|c| c * c).sum();
            if !(length.is_finite() && length > 0.0) {
                return Err(ContactError::ObstacleNormal {
                    contact: index,
                    normal,
                });
            }
        }
        if contact.motion.is_some() && !contact.partner.is_empty() {
            return Err(ContactError::MovedPartner { contact: index });
        }
        if let Some((displacement, _)) = contact.motion
            && let Some(value) = displacement.iter().find(|c| !c.is_finite())
        {
            return Err(ContactError::Setting {
                name: "displacement of the obstacle",
                value: *value,
                range: "of finite numbers",
            });
        }
        if !(contact.crease > 0.0 && contact.crease <= 180.0) {
            return Err(ContactError::Setting {
                name: "crease",
                value: contact.crease,
                range: "(0, 180]",
            });
        }
        if let Friction::Coulomb(coefficient) = &contact.friction {
            coefficient.validate(index)?;
        }
        Ok(())
    }
}
