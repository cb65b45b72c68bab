//! Words that must not be used in the texts of the window and the command line (docs/terms.md lists those to use), or
//! in comments of the code.

use std::fs;
use std::path::{Path, PathBuf};

const FORBIDDEN_ENGLISH: &[&str] = &[
    "nobody",
    "somebody",
    "whoever",
    "all the same",
    "of its own",
    "lately",
    "lamp",
    "lamps",
    "reckon",
    "reckons",
    "reckoned",
    "mend",
    "mended",
    "mends",
    "you may not",
    "anew",
    "talks",
    "on its desk",
];
/// Words that must not appear in comments: see CONTRIBUTING.md.
const FORBIDDEN_IN_COMMENTS: &[&str] = &[
    "nobody",
    "somebody",
    "anew",
    "all the same",
    "lately",
    "reckon",
    "mend",
    "lamp",
    "lamps",
    "most usual",
    "endures",
    "early end",
];
const FORBIDDEN_OPENINGS: &[&str] = &["Who ", "Where ", "That ", "Nobody ", "Somebody ", "Whoever "];
const FORBIDDEN_GERMAN: &[&str] = &["jemand", "lampe", "lampen", "leuchte", "leuchten", "verbindungsangabe"];

/// Returns whether a text contains the given words, matching only whole words.
fn has(text: &str, words: &str) -> bool {
    let text = text.to_lowercase();
    text.match_indices(words).any(|(at, _)| {
        let is_end = |c: Option<char>| !c.is_some_and(char::is_alphanumeric);
        is_end(text[..at].chars().next_back()) && is_end(text[at + words.len()..].chars().next())
    })
}

/// Returns the texts in a catalogue line with their languages.
fn texts(line: &str) -> impl Iterator<Item = (&'static str, &str)> {
    ["en", "terminal", "de"].into_iter().filter_map(move |language| {
        let begin = line.find(&format!("{language}: \""))? + language.len() + 3;
        let rest = &line[begin..];
        let end = rest.match_indices('"').map(|(at, _)| at).find(|at| !rest[..*at].ends_with('\\'))?;
        Some((language, &rest[..end]))
    })
}

#[test]
fn texts_contain_no_forbidden_words() {
    let mut found = Vec::new();
    let mut read = 0;
    for file in fs::read_dir("assets/texts").unwrap() {
        let path = file.unwrap().path();
        for line in fs::read_to_string(&path).unwrap().lines() {
            for (language, text) in texts(line) {
                read += 1;
                let given_up = if language == "de" { FORBIDDEN_GERMAN } else { FORBIDDEN_ENGLISH };
                let words = given_up.iter().filter(|words| has(text, words));
                found.extend(words.map(|words| format!("{}: \"{words}\" in {text}", path.display())));
            }
        }
    }
    assert!(read > 7000, "{read} texts");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Returns the comment in a line, and whether it is a doc comment.
fn comment(line: &str) -> Option<(bool, &str)> {
    let text = line.trim_start().strip_prefix("//")?;
    let is_doc = text.starts_with(['/', '!']);
    Some((is_doc, text.trim_start_matches(['/', '!']).trim_start()))
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_of_tests = path.file_stem().is_some_and(|stem| stem == "tests" || stem == "vectors");
        match path.is_dir() {
            _ if is_of_tests => {}
            true => sources(&path, found),
            false => found.extend(path.extension().is_some_and(|ending| ending == "rs").then_some(path)),
        }
    }
}

#[test]
fn comments_contain_no_forbidden_words() {
    let (mut files, mut found, mut read) = (Vec::new(), Vec::new(), 0);
    for folder in ["src", "adapter/codec/src", "adapter/core/src", "adapter/firmware/src"] {
        sources(Path::new(folder), &mut files);
    }
    for path in files {
        let mut goes_on = false;
        for (number, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let Some((is_doc, text)) = comment(line) else {
                goes_on = false;
                continue;
            };
            read += 1;
            let begins = is_doc && !goes_on && FORBIDDEN_OPENINGS.iter().any(|beginning| text.starts_with(beginning));
            if begins || FORBIDDEN_IN_COMMENTS.iter().any(|words| has(text, words)) {
                found.push(format!("{}:{}: {text}", path.display(), number + 1));
            }
            goes_on = true;
        }
    }
    assert!(read > 10_000, "{read} lines of comments");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn matches_whole_words_only() {
    assert!(has("Nobody acknowledges.", "nobody") && has("as all the same", "all the same"));
    assert!(!has("Recommend it.", "mend") && !has("clamps", "lamps"));
    assert_eq!(comment("    /// Who comes."), Some((true, "Who comes.")));
    assert_eq!((comment("let x = 1;"), comment("// It is.")), (None, Some((false, "It is."))));
    let line = r#"    "x": (en: "a \"lamp\" b", de: "eine Lampe"),"#;
    assert_eq!(texts(line).collect::<Vec<_>>(), [("en", r#"a \"lamp\" b"#), ("de", "eine Lampe")]);
}
