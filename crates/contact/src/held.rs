//! Whether supports and contact can hold the body against its loads, judged before anything is solved.
//!
//! Equilibrium of the rigid motions that supports leave free is necessary: contact forces must exist with `G lambda = e`,
//! `lambda_nu <= 0` and friction in its cone. On these motions, six a free body at most, that is a small problem: the
//! loads `b` must lie in the cone of the contact forces. If they do not, the residual of the closest point in the cone
//! is a motion on which the loads work and against which no contact force can.

use crate::cone::{Cone, Generators};
use crate::error::ContactError;
use crate::law::Friction;
use crate::model::Model;
use signorini_qp::vector;
use signorini_tfeti::{FreeMotion, OrthonormalCoarse, RowWeights};

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
    let mut cone = Cone::new(motions.len(), generators(model, &motions));
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
        b.iter_mut().for_each(|v| *v /= length);
        // loads that only grow need no second look
        let same = |old: &Vec<f64>| vector::distance(old, &b) < 1e-12;
        if approved.as_ref().is_some_and(same) {
            continue;
        }
        if let Some(motion) = cone.separates(&b) {
            // `G lambda = e = -Rᵀ f`: the loads push along the negative residual
            let force = length * vector::dot(&motion, &b);
            let motion: Vec<f64> = motion.iter().map(|v| -v).collect();
            let (body, mode) = describe(&motions, &motion);
            return Err(ContactError::NotHeld {
                level,
                body,
                mode,
                force,
            });
        }
        approved = Some(b);
    }
    Ok(())
}

/// What a force at each touch point does on the motions: newtons to work.
fn generators(model: &Model, motions: &[FreeMotion]) -> Vec<Generators> {
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
        let coefficient = match model.friction() {
            Friction::None => Some(0.0),
            // bounds do not follow the pressure: what they cannot hold shows in the solution
            Friction::Given(_) => None,
            Friction::Coulomb(law) => law.largest(point.position),
        };
        out.push(Generators {
            normal: along(point.row, -1.0 / point.scale),
            tangents,
            coefficient,
        });
    }
    out
}

/// The body that moves most, and the motion in words.
fn describe(motions: &[FreeMotion], factors: &[f64]) -> (usize, String) {
    let mut bodies: Vec<(usize, [f64; 6])> = Vec::new();
    for (motion, factor) in motions.iter().zip(factors) {
        for body in &motion.bodies {
            let at = match bodies.iter().position(|b| b.0 == body.body) {
                Some(at) => at,
                None => {
                    bodies.push((body.body, [0.0; 6]));
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
    let Some(&(body, m)) = bodies
        .iter()
        .max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)))
    else {
        return (0, String::new());
    };
    let unit = 1.0 / size(&m).sqrt();
    let m = m.map(|v| {
        if (v * unit).abs() < 5e-4 {
            0.0
        } else {
            v * unit
        }
    });
    let mode = format!(
        "its translation ({:.3}, {:.3}, {:.3}) with rotation ({:.3}, {:.3}, {:.3})",
        m[0], m[1], m[2], m[3], m[4], m[5]
    );
    (body, mode)
}

/// The orthonormal coarse rows that the linear solver and the paper's methods need.
///
/// # Errors
/// [`ContactError::NotHeld`] if no row stops some rigid motion, even if the loads do not push along it.
pub(crate) fn orthonormal_coarse(model: &Model) -> Result<OrthonormalCoarse, ContactError> {
    let factor = model.tfeti.coarse_factor();
    factor.orthonormal().ok_or_else(|| {
        let motions = factor.free_motions();
        let words: Vec<String> = motions.iter().map(ToString::to_string).collect();
        let body = motions
            .first()
            .and_then(|m| m.bodies.first())
            .map_or(0, |b| b.body);
        ContactError::NotHeld {
            level: 0,
            body,
            mode: words.join("; "),
            force: 0.0,
        }
    })
}
