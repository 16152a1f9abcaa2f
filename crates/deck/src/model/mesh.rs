//! Nodes, elements, sets and surfaces.

use super::{Element, Faces, Ignored, Kind, Member, Model, Node, SetCard, Side, Target};
use crate::error::{DeckError, Fault, Word};
use crate::lexer::{Card, Named, is_numeric, label, name};
use signorini_fem_mesh::mesh::CellShape;

/// Most members of one generated range.
const RANGE: u64 = 100_000_000;

/// Elements that are read: what they are, the number of their nodes and of those that are kept, and what a line of them
/// is.
const TYPES: [(&str, Kind, [usize; 2], &str); 16] = {
    use CellShape::{Hexahedron, Prism, Pyramid, Tetrahedron};
    use Kind::{Flat, Line, Rigid, Solid};
    const TWO: &str = "an element number and two node numbers";
    const THREE: &str = "an element number and three node numbers";
    const FOUR: &str = "an element number and four node numbers";
    const FIVE: &str = "an element number and five node numbers";
    const SIX: &str = "an element number and six node numbers";
    const EIGHT: &str = "an element number and eight node numbers";
    const TEN: &str = "an element number and ten node numbers";
    const THIRTEEN: &str = "an element number and thirteen node numbers";
    const FIFTEEN: &str = "an element number and fifteen node numbers";
    const TWENTY: &str = "an element number and twenty node numbers";
    [
        ("C3D4", Solid(Tetrahedron), [4, 4], FOUR),
        ("C3D10", Solid(Tetrahedron), [10, 10], TEN),
        ("C3D13", Solid(Pyramid), [13, 13], THIRTEEN),
        ("C3D5", Solid(Pyramid), [5, 5], FIVE),
        ("C3D6", Solid(Prism), [6, 6], SIX),
        ("C3D15", Solid(Prism), [15, 15], FIFTEEN),
        ("C3D8", Solid(Hexahedron), [8, 8], EIGHT),
        ("C3D20", Solid(Hexahedron), [20, 20], TWENTY),
        ("R3D3", Rigid, [3, 3], THREE),
        ("R3D4", Rigid, [4, 4], FOUR),
        ("CPS3", Flat, [3, 3], THREE),
        ("CPS4", Flat, [4, 4], FOUR),
        // a place between the corners is not looked at
        ("CPS6", Flat, [6, 3], SIX),
        ("CPS8", Flat, [8, 4], EIGHT),
        ("T3D2", Line, [2, 2], TWO),
        ("T3D3", Line, [3, 2], THREE),
    ]
};

/// Why a surface is refused whose name is not new.
pub(super) const TWICE: &str = "a surface of this name is there already; give all its faces at once";

/// Endings of the names of variants that differ in what is not solved here, and in how they are integrated or locked.
const VARIANTS: [&str; 11] = ["H", "HS", "I", "M", "MH", "T", "R", "RH", "IH", "RT", "S"];

const LABEL: &str = "a number from 1 to 2147483647";

pub(super) fn nodes(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NSET"])?;
    let set = card.value("NSET")?;
    let first = model.nodes.len();
    for line in &card.lines {
        let fields = line.at_most(4, "a node number and up to three coordinates")?;
        let label = line.label(&fields, 0, "a node number from 1 to 2147483647")?;
        let mut point = [0.0; 3];
        for (c, value) in point.iter_mut().enumerate() {
            let given = line.optional(&fields, 1 + c, "a coordinate, a finite number")?;
            *value = given.unwrap_or(0.0);
        }
        let location = line.location.clone();
        model.nodes.push(Node { label, point, location });
    }
    if let Some(set) = set {
        let new = model.nodes[first..].iter();
        let members = new.map(|node| (Member::One(node.label), node.location.clone()));
        model.nsets.push(SetCard {
            name: set.name,
            defines: true,
            members: members.collect(),
        });
    }
    Ok(())
}

