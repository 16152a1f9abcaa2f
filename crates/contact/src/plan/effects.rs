//! Which effects a scene has.

use crate::discrete::DiscreteScene;
use crate::scene::{Analysis, Friction, Gap, Scene};

/// What kind of friction a scene has; of several the one with the most effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FrictionKind {
    /// No tangential rows.
    None,
    /// One quadratic program a step.
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
    /// Bonded sides.
    pub ties: bool,
    /// Bonded sides that move against each other.
    pub moving_ties: bool,
    /// Friction.
    pub friction: FrictionKind,
    /// History: old tangential displacements.
    pub history: bool,
    /// Gluing of several subdomains.
    pub gluing: bool,
    /// Supports.
    pub supports: bool,
    /// Elastic foundations.
    pub springs: bool,
    /// Rigid couplings.
    pub couplings: bool,
    /// Linear equations.
    pub equations: bool,
    /// Supports, couplings or equations that move.
    pub motion: bool,
    /// Obstacles that move.
    pub moving_obstacle: bool,
    /// Gaps that change in time.
    pub gap_history: bool,
    /// Contact that gives way along the normal or along the surface.
    pub compliance: bool,
}

impl FrictionKind {
    fn of(friction: &Friction) -> Self {
        match friction {
            Friction::None => Self::None,
            Friction::Tresca(_) => Self::Tresca,
            Friction::Coulomb(law) if law.depends_on_rate() => Self::RateDependent,
            Friction::Coulomb(_) => Self::Coulomb,
        }
    }
}

impl Effects {
    pub(super) fn of(scene: &Scene, discrete: &DiscreteScene) -> Self {
        let (contacts, points) = (&scene.contacts, &discrete.points);
        let kinds = contacts.iter().map(|c| FrictionKind::of(c.friction()));
        let friction = kinds.max_by_key(|k| *k as u8).unwrap_or(FrictionKind::None);
        let measured = |surface: usize| points.iter().any(|p| p.surface == surface && p.gap != 0.0);
        let has_gap = |surface: usize| match contacts[surface].gap {
            // turned where it has moved to, an obstacle opens more than its way
            Gap::None | Gap::Constant(0.0) => {
                !contacts[surface].motions.is_empty() && contacts[surface].rotation.is_some()
            }
            Gap::Measured => measured(surface),
            _ => true,
        };
        let quasistatic = matches!(scene.analysis, Analysis::Quasistatic { .. });
        Self {
            contact: contacts.iter().any(|c| !c.tied),
            gap: (0..contacts.len()).any(has_gap),
            partners: points.iter().any(|p| p.sides.partner.is_some()),
            ties: contacts.iter().any(|c| c.tied),
            friction,
            history: friction != FrictionKind::None && quasistatic,
            gluing: discrete.decomposition.subdomains().len() > 1,
            supports: !scene.supports.is_empty(),
            springs: !scene.springs.is_empty(),
            couplings: !scene.couplings.is_empty(),
            equations: !scene.equations.is_empty(),
            motion: !discrete.supports.motions.is_empty(),
            moving_obstacle: contacts.iter().any(|c| !c.tied && c.moves()),
            moving_ties: contacts.iter().any(|c| c.tied && c.moves()),
            compliance: contacts.iter().any(|c| c.compliance != [0.0; 2]),
            gap_history: (0..contacts.len()).any(|k| has_gap(k) && contacts[k].gap_history.is_some()),
        }
    }
}
