//! The two sides of a contact point, as short lists of nodes: all that is above asks here which nodes a point moves.

/// One side: mesh nodes and their weights, whose sum is one. Where meshes match it is one node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Side(Vec<(u32, f64)>);

impl Side {
    /// A side that is one node.
    pub(crate) fn node(node: u32) -> Self {
        Self(vec![(node, 1.0)])
    }

    /// Its nodes and their weights.
    pub(crate) fn nodes(&self) -> &[(u32, f64)] {
        &self.0
    }

    /// The node that names the side.
    pub(crate) fn first(&self) -> u32 {
        self.0[0].0
    }
}

/// Both sides of a contact point.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sides {
    /// That of the body whose outward normal counts.
    pub(crate) own: Side,
    /// That of the other body; `None` for a rigid obstacle.
    pub(crate) partner: Option<Side>,
}

impl Sides {
    /// The node that names the point.
    pub(crate) fn node(&self) -> u32 {
        self.own.first()
    }

    /// The node that names the other side.
    pub(crate) fn partner(&self) -> Option<u32> {
        self.partner.as_ref().map(Side::first)
    }

    /// The relative displacement of the sides as a sum: nodes with their weights, those of the partner negative.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = (u32, f64)> {
        let partner = self.partner.iter().flat_map(Side::nodes);
        let partner = partner.map(|&(node, weight)| (node, -weight));
        self.own.0.iter().copied().chain(partner)
    }
}