pub(super) fn elements(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["TYPE", "ELSET"])?;
    let kind = card.need("TYPE")?;
    let variants = |plain: &str| kind.name.strip_prefix(plain).is_some_and(|end| VARIANTS.contains(&end));
    let found = TYPES.iter().find(|t| t.0 == kind.name);
    let variant = || {
        TYPES
            .iter()
            .find(|t| matches!(t.1, Kind::Solid(_) | Kind::Flat) && variants(t.0))
    };
    let Some(&(plain, of, [nodes, kept], wanted)) = found.or_else(variant) else {
        return Err(kind.word.fault(Fault::Unsupported(
            "only C3D4, C3D10, C3D8, C3D20, C3D6, C3D15, C3D5, C3D13, R3D3 and R3D4 for rigid surfaces, and CPS3, CPS4, CPS6, \
            CPS8, T3D2, T3D3 as marks are read; mesh in these (Gmsh: SecondOrderIncomplete = 1), and leave out others",
        )));
    };
    if plain != kind.name {
        let why = format!("a variant; the element is {plain} here");
        model.ignored.push(Ignored::new(&kind.word, why));
    }
    if of.is_mark() {
        let why = "flat elements and lines have no stiffness here; flat ones name faces in *SURFACE";
        model.ignored.push(Ignored::new(&kind.word, why));
    }
    let set = card.value("ELSET")?;
    let first = model.elements.len();
    let mut lines = card.lines.iter();
    while let Some(line) = lines.next() {
        let mut numbers = Vec::with_capacity(1 + nodes);
        let mut next = Some(line);
        // a line that ends with a comma goes on in the next one, and one whose nodes are all there with that
        while let Some(line) = next {
            let fields = line.at_most(1 + nodes - numbers.len(), wanted)?;
            for at in 0..fields.len() {
                numbers.push(line.label(&fields, at, LABEL)?);
            }
            let missing = 1 + nodes - numbers.len();
            let completes = |next: &Word| next.fields().len() == missing;
            let open = missing > 0 && (line.text.ends_with(',') || lines.clone().next().is_some_and(completes));
            next = if open { lines.next() } else { None };
        }
        let (label, numbers) = match numbers.split_first() {
            Some((label, numbers)) if numbers.len() == nodes => (*label, &numbers[..kept]),
            _ => return Err(line.expected(wanted)),
        };
        model.elements.push(Element {
            label,
            kind: of,
            nodes: numbers.to_vec(),
            location: line.location.clone(),
        });
    }
    if let Some(set) = set {
        let new = model.elements[first..].iter();
        let members = new.map(|element| (Member::One(element.label), element.location.clone()));
        model.elsets.push(SetCard {
            name: set.name,
            defines: true,
            members: members.collect(),
        });
    }
    Ok(())
}

/// `*NSET` and `*ELSET`, whose parameter of the name is `key`.
pub(super) fn set(model: &mut Model, card: &Card, key: &'static str) -> Result<(), DeckError> {
    // INTERNAL only hides a set in a user interface
    card.allow(&[key, "GENERATE", "INTERNAL", "UNSORTED"])?;
    card.flag("INTERNAL")?;
    let set = card.need(key)?;
    if let (true, Some(param)) = (card.flag("UNSORTED")?, card.param("UNSORTED")) {
        let why = "the order of a set has no meaning here";
        model.ignored.push(Ignored::new(&param.word, why));
        if key == "NSET" {
            model.unsorted.insert(set.name.clone(), param.word.location.clone());
        }
    }
    let generate = card.flag("GENERATE")?;
    let sets = match key {
        "NSET" => &mut model.nsets,
        _ => &mut model.elsets,
    };
    let mut members = Vec::new();
    for line in &card.lines {
        if generate {
            members.push((range(line)?, line.location.clone()));
            continue;
        }
        for field in line.fields() {
            let member = match label(field) {
                Some(number) => Member::One(number),
                None => Member::Set(set_name(line, field)?),
            };
            members.push((member, line.location.clone()));
        }
    }
    sets.push(SetCard {
        name: set.name,
        defines: false,
        members,
    });
    Ok(())
}

