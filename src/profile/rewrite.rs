//! A profile saved over a text edited by a user, and profiles of two users merged.

use super::source::{Carried, Change, applied, carry, changes, lost};
use super::{Document, Formats, ProfileError};

impl Document {
    /// Returns `text` with the content of the document: equal entries remain as written, with comments, order and line
    /// ends.
    pub fn emit_over(&self, text: &str, formats: Formats) -> Carried {
        let own = self.emit();
        let before = Document::parse(text, formats).map(|before| before.emit());
        let carried = before.as_ref().ok().and_then(|before| carry(text, before, &own));
        let says_the_same = |text: &str| Document::parse(text, formats).is_ok_and(|read| read.emit() == own);
        match carried {
            Some(carried) if says_the_same(&carried.text) => carried,
            _ => {
                let lost = lost(text, &own, before.as_deref().unwrap_or_default());
                let text = if text.contains("\r\n") { own.replace('\n', "\r\n") } else { own };
                Carried { text, lost }
            }
        }
    }

    /// Returns the changes that turn this into `other`, entry by entry.
    pub fn changes_to(&self, other: &Document) -> Vec<Change> {
        changes(&self.emit(), &other.emit()).unwrap_or_default()
    }

    /// Returns the document with these changes.
    ///
    /// # Errors
    /// Returns the error if the result is not a profile; `None` if a change has no place in it.
    pub fn changed(&self, changes: &[Change], formats: Formats) -> Result<Document, Option<ProfileError>> {
        Document::parse(&applied(&self.emit(), changes).ok_or(None)?, formats).map_err(Some)
    }
}

/// Which side changed an entry since both had the same profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changed {
    /// The other one alone.
    There,
    /// This one alone.
    Here,
    /// Both.
    Both,
}

/// Returns the changes that turn `theirs` into `mine`, and which side made each.
pub fn divergence(base: &Document, theirs: &Document, mine: &Document) -> Vec<(Change, Changed)> {
    let (there, here) = (base.changes_to(theirs), base.changes_to(mine));
    let touches = |own: &[Change], change: &Change| {
        let shares = |other: &Change| other.path.iter().zip(&change.path).all(|(one, other)| one == other);
        own.iter().any(shares)
    };
    let changed = |change: &Change| match (touches(&there, change), touches(&here, change)) {
        (true, false) => Changed::There,
        (false, true) => Changed::Here,
        _ => Changed::Both,
    };
    theirs
        .changes_to(mine)
        .into_iter()
        .map(|change| {
            let who = changed(&change);
            (change, who)
        })
        .collect()
}
