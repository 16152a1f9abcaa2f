//! Whether supports and contact can hold the body against its loads, judged before anything is solved; and whether
//! friction can with given normal forces.
//!
//! Equilibrium of the rigid motions that supports leave free is necessary: contact forces must exist with `G lambda =
//! e`, `lambda_nu <= 0` and friction in its cone. On these motions, six a free body at most, that is a small problem:
//! the loads `b` must lie in the cone of the contact forces. If they do not, the residual of the closest point in the
//! cone is a motion on which the loads work and against which no contact force can. Where larger friction could, the
//! error says so, and by which factor.

use super::contact_point::ConstrainedPoint;
use super::friction_cone::{Generators, Separation, WrenchCone};
use super::model::Model;
use crate::error::ContactError;
use crate::scene::{Friction, LoadKind};
use crate::status::{FreeCoupling, Slide};
use crate::tolerances::{ALONGSIDE, FREE_WORK, LEFT_FREE, NEAR_BALANCE, ROUNDING, SLIDES};
use signorini_qp::vector;
use signorini_tfeti::{BodyMotion, FreeMotion};

/// Refuses loads that push the body, at some step from a `first` one on, along a rigid motion that neither supports nor
/// contact can stop.
pub(crate) fn check_equilibrium(model: &Model, first: usize) -> Result<(), ContactError> {
    let motions = model.loose_motions()?;
    if motions.is_empty() {
        return Ok(());
    }
    // each body is judged alone, by its own loads, with those that it may touch
    let mut worst: Option<Escape> = None;
    for body in 0..model.bodies.count() {
        let motions = loose_motions_of(model, body, motions);
        if motions.is_empty() {
            continue;
        }
        if let Some(escape) = escapes(model, body, &motions, first)? {
            let first = |w: &Escape| escape.step < w.step || escape.step == w.step && escape.force > w.force;
            if worst.as_ref().is_none_or(first) {
                worst = Some(escape);
            }
        }
    }
    worst.map_or(Ok(()), |escape| Err(escape.error))
}

/// The body that slides away where multipliers are not in balance with the right side `e` of a step; `None` if they
/// are, or if supports hold all bodies.
pub(crate) fn slides(model: &Model, e: &[f64], lambda: &[f64]) -> Result<Option<Slide>, ContactError> {
    let coarse = model.tfeti.coarse();
    let mut missing = vec![0.0; e.len()];
    coarse.apply(lambda, &mut missing, &mut coarse.scratch());
    vector::axpby(1.0, e, -1.0, &mut missing);
    let motions: Vec<&FreeMotion> = model.loose_motions()?.iter().collect();
    let work: Vec<f64> = motions.iter().map(|m| -vector::dot(&m.amplitudes, &missing)).collect();
    let size = vector::norm(&work);
    if !(size.is_finite() && size > 0.0) {
        return Ok(None);
    }
    let (slide, _, length) = describe(model, &motions, &work);
    Ok((length > 0.0).then_some(Slide { force: length, ..slide }))
}

