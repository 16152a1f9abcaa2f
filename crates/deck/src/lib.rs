//! Input decks.

mod deck;
mod error;
mod lexer;
mod model;
mod scene;

pub use deck::Deck;
pub use error::{DeckError, Fault, Place};
pub use model::Ignored;
