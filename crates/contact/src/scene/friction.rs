//! Friction laws: none, given (Tresca), and Coulomb with a coefficient that may depend on place and slip rate.

use crate::error::ContactError;
use signorini_fem_mesh::internal::interpolate;
use signorini_fem_mesh::loads::Function;
use std::sync::Arc;

/// A value that depends on the place only.
pub(super) type PlaceField = Function<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

/// A value that depends on the place and the slip rate in m/s.
type RateField = Function<dyn Fn([f64; 3], f64) -> f64 + Send + Sync>;

/// The friction on a contact surface.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
#[must_use]
pub enum Friction {
    /// No friction: no tangential rows, no slip bounds, no history of the tangential displacement.
    #[default]
    None,
    /// Tresca (given) friction: the slip bound is prescribed and does not depend on the pressure. It acts even at open
    /// points.
    Tresca(SlipBound),
    /// Coulomb friction: the slip bound is the coefficient times the contact pressure.
    Coulomb(Coefficient),
}

impl Friction {
    /// Coulomb friction with one coefficient everywhere.
    pub fn coulomb(coefficient: f64) -> Self {
        Self::Coulomb(Coefficient::Constant(coefficient))
    }

    /// Tresca friction with the same bound of the friction stress everywhere, in Pa.
    pub fn tresca(stress: f64) -> Self {
        Self::Tresca(SlipBound::Stress(stress))
    }

    /// Whether there are tangential forces at all.
    pub fn is_some(&self) -> bool {
        !matches!(self, Self::None)
    }

    /// Whether the bound or coefficient is a constant zero.
    pub(super) fn is_zero(&self) -> bool {
        match self {
            Self::None => true,
            Self::Tresca(SlipBound::Stress(value)) | Self::Coulomb(Coefficient::Constant(value)) => *value == 0.0,
            _ => false,
        }
    }

    /// A constant slip bound that cannot be meant.
    pub(crate) fn bad_bound(&self) -> Option<f64> {
        match self {
            Self::Tresca(SlipBound::Stress(value)) => Some(*value).filter(|value| !is_good(*value)),
            _ => None,
        }
    }

    /// Whether the coefficient depends on the slip rate.
    pub(crate) fn depends_on_rate(&self) -> bool {
        matches!(self, Self::Coulomb(c) if c.depends_on_rate())
    }
}

/// Bound of the friction stress in Tresca friction.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub enum SlipBound {
    /// The same bound everywhere, in Pa; the bound of a node is this times its area.
    Stress(f64),
    /// Bound in Pa at a point.
    StressField(PlaceField),
}

