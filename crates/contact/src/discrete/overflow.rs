//! Materials, loads, motions and gaps whose squares would overflow are refused with their place before anything is
//! solved: solvers would only see norms that are infinite or vanish, and blame their tolerance.

use super::couplings::Couplings;
use super::points::ContactPoint;
use crate::error::ContactError;
use crate::part::Part;
use crate::scene::{LoadKind, Pose, Scene};
use crate::tolerances::LARGEST;
use signorini_fem_mesh::{Decomposition, assemble_eigenstrain, assemble_load};
use signorini_qp::vector;

/// Refuses materials of regions in use; the least and the largest stiffness of a region times the extent of the mesh,
/// N/m.
pub(super) fn check_materials(scene: &Scene) -> Result<[f64; 2], ContactError> {
    let mut ends = [f64::INFINITY, 0.0_f64];
    for region in scene.mesh.distinct_regions() {
        let law = scene.materials.get(region).map_err(ContactError::Material)?;
        let value = law.bound();
        if !(1.0 / LARGEST..=LARGEST).contains(&value) {
            return Err(ContactError::Stiffness {
                region,
                value,
                least: 1.0 / LARGEST,
                most: LARGEST,
            });
        }
        ends = [ends[0].min(value), ends[1].max(value)];
    }
    let (low, high) = scene.mesh.extent();
    let extent = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    Ok(ends.map(|s| s * extent))
}

/// What numbers count, in words: scenes have units of their own.
const LENGTH: &str = "units of length";
const FORCE: &str = "units of force";
const STIFFNESS: &str = "units of force over length";
const COMPLIANCE: &str = "units of length over force";

/// Refuses what is too large; what is not a number is left to others.
fn expect(value: f64, unit: &'static str, part: Part, place: impl Fn() -> String) -> Result<(), ContactError> {
    if value > LARGEST {
        return Err(ContactError::TooLarge {
            part,
            place: place(),
            value,
            unit,
            most: LARGEST,
        });
    }
    Ok(())
}

/// Refuses motions of supports and obstacles; `spring` is the largest stiffness of a region, N/m.
pub(super) fn check_motions(scene: &Scene, spring: f64) -> Result<(), ContactError> {
    let most = |part, history, what: &str, size: f64, unit| {
        let (factor, time) = scene.analysis.largest_factor(history);
        expect(factor * size, unit, part, || format!(" at time {time} s: {what}"))
    };
    // what moves a body also strains it
    let strains = |part, history, what: &str, size: f64, times: &str| {
        most(part, history, what, size, LENGTH)?;
        most(
            part,
            history,
            &format!("{what}{times} the stiffness"),
            size * spring,
            FORCE,
        )
    };
    for (index, support) in scene.supports.iter().enumerate() {
        if let Some((values, history)) = &support.motion {
            let size = vector::max_abs(values.as_flattened());
            strains(Part::Support(index), history, "its displacement", size, " times")?;
        }
    }
    for (index, coupling) in scene.couplings.iter().enumerate() {
        for (motion, history) in &coupling.motions {
            let size = vector::max_abs(motion);
            strains(Part::Coupling(index), history, "its motion", size, " times")?;
        }
    }
    for (index, equation) in scene.equations.iter().enumerate() {
        let nodes = equation.terms.iter().map(|t| t.1);
        let all = nodes.chain(equation.points.iter().map(|p| p.1));
        let largest = all.map(|v| vector::max_abs(&v)).fold(0.0, f64::max);
        if let Some((value, history)) = equation.value.as_ref().filter(|_| largest > 0.0) {
            let what = "its value over its largest coefficient";
            strains(Part::Equation(index), history, what, value.abs() / largest, ", times")?;
        }
    }
    for (index, contact) in scene.contacts.iter().enumerate() {
        let part = Part::Contact(index);
        for (value, history) in &contact.motions {
            let size = vector::max_abs(value);
            most(part, history, "the displacement of its obstacle", size, LENGTH)?;
        }
        if let Some(rotation) = &contact.rotation {
            most(part, &rotation.angle, "the angle of its obstacle", 1.0, "radians")?;
        }
    }
    Ok(())
}

/// The nodal forces of each load with factor one, subdomain by subdomain, N; `spring` is the least stiffness of a
/// region, N/m.
pub(super) fn nodal_loads(
    scene: &Scene,
    (decomposition, couplings): (&Decomposition, &Couplings),
    spring: f64,
) -> Result<Vec<Vec<Vec<f64>>>, ContactError> {
    let mut out = Vec::with_capacity(scene.loads.len());
    for (index, load) in scene.loads.iter().enumerate() {
        let local = match &load.kind {
            LoadKind::Density(density) => assemble_load(&scene.mesh, decomposition, density),
            LoadKind::Eigenstrain(strain) => assemble_eigenstrain(&scene.mesh, decomposition, &scene.materials, strain),
            LoadKind::Coupling(load) => Ok(couplings.forces(scene, decomposition, (index, load))?),
        };
        let local = local.map_err(|source| ContactError::Load { index, source })?;
        // a NaN stays one
        let sizes = local.iter().map(|f| vector::max_abs(f));
        let size = sizes.fold(0.0, |a: f64, b| if b.is_nan() { b } else { a.max(b) });
        let (factor, time) = scene.analysis.largest_factor(&load.history);
        let place = |more: &str| format!(" at time {time} s: its largest nodal force{more}");
        let part = Part::Load(index);
        expect(factor * size, FORCE, part, || place(""))?;
        expect(factor * size / spring, LENGTH, part, || place(" over the stiffness"))?;
        out.push(local);
    }
    Ok(out)
}

/// Refuses the stiffness of a spring at a node.
pub(super) fn check_spring(index: usize, node: u32, stiffness: f64) -> Result<(), ContactError> {
    let place = || format!(" at node {node}: its stiffness");
    expect(stiffness, STIFFNESS, Part::Spring(index), place)
}

/// Refuses compliances that are too large for the area of a point.
pub(super) fn check_compliance(points: &[ContactPoint]) -> Result<(), ContactError> {
    for point in points.iter().filter(|p| p.compliance != [0.0; 2]) {
        let place = || format!(" at node {}: its compliance", point.node());
        for value in point.compliance {
            expect(value / point.area, COMPLIANCE, Part::Contact(point.surface), place)?;
        }
    }
    Ok(())
}

/// Refuses gaps as given, and what becomes of them at the steps at which they act.
pub(super) fn check_gaps(scene: &Scene, conditions: &[ContactPoint], poses: &[Vec<Pose>]) -> Result<(), ContactError> {
    for c in conditions {
        let place = || format!(" at node {}: the gap", c.node());
        let part = Part::Contact(c.surface);
        expect(c.gap.abs(), LENGTH, part, place)?;
        let contact = &scene.contacts[c.surface];
        if contact.changes_gap() {
            for (pose, _) in contact.acting(&poses[c.surface], scene.analysis.times()) {
                let gap = c.gap_after(scene, pose)?;
                expect(gap.abs(), LENGTH, part, place)?;
            }
        }
    }
    Ok(())
}
