//! The effects example: what is off costs nothing, and the plan's figures are those of the run.

use crate::effects::{EffectsOptions, Line, execute};
use crate::{folder, options, read};

fn find<'a>(lines: &'a [Line], name: &str) -> &'a Line {
    lines.iter().find(|l| l.name.ends_with(name)).expect("line")
}

#[test]
fn effects_that_are_off_cost_nothing() {
    let json = folder("effects").join("effects.json");
    let options: EffectsOptions = options(&format!("effects --short --json {}", json.display()));
    let mut out = Vec::new();
    let results = execute(&options, &mut out).expect("run");
    let lines = &results.effects;
    assert!(lines.iter().all(|l| l.certificate < 1e-6));
    // rows and factorisations are as planned
    for l in lines {
        assert_eq!(l.plan.rows(), l.truth.rows(), "{}", l.name);
        assert_eq!(l.plan.factorisations, l.truth.factorisations, "{}", l.name);
        let ratio = l.plan.products as f64 / l.truth.products as f64;
        assert!(ratio > 0.2 && ratio < 5.0, "{}: {ratio}", l.name);
    }
    // whatever the shape, no step is left unconverged where the default method did not give up
    assert!(results.shapes.len() >= 13);
    let all = results.shapes.iter().chain(&results.benchmark).chain(lines);
    for l in all.filter(|l| l.fallbacks == 0) {
        assert_eq!(l.unconverged, 0, "{}", l.name);
    }
    let gave_up = results.shapes.iter().filter(|l| l.fallbacks > 0).count();
    assert!(gave_up <= 4, "{gave_up}");
    let elastic = find(lines, "elastic only");
    assert_eq!(elastic.inequality_solves + elastic.slip_bound_updates, 0);
    assert_eq!(elastic.truth.rows(), elastic.truth.support_rows);
    for name in ["+ contact", "+ gap"] {
        let l = find(lines, name);
        assert!(l.truth.normal_rows > 0 && l.truth.tangential_rows == 0);
        assert_eq!((l.inequality_solves, l.slip_bound_updates), (1, 0));
    }
    assert_eq!(find(lines, "Tresca friction").slip_bound_updates, 1);
    let coulomb = find(lines, "Coulomb instead");
    assert!(coulomb.slip_bound_updates > 1);
    assert_eq!(coulomb.truth.tangential_rows, 2 * coulomb.truth.normal_rows);
    // no state without history, no rates without dependence on them
    let history = lines.iter().position(|l| l.name == "+ history").expect("line");
    assert!(lines[..history].iter().all(|l| l.state_bytes == 0));
    assert!(lines[history..].iter().all(|l| l.state_bytes > 0));
    assert!(lines[..=history].iter().all(|l| l.rate_updates == 0));
    assert!(lines[history + 1..].iter().all(|l| l.rate_updates == l.steps));
    let cut = find(lines, "several subdomains");
    assert!(lines[..lines.len() - 3].iter().all(|l| l.truth.interface_rows == 0));
    assert!(cut.truth.interface_rows > 0);
    // output and estimates change nothing in the solution
    for name in ["stress output", "error estimates"] {
        let l = find(lines, name);
        assert_eq!((l.truth.products, &l.forces), (cut.truth.products, &cut.forces));
        assert!(l.extra_seconds > 0.0);
    }
    let text = String::from_utf8(out).expect("text");
    assert!(text.contains("| + Tresca friction |") && text.contains("| n = 1 |"));
    assert!(read(&json).contains("rate_updates"));
}
