//! Tied surfaces that are apart: as far as CalculiX ties them they are tied, with a word where it would move nodes.

use signorini_deck::{Deck, DeckError};
use signorini_fem_mesh::{Brick, FacetTag};

use crate::write::{self, read};

/// A block above a coarser one, `gap` apart, tied by this card.
fn tied(gap: f64, card: &str) -> Result<Deck, DeckError> {
    let brick = |n| Brick::new([1.0; 3], [n; 3]).build().expect("brick");
    let above = brick(3).map_points(|[x, y, z]| [x, y, z + 1.0 + gap]).expect("lifted");
    let mesh = brick(2).append(&above.map_tags(|t| FacetTag(t.0 + 10))).expect("two");
    read(&(write::mesh(&mesh) + write::STEEL + card + "\nS15, S6\n*BOUNDARY\nN5, 1, 3\n*STEP\n*STATIC\n*END STEP\n"))
}

#[test]
fn what_is_too_far_is_refused() {
    // a fortieth of the radius of the circle in triangles with legs of 0.5
    for (gap, tolerance, good) in [
        (0.0, "", true),
        (3e-3, "", true),
        (4.5e-3, "", false),
        (-4.5e-3, "", false),
        (0.1, "", false),
        (0.1, ", POSITION TOLERANCE=0.11", true),
        (0.1, ", POSITION TOLERANCE=0.09", false),
        (0.1, ", POSITION TOLERANCE=1e-11", false),
    ] {
        for adjust in ["", ", ADJUST=YES", ", ADJUST=NO"] {
            let card = format!("*TIE, NAME=T{tolerance}{adjust}");
            match tied(gap, &card) {
                Ok(deck) => {
                    assert!(good, "{gap} {card}");
                    let told: Vec<String> = deck.ignored().iter().map(ToString::to_string).collect();
                    let moves = gap > 0.0 && adjust != ", ADJUST=NO";
                    assert_eq!(told.len(), usize::from(moves), "{told:?}");
                    assert!(
                        told.iter().all(|t| t.contains("are not moved onto S6: node")),
                        "{told:?}"
                    );
                }
                Err(error) => {
                    assert!(!good, "{gap} {card}: {error}");
                    let text = error.to_string();
                    assert!(
                        text.contains("S15: node") && text.contains("larger POSITION TOLERANCE"),
                        "{text}"
                    );
                }
            }
        }
    }
}

/// Nodes beside the other surface are tied by nobody.
#[test]
fn a_surface_may_be_larger() {
    let brick = |n| Brick::new([1.0; 3], [n; 3]).build().expect("brick");
    let above = brick(3)
        .map_points(|[x, y, z]| [3.0 * x - 1.0, y, z + 1.0])
        .expect("lifted");
    let mesh = brick(2).append(&above.map_tags(|t| FacetTag(t.0 + 10))).expect("two");
    let deck = read(&(write::mesh(&mesh) + write::STEEL + "*TIE, NAME=T\nS15, S6\n"));
    assert!(deck.expect("deck").ignored().is_empty());
}

/// An interaction that ties makes ties of its contact pairs, with no gap to give.
#[test]
fn a_tied_interaction_is_a_tie() {
    let card = |more: &str| {
        format!(
            "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1e7\n*FRICTION\n0.1, 1e6\n{more}\
             *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE"
        )
    };
    let [by_contact, by_tie] = [card(""), "*TIE, NAME=T".to_owned()].map(|card| tied(0.0, &card).expect("deck"));
    let told: Vec<String> = by_contact.ignored().iter().map(ToString::to_string).collect();
    assert!(told.iter().any(|t| t.contains("PRESSURE-OVERCLOSURE=TIED")), "{told:?}");
    let [own, other] = [by_contact, by_tie].map(|deck| deck.scene().expect("scene").contacts().to_vec());
    assert_eq!(format!("{own:?}"), format!("{other:?}"));
    assert!(tied(0.1, &card("")).is_err());
    let error = tied(0.0, &card("*CLEARANCE, SLAVE=S15, MASTER=S6, VALUE=0.1\n")).expect_err("a gap");
    assert!(error.to_string().contains("remove their *CLEARANCE"), "{error}");
}
