//! The gaps that coordinates give between sides whose meshes do not match.
//!
//! Along curved sides they are those of the curves that facets stand for, which are known to a hundredth of the
//! distance between the two: what is less counts as none. Points are means around nodes; a contact touches where the
//! curves of its sides do, also between them.

use crate::error::ContactError;
use crate::mortar::MortarNode;
use crate::scene::{Contact, Gap};
use crate::tolerances::{CURVE, FACETED, SURELY};
use signorini_fem_mesh::{Surface, SurfaceFrame, TetMesh, vec3};
use signorini_qp::vector;

/// The gaps of a contact whose meshes do not match.
#[derive(Debug, Default)]
pub(super) struct MortarGaps {
    /// That of each node of the side with the points along its normal, m; zero at those that see nothing.
    pub(super) gaps: Vec<f64>,
    /// The deepest overlap, if facets leave open how deep it is.
    pub(super) unsure: Option<Overlap>,
}

/// Where curved sides begin inside each other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Overlap {
    pub(crate) node: u32,
    /// How far, m.
    pub(crate) depth: f64,
    /// Distance of the facets of both sides from their curves, m.
    pub(crate) sagitta: f64,
}

impl MortarGaps {
    pub(super) fn new(
        mesh: &TetMesh,
        (index, contact): (usize, &Contact),
        (surface, fixed): (&Surface, Option<SurfaceFrame>),
        nodes: &[Option<MortarNode>],
        rounding: f64,
    ) -> Result<Self, ContactError> {
        let gap = |(local, seen): (usize, &Option<MortarNode>)| {
            let Some(seen) = seen else {
                return Ok(0.0);
            };
            let normal = fixed.unwrap_or(seen.frame).normal;
            let gap = mortar_gap(mesh, surface.nodes()[local], &normal, seen);
            let size = surface.areas()[local].sqrt();
            check_overlap(index, contact, [surface.nodes()[local], seen.partner[0].0], gap, size)?;
            // weights are in part negative: over a curved side a mean may be where nothing is
            let [nearest, farthest] = seen.range;
            let deepest = nearest.min(0.0);
            let inside = mesh.order() == 1 && !contact.tied && gap < deepest - rounding;
            Ok(match inside {
                true => deepest,
                false if seen.sagitta > 0.0 && fixed.is_none() => gap.max(nearest).min(farthest),
                false => gap,
            })
        };
        let mut gaps: Vec<f64> = nodes.iter().enumerate().map(gap).collect::<Result<_, ContactError>>()?;
        let seen = nodes
            .iter()
            .enumerate()
            .filter_map(|(local, seen)| Some((local, seen.as_ref()?)));
        let depth = |(local, seen): (usize, &MortarNode)| Overlap {
            node: surface.nodes()[local],
            depth: -gaps[local],
            sagitta: seen.sagitta,
        };
        let deepest = seen.map(depth).max_by(|a, b| a.depth.total_cmp(&b.depth));
        let is_unsure = |o: &Overlap| {
            let unknown = CURVE * o.sagitta;
            !contact.tied && unknown > FACETED * o.depth && o.depth > SURELY * unknown
        };
        let unsure = deepest.filter(is_unsure);
        if !contact.tied {
            touch(surface, fixed.is_some(), nodes, &mut gaps);
        }
        for (gap, seen) in gaps.iter_mut().zip(nodes) {
            let Some(seen) = seen else {
                continue;
            };
            let weights: f64 = seen.partner.iter().map(|(_, weight)| weight.abs()).sum();
            let unknown = if contact.tied { 0.0 } else { CURVE * seen.sagitta };
            if gap.abs() <= unknown.max(weights * rounding) {
                *gap = 0.0;
            }
        }
        Ok(Self { gaps, unsure })
    }
}

/// Brings points together where curves touch, or are nearest, between them: of those over such places the nearest one
/// of each neighbourhood, and its neighbours as far; all others as far as the first of all. None comes nearer than the
/// curves around it are.
fn touch(surface: &Surface, is_fixed: bool, nodes: &[Option<MortarNode>], gaps: &mut [f64]) {
    let seen = || nodes.iter().flatten();
    let arc = seen().map(|s| s.arc).fold(0.0, f64::max);
    let nearest = seen().map(|s| s.range[0]).fold(f64::INFINITY, f64::min);
    let unknown = CURVE * arc;
    // along a given direction only what touches is as far apart as along the normal
    if arc == 0.0 || is_fixed && nearest > unknown {
        return;
    }
    let early = |gap: f64| {
        if gap - nearest.max(0.0) > unknown {
            gap - nearest.max(0.0)
        } else {
            0.0
        }
    };
    let first = gaps.iter().zip(nodes).filter(|(_, s)| s.is_some()).map(|(gap, _)| *gap);
    let all = early(first.fold(f64::INFINITY, f64::min));
    let is_over = |k: usize| nodes[k].as_ref().is_some_and(|s| s.range[0] <= nearest + unknown);
    let mut around = vec![f64::INFINITY; gaps.len()];
    for triangle in surface.triangles() {
        let over = || triangle.iter().map(|&n| n as usize).filter(|&k| is_over(k));
        let least = over().map(|k| gaps[k]).fold(f64::INFINITY, f64::min);
        over().for_each(|k| around[k] = around[k].min(least));
    }
    for ((gap, seen), around) in gaps.iter_mut().zip(nodes).zip(around) {
        let Some(seen) = seen else {
            continue;
        };
        let early = if around.is_finite() { early(around) } else { all };
        if early > 0.0 {
            *gap = (*gap - early).max(gap.min(seen.range[0].max(0.0)));
        }
    }
}

/// The weighted gap of a node along a normal, m: from the node to the weighted mean of what it sees.
fn mortar_gap(mesh: &TetMesh, node: u32, normal: &[f64; 3], seen: &MortarNode) -> f64 {
    let from = mesh.points()[node as usize];
    let along = |&(other, weight): &(u32, f64)| {
        let way = vec3::sub(mesh.points()[other as usize], from);
        weight * vector::dot(&way, normal)
    };
    let [partner, own] = [&seen.partner, &seen.own].map(|side| side.iter().map(along).sum::<f64>());
    partner - own + seen.way + vector::dot(&seen.bulge, normal)
}

/// Refuses bodies that lie in each other deeper than the facets of a node and its partner, unless the gap is given:
/// tied sides may be apart, not one within the other. `size` is the root of the area of the node, m.
pub(super) fn check_overlap(
    index: usize,
    contact: &Contact,
    [node, partner]: [u32; 2],
    gap: f64,
    size: f64,
) -> Result<(), ContactError> {
    let measured = contact.tied || matches!(contact.gap, Gap::Measured);
    if measured && -gap > size {
        return Err(ContactError::Overlap {
            contact: index,
            node,
            partner,
            depth: -gap,
            size,
        });
    }
    Ok(())
}
