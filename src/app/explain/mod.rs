//! Error messages for the user: what happened, and what to do. Errors specific to one kind of device are in a separate
//! module.

mod detail;
mod expected;
mod server;
pub mod signal;

use std::path::Path;

pub(crate) use detail::syntax_error_text;
#[cfg(test)]
pub(crate) use detail::tests::check as assert_in_both_languages;
pub use detail::{logbook_problem, profile_error_text, setting_error_text, trace_error_text, url_error_text};
pub use expected::expected_text;
pub use server::{device_in_use_text, server_address_error_text, server_error_text};

use super::action::OpenFailure;
use super::{KindRegistry, Text};
use crate::analysis::check::CycleCount;
use crate::link::{LinkError, LinkErrorKind};
use crate::profile::{ProfileDocument, ProfileError, Redo, SCHEMA};
use crate::store::{AssetNameError, FileError, FileErrorKind, LogbookError, StoreError, UndoObstacle};
use crate::units::Parity;
use crate::worker::{NotStarted, OpenError};

/// Maximum number of listed remarks of the same kind.
const MAX_LISTED_REMARKS: usize = 3;

/// Lists the first few items and states how many more there are.
pub(crate) fn truncated_list<T>(things: &[T], words: impl Fn(&T) -> Text) -> Vec<Text> {
    let more = things.len().saturating_sub(MAX_LISTED_REMARKS);
    let rest = (more > 0).then(|| Text::new("session.and_more").with("count", more));
    things.iter().take(MAX_LISTED_REMARKS).map(words).chain(rest).collect()
}

/// Returns what to do instead for an item that cannot be undone.
pub fn redo_text(redo: &Redo) -> Text {
    match redo {
        Redo::Write(value) => Text::new("undo.write").with("value", value),
        Redo::WriteUnknown => Text::new("undo.write_unknown"),
        Redo::Delete => Text::new("undo.delete"),
        Redo::SetPosition => Text::new("undo.set_position"),
        Redo::ChangeCode => Text::new("undo.change_code"),
        Redo::ChangeNetwork => Text::new("undo.change_network"),
        Redo::Repeat => Text::new("undo.repeat"),
        Redo::KeepCounter => Text::new("undo.keep_counter"),
    }
}

/// Describes why a logbook entry cannot be undone.
pub fn undo_obstacle_text(why: UndoObstacle) -> Text {
    Text::new(match why {
        UndoObstacle::NoItems => "undo.no_items",
        UndoObstacle::Preset => "undo.preset",
        UndoObstacle::Procedure => "undo.procedure",
        UndoObstacle::NothingWritten => "undo.nothing_written",
        UndoObstacle::NoBackup => "undo.no_backup",
    })
}

pub fn link_error_text(error: &LinkError) -> Text {
    let target = &error.target;
    match &error.kind {
        LinkErrorKind::NotFound if target.contains(':') && !cfg!(windows) => {
            Text::new("link.host_not_found").with("target", target)
        }
        LinkErrorKind::NotFound => Text::new("link.not_found").with("target", target),
        LinkErrorKind::Permission { group: Some(group) } => {
            Text::new("link.permission_group").with("target", target).with("group", group)
        }
        LinkErrorKind::Permission { group: None } => Text::new("link.permission").with("target", target),
        LinkErrorKind::Busy => Text::new("link.busy").with("target", target),
        LinkErrorKind::NotAPort => Text::new("link.not_a_port").with("target", target),
        LinkErrorKind::Unreachable(why) => Text::new("link.unreachable").with("target", target).with("why", why),
        LinkErrorKind::Lost => Text::new("link.lost").with("target", target),
        LinkErrorKind::Format(format) => Text::new("link.format").with("target", target).with("format", format),
        LinkErrorKind::NotRecorded(request) => {
            Text::new("link.not_recorded").with("target", target).with("request", request)
        }
        LinkErrorKind::Other(why) => Text::new("link.other").with("target", target).with("why", why),
    }
}

pub fn open_error_text(error: &OpenError) -> Text {
    match error {
        OpenError::Url(why) => Text::new("link.url").with_text("why", url_error_text(why)),
        OpenError::Sim(why) => Text::new("link.url").with_text("why", setting_error_text(why)),
        OpenError::Link(error) => link_error_text(error),
        OpenError::File(error) => file_error_text(error),
        OpenError::Recording { path, cause } => {
            Text::new("link.recording").with("path", path).with_text("why", trace_error_text(cause))
        }
        OpenError::Store(error) => store_error_text(error),
    }
}

/// Returns the reason why a link could not be opened or its thread could not be started. `open` explains the
/// device-specific errors.
pub fn open_failure_text(failed: &OpenFailure, open: impl Fn(&OpenError) -> Text) -> Text {
    match failed {
        OpenFailure::Link(error) => open(error),
        OpenFailure::Thread(why) => Text::new("session.no_thread").with("why", why),
        OpenFailure::Held => Text::new("session.held"),
    }
}

