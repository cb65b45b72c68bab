//! RON for profiles. The `ron` crate parses the text, but the writer is implemented here, so that files are readable:
//! hexadecimal numbers, sixteen bytes per line, and comments. Unknown entries are preserved.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::rc::Rc;

use ron::Value;
use serde::de::DeserializeOwned;

use super::ProfileError;
use super::misspelt::{Misspelling, Reading, edit_distance};
use crate::bits::{HexError, parse_hex};
use crate::expected::AllowedValues;

/// Unknown entries by name. They were added by the user or belong to a newer schema.
pub type UnknownValues = BTreeMap<String, Value>;

/// Name of the structure for entries added by the user.
const EXTRA_ENTRY: &str = "extra";

/// The entries of a structure. Parsing removes them one by one. Those that remain were added by the user or are
/// misspelt.
pub struct Entries {
    path: String,
    entries: BTreeMap<String, Value>,
    /// Names that were requested but not found.
    missed: Vec<String>,
    reading: Rc<Reading>,
}

impl Entries {
    pub(super) fn open(path: &str, value: Value, reading: &Rc<Reading>) -> Result<Self, ProfileError> {
        let map = match unwrap_value(value) {
            Value::Map(map) => map,
            // The crate returns this for an empty structure, `()` or `( )`.
            Value::Unit => ron::Map::new(),
            Value::Seq(values) if values.is_empty() => ron::Map::new(),
            _ => {
                return Err(ProfileError::Shape { path: path.to_owned(), expected: AllowedValues::Structure });
            }
        };
        let mut entries = BTreeMap::new();
        for (key, value) in map {
            let Value::String(name) = key else {
                return Err(ProfileError::Shape { path: path.to_owned(), expected: AllowedValues::Names });
            };
            entries.insert(name, value);
        }
        Ok(Entries { path: path.to_owned(), entries, missed: Vec::new(), reading: reading.clone() })
    }

    /// Removes and returns an entry. If the entry is missing, its name is recorded.
    fn take_value(&mut self, name: &str) -> Option<Value> {
        let value = self.entries.remove(name);
        if value.is_none() {
            self.missed.push(name.to_owned());
        }
        value
    }

    /// Returns the best match between a remaining entry and a missing one. At most `most` letters may differ.
    fn find_misspelling(&self, most: usize) -> Option<Misspelling> {
        if self.reading.is_newer() {
            return None;
        }
        let left = self.entries.keys().filter(|name| *name != EXTRA_ENTRY);
        let pairs = left.flat_map(|name| self.missed.iter().map(move |intended| (name, intended)));
        let slips = pairs.filter_map(|(name, intended)| {
            let letters = edit_distance(name, intended).filter(|letters| *letters <= most)?;
            Some(Misspelling { letters, path: self.entry_path(name), intended: intended.clone() })
        });
        slips.min()
    }

