//! Numbers and sets of the deck as positions in its tables.

use std::collections::HashSet;

use crate::error::{DeckError, Fault, Location, Word};
use crate::lexer::Named;
use crate::model::{Element, Member, Model, Names, Set, Target};

/// Most members of all sets together, each as often as it is named: so many, and for each node and element of the deck.
const MEMBERS: u64 = 1_000_000;
const MEMBERS_EACH: u64 = 20;

/// How many members sets may still get, of how many.
#[derive(Debug)]
struct Room {
    left: u64,
    most: u64,
}

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

/// Nodes or elements by numbers and sets, as positions in their table of the deck.
#[derive(Debug)]
pub(super) struct Table<'a> {
    what: &'static str,
    what_set: &'static str,
    names: &'a Names<Set>,
    numbers: Numbers,
    /// Members of each set, ascending.
    sets: Vec<Vec<u32>>,
}

/// The members of a set that are found so far.
#[derive(Debug, Clone, Default)]
struct Found {
    /// Positions, each once.
    members: Vec<u32>,
    /// How many there are after each entry of the set.
    ends: Vec<usize>,
    taken: HashSet<(usize, usize)>,
}

/// Of no set.
const NOT_YET: u32 = u32::MAX;

/// All numbers and sets.
#[derive(Debug)]
pub(super) struct Sets<'a> {
    pub(super) model: &'a Model,
    pub(super) nodes: Table<'a>,
    pub(super) elements: Table<'a>,
}

