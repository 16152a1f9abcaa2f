//! Steps: their times, supports and loads.

use std::fmt;

use super::mesh::target;
use super::property::Change;
use super::{Ignored, Model};
use crate::error::{DeckError, Fault, Word};
use crate::lexer::{Card, label, name};
use crate::tolerances::{CUT_BACKS, LEAST_INCREMENT, ROUNDING};

/// Why some settings are ignored.
pub(super) const SOLVER: &str = "a setting of another solver";

/// Most increments of a deck.
pub(crate) const INCREMENTS: f64 = 1e6;

/// A node or element by its number, a set by its name, or all there are.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Target {
    Number(u32),
    Name(String),
    All,
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => f.write_str(name),
            Self::All => f.write_str("all"),
        }
    }
}

/// A value and the position of its amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Given {
    pub(crate) value: f64,
    pub(crate) amplitude: Option<usize>,
}

/// What a line says of a target.
#[derive(Debug, Clone)]
pub(crate) struct Condition<K> {
    /// The word that names the target.
    pub(crate) word: Word,
    pub(crate) target: Target,
    pub(crate) kind: K,
    pub(crate) given: Given,
}

/// Components of nodes that are held, moved or loaded.
#[derive(Debug, Clone)]
pub(crate) struct Components {
    /// Those of displacement or force, then of rotation or moment, which nodes of rigid bodies and couplings have.
    pub(crate) on: [bool; 6],
    /// FIXED, where they stay as the steps before left them.
    pub(crate) fixed: Option<Word>,
    /// The word that asks for one of the latter by its number.
    pub(crate) rotation: Option<Word>,
}

/// A pressure, on elements or a surface, or a load of the volume.
#[derive(Debug, Clone)]
pub(crate) enum DistributedKind {
    /// Pressure on face 1 to 6 of elements.
    Face(u8),
    /// Pressure on a surface.
    Surface,
    /// Traction on a surface in a direction (not of unit length).
    Traction([f64; 3]),
    Volume(VolumeLaw),
}

impl DistributedKind {
    /// Whether it is one of *DSLOAD.
    fn on_surface(&self) -> bool {
        matches!(self, Self::Surface | Self::Traction(_))
    }
}

/// A load of the volume.
#[derive(Debug, Clone)]
pub(crate) enum VolumeLaw {
    /// Force per volume along a component.
    Force(usize),
    /// Acceleration in a direction (not of unit length).
    Gravity([f64; 3]),
    /// The square of an angular velocity about an axis: a point and its direction (not of unit length).
    Centrifugal([[f64; 3]; 2]),
}

/// What the cards of one kind of condition say in a step.
#[derive(Debug)]
pub(crate) struct Conditions<K> {
    /// The first card, or its OP, and whether it removes what was there before.
    pub(crate) first: Option<(Word, bool)>,
    pub(crate) lines: Vec<Condition<K>>,
}

impl<K> Default for Conditions<K> {
    fn default() -> Self {
        let (first, lines) = (None, Vec::new());
        Self { first, lines }
    }
}

impl<K> Conditions<K> {
    /// Notes the parameter OP of a card: that of the first one counts.
    pub(super) fn card(&mut self, card: &Card) -> Result<(), DeckError> {
        let wanted = "OP=MOD or OP=NEW";
        let new = card.choice("OP", &["MOD", "NEW"], wanted)? == Some(1);
        match &self.first {
            None => {
                let word = card.param("OP").map_or(&card.word, |p| &p.word).clone();
                self.first = Some((word, new));
            }
            Some((_, before)) if new != *before && card.param("OP").is_some() => {
                let why = "only the first card of its kind in a step can say OP, and it says another; move \
                it to that card";
                return Err(card.word.cannot(why));
            }
            Some(_) => {}
        }
        Ok(())
    }

    /// Whether what was there before is removed.
    pub(crate) fn removes(&self) -> bool {
        self.first.as_ref().is_some_and(|first| first.1)
    }
}

/// Equal increments, the last one shorter if they do not add up to the period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Increments {
    pub(crate) size: f64,
    pub(crate) period: f64,
    pub(crate) count: usize,
    /// How often one may be halved without being shorter than the least one.
    pub(crate) halvings: u32,
}

impl Increments {
    /// Time of the end of an increment (from 1) after the beginning of the step.
    pub(crate) fn time(&self, i: usize) -> f64 {
        let all = self.count as f64 * self.size;
        if i >= self.count {
            self.period
        } else if (all - self.period).abs() <= ROUNDING * self.period {
            self.period * i as f64 / self.count as f64
        } else {
            self.size * i as f64
        }
    }
}

