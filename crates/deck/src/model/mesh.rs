//! Nodes, elements, sets and surfaces.

use super::{Element, Faces, Kind, Member, Model, Node, Side, Target};
use crate::error::{DeckError, Fault};
use crate::lexer::{Card, Line, label, name};

/// Most members of one generated range.
const RANGE: u64 = 100_000_000;

const TYPES: &str = "only tetrahedra C3D4 and C3D10 are read, and R3D3 and R3D4 for rigid planes; mesh in \
these, and \
    leave out elements of surfaces and lines (in Gmsh: save only physical volumes)";

pub(super) fn nodes(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NSET"])?;
    let set = card.value("NSET")?;
    let mut members = Vec::new();
    for line in &card.lines {
        let wanted = "a node number and up to three coordinates";
        let fields = line.at_most(4, wanted)?;
        let label = line.label(&fields, 0, "a node number from 1 to 2147483647")?;
        let mut point = [0.0; 3];
        for (c, value) in point.iter_mut().enumerate() {
            let given = line.optional(&fields, 1 + c, "a coordinate, a finite number")?;
            *value = given.unwrap_or(0.0);
        }
        let location = line.location.clone();
        model.nodes.push(Node { label, point, location });
        if set.is_some() {
            members.push((Member::One(label), line.location.clone()));
        }
    }
    if let Some(set) = set {
        model.nsets.entry(set).append(&mut members);
    }
    Ok(())
}

pub(super) fn elements(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["TYPE", "ELSET"])?;
    let kinds = [Kind::Solid, Kind::Triangle, Kind::Quadrilateral, Kind::Solid];
    let kind = card.need("TYPE")?;
    let kind = ["C3D4", "R3D3", "R3D4", "C3D10"].iter().position(|k| *k == kind);
    let quadratic = kind == Some(3);
    let (kind, nodes, wanted) = match (kind.map(|k| kinds[k]), card.param("TYPE")) {
        (None, Some(param)) => {
            return Err(card.param_fault(param, Fault::Unsupported(TYPES)));
        }
        (Some(_), _) if quadratic => (Kind::Solid, 10, "an element number and ten node numbers"),
        (Some(Kind::Triangle), _) => (Kind::Triangle, 3, "an element number and three node numbers"),
        (kind, _) => (
            kind.unwrap_or(Kind::Solid),
            4,
            "an element number and four node numbers",
        ),
    };
    let set = card.value("ELSET")?;
    let mut members = Vec::new();
    let mut lines = card.lines.iter();
    while let Some(line) = lines.next() {
        let mut numbers = Vec::with_capacity(1 + nodes);
        let mut next = Some(line);
        // a line that ends with a comma goes on in the next one
        while let Some(line) = next {
            let fields = line.at_most(1 + nodes - numbers.len(), wanted)?;
            for at in 0..fields.len() {
                numbers.push(line.label(&fields, at, "a number from 1 to 2147483647")?);
            }
            let open = numbers.len() < 1 + nodes && line.text.ends_with(',');
            next = if open { lines.next() } else { None };
        }
        let (label, nodes, mids) = match numbers[..] {
            [label, a, b, c] if nodes == 3 => (label, [a, b, c, c], [0; 6]),
            [label, a, b, c, d] if nodes == 4 => (label, [a, b, c, d], [0; 6]),
            [label, a, b, c, d, e, f, g, h, i, j] => (label, [a, b, c, d], [e, f, g, h, i, j]),
            _ => return Err(line.fault(line.text.trim(), Fault::Expected(wanted))),
        };
        let location = line.location.clone();
        if set.is_some() {
            members.push((Member::One(label), location.clone()));
        }
        model.elements.push(Element {
            label,
            kind,
            nodes,
            mids,
            location,
        });
    }
    if let Some(set) = set {
        model.elsets.entry(set).append(&mut members);
    }
    Ok(())
}

