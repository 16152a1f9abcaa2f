//! Which keyword is read by whom, where it may stand, and what is said about the others.

use std::borrow::Cow;

use super::assembly::Assembly;
use super::step::{self, SOLVER, Step};
use super::{Ignored, Model, coupling, elastic, equation, mesh, orientation, property, temperature, transform};
use crate::error::{DeckError, Fault};
use crate::lexer::Card;

/// What is read, as an error lists it.
const READ: &str = "*HEADING, *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE, *MATERIAL, *ELASTIC, *DENSITY, *EXPANSION, \
*INITIAL CONDITIONS, *TEMPERATURE, *SOLID SECTION, *ORIENTATION, *TRANSFORM, *BOUNDARY, *CLOAD, *DLOAD, *DSLOAD, *AMPLITUDE, *CONTACT PAIR, \
*CLEARANCE, *TIE, *RIGID BODY, *COUPLING, *DISTRIBUTING, *KINEMATIC, *PRE-TENSION SECTION, *EQUATION, *MPC, *PART, *ASSEMBLY, *INSTANCE, \
*SURFACE INTERACTION, *SURFACE BEHAVIOR, *FRICTION, *STEP, *STATIC, *MODEL CHANGE, *END STEP, *INCLUDE, and requests for output, \
which are ignored and reported";

/// Requests for output, which ask nothing of the solution.
const OUTPUT: &str = "NODEFILE NODEPRINT NODEOUTPUT ELFILE ELPRINT ELEMENTOUTPUT CONTACTFILE CONTACTPRINT \
CONTACTOUTPUT FACEPRINT SECTIONPRINT ENERGYFILE ENERGYPRINT ENERGYOUTPUT OUTPUT FILEFORMAT PREPRINT MONITOR PRINT \
TIMEPOINTS FILTER INTEGRATEDOUTPUT";

/// Other keywords that ask nothing of the solution here, and why.
const IDLE: [(&str, &str); 4] = [
    ("CONTROLS CONTACTCONTROLS SECTIONCONTROLS", SOLVER),
    (
        "CONDUCTIVITY ELECTRICALCONDUCTIVITY GAPCONDUCTANCE GAPHEATGENERATION SPECIFICHEAT",
        "temperatures are given here, not computed",
    ),
    ("DAMPING", "steps are static"),
    ("PHYSICALCONSTANTS", "nothing depends on these numbers here"),
];

/// Parameters of keywords, likewise.
const IDLE_PARAMETERS: [(&str, &str, &str); 12] = [
    ("STEP", "EXTRAPOLATION", SOLVER),
    ("STEP", "CONVERTSDI", SOLVER),
    ("STATIC", "STABILIZE", SOLVER),
    ("STATIC", "ALLSDTOL", SOLVER),
    ("STATIC", "FACTOR", SOLVER),
    ("SOLIDSECTION", "CONTROLS", SOLVER),
    ("SURFACEBEHAVIOR", "AUGMENTEDLAGRANGE", SOLVER),
    ("SURFACEBEHAVIOR", "DIRECT", SOLVER),
    ("SURFACEBEHAVIOR", "PENALTY", SOLVER),
    ("FRICTION", "LAGRANGE", SOLVER),
    ("CONTACTPAIR", "MECHANICALCONSTRAINT", SOLVER),
    ("CONTACTPAIR", "NOTHICKNESS", "solid elements have no thickness"),
];

