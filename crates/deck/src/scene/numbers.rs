//! Numbers and sets of the deck as positions in its tables.

use crate::error::{DeckError, Fault, Location, Word};
use crate::lexer::Named;
use crate::model::{Element, Member, Model, Names, SetCard, Target};

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

    /// The positions of the numbers from, from + step, ..., and to, as far as there are any.
    fn range(&self, from: u32, to: u32, step: u32) -> impl Iterator<Item = u32> {
        let start = self.0.partition_point(|p| p.0 < from);
        let end = self.0.partition_point(|p| p.0 <= to);
        let inside = self.0[start..end.max(start)].iter();
        // both ends, as CalculiX does
        inside
            .filter(move |p| (p.0 - from).is_multiple_of(step) || p.0 == to)
            .map(|p| p.1)
    }
}

/// Nodes or elements by numbers and sets, as positions in their table of the deck.
#[derive(Debug)]
pub(super) struct Table {
    what: &'static str,
    what_set: &'static str,
    numbers: Numbers,
    /// Members of each set, ascending.
    sets: Names<Vec<u32>>,
}

/// All numbers and sets.
#[derive(Debug)]
pub(super) struct Sets<'a> {
    pub(super) model: &'a Model,
    pub(super) nodes: Table,
    pub(super) elements: Table,
}

impl Table {
    /// `at` tells number and place of each of `count` things, `cards` what is said of sets.
    fn new<'a>(
        [what, what_set, remedy]: [&'static str; 3],
        count: usize,
        at: impl Fn(usize) -> (u32, &'a Location),
        (cards, room): (&[SetCard], &mut Room),
    ) -> Result<Self, DeckError> {
        let pairs = (0..count).map(|position| (at(position).0, position as u32));
        let numbers = Numbers::new(pairs.collect()).map_err(|[first, second]| {
            let (label, location) = at(second as usize);
            let first = at(first as usize).1.clone();
            Word::new(location, label.to_string()).fault(Fault::Repeated { first, remedy })
        })?;
        let mut table = Self {
            what,
            what_set,
            numbers,
            sets: Names::default(),
        };
        table.resolve(cards, room)?;
        Ok(table)
    }

    /// Positions of a target.
    pub(super) fn find(&self, target: &Target, word: &Word) -> Result<Vec<u32>, DeckError> {
        match target {
            Target::Number(number) => {
                let found = self.numbers.get(*number);
                Ok(vec![found.ok_or_else(|| word.fault(Fault::UnknownNumber(self.what)))?])
            }
            Target::All => Ok((0..self.numbers.0.len() as u32).collect()),
            Target::Name(name) => match &self.sets.at(self.sets.find(self.what_set, name, word)?)[..] {
                [] => Err(word.cannot("the set is empty; fill it, or remove this line")),
                set => Ok(set.to_vec()),
            },
        }
    }

    /// Finds the members of each set: what *NODE and *ELEMENT say, wherever they stand, and then the other cards in
    /// their order, as CalculiX reads them.
    fn resolve(&mut self, cards: &[SetCard], room: &mut Room) -> Result<(), DeckError> {
        let places: Vec<usize> = cards.iter().map(|card| self.sets.place(&card.name)).collect();
        let mut begun = vec![false; self.sets.len()];
        let (first, later): (Vec<_>, Vec<_>) = cards.iter().zip(places).partition(|(card, _)| card.defines);
        for (card, set) in first.into_iter().chain(later) {
            let mut own = std::mem::take(self.sets.at_mut(set));
            for (member, location) in &card.members {
                let before = own.len();
                self.add_member(&mut own, member, location, |other| (begun[other], other == set))?;
                let named = (own.len() - before) as u64;
                room.left = room.left.checked_sub(named).ok_or_else(|| {
                    Word::new(location, &card.name).fault(Fault::TooMany {
                        what: "members of sets",
                        most: room.most,
                        remedy: "remove sets that are not needed",
                    })
                })?;
            }
            *self.sets.at_mut(set) = own;
            begun[set] = true;
        }
        (0..self.sets.len()).for_each(|set| tidy(self.sets.at_mut(set)));
        Ok(())
    }

    /// Adds what a member stands for to those of its set, maybe once more; `known` says of another set whether it has
    /// begun, and whether it is this one.
    fn add_member(
        &mut self,
        own: &mut Vec<u32>,
        member: &Member,
        location: &Location,
        known: impl Fn(usize) -> (bool, bool),
    ) -> Result<(), DeckError> {
        let unknown = |word: String| Word::new(location, word).fault(Fault::UnknownNumber(self.what));
        match member {
            Member::One(number) => own.push(self.numbers.get(*number).ok_or_else(|| unknown(number.to_string()))?),
            Member::Range { from, to, step } => {
                let mut inside = self.numbers.range(*from, *to, *step).peekable();
                if inside.peek().is_none() {
                    return Err(unknown(format!("{from}, {to}, {step}")));
                }
                own.extend(inside);
            }
            Member::Set(name) => {
                let word = Word::new(location, name);
                let other = self.sets.find("set", name, &word)?;
                match known(other) {
                    (false, _) => {
                        let why = "a set may name only sets that are defined before it; move the other one up";
                        return Err(word.cannot(why));
                    }
                    // of its own it has all
                    (true, true) => {}
                    (true, false) => {
                        let other = self.sets.at_mut(other);
                        tidy(other);
                        own.extend_from_slice(other);
                    }
                }
            }
        }
        Ok(())
    }

    /// The sets by name, with what the positions in each are to be taken for.
    pub(super) fn named(self, new: impl Fn(Vec<u32>) -> Vec<u32>) -> Names<Vec<u32>> {
        let mut named = self.sets;
        for set in 0..named.len() {
            let members = named.at_mut(set);
            *members = new(std::mem::take(members));
        }
        named
    }
}

/// Each once, ascending.
fn tidy(members: &mut Vec<u32>) {
    members.sort_unstable();
    members.dedup();
}

impl<'a> Sets<'a> {
    pub(super) fn new(model: &'a Model) -> Result<Self, DeckError> {
        let most = MEMBERS + MEMBERS_EACH * (model.nodes.len() + model.elements.len()) as u64;
        let mut room = Room { left: most, most };
        let what = ["node", "node set", "give each node a number of its own"];
        let at = |n: usize| (model.nodes[n].label, &model.nodes[n].location);
        let nodes = Table::new(what, model.nodes.len(), at, (&model.nsets, &mut room))?;
        let what = ["element", "element set", "give each element a number of its own"];
        let at = |e: usize| (model.elements[e].label, &model.elements[e].location);
        let elements = Table::new(what, model.elements.len(), at, (&model.elsets, &mut room))?;
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
