//! A profile document: schema version, kind of device, and what is saved of it.

use std::rc::Rc;

use ron::Value;
use ron::error::SpannedError;

use super::biss::BissProfile;
use super::error::ProfileError;
use super::hiperdrive::HiperdriveProfile;
use super::hiperface::HiperfaceProfile;
use super::interbus::InterbusProfile;
use super::misspelt::Reading;
use super::place::place_of;
use super::ron_text::{Entries, Unknown, Writer};
use super::ssi::SsiProfile;
use super::unique_names::UniqueNames;
use crate::protocol::{biss, hiperdrive, hiperface, interbus, ssi};

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
    /// The version of its form. One that is newer than [`SCHEMA`] is only looked at: what this program does not know of it
    /// would be lost with a save.
    pub schema: u32,
    /// Places of entries that the schema does not have: of an older file they are taken into `extra`.
    pub beyond: Vec<String>,
}

/// What is saved, by kind of device.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A HIPERFACE encoder.
    Hiperface(HiperfaceProfile),
    /// A BiSS encoder.
    Biss(BissProfile),
    /// An SSI encoder.
    Ssi(SsiProfile),
    /// An INTERBUS encoder.
    Interbus(Box<InterbusProfile>),
    /// HIPERDRIVE: an adapter or a hub with its drives.
    Hiperdrive(Box<HiperdriveProfile>),
}

impl Document {
    /// A document of now.
    pub fn new(saved: String, body: Body) -> Self {
        Document { saved: Some(saved), note: None, body, unknown: Unknown::new(), schema: SCHEMA, beyond: Vec::new() }
    }

    /// Reads a profile.
    ///
    /// # Errors
    /// With line and column where the text is not RON, else with the entry that is wrong.
    pub fn parse(text: &str) -> Result<Self, ProfileError> {
        let syntax = |error: SpannedError| ProfileError::Syntax {
            line: error.span.start.line,
            column: error.span.start.col,
            what: match error.code {
                // The crate's own words are for programmers.
                ron::Error::ExceededRecursionLimit => "nested too deeply".to_owned(),
                code => code.to_string(),
            },
        };
        let value: Value = ron::from_str(text).map_err(syntax)?;
        ron::from_str::<UniqueNames>(text).map_err(syntax)?;
        let reading = Rc::new(Reading::default());
        Self::read(value, &reading).map_err(|error| match reading.told(error) {
            ProfileError::Misspelt { path, meant, .. } => {
                let (line, column) = place_of(text, &path).unwrap_or((1, 1));
                ProfileError::Misspelt { line, column, path, meant }
            }
            error => error,
        })
    }

    fn read(value: Value, reading: &Rc<Reading>) -> Result<Self, ProfileError> {
        let mut entries = Entries::open("", value, reading)?;
        let schema: u32 = entries.required("schema", "a whole number")?;
        if schema == 0 {
            return Err(ProfileError::Schema { found: schema, known: SCHEMA });
        }
        if schema > SCHEMA {
            reading.set_newer(schema);
        }
        let device: String = entries.required("device", "a text")?;
        let saved = entries.optional("saved", "a text")?;
        let note = entries.optional("note", "a text")?;
        let body = match device.as_str() {
            hiperface::KIND => Body::Hiperface(HiperfaceProfile::read(&mut entries)?),
            biss::KIND => Body::Biss(BissProfile::read(&mut entries)?),
            ssi::KIND => Body::Ssi(SsiProfile::read(&mut entries)?),
            interbus::KIND => Body::Interbus(Box::new(InterbusProfile::read(&mut entries)?)),
            hiperdrive::KIND => Body::Hiperdrive(Box::new(HiperdriveProfile::read(&mut entries)?)),
            _ => return Err(ProfileError::Device { found: device }),
        };
        let unknown = entries.rest()?;
        Ok(Document { saved, note, body, unknown, schema, beyond: reading.beyond() })
    }

    /// It is of a newer schema: it is looked at, compared, and neither saved nor written into a device.
    pub fn is_newer(&self) -> bool {
        self.schema > SCHEMA
    }

    /// The same, where all of it is known.
    ///
    /// # Errors
    /// [`ProfileError::Schema`] of a newer schema.
    pub fn known(self) -> Result<Self, ProfileError> {
        if self.is_newer() { Err(ProfileError::Schema { found: self.schema, known: SCHEMA }) } else { Ok(self) }
    }

    /// The profile's text.
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
        match &self.body {
            Body::Hiperface(profile) => profile.write(&mut writer),
            Body::Biss(profile) => profile.write(&mut writer),
            Body::Ssi(profile) => profile.write(&mut writer),
            Body::Interbus(profile) => profile.write(&mut writer),
            Body::Hiperdrive(profile) => profile.write(&mut writer),
        }
        writer.unknown(&self.unknown);
        writer.close(')');
        writer.finish()
    }

    /// The word for the kind of device, as on the command line.
    pub fn device(&self) -> &'static str {
        self.body.kind()
    }
}

