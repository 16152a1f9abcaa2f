//! Steps: their times, supports and loads.

use super::mesh::target;
use super::{Ignored, Model};
use crate::error::{DeckError, Fault, Location};
use crate::lexer::{Card, Line, label, name};

/// Most increments of a deck.
pub(crate) const INCREMENTS: f64 = 1e6;

/// A node or element by its number, or a set by its name.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Target {
    Number(u32),
    Name(String),
}

/// Components of nodes that are held or moved.
#[derive(Debug, Clone)]
pub(crate) struct Boundary {
    pub(crate) location: Location,
    pub(crate) word: String,
    pub(crate) target: Target,
    /// Displacements, then rotations, which nodes of rigid bodies have.
    pub(crate) components: [bool; 6],
    /// The word that asks for a rotation by its number.
    pub(crate) rotation: Option<String>,
    pub(crate) value: f64,
    /// Position of the amplitude.
    pub(crate) amplitude: Option<usize>,
}

/// A force at nodes.
#[derive(Debug, Clone)]
pub(crate) struct Force {
    pub(crate) location: Location,
    pub(crate) word: String,
    pub(crate) target: Target,
    /// 0 to 2.
    pub(crate) component: usize,
    pub(crate) value: f64,
    pub(crate) amplitude: Option<usize>,
}

#[derive(Debug, Clone)]
pub(crate) enum DistributedKind {
    /// Pressure on face 1 to 4 of elements.
    Face(u8),
    /// Pressure on a surface.
    Surface,
    /// Acceleration in a direction (not of unit length).
    Gravity([f64; 3]),
    /// Force per volume along a component.
    Body(usize),
}

/// A pressure or a load of the volume.
#[derive(Debug, Clone)]
pub(crate) struct Distributed {
    pub(crate) location: Location,
    pub(crate) word: String,
    /// Elements, or the surface.
    pub(crate) target: Target,
    pub(crate) kind: DistributedKind,
    pub(crate) value: f64,
    pub(crate) amplitude: Option<usize>,
}

/// What the cards of one kind of condition say in a step.
#[derive(Debug)]
pub(crate) struct Conditions<T> {
    /// Where the first card is, and whether it removes what was there before.
    pub(crate) first: Option<(Location, String, bool)>,
    pub(crate) lines: Vec<T>,
}

impl<T> Default for Conditions<T> {
    fn default() -> Self {
        let (first, lines) = (None, Vec::new());
        Self { first, lines }
    }
}

impl<T> Conditions<T> {
    /// Notes the parameter OP of a card: that of the first one counts.
    fn card(&mut self, card: &Card) -> Result<(), DeckError> {
        let wanted = "OP=MOD or OP=NEW";
        let new = card.choice("OP", &["MOD", "NEW"], wanted)? == Some(1);
        match &self.first {
            None => {
                let word = card.param("OP").map_or(&card.word, |p| &p.word).clone();
                self.first = Some((card.location.clone(), word, new));
            }
            Some((_, _, before)) if new != *before && card.param("OP").is_some() => {
                let why = "only the first card of its kind in a step can say OP, and it says another; move \
                it to that card";
                return Err(card.fault(Fault::Misplaced(why)));
            }
            Some(_) => {}
        }
        Ok(())
    }

    /// Whether what was there before is removed.
    pub(crate) fn removes(&self) -> bool {
        self.first.as_ref().is_some_and(|first| first.2)
    }
}

/// Equal increments, the last one shorter if they do not add up to the period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Increments {
    pub(crate) size: f64,
    pub(crate) period: f64,
    pub(crate) count: usize,
}

impl Increments {
    /// Relative difference of increments that is rounding.
    const ROUNDING: f64 = 1e-9;

    /// Time of the end of an increment (from 1) after the beginning of the step.
    pub(crate) fn time(&self, i: usize) -> f64 {
        let all = self.count as f64 * self.size;
        if i >= self.count {
            self.period
        } else if (all - self.period).abs() <= Self::ROUNDING * self.period {
            self.period * i as f64 / self.count as f64
        } else {
            self.size * i as f64
        }
    }
}

