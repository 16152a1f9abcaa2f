//! Files to cards.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::card::{Card, name};
use crate::error::{DeckError, Fault, Location, Word};

/// Most included files, how deep they may include each other, and the bytes and lines of all files together:
/// far beyond any model that a machine holds, so that a damaged file cannot fill the memory.
const FILES: u64 = 1000;
const DEPTH: usize = 32;
const BYTES: u64 = 1 << 31;
const LINES: u64 = 50_000_000;

/// Parameters without a value.
const FLAGS: [&str; 20] = [
    "ADD",
    "ALLSDTOL",
    "AUGMENTEDLAGRANGE",
    "DIRECT",
    "FIXED",
    "GENERATE",
    "INTERNAL",
    "LAGRANGE",
    "NLGEOM",
    "NOTHICKNESS",
    "PENALTY",
    "PERTURBATION",
    "READ",
    "REMOVE",
    "ROUGH",
    "SMALLSLIDING",
    "STABILIZE",
    "UNSORTED",
    "UNSYMM",
    "WRITE",
];

/// The cards of a file and of those that it includes.
pub(crate) fn cards(path: &Path) -> Result<Vec<Card>, DeckError> {
    let mut reader = Reader::default();
    let bytes = load(path, BYTES).map_err(|source| DeckError::Io {
        path: path.to_owned(),
        source,
    })?;
    reader.bytes = bytes.len() as u64;
    reader.open.push(identity(path));
    reader.file(path, &bytes)?;
    Ok(reader.cards)
}

#[derive(Default)]
struct Reader {
    cards: Vec<Card>,
    /// Files being read, the innermost last.
    open: Vec<PathBuf>,
    files: u64,
    bytes: u64,
    lines: u64,
}

impl Reader {
    fn file(&mut self, path: &Path, bytes: &[u8]) -> Result<(), DeckError> {
        let file: Arc<Path> = path.into();
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut lines = bytes
            .split(|b| *b == b'\n')
            .enumerate()
            .map(|(index, line)| (index + 1, String::from_utf8_lossy(line)))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with("**"))
            .peekable();
        while let Some((line, text)) = lines.next() {
            let location = Location {
                file: file.clone(),
                line,
            };
            let text = text.trim();
            self.lines += 1;
            if self.lines > LINES {
                return Err(Word::new(&location, text).fault(Fault::TooMany {
                    what: "lines in all files",
                    most: LINES,
                    remedy: "split the model",
                }));
            }
            if !text.starts_with('*') {
                let line = Word::new(&location, text);
                match self.cards.last_mut() {
                    Some(card) => card.lines.push(line),
                    None => return Err(line.fault(Fault::NoKeyword)),
                }
                continue;
            }
            let mut keyword = text.to_owned();
            while keyword.ends_with(',') {
                match lines.next_if(|(_, more)| has_parameters(more)) {
                    Some((_, more)) => keyword.push_str(more.trim()),
                    // a comma too many
                    None if lines.peek().is_some() => keyword.truncate(keyword.len() - 1),
                    None => return Err(Word::new(&location, keyword).fault(Fault::NotContinued)),
                }
            }
            let card = Card::new(&location, &keyword);
            if card.key == "INCLUDE" {
                self.include(&card)?;
            } else {
                self.cards.push(card);
            }
        }
        Ok(())
    }

    /// The path of a file that a file includes: beside this, or beside the deck, where CalculiX looks.
    fn place(&self, including: &Path, written: &str) -> PathBuf {
        let beside = |file: &Path| file.parent().unwrap_or(Path::new("")).join(written);
        let own = beside(including);
        match self.open.first().map(|deck| beside(deck)) {
            Some(other) if !own.exists() && other.exists() => other,
            _ => own,
        }
    }

    fn include(&mut self, card: &Card) -> Result<(), DeckError> {
        card.allow(&["INPUT"])?;
        card.need("INPUT")?;
        let param = card.need_param("INPUT")?;
        // the path as it is written: names of files have cases
        let written = param.value.as_deref().unwrap_or("").trim_matches('"');
        let path = self.place(&card.word.location.file, written);
        let this = identity(&path);
        if self.open.contains(&this) {
            return Err(param.word.fault(Fault::IncludeLoop));
        }
        self.files += 1;
        let too_many = |what, most| {
            let remedy = "put them together";
            param.word.fault(Fault::TooMany { what, most, remedy })
        };
        if self.files > FILES {
            return Err(too_many("included files", FILES));
        }
        if self.open.len() >= DEPTH {
            return Err(too_many("files inside each other", DEPTH as u64));
        }
        let bytes = load(&path, BYTES - self.bytes).map_err(|source| {
            let path = path.clone();
            param.word.fault(Fault::Include { path, source })
        })?;
        self.bytes += bytes.len() as u64;
        self.open.push(this);
        self.file(&path, &bytes)?;
        self.open.pop();
        Ok(())
    }
}

/// Whether a line goes on with the parameters of the keyword before: with values, or flags that are read.
fn has_parameters(line: &str) -> bool {
    let is_flag = |field: &str| field.trim().is_empty() || FLAGS.contains(&&*name(field));
    !line.trim_start().starts_with('*') && (line.contains('=') || line.split(',').all(is_flag))
}

/// The same for all ways to write the path of a file.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn load(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let text = format!("decks of more than {BYTES} bytes are not read; split the model");
        return Err(std::io::Error::other(text));
    }
    Ok(bytes)
}
