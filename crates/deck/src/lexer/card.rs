//! A keyword with its parameters and data lines.

use crate::error::{DeckError, Fault, Location, Word};

/// Largest number of a node or element.
pub(crate) const LARGEST: u32 = i32::MAX as u32;

/// A parameter of a keyword.
#[derive(Debug, Clone)]
pub(crate) struct Param {
    /// As it is written: `TYPE=C3D4`.
    pub(crate) word: Word,
    /// Upper case without blanks.
    key: String,
    /// What follows the equals sign, as it is written.
    pub(crate) value: Option<String>,
}

/// A name as it is compared, and the word that has it.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) word: Word,
}

/// What a data line says.
impl Word {
    /// A part of the line.
    pub(crate) fn part(&self, text: &str) -> Self {
        Self::new(&self.location, text)
    }

    /// An entry of the line; all of it where that is missing or blank.
    pub(crate) fn entry(&self, fields: &[&str], at: usize) -> Self {
        match fields.get(at) {
            None | Some(&"") => self.clone(),
            Some(text) => self.part(text),
        }
    }

    /// The entries, without blanks around them; a comma at the end adds none.
    pub(crate) fn fields(&self) -> Vec<&str> {
        let mut fields: Vec<&str> = self.text.split(',').map(str::trim).collect();
        if fields.len() > 1 && fields.last().is_some_and(|last| last.is_empty()) {
            fields.pop();
        }
        fields
    }

    /// The entries, at most so many.
    pub(crate) fn at_most(&self, most: usize, wanted: &'static str) -> Result<Vec<&str>, DeckError> {
        let fields = self.fields();
        match fields.get(most) {
            Some(extra) => Err(self.part(if extra.is_empty() { "," } else { extra }).expected(wanted)),
            None => Ok(fields),
        }
    }

