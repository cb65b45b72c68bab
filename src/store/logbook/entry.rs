//! Logbook entries.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use jiff::Timestamp;

use super::user_name;
use crate::profile::ChangedItem;

/// The device to which an entry belongs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeviceKey {
    /// Kind of device, such as `hiperface`.
    pub kind: String,
    /// Type of the device as written in its manual, such as `37h`. Serial numbers are unique only within a type.
    pub device_type: String,
    pub serial_number: String,
    /// Whether the device is simulated. Simulated and real devices are counted separately.
    pub is_virtual: bool,
}

impl DeviceKey {
    pub fn new(kind: &str, device_type: &str, serial_number: &str, is_virtual: bool) -> Self {
        let [kind, device_type, serial_number] = [kind, device_type, serial_number].map(str::to_owned);
        DeviceKey { kind, device_type, serial_number, is_virtual }
    }
}

/// Number of an entry in this computer's logbook.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EntryId(pub(super) i64);

impl EntryId {
    /// Parses the number as printed by the `log` command. Returns `None` if the text is not a number of at least 1.
    pub fn parse(text: &str) -> Option<Self> {
        text.parse().ok().filter(|number| *number > 0).map(EntryId)
    }
}

impl fmt::Display for EntryId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Identifier of an entry that is the same on every computer sharing the logbook.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct EntryUid(pub(super) String);

/// A reference to another entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LinkedEntry {
    pub id: EntryId,
    pub at: Timestamp,
}

/// Type of event that an entry records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EntryKind {
    /// A device was identified. Recorded once for each connection.
    Connected,
    /// The device was assigned to an asset, such as a motor or an axis.
    Assigned,
    /// Status codes were read. Reading may have cleared them in the device.
    Status,
    /// Single values were written.
    Write,
    /// A profile or a backup was restored.
    Restore,
    /// The position was set, or a preset was stored or fired.
    Preset,
    /// A device procedure or service was executed, such as a calibration.
    Procedure,
    /// A profile of the device was saved. A backup taken before a write is part of the entry for that write instead.
    Backup,
    /// The device was checked.
    Check,
    /// The user has written a note.
    Note,
}

impl EntryKind {
    pub const ALL: [EntryKind; 10] = [
        EntryKind::Connected,
        EntryKind::Assigned,
        EntryKind::Status,
        EntryKind::Write,
        EntryKind::Restore,
        EntryKind::Preset,
        EntryKind::Procedure,
        EntryKind::Backup,
        EntryKind::Check,
        EntryKind::Note,
    ];

    /// Returns the keyword for this value in the database and on the command line.
    pub const fn keyword(self) -> &'static str {
        match self {
            EntryKind::Connected => "connected",
            EntryKind::Assigned => "assigned",
            EntryKind::Status => "status",
            EntryKind::Write => "write",
            EntryKind::Restore => "restore",
            EntryKind::Preset => "preset",
            EntryKind::Procedure => "procedure",
            EntryKind::Backup => "backup",
            EntryKind::Check => "check",
            EntryKind::Note => "note",
        }
    }

    /// Returns whether entries of this kind have a result.
    pub const fn has_result(self) -> bool {
        match self {
            EntryKind::Write | EntryKind::Restore | EntryKind::Preset | EntryKind::Procedure => true,
            EntryKind::Connected
            | EntryKind::Assigned
            | EntryKind::Status
            | EntryKind::Backup
            | EntryKind::Check
            | EntryKind::Note => false,
        }
    }

    /// Returns the reason why entries of this kind cannot be undone, or `None` if they can be undone.
    pub const fn undo_obstacle(self) -> Option<UndoObstacle> {
        match self {
            EntryKind::Write | EntryKind::Restore => None,
            EntryKind::Preset => Some(UndoObstacle::Preset),
            EntryKind::Procedure => Some(UndoObstacle::Procedure),
            EntryKind::Connected
            | EntryKind::Assigned
            | EntryKind::Status
            | EntryKind::Backup
            | EntryKind::Check
            | EntryKind::Note => Some(UndoObstacle::NothingWritten),
        }
    }

    pub(super) fn parse(word: &str) -> Option<Self> {
        EntryKind::ALL.into_iter().find(|kind| kind.keyword() == word)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    Done,
    Failed(String),
    Cancelled,
}

impl Outcome {
    /// Returns the keyword for this value in the database and on the command line.
    pub const fn keyword(&self) -> &'static str {
        match self {
            Outcome::Done => "done",
            Outcome::Failed(_) => "failed",
            Outcome::Cancelled => "cancelled",
        }
    }
}

/// The computer, user and program version that made an entry.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Name of the computer. Empty in entries of older logbooks.
    pub bench: String,
    /// Name of the user, if known and if the settings allow it to be recorded.
    pub user: Option<String>,
    /// Version of the program. Empty in entries of older logbooks.
    pub version: String,
}

