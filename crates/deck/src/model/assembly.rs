//! Parts, their instances and the assembly, as one flat model.
//!
//! Each instance has the nodes, elements, sets, surfaces and sections of its part: numbers of the first one as they
//! are, of each later one with one more time the power of ten above all numbers of parts, and names with the name of
//! the instance and a dot before them. Nodes and elements of the assembly itself have the numbers of one more instance
//! behind all others, with names as they are.

use std::borrow::Cow;

use signorini_fem_mesh::vec3::{Vec3, add, cross, dot, norm, scale, sub, unit};

use super::{Faces, MaterialAxes, Member, Model, Names, Section, SetCard, Side, Target, mesh, property};
use crate::error::{DeckError, Fault, Location, Word};
use crate::lexer::{Card, LARGEST, Named, label};

/// Most things that instances copy from their parts, see [`weight`].
const COPIES: u64 = 5_000_000;

/// Bytes that count as one thing.
const THING: usize = 64;

/// Bytes that a name takes beside its letters, in tables and with its place.
const NAME: usize = 256;

const NESTED: &str = "the part, instance or assembly before has not ended; end it first";

const OUTSIDE: &str = "between *PART and *END PART only nodes, elements, sets, surfaces and *SOLID SECTION are read; \
put this behind *END PART";

const BEHIND: &str = "this is not a part of the assembly; put it behind *END ASSEMBLY";

const ANY: &str = "in the assembly a number does not tell of which instance the node is; name it by a set";

/// What is open, and what has been read of parts.
#[derive(Default)]
pub(super) struct Assembly {
    parts: Names<Model>,
    /// The largest number in parts.
    largest: u32,
    /// The part that is being read.
    part: Option<(Named, Model)>,
    /// *ASSEMBLY and *INSTANCE that have not ended.
    assembly: Option<Word>,
    instance: Option<Word>,
    /// Whether an assembly has ended.
    ended: bool,
    instances: Names<()>,
    /// How many instances the deck has, also those to come.
    count: usize,
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
    /// Added to numbers.
    offset: u64,
    /// No number beyond is there.
    largest: u32,
    moved: Moved,
    /// The card that asks.
    word: &'a Word,
}

impl Assembly {
    pub(super) fn new(cards: &[Card]) -> Self {
        Self {
            count: cards.iter().filter(|card| card.key == "INSTANCE").count(),
            ..Self::default()
        }
    }

