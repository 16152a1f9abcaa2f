//! A keyword with its parameters and data lines.

use crate::error::{DeckError, Fault, Location};

/// Largest number of a node or element.
const LARGEST: u32 = i32::MAX as u32;

/// A parameter of a keyword.
#[derive(Debug, Clone)]
pub(crate) struct Param {
    /// As it is written: `TYPE=C3D4`.
    pub(crate) word: String,
    /// Upper case without blanks.
    pub(crate) key: String,
    /// What follows the equals sign, as it is written.
    pub(crate) value: Option<String>,
}

/// A data line.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) location: Location,
    pub(crate) text: String,
}

impl Line {
    /// The entries, without blanks around them; a comma at the end adds none.
    pub(crate) fn fields(&self) -> Vec<&str> {
        let mut fields: Vec<&str> = self.text.split(',').map(str::trim).collect();
        if fields.len() > 1 && fields.last().is_some_and(|last| last.is_empty()) {
            fields.pop();
        }
        fields
    }

    pub(crate) fn fault(&self, word: &str, fault: Fault) -> DeckError {
        DeckError::at(&self.location, word, fault)
    }

    /// The entries, at most so many.
    pub(crate) fn at_most(&self, most: usize, wanted: &'static str) -> Result<Vec<&str>, DeckError> {
        let fields = self.fields();
        match fields.get(most) {
            Some(extra) => Err(self.fault(if extra.is_empty() { "," } else { extra }, Fault::Expected(wanted))),
            None => Ok(fields),
        }
    }

