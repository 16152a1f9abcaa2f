//! What one condition does in all steps, as one factor in time.
//!
//! A value without an amplitude goes along a straight line from that at the end of the step before; with one it
//! is the value times the amplitude. What a later step does not name stays as it was at the end of the step
//! before, or follows its amplitude if that is in total time; what a step removes goes back to zero along a
//! straight line, or at once if it followed one. A jump at the beginning of a step becomes a line over its first increment.

use std::collections::BTreeMap;

use signorini_fem_mesh::History;

use super::timeline::{Span, Timeline};
use crate::error::{DeckError, Fault, Word};
use crate::model::{Amplitude, Given};

/// What the steps say about one condition: by step, a value or its removal.
#[derive(Debug, Clone)]
pub(super) struct Track {
    events: Vec<(usize, Option<Given>)>,
    /// Its place among all conditions of the deck.
    pub(super) order: usize,
    /// Where it appears first.
    pub(super) word: Word,
    /// A value and its factor that stand in place of events.
    course: Option<(f64, History)>,
    /// What the values are before the first event and after a removal; only the rise above it counts.
    base: f64,
}

impl Track {
    pub(super) fn new(order: usize, word: &Word) -> Self {
        Self {
            events: Vec::new(),
            order,
            word: word.clone(),
            course: None,
            base: 0.0,
        }
    }

    /// Whether all steps say the same of both, or that both stay at zero.
    pub(super) fn says_as(&self, other: &Self) -> bool {
        let bare = self.course.is_none() && other.course.is_none();
        let same = bare && self.base == other.base && self.events == other.events;
        same || self.reference().is_none() && other.reference().is_none()
    }

    /// The same with values of which the rise above `base` counts.
    pub(super) fn above(self, base: f64) -> Self {
        Self { base, ..self }
    }

    /// The same with a value and a history that follow from others.
    pub(super) fn with_course(&self, value: f64, history: History) -> Self {
        Self {
            course: Some((value, history)),
            ..Self::new(self.order, &self.word)
        }
    }

    /// The same, but with a displacement that follows from others.
    pub(super) fn moving(&self, value: f64, history: History) -> Self {
        Self {
            course: Some((value, history)),
            ..self.clone()
        }
    }

    /// A value, and the points of the factor that multiplies it; `None` if it is zero at all times.
    pub(super) fn course(&self, timeline: &Timeline) -> Option<(f64, Vec<(f64, f64)>)> {
        let reference = self.reference()?;
        Some((reference, self.points(timeline, reference)))
    }

    /// Tracks of which this is the sum at the ends of increments: one for each value, and one for the base. The factor
    /// of each depends on steps and amplitudes alone.
    pub(super) fn parts(&self) -> impl Iterator<Item = Self> {
        let only = |kept: Option<usize>| {
            let part = |(at, (step, given)): (usize, &(usize, Option<Given>))| {
                let value = |given: Given| if kept == Some(at) { given.value } else { 0.0 };
                let given = given.map(|given| Given {
                    value: value(given),
                    ..given
                });
                (*step, given)
            };
            Self {
                events: self.events.iter().enumerate().map(part).collect(),
                base: if kept.is_none() { self.base } else { 0.0 },
                order: self.order,
                word: self.word.clone(),
                course: self.course.clone(),
            }
        };
        let kept = (0..self.events.len()).map(Some).chain([None]);
        kept.map(only)
    }

    /// The value that this step gives, if it does.
    pub(super) fn given_in(&self, step: usize) -> Option<Given> {
        self.event(step).flatten()
    }

    pub(super) fn set(&mut self, step: usize, given: Given) {
        self.put(step, Some(given));
    }

    /// Ends the condition in a step, if it has not ended before.
    pub(super) fn remove(&mut self, step: usize) {
        if self.events.last().is_some_and(|event| event.1.is_some()) {
            self.put(step, None);
        }
    }

    /// The first step that says something.
    pub(super) fn first_step(&self) -> Option<usize> {
        self.events.first().map(|event| event.0)
    }