impl Body {
    /// Kinds of devices that this program saves, by their words on the command line.
    pub const KINDS: [&'static str; 5] = [hiperface::KIND, biss::KIND, ssi::KIND, interbus::KIND, hiperdrive::KIND];

    /// The word for the kind of device.
    pub fn kind(&self) -> &'static str {
        match self {
            Body::Hiperface(_) => hiperface::KIND,
            Body::Biss(_) => biss::KIND,
            Body::Ssi(_) => ssi::KIND,
            Body::Interbus(_) => interbus::KIND,
            Body::Hiperdrive(_) => hiperdrive::KIND,
        }
    }

    /// It is of another kind of device than the one asked for.
    pub fn is_not(&self, wanted: &'static str) -> ProfileError {
        ProfileError::OtherKind { found: self.kind(), wanted }
    }

    /// The profile of a HIPERFACE encoder.
    ///
    /// # Errors
    /// [`ProfileError::OtherKind`].
    pub fn into_hiperface(self) -> Result<HiperfaceProfile, ProfileError> {
        match self {
            Body::Hiperface(profile) => Ok(profile),
            other => Err(other.is_not(hiperface::KIND)),
        }
    }

    /// The profile of a BiSS encoder.
    ///
    /// # Errors
    /// [`ProfileError::OtherKind`].
    pub fn into_biss(self) -> Result<BissProfile, ProfileError> {
        match self {
            Body::Biss(profile) => Ok(profile),
            other => Err(other.is_not(biss::KIND)),
        }
    }

    /// The profile of an SSI encoder.
    ///
    /// # Errors
    /// [`ProfileError::OtherKind`].
    pub fn into_ssi(self) -> Result<SsiProfile, ProfileError> {
        match self {
            Body::Ssi(profile) => Ok(profile),
            other => Err(other.is_not(ssi::KIND)),
        }
    }

    /// The profile of an INTERBUS encoder.
    ///
    /// # Errors
    /// [`ProfileError::OtherKind`].
    pub fn into_interbus(self) -> Result<InterbusProfile, ProfileError> {
        match self {
            Body::Interbus(profile) => Ok(*profile),
            other => Err(other.is_not(interbus::KIND)),
        }
    }

    /// The profile of an adapter or a hub.
    ///
    /// # Errors
    /// [`ProfileError::OtherKind`].
    pub fn into_hiperdrive(self) -> Result<HiperdriveProfile, ProfileError> {
        match self {
            Body::Hiperdrive(profile) => Ok(*profile),
            other => Err(other.is_not(hiperdrive::KIND)),
        }
    }

    /// The profile of a HIPERFACE encoder; `None` of another device.
    pub fn hiperface(&self) -> Option<&HiperfaceProfile> {
        match self {
            Body::Hiperface(profile) => Some(profile),
            Body::Biss(_) | Body::Ssi(_) | Body::Interbus(_) | Body::Hiperdrive(_) => None,
        }
    }

    /// The profile of a BiSS encoder; `None` of another device.
    pub fn biss(&self) -> Option<&BissProfile> {
        match self {
            Body::Biss(profile) => Some(profile),
            Body::Hiperface(_) | Body::Ssi(_) | Body::Interbus(_) | Body::Hiperdrive(_) => None,
        }
    }

    /// The profile of an SSI encoder; `None` of another device.
    pub fn ssi(&self) -> Option<&SsiProfile> {
        match self {
            Body::Ssi(profile) => Some(profile),
            Body::Hiperface(_) | Body::Biss(_) | Body::Interbus(_) | Body::Hiperdrive(_) => None,
        }
    }

    /// The profile of an INTERBUS encoder; `None` of another device.
    pub fn interbus(&self) -> Option<&InterbusProfile> {
        match self {
            Body::Interbus(profile) => Some(profile),
            Body::Hiperface(_) | Body::Biss(_) | Body::Ssi(_) | Body::Hiperdrive(_) => None,
        }
    }