impl<'a> Table<'a> {
    /// `at` tells number and place of each of `count` things.
    fn new(
        [what, what_set, remedy]: [&'static str; 3],
        count: usize,
        at: impl Fn(usize) -> (u32, &'a Location),
        names: &'a Names<Set>,
    ) -> Result<Self, DeckError> {
        let pairs = (0..count).map(|position| (at(position).0, position as u32));
        let numbers = Numbers::new(pairs.collect()).map_err(|[first, second]| {
            let (label, location) = at(second as usize);
            let first = at(first as usize).1.clone();
            Word::new(location, label.to_string()).fault(Fault::Repeated { first, remedy })
        })?;
        Ok(Self {
            what,
            what_set,
            names,
            numbers,
            sets: Vec::new(),
        })
    }

    /// Positions of a target.
    pub(super) fn find(&self, target: &Target, word: &Word) -> Result<Vec<u32>, DeckError> {
        match target {
            Target::Number(number) => {
                let found = self.numbers.get(*number);
                Ok(vec![found.ok_or_else(|| word.fault(Fault::UnknownNumber(self.what)))?])
            }
            Target::All => Ok((0..self.numbers.0.len() as u32).collect()),
            Target::Name(name) => match &self.sets[self.names.find(self.what_set, name, word)?][..] {
                [] => Err(word.cannot("the set is empty; fill it, or remove this line")),
                set => Ok(set.to_vec()),
            },
        }
    }

    /// Finds the members of each set.
    fn resolve(&mut self, room: &mut Room) -> Result<(), DeckError> {
        let mut found: Vec<Found> = vec![Found::default(); self.names.len()];
        let mut last = vec![NOT_YET; self.numbers.0.len()];
        for index in 0..found.len() {
            // those that it waits for, with the number of their members that are wanted
            let mut waiting = vec![(index, self.names.at(index).len())];
            while let Some(&(set, wanted)) = waiting.last() {
                match self.add_members((set, wanted), &mut found, &mut last, room)? {
                    Some(first) => waiting.push(first),
                    None => _ = waiting.pop(),
                }
            }
        }
        for Found { mut members, .. } in found {
            members.sort_unstable();
            self.sets.push(members);
        }
        Ok(())
    }

    /// Goes on with the members of a set up to the wanted ones; another set and its members if these come first. `last`
    /// says of each position to which set it was added last.
    fn add_members(
        &self,
        (set, wanted): (usize, usize),
        found: &mut [Found],
        last: &mut [u32],
        room: &mut Room,
    ) -> Result<Option<(usize, usize)>, DeckError> {
        let unknown =
            |location: &Location, word: String| Word::new(location, word).fault(Fault::UnknownNumber(self.what));
        let mut own = std::mem::take(&mut found[set]);
        own.members
            .iter()
            .for_each(|member| last[*member as usize] = set as u32);
        while own.ends.len() < wanted {
            let (members, mut named) = (&mut own.members, 0);
            let mut add = |position: u32| {
                named += 1;
                if std::mem::replace(&mut last[position as usize], set as u32) != set as u32 {
                    members.push(position);
                }
            };
            let (member, location) = &self.names.at(set)[own.ends.len()];
            match member {
                Member::One(number) => match self.numbers.get(*number) {
                    Some(position) => add(position),
                    None => return Err(unknown(location, number.to_string())),
                },
                Member::Range { from, to, step } => {
                    let mut inside = self.numbers.range(*from, *to, *step).peekable();
                    if inside.peek().is_none() {
                        return Err(unknown(location, format!("{from}, {to}, {step}")));
                    }
                    inside.for_each(&mut add);
                }
                Member::Set(name, before) => {
                    let word = Word::new(location, name);
                    let other = self.names.find("set", name, &word)?;
                    let Some(before) = *before else {
                        let why = "a set may name only sets that are defined before it; move the other one up";
                        return Err(word.cannot(why));
                    };
                    // of its own it has all
                    if other != set && before > 0 && !own.taken.contains(&(other, before)) {
                        let Some(&end) = found[other].ends.get(before - 1) else {
                            found[set] = own;
                            return Ok(Some((other, before)));
                        };
                        found[other].members[..end].iter().copied().for_each(&mut add);
                        own.taken.insert((other, before));
                    }
                }
            }
            room.left = room.left.checked_sub(named).ok_or_else(|| {
                let name = self.names.iter().nth(set).map_or("", |known| known.0);
                Word::new(location, name).fault(Fault::TooMany {
                    what: "members of sets",
                    most: room.most,
                    remedy: "remove sets that are not needed",
                })
            })?;
            own.ends.push(own.members.len());
        }
        found[set] = own;
        Ok(None)
    }

    /// The sets by name, with what the positions in each are to be taken for.
    pub(super) fn named(self, new: impl Fn(Vec<u32>) -> Vec<u32>) -> Names<Vec<u32>> {
        let mut named = Names::default();
        for (name, set) in self.names.names().into_iter().zip(self.sets) {
            named.add(name, new(set));
        }
        named
    }
}

impl<'a> Sets<'a> {
    pub(super) fn new(model: &'a Model) -> Result<Self, DeckError> {
        let what = ["node", "node set", "give each node a number of its own"];
        let at = |n: usize| (model.nodes[n].label, &model.nodes[n].location);
        let mut nodes = Table::new(what, model.nodes.len(), at, &model.nsets)?;
        let what = ["element", "element set", "give each element a number of its own"];
        let at = |e: usize| (model.elements[e].label, &model.elements[e].location);
        let mut elements = Table::new(what, model.elements.len(), at, &model.elsets)?;
        let most = MEMBERS + MEMBERS_EACH * (model.nodes.len() + model.elements.len()) as u64;
        let mut room = Room { left: most, most };
        nodes.resolve(&mut room)?;
        elements.resolve(&mut room)?;
        Ok(Self { model, nodes, elements })
    }

    /// Positions of the nodes of an element.
    pub(super) fn nodes_of(&self, element: &Element) -> Result<Vec<u32>, DeckError> {
        let position = |label: &u32| {
            let unknown = || Word::new(&element.location, label.to_string()).fault(Fault::UnknownNumber("node"));
            self.nodes.numbers.get(*label).ok_or_else(unknown)
        };
        element.nodes.iter().map(position).collect()
    }

    /// The position of a target that is one node.
    pub(super) fn one_node(&self, target: &Target, word: &Word) -> Result<u32, DeckError> {
        match self.nodes.find(target, word)?[..] {
            [node] => Ok(node),
            _ => Err(word.expected("one node")),
        }
    }

    /// Positions of the elements of a set.
    pub(super) fn elements_of(&self, set: &Named) -> Result<Vec<u32>, DeckError> {
        self.elements.find(&Target::Name(set.name.clone()), &set.word)
    }
}