/// Whether friction within the slip bounds of the points, in units of force of their bodies, could balance the loads
/// `e` with the normal forces among multipliers and any that come to them, or pressure most of what is missing. Where
/// it could, it is other forces that are not found yet.
pub(crate) fn friction_could_hold(
    model: &Model,
    e: &[f64],
    lambda: &[f64],
    bound: impl Fn(usize, &ConstrainedPoint) -> f64,
) -> Result<bool, ContactError> {
    let coarse = model.tfeti.coarse();
    let mut normal = lambda.to_vec();
    normal[model.tangential_rows()].fill(0.0);
    let [pressed, held] = [&normal, lambda].map(|forces| {
        let mut out = vec![0.0; e.len()];
        coarse.apply(forces, &mut out, &mut coarse.scratch());
        out
    });
    let all = model.loose_motions()?;
    for body in 0..model.bodies.count() {
        let motions = loose_motions_of(model, body, all);
        let work =
            |forces: &[f64]| -> Vec<f64> { motions.iter().map(|m| vector::dot(&m.amplitudes, forces)).collect() };
        let [load, pressed, held] = [e, &pressed, &held].map(work);
        let [mut rest, mut missing] = [load.clone(), load.clone()];
        vector::subtract(&pressed, &mut rest);
        vector::subtract(&held, &mut missing);
        // pressure alone is in balance with the loads, or all is; or what loads leave along these motions is rounding
        let size = load.iter().chain(&pressed).fold(0.0_f64, |size, v| size.max(v.abs()));
        let least = (NEAR_BALANCE * size).max(ROUNDING * vector::norm(e));
        let small = |rest: &[f64]| vector::norm(rest) <= least;
        if small(&rest) || small(&missing) {
            continue;
        }
        let columns = columns(model, &motions);
        let own = || {
            let points = model.points.iter().enumerate();
            points.filter(|(_, point)| model.bodies.of_row(point.row) == body)
        };
        // an iterate may have lifted a body off what presses it
        let pressure = own().map(|(_, point)| Generators::pressure(along(&columns, point.row, -1.0 / point.scale)));
        vector::scale(vector::norm(&missing).recip(), &mut missing);
        let slides = WrenchCone::new(pressure.collect()).separates(&missing);
        if slides.is_none_or(|motion| vector::dot(&motion, &missing) < SLIDES) {
            continue;
        }
        let friction = own().map(|(k, point)| Generators {
            normal: along(&columns, point.row, -1.0 / point.scale),
            tangents: tangents(&columns, point),
            coefficient: Some(0.0),
            tresca: bound(k, point),
        });
        let mut cone = WrenchCone::new(friction.collect());
        if cone.exceeded(&rest).is_some() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Those of some motions that move a body.
pub(crate) fn loose_motions_of<'a>(model: &Model, body: usize, motions: &'a [FreeMotion]) -> Vec<&'a FreeMotion> {
    let group = |b: &BodyMotion| model.bodies.of_body(b.body) == body;
    motions.iter().filter(|m| m.bodies.iter().any(group)).collect()
}

/// A body that gets away, when, and by how much the loads exceed what holds it, N.
struct Escape {
    step: usize,
    force: f64,
    error: ContactError,
}

/// The first step, from one on, at which nothing can hold a body.
fn escapes(model: &Model, body: usize, motions: &[&FreeMotion], first: usize) -> Result<Option<Escape>, ContactError> {
    let mut cone = WrenchCone::new(generators(model, body, motions)?);
    let largest = motions.iter().map(|m| vector::norm(&m.amplitudes));
    let largest = largest.fold(0.0, f64::max);
    let tresca = model.any_law(|law| matches!(law, Friction::Tresca(_)));
    // of each load its work on the motions, and its size
    let work = |load: &signorini_tfeti::LoadResponse| {
        let works = motions.iter().map(|m| vector::dot(&m.amplitudes, &load.coarse));
        let subdomains = load.coarse.chunks_exact(6).enumerate();
        let own = subdomains.filter(|(s, _)| model.bodies.of_subdomain(*s) == body);
        let square: f64 = own.map(|(_, e)| e.iter().map(|v| v * v).sum::<f64>()).sum();
        (works.collect::<Vec<f64>>(), square.sqrt() * largest)
    };
    let loads: Vec<_> = model.loads.iter().map(work).collect();
    let mut approved: Option<Vec<f64>> = None;
    // other stages may hold more, or less
    let steps = model.scene.stage_steps();
    let steps = steps.start.max(first)..steps.end;
    let times = model.scene.analysis.times().iter().enumerate();
    for (step, &time) in times.skip(steps.start).take(steps.len()) {
        let mut b = vec![0.0; motions.len()];
        let mut size = 0.0;
        for (load, (work, part)) in loads.iter().enumerate() {
            let h = model.factor(load, time);
            vector::axpy(h, work, &mut b);
            size += h.abs() * part;
        }
        let length = vector::norm(&b);
        if length <= FREE_WORK * size {
            continue;
        }
        let found = if tresca {
            // the size of the loads counts
            cone.exceeded(&b)
        } else {
            b.iter_mut().for_each(|v| *v /= length);
            // loads that only grow need no second look
            let same = |old: &Vec<f64>| vector::distance(old, &b) < ROUNDING;
            if approved.as_ref().is_some_and(same) {
                continue;
            }
            cone.separates(&b).map(|motion| Separation { motion, tresca: 0.0 })
        };
        if let Some(found) = found {
            let unit = if tresca { 1.0 } else { length };
            let friction = cone.friction_needed(&b);
            let work = |s: &Separation| unit * vector::dot(&s.motion, &b);
            let escape = |s: &Separation| escape(model, step, motions, s, (work(s), friction));
            let flat = Separation {
                motion: cone.sliding(&found.motion),
                tresca: 0.0,
            };
            // loads that lift it, too, are told as they are
            let slides = friction.is_some() && !tresca && work(&flat) > work(&found);
            let whole = escape(&found);
            return Ok(Some(if slides {
                Escape {
                    force: whole.force,
                    ..escape(&flat)
                }
            } else {
                whole
            }));
        }
        approved = Some(b);
    }
    Ok(None)
}