    /// The profile of an adapter or a hub; `None` of another device.
    pub fn hiperdrive(&self) -> Option<&HiperdriveProfile> {
        match self {
            Body::Hiperdrive(profile) => Some(profile),
            Body::Hiperface(_) | Body::Biss(_) | Body::Ssi(_) | Body::Interbus(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::hiperface::{FieldImage, FieldRange};
    use crate::profile::tests::SHORT;
    use crate::protocol::hiperface::DataFieldStatus;

    fn profile(text: &str) -> HiperfaceProfile {
        Document::parse(text).unwrap().body.hiperface().unwrap().clone()
    }

    #[test]
    fn a_profile_written_by_hand_is_read() {
        let profile = profile(SHORT);
        assert_eq!(profile.identity.serial_number, "A1");
        let bytes = Some((0..16).collect());
        let status = DataFieldStatus::from_byte(0xC8);
        assert_eq!(profile.fields, [FieldImage { number: 0, status, bytes }]);
        assert_eq!(profile.recorded.position, None);
    }

    #[test]
    fn a_slip_of_the_hand_is_no_profile() {
        let cases = [
            ("fields: [(", "fields: [], fields: [(", "fields stands twice"),
            ("status: 0xC8", "status: 0xC9, status: 0xC8", "status stands twice"),
            ("fields:", "feilds:", "fields is missing"),
        ];
        for (from, to, why) in cases {
            let error = Document::parse(&SHORT.replace(from, to)).unwrap_err().to_string();
            assert!(error.ends_with(why), "{to}: {error}");
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let mut document = Document::parse(SHORT).unwrap();
        let Body::Hiperface(profile) = &mut document.body else { panic!() };
        profile.recorded.position = Some(0x000E_0531);
        profile.identity.extended_label = Some(vec![0x53; 64]);
        profile.identity.serial_number = "quote \" and \\ and ä".to_owned();
        let mut offset = b"CO1".to_vec();
        offset.resize(32, 0);
        let status = DataFieldStatus::from_byte(0x89);
        profile.fields.push(FieldImage { number: 1, status, bytes: Some(offset) });
        let status = DataFieldStatus::from_byte(0xE8);
        profile.fields.push(FieldImage { number: 2, status, bytes: None });
        profile.mark_mounting();
        assert_eq!(profile.mounting[0].item, FieldRange::new(1, 0, 16));
        document.note = Some("two\nlines".to_owned());
        assert_eq!(Document::parse(&document.emit()), Ok(document));
    }

    #[test]
    fn a_wrong_profile_is_told_where() {
        let cases = [
            ("", "", "line 1, column 1: "),
            ("schema: 1,", "schema: 1,,", "line 2, column 15: "),
            ("schema: 1,", "", "schema is missing"),
            ("schema: 1,", "schema: 0,", "schema 0; this program knows schema 1 to 1"),
            ("\"hiperface\"", "\"sse\"", "device \"sse\"; this program knows \"hiperface\", \"biss\", \"ssi\","),
            ("\"A1\"", "17", "identity.serial_number must be a text"),
            ("0x37", "0x137", "identity.encoder_type must be a number from 0 to 255 (0x00 to 0xFF)"),
            ("status: 0xC8", "status: 0x48", "fields[0].status: 48h is not the status of an existing field"),
            ("status: 0xC8", "status: 0xC9", "fields[0].bytes: 16 bytes where the status says 32"),
            ("00 01", "0G 01", "fields[0].bytes: 'G' is not a hexadecimal digit"),
            ("00 01", "00 1", "fields[0].bytes: \"1\" has an odd number of hexadecimal digits"),
            ("bytes:", "byts:", "line 5, column 40: fields[0].byts is not known, and bytes is missing"),
            (
                "bytes: \"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"",
                "",
                "fields[0].bytes: missing; a field without them is",
            ),
            ("bytes:", "locked: true, bytes:", "fields[0].bytes: a locked field has none"),
            ("fields: [", "fields: [5, ", "fields[0] must be a structure: (name: value, …)"),
            ("fields: [", "mounting: [(item: \"counter\")], fields: [", "mounting[0].item: \"counter\" is not"),
        ];
        for (old, new, message) in cases {
            let text = if old.is_empty() { String::new() } else { SHORT.replacen(old, new, 1) };
            let error = Document::parse(&text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error:?} does not begin with {message:?}");
        }
    }

    #[test]
    fn a_profile_of_another_kind_names_both() {
        let error = Document::parse(SHORT).unwrap().body.into_biss().unwrap_err();
        assert_eq!(error.to_string(), "a profile of a hiperface device where one of a biss device is needed");
        assert!(Document::parse(SHORT).unwrap().body.biss().is_none());
    }

    #[test]
    fn the_profiles_that_ship_are_read() {
        for kind in Body::KINDS {
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles").join(kind);
            let mut count = 0;
            for entry in std::fs::read_dir(folder).unwrap() {
                let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
                let document = Document::parse(&text).unwrap();
                assert_eq!((document.device(), document.emit()), (kind, text), "as the program writes it");
                count += 1;
            }
            // Of SSI, each family as delivered and one more.
            let expected = match kind {
                ssi::KIND => 12,
                interbus::KIND => 2,
                hiperdrive::KIND => 5,
                _ => 3,
            };
            assert_eq!(count, expected, "{kind}");
        }
    }
}