/// Keywords of these programs that have no counterpart here, and what to do.
const REFUSED: [(&str, &str); 7] = [
    (
        "DISTRIBUTINGCOUPLING KINEMATICCOUPLING",
        "couplings are read of surfaces; give *COUPLING and behind it *DISTRIBUTING or *KINEMATIC",
    ),
    ("PLASTIC CREEP HYPERELASTIC", "materials are linear and elastic"),
    (
        "SHELLSECTION BEAMSECTION MEMBRANESECTION SPRING MASS",
        "only solid elements are read",
    ),
    ("CHANGEFRICTION", "coefficients of friction hold for all steps"),
    (
        "CONTACTINTERFERENCE",
        "overlaps press from the first step on; give that of a pair by *CLEARANCE, negative",
    ),
    (
        "CONTACT",
        "general contact is not here; name the surfaces that may touch with *CONTACT PAIR",
    ),
    (
        "DYNAMIC FREQUENCY BUCKLE HEATTRANSFER VISCO COUPLEDTEMPERATURE-DISPLACEMENT UNCOUPLEDTEMPERATURE-DISPLACEMENT",
        "only *STATIC is solved",
    ),
];

/// Parameters of keywords that are read, likewise.
const PARAMETERS: [(&str, &str, &str); 5] = [
    ("COUPLING", "ORIENTATION", "components are along x, y, z; remove it"),
    ("EQUATION", "REMOVE", "equations hold for all steps; remove their lines"),
    (
        "EQUATION",
        "INPUT",
        "data of equations stand in the deck; put them there, or *INCLUDE the file",
    ),
    (
        "FRICTION",
        "ROUGH",
        "friction slides at some force; give a large coefficient",
    ),
    (
        "FRICTION",
        "TAUMAX",
        "friction has the limit of Coulomb alone; remove it",
    ),
];

const BEFORE: &str = "this belongs to the model; put it before the first *STEP";
const INSIDE: &str = "this belongs to a step; put it between *STEP and *END STEP";

/// The model that cards describe.
pub(crate) fn read(cards: &[Card]) -> Result<Model, DeckError> {
    let mut model = Model::default();
    let mut step: Option<Step> = None;
    let mut assembly = Assembly::new(cards);
    for card in cards {
        let card = &*without_idle(&mut model, card);
        let begun = step.is_some() || !model.steps.is_empty();
        if begun || !assembly.take(&mut model, card)? {
            read_card(&mut model, &mut step, card)?;
        }
    }
    assembly.end()?;
    match step {
        Some(step) => Err(step.word.cannot("the step does not end; put *END STEP after it")),
        None => Ok(model),
    }
}

/// A card without the parameters that ask nothing, which are noted.
fn without_idle<'a>(model: &mut Model, card: &'a Card) -> Cow<'a, Card> {
    let mut kept = Cow::Borrowed(card);
    for (_, key, why) in IDLE_PARAMETERS.iter().filter(|idle| idle.0 == card.key) {
        if let Some(param) = card.param(key) {
            model.ignored.push(Ignored::new(&param.word, *why));
            kept = Cow::Owned(kept.without(key));
        }
    }
    kept
}