/// The way out along a motion on which the loads work with `force`, N; by which factor friction would have to be
/// larger, `None` where no friction could hold the body.
fn escape(
    model: &Model,
    step: usize,
    motions: &[&FreeMotion],
    found: &Separation,
    (force, friction): (f64, Option<f64>),
) -> Escape {
    // `G lambda = e = -Rᵀ f`: the loads push along the negative residual
    let motion: Vec<f64> = found.motion.iter().map(|v| -v).collect();
    let (slide, radius, share) = describe(model, motions, &motion);
    let mut mode = slide.to_string();
    if slide.turns() {
        mode = format!("{mode} at radius {radius:.3e}");
    }
    if found.tresca > 0.0 {
        let held = found.tresca * share;
        mode = format!("{mode}, of which Tresca friction holds {held:.3e},");
    }
    let force = force * share;
    let error = ContactError::NotHeld {
        step,
        body: slide.body as usize,
        node: slide.node,
        mode,
        force,
        friction,
        coupling: slide.coupling.map(Box::new),
    };
    Escape { step, force, error }
}

/// What multipliers of one do on the motions, by motion and row; nothing where rounding alone says so, of motions and
/// rows of length one.
fn columns(model: &Model, motions: &[&FreeMotion]) -> Vec<Vec<f64>> {
    let coarse = model.tfeti.coarse();
    let mut scratch = coarse.scratch();
    let column = |motion: &&FreeMotion| {
        let mut out = vec![0.0; coarse.dim()];
        coarse.apply_transpose(&motion.amplitudes, &mut out, &mut scratch);
        out.iter_mut().filter(|v| v.abs() <= FREE_WORK).for_each(|v| *v = 0.0);
        out
    };
    motions.iter().map(column).collect()
}

/// Those of a row, times a factor.
fn along(columns: &[Vec<f64>], row: usize, factor: f64) -> Vec<f64> {
    columns.iter().map(|c| factor * c[row]).collect()
}

/// What friction forces of 1 N at a point do on the motions.
fn tangents(columns: &[Vec<f64>], point: &ConstrainedPoint) -> Vec<Vec<f64>> {
    let rows = point.isotropic().skip(1);
    rows.map(|own| along(columns, own.row, 1.0 / own.scale)).collect()
}

/// What a force at each contact point does on the motions: newtons to work.
fn generators(model: &Model, body: usize, motions: &[&FreeMotion]) -> Result<Vec<Generators>, ContactError> {
    let columns = columns(model, motions);
    let mut out = Vec::new();
    let own = |point: &&ConstrainedPoint| model.bodies.of_row(point.row) == body;
    for point in model.points.iter().filter(own) {
        let (coefficient, tresca) = match model.law(point) {
            Friction::None => (Some(0.0), 0.0),
            Friction::Tresca(bound) => {
                let stress = bound.stress(point.contact.at())?;
                (Some(0.0), stress * point.area())
            }
            Friction::Coulomb(law) => (law.largest(point.position()), 0.0),
        };
        out.push(Generators {
            normal: along(&columns, point.row, -1.0 / point.scale),
            tangents: tangents(&columns, point),
            coefficient,
            tresca,
        });
    }
    Ok(out)
}

/// A rigid part: a body, or what hinges join to one.
#[derive(Debug, Clone, Copy, Default)]
struct RigidPart {
    body: usize,
    /// Its first subdomain.
    subdomain: usize,
    radius: f64,
    /// Translation, and rotation times the radius.
    motion: [f64; 6],
}

