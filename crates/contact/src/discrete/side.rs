//! The two sides of a contact point: all that is above asks here which nodes a point moves.

use signorini_tfeti::Side;

/// Both sides of a contact point: short lists of nodes with weights, where meshes match of one node each.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sides {
    /// That of the body whose outward normal counts.
    pub(crate) own: Side,
    /// That of the other body; `None` for a rigid obstacle.
    pub(crate) partner: Option<Side>,
    /// Whether the scene names the other body first.
    pub(crate) swapped: bool,
}

impl Sides {
    /// The node that names the point: the first.
    pub(crate) fn node(&self) -> u32 {
        self.own.nodes()[0].0
    }

    /// The node that names the other side.
    pub(crate) fn partner(&self) -> Option<u32> {
        self.partner.as_ref().map(|side| side.nodes()[0].0)
    }

    /// Nodes of the body that the scene names first, with weights, negative where forces on it are opposite to those of
    /// the point.
    pub(crate) fn first(&self) -> impl Iterator<Item = (u32, f64)> {
        let partner = self.partner.as_ref().filter(|_| self.swapped);
        let (side, sign) = (partner.unwrap_or(&self.own), self.sign());
        side.nodes().iter().map(move |&(node, weight)| (node, sign * weight))
    }

    /// Sign of forces on the body that the scene names first.
    pub(crate) fn sign(&self) -> f64 {
        if self.swapped { -1.0 } else { 1.0 }
    }

    /// The displacement of one side relative to the other as a sum: nodes with weights, those of the partner negative.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, f64)> {
        let partner = self.partner.iter().flat_map(Side::nodes);
        let partner = partner.map(|&(node, weight)| (node, -weight));
        self.own.nodes().iter().copied().chain(partner)
    }
}
