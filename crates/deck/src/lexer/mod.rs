//! Lines to cards: the bottom layer, which knows no keyword but `*INCLUDE`.
//!
//! In goes a file, out comes the list of its [`Card`]s in order: keyword, parameters and data lines, each with
//! its place. Comments, blank lines, line ends of Windows, continuation lines and included files are dealt with
//! here and unknown above. Uses only [`crate::error`].

mod card;
mod source;

pub(crate) use card::{Card, LARGEST, Named, is_numeric, label, name};
pub(crate) use source::cards;