/// `*NSET` and `*ELSET`, whose parameter of the name is `key`.
pub(super) fn set(model: &mut Model, card: &Card, key: &'static str) -> Result<(), DeckError> {
    // INTERNAL only hides a set in a user interface
    card.allow(&[key, "GENERATE", "INTERNAL"])?;
    card.flag("INTERNAL")?;
    let name = card.need(key)?;
    let generate = card.flag("GENERATE")?;
    let mut members = Vec::new();
    for line in &card.lines {
        if generate {
            members.push((range(line)?, line.location.clone()));
            continue;
        }
        for field in line.fields() {
            let member = member(line, field)?;
            members.push((member, line.location.clone()));
        }
    }
    let sets = match key {
        "NSET" => &mut model.nsets,
        _ => &mut model.elsets,
    };
    sets.entry(name).append(&mut members);
    Ok(())
}

fn member(line: &Line, field: &str) -> Result<Member, DeckError> {
    if let Some(number) = label(field) {
        return Ok(Member::One(number));
    }
    match target(line, field)? {
        Target::Number(number) => Ok(Member::One(number)),
        Target::Name(name) => Ok(Member::Set(name)),
    }
}

fn range(line: &Line) -> Result<Member, DeckError> {
    let wanted = "first number, last number and, if it is not 1, the increment";
    let fields = line.at_most(3, wanted)?;
    let [from, to] = [line.label(&fields, 0, wanted)?, line.label(&fields, 1, wanted)?];
    let step = match fields.get(2) {
        None | Some(&"") => 1,
        Some(_) => line.label(&fields, 2, wanted)?,
    };
    if to < from {
        let wanted = "a last number not below the first";
        return Err(line.fault(line.text.trim(), Fault::Expected(wanted)));
    }
    if u64::from((to - from) / step) >= RANGE {
        let fault = Fault::TooMany {
            what: "numbers in one range",
            most: RANGE,
            remedy: "check the last number",
        };
        return Err(line.fault(line.text.trim(), fault));
    }
    Ok(Member::Range { from, to, step })
}

/// A number, or the name of a set.
pub(super) fn target(line: &Line, field: &str) -> Result<Target, DeckError> {
    if let Some(number) = label(field) {
        return Ok(Target::Number(number));
    }
    let wanted = "a number from 1 to 2147483647, or the name of a set";
    let begins = field.chars().next();
    if begins.is_none_or(|c| c.is_ascii_digit() || "+-.".contains(c)) {
        let word = if field.is_empty() { line.text.trim() } else { field };
        return Err(line.fault(word, Fault::Expected(wanted)));
    }
    Ok(Target::Name(name(field)))
}

pub(super) fn surface(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "TYPE", "INTERNAL"])?;
    card.flag("INTERNAL")?;
    let surface = card.need("NAME")?;
    if let (Some(kind), Some(param)) = (card.value("TYPE")?, card.param("TYPE")) {
        let why = match kind.as_str() {
            "ELEMENT" => None,
            "NODE" => Some(
                "a surface of nodes has no areas and normals, which contact and pressure need; give faces \
                of elements, TYPE=ELEMENT",
            ),
            _ => Some("only surfaces of element faces are read, TYPE=ELEMENT"),
        };
        if let Some(why) = why {
            return Err(card.param_fault(param, Fault::Unsupported(why)));
        }
    }
    if model.surfaces.position(&surface).is_some() {
        let why = "a surface of this name is there already; give all its faces at once";
        return Err(card.fault(Fault::Misplaced(why)));
    }
    let mut faces = Vec::new();
    for line in &card.lines {
        let wanted = "an element or element set, and a face S1, S2, S3 or S4 (SPOS or SNEG of rigid facets)";
        let fields = line.at_most(2, wanted)?;
        let side = match fields.get(1).map(|f| name(f)).as_deref() {
            Some("S1") => Side::Face(1),
            Some("S2") => Side::Face(2),
            Some("S3") => Side::Face(3),
            Some("S4") => Side::Face(4),
            Some("SPOS") => Side::Facet { positive: true },
            Some("SNEG") => Side::Facet { positive: false },
            _ => {
                let word = fields.get(1).copied().unwrap_or(line.text.trim());
                return Err(line.fault(word, Fault::Expected(wanted)));
            }
        };
        faces.push(Faces {
            target: target(line, fields[0])?,
            side,
            location: line.location.clone(),
        });
    }
    if faces.is_empty() {
        return Err(card.fault(Fault::Empty("the surface has no faces; give them in lines")));
    }
    model.surfaces.add(surface, faces);
    Ok(())
}