/// A step of the deck: a span of time with increments.
#[derive(Debug)]
pub(crate) struct Step {
    pub(crate) word: Word,
    /// Whether loads without an amplitude grow along a straight line; else they jump.
    pub(crate) ramp: bool,
    increments: Option<(f64, Word)>,
    /// The procedure, and its increments.
    pub(crate) time: Option<(Word, Increments)>,
    pub(crate) boundary: Conditions<Components>,
    pub(crate) forces: Conditions<Components>,
    pub(crate) distributed: Conditions<DistributedKind>,
    /// Whether it has *DLOAD, and *DSLOAD.
    loaded_by: [bool; 2],
    pub(crate) temperatures: Conditions<()>,
    /// Contact pairs that come or go.
    pub(crate) changes: Vec<Change>,
}

impl Step {
    pub(super) fn new(model: &mut Model, card: &Card) -> Result<Self, DeckError> {
        card.allow(&["NAME", "INC", "NLGEOM", "AMPLITUDE", "UNSYMM", "PERTURBATION"])?;
        if let Some(param) = card.param("NLGEOM")
            && !card
                .value("NLGEOM")
                .is_ok_and(|value| value.is_some_and(|v| v.name == "NO"))
        {
            let why = "displacements and rotations are small here; remove it, or write NLGEOM=NO";
            return Err(param.word.fault(Fault::Unsupported(why)));
        }
        if let Some(param) = card.param("PERTURBATION") {
            let why = "contact is not linear, and a perturbation is; make it a step of its own";
            return Err(param.word.fault(Fault::Unsupported(why)));
        }
        if let Some(param) = card.param("UNSYMM") {
            model.ignored.push(Ignored::new(&param.word, SOLVER));
        }
        let amplitude = card.choice("AMPLITUDE", &["RAMP", "STEP"], "RAMP or STEP")?;
        let mut increments = None;
        if let Some(param) = card.param("INC") {
            let number = param.value.as_deref().and_then(|v| label(v.trim()));
            let number = number.ok_or_else(|| param.word.expected("a number of increments"))?;
            increments = Some((f64::from(number), param.word.clone()));
        }
        Ok(Self {
            word: Word::new(&card.word.location, "*STEP"),
            ramp: amplitude != Some(1),
            increments,
            time: None,
            boundary: Conditions::default(),
            forces: Conditions::default(),
            distributed: Conditions::default(),
            loaded_by: [false; 2],
            temperatures: Conditions::default(),
            changes: Vec::new(),
        })
    }

    /// `*STATIC`.
    pub(super) fn procedure(&mut self, model: &mut Model, card: &Card) -> Result<(), DeckError> {
        card.allow(&["DIRECT", "SOLVER"])?;
        card.flag("DIRECT")?;
        if let Some(param) = card.param("SOLVER") {
            model.ignored.push(Ignored::new(&param.word, SOLVER));
        }
        if let Some((first, _)) = &self.time {
            let first = first.location.clone();
            let remedy = "a step has one procedure; begin another *STEP";
            return Err(card.word.fault(Fault::Repeated { first, remedy }));
        }
        let wanted = "first increment, period, least and largest increment: positive numbers, or 0 for the default";
        card.lines_at_most(1, wanted)?;
        let mut values = [None; 4];
        if let Some(line) = card.lines.first() {
            let fields = line.at_most(5, wanted)?;
            for (at, value) in values.iter_mut().enumerate() {
                // zero is the default
                *value = line.optional(&fields, at, wanted)?.filter(|v| *v != 0.0);
                if value.is_some_and(|v| v < 0.0) {
                    return Err(line.part(fields[at]).expected(wanted));
                }
            }
            if let Some(extra) = fields.get(4) {
                line.optional(&fields, 4, wanted)?;
                model.ignored.push(Ignored::new(&line.part(extra), SOLVER));
            }
        }
        let period = values[1].unwrap_or(1.0);
        let largest = values[3].unwrap_or(period);
        let increment = values[0].unwrap_or(period).min(largest).min(period);
        let count = (period / increment * (1.0 - ROUNDING)).ceil();
        if count > INCREMENTS {
            return Err(card.lines.first().unwrap_or(&card.word).fault(Fault::TooMany {
                what: "increments",
                most: INCREMENTS as u64,
                remedy: "make the first increment larger",
            }));
        }
        if let Some((most, word)) = &self.increments
            && count > *most
        {
            return Err(word.cannot(format!(
                "the step needs {count} increments of {increment}; raise INC or the increment"
            )));
        }
        let least = values[2].unwrap_or(LEAST_INCREMENT * period);
        let halvings = if card.param("DIRECT").is_some() {
            0
        } else {
            // what is negative becomes 0
            ((increment / least).log2() + ROUNDING) as u32
        };
        let increments = Increments {
            size: increment,
            period,
            count: count.max(1.0) as usize,
            halvings: halvings.min(CUT_BACKS),
        };
        self.time = Some((Word::new(&card.word.location, "*STATIC"), increments));
        Ok(())
    }

