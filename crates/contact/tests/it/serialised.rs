//! Results as text for other programs.

use crate::common::*;

#[test]
fn a_result_is_written_as_json() {
    let mut simulation =
        Simulation::new(small_benchmark(Friction::coulomb(0.3), 1), Settings::default()).expect("simulation");
    let result = simulation.step().expect("step");
    let json = |value: serde_json::Result<serde_json::Value>| value.expect("JSON");
    let report = json(serde_json::to_value(result.report()));
    assert_eq!(report["status"], "Converged");
    assert_eq!(report["counters"]["products"], result.report().counters.products);
    let summary = json(serde_json::to_value(result.summary()));
    assert_eq!(summary["normal_force"], result.summary().normal_force);
    let certificate = json(serde_json::to_value(result.certificate()));
    assert!(
        certificate.as_object().is_some_and(|parts| parts.len() > 3),
        "{certificate}"
    );
    let points = result.points();
    let written = json(serde_json::to_value(points));
    assert_eq!(written[0]["node"], points[0].node);
    assert_eq!(written[0]["gap"], points[0].gap);
    let reactions = json(serde_json::to_value(result.reactions()));
    assert!(reactions["supports"].is_array(), "{reactions}");
}
