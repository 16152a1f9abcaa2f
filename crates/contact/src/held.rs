//! Whether supports and contact can hold the body against its loads, judged before anything is solved.
//!
//! Equilibrium of the rigid motions that supports leave free is necessary: contact forces must exist with `G lambda = e`,
//! `lambda_nu <= 0` and friction in its cone. On these motions, six a free body at most, that is a small problem: the
//! loads `b` must lie in the cone of the contact forces. If they do not, the residual of the closest point in the cone
//! is a motion on which the loads work and against which no contact force can.

use crate::cone::{Cone, Generators, Separation};
use crate::error::ContactError;
use crate::law::Friction;
use crate::model::Model;
use signorini_qp::vector;
use signorini_tfeti::{BodyMotion, FreeMotion, OrthonormalCoarse, RowWeights};

/// Work on a free motion above this fraction of the size of the loads counts.
const WORK: f64 = 1e-9;

/// Refuses loads that push the body along a rigid motion that neither supports nor contact can stop.
pub(crate) fn check(model: &Model) -> Result<(), ContactError> {
    let coarse = model.tfeti.coarse();
    let mut weights = vec![1.0; coarse.dim()];
    weights[..model.tfeti.gluing().ranges().contact().end].fill(0.0);
    let motions = coarse.free_motions(Some(&RowWeights::diagonal(weights)))?;
    if motions.is_empty() {
        return Ok(());
    }
    let mut cone = Cone::new(motions.len(), generators(model, &motions)?);
    let given = model.any_law(|law| matches!(law, Friction::Given(_)));
    let loads: Vec<(Vec<f64>, f64)> = model
        .loads
        .iter()
        .map(|response| {
            let work = |m: &FreeMotion| vector::dot(&m.amplitudes, &response.coarse);
            let largest = motions.iter().map(|m| vector::norm(&m.amplitudes));
            let size = vector::norm(&response.coarse) * largest.fold(0.0, f64::max);
            (motions.iter().map(work).collect(), size)
        })
        .collect();
    let analysis = &model.scene.analysis;
    let mut approved: Option<Vec<f64>> = None;
    for level in 0..analysis.levels() {
        let Some(time) = analysis.time(level) else {
            break;
        };
        let mut b = vec![0.0; motions.len()];
        let mut size = 0.0;
        for (load, (work, part)) in model.scene.loads.iter().zip(&loads) {
            let h = load.history.value(time);
            vector::axpy(h, work, &mut b);
            size += h.abs() * part;
        }
        let length = vector::norm(&b);
        if length <= WORK * size {
            continue;
        }
        if given {
            // the size of the loads counts
            if let Some(Separation { motion, given }) = cone.exceeded(&b) {
                let force = vector::dot(&motion, &b);
                return Err(not_held(level, &motions, &motion, force, given));
            }
            continue;
        }
        b.iter_mut().for_each(|v| *v /= length);
        // loads that only grow need no second look
        let same = |old: &Vec<f64>| vector::distance(old, &b) < 1e-12;
        if approved.as_ref().is_some_and(same) {
            continue;
        }
        if let Some(motion) = cone.separates(&b) {
            let force = length * vector::dot(&motion, &b);
            return Err(not_held(level, &motions, &motion, force, 0.0));
        }
        approved = Some(b);
    }
    Ok(())
}

/// The refusal: `given` is what given friction takes of the force.
fn not_held(
    level: usize,
    motions: &[FreeMotion],
    motion: &[f64],
    force: f64,
    given: f64,
) -> ContactError {
    // `G lambda = e = -Rᵀ f`: the loads push along the negative residual
    let motion: Vec<f64> = motion.iter().map(|v| -v).collect();
    let Described { body, mode, share } = describe(motions, &motion);
    let mode = if given > 0.0 {
        format!(
            "{mode}, of which given friction holds {:.3e} N,",
            given * share
        )
    } else {
        mode
    };
    ContactError::NotHeld {
        level,
        body,
        mode,
        force: force * share,
    }
}