    /// Reads a card if it belongs to a part, an instance or the assembly; whether it does.
    pub(super) fn take(&mut self, model: &mut Model, card: &Card) -> Result<bool, DeckError> {
        let closed = self.part.is_none() && self.instance.is_none();
        match card.key.as_str() {
            "PART" => {
                if !closed || self.assembly.is_some() {
                    return Err(card.word.cannot(NESTED));
                }
                bare(card, &["NAME"])?;
                let named = card.need("NAME")?;
                if self.parts.position(&named.name).is_some() {
                    return Err(named
                        .word
                        .cannot("a part of this name is there already; give it another one"));
                }
                self.part = Some((named, Model::default()));
            }
            "ENDPART" => {
                bare(card, &[])?;
                let (named, mut part) = self
                    .part
                    .take()
                    .ok_or_else(|| card.word.cannot("no *PART is open; remove it"))?;
                model.ignored.append(&mut part.ignored);
                let labels = part.nodes.iter().map(|node| node.label);
                let labels = labels.chain(part.elements.iter().map(|element| element.label));
                self.largest = labels.fold(self.largest, u32::max);
                self.parts.add(named.name, part);
            }
            "ASSEMBLY" if closed && self.assembly.is_none() && !self.ended => {
                bare(card, &["NAME"])?;
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
                bare(card, &[])?;
                let open = self.instance.take();
                open.ok_or_else(|| card.word.cannot("no *INSTANCE is open; remove it"))?;
            }
            "ENDASSEMBLY" => {
                bare(card, &[])?;
                if !closed {
                    return Err(card.word.cannot(NESTED));
                }
                let open = self.assembly.take();
                open.ok_or_else(|| card.word.cannot("no *ASSEMBLY is open; remove it"))?;
                self.ended = true;
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
                if self.assembly.is_none() {
                    return Ok(false);
                }
                return match (key, reader(key)) {
                    ("BOUNDARY" | "INITIALCONDITIONS" | "STEP", _) => Err(card.word.cannot(BEHIND)),
                    ("RIGIDBODY" | "COUPLING" | "PRE-TENSIONSECTION", _) => no_numbers(card).map(|()| false),
                    ("EQUATION" | "MPC", _) => no_single_nodes(card).map(|()| false),
                    (_, Some(read)) if key != "SOLIDSECTION" => self.own(model, card, read).map(|()| true),
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

    /// What is added to numbers behind so many instances.
    fn offset(&self, instances: usize) -> u64 {
        let digits = self.largest.checked_ilog10().map_or(0, |digits| digits + 1);
        10_u64.pow(digits).saturating_mul(instances as u64)
    }

    /// Refuses too much that is copied.
    fn few(&self, word: &Word) -> Result<(), DeckError> {
        match self.copies {
            0..=COPIES => Ok(()),
            _ => Err(word.fault(Fault::TooMany {
                what: "nodes, elements, members of sets, faces and names in all instances",
                most: COPIES,
                remedy: "write a deck without parts",
            })),
        }
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
        let prefix = format!("{}.", named.name);
        let part = self.parts.find("part", &part.name, &part.word)?;
        self.copies += weight(self.parts.at(part), prefix.len());
        self.few(&card.word)?;
        let scope = Scope {
            own: &prefix,
            used: &prefix,
            offset: self.offset(self.instances.len()),
            largest: self.largest,
            moved,
            word: &card.word,
        };
        scope.add(self.parts.at(part), model)?;
        self.instances.add(named.name, ());
        self.instance = Some(card.word.clone());
        Ok(())
    }

    /// Reads nodes, elements, sets and surfaces of the assembly; sets may be of an instance.
    fn own(&mut self, model: &mut Model, card: &Card, read: Reader) -> Result<(), DeckError> {
        let is_set = matches!(card.key.as_str(), "NSET" | "ELSET");
        let (of, plain) = if is_set {
            card.allow(&[&card.key, "GENERATE", "INTERNAL", "UNSORTED", "INSTANCE"])?;
            (card.value("INSTANCE")?, Cow::Owned(card.without("INSTANCE")))
        } else {
            (None, Cow::Borrowed(card))
        };
        let mut one = Model::default();
        read(&mut one, &plain)?;
        model.ignored.append(&mut one.ignored);
        let (used, instances, largest) = match of {
            Some(named) => {
                let found = self.instances.find("instance", &named.name, &named.word)?;
                let prefix = format!("{}.", named.name);
                self.copies += weight(&one, prefix.len());
                self.few(&card.word)?;
                (prefix, found, self.largest)
            }
            None => (String::new(), self.count, LARGEST),
        };
        let scope = Scope {
            own: "",
            used: &used,
            offset: self.offset(instances),
            largest,
            moved: ([0.0; 3], None),
            word: &card.word,
        };
        scope.add(&one, model)
    }
}

/// How many things an instance copies from its part: nodes, elements, members of sets and faces, and names, each as
/// several, with so many bytes before it.
fn weight(part: &Model, prefix: usize) -> u64 {
    let named = |name: &str| (NAME + prefix + name.len()) / THING;
    let sets = part.nsets.iter().chain(&part.elsets).map(|card| {
        let members = card.members.iter().map(|(member, _)| match member {
            Member::Set(name) => named(name),
            Member::One(_) | Member::Range { .. } => 1,
        });
        named(&card.name) + members.sum::<usize>()
    });
    let surfaces = part.surfaces.iter().map(|(name, faces)| {
        let faces = faces.iter().map(|faces| match &faces.target {
            Target::Name(name) => named(name),
            Target::Number(_) | Target::All => 1,
        });
        named(name) + faces.sum::<usize>()
    });
    let sections = part.sections.iter();
    let sections = sections.map(|section| named(&section.elset.name) + named(&section.material.name));
    let all = sets.chain(surfaces).chain(sections).sum::<usize>();
    (part.nodes.len() + part.elements.len() + all) as u64
}

/// Refuses other parameters than these, and data.
fn bare(card: &Card, known: &[&str]) -> Result<(), DeckError> {
    card.allow(known)?;
    card.lines_at_most(0, "no data")
}

/// Refuses nodes by number.
fn no_numbers(card: &Card) -> Result<(), DeckError> {
    for key in ["REFNODE", "ROTNODE", "NODE"] {
        match card.value(key)? {
            Some(node) if label(&node.name).is_some() => return Err(node.word.cannot(ANY)),
            Some(_) | None => {}
        }
    }
    Ok(())
}

/// The same in the terms of equations.
fn no_single_nodes(card: &Card) -> Result<(), DeckError> {
    for line in &card.lines {
        let fields = line.fields();
        let nodes: Vec<&str> = match card.key.as_str() {
            "MPC" => fields,
            // the number of terms stands alone
            _ => fields.chunks(3).filter(|term| term.len() > 1).map(|t| t[0]).collect(),
        };
        if let Some(node) = nodes.into_iter().find(|node| label(node).is_some()) {
            return Err(line.part(node).cannot(ANY));
        }
    }
    Ok(())
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
        "SOLIDSECTION" => section,
        _ => return None,
    })
}

/// A section of a part, whose axes would turn with its instances.
fn section(model: &mut Model, card: &Card) -> Result<(), DeckError> {
    match card.param("ORIENTATION") {
        None => property::section(model, card),
        Some(param) => Err(param
            .word
            .cannot("axes of materials are not read in parts; give the section behind the assembly, of a set there")),
    }
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
    fn add(&self, part: &Model, model: &mut Model) -> Result<(), DeckError> {
        for node in &part.nodes {
            let mut node = node.clone();
            (node.label, node.point) = (self.sum(node.label)?, self.place(node.point));
            model.nodes.push(node);
        }
        for element in &part.elements {
            let mut element = element.clone();
            element.label = self.sum(element.label)?;
            for n in &mut element.nodes {
                *n = self.number(*n, "node", &element.location)?;
            }
            model.elements.push(element);
        }
        let pairs = [
            ("node", &part.nsets, &mut model.nsets),
            ("element", &part.elsets, &mut model.elsets),
        ];
        for (what, sets, all) in pairs {
            for card in sets {
                let mut members = Vec::with_capacity(card.members.len());
                for (member, location) in &card.members {
                    let member = match member {
                        Member::One(n) => Member::One(self.number(*n, what, location)?),
                        Member::Range { from, to, step } => Member::Range {
                            from: self.number(*from, what, location)?,
                            // a range takes what is there
                            to: self.shifted(self.last([*from, *to, *step])).min(u64::from(LARGEST)) as u32,
                            step: *step,
                        },
                        Member::Set(name) => Member::Set(format!("{}{name}", self.used)),
                    };
                    members.push((member, location.clone()));
                }
                all.push(SetCard {
                    name: format!("{}{}", self.own, card.name),
                    defines: card.defines,
                    members,
                });
            }
        }
        let unsorted = part.unsorted.iter();
        let unsorted = unsorted.map(|(name, location)| (format!("{}{name}", self.own), location.clone()));
        model.unsorted.extend(unsorted);
        for (name, lines) in part.surfaces.iter() {
            let name = format!("{}{name}", self.own);
            if model.surfaces.position(&name).is_some() {
                return Err(self.word.cannot(mesh::TWICE));
            }
            let mut faces = Vec::with_capacity(lines.len());
            for line in lines {
                let target = match &line.target {
                    Target::Number(n) => {
                        let what = if line.side == Side::Nodes { "node" } else { "element" };
                        Target::Number(self.number(*n, what, &line.word.location)?)
                    }
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
            model.sections.push(Section {
                elset,
                material,
                axes: match self.moved.1 {
                    Some((_, angle)) if angle != 0.0 => MaterialAxes::Turned(self.word.clone()),
                    _ => MaterialAxes::Global,
                },
            });
        }
        Ok(())
    }

    /// The last number of a range that parts can have.
    fn last(&self, [from, to, step]: [u32; 3]) -> u32 {
        if to <= self.largest {
            to
        } else {
            self.largest - self.largest.saturating_sub(from) % step
        }
    }

    fn shifted(&self, n: u32) -> u64 {
        self.offset.saturating_add(u64::from(n))
    }

    /// The number of what is defined.
    fn sum(&self, n: u32) -> Result<u32, DeckError> {
        let sum = u32::try_from(self.shifted(n)).ok().filter(|sum| *sum <= LARGEST);
        sum.ok_or_else(|| too_many(self.word))
    }

    /// The number of what is used. Beyond all numbers of parts begin those of the next instance.
    fn number(&self, n: u32, what: &'static str, location: &Location) -> Result<u32, DeckError> {
        if n <= self.largest {
            self.sum(n)
        } else {
            Err(Word::new(location, n.to_string()).fault(Fault::UnknownNumber(what)))
        }
    }

    fn place(&self, point: Vec3) -> Vec3 {
        let (by, turn) = &self.moved;
        // numbers of parts that stay where they are keep their bits
        let moved = if *by == [0.0; 3] { point } else { add(point, *by) };
        let Some(([a, b], degrees)) = turn else {
            return moved;
        };
        let axis = unit(sub(*b, *a));
        let arm = sub(moved, *a);
        let along = scale(dot(arm, axis), axis);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let across = sub(arm, along);
        let turned = add(scale(cosine, across), scale(sine, cross(axis, across)));
        add(*a, add(along, turned))
    }
}
