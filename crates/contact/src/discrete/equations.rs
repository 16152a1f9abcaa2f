//! Linear equations at the nodes of the mesh.

use super::couplings::Couplings;
use super::supports::Supports;
use crate::error::ContactError;
use crate::scene::Scene;
use signorini_tfeti::{NodalEquation, TfetiError};

/// The equations of a scene as `tfeti` wants them; `supports` get the histories of their values.
pub(super) fn equations(
    scene: &Scene,
    couplings: &Couplings,
    supports: &mut Supports,
) -> Result<Vec<NodalEquation>, ContactError> {
    let nodes = scene.mesh.points().len();
    let mut out = Vec::with_capacity(scene.equations.len());
    for (equation, given) in scene.equations.iter().enumerate() {
        let refuse = |node: Option<u32>, reason| {
            let others = Vec::new();
            let error = TfetiError::Equation {
                equation,
                node,
                others,
                reason,
            };
            Err(error.into())
        };
        if let Some(&(node, _)) = given.terms.iter().find(|t| t.0 as usize >= nodes) {
            return refuse(Some(node), "the mesh has no such node; they are numbered from 0");
        }
        if let Some(&(node, _)) = given.terms.iter().find(|t| couplings.has(t.0)) {
            let reason = "it is in a rigid coupling; name other nodes, or leave it out of the coupling";
            return refuse(Some(node), reason);
        }
        let is_point = |k: usize| scene.couplings.get(k).is_some_and(|coupling| coupling.is_point());
        if !given.points.iter().all(|p| is_point(p.0)) {
            let reason = "there is no point of its number; they are numbered from 0, with the other couplings";
            return refuse(None, reason);
        }
        let value = given.value.as_ref();
        let places = given.points.iter().map(|(k, v)| {
            let place = (couplings.first + k) as u32;
            (place, v.map(|c| c / couplings.unit[*k]))
        });
        out.push(NodalEquation {
            terms: given.terms.clone(),
            places: places.collect(),
            values: value
                .map(|(value, history)| (supports.case(history), *value))
                .into_iter()
                .collect(),
        });
    }
    Ok(out)
}