/// What a force at each touch point does on the motions: newtons to work.
fn generators(model: &Model, motions: &[FreeMotion]) -> Result<Vec<Generators>, ContactError> {
    let coarse = model.tfeti.coarse();
    let mut scratch = coarse.scratch();
    let columns: Vec<Vec<f64>> = motions
        .iter()
        .map(|motion| {
            let mut out = vec![0.0; coarse.dim()];
            coarse.apply_transpose(&motion.amplitudes, &mut out, &mut scratch);
            out
        })
        .collect();
    let along =
        |row: usize, factor: f64| -> Vec<f64> { columns.iter().map(|c| factor * c[row]).collect() };
    let mut out = Vec::with_capacity(model.points.len());
    for point in &model.points {
        let tangents = point
            .tangential
            .rows()
            .map_or_else(Vec::new, |(row, count, scale)| {
                (row..row + count).map(|k| along(k, 1.0 / scale)).collect()
            });
        let (coefficient, given) = match model.law(point) {
            Friction::None => (Some(0.0), 0.0),
            Friction::Given(bound) => {
                let stress = bound.stress(point.node, point.position)?;
                (Some(0.0), stress * point.area)
            }
            Friction::Coulomb(law) => (law.largest(point.position), 0.0),
        };
        out.push(Generators {
            normal: along(point.row, -1.0 / point.scale),
            tangents,
            coefficient,
            given,
        });
    }
    Ok(out)
}

/// What a message says of a motion.
struct Described {
    /// The body that moves most.
    body: usize,
    /// Its motion in words, of length one.
    mode: String,
    /// Its share of the motion of all bodies, of length one. Supports and obstacles act on each body alone, so its part
    /// is a free motion of its own, on which the loads do this share of the work per length.
    share: f64,
}

fn describe(motions: &[FreeMotion], factors: &[f64]) -> Described {
    let mut bodies: Vec<(BodyMotion, [f64; 6])> = Vec::new();
    for (motion, factor) in motions.iter().zip(factors) {
        for body in &motion.bodies {
            let at = match bodies.iter().position(|b| b.0.body == body.body) {
                Some(at) => at,
                None => {
                    bodies.push((*body, [0.0; 6]));
                    bodies.len() - 1
                }
            };
            for c in 0..3 {
                bodies[at].1[c] += factor * body.translation[c];
                bodies[at].1[3 + c] += factor * body.rotation[c];
            }
        }
    }
    let size = |m: &[f64; 6]| m.iter().map(|v| v * v).sum::<f64>();
    let Some((body, m)) = bodies
        .iter()
        .max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)))
    else {
        return Described {
            body: 0,
            mode: "a rigid motion".to_owned(),
            share: 1.0,
        };
    };
    let share = size(m).sqrt();
    let rounded = |v: &f64| {
        let v = v / share;
        if v.abs() < 5e-4 { 0.0 } else { v }
    };
    let words = |name: &str, v: &[f64]| {
        let v: Vec<f64> = v.iter().map(rounded).collect();
        let moves = v.iter().any(|v| *v != 0.0);
        moves.then(|| format!("{name} ({:.3}, {:.3}, {:.3})", v[0], v[1], v[2]))
    };
    let turn = words("rotation", &m[3..]).map(|w| format!("{w} at radius {:.3e} m", body.radius));
    let parts: Vec<String> = words("translation", &m[..3])
        .into_iter()
        .chain(turn)
        .collect();
    Described {
        body: body.body,
        mode: format!("its {}", parts.join(" with ")),
        share,
    }
}

/// The orthonormal coarse rows that the linear solver and the paper's methods need.
///
/// # Errors
/// [`ContactError::NotDetermined`] if no row stops some rigid motion. [`check`] has found before that the loads do not
/// push along it.
pub(crate) fn orthonormal_coarse(model: &Model) -> Result<OrthonormalCoarse, ContactError> {
    let factor = model.tfeti.coarse_factor();
    factor.orthonormal().ok_or_else(|| {
        let motions = factor.free_motions();
        let words: Vec<String> = motions.iter().map(ToString::to_string).collect();
        let body = motions
            .first()
            .and_then(|m| m.bodies.first())
            .map_or(0, |b| b.body);
        ContactError::NotDetermined {
            body,
            count: motions.len(),
            motions: words.join("; "),
        }
    })
}
