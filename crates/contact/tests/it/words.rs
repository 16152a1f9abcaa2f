//! Numbers and places in messages: short, and in one form.

use crate::common::*;

#[test]
fn a_huge_coefficient_has_an_exponent() {
    let floor = |law| clamped().with_contact(Contact::rigid(brick::Z_MIN).with_friction(law));
    let plan = Plan::new(&floor(Friction::coulomb(1e300)), &Settings::default()).expect("plan");
    let large = plan
        .warnings()
        .iter()
        .find(|w| matches!(w, Warning::LargeCoefficient { .. }));
    let text = large.expect("warned").to_string();
    assert!(
        text.contains("is 1e300;") && text.contains("1e300 in per cent is 1.") && text.len() < 200,
        "{text}"
    );
    let plan = Plan::new(&floor(Friction::coulomb(30.0)), &Settings::default()).expect("plan");
    assert!(plan.to_string().contains("is 30; "), "{plan}");
    let text = refused(&floor(Friction::coulomb(-1e300))).to_string();
    assert!(text.contains("the coefficient is -1e300; "), "{text}");
}

#[test]
fn errors_and_warnings_tell_places_alike() {
    let field = |x: [f64; 3]| if x[0] > 0.7 { f64::NAN } else { 0.0 };
    let scene = clamped().with_contact(Contact::rigid(brick::Z_MIN).with_gap_field(field));
    let error = refused(&scene);
    let ContactError::Gap { node, position, .. } = error else {
        panic!("{error}");
    };
    let far = clamped().with_contact(Contact::rigid(brick::Z_MIN).with_gap_field(move |x| {
        let from = (0..3).map(|c| (x[c] - position[c]).abs()).fold(0.0, f64::max);
        10.0 + from
    }));
    let plan = Plan::new(&far, &Settings::default()).expect("plan");
    let gap = plan.warnings().iter().find(|w| matches!(w, Warning::LargeGap { .. }));
    let told = |text: String| {
        let from = text.find('(').expect("a place");
        text[from..=from + text[from..].find(')').expect("its end")].to_owned()
    };
    let [own, other] = [told(error.to_string()), told(gap.expect("warned").to_string())];
    assert_eq!(own, other, "node {node}");
    assert!(!own.contains("e0") && !own.contains(".0,"), "{own}");
}