fn read_card(model: &mut Model, current: &mut Option<Step>, card: &Card) -> Result<(), DeckError> {
    for (_, name, why) in PARAMETERS.iter().filter(|(key, ..)| *key == card.key) {
        if let Some(param) = card.param(name) {
            return Err(param.word.fault(Fault::Unsupported(why)));
        }
    }
    type OfModel = fn(&mut Model, &Card) -> Result<(), DeckError>;
    let of_model: Option<OfModel> = match card.key.as_str() {
        "HEADING" => Some(|_, card| card.allow(&[])),
        "NODE" => Some(mesh::nodes),
        "ELEMENT" => Some(mesh::elements),
        "NSET" => Some(|model, card| mesh::set(model, card, "NSET")),
        "ELSET" => Some(|model, card| mesh::set(model, card, "ELSET")),
        "SURFACE" => Some(mesh::surface),
        "MATERIAL" => Some(property::material),
        "ELASTIC" => Some(elastic::elastic),
        "DENSITY" => Some(property::density),
        "EXPANSION" => Some(temperature::expansion),
        "INITIALCONDITIONS" => Some(temperature::initial),
        "SOLIDSECTION" => Some(property::section),
        "ORIENTATION" => Some(orientation::orientation),
        "AMPLITUDE" => Some(property::amplitude),
        "SURFACEINTERACTION" => Some(property::interaction),
        "SURFACEBEHAVIOR" => Some(property::behavior),
        "FRICTION" => Some(property::friction),
        "CONTACTPAIR" => Some(property::pair),
        "CLEARANCE" => Some(property::clearance),
        "TIE" => Some(property::tie),
        "RIGIDBODY" => Some(property::rigid),
        "COUPLING" => Some(coupling::coupling),
        "DISTRIBUTING" => Some(|model, card| coupling::law(model, card, false)),
        "KINEMATIC" => Some(|model, card| coupling::law(model, card, true)),
        "PRE-TENSIONSECTION" => Some(coupling::pretension),
        "EQUATION" => Some(equation::equation),
        "MPC" => Some(equation::mpc),
        "TRANSFORM" => Some(transform::transform),
        // they come here only after a step has begun
        "PART" | "ENDPART" | "ASSEMBLY" | "ENDASSEMBLY" | "INSTANCE" | "ENDINSTANCE" => {
            return Err(card.word.cannot(BEFORE));
        }
        _ => None,
    };
    if let Some(read) = of_model {
        if current.is_some() || !model.steps.is_empty() {
            return Err(card.word.cannot(BEFORE));
        }
        return read(model, card);
    }
    match (card.key.as_str(), current.as_mut()) {
        ("BOUNDARY", None) if !model.steps.is_empty() => Err(card.word.cannot(INSIDE)),
        ("BOUNDARY", step) => step::boundary(model, step, card),
        ("STEP", None) => {
            *current = Some(Step::new(model, card)?);
            Ok(())
        }
        ("STEP", Some(_)) => {
            let why = "the step before has not ended; put *END STEP before this one";
            Err(card.word.cannot(why))
        }
        ("STATIC" | "CLOAD" | "DLOAD" | "DSLOAD" | "TEMPERATURE" | "MODELCHANGE" | "ENDSTEP", None) => {
            Err(card.word.cannot(INSIDE))
        }
        ("STATIC", Some(step)) => step.procedure(model, card),
        ("CLOAD", Some(step)) => step::forces(model, step, card),
        ("DLOAD", Some(step)) => step::distributed(model, step, card, false),
        ("DSLOAD", Some(step)) => step::distributed(model, step, card, true),
        ("TEMPERATURE", Some(step)) => temperature::temperatures(model, step, card),
        ("MODELCHANGE", Some(step)) => {
            step.changes.append(&mut property::changes(card)?);
            Ok(())
        }
        ("ENDSTEP", Some(step)) => {
            card.allow(&[])?;
            card.lines_at_most(0, "no data")?;
            if step.time.is_none() {
                return Err(step.word.cannot("the step has no procedure; put *STATIC into it"));
            }
            step.tell_removed(model);
            model.steps.extend(current.take());
            Ok(())
        }
        (key, _) => other(model, card, key),
    }
}

/// Output is noted, anything else refused.
fn other(model: &mut Model, card: &Card, key: &str) -> Result<(), DeckError> {
    let among = |keys: &str| keys.split_whitespace().any(|known| known == key);
    let restart = key == "RESTART" && card.param("READ").is_none();
    let idle = IDLE.iter().find(|(keys, _)| among(keys));
    let why = if among(OUTPUT) || restart {
        "results are those that the program writes which runs the deck"
    } else if let Some((_, why)) = idle {
        why
    } else if key == "RESTART" {
        let why = "a run is resumed from a state of this library, not from a restart file";
        return Err(card.word.fault(Fault::Unsupported(why)));
    } else {
        let refused = REFUSED.iter().find(|(keys, _)| among(keys));
        return Err(card.word.fault(match refused {
            Some((_, why)) => Fault::Unsupported(why),
            None => Fault::UnknownKeyword { known: READ.into() },
        }));
    };
    model.ignored.push(Ignored::new(&card.word, why));
    Ok(())
}
