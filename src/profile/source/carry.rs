//! Transfer of changes between two generated texts to the user's text.

use super::apply::{apply, value_at};
use super::changes::{Change, changes};
use super::tree::comments;

/// A text with updated content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Carried {
    /// Updated text.
    pub text: String,
    /// User comments that the new text does not contain.
    pub lost: Vec<String>,
}

/// Applies the changes from `before` to `after` to the user's text. `before` is the generated text with the same
/// content as the user's text.
///
/// Returns `None` if a change does not fit. The caller must check that the result means the same as `after`.
pub(in crate::profile) fn carry(text: &str, before: &str, after: &str) -> Option<Carried> {
    let mut carried = text.to_owned();
    for change in changes(before, after)? {
        carried = apply(&carried, &change).or_else(|| replace_enclosing_value(&carried, &change, after))?;
    }
    let lost = lost(text, &carried, before);
    Some(Carried { text: carried, lost })
}

/// Replaces the nearest enclosing value that can be replaced.
fn replace_enclosing_value(text: &str, change: &Change, after: &str) -> Option<String> {
    (1..change.path.len()).rev().find_map(|length| {
        let path = change.path.get(..length)?.to_vec();
        let (to, behind) = value_at(after, &path)?;
        let (comments, heading) = ((None, None), Vec::new());
        apply(text, &Change { path, from: None, to: Some(to), behind, comments, heading })
    })
}

/// Returns the user's comments that are missing from the new text.
pub(in crate::profile) fn lost(text: &str, now: &str, generated: &str) -> Vec<String> {
    let (mut there, own) = (comments(now), comments(generated));
    let mut lost = Vec::new();
    for comment in comments(text) {
        match there.iter().position(|other| *other == comment) {
            Some(at) => {
                there.swap_remove(at);
            }
            None if own.contains(&comment) || comment.is_empty() => {}
            None => lost.push(comment.to_owned()),
        }
    }
    lost
}
