//! Tests of documents with invented kinds of devices: a light with steps, and a fan.

use super::testing::{assert_edit_in_place, edit_profile};
use super::*;
use crate::expected::AllowedValues;

/// A light that is switched in steps.
#[derive(Clone, Debug, PartialEq)]
struct Lamp {
    colour: String,
    steps: Vec<(u8, UnknownValues)>,
}

impl Profile for Lamp {
    const KIND: &'static str = "lamp";

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let colour = entries.take_required("colour", AllowedValues::Text)?;
        let mut steps = Vec::new();
        for mut entries in entries.take_structures("steps")? {
            steps.push((entries.take_required("level", AllowedValues::whole_range(0, 255))?, entries.into_unknown()?));
        }
        Ok(Lamp { colour, steps })
    }

    fn write(&self, writer: &mut Writer) {
        writer.text("colour", &self.colour);
        writer.open("steps", '[');
        for (level, unknown) in &self.steps {
            writer.open("", '(');
            writer.entry("level", &level.to_string(), "");
            writer.write_unknown(unknown);
            writer.close(')');
        }
        writer.close(']');
    }

    fn compare(&self, other: &Self) -> Comparison {
        let mut comparison = Comparison::default();
        comparison.compare_item("colour".to_owned(), Some(&self.colour), Some(&other.colour));
        comparison
    }
}

/// A fan without any known entries.
#[derive(Clone, Debug, PartialEq)]
struct Fan;

impl Profile for Fan {
    const KIND: &'static str = "fan";

    fn read(_: &mut Entries) -> Result<Self, ProfileError> {
        Ok(Fan)
    }

    fn write(&self, _: &mut Writer) {}

    fn compare(&self, _: &Self) -> Comparison {
        Comparison::default()
    }
}

const FORMATS: ProfileFormats = ProfileFormats::new(&[Lamp::FORMAT, Fan::FORMAT]);

const TEXT: &str = r#"// hall 2
(schema: 1, device: "lamp", // ours
    steps: [
        (level: 10), // night
        (level: 0x40),
    ],
    colour: "red")
"#;

fn parse(text: &str) -> Result<ProfileDocument, ProfileError> {
    ProfileDocument::parse(text, FORMATS)
}

fn lamp(colour: &str) -> Body {
    Body::new(Lamp { colour: colour.to_owned(), steps: Vec::new() })
}

#[test]
fn parses_document_in_its_format() {
    let document = parse(TEXT).unwrap();
    assert_eq!(document.device(), "lamp");
    assert_eq!(document.body.get::<Lamp>().unwrap().steps, [(10, UnknownValues::new()), (0x40, UnknownValues::new())]);
    assert_eq!(document.body.get::<Fan>(), None);
    assert_eq!(parse(&document.emit()), Ok(document));
    assert_eq!(parse("(schema: 1, device: \"fan\")").unwrap().body, Body::new(Fan));
}

#[test]
fn bodies_compare_by_kind_and_content() {
    assert_eq!(lamp("red"), lamp("red"));
    assert_ne!(lamp("red"), lamp("blue"));
    assert_ne!(lamp("red"), Body::new(Fan));
    let mut other = lamp("red").clone();
    other.get_mut::<Lamp>().unwrap().colour = "blue".to_owned();
    assert_eq!(other, lamp("blue"));
    assert_eq!(format!("{other:?}"), format!("{:?}", other.get::<Lamp>().unwrap()));
}

#[test]
fn unknown_kind_error_lists_known_kinds() {
    let told = |formats| ProfileDocument::parse("(schema: 1, device: \"tap\")", formats).unwrap_err().to_string();
    let three = ProfileFormats::new(&[Lamp::FORMAT, Fan::FORMAT, Lamp::FORMAT]);
    assert_eq!(told(Lamp::FORMATS), "device \"tap\" is not supported (supported: \"lamp\")");
    assert_eq!(told(FORMATS), "device \"tap\" is not supported (supported: \"lamp\" and \"fan\")");
    assert_eq!(told(three), "device \"tap\" is not supported (supported: \"lamp\", \"fan\" and \"lamp\")");
}

