//! Profile documents, with the schema version, the kind of device and the saved content.

use std::cell::RefCell;
use std::rc::Rc;

use ron::Value;
use ron::error::SpannedError;

use super::body::{Body, ProfileFormats};
use super::entry_location::find_location;
use super::error::{ProfileError, SyntaxErrorKind};
use super::misspelt::Reading;
use super::ron_text::{Entries, UnknownValues, Writer};
use super::unique_names::UniqueNames;
use crate::expected::AllowedValues;

/// Version of the profile schema that this program writes.
pub const SCHEMA: u32 = 1;

/// A profile document as stored in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileDocument {
    /// Time at which the profile was read from a device, in the format of RFC 3339.
    pub saved: Option<String>,
    /// Note by the user.
    pub note: Option<String>,
    /// Saved content.
    pub body: Body,
    /// Unknown entries, which are preserved when the profile is saved.
    pub unknown: UnknownValues,
    /// Schema version. A profile newer than [`SCHEMA`] can only be viewed, because saving it would lose its unknown
    /// parts.
    pub schema: u32,
    /// Paths of entries that the schema does not define. Saving moves such entries to `extra`.
    pub beyond: Vec<String>,
}

impl ProfileDocument {
    /// Creates a document. `saved` is the time at which the profile was read.
    pub fn new(saved: String, body: Body) -> Self {
        ProfileDocument {
            saved: Some(saved),
            note: None,
            body,
            unknown: UnknownValues::new(),
            schema: SCHEMA,
            beyond: Vec::new(),
        }
    }

    /// Parses a profile in one of the given formats.
    ///
    /// # Errors
    /// Returns an error with line and column if the file is not valid RON, or an error that names an invalid entry.
    pub fn parse(text: &str, formats: ProfileFormats) -> Result<Self, ProfileError> {
        let twice = RefCell::default();
        let syntax = |error: SpannedError| ProfileError::Syntax {
            line: error.span.start.line,
            column: error.span.start.col,
            what: match (error.code, twice.take()) {
                (_, Some(name)) => SyntaxErrorKind::Twice(name),
                // The message of the crate is meant for programmers.
                (ron::Error::ExceededRecursionLimit, None) => SyntaxErrorKind::TooDeep,
                (code, None) => SyntaxErrorKind::Parser(code.to_string()),
            },
        };
        let value: Value = ron::from_str(text).map_err(syntax)?;
        ron::Options::default().from_str_seed(text, UniqueNames { twice: &twice }).map_err(syntax)?;
        let reading = Rc::new(Reading::default());
        Self::read(value, &reading, formats).map_err(|error| match reading.reported_error(error) {
            ProfileError::Misspelt { path, intended, .. } => {
                let (line, column) = find_location(text, &path).unwrap_or((1, 1));
                ProfileError::Misspelt { line, column, path, intended }
            }
            error => error,
        })
    }

    fn read(value: Value, reading: &Rc<Reading>, formats: ProfileFormats) -> Result<Self, ProfileError> {
        let mut entries = Entries::open("", value, reading)?;
        let schema: u32 = entries.take_required("schema", AllowedValues::Whole)?;
        if schema == 0 {
            return Err(ProfileError::Schema { found: schema, known: SCHEMA });
        }
        if schema > SCHEMA {
            reading.set_newer_schema(schema);
        }
        let device: String = entries.take_required("device", AllowedValues::Text)?;
        let saved = entries.take_optional("saved", AllowedValues::Text)?;
        let note = entries.take_optional("note", AllowedValues::Text)?;
        let body = formats.parse(device, &mut entries)?;
        let unknown = entries.into_unknown()?;
        Ok(ProfileDocument { saved, note, body, unknown, schema, beyond: reading.undefined_entries() })
    }

    /// Returns whether the schema is newer than this program supports. Such a profile can be viewed and compared, but
    /// not saved or written to a device.
    pub fn is_newer(&self) -> bool {
        self.schema > SCHEMA
    }

    /// Returns the document if its schema is supported.
    ///
    /// # Errors
    /// Returns [`ProfileError::Schema`] if the schema is newer.
    pub fn check_schema(self) -> Result<Self, ProfileError> {
        if self.is_newer() { Err(ProfileError::Schema { found: self.schema, known: SCHEMA }) } else { Ok(self) }
    }

    /// Formats the document as the content of a file.
    pub fn emit(&self) -> String {
        let mut writer = Writer::default();
        writer.open("", '(');
        writer.entry("schema", &self.schema.to_string(), "");
        writer.text("device", self.device());
        if let Some(saved) = &self.saved {
            writer.text("saved", saved);
        }
        if let Some(note) = &self.note {
            writer.text("note", note);
        }
        self.body.emit(&mut writer);
        writer.write_unknown(&self.unknown);
        writer.close(')');
        writer.finish()
    }

    /// Returns the keyword for the kind of device, as used on the command line.
    pub fn device(&self) -> &'static str {
        self.body.kind()
    }
}
