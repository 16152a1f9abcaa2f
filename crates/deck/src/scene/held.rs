//! What the steps say of one component of a node that is held.

use std::collections::BTreeMap;

use super::history::Track;
use super::timeline::{Acting, Beginning, Timeline};
use crate::error::{DeckError, Word};
use crate::model::{Components, Condition, Given};

/// A node of the mesh, or the position of one, and a component.
pub(super) type Key = (u32, usize);

/// Name of a target, and the first word that is it.
pub(super) type Owner = (String, Word);

/// A held component of a node: the target that it is given on first, and what the steps say.
#[derive(Clone)]
pub(super) struct Held {
    pub(super) owner: usize,
    pub(super) track: Track,
    /// Given before the first step, which may say it anew.
    pub(super) before: bool,
    /// Begins with FIXED: it stays where it is then.
    pub(super) fixed: bool,
    /// The step from which on it is held, if that is not the first, and that which releases it.
    pub(super) span: Acting,
}

impl Held {
    /// Notes a value of a component of a node with this number in the deck; `step` is none before the first.
    fn give(&mut self, step: Option<usize>, given: Given, what: &str) -> Result<(), String> {
        let now = step.unwrap_or(0);
        let again = !(self.before && step == Some(0));
        if let Some(before) = self.track.given_in(now)
            && again
            && before != given
            && (before.value, given.value) != (0.0, 0.0)
        {
            let (before, now) = (before.value, given.value);
            return Err(format!(
                "{what} is given {before} and {now} in one step; keep one of them"
            ));
        }
        self.before = step.is_none();
        self.track.set(now, given);
        Ok(())
    }

    pub(super) fn beginning(&self, timeline: &Timeline) -> Beginning {
        let [from, _] = self.span;
        let ramp = timeline.span(from).is_some_and(|span| span.ramp);
        let by_line = |step| self.track.given_in(step).is_some_and(|given| given.amplitude.is_none());
        match self.fixed {
            true => Beginning::Stay,
            false if ramp && from.is_some_and(by_line) => Beginning::Line,
            false => Beginning::Jump,
        }
    }
}

/// What a line says of a component of a node.
pub(super) struct Said<'a> {
    pub(super) line: &'a Condition<Components>,
    /// Its target.
    pub(super) owner: usize,
    /// Its step; none before the first.
    pub(super) step: Option<usize>,
    /// The step from which on the component is held, if that is not the first.
    pub(super) from: Option<usize>,
    /// The component in words.
    pub(super) what: String,
}

impl Said<'_> {
    /// Notes it in a table of held components.
    pub(super) fn note(&self, table: &mut BTreeMap<Key, Held>, key: Key, timeline: &Timeline) -> Result<(), DeckError> {
        let (line, next) = (self.line, table.len());
        let refuse = |word: &Word, why| Err(word.cannot(format!("{} {why}", self.what)));
        match (table.get_mut(&key), self.step, &line.kind.fixed) {
            (Some(held), _, None) if held.fixed => {
                return refuse(&line.word, "is FIXED, and stays so; remove one of both");
            }
            (Some(held), _, Some(fixed)) if held.track.follows(timeline) => {
                return refuse(fixed, "follows an amplitude in total time; end that before");
            }
            (Some(held), Some(step), Some(_)) => {
                held.track.forget(step);
                if held.span[0] != Some(step) {
                    return Ok(());
                }
                held.fixed = true;
            }
            _ => {}
        }
        let held = table.entry(key).or_insert_with(|| Held {
            owner: self.owner,
            track: Track::new(next, &line.word),
            before: self.step.is_none(),
            fixed: self.from.is_some() && line.kind.fixed.is_some(),
            span: [self.from, None],
        });
        let given = held.give(self.step, line.given, &self.what);
        given.map_err(|why| line.word.cannot(why))
    }
}

/// The steps in which both act.
pub(super) fn common([from, until]: Acting, [other_from, other_until]: Acting) -> Option<Acting> {
    let from = from.max(other_from);
    let until = [until, other_until].into_iter().flatten().min();
    until
        .is_none_or(|until| from.unwrap_or(0) < until)
        .then_some([from, until])
}