    /// Whether the last value follows an amplitude in total time.
    pub(super) fn follows(&self, timeline: &Timeline) -> bool {
        let last = self.events.iter().rev().find_map(|event| event.1);
        let amplitude = last.and_then(|given| given.amplitude);
        amplitude.is_some_and(|amplitude| timeline.model.amplitudes.at(amplitude).total)
    }

    /// Takes back what a step says; what nothing else is said of is held where it is at rest.
    pub(super) fn forget(&mut self, step: usize) {
        self.events.retain(|event| event.0 != step);
        if self.events.is_empty() {
            let (value, amplitude) = (0.0, None);
            self.set(step, Given { value, amplitude });
        }
    }

    /// Whether nothing changes it from a step on.
    pub(super) fn rests_from(&self, step: usize, timeline: &Timeline) -> bool {
        let said = self.events.last().is_none_or(|event| event.0 < step);
        said && self.course.is_none() && !self.follows(timeline)
    }

    /// Whether a step removes it.
    pub(super) fn is_removed_in(&self, step: usize) -> bool {
        self.event(step) == Some(None)
    }

    fn put(&mut self, step: usize, event: Option<Given>) {
        match self.events.last_mut() {
            Some(last) if last.0 == step => last.1 = event,
            _ => self.events.push((step, event)),
        }
    }

    fn event(&self, step: usize) -> Option<Option<Given>> {
        let at = self.events.binary_search_by_key(&step, |e| e.0).ok()?;
        Some(self.events[at].1)
    }

    /// The value that the factor multiplies: the first that is not zero; `None` if there is none.
    fn reference(&self) -> Option<f64> {
        if let Some((value, _)) = &self.course {
            return Some(*value).filter(|value| *value != 0.0);
        }
        if self.base != 0.0 {
            return Some(self.base);
        }
        let values = self.events.iter().filter_map(|e| Some(e.1?.value));
        values.into_iter().find(|value| *value != 0.0)
    }

    /// The points of the factor, times strictly ascending.
    fn points(&self, timeline: &Timeline, reference: f64) -> Vec<(f64, f64)> {
        if let Some((_, history)) = &self.course {
            return history.points().to_vec();
        }
        let spans = &timeline.spans;
        let mut points = Vec::new();
        let base = self.base / reference;
        let (mut value, mut follows) = (base, None);
        for (step, span) in spans.iter().enumerate() {
            let law = match self.event(step) {
                Some(Some(given)) => match given.amplitude {
                    Some(amplitude) => {
                        let amplitude = timeline.model.amplitudes.at(amplitude);
                        Law::Amplitude(given.value / reference, amplitude)
                    }
                    None => Law::to(value, given.value / reference, span.ramp),
                },
                // as in CalculiX
                Some(None) => Law::to(value, base, follows.is_none()),
                None => follows.unwrap_or(Law::Constant(value)),
            };
            follows = match law {
                Law::Amplitude(_, Amplitude { total: true, .. }) => Some(law),
                _ => None,
            };
            law.append(span, step + 1 == spans.len(), &mut points);
            value = law.at(span, span.end);
        }
        simplified(points)
    }
}

/// A condition by what it acts on.
pub(super) struct Tracks<K>(pub(super) BTreeMap<K, Track>);

impl<K> Default for Tracks<K> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<K: Ord> Tracks<K> {
    pub(super) fn remove(&mut self, step: usize) {
        self.0.values_mut().for_each(|track| track.remove(step));
    }

    /// Notes a value. Another one in the same step is added, if it may be and has the same amplitude.
    pub(super) fn set(
        &mut self,
        key: K,
        (step, order, adds): (usize, usize, bool),
        mut given: Given,
        word: &Word,
    ) -> Result<(), DeckError> {
        let track = self.0.entry(key).or_insert_with(|| Track::new(order, word));
        if let Some(before) = track.given_in(step) {
            if !adds || before.amplitude != given.amplitude {
                return Err(word.cannot(if adds {
                    "a force along this component is given in this step already, with another amplitude; \
                    put them on different nodes, or give one amplitude"
                } else {
                    "such a load is given there in this step already; add the values and give their sum once"
                }));
            }
            given.value += before.value;
        }
        track.set(step, given);
        Ok(())
    }
}

