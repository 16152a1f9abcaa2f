//! The steps on one axis of time.

use signorini_contact::{Analysis, DifferenceFormula, Support};
use signorini_fem_mesh::History;

use crate::error::{DeckError, Fault};
use crate::model::{INCREMENTS, Model};

/// A step on the axis of time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) start: f64,
    pub(super) end: f64,
    /// End of the first increment.
    pub(super) first: f64,
    /// Whether what has no amplitude changes along a straight line; else it jumps.
    pub(super) ramp: bool,
}

/// From which step on something acts, if not from the first, and up to which.
pub(super) type Acting = [Option<usize>; 2];

/// How a support begins whose nodes were free.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Beginning {
    /// They jump to what the steps say.
    Jump,
    /// They go there along a straight line, in the first of its steps.
    Line,
    /// They stay where they are.
    Stay,
}

#[derive(Debug)]
pub(super) struct Timeline<'a> {
    pub(super) model: &'a Model,
    pub(super) spans: Vec<Span>,
    times: Vec<f64>,
}

impl<'a> Timeline<'a> {
    pub(super) fn new(model: &'a Model) -> Result<Self, DeckError> {
        let (mut spans, mut times) = (Vec::new(), Vec::new());
        let mut start = 0.0;
        for step in &model.steps {
            let Some((word, increments)) = &step.time else {
                continue;
            };
            if (times.len() + increments.count) as f64 > INCREMENTS {
                return Err(word.fault(Fault::TooMany {
                    what: "increments in all steps",
                    most: INCREMENTS as u64,
                    remedy: "make the increments larger",
                }));
            }
            for i in 1..=increments.count {
                let time = start + increments.time(i);
                if !(time.is_finite() && times.last().is_none_or(|before| time > *before)) {
                    return Err(word.cannot(format!(
                        "increment {i} does not end later than the one before, by rounding; its step starts at {start}"
                    )));
                }
                times.push(time);
            }
            let end = start + increments.period;
            spans.push(Span {
                start,
                end,
                first: start + increments.time(1),
                ramp: step.ramp,
            });
            start = end;
        }
        Ok(Self { model, spans, times })
    }

    /// Increments up to the end of each step, and where it stands.
    pub(super) fn steps(&self) -> Vec<(usize, String)> {
        let mut end = 0;
        let steps = self.model.steps.iter().map(|step| {
            end += step.time.as_ref().map_or(0, |(_, increments)| increments.count);
            (end, step.word.told())
        });
        steps.collect()
    }

    /// How often an increment of any step may be halved.
    pub(super) fn halvings(&self) -> u32 {
        let increments = self.model.steps.iter().filter_map(|step| step.time.as_ref());
        increments.map(|(_, increments)| increments.halvings).min().unwrap_or(0)
    }

    /// That of a step, if there is one.
    pub(super) fn span(&self, step: Option<usize>) -> Option<&Span> {
        self.spans.get(step?)
    }

    /// A support from a step on, and until another.
    pub(super) fn during(
        &self,
        support: Support,
        [from, until]: Acting,
        beginning: Beginning,
    ) -> Result<Support, DeckError> {
        let support = self
            .span(until)
            .map_or(support.clone(), |span| support.with_end(span.start));
        let Some(first) = self.span(from) else {
            return Ok(support);
        };
        let support = support.with_start(first.start);
        let line = match beginning {
            Beginning::Stay => return Ok(support),
            Beginning::Line => History::table(vec![(first.start, 1.0), (first.end, 0.0)]),
            Beginning::Jump => Ok(History::constant(0.0)),
        };
        let word = &self.model.steps[from.unwrap_or(0)].word;
        let line = line.map_err(|error| word.fault(Fault::History(error)))?;
        Ok(support.with_fading(line))
    }

    /// Backward Euler over all increments; a single one is static.
    pub(super) fn analysis(&self) -> Analysis {
        match self.times[..] {
            [] => Analysis::statics(),
            [time] => Analysis::Static { time },
            _ => Analysis::Quasistatic {
                times: self.times.clone(),
                formula: DifferenceFormula::BACKWARD_EULER,
            },
        }
    }
}
