//! Parts, their instances and the assembly, as one flat model.
//!
//! Each instance has the nodes, elements, sets, surfaces and sections of its part: numbers of the first one as they
//! are, of each later one with one more time the power of ten above all numbers of parts, and names with the name of
//! the instance and a dot before them. Nodes and elements of the assembly itself count as one more instance, with names
//! as they are.

use signorini_fem_mesh::vec3::{Vec3, add, cross, dot, norm, scale, sub};

use super::{Faces, Member, Model, Names, Section, Set, Target, mesh, property};
use crate::error::{DeckError, Fault, Word};
use crate::lexer::{Card, LARGEST, Named};

/// Most nodes, elements and members of sets of all instances together.
const COPIES: u64 = 5_000_000;

const NESTED: &str = "the part, instance or assembly before has not ended; end it first";

const OUTSIDE: &str = "between *PART and *END PART only nodes, elements, sets, surfaces and *SOLID SECTION are read; \
put this behind *END PART";

/// What is open, and what has been read of parts.
#[derive(Default)]
pub(super) struct Assembly {
    parts: Names<Model>,
    /// The part that is being read.
    part: Option<(Named, Model)>,
    /// *ASSEMBLY and *INSTANCE that have not ended.
    assembly: Option<Word>,
    instance: Option<Word>,
    /// What each instance adds to the numbers of its part.
    instances: Names<u32>,
    /// The same of nodes and elements of the assembly.
    own: Option<u32>,
    slots: u32,
    copies: u64,
}

/// A translation, and then a rotation: two points of its axis and the angle, degrees.
type Moved = (Vec3, Option<([Vec3; 2], f64)>);

/// How names and numbers of a part are changed.
struct Scope<'a> {
    /// Before names that are defined.
    own: &'a str,
    /// Before names that are used.
    used: &'a str,
    offset: u32,
    moved: Moved,
}

impl Assembly {
    /// Reads a card if it belongs to a part, an instance or the assembly; whether it does.
    pub(super) fn take(&mut self, model: &mut Model, card: &Card) -> Result<bool, DeckError> {
        let closed = self.part.is_none() && self.instance.is_none();
        match card.key.as_str() {
            "PART" => {
                if !closed || self.assembly.is_some() {
                    return Err(card.word.cannot(NESTED));
                }
                card.allow(&["NAME"])?;
                let named = card.need("NAME")?;
                if self.parts.position(&named.name).is_some() {
                    return Err(named
                        .word
                        .cannot("a part of this name is there already; give it another one"));
                }
                self.part = Some((named, Model::default()));
            }
            "ENDPART" => {
                let (named, mut part) = self
                    .part
                    .take()
                    .ok_or_else(|| card.word.cannot("no *PART is open; remove it"))?;
                model.ignored.append(&mut part.ignored);
                self.parts.add(named.name, part);
            }
            "ASSEMBLY" if closed && self.assembly.is_none() => {
                card.allow(&["NAME"])?;
                self.assembly = Some(card.word.clone());
            }
            "INSTANCE" if closed && self.assembly.is_some() => self.add(model, card)?,
            "ASSEMBLY" | "INSTANCE" if !closed => return Err(card.word.cannot(NESTED)),
            "ASSEMBLY" => return Err(card.word.cannot("there is one assembly; put all into it")),
            "INSTANCE" => {
                return Err(card
                    .word
                    .cannot("this belongs to the assembly; put *ASSEMBLY before it"));
            }
            "ENDINSTANCE" => {
                let open = self.instance.take();
                open.ok_or_else(|| card.word.cannot("no *INSTANCE is open; remove it"))?;
            }
            "ENDASSEMBLY" => {
                if !closed {
                    return Err(card.word.cannot(NESTED));
                }
                let open = self.assembly.take();
                open.ok_or_else(|| card.word.cannot("no *ASSEMBLY is open; remove it"))?;
            }
            key => {
                if self.instance.is_some() {
                    let why = "between *INSTANCE and *END INSTANCE nothing is read; put it into the part";
                    return Err(card.word.cannot(why));
                }
                if let Some((_, part)) = &mut self.part {
                    let read = reader(key).ok_or_else(|| card.word.cannot(OUTSIDE))?;
                    return read(part, card).map(|()| true);
                }
                return match (&self.assembly, reader(key)) {
                    (Some(_), Some(read)) if key != "SOLIDSECTION" => self.own(model, card, read).map(|()| true),
                    _ => Ok(false),
                };
            }
        }
        Ok(true)
    }

