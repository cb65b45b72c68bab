//! Texts of a review that explain which values a write skips, which values must be set up again, and how the write can
//! be undone.

use crate::app::Text;
use crate::app::explain::{literal_text, redo_text, truncated_list};
use crate::worker::commit::Undo;

/// Describes how a write can be undone later. Operations are named only if they cannot be undone exactly.
pub(crate) fn undo_texts(operations: impl IntoIterator<Item = (Text, Option<Undo>)>) -> Vec<Text> {
    let mut has_exact = false;
    let mut groups: Vec<(Undo, Vec<Text>)> = Vec::new();
    for (item, undo) in operations {
        match undo {
            None => {}
            Some(Undo::Exactly) => has_exact = true,
            Some(undo) => match groups.iter_mut().find(|(own, _)| *own == undo) {
                Some((_, items)) => items.push(item),
                None => groups.push((undo, vec![item])),
            },
        }
    }
    if groups.is_empty() {
        return has_exact.then(|| undo_text(&Undo::Exactly)).into_iter().collect();
    }
    let named = |(undo, items): &(Undo, Vec<Text>)| undo_text(undo).with_list("items", truncate_items(items));
    let mut texts = truncated_list(&groups, named);
    texts.extend(has_exact.then(|| Text::new("review.undo_rest")));
    texts
}

/// Maximum number of items listed in a sentence.
const MAX_ITEMS_IN_SENTENCE: usize = 3;

fn truncate_items(items: &[Text]) -> Vec<Text> {
    let more = (items.len() > MAX_ITEMS_IN_SENTENCE).then(|| literal_text("…"));
    items.iter().take(MAX_ITEMS_IN_SENTENCE).cloned().chain(more).collect()
}

fn undo_text(undo: &Undo) -> Text {
    match undo {
        Undo::Exactly => Text::new("review.undo_exactly"),
        Undo::RestoreBackup => Text::new("review.undo_backup"),
        Undo::AnotherWrite { value, cycles } => {
            Text::new("review.undo_write").with("value", value).with("cycles", cycles)
        }
        Undo::Never(redo) => Text::new("review.undo_never").with_text("instead", redo_text(redo)),
    }
}

/// Describes the values that a restore does not change: those missing from the profile or the device, and those that
/// depend on how the device is mounted.
pub(crate) fn skipped_item_messages(words: impl Into<Text>, missing: Vec<Text>, mounting: Vec<Text>) -> Vec<Text> {
    let mut texts = Vec::new();
    if !missing.is_empty() {
        texts.push(words.into().with_list("items", missing));
    }
    if !mounting.is_empty() {
        texts.push(Text::new("review.mounting_left").with_list("items", mounting));
    }
    texts
}

/// Describes the values that must be set up again.
pub fn redo(items: Vec<Text>) -> Option<Text> {
    (!items.is_empty()).then(|| Text::new("review.redo").with_list("items", items))
}