impl SlipBound {
    /// A function of the place.
    pub fn field(f: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Self {
        Self::StressField(Function(Arc::new(f)))
    }

    /// The bound in Pa at a point, checked.
    pub(crate) fn stress(&self, (contact, node, position): At) -> Result<f64, ContactError> {
        let value = match self {
            Self::Stress(value) => *value,
            Self::StressField(field) => field(position),
        };
        is_good(value).then_some(value).ok_or(ContactError::SlipBound {
            contact,
            node,
            position,
            value,
        })
    }
}

/// The coefficient of Coulomb friction, script F of the paper.
///
/// A coefficient that depends on the slip rate is evaluated with the rate of the step before, and with
/// rate 0 in the first step, as in the paper (after (2.11)).
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub enum Coefficient {
    /// The same everywhere.
    Constant(f64),
    /// Depends on the place.
    Field(PlaceField),
    /// `kinetic + (fixed - kinetic) exp(-rate / decay)`.
    Exponential {
        /// Coefficient at rest.
        fixed: f64,
        /// Coefficient at high slip rate.
        kinetic: f64,
        /// Slip rate, in m/s, over which the difference falls by e.
        decay: f64,
    },
    /// Linear interpolation between (rate in m/s, coefficient) points, constant outside.
    Table(Vec<(f64, f64)>),
    /// Depends on place and rate.
    RateField(RateField),
}

impl Coefficient {
    /// A function of the place.
    pub fn field(f: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Self {
        Self::Field(Function(Arc::new(f)))
    }

    /// A function of place and slip rate.
    pub fn rate_field(f: impl Fn([f64; 3], f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::RateField(Function(Arc::new(f)))
    }

    /// Whether the slip rate matters; if not, none is computed.
    pub(crate) fn depends_on_rate(&self) -> bool {
        matches!(self, Self::Exponential { .. } | Self::Table(_) | Self::RateField(_))
    }

    /// The largest value at any slip rate; `None` if that is not known.
    pub(crate) fn largest(&self, point: [f64; 3]) -> Option<f64> {
        match self {
            Self::Constant(value) => Some(*value),
            Self::Field(field) => Some(field(point)),
            Self::Exponential { fixed, kinetic, .. } => Some(fixed.max(*kinetic)),
            Self::Table(points) => Some(points.iter().fold(0.0_f64, |m, p| m.max(p.1))),
            Self::RateField(_) => None,
        }
        .filter(|v| is_good(*v))
    }

    /// Checks what can be checked without a place; `contact` is whose law it is.
    pub(crate) fn validate(&self, contact: usize) -> Result<(), ContactError> {
        let check = |good: bool, what, value| {
            let error = ContactError::Coefficient { contact, what, value };
            good.then_some(()).ok_or(error)
        };
        match self {
            Self::Field(_) | Self::RateField(_) => Ok(()),
            Self::Constant(value) => check(is_good(*value), "coefficient", *value),
            Self::Exponential { fixed, kinetic, decay } => {
                check(is_good(*fixed), "coefficient at rest", *fixed)?;
                check(is_good(*kinetic), "kinetic coefficient", *kinetic)?;
                check(is_good(*decay) && *decay > 0.0, "decay rate", *decay)
            }
            Self::Table(points) => {
                if points.is_empty() {
                    return Err(ContactError::EmptyTable { contact });
                }
                let mut before = f64::NEG_INFINITY;
                for (entry, &(rate, value)) in points.iter().enumerate() {
                    if !(rate.is_finite() && rate > before) {
                        return Err(ContactError::TableRate { contact, entry, rate });
                    }
                    check(is_good(value), "coefficient in the table", value)?;
                    before = rate;
                }
                Ok(())
            }
        }
    }

    /// The coefficient at a point, checked. `rate` in m/s.
    pub(crate) fn value(&self, (contact, node, position): At, rate: f64) -> Result<f64, ContactError> {
        let value = match self {
            Self::Constant(value) => *value,
            Self::Field(field) => field(position),
            Self::Exponential { fixed, kinetic, decay } => kinetic + (fixed - kinetic) * (-rate / decay).exp(),
            Self::Table(points) => interpolate(points, rate),
            Self::RateField(field) => field(position, rate),
        };
        is_good(value).then_some(value).ok_or(ContactError::CoefficientAt {
            contact,
            node,
            position,
            rate,
            value,
        })
    }
}

/// Where friction is: contact, node, and its place.
pub(crate) type At = (usize, u32, [f64; 3]);

/// Whether a bound or a coefficient can be meant.
fn is_good(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// Asks the laws of friction at points, at rest, so that what it cannot mean is said before any work.
pub(crate) fn check_laws<'a>(points: impl IntoIterator<Item = (&'a Friction, At)>) -> Result<(), ContactError> {
    for (friction, at) in points {
        match friction {
            Friction::None => continue,
            Friction::Tresca(bound) => bound.stress(at)?,
            Friction::Coulomb(law) => law.value(at, 0.0)?,
        };
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_law_of_the_benchmark() {
        let law = Coefficient::Exponential {
            fixed: 0.3,
            kinetic: 0.1,
            decay: 0.05,
        };
        law.validate(0).unwrap();
        assert!((law.value((0, 0, [0.0; 3]), 0.0).unwrap() - 0.3).abs() < 1e-15);
        assert!((law.value((0, 0, [0.0; 3]), 0.05).unwrap() - (0.1 + 0.2 * (-1.0_f64).exp())).abs() < 1e-15);
    }

    #[test]
    fn tables_interpolate_and_are_constant_outside() {
        let law = Coefficient::Table(vec![(0.0, 0.4), (1.0, 0.2)]);
        for (rate, expected) in [(-1.0, 0.4), (0.0, 0.4), (0.25, 0.35), (1.0, 0.2), (7.0, 0.2)] {
            assert!((law.value((0, 0, [0.0; 3]), rate).unwrap() - expected).abs() < 1e-15);
        }
    }

    /// A constant zero is no friction, and has no tangential rows; a field may be anything.
    #[test]
    fn zero_is_no_friction() {
        let zero = |_: [f64; 3]| 0.0;
        for (law, is_zero) in [
            (Friction::None, true),
            (Friction::coulomb(0.0), true),
            (Friction::tresca(0.0), true),
            (Friction::coulomb(1e-9), false),
            (Friction::tresca(1e-9), false),
            (Friction::Coulomb(Coefficient::field(zero)), false),
            (Friction::Tresca(SlipBound::field(zero)), false),
        ] {
            assert_eq!(law.is_zero(), is_zero, "{law:?}");
            let contact = crate::Contact::rigid(signorini_fem_mesh::FacetTag(1));
            let kept = contact.with_friction(law).friction().is_some();
            assert_eq!(kept, !is_zero);
        }
    }

    #[test]
    fn wrong_laws_are_refused() {
        for law in [
            Coefficient::Constant(-0.1),
            Coefficient::Constant(f64::NAN),
            Coefficient::Exponential {
                fixed: 0.3,
                kinetic: -0.1,
                decay: 0.05,
            },
            Coefficient::Exponential {
                fixed: 0.3,
                kinetic: 0.1,
                decay: 0.0,
            },
            Coefficient::Table(vec![]),
            Coefficient::Table(vec![(1.0, 0.1), (1.0, 0.2)]),
            Coefficient::Table(vec![(0.0, f64::INFINITY)]),
        ] {
            assert!(law.validate(0).is_err(), "{law:?}");
        }
        for (rates, at) in [
            ([f64::NAN, 1.0, 2.0], 0),
            ([0.0, f64::NAN, 2.0], 1),
            ([0.0, 1.0, f64::INFINITY], 2),
            ([0.0, 2.0, 1.0], 2),
        ] {
            let error = Coefficient::Table(rates.map(|r| (r, 0.3)).to_vec()).validate(0);
            assert!(
                matches!(error, Err(ContactError::TableRate { entry, .. }) if entry == at),
                "{error:?}"
            );
        }
        let field = Coefficient::field(|x| -x[0]);
        assert!(matches!(
            field.value((2, 7, [1.0; 3]), 0.0),
            Err(ContactError::CoefficientAt {
                contact: 2,
                node: 7,
                position: [1.0, 1.0, 1.0],
                ..
            })
        ));
    }
}