impl Origin {
    /// Returns the origin of entries made by this process.
    pub fn of_this_process() -> Self {
        Origin {
            bench: this_computer_name().to_owned(),
            user: user_name::of_this_process(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// Returns the computer that made the entry, or `None` if it was this computer or is unknown.
    pub fn other_bench(&self) -> Option<&str> {
        Some(self.bench.as_str()).filter(|bench| !bench.is_empty() && *bench != this_computer_name())
    }
}

/// Returns the name of this computer.
fn this_computer_name() -> &'static str {
    static NAME: OnceLock<String> = OnceLock::new();
    NAME.get_or_init(|| whoami::hostname().unwrap_or_default())
}

/// An upcoming write to a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Intent {
    pub kind: EntryKind,
    pub items: Vec<ChangedItem>,
    pub planned_cycles: u64,
    /// Path of the backup taken before the write.
    pub backup: Option<PathBuf>,
    /// The entry that the write undoes.
    pub undoes: Option<EntryUid>,
}

/// An event that writes nothing to the device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    pub kind: EntryKind,
    pub description: String,
    /// Changed items with their old and new values, for events whose description does not contain them.
    pub items: Vec<ChangedItem>,
    /// Path of the profile that was saved.
    pub backup: Option<PathBuf>,
}

impl Event {
    /// Creates an event with a description, but without items or a profile.
    pub fn new(kind: EntryKind, description: impl Into<String>) -> Self {
        Event { kind, description: description.into(), items: Vec::new(), backup: None }
    }

    /// Creates the event for a profile saved to a file.
    pub fn saved_profile(path: &Path) -> Self {
        let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let saved = Event::new(EntryKind::Backup, format!("saved to {}", full.display()));
        Event { backup: Some(full), ..saved }
    }
}

/// A logbook entry. The entry for a write also contains the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Number of the entry. An entry received from another computer may be older than entries with a lower number.
    pub id: EntryId,
    pub uid: EntryUid,
    pub kind: EntryKind,
    /// Time of the event. For a write, this is the time directly before its first byte.
    pub at: Timestamp,
    pub device: DeviceKey,
    /// Asset to which the device was assigned at the time of the event.
    pub asset: Option<String>,
    /// Description of the event. For a write, it contains the changed items.
    pub description: String,
    /// Changed items. The list is empty in entries of older logbooks.
    pub items: Vec<ChangedItem>,
    pub planned_cycles: u64,
    /// Path of the backup taken before the write. Invalid Unicode in the path is replaced.
    pub backup: Option<PathBuf>,
    pub origin: Origin,
    /// The entry that this write undoes, if any.
    pub undoes: Option<LinkedEntry>,
    /// The last write that undid this entry completely, unless it was itself undone.
    pub undone_by: Option<LinkedEntry>,
    /// Result of the write, or `None` if the write is still running or the program ended during the write.
    pub conclusion: Option<WriteResult>,
}

/// The reason why an entry cannot be undone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UndoObstacle {
    /// The entry was made by an older version of the program and does not contain the changed values.
    NoItems,
    /// The position was set, or a preset was stored or fired.
    Preset,
    /// A procedure was executed.
    Procedure,
    /// Nothing was written to the device.
    NothingWritten,
    /// The entry has no backup.
    NoBackup,
}

impl Entry {
    /// Returns the path of the backup from which the write can be undone.
    ///
    /// # Errors
    /// Returns the reason why the entry cannot be undone.
    pub fn undo_backup(&self) -> Result<&Path, UndoObstacle> {
        match self.kind.undo_obstacle() {
            Some(why) => Err(why),
            None if self.items.is_empty() => Err(UndoObstacle::NoItems),
            None => self.backup.as_deref().ok_or(UndoObstacle::NoBackup),
        }
    }

    /// Returns the number of write cycles used by this entry. For a write without a result, this is the planned number,
    /// because the program may have ended after the last byte was sent.
    pub fn write_cycles(&self) -> u64 {
        self.conclusion.as_ref().map_or(self.planned_cycles, |end| end.cycles_spent)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteResult {
    pub at: Timestamp,
    pub outcome: Outcome,
    /// Number of write cycles used, including those of a write that was only partly completed.
    pub cycles_spent: u64,
}

/// Filter that selects logbook entries.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EntryFilter {
    pub device: Option<DeviceKey>,
    pub what: Option<EntryKind>,
    /// Kind of device.
    pub kind: Option<String>,
    pub serial_number: Option<String>,
    /// Asset to which the device was assigned when the entry was made.
    pub asset: Option<String>,
    /// Time of the oldest entry.
    pub since: Option<Timestamp>,
    /// Text contained in the description, the device, its asset at the time, the user or the computer. ASCII case is
    /// ignored.
    pub search: String,
}
