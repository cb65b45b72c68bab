//! Tests with profiles of every kind: ready-made ones, ones of schema 1, and ones with misspelt entry names.

use std::fs;
use std::path::{Path, PathBuf};

use super::program;
use crate::profile::{ProfileDocument, ProfileError};

mod adapter;
mod options;
mod rewrite;

fn read_folder_profiles(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let in_kind = |kind: &str| fs::read_dir(root.join(kind)).unwrap().map(|entry| entry.unwrap().path());
    let all = program().studio.formats.kinds().flat_map(in_kind);
    all.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Returns the start and end of each entry name, which is a word before a colon outside strings and comments.
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

/// Returns a name with typing errors: a letter omitted, doubled, swapped with its neighbour, or added.
fn generate_typos(name: &str) -> Vec<String> {
    let short = name[..name.len() - 1].to_owned();
    let doubled = format!("{name}{}", &name[name.len() - 1..]);
    let (first, rest) = name.split_at(1);
    let (second, rest) = rest.split_at(1);
    [short, doubled, format!("{second}{first}{rest}"), format!("x{name}"), name.to_uppercase()]
        .into_iter()
        .filter(|slip| slip != name)
        .collect()
}

/// No misspelt name may be accepted, as 153 of 393 once were (issue 22.17).
#[test]
fn reports_misspelt_names_in_ready_made_profiles() {
    let mut misspelt = 0;
    for (path, text) in read_folder_profiles("profiles") {
        for (begin, end) in names(&text) {
            let line = text[..begin].matches('\n').count() + 1;
            let column = begin - text[..begin].rfind('\n').map_or(0, |at| at + 1) + 1;
            for slip in generate_typos(&text[begin..end]) {
                let wrong = format!("{}{slip}{}", &text[..begin], &text[end..]);
                let error = ProfileDocument::parse(&wrong, program().studio.formats).map(|_| ()).unwrap_err();
                let place = format!("line {line}, column {column}: ");
                assert!(error.to_string().starts_with(&place), "{}: {slip} at {place}{error}", path.display());
                assert!(error.to_string().contains(&slip), "{}: {error}", path.display());
            }
            misspelt += 1;
        }
    }
    assert!(misspelt >= 393, "{misspelt}");
}

/// Covers the ready-made profiles of schema 1, and a profile of each kind saved at that time (issue 22.17).
#[test]
fn opens_schema_1_profiles() {
    let files = read_folder_profiles("tests/fixtures/schema-1");
    assert_eq!(
        files.iter().filter(|(path, _)| path.file_stem().unwrap() == "saved").count(),
        program().studio.formats.kinds().count()
    );
    for (path, text) in files {
        let document = ProfileDocument::parse(&text, program().studio.formats)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(document.beyond.is_empty() && !document.is_newer(), "{}", path.display());
        assert_eq!(
            ProfileDocument::parse(&document.emit(), program().studio.formats),
            Ok(document),
            "{}",
            path.display()
        );
    }
}

#[test]
fn ready_made_profiles_parse() {
    for kind in program().studio.formats.kinds() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles").join(kind);
        let mut count = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let text = std::fs::read_to_string(entry.unwrap().path()).unwrap();
            let document = ProfileDocument::parse(&text, program().studio.formats).unwrap();
            assert_eq!((document.device(), document.emit()), (kind, text), "as the program writes it");
            count += 1;
        }
        // For SSI, there is one profile for each family with factory settings, and one more.
        let expected = match kind {
            "ssi" => 12,
            "interbus" => 2,
            "hiperdrive" => 5,
            _ => 3,
        };
        assert_eq!(count, expected, "{kind}");
    }
}

#[test]
fn unknown_kind_error_lists_known_kinds() {
    let error = ProfileDocument::parse("(schema: 1, device: \"sse\")", program().studio.formats).unwrap_err();
    let known = "\"hiperface\", \"biss\", \"ssi\", \"interbus\" and \"hiperdrive\"";
    assert_eq!(error.to_string(), format!("device \"sse\" is not supported (supported: {known})"));
    assert!(matches!(error, ProfileError::Device { found, .. } if found == "sse"));
}

#[test]
fn tabs_follow_navigation_order() {
    let tabs: Vec<_> = program().tabs.tabs().map(crate::app::Tab::name).collect();
    assert_eq!(
        tabs,
        ["Hiperface", "Biss", "Ssi", "Interbus", "Hiperdrive", "Signals", "Logbook"],
        "devices, then tools"
    );
    // The logbook is a single page without a list of pages.
    for tab in program().tabs.tabs().filter(|tab| *tab != crate::app::LOGBOOK_TAB) {
        let mut words = program().tabs.page_text_ids(tab);
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert!(count > 0 && words.len() == count, "{tab:?}: {words:?}");
    }
}
