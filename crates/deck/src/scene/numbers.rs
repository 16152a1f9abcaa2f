//! Numbers and sets of the deck as positions in its tables.

use std::collections::HashSet;

use crate::error::{DeckError, Fault, Location, Word};
use crate::lexer::Named;
use crate::model::{Element, Member, Model, Names, Set, Target};

/// Most members of all sets together.
const MEMBERS: u64 = 200_000_000;

/// Positions by number, ascending.
#[derive(Debug, Clone, Default)]
pub(crate) struct Numbers(Vec<(u32, u32)>);

impl Numbers {
    /// Of (number, position) pairs; two with the same number are the error.
    pub(crate) fn new(mut pairs: Vec<(u32, u32)>) -> Result<Self, [u32; 2]> {
        pairs.sort_unstable();
        match pairs.windows(2).find(|w| w[0].0 == w[1].0) {
            Some(w) => Err([w[0].1, w[1].1]),
            None => Ok(Self(pairs)),
        }
    }

    pub(crate) fn get(&self, number: u32) -> Option<u32> {
        let at = self.0.binary_search_by_key(&number, |p| p.0).ok()?;
        Some(self.0[at].1)
    }

    /// The positions of the numbers from, from + step, ..., up to to, as far as there are any.
    fn range(&self, from: u32, to: u32, step: u32) -> impl Iterator<Item = u32> {
        let start = self.0.partition_point(|p| p.0 < from);
        let end = self.0.partition_point(|p| p.0 <= to);
        let inside = self.0[start..end.max(start)].iter();
        inside.filter(move |p| (p.0 - from).is_multiple_of(step)).map(|p| p.1)
    }
}

/// All numbers and sets, as positions in the tables of nodes and elements of the deck.
#[derive(Debug)]
pub(super) struct Sets<'a> {
    pub(super) model: &'a Model,
    node_numbers: Numbers,
    element_numbers: Numbers,
    pub(super) nodes: Vec<Vec<u32>>,
    pub(super) elements: Vec<Vec<u32>>,
}

impl<'a> Sets<'a> {
    pub(super) fn new(model: &'a Model) -> Result<Self, DeckError> {
        let at = |n: usize| (model.nodes[n].label, &model.nodes[n].location);
        let remedy = "give each node a number of its own";
        let node_numbers = numbers(model.nodes.len(), at, remedy)?;
        let at = |e: usize| (model.elements[e].label, &model.elements[e].location);
        let remedy = "give each element a number of its own";
        let element_numbers = numbers(model.elements.len(), at, remedy)?;
        let mut room = MEMBERS;
        let nodes = resolve("node", &model.nsets, &node_numbers, model.nodes.len(), &mut room)?;
        let count = model.elements.len();
        let elements = resolve("element", &model.elsets, &element_numbers, count, &mut room)?;
        Ok(Self {
            model,
            node_numbers,
            element_numbers,
            nodes,
            elements,
        })
    }

    /// Positions of the nodes of a target.
    pub(super) fn nodes(&self, target: &Target, word: &Word) -> Result<Vec<u32>, DeckError> {
        let what = ("node", "node set");
        find(what, target, &self.node_numbers, &self.model.nsets, &self.nodes, word)
    }

    /// Positions of the elements of a target.
    pub(super) fn elements(&self, target: &Target, word: &Word) -> Result<Vec<u32>, DeckError> {
        let what = ("element", "element set");
        find(
            what,
            target,
            &self.element_numbers,
            &self.model.elsets,
            &self.elements,
            word,
        )
    }

    /// Positions of the corners of an element.
    pub(super) fn corners(&self, element: &Element) -> Result<[u32; 4], DeckError> {
        self.positions(element, element.nodes)
    }

    /// Positions of the nodes on the edges of an element C3D10; `None` for others.
    pub(super) fn mids(&self, element: &Element) -> Result<Option<[u32; 6]>, DeckError> {
        let quadratic = element.mids != [0; 6];
        quadratic.then(|| self.positions(element, element.mids)).transpose()
    }