    /// A finite number; `None` if the entry is missing or blank.
    pub(crate) fn optional(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<Option<f64>, DeckError> {
        match fields.get(at) {
            None | Some(&"") => Ok(None),
            Some(text) => match real(text) {
                Some(value) => Ok(Some(value)),
                None => Err(self.fault(text, Fault::Expected(wanted))),
            },
        }
    }

    /// A finite number.
    pub(crate) fn real(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<f64, DeckError> {
        let value = self.optional(fields, at, wanted)?;
        value.ok_or_else(|| self.fault(self.text.trim(), Fault::Expected(wanted)))
    }

    /// A number of a node or element.
    pub(crate) fn label(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<u32, DeckError> {
        let text = fields.get(at).copied().unwrap_or("");
        let word = if text.is_empty() { self.text.trim() } else { text };
        label(text).ok_or_else(|| self.fault(word, Fault::Expected(wanted)))
    }
}

/// A finite number, also with the exponent letter D of Fortran.
pub(crate) fn real(text: &str) -> Option<f64> {
    // words such as "inf" and "nan" are names here
    let digits = |c: char| c.is_ascii_digit() || "+-.eEdD".contains(c);
    if !text.chars().all(digits) {
        return None;
    }
    let value: f64 = text.replace(['d', 'D'], "e").parse().ok()?;
    value.is_finite().then_some(value)
}

/// A number of a node or element.
pub(crate) fn label(text: &str) -> Option<u32> {
    let number: u32 = text.parse().ok()?;
    (1..=LARGEST).contains(&number).then_some(number)
}

/// A name as it is compared: upper case, without blanks unless it is quoted, without the quotes.
pub(crate) fn name(text: &str) -> String {
    let text = text.trim();
    let quoted = text.len() > 1 && text.starts_with('"') && text.ends_with('"');
    if quoted {
        return text[1..text.len() - 1].to_uppercase();
    }
    let kept = text.chars().filter(|c| !c.is_whitespace());
    kept.flat_map(char::to_uppercase).collect()
}

/// A keyword, its parameters, and the data lines up to the next keyword.
#[derive(Debug, Clone)]
pub(crate) struct Card {
    pub(crate) location: Location,
    /// As it is written: `*Node file`.
    pub(crate) word: String,
    /// Upper case without blanks and star: `NODEFILE`.
    pub(crate) key: String,
    pub(crate) params: Vec<Param>,
    pub(crate) lines: Vec<Line>,
}

impl Card {
    /// Takes a keyword line, with its continuation lines, apart.
    pub(crate) fn new(location: Location, text: &str) -> Self {
        let mut items = split(text).into_iter();
        let word = items.next().unwrap_or_default().trim().to_owned();
        let key = name(word.trim_start_matches('*'));
        let params = items.filter(|item| !item.trim().is_empty()).map(|item| {
            let (left, value) = match item.split_once('=') {
                Some((left, value)) => (left, Some(value.trim().to_owned())),
                None => (item, None),
            };
            Param {
                word: item.trim().to_owned(),
                key: name(left),
                value,
            }
        });
        Self {
            location,
            word,
            key,
            params: params.collect(),
            lines: Vec::new(),
        }
    }

    pub(crate) fn fault(&self, fault: Fault) -> DeckError {
        DeckError::at(&self.location, &self.word, fault)
    }

    pub(crate) fn param_fault(&self, param: &Param, fault: Fault) -> DeckError {
        DeckError::at(&self.location, &param.word, fault)
    }

    /// Refuses parameters that are not in the list (upper case, as they are written with blanks), and those
    /// given twice.
    pub(crate) fn allow(&self, known: &[&str]) -> Result<(), DeckError> {
        for (index, param) in self.params.iter().enumerate() {
            if !known.iter().any(|k| name(k) == param.key) {
                let fault = Fault::UnknownParameter {
                    keyword: self.word.clone(),
                    known: known.iter().map(|k| (*k).to_owned()).collect(),
                };
                return Err(self.param_fault(param, fault));
            }
            if self.params[..index].iter().any(|p| p.key == param.key) {
                return Err(self.param_fault(param, Fault::RepeatedParameter));
            }
        }
        Ok(())
    }

    /// A parameter, by its upper-case name without blanks.
    pub(crate) fn param(&self, key: &str) -> Option<&Param> {
        self.params.iter().find(|p| p.key == key)
    }

    /// Whether a parameter without a value is there.
    pub(crate) fn flag(&self, key: &str) -> Result<bool, DeckError> {
        match self.param(key) {
            None => Ok(false),
            Some(Param { value: None, .. }) => Ok(true),
            Some(param) => Err(self.param_fault(param, Fault::Expected("this parameter without a value"))),
        }
    }

    /// The value of a parameter, as names are compared.
    pub(crate) fn value(&self, key: &str) -> Result<Option<String>, DeckError> {
        let Some(param) = self.param(key) else {
            return Ok(None);
        };
        match param.value.as_deref().map(name) {
            Some(value) if !value.is_empty() => Ok(Some(value)),
            _ => Err(self.param_fault(param, Fault::Expected("a value after an equals sign"))),
        }
    }

    /// The value of a parameter that has to be there.
    pub(crate) fn need(&self, key: &'static str) -> Result<String, DeckError> {
        let value = self.value(key)?;
        value.ok_or_else(|| self.fault(Fault::MissingParameter(key)))
    }

    /// The value of a parameter, one of those listed (upper case, without blanks), by its position.
    pub(crate) fn choice(&self, key: &str, choices: &[&str], wanted: &'static str) -> Result<Option<usize>, DeckError> {
        let Some(value) = self.value(key)? else {
            return Ok(None);
        };
        match (choices.iter().position(|c| *c == value), self.param(key)) {
            (None, Some(param)) => Err(self.param_fault(param, Fault::Expected(wanted))),
            (found, _) => Ok(found),
        }
    }

    /// Refuses data beyond the first `most` lines.
    pub(crate) fn lines_at_most(&self, most: usize, wanted: &'static str) -> Result<(), DeckError> {
        match self.lines.get(most) {
            Some(line) => Err(line.fault(line.text.trim(), Fault::Expected(wanted))),
            None => Ok(()),
        }
    }

    /// The only data line.
    pub(crate) fn only_line(&self, wanted: &'static str) -> Result<&Line, DeckError> {
        self.lines_at_most(1, wanted)?;
        let line = self.lines.first();
        line.ok_or_else(|| self.fault(Fault::Expected(wanted)))
    }
}

/// The parts between commas that are not quoted.
fn split(text: &str) -> Vec<&str> {
    let (mut parts, mut start, mut quoted) = (Vec::new(), 0, false);
    for (at, c) in text.char_indices() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}
