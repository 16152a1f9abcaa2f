//! Things by name, in the order in which they are defined.

use std::collections::HashMap;

use crate::error::{DeckError, Fault, Word};

/// A table of named things.
#[derive(Debug, Clone)]
pub(crate) struct Names<T> {
    list: Vec<(String, T)>,
    places: HashMap<String, usize>,
}

impl<T> Default for Names<T> {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            places: HashMap::new(),
        }
    }
}

impl<T> Names<T> {
    pub(crate) fn position(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    pub(crate) fn at(&self, position: usize) -> &T {
        &self.list[position].1
    }

    pub(crate) fn at_mut(&mut self, position: usize) -> &mut T {
        &mut self.list[position].1
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &T)> {
        self.list.iter().map(|(name, thing)| (name.as_str(), thing))
    }

    pub(crate) fn names(&self) -> Vec<String> {
        self.list.iter().map(|(name, _)| name.clone()).collect()
    }

    pub(crate) fn last_mut(&mut self) -> Option<&mut T> {
        self.list.last_mut().map(|(_, thing)| thing)
    }

    /// Adds a thing whose name is new.
    pub(crate) fn add(&mut self, name: String, thing: T) {
        self.places.insert(name.clone(), self.list.len());
        self.list.push((name, thing));
    }

    /// The position of a name, or what an error at `word` says.
    pub(crate) fn find(&self, what: &'static str, name: &str, word: &Word) -> Result<usize, DeckError> {
        self.position(name).ok_or_else(|| {
            let known = self.names();
            word.fault(Fault::UnknownName { what, known })
        })
    }
}

impl<T: Default> Names<T> {
    /// The position of a name, made if there is none.
    pub(crate) fn place(&mut self, name: &str) -> usize {
        self.position(name).unwrap_or_else(|| {
            self.add(name.to_owned(), T::default());
            self.list.len() - 1
        })
    }
}