/// A step of the deck: a span of time with increments.
#[derive(Debug)]
pub(crate) struct Step {
    pub(crate) location: Location,
    /// Whether loads without an amplitude grow along a straight line; else they jump.
    pub(crate) ramp: bool,
    increments: Option<(f64, Location, String)>,
    /// Where the procedure is, and its increments.
    pub(crate) time: Option<(Location, Increments)>,
    pub(crate) boundary: Conditions<Boundary>,
    pub(crate) forces: Conditions<Force>,
    pub(crate) distributed: Conditions<Distributed>,
}

impl Step {
    pub(super) fn new(model: &mut Model, card: &Card) -> Result<Self, DeckError> {
        card.allow(&["NAME", "INC", "NLGEOM", "AMPLITUDE", "UNSYMM", "PERTURBATION"])?;
        if let Some(param) = card.param("NLGEOM")
            && card.value("NLGEOM").ok().flatten().as_deref() != Some("NO")
        {
            let why = "displacements and rotations are small here; remove it, or write NLGEOM=NO";
            return Err(card.param_fault(param, Fault::Unsupported(why)));
        }
        if let Some(param) = card.param("PERTURBATION") {
            let why = "contact is not linear, and a perturbation is; make it a step of its own";
            return Err(card.param_fault(param, Fault::Unsupported(why)));
        }
        if let Some(param) = card.param("UNSYMM") {
            model
                .ignored
                .push(Ignored::new(&card.location, &param.word, "a setting of another solver"));
        }
        let amplitude = card.choice("AMPLITUDE", &["RAMP", "STEP"], "RAMP or STEP")?;
        let mut increments = None;
        if let Some(param) = card.param("INC") {
            let wanted = "a number of increments";
            let number = param.value.as_deref().and_then(|v| label(v.trim()));
            let number = number.ok_or_else(|| card.param_fault(param, Fault::Expected(wanted)))?;
            increments = Some((f64::from(number), card.location.clone(), param.word.clone()));
        }
        Ok(Self {
            location: card.location.clone(),
            ramp: amplitude != Some(1),
            increments,
            time: None,
            boundary: Conditions::default(),
            forces: Conditions::default(),
            distributed: Conditions::default(),
        })
    }

    /// `*STATIC`.
    pub(super) fn procedure(&mut self, model: &mut Model, card: &Card) -> Result<(), DeckError> {
        card.allow(&["DIRECT", "SOLVER"])?;
        card.flag("DIRECT")?;
        if let Some(param) = card.param("SOLVER") {
            model
                .ignored
                .push(Ignored::new(&card.location, &param.word, "a setting of another solver"));
        }
        if let Some((first, ..)) = &self.time {
            let first = first.line;
            let remedy = "a step has one procedure; begin another *STEP";
            return Err(card.fault(Fault::Repeated { first, remedy }));
        }
        let wanted = "first increment, period, least and largest increment: positive numbers";
        card.lines_at_most(1, wanted)?;
        let mut values = [None; 4];
        if let Some(line) = card.lines.first() {
            let fields = line.at_most(4, wanted)?;
            for (at, value) in values.iter_mut().enumerate() {
                *value = line.optional(&fields, at, wanted)?;
                // a largest increment of zero is none
                if value.is_some_and(|v| v < 0.0) || at < 2 && *value == Some(0.0) {
                    return Err(line.fault(fields[at], Fault::Expected(wanted)));
                }
            }
        }
        let period = values[1].unwrap_or(1.0);
        let largest = values[3].filter(|&v| v > 0.0).unwrap_or(period);
        let increment = values[0].unwrap_or(period).min(largest).min(period);
        let count = (period / increment * (1.0 - Increments::ROUNDING)).ceil();
        let (location, word) = match card.lines.first() {
            Some(line) => (&line.location, line.text.as_str()),
            None => (&card.location, card.word.as_str()),
        };
        if count > INCREMENTS {
            let fault = Fault::TooMany {
                what: "increments",
                most: INCREMENTS as u64,
                remedy: "make the first increment larger",
            };
            return Err(DeckError::at(location, word, fault));
        }
        if let Some((most, location, word)) = &self.increments
            && count > *most
        {
            let text = format!("the step needs {count} increments of {increment}; raise INC or the increment");
            return Err(DeckError::at(location, word, Fault::Cannot(text)));
        }
        let increments = Increments {
            size: increment,
            period,
            count: count.max(1.0) as usize,
        };
        self.time = Some((card.location.clone(), increments));
        Ok(())
    }
}

