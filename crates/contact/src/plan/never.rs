//! What of a scene acts at no step, though it is to act at some time.

use crate::discrete::DiscreteScene;
use crate::part::Part;
use crate::report::Warning;
use crate::scene::{Scene, Span};
use crate::tolerances::NO_LOAD;
use signorini_fem_mesh::History;

/// Parts of a step at which functions of time are looked at between its ends.
const BETWEEN: [f64; 2] = [0.31, 0.5];

/// The first support or contact in whose span no step ends, or coupling that locks behind all of them. What starts when
/// the last step ends waits on purpose.
pub(super) fn between_steps(scene: &Scene) -> Option<Warning> {
    let times = scene.analysis.times();
    let last = *times.last()?;
    let locks = scene.couplings.iter().enumerate().filter_map(|(k, coupling)| {
        let (start, end) = (Some(coupling.lockable()?.1), None);
        Some((Part::Coupling(k), Span { start, end }))
    });
    let mut all = scene.spans().chain(locks).filter(|(_, span)| span.start != Some(last));
    let (part, span) = all.find(|(_, span)| !times.iter().any(|&end| span.has(end)))?;
    Some(Warning::BetweenSteps {
        part,
        start: span.start.unwrap_or(0.0),
        end: span.end,
        last,
    })
}

/// The histories of loads, motions of supports, obstacles and couplings, and values of equations that are not zero.
pub(super) fn acting<'a>(scene: &'a Scene, discrete: &'a DiscreteScene) -> impl Iterator<Item = (Part, &'a History)> {
    let loads = scene.loads.iter().zip(&discrete.loads).enumerate();
    let loads = loads.filter(|(_, (_, forces))| forces.iter().flatten().any(|f| *f != 0.0));
    let supports = scene.supports.iter().enumerate();
    let motions = supports.filter_map(|(k, s)| Some((k, s.motion.as_ref()?)));
    let motions = motions.filter(|(_, (ways, _))| ways.iter().flatten().any(|w| *w != 0.0));
    let contacts = scene.contacts.iter().enumerate();
    let obstacles = contacts.flat_map(|(k, contact)| {
        let motions = contact.motions.iter().filter(|(way, _)| *way != [0.0; 3]);
        let turn = contact.rotation.as_ref().map(|rotation| &rotation.angle);
        (motions.map(|(_, history)| history).chain(turn)).map(move |history| (Part::Contact(k), history))
    });
    let couplings = scene.couplings.iter().enumerate().flat_map(|(k, coupling)| {
        let motions = coupling.motions().iter().filter(|(way, _)| *way != [0.0; 6]);
        motions.map(move |(_, history)| (Part::Coupling(k), history))
    });
    let equations = scene.equations.iter().enumerate().filter_map(|(k, equation)| {
        let (value, history) = equation.value.as_ref()?;
        (*value != 0.0).then_some((Part::Equation(k), history))
    });
    (loads.map(|(k, (load, _))| (Part::Load(k), &load.history)))
        .chain(motions.map(|(k, (_, history))| (Part::Support(k), history)))
        .chain(obstacles)
        .chain(couplings)
        .chain(equations)
}

/// The first of what acts whose history is zero at the end of each step but not at all times.
pub(super) fn zero_at_steps(scene: &Scene, discrete: &DiscreteScene) -> Option<Warning> {
    let times = scene.analysis.times();
    acting(scene, discrete).find_map(|(part, history)| {
        let (time, factor) = largest(history, times)?;
        let acts = times.iter().any(|&t| history.value(t).abs() > NO_LOAD * factor.abs());
        (!acts).then_some(Warning::ZeroAtSteps { part, time, factor })
    })
}

/// The time at which a history is largest, as far as it is known, and its value then; `None` of one that is zero. Of a
/// table its points are known, of a function some values between the ends of steps.
fn largest(history: &History, times: &[f64]) -> Option<(f64, f64)> {
    let starts = std::iter::once(&0.0).chain(times);
    let between = starts
        .zip(times)
        .flat_map(|(&start, &end)| BETWEEN.map(|part| start + part * (end - start)));
    let between = between
        .filter(|_| history.points().is_empty())
        .map(|time| (time, history.value(time)));
    let all = history.points().iter().copied().chain(between);
    let some = all.filter(|(_, value)| value.is_finite() && *value != 0.0);
    some.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a })
}
