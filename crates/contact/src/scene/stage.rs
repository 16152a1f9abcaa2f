//! Stages: spans of steps in which the same supports and contacts act, and the same motions of couplings are locked.

use super::scene::Scene;
use super::span::{Span, is_past};
use crate::part::Part;
use std::collections::BTreeSet;
use std::ops::Range;

/// The stage that a scene is set up for, with what earlier steps say of it.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Stage {
    /// Its first step.
    pub(crate) first: usize,
    /// Motions at which couplings are locked; none where none are.
    pub(crate) locked: Vec<[Option<f64>; 6]>,
    /// Displacements at which supports started, m; none where none did.
    pub(crate) left: Vec<Vec<[f64; 3]>>,
}

impl Scene {
    /// The first steps of all stages, ascending.
    pub(crate) fn stages(&self) -> Vec<usize> {
        let locks = self.couplings.iter().filter_map(|c| Some(c.lockable()?.1));
        let times = self.analysis.times();
        let first = |time: f64| times.partition_point(|&step| !is_past(time, step));
        let firsts: BTreeSet<usize> = self
            .spans()
            .flat_map(|(_, span)| span.times())
            .chain(locks)
            .map(first)
            .collect();
        let later = firsts.into_iter().filter(|first| (1..times.len()).contains(first));
        std::iter::once(0).chain(later).collect()
    }

    /// The first step of the stage that a step belongs to.
    pub(crate) fn stage_of(&self, step: usize) -> usize {
        let stages = self.stages();
        stages[stages.partition_point(|first| *first <= step) - 1]
    }

    /// The steps of the stage that the scene is set up for.
    pub(crate) fn stage_steps(&self) -> Range<usize> {
        let stages = self.stages();
        let next = stages.get(stages.partition_point(|first| *first <= self.stage));
        self.stage..next.copied().unwrap_or(self.analysis.steps())
    }

    /// Whether supports or contacts start or end between steps.
    pub(crate) fn has_spans(&self) -> bool {
        self.spans().any(|(_, span)| span != Span::default())
    }

    /// Whether supports start after the stage that the scene is set up for, where its steps leave their nodes.
    pub(crate) fn leaves(&self) -> bool {
        let now = self.analysis.time(self.stage);
        let later = |start: f64| now.is_some_and(|now| !is_past(start, now));
        self.supports.iter().filter_map(|s| s.span.start).any(later)
    }

    /// When supports and contacts act.
    pub(crate) fn spans(&self) -> impl Iterator<Item = (Part, Span)> {
        let supports = self.supports.iter().map(|s| s.span).enumerate();
        let contacts = self.contacts.iter().map(|c| c.span).enumerate();
        (supports.map(|(k, span)| (Part::Support(k), span))).chain(contacts.map(|(k, span)| (Part::Contact(k), span)))
    }

    /// Whether what has this span acts in the stage that the scene is set up for.
    pub(crate) fn acts(&self, span: Span) -> bool {
        self.analysis.time(self.stage).is_none_or(|step| span.has(step))
    }

    /// The stage that the scene is set up for.
    pub(crate) fn stage(&self) -> Stage {
        let locked: Vec<[Option<f64>; 6]> = self.couplings.iter().map(|c| c.locked).collect();
        let any = locked.iter().flatten().any(Option::is_some);
        let left: Vec<Vec<[f64; 3]>> = self.supports.iter().map(|s| s.left.clone()).collect();
        let started = left.iter().any(|left| !left.is_empty());
        Stage {
            first: self.stage,
            locked: if any { locked } else { Vec::new() },
            left: if started { left } else { Vec::new() },
        }
    }

    /// Sets up for a stage.
    pub(crate) fn enter(&mut self, stage: &Stage) {
        self.stage = stage.first;
        let acting: Vec<bool> = self.supports.iter().map(|s| self.acts(s.span)).collect();
        for (k, support) in self.supports.iter_mut().enumerate() {
            support.left = stage.left.get(k).filter(|_| acting[k]).cloned().unwrap_or_default();
        }
        let first = self.analysis.time(0).filter(|_| stage.first == 0);
        for (k, coupling) in self.couplings.iter_mut().enumerate() {
            let own = stage.locked.get(k).copied().unwrap_or_default();
            let held = coupling.held;
            // before the first step all is at rest
            let at_rest = coupling
                .lockable()
                .filter(|(_, time)| first.is_some_and(|first| is_past(*time, first)));
            let at_rest = |c: usize| at_rest.filter(|(motions, _)| motions[c]).map(|_| 0.0);
            coupling.locked = [0, 1, 2, 3, 4, 5].map(|c| own[c].or(at_rest(c)).filter(|_| !held[c]));
        }
    }

    /// The stages after the first, as far as they are known beforehand: where something will be locked is not.
    pub(crate) fn later_stages(&self) -> impl Iterator<Item = Stage> {
        self.stages().into_iter().skip(1).map(|first| {
            let step = self.analysis.time(first).unwrap_or(0.0);
            let locked = self.couplings.iter().map(|coupling| {
                let due = coupling.lockable().filter(|(_, time)| is_past(*time, step));
                let at_zero = |on: bool| on.then_some(0.0);
                due.map_or([None; 6], |(motions, _)| motions.map(at_zero))
            });
            Stage {
                first,
                locked: locked.collect(),
                left: Vec::new(),
            }
        })
    }

    /// Whether a support starts where its nodes are left by earlier steps, in the stage that the scene is set up for or
    /// before.
    pub(crate) fn has_started(&self, support: usize) -> bool {
        let span = self.supports[support].span;
        let at_rest = |start: f64| self.analysis.time(0).is_none_or(|first| is_past(start, first));
        self.acts(span) && span.start.is_some_and(|start| !at_rest(start))
    }
}