/// The position of the amplitude that a card names.
fn amplitude(model: &Model, card: &Card) -> Result<Option<usize>, DeckError> {
    let Some((name, param)) = card.value("AMPLITUDE")?.zip(card.param("AMPLITUDE")) else {
        return Ok(None);
    };
    let at = (&card.location, param.word.as_str());
    model.amplitudes.find("amplitude", &name, at).map(Some)
}

/// `*BOUNDARY`, in a step or before the first.
pub(super) fn boundary(model: &mut Model, step: Option<&mut Step>, card: &Card) -> Result<(), DeckError> {
    card.allow(match &step {
        Some(_) => &["OP", "AMPLITUDE", "TYPE"],
        None => &["TYPE"],
    })?;
    card.choice("TYPE", &["DISPLACEMENT"], "DISPLACEMENT; other types are not supported")?;
    let amplitude = amplitude(model, card)?;
    let mut lines = Vec::with_capacity(card.lines.len());
    for line in &card.lines {
        let given = boundary_line(line, amplitude)?;
        if step.is_none() && given.value != 0.0 {
            let why = "before the first *STEP a support cannot move; give its value in a step";
            return Err(line.fault(line.text.trim(), Fault::Misplaced(why)));
        }
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
PINNED, XSYMM, YSYMM or ZSYMM";

fn boundary_line(line: &Line, amplitude: Option<usize>) -> Result<Boundary, DeckError> {
    let wanted = "a node or node set, first and last component (1 to 3), and a value";
    let fields = line.at_most(4, wanted)?;
    let target = target(line, fields[0])?;
    let second = fields.get(1).copied().unwrap_or("");
    let word = if second.is_empty() { line.text.trim() } else { second };
    let by_name = |name: &str| {
        let on = match name {
            "ENCASTRE" => [1, 1, 1, 1, 1, 1],
            "PINNED" => [1, 1, 1, 0, 0, 0],
            "XSYMM" => [1, 0, 0, 0, 1, 1],
            "YSYMM" => [0, 1, 0, 1, 0, 1],
            "ZSYMM" => [0, 0, 1, 1, 1, 0],
            _ => return None,
        };
        Some(on.map(|on| on == 1))
    };
    let mut rotation = None;
    let (components, value) = match by_name(&name(second)) {
        Some(components) => (components, 0.0),
        None => {
            let mut component = |at: usize| {
                let text = fields.get(at).copied().unwrap_or("");
                match label(text) {
                    Some(number @ 1..=6) => {
                        if number > 3 {
                            rotation = Some(text.to_owned());
                        }
                        Ok(number as usize - 1)
                    }
                    _ => {
                        let word = if text.is_empty() { word } else { text };
                        Err(line.fault(word, Fault::Expected(COMPONENT)))
                    }
                }
            };
            let first = component(1)?;
            let last = match fields.get(2) {
                None | Some(&"") => first,
                Some(_) => component(2)?,
            };
            if last < first {
                let wanted = "a last component not below the first";
                return Err(line.fault(fields[2], Fault::Expected(wanted)));
            }
            let value = line.optional(&fields, 3, "a displacement, a finite number")?;
            let on = [0, 1, 2, 3, 4, 5].map(|c| (first..=last).contains(&c));
            (on, value.unwrap_or(0.0))
        }
    };
    if !second.starts_with(|c: char| c.is_ascii_digit())
        && let Some(extra) = fields.get(2)
    {
        return Err(line.fault(extra, Fault::Expected("nothing after the name of a condition")));
    }
    Ok(Boundary {
        location: line.location.clone(),
        word: fields[0].to_owned(),
        target,
        components,
        rotation,
        value,
        amplitude,
    })
}

/// `*CLOAD`.
pub(super) fn forces(model: &Model, step: &mut Step, card: &Card) -> Result<(), DeckError> {
    card.allow(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(model, card)?;
    step.forces.card(card)?;
    for line in &card.lines {
        let wanted = "a node or node set, a component 1, 2 or 3, and a force";
        let fields = line.at_most(3, wanted)?;
        let target = target(line, fields[0])?;
        let component = match fields.get(1).and_then(|f| label(f)) {
            Some(number @ 1..=3) => number as usize - 1,
            _ => {
                let word = fields.get(1).copied().unwrap_or(line.text.trim());
                return Err(line.fault(word, Fault::Expected(wanted)));
            }
        };
        step.forces.lines.push(Force {
            location: line.location.clone(),
            word: fields[0].to_owned(),
            target,
            component,
            value: line.real(&fields, 2, wanted)?,
            amplitude,
        });
    }
    Ok(())
}

/// `*DLOAD`, and `*DSLOAD` with `on_surface`.
pub(super) fn distributed(model: &Model, step: &mut Step, card: &Card, on_surface: bool) -> Result<(), DeckError> {
    card.allow(&["OP", "AMPLITUDE"])?;
    let amplitude = amplitude(model, card)?;
    step.distributed.card(card)?;
    for line in &card.lines {
        let wanted = if on_surface {
            "a surface, P, and a pressure"
        } else {
            "an element or element set, one of P1 to P4, GRAV, BX, BY, BZ, a value, and with GRAV a direction"
        };
        let fields = line.at_most(6, wanted)?;
        let kind = fields.get(1).copied().unwrap_or("");
        let found = match (on_surface, name(kind).as_str()) {
            (true, "P") => Some(DistributedKind::Surface),
            (false, "P1") => Some(DistributedKind::Face(1)),
            (false, "P2") => Some(DistributedKind::Face(2)),
            (false, "P3") => Some(DistributedKind::Face(3)),
            (false, "P4") => Some(DistributedKind::Face(4)),
            (false, "BX") => Some(DistributedKind::Body(0)),
            (false, "BY") => Some(DistributedKind::Body(1)),
            (false, "BZ") => Some(DistributedKind::Body(2)),
            (false, "GRAV") => Some(DistributedKind::Gravity([0.0; 3])),
            _ => None,
        };
        let Some(mut kind) = found else {
            let word = if kind.is_empty() { line.text.trim() } else { kind };
            return Err(line.fault(word, Fault::Expected(wanted)));
        };
        let value = line.real(&fields, 2, wanted)?;
        if let DistributedKind::Gravity(direction) = &mut kind {
            let wanted = "a direction that is not zero: three numbers";
            for (c, d) in direction.iter_mut().enumerate() {
                *d = line.real(&fields, 3 + c, wanted)?;
            }
            let length = direction.iter().map(|d| d * d).sum::<f64>();
            if !(length > 0.0 && length.is_finite()) {
                return Err(line.fault(line.text.trim(), Fault::Expected(wanted)));
            }
        } else if let Some(extra) = fields.get(3) {
            return Err(line.fault(extra, Fault::Expected(wanted)));
        }
        let target = match on_surface {
            true => Target::Name(name(fields[0])),
            false => target(line, fields[0])?,
        };
        step.distributed.lines.push(Distributed {
            location: line.location.clone(),
            word: fields[0].to_owned(),
            target,
            kind,
            value,
            amplitude,
        });
    }
    Ok(())
}
