//! Helpers for the tests of profiles of any kind of device.

use super::{Carried, Document, Profile};

/// A profile with its note, changed and put over the text that it was read from.
pub(crate) fn edited<P: Profile>(text: &str, edit: impl FnOnce(&mut Option<String>, &mut P)) -> (Document, Carried) {
    let mut document = Document::parse(text, P::FORMATS).unwrap();
    edit(&mut document.note, document.body.get_mut().unwrap());
    let carried = document.emit_over(text, P::FORMATS);
    assert_eq!(Document::parse(&carried.text, P::FORMATS).unwrap().emit(), document.emit());
    (document, carried)
}

/// A change touches nothing of the text but `from`, which becomes `to`; without one it touches nothing.
pub(crate) fn changed_in_place<P: Profile>(text: &str, edit: impl FnOnce(&mut P), from: &str, to: &str) {
    let (_, same) = edited(text, |_, _: &mut P| {});
    assert_eq!(same, Carried { text: text.to_owned(), lost: Vec::new() });
    let (_, carried) = edited(text, |_, own| edit(own));
    // An entry that is new is written as this program writes it, in its place.
    let squeezed = |text: &str| text.split_whitespace().collect::<String>().replace(",)", ")");
    assert_eq!(squeezed(&carried.text), squeezed(&text.replace(from, to)));
    assert_eq!(carried.lost, Vec::<String>::new());
    assert_eq!(carried.text.matches("\r\n").count() > 0, text.contains("\r\n"));
    assert!(!carried.text.replace("\r\n", "").contains('\n') || !text.contains("\r\n"));
}