pub fn file_error_text(error: &FileError) -> Text {
    let path = error.path.display();
    match &error.problem {
        FileErrorKind::NotFound => Text::new("file.not_found").with("path", path),
        FileErrorKind::NoFolder => Text::new("file.no_folder").with("path", path),
        FileErrorKind::NotFolder => Text::new("file.not_a_folder").with("path", path),
        FileErrorKind::IsFolder => Text::new("file.is_folder").with("path", path),
        FileErrorKind::NotAFile => Text::new("file.no_file").with("path", path),
        FileErrorKind::Exists => Text::new("file.exists").with("path", path),
        FileErrorKind::PermissionDenied => Text::new("file.permission").with("path", path),
        FileErrorKind::WriteProtected => Text::new("file.write_protected").with("path", path),
        FileErrorKind::DiskFull => Text::new("file.disk_full").with("path", path),
        FileErrorKind::InUse => Text::new("file.in_use").with("path", path),
        FileErrorKind::TooLarge { limit } => Text::new("file.too_large").with("path", path).with("limit", limit),
        FileErrorKind::NotUtf8 { offset } => Text::new("file.not_utf8").with("path", path).with("offset", offset),
        FileErrorKind::Other { what, .. } => Text::new("file.other").with("path", path).with("why", what),
    }
}

/// Returns the message for an error in the program's folders. Errors in device-specific files are explained where those
/// files are read.
pub fn store_error_text(error: &StoreError) -> Text {
    match error {
        StoreError::NoHome => Text::new("store.no_home"),
        StoreError::File(error) => file_error_text(error),
        // This is for a kind of device that does not have a more specific message.
        StoreError::Refused(cause) => Text::new("store.refused").with_text("why", literal_text(cause)),
    }
}

/// Returns the reason why a profile cannot be read. `kinds` explain the values that they reject.
pub fn profile_file_error_text(path: &Path, error: &ProfileError, kinds: KindRegistry) -> Text {
    let path = path.display();
    match error {
        ProfileError::Schema { found, known } => {
            Text::new("profile.schema").with("path", path).with("found", found).with("known", known)
        }
        ProfileError::Device { found, known } => {
            Text::new("profile.device").with("path", path).with("found", found).with("known", known.join(", "))
        }
        ProfileError::OtherKind { found, wanted } => {
            Text::new("profile.other_kind").with("path", path).with("found", found).with("wanted", wanted)
        }
        error => Text::new("profile.invalid").with("path", path).with_text("why", profile_error_text(error, kinds)),
    }
}

/// Returns remarks about a profile that has a newer schema, or entries unknown to its schema.
pub fn profile_remarks(path: &Path, document: &ProfileDocument) -> Vec<Text> {
    if document.is_newer() {
        return vec![newer_profile(path, document)];
    }
    let beyond =
        || Text::new("profile.beyond").with("path", path.display()).with("entries", document.beyond.join(", "));
    if document.beyond.is_empty() { Vec::new() } else { vec![beyond()] }
}

/// Returns the message that a profile has a newer schema and possibly unknown entries.
pub fn newer_profile(path: &Path, document: &ProfileDocument) -> Text {
    let id = if document.beyond.is_empty() { "profile.newer" } else { "profile.newer_entries" };
    Text::new(id)
        .with("path", path.display())
        .with("found", document.schema)
        .with("known", SCHEMA)
        .with("entries", document.beyond.join(", "))
}

pub fn not_started_text(why: &NotStarted) -> Text {
    match why {
        NotStarted::OtherPlan => Text::new("write.other_plan"),
        NotStarted::BackupFailed(error) => Text::new("write.not_kept").with_text("why", file_error_text(error)),
        NotStarted::WearUnknown { cost } => Text::new("write.uncounted").with("cost", cost),
        NotStarted::WearIncomplete { seen, cost, limit } => {
            Text::new("write.incomplete").with("seen", seen).with("cost", cost).with("limit", limit)
        }
        NotStarted::Worn { seen, cost, limit } => {
            Text::new("write.worn").with("used", seen).with("cost", cost).with("limit", limit)
        }
    }
}

pub fn logbook_error_text(why: &LogbookError) -> Text {
    Text::new("write.logbook").with_text("why", logbook_problem(why))
}

/// Formats a number of write cycles, as “at least …” if some may be missing from the logbook.
pub fn cycle_count_text(count: CycleCount) -> Text {
    match count.is_complete {
        true => literal_text(count.seen),
        false => Text::new("wear.at_least").with("count", count.seen),
    }
}

/// Describes why the logbook cannot be read.
pub fn logbook_unreadable_text(why: &LogbookError) -> Text {
    Text::new("backups.no_logbook").with_text("why", logbook_problem(why))
}

/// Describes why an asset name is rejected.
pub fn asset_name_error_text(why: AssetNameError) -> Text {
    match why {
        AssetNameError::Empty => Text::new("asset_card.empty"),
        AssetNameError::TooLong { found, most } => {
            Text::new("asset_card.too_long").with("found", found).with("most", most)
        }
        AssetNameError::ControlCharacter => Text::new("asset_card.control"),
    }
}

pub fn parity_text(parity: Parity) -> Text {
    Text::new(match parity {
        Parity::None => "parity.none",
        Parity::Even => "parity.even",
        Parity::Odd => "parity.odd",
    })
}

/// Returns a text that is the same in every language, such as a name or a number.
pub fn literal_text(words: impl ToString) -> Text {
    Text::new("plain.words").with("words", words)
}