    /// Returns the path of the structure, as shown in messages.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Returns the path of an entry, as shown in messages.
    pub fn entry_path(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    /// Parses a simple value, or returns `None` if the entry is missing.
    pub fn take_optional<T: DeserializeOwned>(
        &mut self,
        name: &str,
        expected: AllowedValues,
    ) -> Result<Option<T>, ProfileError> {
        let Some(value) = self.take_value(name) else { return Ok(None) };
        if matches!(value, Value::Option(None)) {
            return Ok(None);
        }
        unwrap_value(value)
            .into_rust()
            .map(Some)
            .map_err(|_| ProfileError::Shape { path: self.entry_path(name), expected })
    }

    /// Parses a required simple value.
    pub fn take_required<T: DeserializeOwned>(
        &mut self,
        name: &str,
        expected: AllowedValues,
    ) -> Result<T, ProfileError> {
        self.take_optional(name, expected)?.ok_or_else(|| ProfileError::Missing { path: self.entry_path(name) })
    }

    /// Takes a required structure.
    pub fn take_structure(&mut self, name: &str) -> Result<Entries, ProfileError> {
        let path = self.entry_path(name);
        let value = self.take_value(name).ok_or_else(|| ProfileError::Missing { path: path.clone() })?;
        Entries::open(&path, value, &self.reading)
    }

    /// Takes a structure, or returns `None` if the structure is missing.
    pub fn optional_structure(&mut self, name: &str) -> Result<Option<Entries>, ProfileError> {
        let path = self.entry_path(name);
        match self.take_value(name) {
            None | Some(Value::Option(None)) => Ok(None),
            Some(value) => Entries::open(&path, value, &self.reading).map(Some),
        }
    }

    /// Parses bytes written as one hex string or as a list of them.
    pub fn bytes(&mut self, name: &str) -> Result<Option<Vec<u8>>, ProfileError> {
        let path = self.entry_path(name);
        let Some(value) = self.take_optional::<Value>(name, AllowedValues::HexLines)? else { return Ok(None) };
        let lines = match value {
            Value::String(line) => vec![line],
            value => value
                .into_rust::<Vec<String>>()
                .map_err(|_| ProfileError::Shape { path: path.clone(), expected: AllowedValues::HexLines })?,
        };
        let bytes = lines.iter().map(|line| parse_pairs(line)).collect::<Result<Vec<_>, _>>();
        bytes.map(|rows| Some(rows.concat())).map_err(|problem| ProfileError::Bytes { path, problem })
    }

    /// Takes a required list of structures.
    pub fn required_structures(&mut self, name: &str) -> Result<Vec<Entries>, ProfileError> {
        if !self.entries.contains_key(name) {
            self.missed.push(name.to_owned());
            return Err(ProfileError::Missing { path: self.entry_path(name) });
        }
        self.take_structures(name)
    }

    /// Takes a list of structures, or returns an empty list if the entry is missing.
    pub fn take_structures(&mut self, name: &str) -> Result<Vec<Entries>, ProfileError> {
        let path = self.entry_path(name);
        match self.take_value(name).map(unwrap_value) {
            None => Ok(Vec::new()),
            Some(Value::Seq(values)) => values
                .into_iter()
                .enumerate()
                .map(|(at, value)| Entries::open(&format!("{path}[{at}]"), value, &self.reading))
                .collect(),
            Some(_) => Err(ProfileError::Shape { path, expected: AllowedValues::List }),
        }
    }

    /// Takes a map with arbitrary keys, in their original order. Returns an empty map if the entry is missing.
    pub fn take_map(&mut self, name: &str) -> Result<Vec<(Value, Value)>, ProfileError> {
        match self.take_value(name).map(unwrap_value) {
            None | Some(Value::Unit) => Ok(Vec::new()),
            Some(Value::Map(map)) => Ok(map.into_iter().collect()),
            Some(_) => Err(ProfileError::Shape { path: self.entry_path(name), expected: AllowedValues::Map }),
        }
    }

    /// Returns the remaining entries, which were added by the user or belong to a newer schema. Those outside `extra`,
    /// as found in older files, are moved to `extra`.
    ///
    /// # Errors
    /// Returns [`ProfileError::Misspelt`] if a remaining entry is a misspelling of a missing one.
    pub fn into_unknown(mut self) -> Result<UnknownValues, ProfileError> {
        let left = std::mem::take(&mut self.entries);
        if self.reading.is_newer() {
            self.report_unknown_entries(&left);
            return Ok(left);
        }
        self.entries = left;
        if let Some(slip) = self.find_misspelling(usize::MAX) {
            return Err(slip.error());
        }
        let mut left = std::mem::take(&mut self.entries);
        let mut own = match left.remove(EXTRA_ENTRY) {
            None => UnknownValues::new(),
            Some(value) => {
                std::mem::take(&mut Entries::open(&self.entry_path(EXTRA_ENTRY), value, &self.reading)?.entries)
            }
        };
        self.report_unknown_entries(&left);
        for (name, value) in left {
            own.entry(name).or_insert(value);
        }
        Ok(own)
    }

    /// Records an entry that the schema does not define.
    pub fn record_undefined_entry(&self, path: String) {
        self.reading.record_undefined_entry(path);
    }

    fn report_unknown_entries(&self, left: &UnknownValues) {
        left.keys().for_each(|name| self.reading.record_undefined_entry(self.entry_path(name)));
    }
}

impl Drop for Entries {
    /// Records a misspelt name, in case an error has ended the parsing early.
    fn drop(&mut self) {
        if let Some(slip) = self.find_misspelling(2) {
            self.reading.record_misspelling(slip);
        }
    }
}

/// Parses bytes of two hexadecimal digits each. A single digit is an error, because its other half may have been
/// deleted by mistake.
fn parse_pairs(line: &str) -> Result<Vec<u8>, HexError> {
    match line.split_whitespace().find(|group| group.len() == 1) {
        Some(digit) => Err(HexError::Odd(digit.to_owned())),
        None => parse_hex(line),
    }
}

/// Returns `x` for `Some(x)`, and any other value unchanged. A profile may contain either form.
fn unwrap_value(value: Value) -> Value {
    match value {
        Value::Option(Some(inner)) => *inner,
        other => other,
    }
}

/// A writer for profile files.
#[derive(Default)]
pub struct Writer {
    out: String,
    depth: usize,
}

impl Writer {
    /// Writes a comment on a separate line.
    pub fn write_comment(&mut self, text: &str) {
        self.write_line(&format!("// {text}"));
    }

