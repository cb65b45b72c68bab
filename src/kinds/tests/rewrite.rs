//! Tests that save profiles of every kind over edited text.

use super::program;
use crate::profile::{ProfileDocument, UpdatedText};

fn ready_made() -> Vec<(&'static str, String)> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
    let mut found = Vec::new();
    for kind in program().studio.formats.kinds() {
        for file in std::fs::read_dir(root.join(kind)).unwrap() {
            found.push((kind, std::fs::read_to_string(file.unwrap().path()).unwrap()));
        }
    }
    assert!(found.len() > 20, "{}", found.len());
    found
}

/// Returns a profile of this kind with comments by a user.
fn commented_profile(kind: &str) -> String {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/commented");
    std::fs::read_to_string(folder.join(kind).with_extension("ron")).unwrap()
}

/// Saving an unchanged profile keeps the text, for every kind and any line endings (issue 22.26).
#[test]
fn keeps_unchanged_text_verbatim() {
    for kind in program().studio.formats.kinds() {
        let text = commented_profile(kind);
        for text in [text.replace('\n', "\r\n"), text] {
            let carried = ProfileDocument::parse(&text, program().studio.formats)
                .unwrap()
                .rewrite_text(&text, program().studio.formats);
            assert_eq!(carried, UpdatedText { text, lost: Vec::new() });
        }
    }
}

/// Saving a different profile over a text writes its exact content, and each user comment is kept or reported as lost
/// (issue 22.26).
#[test]
fn rewrite_is_exact_and_lists_lost_comments() {
    let all = ready_made();
    for (kind, text) in &all {
        for line_end in ["\n", "\r\n"] {
            let lines = text.lines().enumerate().map(|(at, line)| format!("{line}{line_end}// own {at}.{line_end}"));
            let commented: String = lines.collect();
            for (_, other) in all.iter().filter(|(own, _)| own == kind) {
                let document = ProfileDocument::parse(other, program().studio.formats).unwrap();
                let carried = document.rewrite_text(&commented, program().studio.formats);
                assert_eq!(
                    ProfileDocument::parse(&carried.text, program().studio.formats).unwrap().emit(),
                    document.emit()
                );
                for at in 0..text.lines().count() {
                    let own = format!("own {at}.");
                    let stays = carried.text.contains(&format!("// {own}"));
                    assert_eq!(stays, !carried.lost.contains(&own), "{own}");
                }
                if line_end == "\r\n" {
                    assert!(!carried.text.replace("\r\n", "").contains('\n'));
                }
            }
            let own = ProfileDocument::parse(text, program().studio.formats)
                .unwrap()
                .rewrite_text(&commented, program().studio.formats);
            assert_eq!(own, UpdatedText { text: commented, lost: Vec::new() });
        }
    }
}

/// Returns the text with its whitespace replaced by spaces, line ends and numbered comments, as selected by `picks`.
/// Also returns the number of comments.
fn with_varied_whitespace(text: &str, picks: &[usize]) -> (String, usize) {
    const WAYS: usize = 9;
    let (mut out, mut comments, mut at, mut pick) = (String::new(), 0, 0, picks.iter().cycle());
    let mut quoted = false;
    let letters: Vec<char> = text.chars().collect();
    while at < letters.len() {
        let letter = letters[at];
        let between = !quoted && (letter.is_whitespace() || "([{,".contains(letter));
        if quoted && letter == '\\' {
            out.extend([letter, letters[at + 1]]);
            at += 2;
            continue;
        }
        if letter == '"' {
            quoted = !quoted;
        }
        if !quoted && letters[at..].starts_with(&['/', '/']) {
            at += letters[at..].iter().position(|own| *own == '\n').unwrap_or(letters.len() - at);
            continue;
        }
        if !letter.is_whitespace() || quoted {
            out.push(letter);
        }
        at += 1;
        if !between {
            continue;
        }
        let own = format!("own {comments}.");
        let blank = match pick.next().unwrap() % WAYS {
            0 => " ".to_owned(),
            1 => "\n".to_owned(),
            2 => "\t\r\n  ".to_owned(),
            3 => format!(" // {own}\n"),
            4 => format!("// {own}\r\n"),
            5 => format!(" /* {own} */ "),
            6 => format!("/* {own} */"),
            7 => format!("\n/* \"( /* ,[ */ {{\n{own} */\n"),
            _ => format!(" // \u{1F527} ü\" ( , {own}\n"),
        };
        comments += usize::from(blank.contains(&own));
        out.push_str(&blank);
    }
    (out, comments)
}

proptest::proptest! {
    #![proptest_config(proptest::test_runner::Config { cases: 256, ..Default::default() })]

    /// Wherever a text has comments and line endings, saving any profile over it keeps the comments or reports them as
    /// lost (issue 22.26).
    #[test]
    fn keeps_or_lists_comments_between_tokens(
        from in 0_usize..100,
        to in 0_usize..100,
        picks in proptest::collection::vec(0_usize..9, 1..200),
    ) {
        let mut all = ready_made();
        all.extend(program().studio.formats.kinds().map(|kind| (kind, commented_profile(kind))));
        let (kind, text) = &all[from % all.len()];
        let others: Vec<&String> = all.iter().filter(|(own, _)| own == kind).map(|(_, text)| text).collect();
        let document = ProfileDocument::parse(others[to % others.len()], program().studio.formats).unwrap();
        let (spaced, comments) = with_varied_whitespace(text, &picks);
        let before = ProfileDocument::parse(&spaced, program().studio.formats).unwrap();
        proptest::prop_assert_eq!(before.emit(), ProfileDocument::parse(text, program().studio.formats).unwrap().emit());
        let same = before.rewrite_text(&spaced, program().studio.formats);
        proptest::prop_assert_eq!(same, UpdatedText { text: spaced.clone(), lost: Vec::new() });
        let carried = document.rewrite_text(&spaced, program().studio.formats);
        proptest::prop_assert_eq!(ProfileDocument::parse(&carried.text, program().studio.formats).unwrap().emit(), document.emit());
        for at in 0..comments {
            let own = format!("own {at}.");
            let stays = carried.text.contains(&own);
            let is_named = carried.lost.iter().any(|lost| lost.contains(&own));
            proptest::prop_assert!(stays != is_named, "{own}\n{spaced}\n----\n{}", carried.text);
        }
    }
}
