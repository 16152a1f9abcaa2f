//! How a step ended.

use std::fmt;

/// How the solve of a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum StepStatus {
    /// The certificate is at most the tolerance (usually a tenth), however the solver ended; or the solver reached the
    /// tolerance, and smaller ones did not bring the certificate below it, but to at most thirty times it (above a
    /// tolerance of 3e-4 to 0.01, or the tolerance where that is more), or 1e-10.
    Converged,
    /// A limit of iterations or products was reached first; the result is the last iterate.
    #[default]
    IterationLimit,
    /// No further progress, above the tolerance.
    Stagnated,
    /// The Coulomb map is not contractive here: successive approximations do not converge from this start. The result
    /// is the last iterate, which solves the Tresca problem of the last slip bounds.
    NotContractive,
    /// Under the normal forces of this step friction does not hold a body: with consistent slip bounds and normal
    /// forces there is no balance with the loads. The set-up checks only whether some normal forces could hold it.
    NotHeld,
    /// The solver met its tolerance, and smaller ones, but the certificate is more than that (with an
    /// [`Accuracy`](crate::Accuracy) by estimates, above
    /// [`certificate_limit`](crate::report::AccuracyReport::certificate_limit)): mostly the problem is too badly
    /// conditioned for it. The parts of the certificate name the violated condition.
    NotCertified,
}

impl StepStatus {
    /// Whether the tolerance was reached.
    #[must_use]
    pub fn converged(self) -> bool {
        self == Self::Converged
    }

    /// Whether the iterate is useless as a start.
    pub(crate) fn is_lost(self) -> bool {
        matches!(self, Self::Stagnated | Self::NotHeld)
    }

    /// What to do about it; empty for a step that converged.
    pub fn remedy(self) -> &'static str {
        match self {
            Self::Converged => "",
            Self::IterationLimit => "raise max_fallback_products or the limits of the method, or take smaller steps",
            Self::Stagnated => {
                "take smaller steps, or Settings::with_step_halving; with Accuracy::Relative a looser target"
            }
            Self::NotContractive => {
                "the Coulomb problem may have no solution here: take a smaller coefficient or smaller steps"
            }
            Self::NotHeld => {
                "press the body more, give it more friction, hold it by a support, or take smaller steps, as \
                Settings::with_step_halving does"
            }
            Self::NotCertified => {
                "take better shaped cells, Poisson's ratio further from 1/2, springs less soft beside the body, smaller \
                steps, or Method::paper()"
            }
        }
    }
}

impl fmt::Display for StepStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration limit",
            Self::Stagnated => "stagnated",
            Self::NotContractive => "not contractive",
            Self::NotHeld => "not held by friction",
            Self::NotCertified => "not certified",
        })
    }
}

/// A coupling that leaves free a motion which nothing else stops.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FreeCoupling {
    /// Its number in the scene.
    pub coupling: u32,
    /// Of a relative one the tied contact whose sides it lets move.
    pub tied: Option<u32>,
    /// Which of its motions are part of it: displacements along its axes, then rotations about them.
    pub free: [bool; 6],
    /// Its axes.
    pub axes: [[f64; 3]; 3],
}

impl fmt::Display for FreeCoupling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "coupling {}", self.coupling)?;
        if let Some(contact) = self.tied {
            write!(f, ", which lets the sides of contact {contact} move,")?;
        }
        let free = (0..6).filter(|&c| self.free[c]).map(|c| {
            let kind = if c < 3 { "displacement along" } else { "rotation about" };
            let [x, y, z] = self.axes[c % 3].map(|v| if v.abs() < IN_WORDS { 0.0 } else { v });
            format!("{kind} ({x:.3}, {y:.3}, {z:.3})")
        });
        let free: Vec<String> = free.collect();
        write!(f, " in its {} (Coupling::with_held)", free.join(" and "))
    }
}

/// How a body slides away that friction does not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Slide {
    /// Its number; bodies are numbered by their first subdomain.
    pub body: u32,
    /// A node of it.
    pub node: u32,
    /// Translation of its centre; with the rotation of length one.
    pub translation: [f64; 3],
    /// Rotation about its centre, times the root mean square distance of its nodes from there.
    pub rotation: [f64; 3],
    /// By how much the loads exceed what contact holds along it, N.
    pub force: f64,
    /// Other bodies that go at least half as far with it, each with a node of it: the first three.
    pub others: [Option<(u32, u32)>; 3],
    /// The coupling that leaves it free, if one does.
    pub coupling: Option<FreeCoupling>,
}

impl Slide {
    /// Whether it turns, as far as words tell.
    pub(crate) fn turns(&self) -> bool {
        self.rotation.iter().any(|r| r.abs() >= IN_WORDS)
    }
}

/// Components of a motion of length one that words leave out: three digits are told.
const IN_WORDS: f64 = 5e-4;

impl fmt::Display for Slide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = |name: &str, v: &[f64; 3]| {
            let v = v.map(|v| if v.abs() < IN_WORDS { 0.0 } else { v });
            let moves = v.iter().any(|v| *v != 0.0);
            moves.then(|| format!("{name} ({:.3}, {:.3}, {:.3})", v[0], v[1], v[2]))
        };
        let turn = words("rotation", &self.rotation);
        let parts: Vec<String> = words("translation", &self.translation)
            .into_iter()
            .chain(turn)
            .collect();
        write!(f, "its {}", parts.join(" with "))?;
        let others: Vec<String> = self
            .others
            .iter()
            .flatten()
            .map(|(body, node)| format!("body {body} (with node {node})"))
            .collect();
        if others.is_empty() {
            Ok(())
        } else {
            write!(f, ", together with {}", others.join(" and "))
        }
    }
}

/// A step that did not converge.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StepFailure {
    /// The step, from 0.
    pub step: usize,
    /// Its time, s.
    pub time: f64,
    /// How it ended.
    pub status: StepStatus,
    /// The largest relative violation of its certificate.
    pub certificate: f64,
    /// The condition of the certificate that is violated so.
    pub condition: &'static str,
    /// Which body slides away, where that is how it ended, or may where no balance was found.
    pub slide: Option<Slide>,
    /// Length over thickness of the longest subdomain in contact, if it is so long that it keeps the solver from the
    /// end.
    pub slender: Option<f64>,
}

impl fmt::Display for StepFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            step,
            time,
            status,
            certificate,
            condition,
            slide,
            slender,
        } = self;
        write!(
            f,
            "step {step}, at {time} s, did not converge ({status}, certificate {certificate:.1e}, {condition}); "
        )?;
        if let Some(
            slide @ Slide {
                body,
                node,
                force,
                coupling,
                ..
            },
        ) = slide
        {
            let [away, remedy] = if *status == StepStatus::NotHeld {
                ["slides away", ""]
            } else {
                ["may slide away", "press it more, or hold it by a support; else "]
            };
            write!(
                f,
                "body {body} (with node {node}) {away} along {slide}, because {force:.3e} N are missing; "
            )?;
            if let Some(coupling) = coupling {
                write!(f, "hold {coupling}, or ")?;
            }
            f.write_str(remedy)?;
        }
        if let Some(slender) = slender {
            write!(
                f,
                "a subdomain in contact is {slender:.0} times as long as thick: cut finer (Scene::with_subdomains), or "
            )?;
        }
        f.write_str(status.remedy())
    }
}