/// A factor within a step.
#[derive(Clone, Copy)]
enum Law<'a> {
    Constant(f64),
    Line(f64, f64),
    Amplitude(f64, &'a Amplitude),
}

impl Law<'_> {
    fn to(from: f64, to: f64, ramp: bool) -> Self {
        if ramp && from != to { Self::Line(from, to) } else { Self::Constant(to) }
    }

    fn at(&self, span: &Span, time: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Line(from, to) => {
                if time >= span.end {
                    *to
                } else {
                    from + (to - from) * ((time - span.start) / (span.end - span.start))
                }
            }
            Self::Amplitude(factor, amplitude) => factor * amplitude.history.value(time - Self::shift(amplitude, span)),
        }
    }

    fn shift(amplitude: &Amplitude, span: &Span) -> f64 {
        if amplitude.total { 0.0 } else { span.start }
    }

    /// Adds the points of a step to those before.
    fn append(&self, span: &Span, last: bool, points: &mut Vec<(f64, f64)>) {
        let push = |points: &mut Vec<(f64, f64)>, time: f64, value: f64| {
            if points.last().is_none_or(|p| p.0 < time) {
                points.push((time, value));
            }
        };
        let begin = self.at(span, span.start);
        // the beginning is the end of the step before; what jumps there takes the first increment
        if points.last().is_some_and(|p| p.1 != begin) {
            push(points, span.first, self.at(span, span.first));
        } else {
            push(points, span.start, begin);
        }
        let mut beyond = false;
        if let Self::Amplitude(factor, amplitude) = self {
            let shift = Self::shift(amplitude, span);
            for &(time, value) in &amplitude.points {
                let time = time + shift;
                beyond |= time >= span.end;
                // after the last step the table goes on, as if there was none
                if time < span.end || last {
                    push(points, time, factor * value);
                }
            }
        }
        if !(last && beyond) {
            push(points, span.end, self.at(span, span.end));
        }
    }
}

/// Without points between two of the same value, and after the last change.
fn simplified(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        let flat = kept.len() > 1 && kept[kept.len() - 2..].iter().all(|p| p.1 == point.1);
        if flat {
            kept.pop();
        }
        kept.push(point);
    }
    while kept.len() > 1 && kept[kept.len() - 2].1 == kept[kept.len() - 1].1 {
        kept.pop();
    }
    kept
}

/// Histories, each once.
#[derive(Debug, Default)]
pub(super) struct Histories {
    list: Vec<History>,
    places: BTreeMap<Vec<(u64, u64)>, usize>,
}

impl Histories {
    /// The value of a condition and the position of its history; `None` if it is zero at all times.
    pub(super) fn add(&mut self, timeline: &Timeline, track: &Track) -> Result<Option<(f64, usize)>, DeckError> {
        let Some(mut reference) = track.reference() else {
            return Ok(None);
        };
        let mut points = track.points(timeline, reference);
        if points.is_empty() {
            return Err(track
                .word
                .cannot("a value acts in steps, and there are none; give it behind a *STEP, or give none"));
        }
        if track.base != 0.0 {
            // factors of the base become those of the first rise
            points.iter_mut().for_each(|p| p.1 -= 1.0);
            let first = points.iter().map(|p| p.1).find(|rise| *rise != 0.0).unwrap_or(1.0);
            // without negative zeros
            points.iter_mut().for_each(|p| p.1 = p.1 / first + 0.0);
            reference *= first;
        }
        if points.iter().all(|p| p.1 == 0.0) {
            return Ok(None);
        }
        let key = points.iter().map(|p| (p.0.to_bits(), p.1.to_bits()));
        let next = self.list.len();
        let position = *self.places.entry(key.collect()).or_insert(next);
        if position == next {
            // numbers are finite but for quotients that overflow
            let table = History::table(points);
            self.list.push(table.map_err(|e| track.word.fault(Fault::History(e)))?);
        }
        Ok(Some((reference, position)))
    }

    pub(super) fn at(&self, position: usize) -> History {
        self.list[position].clone()
    }
}