    /// Writes `name: value,` followed by a comment. The value is written verbatim.
    pub fn entry(&mut self, name: &str, value: &str, comment: &str) {
        let behind = if comment.is_empty() { String::new() } else { format!(" // {comment}") };
        self.write_line(&format!("{name}: {value},{behind}"));
    }

    /// Writes a list element verbatim.
    pub fn write_list_element(&mut self, value: &str) {
        self.write_line(&format!("{value},"));
    }

    /// Writes `name: "text",`.
    pub fn text(&mut self, name: &str, text: &str) {
        self.entry(name, &quote(text), "");
    }

    /// Writes bytes as a list of strings of sixteen bytes each, with their ASCII characters as comments.
    pub fn bytes(&mut self, name: &str, bytes: &[u8]) {
        self.open(name, '[');
        for row in bytes.chunks(16) {
            let printable = |byte: &u8| if matches!(byte, b' '..=b'~') { char::from(*byte) } else { '.' };
            let text: String = row.iter().map(printable).collect();
            self.write_line(&format!("\"{}\", // {text}", crate::bits::hex(row)));
        }
        self.close(']');
    }

    /// Writes unknown entries as they were read.
    pub fn write_unknown(&mut self, unknown: &UnknownValues) {
        if !unknown.is_empty() {
            self.entry(EXTRA_ENTRY, &extra_text(unknown), "");
        }
    }

    /// Begins a structure or list. The name is empty in a list and at the top level.
    pub fn open(&mut self, name: &str, bracket: char) {
        let head = if name.is_empty() { bracket.to_string() } else { format!("{name}: {bracket}") };
        self.write_line(&head);
        self.depth += 1;
    }

    /// Ends a structure or list.
    pub fn close(&mut self, bracket: char) {
        self.depth = self.depth.saturating_sub(1);
        let comma = if self.depth == 0 { "" } else { "," };
        self.write_line(&format!("{bracket}{comma}"));
    }

    pub(super) fn finish(self) -> String {
        self.out
    }

    fn write_line(&mut self, text: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.out, "{:indent$}{}", "", text.trim_end(), indent = self.depth * 4);
    }
}

pub(crate) fn quote(text: &str) -> String {
    ron::to_string(text).unwrap_or_else(|_| "\"\"".to_owned())
}

/// Formats the entries added by the user for the end of a single-line structure, for example as `, extra: {…}`.
pub(crate) fn entries_text(unknown: &UnknownValues) -> String {
    if unknown.is_empty() { String::new() } else { format!(", {EXTRA_ENTRY}: {}", extra_text(unknown)) }
}

fn extra_text(unknown: &UnknownValues) -> String {
    let entries: Vec<String> =
        unknown.iter().map(|(name, value)| format!("{}: {}", quote(name), value_text(value))).collect();
    format!("{{{}}}", entries.join(", "))
}

/// Formats a value as RON. A structure becomes `(name: value)` if its names allow it.
pub(crate) fn value_text(value: &Value) -> String {
    let is_name = |text: &str| {
        text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    match value {
        Value::Map(map) => {
            let named = map.iter().all(|(key, _)| matches!(key, Value::String(name) if is_name(name)));
            let entries: Vec<String> = map
                .iter()
                .map(|(key, value)| match key {
                    Value::String(name) if named => format!("{name}: {}", value_text(value)),
                    key => format!("{}: {}", value_text(key), value_text(value)),
                })
                .collect();
            let (open, close) = if named && !entries.is_empty() { ('(', ')') } else { ('{', '}') };
            format!("{open}{}{close}", entries.join(", "))
        }
        Value::Seq(values) => format!("[{}]", values.iter().map(value_text).collect::<Vec<_>>().join(", ")),
        Value::Option(Some(inner)) => format!("Some({})", value_text(inner)),
        other => ron::to_string(other).unwrap_or_else(|_| "()".to_owned()),
    }
}