    /// Tells that OP=NEW takes away loads of earlier steps by a keyword that this step does not have.
    pub(super) fn tell_removed(&self, model: &mut Model) {
        let Some((word, true)) = &self.distributed.first else {
            return;
        };
        let whys = [
            "that Abaqus keeps the loads of *DLOAD then; as in CalculiX they are removed, too",
            "that Abaqus keeps the loads of *DSLOAD then; as in CalculiX they are removed, too",
        ];
        // those that an earlier step has removed are gone
        let removes = |step: &Step| matches!(step.distributed.first, Some((_, true)));
        let from = model.steps.iter().rposition(removes).unwrap_or(0);
        for (on_surface, why) in [false, true].into_iter().zip(whys) {
            let mut before = model.steps[from..].iter().flat_map(|step| &step.distributed.lines);
            if !self.loaded_by[usize::from(on_surface)] && before.any(|line| line.kind.on_surface() == on_surface) {
                model.ignored.push(Ignored::new(word, why));
            }
        }
    }
}

/// The position of the amplitude that a card names.
pub(super) fn amplitude(model: &Model, card: &Card) -> Result<Option<usize>, DeckError> {
    let named = card.value("AMPLITUDE")?;
    let position = named.map(|n| model.amplitudes.find("amplitude", &n.name, &n.word));
    position.transpose()
}

/// `*BOUNDARY`, in a step or before the first.
pub(super) fn boundary(model: &mut Model, step: Option<&mut Step>, card: &Card) -> Result<(), DeckError> {
    card.allow(match &step {
        Some(_) => &["OP", "AMPLITUDE", "TYPE", "FIXED"],
        None => &["TYPE"],
    })?;
    card.choice("TYPE", &["DISPLACEMENT"], "DISPLACEMENT; other types are not supported")?;
    let amplitude = amplitude(model, card)?;
    let mut lines = Vec::with_capacity(card.lines.len());
    for line in &card.lines {
        let mut given = boundary_line(line, amplitude)?;
        given.kind.fixed = card.param("FIXED").map(|param| param.word.clone());
        lines.push(given);
    }
    match step {
        Some(step) => {
            step.boundary.card(card)?;
            step.boundary.lines.append(&mut lines);
        }
        None => model.supports.append(&mut lines),
    }
    Ok(())
}

/// What a component of a support is.
pub(crate) const COMPONENT: &str = "a component: 1, 2 or 3 (solid elements have no rotations), ENCASTRE, \
PINNED, XSYMM, XASYMM and so on for y and z";

fn boundary_line(line: &Word, amplitude: Option<usize>) -> Result<Condition<Components>, DeckError> {
    let wanted = "a node or node set, first and last component (1 to 3), and a value";
    let fields = line.at_most(4, wanted)?;
    let target = target(line, fields[0])?;
    let by_name = match name(fields.get(1).unwrap_or(&"")).as_str() {
        "ENCASTRE" => Some([1, 1, 1, 1, 1, 1]),
        "PINNED" => Some([1, 1, 1, 0, 0, 0]),
        "XSYMM" => Some([1, 0, 0, 0, 1, 1]),
        "YSYMM" => Some([0, 1, 0, 1, 0, 1]),
        "ZSYMM" => Some([0, 0, 1, 1, 1, 0]),
        "XASYMM" => Some([0, 1, 1, 1, 0, 0]),
        "YASYMM" => Some([1, 0, 1, 0, 1, 0]),
        "ZASYMM" => Some([1, 1, 0, 0, 0, 1]),
        _ => None,
    };
    let mut rotation = None;
    let (on, value) = match by_name {
        Some(on) => {
            if let Some(extra) = fields.get(2) {
                return Err(line.part(extra).expected("nothing after the name of a condition"));
            }
            (on.map(|on| on == 1), 0.0)
        }
        None => {
            let mut component = |at: usize| match fields.get(at).and_then(|text| label(text)) {
                Some(number @ 1..=6) => {
                    if number > 3 {
                        rotation = Some(line.part(fields[at]));
                    }
                    Ok(number as usize - 1)
                }
                _ => Err(line.entry(&fields, at).expected(COMPONENT)),
            };
            let first = component(1)?;
            let last = match fields.get(2) {
                None | Some(&"") => first,
                Some(_) => component(2)?,
            };
            if last < first {
                return Err(line.part(fields[2]).expected("a last component not below the first"));
            }
            let value = line.optional(&fields, 3, "a displacement, a finite number")?;
            let on = [0, 1, 2, 3, 4, 5].map(|c| (first..=last).contains(&c));
            (on, value.unwrap_or(0.0))
        }
    };
    Ok(Condition {
        word: line.part(fields[0]),
        target,
        kind: Components {
            on,
            fixed: None,
            rotation,
        },
        given: Given { value, amplitude },
    })
}