    /// A finite number; `None` if the entry is missing or blank.
    pub(crate) fn optional(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<Option<f64>, DeckError> {
        match fields.get(at) {
            None | Some(&"") => Ok(None),
            Some(text) => real(text).map(Some).ok_or_else(|| self.part(text).expected(wanted)),
        }
    }

    /// A finite number.
    pub(crate) fn real(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<f64, DeckError> {
        let value = self.optional(fields, at, wanted)?;
        value.ok_or_else(|| self.expected(wanted))
    }

    /// So many finite numbers, from an entry on.
    pub(crate) fn reals<const N: usize>(
        &self,
        fields: &[&str],
        from: usize,
        wanted: &'static str,
    ) -> Result<[f64; N], DeckError> {
        let mut values = [0.0; N];
        for (at, value) in (from..).zip(&mut values) {
            *value = self.real(fields, at, wanted)?;
        }
        Ok(values)
    }

    /// A number of a node or element.
    pub(crate) fn label(&self, fields: &[&str], at: usize, wanted: &'static str) -> Result<u32, DeckError> {
        let found = fields.get(at).and_then(|text| label(text));
        found.ok_or_else(|| self.entry(fields, at).expected(wanted))
    }
}

/// Whether a field is written as numbers are; names may begin so.
pub(crate) fn is_numeric(field: &str) -> bool {
    real(field).is_some() || field.chars().all(|c| c.is_ascii_digit() || "+-.".contains(c))
}

fn is_of_number(c: char) -> bool {
    c.is_ascii_digit() || "+-.eEdD".contains(c)
}

/// A finite number, also with the exponent letter D of Fortran.
fn real(text: &str) -> Option<f64> {
    // words such as "inf" and "nan" are names here
    if !text.chars().all(is_of_number) {
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
    /// As it is written: `*Node file`.
    pub(crate) word: Word,
    /// Upper case without blanks and star: `NODEFILE`.
    pub(crate) key: String,
    pub(crate) params: Vec<Param>,
    pub(crate) lines: Vec<Word>,
}

impl Card {
    /// Takes a keyword line, with its continuation lines, apart.
    pub(crate) fn new(location: &Location, text: &str) -> Self {
        let mut items = split(text).into_iter();
        let word = items.next().unwrap_or_default().trim();
        let params = items.filter(|item| !item.trim().is_empty()).map(|item| {
            let (left, value) = match item.split_once('=') {
                Some((left, value)) => (left, Some(value.trim().to_owned())),
                None => (item, None),
            };
            Param {
                word: Word::new(location, item.trim()),
                key: name(left),
                value,
            }
        });
        Self {
            key: name(word.trim_start_matches('*')),
            word: Word::new(location, word),
            params: params.collect(),
            lines: Vec::new(),
        }
    }

    /// Refuses parameters that are not in the list (upper case, as they are written with blanks), and those
    /// given twice.
    pub(crate) fn allow(&self, known: &[&str]) -> Result<(), DeckError> {
        for (index, param) in self.params.iter().enumerate() {
            if !known.iter().any(|k| name(k) == param.key) {
                return Err(param.word.fault(Fault::UnknownParameter {
                    keyword: self.word.text.clone(),
                    known: known.iter().map(|k| (*k).to_owned()).collect(),
                }));
            }
            if self.params[..index].iter().any(|p| p.key == param.key) {
                return Err(param.word.fault(Fault::RepeatedParameter));
            }
        }
        Ok(())
    }

    /// The same without a parameter.
    pub(crate) fn without(&self, key: &str) -> Self {
        let mut card = self.clone();
        card.params.retain(|param| param.key != key);
        card
    }

    /// A parameter, by its upper-case name without blanks.
    pub(crate) fn param(&self, key: &str) -> Option<&Param> {
        self.params.iter().find(|p| p.key == key)
    }

    /// A parameter that has to be there.
    pub(crate) fn need_param(&self, key: &'static str) -> Result<&Param, DeckError> {
        let param = self.param(key);
        param.ok_or_else(|| self.word.fault(Fault::MissingParameter(key)))
    }

    /// Whether a parameter without a value is there.
    pub(crate) fn flag(&self, key: &str) -> Result<bool, DeckError> {
        match self.param(key) {
            None => Ok(false),
            Some(Param { value: None, .. }) => Ok(true),
            Some(param) => Err(param.word.expected("this parameter without a value")),
        }
    }

    /// The value of a parameter.
    pub(crate) fn value(&self, key: &str) -> Result<Option<Named>, DeckError> {
        self.param(key).map(Param::named).transpose()
    }

    /// The value of a parameter that has to be there.
    pub(crate) fn need(&self, key: &'static str) -> Result<Named, DeckError> {
        self.need_param(key)?.named()
    }

    /// The value of a parameter, one of those listed (upper case, without blanks), by its position.
    pub(crate) fn choice(&self, key: &str, choices: &[&str], wanted: &'static str) -> Result<Option<usize>, DeckError> {
        let Some(value) = self.value(key)? else {
            return Ok(None);
        };
        let found = choices.iter().position(|c| *c == value.name);
        found.map(Some).ok_or_else(|| value.word.expected(wanted))
    }

    /// Refuses data beyond the first `most` lines.
    pub(crate) fn lines_at_most(&self, most: usize, wanted: &'static str) -> Result<(), DeckError> {
        match self.lines.get(most) {
            Some(line) => Err(line.expected(wanted)),
            None => Ok(()),
        }
    }

    /// The only data line.
    pub(crate) fn only_line(&self, wanted: &'static str) -> Result<&Word, DeckError> {
        self.lines_at_most(1, wanted)?;
        self.lines.first().ok_or_else(|| self.word.expected(wanted))
    }
}

impl Param {
    /// Its value, as names are compared.
    fn named(&self) -> Result<Named, DeckError> {
        let name = self.value.as_deref().map(name).filter(|name| !name.is_empty());
        let name = name.ok_or_else(|| self.word.expected("a value after an equals sign"))?;
        let word = self.word.clone();
        Ok(Named { name, word })
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
