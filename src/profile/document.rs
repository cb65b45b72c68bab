//! A profile document: schema version, kind of device, and what is saved of it.

use ron::Value;

use super::hiperface::HiperfaceProfile;
use super::ron_text::{Entries, Unknown, Writer};

/// The version of the profile's form that this program writes.
pub const SCHEMA: u32 = 1;

/// A profile as it stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// When it was read from a device, RFC 3339.
    pub saved: Option<String>,
    /// What a person wrote about it.
    pub note: Option<String>,
    /// What is saved.
    pub body: Body,
    /// Entries that this program does not know.
    pub unknown: Unknown,
}

/// What is saved, by kind of device.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A HIPERFACE encoder.
    Hiperface(HiperfaceProfile),
}

/// Why a text is not a profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// Not RON.
    #[error("line {line}, column {column}: {what}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        what: String,
    },
    /// From a later version of the program.
    #[error("schema {found}; this program knows schema 1 to {known}")]
    Schema {
        /// What the file says.
        found: u32,
        /// The newest that is known.
        known: u32,
    },
    /// Not a kind of device that this program saves.
    #[error("device {0:?}; this program knows \"hiperface\"")]
    Device(String),
    /// Something has to be there and is not.
    #[error("{path} is missing")]
    Missing {
        /// Where: `fields[2].status`.
        path: String,
    },
    /// Something is of another kind.
    #[error("{path} must be {expected}")]
    Shape {
        /// Where.
        path: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A value that cannot be.
    #[error("{path}: {what}")]
    Value {
        /// Where.
        path: String,
        /// What is wrong, and what is allowed.
        what: String,
    },
}

impl Document {
    /// A document of now.
    pub fn new(saved: String, body: Body) -> Self {
        Document { saved: Some(saved), note: None, body, unknown: Unknown::new() }
    }

    /// Reads a profile.
    ///
    /// # Errors
    /// With line and column where the text is not RON, else with the entry that is wrong.
    pub fn parse(text: &str) -> Result<Self, ProfileError> {
        let value: Value = ron::from_str(text).map_err(|error| ProfileError::Syntax {
            line: error.span.start.line,
            column: error.span.start.col,
            what: error.code.to_string(),
        })?;
        let mut entries = Entries::open("", value)?;
        let schema: u32 = entries.required("schema", "a whole number")?;
        if schema == 0 || schema > SCHEMA {
            return Err(ProfileError::Schema { found: schema, known: SCHEMA });
        }
        let device: String = entries.required("device", "a text")?;
        let saved = entries.optional("saved", "a text")?;
        let note = entries.optional("note", "a text")?;
        let body = match device.as_str() {
            "hiperface" => Body::Hiperface(HiperfaceProfile::read(&mut entries)?),
            _ => return Err(ProfileError::Device(device)),
        };
        Ok(Document { saved, note, body, unknown: entries.rest() })
    }

    /// The profile's text.
    pub fn emit(&self) -> String {
        let mut writer = Writer::default();
        writer.open("", '(');
        writer.entry("schema", &SCHEMA.to_string(), "");
        writer.text("device", self.device());
        if let Some(saved) = &self.saved {
            writer.text("saved", saved);
        }
        if let Some(note) = &self.note {
            writer.text("note", note);
        }
        match &self.body {
            Body::Hiperface(profile) => profile.write(&mut writer),
        }
        writer.unknown(&self.unknown);
        writer.close(')');
        writer.finish()
    }

    /// The word for the kind of device, as on the command line.
    pub fn device(&self) -> &'static str {
        match self.body {
            Body::Hiperface(_) => "hiperface",
        }
    }
}