    fn positions<const N: usize>(&self, element: &Element, labels: [u32; N]) -> Result<[u32; N], DeckError> {
        let mut nodes = [0; N];
        for (position, label) in nodes.iter_mut().zip(labels) {
            let unknown = || Word::new(&element.location, label.to_string()).fault(Fault::UnknownNumber("node"));
            *position = self.node_numbers.get(label).ok_or_else(unknown)?;
        }
        Ok(nodes)
    }

    /// Positions of the elements of a set.
    pub(super) fn elements_of(&self, set: &Named) -> Result<Vec<u32>, DeckError> {
        self.elements(&Target::Name(set.name.clone()), &set.word)
    }
}

/// The positions of so many things by number; `at` tells number and place of each.
fn numbers<'a>(
    count: usize,
    at: impl Fn(usize) -> (u32, &'a Location),
    remedy: &'static str,
) -> Result<Numbers, DeckError> {
    let pairs = (0..count).map(|position| (at(position).0, position as u32));
    Numbers::new(pairs.collect()).map_err(|[first, second]| {
        let (label, location) = at(second as usize);
        let first = at(first as usize).1.line;
        Word::new(location, label.to_string()).fault(Fault::Repeated { first, remedy })
    })
}

fn find(
    (what, what_set): (&'static str, &'static str),
    target: &Target,
    numbers: &Numbers,
    names: &Names<Set>,
    sets: &[Vec<u32>],
    word: &Word,
) -> Result<Vec<u32>, DeckError> {
    match target {
        Target::Number(number) => {
            let found = numbers.get(*number);
            Ok(vec![found.ok_or_else(|| word.fault(Fault::UnknownNumber(what)))?])
        }
        Target::Name(name) => match &sets[names.find(what_set, name, word)?][..] {
            [] => Err(word.cannot("the set is empty; fill it, or remove this line")),
            set => Ok(set.to_vec()),
        },
    }
}

/// The members of each set, ascending.
fn resolve(
    what: &'static str,
    names: &Names<Set>,
    numbers: &Numbers,
    count: usize,
    room: &mut u64,
) -> Result<Vec<Vec<u32>>, DeckError> {
    const NOT_YET: u32 = u32::MAX;
    let unknown = |location: &Location, word: String| Word::new(location, word).fault(Fault::UnknownNumber(what));
    let mut sets: Vec<Vec<u32>> = Vec::new();
    let mut last = vec![NOT_YET; count];
    for (index, (_, set)) in names.iter().enumerate() {
        let mut members = Vec::new();
        let mut add = |position: u32| {
            if std::mem::replace(&mut last[position as usize], index as u32) != index as u32 {
                members.push(position);
            }
        };
        let mut taken = HashSet::new();
        for (member, location) in set {
            match member {
                Member::One(number) => match numbers.get(*number) {
                    Some(position) => add(position),
                    None => return Err(unknown(location, number.to_string())),
                },
                Member::Range { from, to, step } => {
                    let mut inside = numbers.range(*from, *to, *step).peekable();
                    if inside.peek().is_none() {
                        return Err(unknown(location, format!("{from}, {to}, {step}")));
                    }
                    inside.for_each(&mut add);
                }
                Member::Set(name) => {
                    let word = Word::new(location, name);
                    let other = names.find("set", name, &word)?;
                    if other >= index {
                        let why = "a set may name only sets that are defined before it; move the other one up";
                        return Err(word.cannot(why));
                    }
                    if taken.insert(other) {
                        sets[other].iter().copied().for_each(&mut add);
                    }
                }
            }
        }
        members.sort_unstable();
        match room.checked_sub(members.len() as u64) {
            Some(left) => *room = left,
            None => {
                let (member, location) = &set[0];
                return Err(Word::new(location, format!("{member:?}")).fault(Fault::TooMany {
                    what: "members of sets",
                    most: MEMBERS,
                    remedy: "remove sets that are not needed",
                }));
            }
        }
        sets.push(members);
    }
    Ok(sets)
}