/// The coupling that leaves free most of a sum of motions, of this length in a body of this radius, but for what loads
/// push it along.
pub(crate) fn freed(
    model: &Model,
    motions: &[&FreeMotion],
    factors: &[f64],
    (length, radius): (f64, f64),
) -> Option<FreeCoupling> {
    let (tfeti, couplings) = (&model.tfeti, &model.discrete.couplings);
    if model.scene.couplings.is_empty() {
        return None;
    }
    let mut torn = vec![0.0; tfeti.torn_dim()];
    for subdomain in couplings.first..tfeti.subdomains() {
        let own = &mut torn[tfeti.torn_range(subdomain)];
        for (motion, factor) in motions.iter().zip(factors) {
            let amplitudes = &motion.amplitudes[6 * subdomain..6 * (subdomain + 1)];
            tfeti.kernel(subdomain).add_motion(*factor, amplitudes, own);
        }
    }
    // what a load pushes is to move along it
    let loaded = |k: usize, c: usize| {
        model.scene.loads.iter().any(|load| match &load.kind {
            LoadKind::Coupling(load) if load.coupling == k => {
                let along = couplings.along(k, [load.force, load.moment]);
                along[c].abs() > ROUNDING * vector::norm(&along)
            }
            _ => false,
        })
    };
    let mut found: Option<(f64, FreeCoupling)> = None;
    let motions = model.coupling_motions(&torn).into_iter().zip(&model.scene.couplings);
    for (k, (motion, coupling)) in motions.enumerate() {
        let (along, holds) = (couplings.along(k, motion), coupling.holds());
        let free = |c: usize| if holds[c] || loaded(k, c) { 0.0 } else { along[c].abs() };
        let sizes: [f64; 6] = std::array::from_fn(|c| if c < 3 { free(c) } else { radius * free(c) });
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let enough = largest > 0.0 && largest >= ALONGSIDE * length;
        if enough && found.is_none_or(|other| largest > other.0 * (1.0 + ROUNDING)) {
            let free = FreeCoupling {
                coupling: k as u32,
                tied: coupling.tied().map(|contact| contact as u32),
                free: sizes.map(|size| size >= LEFT_FREE * largest),
                axes: couplings.axes[k],
            };
            found = Some((largest, free));
        }
    }
    found.map(|(_, free)| free)
}

/// The part that moves most in a sum of motions, and how.
pub(crate) fn slide(model: &Model, motions: &[&FreeMotion], factors: &[f64]) -> Slide {
    describe(model, motions, factors).0
}

/// The same, of length one; its radius, and its length in the sum.
fn describe(model: &Model, motions: &[&FreeMotion], factors: &[f64]) -> (Slide, f64, f64) {
    let subdomains = model.discrete.decomposition.subdomains();
    let mut parts: Vec<RigidPart> = Vec::new();
    for (motion, factor) in motions.iter().zip(factors) {
        // what moves relative to another is one of the bodies, or a point that moves with them
        let is_body = |part: &BodyMotion| !subdomains[part.subdomain].is_relative;
        let alone = !motion.bodies.iter().any(is_body);
        for part in motion.bodies.iter().filter(|part| alone || is_body(part)) {
            let at = match parts.iter().position(|p| p.subdomain == part.subdomain) {
                Some(at) => at,
                None => {
                    parts.push(RigidPart {
                        body: part.body,
                        subdomain: part.subdomain,
                        radius: part.radius,
                        motion: [0.0; 6],
                    });
                    parts.len() - 1
                }
            };
            for c in 0..3 {
                parts[at].motion[c] += factor * part.translation[c];
                parts[at].motion[3 + c] += factor * part.rotation[c];
            }
        }
    }
    let size = |p: &RigidPart| vector::norm(&p.motion);
    let most = parts.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
    let most = most.copied().unwrap_or_default();
    let (m, length) = (most.motion.map(|v| v / size(&most)), size(&most));
    let node = |part: &RigidPart| subdomains[part.subdomain].nodes[0];
    let mut others = [None; 3];
    let far = parts
        .iter()
        .filter(|p| p.body != most.body && size(p) >= ALONGSIDE * length);
    let mut far: Vec<&RigidPart> = far.collect();
    far.sort_by_key(|p| p.body);
    far.dedup_by_key(|p| p.body);
    for (other, part) in others.iter_mut().zip(far) {
        *other = Some((part.body as u32, node(part)));
    }
    let slide = Slide {
        body: most.body as u32,
        node: node(&most),
        translation: [m[0], m[1], m[2]],
        rotation: [m[3], m[4], m[5]],
        force: 0.0,
        others,
        coupling: freed(model, motions, factors, (length, most.radius)),
    };
    (slide, most.radius, length)
}
