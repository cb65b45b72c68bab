//! Stored data about drives: spindle pitch, position unit, limits not confirmed since the scaling changed, and values
//! that the drives have not saved.
//!
//! A drive may also be open in another session or window. Changes made in one of them do not affect the others.
//! However, limits marked as unconfirmed in one of them lock all of them, and must be confirmed in each.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

/// The unit in which positions are shown and entered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum PositionUnit {
    /// Steps as transmitted by the drive.
    #[default]
    Steps,
    Turns,
    /// Angle in degrees. It may exceed one turn.
    Degrees,
    /// Millimetres of travel on a spindle whose pitch has been entered.
    Millimetres,
}

impl PositionUnit {
    pub const ALL: [PositionUnit; 4] =
        [PositionUnit::Steps, PositionUnit::Turns, PositionUnit::Degrees, PositionUnit::Millimetres];

    pub const fn unit(self) -> &'static str {
        match self {
            PositionUnit::Steps => "unit.steps",
            PositionUnit::Turns => "unit.turns",
            PositionUnit::Degrees => "unit.degrees",
            PositionUnit::Millimetres => "unit.millimetres",
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct RememberedDrives {
    /// Spindle pitches in nanometres per turn, by drive number.
    pub pitches: BTreeMap<u8, u64>,
    pub measure: PositionUnit,
    unconfirmed: Vec<u8>,
    /// Number of times that the limits of each drive have been marked as unconfirmed, by drive number. It distinguishes
    /// a new mark from an earlier one.
    marks: BTreeMap<u8, u64>,
    /// Written values that the drive has not saved, by parameter number.
    pub unsaved: BTreeMap<u16, i64>,
}

/// The readable part of a stored drive entry that is otherwise invalid.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct PartialDriveEntry {
    unconfirmed: Vec<u8>,
    marks: BTreeMap<u8, u64>,
}

/// Whether the settings have been read since this window took control of the drives. Another window may have marked
/// limits there as unconfirmed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SettingsReadState {
    Unread,
    Reading,
    Read,
}

/// A device whose drives have data stored in the settings.
pub trait StoredDriveData {
    /// Returns the name of the device's entry in the settings, or `None` until the device has been read.
    fn storage_name(&self) -> Option<String>;

    /// Adopts the stored data about the drives. Returns data that must be stored because they differ.
    ///
    /// All data are adopted once per device. Afterwards, only limits that were marked elsewhere are adopted.
    fn sync_remembered_drives(&mut self, kept: &RememberedDrives) -> Option<RememberedDrives>;

    /// Locks the drives whose limits another session or window has marked as unconfirmed, even before the mark is in
    /// the settings.
    fn lock_marked_drives(&mut self, found: &RememberedDrives);

    /// Returns whether the settings have been read since this window took control.
    fn read_state(&self) -> SettingsReadState;

    /// Records whether the settings have been read since this window took control. Until then, no drive moves.
    fn set_read_state(&mut self, marks: SettingsReadState);
}

impl From<PartialDriveEntry> for RememberedDrives {
    fn from(PartialDriveEntry { unconfirmed, marks }: PartialDriveEntry) -> Self {
        RememberedDrives { unconfirmed, marks, ..RememberedDrives::default() }
    }
}

impl RememberedDrives {
    /// Creates drive data without unconfirmed limits.
    pub fn without_limits(pitches: BTreeMap<u8, u64>, measure: PositionUnit, unsaved: BTreeMap<u16, i64>) -> Self {
        RememberedDrives { pitches, measure, unsaved, ..RememberedDrives::default() }
    }

    pub(crate) fn mark_count(&self, drive: u8) -> u64 {
        self.marks.get(&drive).copied().unwrap_or_default()
    }

    pub(crate) fn is_unconfirmed(&self, drive: u8) -> bool {
        self.unconfirmed.contains(&drive)
    }

    pub(crate) fn set_unconfirmed(&mut self, drive: u8, unconfirmed: bool) {
        self.unconfirmed.retain(|own| *own != drive);
        if unconfirmed {
            self.unconfirmed.push(drive);
            self.unconfirmed.sort_unstable();
        }
    }

