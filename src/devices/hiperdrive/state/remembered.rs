//! What is remembered of a device's drives beside what they keep themselves: the spindles behind them, what their positions
//! are shown in, limits that nobody has looked at since their scaling was changed, and what was not saved.
//!
//! The device may be open in another session or another window too. What is typed in one of them does not change another;
//! limits that are marked as unconfirmed in one of them lock all of them, and are confirmed in each.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::ruler::Measure;
use super::unit::Unit;
use crate::devices::hiperdrive::protocol::{DriveNumber, Length};

/// Of one adapter or hub.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    /// Nanometres a turn, by the numbers of the drives.
    pitches: BTreeMap<u8, u64>,
    /// What positions are shown in.
    measure: Measure,
    /// Drives whose limits nobody has confirmed.
    unconfirmed: Vec<u8>,
    /// How often each drive was marked so: tells a mark from the one before.
    marks: BTreeMap<u8, u64>,
    /// What was saved of what was written since, by the parameters' own numbers.
    unsaved: BTreeMap<u16, i64>,
}

/// What can be read of a drive's entry whose other parts are broken.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct LocksAlone {
    unconfirmed: Vec<u8>,
    marks: BTreeMap<u8, u64>,
}

/// What a device's session and the settings told each other last.
#[derive(Clone, Debug, Default)]
pub(super) struct Exchanged {
    /// What the settings said.
    kept: Remembered,
    pitches: BTreeMap<u8, u64>,
    measure: Measure,
    unsaved: BTreeMap<u16, i64>,
    unconfirmed: BTreeSet<DriveNumber>,
    /// The scales in which limits are unconfirmed, as they were read.
    scales: BTreeMap<DriveNumber, (i64, i64)>,
}

/// Whether the settings were read since control was taken: another window may have marked limits in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Marks {
    /// Not yet, or too long ago.
    Unread,
    /// They are being read.
    Reading,
    /// Yes.
    Read,
}

impl From<LocksAlone> for Remembered {
    fn from(LocksAlone { unconfirmed, marks }: LocksAlone) -> Self {
        Remembered { unconfirmed, marks, ..Remembered::default() }
    }
}

impl Remembered {
    fn marks(&self, drive: u8) -> u64 {
        self.marks.get(&drive).copied().unwrap_or_default()
    }

    fn is_unconfirmed(&self, drive: u8) -> bool {
        self.unconfirmed.contains(&drive)
    }

    fn set_unconfirmed(&mut self, drive: u8, unconfirmed: bool) {
        self.unconfirmed.retain(|own| *own != drive);
        if unconfirmed {
            self.unconfirmed.push(drive);
            self.unconfirmed.sort_unstable();
        }
    }

    fn mark(&mut self, drive: u8, times: u64) {
        self.set_unconfirmed(drive, true);
        self.marks.insert(drive, self.marks(drive).wrapping_add(times));
    }

    /// Drives that were marked since `before`: a mark of the same number is the same, which may be confirmed here and not yet
    /// on disk. A program that does not count leaves out the numbers.
    fn marked_since(&self, before: &Remembered) -> Vec<u8> {
        let is_new = |drive: &u8| {
            let number = self.marks(*drive);
            number != before.marks(*drive) || number == 0 && !before.is_unconfirmed(*drive)
        };
        self.unconfirmed.iter().copied().filter(is_new).collect()
    }

    /// The same with what `ours` has changed since `known`. Limits stay unconfirmed that were marked here meanwhile, whatever
    /// `ours` has confirmed.
    #[must_use]
    pub(crate) fn with_changes(mut self, known: &Remembered, ours: &Remembered) -> Self {
        let drives = |maps: [&BTreeMap<u8, u64>; 2]| -> BTreeSet<u8> {
            maps.into_iter().flat_map(BTreeMap::keys).copied().collect()
        };
        change(&mut self.pitches, &known.pitches, &ours.pitches);
        change(&mut self.unsaved, &known.unsaved, &ours.unsaved);
        if ours.measure != known.measure {
            self.measure = ours.measure;
        }
        let locked = known.unconfirmed.iter().chain(&ours.unconfirmed).copied();
        for drive in drives([&known.marks, &ours.marks]).into_iter().chain(locked).collect::<BTreeSet<_>>() {
            let marked_here = ours.marks(drive).wrapping_sub(known.marks(drive));
            let is_marked = ours.is_unconfirmed(drive) && (marked_here > 0 || !known.is_unconfirmed(drive));
            let is_confirmed = known.is_unconfirmed(drive) && !ours.is_unconfirmed(drive);
            let is_same = self.marks(drive) == known.marks(drive);
            if is_marked {
                self.mark(drive, marked_here);
            } else if is_confirmed && is_same {
                self.set_unconfirmed(drive, false);
            }
        }
        self
    }
}

