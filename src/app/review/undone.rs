//! Undo of a write recorded in the logbook: checks whether values have changed since the write, and describes the items
//! that are not undone.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use crate::app::Text;
use crate::app::explain::{literal_text, redo_text, truncated_list};
use crate::app::kinds::KindRegistry;
use crate::profile::{Body, IrreversibleItem, LaterChange, UndoableWrite};
use crate::store::{Entry, EntryUid};
use crate::worker::commit::PlannedWrite;

/// A logbook entry that is being undone by restoring its backup.
#[derive(Clone, Debug)]
pub struct UndoneEntry {
    uid: EntryUid,
    /// Local time of the entry.
    at: String,
    /// Local time of an earlier undo of the entry, if any.
    undone_at: Option<String>,
    write: UndoableWrite,
    device_kind: String,
    kinds: KindRegistry,
    /// Names in the manual of those items that are addresses.
    manual_names: Vec<(String, String)>,
}

impl UndoneEntry {
    /// Removes from the backup the values that the write did not change.
    ///
    /// # Errors
    /// Returns one message per item if no item can be undone.
    pub(in crate::app) fn new(entry: &Entry, backup: &mut Body, kinds: KindRegistry) -> Result<Self, Vec<Text>> {
        let write = UndoableWrite::new(&entry.items, backup);
        let undone_at = entry.undone_by.map(|own| minutes(own.at));
        let manual_names = entry.items.iter().filter_map(|own| Some((own.item.clone(), own.name.clone()?))).collect();
        let (uid, at, device_kind) = (entry.uid.clone(), minutes(entry.at), entry.device.kind.clone());
        let undone = UndoneEntry { uid, at, undone_at, write, device_kind, kinds, manual_names };
        if undone.write.has_effect() { Ok(undone) } else { Err(undone.irreversible_item_messages()) }
    }

    pub(super) fn title(&self) -> Text {
        Text::new("undo.title").with("time", &self.at)
    }

    pub(super) fn concerns(&self, item: &str) -> bool {
        self.write.concerns(item)
    }

    pub(super) fn uid(&self) -> &EntryUid {
        &self.uid
    }

    /// Returns a warning if the entry has been undone before, and a description of each item that is not undone.
    pub(super) fn warnings(&self) -> impl Iterator<Item = Text> {
        self.repeated_undo_message().into_iter().chain(self.irreversible_item_messages())
    }

    fn repeated_undo_message(&self) -> Option<Text> {
        self.undone_at.as_ref().map(|at| Text::new("undo.already").with("time", at))
    }

    /// Describes each item that is not undone, and what to do instead.
    fn irreversible_item_messages(&self) -> Vec<Text> {
        let kept = |own: &IrreversibleItem| {
            let name = self.item_name(&own.item);
            Text::new("undo.kept").with_text("item", name).with_text("instead", redo_text(&own.redo))
        };
        truncated_list(self.write.kept(), kept)
    }

    /// Returns the reason for rejecting a plan, with the values that have changed since the write. Returns `None` if
    /// none have changed.
    pub(super) fn rejection<P: PlannedWrite>(&self, prepared: &P) -> Option<Vec<Text>> {
        let planned = prepared.plan().ops.iter().flat_map(|op| prepared.changed_items(op));
        let changed = self.write.changed_since(planned);
        let first = self.repeated_undo_message().into_iter().chain([Text::new("undo.changed")]);
        let texts = first.chain(truncated_list(&changed, |own| self.changed_item_message(own)));
        (!changed.is_empty()).then(|| texts.collect())
    }

    fn changed_item_message(&self, changed: &LaterChange) -> Text {
        let value = |value: &Option<String>| match value {
            Some(value) => literal_text(value),
            None => Text::new("undo.no_value"),
        };
        Text::new("undo.changed_value")
            .with_text("item", self.item_name(&changed.item))
            .with_text("expected", value(&changed.expected))
            .with_text("found", value(&changed.found))
    }

    fn item_name(&self, item: &str) -> Text {
        let manual_name = self.manual_names.iter().find(|(own, _)| own == item).map(|(_, name)| name.as_str());
        self.kinds.item_name(&self.device_kind, item, manual_name)
    }
}

fn minutes(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string()
}
