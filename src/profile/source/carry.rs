//! Transfers the changes between two generated texts to a text edited by the user.

use super::apply::{apply_change, value_at};
use super::changes::{Change, find_changes};
use super::tree::comments_in;

/// A text with updated content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UpdatedText {
    /// Updated text.
    pub text: String,
    /// User comments that are missing from the new text.
    pub lost: Vec<String>,
}

/// Applies the changes between `before` and `after` to the user's text. `before` is the generated text with the same
/// content as the user's text.
///
/// Returns `None` if a change does not fit. The caller must check that the result has the same meaning as `after`.
pub(in crate::profile) fn carry_changes(text: &str, before: &str, after: &str) -> Option<UpdatedText> {
    let mut carried = text.to_owned();
    for change in find_changes(before, after)? {
        carried = apply_change(&carried, &change).or_else(|| replace_enclosing_value(&carried, &change, after))?;
    }
    let lost = lost_comments(text, &carried, before);
    Some(UpdatedText { text: carried, lost })
}

/// Replaces the innermost enclosing value that can be replaced.
fn replace_enclosing_value(text: &str, change: &Change, after: &str) -> Option<String> {
    (1..change.path.len()).rev().find_map(|length| {
        let path = change.path.get(..length)?.to_vec();
        let (to, behind) = value_at(after, &path)?;
        let (comments, heading) = ((None, None), Vec::new());
        apply_change(text, &Change { path, from: None, to: Some(to), behind, comments, heading })
    })
}

/// Returns the user's comments that are missing from the new text.
pub(in crate::profile) fn lost_comments(text: &str, now: &str, generated: &str) -> Vec<String> {
    let (mut there, own) = (comments_in(now), comments_in(generated));
    let mut lost = Vec::new();
    for comment in comments_in(text) {
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