    pub(crate) fn add_marks(&mut self, drive: u8, times: u64) {
        self.set_unconfirmed(drive, true);
        self.marks.insert(drive, self.mark_count(drive).wrapping_add(times));
    }

    /// Returns the drives whose limits were marked as unconfirmed since `before`.
    ///
    /// A mark with the same number may already be confirmed here but not yet on disk. Settings written by a program
    /// version that does not count marks contain no numbers.
    pub(crate) fn newly_marked_drives(&self, before: &RememberedDrives) -> Vec<u8> {
        let is_new = |drive: &u8| {
            let number = self.mark_count(*drive);
            number != before.mark_count(*drive) || number == 0 && !before.is_unconfirmed(*drive)
        };
        self.unconfirmed.iter().copied().filter(is_new).collect()
    }

    /// Applies the changes between `known` and `ours` to the data. Limits marked as unconfirmed in the meantime stay
    /// so, even if `ours` has confirmed them.
    #[must_use]
    pub(crate) fn with_changes(mut self, known: &RememberedDrives, ours: &RememberedDrives) -> Self {
        let drives = |maps: [&BTreeMap<u8, u64>; 2]| -> BTreeSet<u8> {
            maps.into_iter().flat_map(BTreeMap::keys).copied().collect()
        };
        apply_changes(&mut self.pitches, &known.pitches, &ours.pitches);
        apply_changes(&mut self.unsaved, &known.unsaved, &ours.unsaved);
        if ours.measure != known.measure {
            self.measure = ours.measure;
        }
        let locked = known.unconfirmed.iter().chain(&ours.unconfirmed).copied();
        for drive in drives([&known.marks, &ours.marks]).into_iter().chain(locked).collect::<BTreeSet<_>>() {
            let marked_here = ours.mark_count(drive).wrapping_sub(known.mark_count(drive));
            let is_marked = ours.is_unconfirmed(drive) && (marked_here > 0 || !known.is_unconfirmed(drive));
            let is_confirmed = known.is_unconfirmed(drive) && !ours.is_unconfirmed(drive);
            let is_same = self.mark_count(drive) == known.mark_count(drive);
            if is_marked {
                self.add_marks(drive, marked_here);
            } else if is_confirmed && is_same {
                self.set_unconfirmed(drive, false);
            }
        }
        self
    }
}

/// Applies the changes between `known` and `ours` to a map, key by key.
fn apply_changes<K: Copy + Ord, V: Copy + Eq>(own: &mut BTreeMap<K, V>, known: &BTreeMap<K, V>, ours: &BTreeMap<K, V>) {
    for key in known.keys().chain(ours.keys()) {
        match (known.get(key), ours.get(key)) {
            (before, now) if before == now => {}
            (_, Some(value)) => drop(own.insert(*key, *value)),
            (_, None) => drop(own.remove(key)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A new mark locks limits that were confirmed here. The mark that was confirmed does not lock them again.
    #[test]
    fn detects_new_limit_marks() {
        let of = |text: &str| ron::from_str::<RememberedDrives>(&format!("({text})")).unwrap();
        let cases: [(&str, &str, &[u8]); 7] = [
            ("unconfirmed: [1], marks: {1: 1}", "", &[1]),
            ("unconfirmed: [1], marks: {1: 1}", "unconfirmed: [1], marks: {1: 1}", &[]),
            ("unconfirmed: [1], marks: {1: 1}", "marks: {1: 1}", &[]),
            ("unconfirmed: [1], marks: {1: 2}", "marks: {1: 1}", &[1]),
            // Written by a program version that does not count marks.
            ("unconfirmed: [1]", "", &[1]),
            ("unconfirmed: [1]", "marks: {1: 1}", &[1]),
            ("marks: {1: 2}", "marks: {1: 1}", &[]),
        ];
        for (found, before, marked) in cases {
            assert_eq!(of(found).newly_marked_drives(&of(before)), marked, "{found}, {before}");
        }
    }
}