#[test]
fn kind_mismatch_names_both_kinds() {
    let error = lamp("red").into_profile::<Fan>().unwrap_err();
    assert_eq!(error, lamp("red").wrong_kind_error(Fan::KIND));
    assert_eq!(error.to_string(), "the profile is for a lamp device, not for a fan device");
    assert_eq!(Body::new(Fan).into_profile(), Ok(Fan));
}

#[test]
fn keeps_user_and_newer_schema_entries() {
    let own = TEXT.replace("(level: 10)", "(level: 10, extra: {\"by\": \"CK\"})");
    let document = parse(&own).unwrap();
    assert!(document.beyond.is_empty() && document.emit().contains("extra: {\"by\": \"CK\"}"));
    let newer = parse(&TEXT.replace("schema: 1", "schema: 7, power: 3")).unwrap();
    assert!(newer.is_newer() && newer.beyond == ["power"]);
    assert_eq!(newer.check_schema(), Err(ProfileError::Schema { found: 7, known: 1 }));
    let error = parse(&TEXT.replace("colour", "color")).unwrap_err().to_string();
    assert_eq!(error, "line 7, column 5: color is unknown, and colour is missing");
}

/// A document is saved over a user's text, and merged with another user's changes (issues 22.25 and 22.26).
#[test]
fn merges_document_into_text_and_document() {
    assert_edit_in_place(TEXT, |own: &mut Lamp| own.colour = "blue".to_owned(), "\"red\"", "\"blue\"");
    let (_, carried) = edit_profile(TEXT, |note, own: &mut Lamp| {
        *note = Some("as of today".to_owned());
        own.steps.remove(0);
    });
    assert_eq!(carried.lost, ["night"]);
    assert!(carried.text.starts_with("// hall 2\n") && carried.text.contains("note: \"as of today\""));

    let base = parse(TEXT).unwrap();
    let theirs = parse(&TEXT.replace("red", "blue")).unwrap();
    let mine = parse(&TEXT.replace("level: 10", "level: 20")).unwrap();
    let found = diverging_changes(&base, &theirs, &mine);
    let who: Vec<ChangedSide> = found.iter().map(|(_, who)| *who).collect();
    assert!(
        who.contains(&ChangedSide::There) && who.contains(&ChangedSide::Here) && !who.contains(&ChangedSide::Both),
        "{found:?}"
    );
    let here: Vec<Change> =
        found.into_iter().filter(|(_, who)| *who == ChangedSide::Here).map(|(own, _)| own).collect();
    let merged = theirs.with_changes(&here, FORMATS).unwrap();
    assert_eq!(merged, parse(&TEXT.replace("red", "blue").replace("level: 10", "level: 20")).unwrap());
}

#[test]
fn cause_keeps_error_type() {
    #[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
    #[error("{0} lamps are too many")]
    struct TooManyLamps(u32);

    let cause = Cause::new(TooManyLamps(3));
    assert_eq!((cause.to_string(), cause.get()), ("3 lamps are too many".to_owned(), Some(&TooManyLamps(3))));
    assert_eq!(cause.get::<ProfileError>(), None);
    assert_eq!(cause, cause.clone());
    assert_ne!(cause, Cause::new(TooManyLamps(4)));
    let error = ProfileError::Refused { path: "lamps".to_owned(), cause };
    assert_eq!(error.to_string(), "lamps: 3 lamps are too many");
}

#[test]
fn compares_profiles_of_one_kind() {
    let comparison = lamp("red").compare(&lamp("blue")).unwrap();
    assert_eq!((comparison.compared, comparison.differences().len()), (1, 1));
    assert!(matches!(
        lamp("red").compare(&Body::new(Fan)),
        Err(ProfileError::OtherKind { found: "fan", wanted: "lamp" })
    ));
}