fn range(line: &Word) -> Result<Member, DeckError> {
    let wanted = "first number, last number and, if it is not 1, the increment";
    let fields = line.at_most(3, wanted)?;
    let [from, to] = [line.label(&fields, 0, wanted)?, line.label(&fields, 1, wanted)?];
    let step = match fields.get(2) {
        None | Some(&"") => 1,
        Some(_) => line.label(&fields, 2, wanted)?,
    };
    if to < from {
        return Err(line.expected("a last number not below the first"));
    }
    if u64::from((to - from) / step) >= RANGE {
        return Err(line.fault(Fault::TooMany {
            what: "numbers in one range",
            most: RANGE,
            remedy: "check the last number",
        }));
    }
    Ok(Member::Range { from, to, step })
}

/// A number, or the name of a set.
pub(super) fn target(line: &Word, field: &str) -> Result<Target, DeckError> {
    match label(field) {
        Some(number) => Ok(Target::Number(number)),
        None => set_name(line, field).map(Target::Name),
    }
}

/// The node by its number, or the set of one by its name, that a parameter gives, and its word.
pub(super) fn node_of(value: Named) -> (Target, Word) {
    let target = match label(&value.name) {
        Some(number) => Target::Number(number),
        None => Target::Name(value.name),
    };
    (target, value.word)
}

fn set_name(line: &Word, field: &str) -> Result<String, DeckError> {
    if field.is_empty() || is_numeric(field) {
        let wanted = "a number from 1 to 2147483647, or the name of a set";
        return Err(line.entry(&[field], 0).expected(wanted));
    }
    Ok(name(field))
}

pub(super) fn surface(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    card.allow(&["NAME", "TYPE", "INTERNAL"])?;
    card.flag("INTERNAL")?;
    let surface = card.need("NAME")?;
    let kinds = ["ELEMENT", "NODE"];
    let of_nodes = card.choice("TYPE", &kinds, "TYPE=ELEMENT or TYPE=NODE")? == Some(1);
    if model.surfaces.position(&surface.name).is_some() {
        return Err(card.word.cannot(TWICE));
    }
    let mut faces = Vec::new();
    for line in &card.lines {
        let wanted = if of_nodes {
            "a node or node set, and none or an area, as 1."
        } else {
            "an element or element set, and a face S1 to S6 (SPOS or SNEG of rigid facets), or none"
        };
        let fields = line.at_most(2, wanted)?;
        let face = fields.get(1).map(|f| name(f));
        let side = match (of_nodes, face.as_deref().map(str::as_bytes)) {
            (true, None) => Side::Nodes,
            // another node is none
            (true, Some(_)) if label(fields[1]).is_none() => {
                line.real(&fields, 1, wanted)?;
                let why = "faces have their own areas";
                model.ignored.push(Ignored::new(&line.part(fields[1]), why));
                Side::Nodes
            }
            (false, None | Some(b"")) => Side::Outside,
            (false, Some([b'S', face @ b'1'..=b'6'])) => Side::Face(face - b'0'),
            (false, Some(b"SPOS")) => Side::Facet { positive: true },
            (false, Some(b"SNEG")) => Side::Facet { positive: false },
            _ => return Err(line.entry(&fields, 1).expected(wanted)),
        };
        let target = target(line, fields[0])?;
        let word = line.part(&target.to_string());
        faces.push(Faces { target, side, word });
    }
    if faces.is_empty() {
        return Err(card
            .word
            .cannot("the surface has no faces; give them, or nodes with TYPE=NODE, in lines"));
    }
    model.surfaces.add(surface.name, faces);
    Ok(())
}
