//! The certificate of a step: how far the recovered displacement and the multipliers are from all conditions,
//! in physical units. It uses no residual of any solver.
//!
//! docs/theory.md, section 10, defines the conditions, their violations and scales. Each body is measured by its own
//! loads, forces and displacements; the worst value is reported.

/// A violation and the quantity it is relative to, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Violation {
    /// How large the violation is.
    pub value: f64,
    /// The scale to compare it with.
    pub reference: f64,
}

impl Violation {
    /// `value / reference`; 0 if nothing is violated.
    pub fn relative(&self) -> f64 {
        if self.value == 0.0 { 0.0 } else { self.value / self.reference }
    }

    /// Takes another violation of the same condition in its place if that is relatively larger, or not a number.
    pub(super) fn worsen(&mut self, value: f64, reference: f64) {
        let other = Self { value, reference };
        if is_worse(other.relative(), self.relative()) {
            *self = other;
        }
    }
}

/// Violations of all conditions at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// Equilibrium of every subdomain, N.
    pub equilibrium: Violation,
    /// Gluing, supports and springs, m.
    pub continuity: Violation,
    /// Penetration, m.
    pub gap: Violation,
    /// Pulling normal forces, N.
    pub sign: Violation,
    /// Normal force across an open gap, N m.
    pub complementarity: Violation,
    /// Friction above the slip bound, N.
    pub cone: Violation,
    /// Friction not opposite to the slip, or slip below the bound, N m.
    pub direction: Violation,
}

impl Certificate {
    /// The largest relative violation; NaN if any is NaN.
    pub fn largest(&self) -> f64 {
        self.worst().1.relative()
    }

    /// The condition with the largest relative violation; NaN counts as largest.
    pub fn worst(&self) -> (&'static str, Violation) {
        worst(self.parts())
    }

    /// Name and violation of every condition.
    pub fn parts(&self) -> [(&'static str, Violation); 7] {
        [
            ("equilibrium", self.equilibrium),
            ("continuity", self.continuity),
            ("gap", self.gap),
            ("sign", self.sign),
            ("complementarity", self.complementarity),
            ("cone", self.cone),
            ("direction", self.direction),
        ]
    }
}

/// Whether a violation is larger than another one; what is not a number is worse than all that are.
fn is_worse(new: f64, old: f64) -> bool {
    new > old || new.is_nan() && !old.is_nan()
}

/// Largest relative violation of the contact conditions; not a number if one is none.
pub(crate) fn contact_violation(certificate: &Certificate) -> f64 {
    let [_equilibrium, _continuity, contact @ ..] = certificate.parts();
    worst(contact).1.relative()
}

/// The part with the largest relative violation; `f64::max` would hide what is not a number.
fn worst<const N: usize>(parts: [(&'static str, Violation); N]) -> (&'static str, Violation) {
    let worse =
        |old: (_, Violation), new: (_, Violation)| if is_worse(new.1.relative(), old.1.relative()) { new } else { old };
    parts.into_iter().reduce(worse).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_violation_of_contact_is_that_of_its_conditions() {
        let mut certificate = Certificate::default();
        certificate.cone.value = 1.0;
        certificate.cone.reference = 4.0;
        certificate.equilibrium.value = 1.0;
        assert_eq!(contact_violation(&certificate), 0.25);
        assert_eq!(certificate.worst(), ("equilibrium", certificate.equilibrium));
        certificate.gap.value = f64::NAN;
        assert!(contact_violation(&certificate).is_nan());
    }
}
