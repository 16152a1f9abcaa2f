//! The cases with known answers, on their coarse meshes.

use super::cases::{CasesOptions, Finding, RunFacts, execute, within_limits};
use super::folder;
use clap::Parser;

/// Errors stay below what these meshes give, and products below what pairs of matching meshes take, or little more.
#[test]
fn short_cases_come_near_their_targets() {
    let path = folder("cases").join("cases.md");
    let arguments = ["cases", "--short", "--out", path.to_str().expect("a path")];
    let mut text = Vec::new();
    let findings = execute(&CasesOptions::parse_from(arguments), &mut text).expect("cases");
    assert!(findings.len() > 15);
    for Finding { case, quantity, .. } in &findings {
        assert!(
            std::fs::read_to_string(&path).expect("page").contains(case.as_str()),
            "{case}: {quantity}"
        );
    }
    for finding in &findings {
        let most = match finding.case.split([',', ' ']).next() {
            Some("pulled" | "wedge") => 1e-9,
            // seconds over seconds
            Some("search") => 1.0,
            // on meshes that are too coarse for their limits
            Some("press") => 0.1,
            Some("crack" | "punch" | "Cattaneo") => 0.04,
            Some("two") => 0.2,
            Some("rigid") if finding.target > 0.0 => 0.03,
            Some("curved") if finding.asked == 0.0 => 0.04,
            _ => finding.asked,
        };
        assert!(
            finding.error() < most || finding.quantity.starts_with("order"),
            "{finding:?}"
        );
        assert!(finding.run.certificate < 1e-6, "{finding:?}");
        if finding.case.starts_with("pulled") {
            assert!(finding.run.products <= 19, "{finding:?}");
        }
    }
    // contact that grows from a point: 68 products is the linear problem with the last active set on the full mesh
    let hertz = findings.iter().find(|f| f.case == "two spheres").expect("two spheres");
    assert!(hertz.run.products <= 80, "{hertz:?}");
    // what supports of a thin body leave free is eliminated, and what is added to dependent rows of a joint is little;
    // between the planes of a slice rows at the border of the punch depend on others
    for (start, most) in [("plate", 400), ("press", 140), ("crack", 65), ("punch", 95)] {
        let own = findings.iter().filter(|f| f.case.starts_with(start));
        let products: Vec<usize> = own.map(|f| f.run.products).collect();
        assert!(products.iter().all(|p| *p <= most), "{start}: {products:?}");
    }
    // facets that do not coincide: errors fall with the cells
    for finding in findings.iter().filter(|f| f.quantity == "order of the mean error") {
        assert!(finding.value > 0.9, "{finding:?}");
    }
    // no locking, and products that do not explode
    let spheres: Vec<&Finding> = findings.iter().filter(|f| f.case.starts_with("rigid")).collect();
    assert!(
        spheres.len() == 3 && spheres[..2].iter().all(|f| f.error() < 0.04),
        "{spheres:?}"
    );
    let products = [0, 1].map(|k| spheres[k].run.products);
    assert!(2 * products[1] <= 5 * products[0] && products[1] <= 80, "{spheres:?}");
    let mean = findings
        .iter()
        .find(|f| f.quantity == "pressure, mean, MPa")
        .expect("press fit");
    assert!(mean.error() < 0.02, "{mean:?}");
}

#[test]
fn an_error_above_its_limit_fails() {
    let finding = |value| Finding::new("case", "force", value, 2.0, 0.1, RunFacts::default());
    let open = Finding::new("case", "no limit", 9.0, 2.0, 0.0, RunFacts::default());
    assert!(within_limits(&[finding(2.1), open]).is_ok());
    for value in [2.3, 1.7, f64::NAN] {
        let error = within_limits(&[finding(2.0), finding(value)]).expect_err("above");
        assert_eq!(error.to_string().matches("force").count(), 1, "{error}");
    }
}

#[test]
fn an_unknown_case_is_named_with_those_that_there_are() {
    let options = CasesOptions::parse_from(["cases", "--case", "nothing"]);
    let error = execute(&options, &mut Vec::new())
        .expect_err("no such case")
        .to_string();
    assert!(error.contains("nothing") && error.contains("press-fit"), "{error}");
}