    /// Refuses what has not ended.
    pub(super) fn end(&self) -> Result<(), DeckError> {
        let part = self
            .part
            .as_ref()
            .map(|part| (&part.0.word, "the part does not end; put *END PART after it"));
        let assembly = self.assembly.as_ref();
        let assembly = assembly.map(|word| (word, "the assembly does not end; put *END ASSEMBLY after it"));
        match part.or(assembly) {
            Some((word, why)) => Err(word.cannot(why)),
            None => Ok(()),
        }
    }

    /// What the next instance adds to numbers.
    fn slot(&mut self, word: &Word) -> Result<u32, DeckError> {
        let parts = self.parts.iter().map(|(_, part)| part);
        let labels = parts.flat_map(|p| {
            p.nodes
                .iter()
                .map(|n| n.label)
                .chain(p.elements.iter().map(|e| e.label))
        });
        let largest = labels.max().unwrap_or(0);
        let unit = 10_u32.checked_pow(largest.checked_ilog10().map_or(0, |digits| digits + 1));
        let offset = unit.and_then(|unit| unit.checked_mul(self.slots));
        // the first one needs no unit
        let offset = offset.or((self.slots == 0).then_some(0));
        self.slots += 1;
        let fits = offset.filter(|offset| offset.checked_add(largest).is_some_and(|sum| sum <= LARGEST));
        fits.ok_or_else(|| too_many(word))
    }

    /// Adds an instance of a part.
    fn add(&mut self, model: &mut Model, card: &Card) -> Result<(), DeckError> {
        card.allow(&["NAME", "PART"])?;
        let (named, part) = (card.need("NAME")?, card.need("PART")?);
        if self.instances.position(&named.name).is_some() {
            return Err(named
                .word
                .cannot("an instance of this name is there already; give it another one"));
        }
        let moved = placed(card)?;
        let offset = self.slot(&card.word)?;
        let part = self.parts.at(self.parts.find("part", &part.name, &part.word)?);
        let sets = part.nsets.iter().chain(part.elsets.iter());
        let members = sets.map(|(_, set)| set.len()).sum::<usize>();
        self.copies += (part.nodes.len() + part.elements.len() + members) as u64;
        if self.copies > COPIES {
            return Err(card.word.fault(Fault::TooMany {
                what: "nodes, elements and members of sets in all instances",
                most: COPIES,
                remedy: "write a deck without parts",
            }));
        }
        let prefix = format!("{}.", named.name);
        let scope = Scope {
            own: &prefix,
            used: &prefix,
            offset,
            moved,
        };
        scope.add(part, model, &card.word)?;
        self.instances.add(named.name, offset);
        self.instance = Some(card.word.clone());
        Ok(())
    }

    /// Reads nodes, elements, sets and surfaces of the assembly; sets may be of an instance.
    fn own(&mut self, model: &mut Model, card: &Card, read: Reader) -> Result<(), DeckError> {
        let of = match card.key.as_str() {
            "NSET" | "ELSET" => card.value("INSTANCE")?,
            _ => None,
        };
        let mut one = Model::default();
        read(&mut one, &card.without("INSTANCE"))?;
        let (used, offset) = match of {
            Some(named) => {
                let found = self.instances.find("instance", &named.name, &named.word)?;
                (format!("{}.", named.name), *self.instances.at(found))
            }
            None => {
                let offset = match self.own {
                    Some(offset) => offset,
                    None => self.slot(&card.word)?,
                };
                self.own = Some(offset);
                (String::new(), offset)
            }
        };
        let scope = Scope {
            own: "",
            used: &used,
            offset,
            moved: ([0.0; 3], None),
        };
        scope.add(&one, model, &card.word)
    }
}

type Reader = fn(&mut Model, &Card) -> Result<(), DeckError>;

/// Cards that parts have.
fn reader(key: &str) -> Option<Reader> {
    Some(match key {
        "NODE" => mesh::nodes,
        "ELEMENT" => mesh::elements,
        "NSET" => |model, card| mesh::set(model, card, "NSET"),
        "ELSET" => |model, card| mesh::set(model, card, "ELSET"),
        "SURFACE" => mesh::surface,
        "SOLIDSECTION" => property::section,
        _ => return None,
    })
}

