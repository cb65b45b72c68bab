//! Saves a profile over a file that a user has edited, and merges profiles edited by two users.

use super::source::{Change, UpdatedText, apply_all, carry_changes, find_changes, lost_comments};
use super::{ProfileDocument, ProfileError, ProfileFormats};

impl ProfileDocument {
    /// Updates `text` to the content of the document. Entries that have not changed keep their notation, comments,
    /// order and line endings.
    pub fn rewrite_text(&self, text: &str, formats: ProfileFormats) -> UpdatedText {
        let own = self.emit();
        let before = ProfileDocument::parse(text, formats).map(|before| before.emit());
        let carried = before.as_ref().ok().and_then(|before| carry_changes(text, before, &own));
        let says_the_same = |text: &str| ProfileDocument::parse(text, formats).is_ok_and(|read| read.emit() == own);
        match carried {
            Some(carried) if says_the_same(&carried.text) => carried,
            _ => {
                let lost = lost_comments(text, &own, before.as_deref().unwrap_or_default());
                let text = if text.contains("\r\n") { own.replace('\n', "\r\n") } else { own };
                UpdatedText { text, lost }
            }
        }
    }

    /// Returns the changes, entry by entry, that turn this document into `other`.
    pub fn changes_to(&self, other: &ProfileDocument) -> Vec<Change> {
        find_changes(&self.emit(), &other.emit()).unwrap_or_default()
    }

    /// Returns the document with the changes applied.
    ///
    /// # Errors
    /// Returns an error if the result is not a valid profile, or `Err(None)` if a change cannot be applied.
    pub fn with_changes(
        &self,
        changes: &[Change],
        formats: ProfileFormats,
    ) -> Result<ProfileDocument, Option<ProfileError>> {
        ProfileDocument::parse(&apply_all(&self.emit(), changes).ok_or(None)?, formats).map_err(Some)
    }
}

/// The side that changed an entry of the common base profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangedSide {
    /// Only the other side changed the entry.
    There,
    /// Only this side changed the entry.
    Here,
    /// Both sides changed the entry.
    Both,
}

/// Returns the changes that turn `theirs` into `mine`, and which side made each of them since `base`.
pub fn diverging_changes(
    base: &ProfileDocument,
    theirs: &ProfileDocument,
    mine: &ProfileDocument,
) -> Vec<(Change, ChangedSide)> {
    let (there, here) = (base.changes_to(theirs), base.changes_to(mine));
    let touches = |own: &[Change], change: &Change| {
        let shares = |other: &Change| other.path.iter().zip(&change.path).all(|(one, other)| one == other);
        own.iter().any(shares)
    };
    let changed = |change: &Change| match (touches(&there, change), touches(&here, change)) {
        (true, false) => ChangedSide::There,
        (false, true) => ChangedSide::Here,
        _ => ChangedSide::Both,
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
