//! Words that must not come back into the texts of the window and the command line: docs/terms.md has those to use.

use std::fs;

const ENGLISH: &[&str] = &[
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
const GERMAN: &[&str] = &["jemand", "lampe", "lampen", "leuchte", "leuchten", "verbindungsangabe"];

/// Whether a text has these words as words.
fn has(text: &str, words: &str) -> bool {
    let text = text.to_lowercase();
    text.match_indices(words).any(|(at, _)| {
        let is_end = |c: Option<char>| !c.is_some_and(char::is_alphanumeric);
        is_end(text[..at].chars().next_back()) && is_end(text[at + words.len()..].chars().next())
    })
}

/// The texts of a line of a catalogue, each with its language.
fn texts(line: &str) -> impl Iterator<Item = (&'static str, &str)> {
    ["en", "terminal", "de"].into_iter().filter_map(move |language| {
        let begin = line.find(&format!("{language}: \""))? + language.len() + 3;
        let rest = &line[begin..];
        let end = rest.match_indices('"').map(|(at, _)| at).find(|at| !rest[..*at].ends_with('\\'))?;
        Some((language, &rest[..end]))
    })
}

#[test]
fn no_text_has_a_word_that_was_given_up() {
    let mut found = Vec::new();
    let mut read = 0;
    for file in fs::read_dir("assets/texts").unwrap() {
        let path = file.unwrap().path();
        for line in fs::read_to_string(&path).unwrap().lines() {
            for (language, text) in texts(line) {
                read += 1;
                let given_up = if language == "de" { GERMAN } else { ENGLISH };
                let words = given_up.iter().filter(|words| has(text, words));
                found.extend(words.map(|words| format!("{}: \"{words}\" in {text}", path.display())));
            }
        }
    }
    assert!(read > 7000, "{read} texts");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn a_word_is_found_as_a_word() {
    assert!(has("Nobody acknowledges.", "nobody") && has("as all the same", "all the same"));
    assert!(!has("Recommend it.", "mend") && !has("clamps", "lamps"));
    let line = r#"    "x": (en: "a \"lamp\" b", de: "eine Lampe"),"#;
    assert_eq!(texts(line).collect::<Vec<_>>(), [("en", r#"a \"lamp\" b"#), ("de", "eine Lampe")]);
}
