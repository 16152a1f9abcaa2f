//! Gaps of contact pairs that a deck prescribes or closes.

use signorini_contact::{Settings, Simulation};
use signorini_fem_mesh::{Brick, FacetTag};

use crate::write::{STEEL, mesh, read};

/// The gaps of two cubes that rest, one 0.01 m above the other.
fn gaps(pair: &str, more: &str) -> (Vec<f64>, usize) {
    let below = Brick::new([1.0; 3], [2, 2, 2]).build().expect("brick");
    let above = below.map_points(|[x, y, z]| [x, y, z + 1.01]).expect("lifted");
    let both = below.append(&above.map_tags(|tag| FacetTag(tag.0 + 10))).expect("two");
    let deck = format!(
        "{}{STEEL}*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I{pair}\nS15, S6\n{more}\
        *BOUNDARY\nN5, 1, 3\nN16, 1, 3\n*STEP\n*STATIC\n*END STEP\n",
        mesh(&both)
    );
    let deck = read(&deck).expect("deck");
    let mut simulation = Simulation::new(deck.scene().expect("scene"), Settings::default()).expect("simulation");
    let result = simulation.step().expect("solved");
    (result.points().iter().map(|p| p.gap).collect(), deck.ignored().len())
}

#[test]
fn gaps_are_measured_prescribed_or_closed() {
    let clearance = "*CLEARANCE, SLAVE=S15, MASTER=S6, VALUE=0.03\n";
    for (pair, more, exact, ignored) in [
        ("", "", 0.01, 0),
        (", ADJUST=0.005", "", 0.01, 1),
        (", ADJUST=0.02", "", 0.0, 1),
        ("", clearance, 0.03, 0),
        (", ADJUST=0.02", clearance, 0.03, 0),
    ] {
        let (gaps, count) = gaps(pair, more);
        assert_eq!((gaps.len(), count), (9, ignored), "{pair}{more}");
        assert!(
            gaps.iter().all(|gap| (gap - exact).abs() < 1e-9),
            "{pair}{more} {gaps:?}"
        );
    }
}
