//! Which effects a scene has.

/// What kind of friction a scene has; of several the one with the most effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FrictionKind {
    /// No tangential rows.
    None,
    /// One quadratic program a level.
    Tresca,
    /// Slip bounds follow the contact forces.
    Coulomb,
    /// The coefficient follows the slip rate, too.
    RateDependent,
}

/// Which effects a scene has; what is `false` here is neither allocated nor computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Effects {
    /// Inequalities: a contact surface.
    pub contact: bool,
    /// A gap: offsets of the normal rows.
    pub gap: bool,
    /// Contact between elastic bodies.
    pub partners: bool,
    /// Friction.
    pub friction: FrictionKind,
    /// History: old tangential displacements.
    pub history: bool,
    /// Gluing of several subdomains.
    pub gluing: bool,
    /// Supports.
    pub supports: bool,
    /// Supports that move.
    pub motion: bool,
    /// Obstacles that move.
    pub moving_obstacle: bool,
}
