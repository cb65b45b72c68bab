//! Helpers for profile tests, for any kind of device.

use super::{Profile, ProfileDocument, UpdatedText};

/// Edits a profile and its note, and saves it over the text from which it was read.
pub(crate) fn edit_profile<P: Profile>(
    text: &str,
    edit: impl FnOnce(&mut Option<String>, &mut P),
) -> (ProfileDocument, UpdatedText) {
    let mut document = ProfileDocument::parse(text, P::FORMATS).unwrap();
    edit(&mut document.note, document.body.get_mut().unwrap());
    let carried = document.rewrite_text(text, P::FORMATS);
    assert_eq!(ProfileDocument::parse(&carried.text, P::FORMATS).unwrap().emit(), document.emit());
    (document, carried)
}

/// Checks that an edit only replaces `from` with `to` in the text. If both are empty, the text must not change.
pub(crate) fn assert_edit_in_place<P: Profile>(text: &str, edit: impl FnOnce(&mut P), from: &str, to: &str) {
    let (_, same) = edit_profile(text, |_, _: &mut P| {});
    assert_eq!(same, UpdatedText { text: text.to_owned(), lost: Vec::new() });
    let (_, carried) = edit_profile(text, |_, own| edit(own));
    // The program chooses the form and the position of a new entry.
    let squeezed = |text: &str| text.split_whitespace().collect::<String>().replace(",)", ")");
    assert_eq!(squeezed(&carried.text), squeezed(&text.replace(from, to)));
    assert_eq!(carried.lost, Vec::<String>::new());
    assert_eq!(carried.text.matches("\r\n").count() > 0, text.contains("\r\n"));
    assert!(!carried.text.replace("\r\n", "").contains('\n') || !text.contains("\r\n"));
}
