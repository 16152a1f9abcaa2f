//! Gaps of contact pairs that a deck prescribes or closes.

use std::sync::Arc;

use signorini_contact::{Settings, Simulation, StepResult};
use signorini_deck::Deck;
use signorini_fem_mesh::{Brick, FacetTag};

use crate::write::{STEEL, mesh, read};

/// Two cubes, one this high above the floor of the other.
fn text(height: f64, pair: &str, more: &str) -> String {
    let below = Brick::new([1.0; 3], [2, 2, 2]).build().expect("brick");
    let above = below.map_points(|[x, y, z]| [x, y, z + height]).expect("lifted");
    let both = below.append(&above.map_tags(|tag| FacetTag(tag.0 + 10))).expect("two");
    format!(
        "{}{STEEL}*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I{pair}\nS15, S6\n{more}\
        *BOUNDARY\nN5, 1, 3\nN16, 1, 3\n*STEP\n*STATIC\n*END STEP\n",
        mesh(&both)
    )
}

/// The same, read and solved.
fn cubes(height: f64, pair: &str, more: &str) -> (Deck, Arc<StepResult>) {
    let deck = read(&text(height, pair, more)).expect("deck");
    let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
    let result = simulation.step().expect("solved");
    (deck, result)
}

#[test]
fn gaps_are_measured_prescribed_or_closed() {
    let clearance = "*CLEARANCE, SLAVE=S15, MASTER=S6, VALUE=0.03\n";
    for (height, pair, more, exact, ignored) in [
        (1.01, "", "", 0.01, 0),
        (1.01, ", ADJUST=0.005", "", 0.01, 1),
        (1.01, ", ADJUST=0.02", "", 0.0, 1),
        // an overlap is none
        (0.99, ", ADJUST=0.", "", 0.0, 1),
        (1.01, "", clearance, 0.03, 0),
        (1.01, ", ADJUST=0.02", clearance, 0.03, 1),
    ] {
        let (deck, result) = cubes(height, pair, more);
        let gaps: Vec<f64> = result.points().iter().map(|p| p.gap).collect();
        assert_eq!((gaps.len(), deck.ignored().len()), (9, ignored), "{pair}{more}");
        assert!(
            gaps.iter().all(|gap| (gap - exact).abs() < 1e-9),
            "{pair}{more} {gaps:?}"
        );
        let moved = result
            .displacement()
            .iter()
            .flatten()
            .fold(0.0, |most: f64, u| most.max(u.abs()));
        assert!(moved < 1e-9, "{pair}{more} {moved}");
        let why = "ADJUST=0.02: ignored: the gap of this pair is that of its *CLEARANCE";
        let told = deck.ignored().iter().any(|ignored| ignored.to_string().contains(why));
        assert_eq!(told, !pair.is_empty() && !more.is_empty(), "{:?}", deck.ignored());
    }
}

/// The clearance of a contact pair is not that of a tie of the same surfaces.
#[test]
fn ties_have_no_clearance() {
    let tie = "*TIE, ADJUST=NO, POSITION TOLERANCE=0.1\nS15, S6\n";
    let both = |more: &str| {
        read(&text(1.01, "", &format!("{tie}{more}")))
            .expect("deck")
            .scene()
            .expect("scene")
    };
    let plain = both("");
    let clear = both("*CLEARANCE, SLAVE=S15, MASTER=S6, VALUE=0.03\n");
    let told = |contact| format!("{contact:?}");
    let [plain, clear] = [plain.contacts(), clear.contacts()].map(|c| [told(&c[0]), told(&c[1])]);
    assert!(plain[0] != clear[0] && plain[1] == clear[1], "{clear:?}");
}

/// A negative clearance is a press fit: the sides part by it, wherever they are.
#[test]
fn a_negative_clearance_is_a_press_fit() {
    let (deck, result) = cubes(1.01, "", "*CLEARANCE, SLAVE=S15, MASTER=S6, VALUE=-0.003\n");
    let (points, moved) = (deck.mesh().points(), result.displacement());
    let below: Vec<usize> = (0..points.len()).filter(|n| points[*n][2] == 1.0).collect();
    assert_eq!(below.len(), 9);
    for n in below {
        let over = |p: &[f64; 3]| p[..2] == points[n][..2] && (p[2] - 1.01).abs() < 1e-9;
        let partner = points.iter().position(over).expect("a node above");
        let apart = moved[partner][2] - moved[n][2];
        assert!((apart - 0.003).abs() < 1e-9, "{apart}");
    }
    assert!(result.points().iter().all(|p| p.gap.abs() < 1e-9));
}
