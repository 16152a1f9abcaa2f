//! When contact pairs are there.

use super::timeline::Acting;
use crate::error::DeckError;
use crate::model::{Ignored, Law, Model};

/// The spans of each pair.
pub(super) fn spans(model: &Model, ignored: &mut Vec<Ignored>) -> Result<Vec<Vec<Acting>>, DeckError> {
    let mut spans: Vec<Vec<Acting>> = vec![vec![[None; 2]]; model.pairs.len()];
    for (step, given) in model.steps.iter().enumerate() {
        for change in &given.changes {
            let names = [change.slave.name.as_str(), change.master.name.as_str()];
            let pairs = model.pairs.iter().zip(&mut spans);
            let own = pairs.filter(|(pair, _)| matches!(pair.law, Law::Contact(_)) && pair.surfaces() == names);
            let mut known = false;
            for (_, own) in own {
                known = true;
                let there = own.last().is_some_and(|[_, until]| until.is_none());
                match (change.add, there) {
                    (true, false) => own.push([Some(step), None]),
                    (false, true) if own.last().is_some_and(|span| span[0].unwrap_or(0) == step) => drop(own.pop()),
                    (false, true) => own.iter_mut().for_each(|span| span[1] = span[1].or(Some(step))),
                    (true, true) => ignored.push(Ignored::new(&change.slave.word, "the pair is there already")),
                    (false, false) => ignored.push(Ignored::new(&change.slave.word, "the pair is gone already")),
                }
            }
            if !known {
                let why = "no *CONTACT PAIR has these surfaces in this order; name those of one";
                return Err(change.slave.word.cannot(why));
            }
        }
    }
    Ok(spans)
}