/// What a line of `*CLOAD` is.
pub(crate) const FORCE: &str = "a node or node set, a component 1, 2 or 3 (4 to 6, moments, have the nodes of *COUPLING), \
and a force";

/// `*CLOAD`.
pub(super) fn forces(model: &Model, step: &mut Step, card: &Card) -> Result<(), DeckError> {
    card.allow(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(model, card)?;
    step.forces.card(card)?;
    for line in &card.lines {
        let wanted = FORCE;
        let fields = line.at_most(3, wanted)?;
        let target = target(line, fields[0])?;
        let number = match fields.get(1).and_then(|f| label(f)) {
            Some(number @ 1..=6) => number as usize,
            _ => return Err(line.entry(&fields, 1).expected(wanted)),
        };
        step.forces.lines.push(Condition {
            word: line.part(fields[0]),
            target,
            kind: Components {
                on: [1, 2, 3, 4, 5, 6].map(|c| c == number),
                fixed: None,
                rotation: (number > 3).then(|| line.part(fields[1])),
            },
            given: Given {
                value: line.real(&fields, 2, wanted)?,
                amplitude,
            },
        });
    }
    Ok(())
}

/// `*DLOAD`, and `*DSLOAD` with `on_surface`.
pub(super) fn distributed(model: &Model, step: &mut Step, card: &Card, on_surface: bool) -> Result<(), DeckError> {
    card.allow(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(model, card)?;
    step.distributed.card(card)?;
    step.loaded_by[usize::from(on_surface)] = true;
    for line in &card.lines {
        let wanted = if on_surface {
            "a surface, P, and a pressure, or TRVEC, a traction, and its direction"
        } else {
            "an element or element set, one of P1 to P6, GRAV, CENTRIF, BX, BY, BZ, a value, with GRAV a direction, \
            and with CENTRIF, whose value is the square of the angular velocity, a point and the direction of the axis"
        };
        let fields = line.at_most(9, wanted)?;
        let label = name(fields.get(1).unwrap_or(&""));
        let (kind, count) = match (on_surface, label.as_bytes()) {
            (true, b"P") => (DistributedKind::Surface, 3),
            (true, b"TRVEC") => (DistributedKind::Traction(vector(line, &fields, 3)?), 6),
            (false, [b'P', face @ b'1'..=b'6']) => (DistributedKind::Face(face - b'0'), 3),
            (false, [b'B', axis @ b'X'..=b'Z']) => {
                let axis = usize::from(axis - b'X');
                (DistributedKind::Volume(VolumeLaw::Force(axis)), 3)
            }
            (false, b"GRAV") => (
                DistributedKind::Volume(VolumeLaw::Gravity(vector(line, &fields, 3)?)),
                6,
            ),
            (false, b"CENTRIF") => {
                let point = line.reals(&fields, 3, "a point of the axis: three numbers")?;
                let axis = [point, vector(line, &fields, 6)?];
                (DistributedKind::Volume(VolumeLaw::Centrifugal(axis)), 9)
            }
            _ => return Err(line.entry(&fields, 1).expected(wanted)),
        };
        let value = line.real(&fields, 2, wanted)?;
        if let Some(extra) = fields.get(count) {
            return Err(line.part(extra).expected(wanted));
        }
        if label == "CENTRIF" && value < 0.0 {
            return Err(line
                .part(fields[2])
                .expected("the square of an angular velocity, not negative"));
        }
        let target = match (on_surface, &kind) {
            (true, _) => Target::Name(name(fields[0])),
            // without a set Abaqus loads the whole model
            (false, DistributedKind::Volume(_)) if fields[0].is_empty() => Target::All,
            (false, _) => target(line, fields[0])?,
        };
        step.distributed.lines.push(Condition {
            word: line.entry(&fields, 0),
            target,
            kind,
            given: Given { value, amplitude },
        });
    }
    Ok(())
}

/// A direction, by its three numbers.
fn vector(line: &Word, fields: &[&str], at: usize) -> Result<[f64; 3], DeckError> {
    let wanted = "a direction that is not zero: three numbers";
    let direction: [f64; 3] = line.reals(fields, at, wanted)?;
    let length = direction.iter().map(|d| d * d).sum::<f64>();
    if length > 0.0 && length.is_finite() {
        Ok(direction)
    } else {
        Err(line.expected(wanted))
    }
}
