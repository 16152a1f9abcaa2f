//! The certificate of a level: how far the recovered displacement and the multipliers are from all conditions,
//! in physical units. It uses no residual of any solver.
//!
//! | condition | violation | unit | relative to |
//! |---|---|---|---|
//! | equilibrium (5.26) | norm of `K u - f - Bᵀ lambda` | N | norm of the loads and of all multipliers |
//! | continuity and supports (4.23) | largest difference between glued copies, or from a support | m | largest displacement |
//! | gap (2.5) | largest penetration | m | largest displacement |
//! | sign (2.5) | largest pulling normal force | N | largest contact force |
//! | complementarity (2.5) | largest normal force times open gap | N m | largest contact force times largest displacement |
//! | cone (2.11) | largest excess of friction over the slip bound | N | largest contact force |
//! | direction (2.11) | largest norm of `r dU + abs(dU) lambda_T` | N m | largest contact force times largest displacement |
//!
//! The largest displacement is that of the body or, if it is larger, what the load of a node would do to it with all others
//! held, so that a body that does not move has a scale too.
//!
//! `r` is the slip bound of the level's own normal forces and `dU` the tangential difference `u_T - z`. The
//! direction condition covers sticking as well: where `abs(lambda_T) < r`, it vanishes only with `dU`.

use crate::level::Level;
use crate::model::{Model, Tangential};
use crate::state::REST;
use signorini_qp::vector;

/// A violation and the quantity it is relative to, in the same unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Violation {
    /// How large the violation is.
    pub value: f64,
    /// What it is to be compared with.
    pub reference: f64,
}

impl Violation {
    /// `value / reference`; 0 if nothing is violated.
    #[must_use]
    pub fn relative(&self) -> f64 {
        if self.value == 0.0 {
            0.0
        } else {
            self.value / self.reference
        }
    }
}

/// Violations of all conditions at the end of a level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Certificate {
    /// Equilibrium of every subdomain, N.
    pub equilibrium: Violation,
    /// Gluing and supports, m.
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
    /// The largest relative violation; not a number if one is none.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.parts()
            .iter()
            .map(|(_, v)| v.relative())
            .fold(0.0, worse)
    }

    /// Name and violation of every condition.
    #[must_use]
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

/// The larger one; `f64::max` would hide what is not a number.
fn worse(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// Displacements of rows, in metres, from the recovered torn displacement.
pub(crate) struct Measured<'a> {
    /// `B u` in row units.
    pub(crate) rows: &'a [f64],
    /// Torn displacement.
    pub(crate) u: &'a [f64],
    /// Torn load, N.
    pub(crate) force: &'a [f64],
    /// `K u - f - Bᵀ lambda`, N.
    pub(crate) residual: &'a [f64],
}

/// Part of all forces that a vanishing contact force is measured against.
const SMALL_PART: f64 = 1e-4;

pub(crate) fn certify(
    model: &Model,
    level: &Level,
    lambda: &[f64],
    m: &Measured<'_>,
) -> Certificate {
    let ranges = model.tfeti.gluing().ranges();
    // where nothing moves, what its load would do to a single node is the scale
    let copies = model.copies();
    let alone = m.force.chunks_exact(3).enumerate().map(|(k, f)| {
        let largest = f.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        largest / copies.weight(k)
    });
    let displacement = vector::max_abs(m.u)
        .max(alone.fold(0.0, f64::max))
        .max(REST * level.peak.displacement);
    let mut contact_force = 0.0_f64;
    let mut total = vector::dot(m.force, m.force);
    for point in &model.points {
        let mut sum = (point.scale * lambda[point.row]).powi(2);
        if let Some((row, count, scale)) = point.tangential.rows() {
            sum += lambda[row..row + count]
                .iter()
                .map(|v| (scale * v).powi(2))
                .sum::<f64>();
        }
        contact_force = contact_force.max(sum.sqrt());
        total += sum;
    }
    // likewise where no force acts, or next to none on the contact surface
    let all = total.sqrt().max(REST * level.peak.multipliers);
    contact_force = contact_force
        .max(REST * level.peak.force)
        .max(SMALL_PART * all);
    // gluing forces and reactions: what displacements alone cause has no loads
    let inner = vector::norm(&lambda[ranges.contact().end..]);
    let mut c = Certificate {
        equilibrium: Violation {
            value: vector::norm(m.residual),
            reference: all.hypot(inner),
        },
        ..Certificate::default()
    };
    let jumps = ranges.interface.start..ranges.total();
    let jump = m.rows[jumps.clone()]
        .iter()
        .zip(&level.offset[jumps])
        .map(|(u, c)| (u - c).abs())
        .fold(0.0, worse);
    c.continuity = Violation {
        value: jump,
        reference: displacement,
    };
    let worst = |v: &mut Violation, value: f64| v.value = worse(v.value, value);
    for v in [&mut c.sign, &mut c.cone] {
        v.reference = contact_force;
    }
    c.gap.reference = displacement;
    for v in [&mut c.complementarity, &mut c.direction] {
        v.reference = contact_force * displacement;
    }
    for (k, point) in model.points.iter().enumerate() {
        let open = (level.offset[point.row] - m.rows[point.row]) / point.scale;
        let force = point.scale * lambda[point.row];
        worst(&mut c.gap, -open);
        worst(&mut c.sign, force);
        worst(&mut c.complementarity, (force * open.max(0.0)).abs());
        let Some((row, count, scale)) = point.tangential.rows() else {
            continue;
        };
        let Some(bound) = slip_bound(model, level, k, lambda) else {
            continue;
        };
        let mut slip = [0.0; 2];
        let mut friction = [0.0; 2];
        for j in 0..count {
            slip[j] = (m.rows[row + j] - level.offset[row + j]) / scale;
            friction[j] = scale * lambda[row + j];
        }
        let (length, size) = (slip[0].hypot(slip[1]), friction[0].hypot(friction[1]));
        worst(&mut c.cone, size - bound);
        let off = [
            bound * slip[0] + length * friction[0],
            bound * slip[1] + length * friction[1],
        ];
        worst(&mut c.direction, off[0].hypot(off[1]));
    }
    c
}

/// Slip bound of a point in newtons, from the level's own normal forces.
pub(crate) fn slip_bound(model: &Model, level: &Level, k: usize, lambda: &[f64]) -> Option<f64> {
    let point = &model.points[k];
    if point.tangential == Tangential::None {
        return None;
    }
    Some(level.bound(k, point, lambda))
}
