//! Exchanges stored data about drives between a session and the settings.

use std::collections::{BTreeMap, BTreeSet};

use super::ruler::PositionUnit;
use super::unit::HiperdriveDevice;
use crate::app::{RememberedDrives, SettingsReadState, StoredDriveData};
use crate::devices::hiperdrive::protocol::{DriveNumber, Length};

/// Values as of the last exchange between a session and the settings.
#[derive(Clone, Debug, Default)]
pub(super) struct ExchangedValues {
    kept: RememberedDrives,
    pitches: BTreeMap<u8, u64>,
    measure: PositionUnit,
    unsaved: BTreeMap<u16, i64>,
    unconfirmed: BTreeSet<DriveNumber>,
    /// Last known scales of the drives whose limits must be confirmed.
    scales: BTreeMap<DriveNumber, (i64, i64)>,
}

impl StoredDriveData for HiperdriveDevice {
    fn storage_name(&self) -> Option<String> {
        let own = self.identity()?;
        let kind = if self.session.is_virtual() { "virtual " } else { "" };
        Some(format!("{kind}{} {}", own.category, own.serial_number))
    }

    fn sync_remembered_drives(&mut self, kept: &RememberedDrives) -> Option<RememberedDrives> {
        let before = match self.exchanged.take() {
            Some(before) => before,
            None => self.apply_remembered(kept),
        };
        let mut next = kept.clone();
        let now = self.remembered_values();
        let (pitches, measure, unsaved) = (before.pitches, before.measure, before.unsaved);
        let known = RememberedDrives::without_limits(pitches, measure, unsaved);
        let (pitches, measure, unsaved) = (now.pitches.clone(), now.measure, now.unsaved.clone());
        let ours = RememberedDrives::without_limits(pitches, measure, unsaved);
        next = next.with_changes(&known, &ours);
        let scaled_anew =
            |drive: &DriveNumber| before.scales.get(drive).is_some_and(|scale| now.scales.get(drive) != Some(scale));
        for drive in now.unconfirmed.iter().filter(|own| !before.unconfirmed.contains(own) || scaled_anew(own)) {
            next.add_marks(drive.get(), 1);
        }
        for drive in before.unconfirmed.difference(&now.unconfirmed).map(|drive| drive.get()) {
            // Limits that another window has marked again have not been confirmed here.
            if kept.mark_count(drive) == before.kept.mark_count(drive) {
                next.set_unconfirmed(drive, false);
            }
        }
        let elsewhere = kept.newly_marked_drives(&before.kept);
        elsewhere.into_iter().filter_map(DriveNumber::new).for_each(|drive| self.moves.require_confirmation(drive));
        self.exchanged = Some(ExchangedValues { kept: next.clone(), ..self.remembered_values() });
        (next != *kept).then_some(next)
    }

    fn lock_marked_drives(&mut self, found: &RememberedDrives) {
        let Some(before) = &mut self.exchanged else { return };
        for drive in found.newly_marked_drives(&before.kept).into_iter().filter_map(DriveNumber::new) {
            self.moves.require_confirmation(drive);
            // The mark was not set in this session.
            before.unconfirmed.insert(drive);
        }
    }

    fn read_state(&self) -> SettingsReadState {
        self.marks
    }

    fn set_read_state(&mut self, marks: SettingsReadState) {
        self.marks = marks;
    }
}

impl HiperdriveDevice {
    fn apply_remembered(&mut self, kept: &RememberedDrives) -> ExchangedValues {
        for (drive, nanometres) in &kept.pitches {
            if let Some(drive) = DriveNumber::new(*drive) {
                self.pitches.entry(drive).or_insert(Length { nanometres: *nanometres });
            }
        }
        self.measure = kept.measure;
        self.unsaved.add_saved_values(&kept.unsaved);
        ExchangedValues {
            pitches: kept.pitches.clone(),
            measure: kept.measure,
            unsaved: kept.unsaved.clone(),
            ..ExchangedValues::default()
        }
    }

    fn remembered_values(&self) -> ExchangedValues {
        let unconfirmed = self.moves.unconfirmed_drives();
        let scale = |drive: &DriveNumber| Some((*drive, self.drive_limits(*drive)?.displayed_limits()?.scale));
        ExchangedValues {
            kept: RememberedDrives::default(),
            pitches: self.pitches.iter().map(|(drive, pitch)| (drive.get(), pitch.nanometres)).collect(),
            measure: self.measure,
            unsaved: self.unsaved.saved_values().clone(),
            scales: unconfirmed.iter().filter_map(scale).collect(),
            unconfirmed,
        }
    }
}
