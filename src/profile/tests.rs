//! Names of entries: none is misspelt without a word, what today's files hold is read for ever, and a newer schema is only
//! looked at.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Body, Document, ProfileError};

fn profiles_in(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let in_kind = |kind: &str| fs::read_dir(root.join(kind)).unwrap().map(|entry| entry.unwrap().path());
    let all = Body::KINDS.into_iter().flat_map(in_kind);
    all.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Names before colons, outside of texts and comments: where each begins and ends.
fn names(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let (mut at, mut found) = (0, Vec::new());
    while at < bytes.len() {
        match bytes[at] {
            b'"' => {
                at += 1;
                while bytes[at] != b'"' {
                    at += if bytes[at] == b'\\' { 2 } else { 1 };
                }
                at += 1;
            }
            b'/' if bytes[at + 1] == b'/' => at += text[at..].find('\n').unwrap(),
            byte if byte.is_ascii_alphabetic() => {
                let end = at + text[at..].find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap();
                if text[end..].trim_start().starts_with(':') {
                    found.push((at, end));
                }
                at = end;
            }
            _ => at += 1,
        }
    }
    found
}

/// Slips of the hand: a letter left out, doubled, exchanged with its neighbour, added.
fn slips(name: &str) -> Vec<String> {
    let short = name[..name.len() - 1].to_owned();
    let doubled = format!("{name}{}", &name[name.len() - 1..]);
    let (first, rest) = name.split_at(1);
    let (second, rest) = rest.split_at(1);
    [short, doubled, format!("{second}{first}{rest}"), format!("x{name}"), name.to_uppercase()]
        .into_iter()
        .filter(|slip| slip != name)
        .collect()
}

/// Issue 22.17: of 393 names 153 passed unnoticed.
#[test]
fn no_name_of_a_ready_made_profile_is_misspelt_without_a_word() {
    let mut misspelt = 0;
    for (path, text) in profiles_in("profiles") {
        for (begin, end) in names(&text) {
            let line = text[..begin].matches('\n').count() + 1;
            let column = begin - text[..begin].rfind('\n').map_or(0, |at| at + 1) + 1;
            for slip in slips(&text[begin..end]) {
                let wrong = format!("{}{slip}{}", &text[..begin], &text[end..]);
                let error = Document::parse(&wrong).map(|_| ()).unwrap_err();
                let place = format!("line {line}, column {column}: ");
                assert!(error.to_string().starts_with(&place), "{}: {slip} at {place}{error}", path.display());
                assert!(error.to_string().contains(&slip), "{}: {error}", path.display());
            }
            misspelt += 1;
        }
    }
    assert!(misspelt >= 393, "{misspelt}");
}

/// Issue 22.17: profiles that were ready-made with schema 1, and one of each kind as it was saved then.
#[test]
fn profiles_of_schema_1_open() {
    let files = profiles_in("tests/fixtures/schema-1");
    assert_eq!(files.iter().filter(|(path, _)| path.file_stem().unwrap() == "saved").count(), Body::KINDS.len());
    for (path, text) in files {
        let document = Document::parse(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(document.beyond.is_empty() && !document.is_newer(), "{}", path.display());
        assert_eq!(Document::parse(&document.emit()), Ok(document), "{}", path.display());
    }
}

/// A profile as a person may write it.
pub(super) const SHORT: &str = r#"(
    schema: 1, device: "hiperface",
    identity: (serial_number: "A1", encoder_type: 0x37),
    interface: (address: 0x40, settings: 0xE4),
    fields: [(number: 0, status: 0xC8, bytes: "00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F")],
)"#;

/// Issue 22.17: people's own entries stand in `extra`, in any structure.
#[test]
fn entries_of_ones_own_are_kept() {
    let text = SHORT
        .replace("schema: 1,", "schema: 1, extra: {\"owner\": (name: \"CK\")},")
        .replace("serial_number:", "extra: (colour: Some(\"red\")), serial_number:")
        .replace("fields: [", "mounting: [(item: \"field:0@0+4\", extra: {\"by\": \"CK\"})], fields: [")
        .replace("number: 0,", "number: 0, extra: {},");
    let document = Document::parse(&text).unwrap();
    assert_eq!(document.beyond, [""; 0]);
    let written = document.emit();
    for kept in ["extra: {\"owner\": (name: \"CK\")}", "extra: {\"colour\": Some(\"red\")}", "extra: {\"by\": \"CK\"}"]
    {
        assert!(written.contains(kept), "{kept} is not in\n{written}");
    }
    assert_eq!(Document::parse(&written), Ok(document));
    let error = Document::parse(&SHORT.replace("schema: 1,", "schema: 1, extra: 5,")).unwrap_err();
    assert!(matches!(&error, ProfileError::Shape { path, .. } if path == "extra"), "{error}");
}

/// Issue 22.17: what a file of before `extra` holds beyond the schema is taken into it, and named.
#[test]
fn what_older_files_hold_beyond_the_schema_is_taken_over() {
    let text = SHORT.replace("schema: 1,", "schema: 1, owner: \"CK\",").replace("number: 0,", "number: 0, label: 3,");
    let document = Document::parse(&text).unwrap();
    assert_eq!(document.beyond, ["fields[0].label", "owner"]);
    let written = document.emit();
    assert!(written.contains("extra: {\"owner\": \"CK\"}") && written.contains("extra: {\"label\": 3}"), "{written}");
    let again = Document::parse(&written).unwrap();
    assert_eq!((again.beyond, again.unknown, again.body), (Vec::new(), document.unknown, document.body));
}

/// Issue 22.17: nothing of a newer schema is lost, because nothing of it is written.
#[test]
fn a_newer_schema_is_only_looked_at() {
    let newer = SHORT.replace("schema: 1,", "schema: 7, feilds: 1,").replace("number: 0,", "number: 0, statsu: 3,");
    let document = Document::parse(&newer).unwrap();
    assert!(document.is_newer());
    assert_eq!(document.beyond, ["fields[0].statsu", "feilds"]);
    assert!(document.emit().contains("schema: 7,"), "never as an older one");
    assert_eq!(document.known(), Err(ProfileError::Schema { found: 7, known: 1 }));
    let zero = Document::parse(&SHORT.replace("schema: 1,", "schema: 0,"));
    assert_eq!(zero, Err(ProfileError::Schema { found: 0, known: 1 }));
}