/// What `ours` has changed since `known`, key by key.
fn change<K: Copy + Ord, V: Copy + Eq>(own: &mut BTreeMap<K, V>, known: &BTreeMap<K, V>, ours: &BTreeMap<K, V>) {
    for key in known.keys().chain(ours.keys()) {
        match (known.get(key), ours.get(key)) {
            (before, now) if before == now => {}
            (_, Some(value)) => drop(own.insert(*key, *value)),
            (_, None) => drop(own.remove(key)),
        }
    }
}

impl Unit {
    /// Under what name it is remembered; `None` before it was read.
    pub(crate) fn remembered_as(&self) -> Option<String> {
        let own = self.identity()?;
        let kind = if self.session.is_virtual() { "virtual " } else { "" };
        Some(format!("{kind}{} {}", own.category, own.serial_number))
    }

    /// Takes what is remembered, and gives what is to be from now on where that is something else. All of it is taken once for
    /// a device; later only limits that were marked elsewhere.
    pub(crate) fn exchange_remembered(&mut self, kept: &Remembered) -> Option<Remembered> {
        let before = match self.exchanged.take() {
            Some(before) => before,
            None => self.take_remembered(kept),
        };
        let mut next = kept.clone();
        let now = self.to_remember();
        let (pitches, measure, unsaved) = (before.pitches, before.measure, before.unsaved);
        let known = Remembered { pitches, measure, unsaved, ..Remembered::default() };
        let (pitches, measure, unsaved) = (now.pitches.clone(), now.measure, now.unsaved.clone());
        let ours = Remembered { pitches, measure, unsaved, ..Remembered::default() };
        next = next.with_changes(&known, &ours);
        let scaled_anew =
            |drive: &DriveNumber| before.scales.get(drive).is_some_and(|scale| now.scales.get(drive) != Some(scale));
        for drive in now.unconfirmed.iter().filter(|own| !before.unconfirmed.contains(own) || scaled_anew(own)) {
            next.mark(drive.get(), 1);
        }
        for drive in before.unconfirmed.difference(&now.unconfirmed).map(|drive| drive.get()) {
            // What was marked again elsewhere is not what a person has looked at here.
            if kept.marks(drive) == before.kept.marks(drive) {
                next.set_unconfirmed(drive, false);
            }
        }
        let elsewhere = kept.marked_since(&before.kept);
        elsewhere.into_iter().filter_map(DriveNumber::new).for_each(|drive| self.moves.unconfirm(drive));
        self.exchanged = Some(Exchanged { kept: next.clone(), ..self.to_remember() });
        (next != *kept).then_some(next)
    }

    /// Locks what was marked elsewhere, before the settings know of it.
    pub(crate) fn lock_by(&mut self, found: &Remembered) {
        let Some(before) = &mut self.exchanged else { return };
        for drive in found.marked_since(&before.kept).into_iter().filter_map(DriveNumber::new) {
            self.moves.unconfirm(drive);
            // It is no mark of this session.
            before.unconfirmed.insert(drive);
        }
    }

    fn take_remembered(&mut self, kept: &Remembered) -> Exchanged {
        for (drive, nanometres) in &kept.pitches {
            if let Some(drive) = DriveNumber::new(*drive) {
                self.pitches.entry(drive).or_insert(Length { nanometres: *nanometres });
            }
        }
        self.measure = kept.measure;
        self.unsaved.extend(&kept.unsaved);
        Exchanged {
            pitches: kept.pitches.clone(),
            measure: kept.measure,
            unsaved: kept.unsaved.clone(),
            ..Exchanged::default()
        }
    }

    fn to_remember(&self) -> Exchanged {
        let unconfirmed = self.moves.unconfirmed();
        let scale = |drive: &DriveNumber| Some((*drive, self.drive_limits(*drive)?.seen()?.scale));
        Exchanged {
            kept: Remembered::default(),
            pitches: self.pitches.iter().map(|(drive, pitch)| (drive.get(), pitch.nanometres)).collect(),
            measure: self.measure,
            unsaved: self.unsaved.saved().clone(),
            scales: unconfirmed.iter().filter_map(scale).collect(),
            unconfirmed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Issue 21.11: what was confirmed here locks again by another's mark, and not by the one that was confirmed.
    #[test]
    fn a_mark_of_the_same_number_is_the_same() {
        let of = |text: &str| ron::from_str::<Remembered>(&format!("({text})")).unwrap();
        let cases: [(&str, &str, &[u8]); 7] = [
            ("unconfirmed: [1], marks: {1: 1}", "", &[1]),
            ("unconfirmed: [1], marks: {1: 1}", "unconfirmed: [1], marks: {1: 1}", &[]),
            ("unconfirmed: [1], marks: {1: 1}", "marks: {1: 1}", &[]),
            ("unconfirmed: [1], marks: {1: 2}", "marks: {1: 1}", &[1]),
            // By a program that does not count.
            ("unconfirmed: [1]", "", &[1]),
            ("unconfirmed: [1]", "marks: {1: 1}", &[1]),
            ("marks: {1: 2}", "marks: {1: 1}", &[]),
        ];
        for (found, before, marked) in cases {
            assert_eq!(of(found).marked_since(&of(before)), marked, "{found}, {before}");
        }
    }
}