fn too_many(word: &Word) -> DeckError {
    word.fault(Fault::TooMany {
        what: "numbers of nodes and elements, those of the parts added to the place of their instance",
        most: u64::from(LARGEST),
        remedy: "number the parts from 1",
    })
}

/// Translation and rotation of an instance.
fn placed(card: &Card) -> Result<Moved, DeckError> {
    let wanted = "a line with a translation, and one with two points of an axis and an angle in degrees";
    card.lines_at_most(2, wanted)?;
    let numbers = |line: usize, count: usize| -> Result<Option<Vec<f64>>, DeckError> {
        let Some(line) = card.lines.get(line) else {
            return Ok(None);
        };
        let fields = line.at_most(count, wanted)?;
        let numbers = (0..count).map(|at| Ok(line.optional(&fields, at, wanted)?.unwrap_or(0.0)));
        numbers.collect::<Result<_, DeckError>>().map(Some)
    };
    let by = numbers(0, 3)?.map_or([0.0; 3], |n| [n[0], n[1], n[2]]);
    let turn = numbers(1, 7)?.map(|n| ([[n[0], n[1], n[2]], [n[3], n[4], n[5]]], n[6]));
    match turn {
        Some(([a, b], _)) if norm(sub(b, a)) == 0.0 => Err(card.lines[1].cannot("two points of an axis must differ")),
        turn => Ok((by, turn)),
    }
}

impl Scope<'_> {
    /// Adds nodes, elements, sets, surfaces and sections to a model.
    fn add(&self, part: &Model, model: &mut Model, word: &Word) -> Result<(), DeckError> {
        let number = |n: u32| {
            let sum = n.checked_add(self.offset).filter(|sum| *sum <= LARGEST);
            sum.ok_or_else(|| too_many(word))
        };
        for node in &part.nodes {
            let mut node = node.clone();
            (node.label, node.point) = (number(node.label)?, self.place(node.point));
            model.nodes.push(node);
        }
        for element in &part.elements {
            let mut element = element.clone();
            element.label = number(element.label)?;
            for n in element.nodes.iter_mut().chain(&mut element.mids) {
                // zeros are none
                *n = if *n == 0 { 0 } else { number(*n)? };
            }
            model.elements.push(element);
        }
        let pairs = [(&part.nsets, &mut model.nsets), (&part.elsets, &mut model.elsets)];
        for (sets, all) in pairs {
            for (name, set) in sets.iter() {
                let mut members: Set = Vec::with_capacity(set.len());
                for (member, location) in set {
                    let member = match member {
                        Member::One(n) => Member::One(number(*n)?),
                        Member::Range { from, to, step } => Member::Range {
                            from: number(*from)?,
                            to: number(*to)?,
                            step: *step,
                        },
                        Member::Set(name) => Member::Set(format!("{}{name}", self.used)),
                    };
                    members.push((member, location.clone()));
                }
                all.entry(format!("{}{name}", self.own)).append(&mut members);
            }
        }
        for (name, lines) in part.surfaces.iter() {
            let name = format!("{}{name}", self.own);
            if model.surfaces.position(&name).is_some() {
                return Err(word.cannot(mesh::TWICE));
            }
            let mut faces = Vec::with_capacity(lines.len());
            for line in lines {
                let target = match &line.target {
                    Target::Number(n) => Target::Number(number(*n)?),
                    Target::Name(name) => Target::Name(format!("{}{name}", self.used)),
                    Target::All => Target::All,
                };
                let word = line.word.clone();
                let side = line.side;
                faces.push(Faces { target, side, word });
            }
            model.surfaces.add(name, faces);
        }
        for section in &part.sections {
            let Named { name, word } = &section.elset;
            let elset = Named {
                name: format!("{}{name}", self.used),
                word: word.clone(),
            };
            let material = section.material.clone();
            model.sections.push(Section { elset, material });
        }
        Ok(())
    }

    fn place(&self, point: Vec3) -> Vec3 {
        let (by, turn) = &self.moved;
        // numbers of parts that stay where they are keep their bits
        let moved = if *by == [0.0; 3] { point } else { add(point, *by) };
        let Some(([a, b], degrees)) = turn else {
            return moved;
        };
        let axis = scale(1.0 / norm(sub(*b, *a)), sub(*b, *a));
        let arm = sub(moved, *a);
        let along = scale(dot(arm, axis), axis);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let across = sub(arm, along);
        let turned = add(scale(cosine, across), scale(sine, cross(axis, across)));
        add(*a, add(along, turned))
    }
}
