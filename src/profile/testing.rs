//! Helpers for profile tests of any kind of device.

use super::{Carried, Document, Profile};

/// Changes a profile with its note, and saves it over the text from which it was read.
pub(crate) fn edited<P: Profile>(text: &str, edit: impl FnOnce(&mut Option<String>, &mut P)) -> (Document, Carried) {
    let mut document = Document::parse(text, P::FORMATS).unwrap();
    edit(&mut document.note, document.body.get_mut().unwrap());
    let carried = document.emit_over(text, P::FORMATS);
    assert_eq!(Document::parse(&carried.text, P::FORMATS).unwrap().emit(), document.emit());
    (document, carried)
}

/// Checks that a change replaces only `from` by `to` in the text, or nothing if there is none.
pub(crate) fn changed_in_place<P: Profile>(text: &str, edit: impl FnOnce(&mut P), from: &str, to: &str) {
    let (_, same) = edited(text, |_, _: &mut P| {});
    assert_eq!(same, Carried { text: text.to_owned(), lost: Vec::new() });
    let (_, carried) = edited(text, |_, own| edit(own));
    // A new entry is written in the form and at the place that this program chooses.
    let squeezed = |text: &str| text.split_whitespace().collect::<String>().replace(",)", ")");
    assert_eq!(squeezed(&carried.text), squeezed(&text.replace(from, to)));
    assert_eq!(carried.lost, Vec::<String>::new());
    assert_eq!(carried.text.matches("\r\n").count() > 0, text.contains("\r\n"));
    assert!(!carried.text.replace("\r\n", "").contains('\n') || !text.contains("\r\n"));
}
