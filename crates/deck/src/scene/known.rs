//! What the translation of all conditions looks up.

use super::couplings::Couplings;
use super::mesh::Raw;
use super::numbers::Sets;
use super::points::Points;
use super::pretension::Sections;
use super::rigid::RigidBodies;
use super::timeline::Timeline;
use super::transforms::Transforms;
use crate::model::Model;

/// What is known of the model where conditions are translated.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub(super) model: &'a Model,
    pub(super) sets: &'a Sets<'a>,
    pub(super) bodies: &'a RigidBodies,
    pub(super) raw: &'a Raw,
    pub(super) timeline: &'a Timeline<'a>,
    pub(super) couplings: &'a Couplings,
    pub(super) points: &'a Points,
    pub(super) transforms: &'a Transforms,
    pub(super) sections: &'a Sections,
}
