//! Notes about encoders that a job switches to another mode, so that the next run can restore the mode after an
//! interruption.

use super::Master;
use super::modes::is_same_operating_mode;
use crate::devices::interbus::procedures::Error;
use crate::devices::interbus::procedures::journal::{Journal, ModeSwitch};
use crate::devices::interbus::protocol::{ReadOutNumber, StartupMode};

#[derive(Default)]
pub(super) struct JournalNotes<'a> {
    journal: Option<Box<dyn Journal + 'a>>,
    serial_number: Option<String>,
    excursion: Option<ModeSwitch>,
    /// Number of cam programs that were left unchanged. The encoder may have stored each of them anyway.
    left: u64,
    /// Whether the selected cam program was changed. If so, storing it is counted as part of the write.
    is_set: bool,
}

impl<'a> Master<'a> {
    /// Sets the journal that records mode switches and EEPROM write cycles.
    #[must_use]
    pub fn with_journal(mut self, journal: impl Journal + 'a) -> Self {
        self.notes.journal = Some(Box::new(journal));
        self
    }
}

impl Master<'_> {
    pub(super) fn note_serial_number(&mut self, serial_number: u32) {
        self.notes.serial_number = Some(serial_number.to_string());
    }

    /// Records that the given number of cam programs is about to be selected for reading.
    pub(in crate::devices::interbus::procedures) fn record_program_reads(
        &mut self,
        programs: usize,
    ) -> Result<(), Error> {
        if programs == 0 || self.notes.journal.is_none() {
            return Ok(());
        }
        let serial_number = self.serial_number()?;
        if let Some(journal) = &mut self.notes.journal {
            journal.record_planned_stores(&serial_number, programs as u64);
        }
        Ok(())
    }

    pub(super) fn mark_program_set(&mut self) {
        self.notes.is_set = matches!(self.is, Some(StartupMode::Cams(_)));
    }

    /// Continues with the original mode if an interrupted run left the encoder in the given mode.
    pub(super) fn resume(&mut self, mode: StartupMode) -> Result<(), Error> {
        if !self.notes.journal.as_ref().is_some_and(|journal| journal.has_modes_to_restore()) {
            return Ok(());
        }
        let serial_number = self.serial_number()?;
        let Some(journal) = &mut self.notes.journal else { return Ok(()) };
        let Some(excursion) = journal.recorded_mode_switch(&serial_number) else { return Ok(()) };
        if is_same_operating_mode(mode, excursion.found) || !excursion.sent.contains(&mode) {
            // The encoder was returned to its mode, or another mode has been selected since then.
            journal.record_mode_restored(&serial_number);
            return Ok(());
        }
        tracing::warn!(
            "A run that was cut off left encoder {serial_number} in mode {}: it is returned to mode {}.",
            mode.emit(),
            excursion.found.emit()
        );
        (self.found, self.switched) = (Some(excursion.found), true);
        self.notes.excursion = Some(excursion);
        Ok(())
    }

    /// Records that the encoder is about to enter the given mode.
    pub(super) fn record_mode_switch(&mut self, wanted: StartupMode) -> Result<(), Error> {
        if let Some(StartupMode::Cams(_)) = self.is
            && !std::mem::take(&mut self.notes.is_set)
        {
            self.notes.left += 1;
        }
        let Some(found) = self.found.filter(|found| !is_same_operating_mode(*found, wanted)) else { return Ok(()) };
        if self.notes.journal.is_none() {
            return Ok(());
        }
        let serial_number = self.serial_number()?;
        let excursion = self.notes.excursion.get_or_insert_with(|| ModeSwitch { found, sent: Vec::new() });
        if !excursion.sent.contains(&wanted) {
            excursion.sent.push(wanted);
        }
        if let Some(journal) = &mut self.notes.journal {
            journal.save_mode_switch(&serial_number, excursion);
        }
        Ok(())
    }

    /// Records that the return to operation stored settings made by another program.
    pub(super) fn record_interrupted_store(&mut self) -> Result<(), Error> {
        if self.notes.journal.is_some() {
            self.serial_number()?;
            self.notes.left += 1;
        }
        Ok(())
    }

    /// Records the possible EEPROM write cycles at the end of a step, and whether the encoder is back in its initial
    /// mode.
    pub(super) fn record_step_end(&mut self, is_back: bool) {
        let JournalNotes { journal: Some(journal), serial_number: Some(serial_number), excursion, left, .. } =
            &mut self.notes
        else {
            return;
        };
        // An encoder that is not back has yet to leave its program, and may store it then.
        journal
            .record_possible_stores(serial_number, std::mem::take(left) + u64::from(!is_back && excursion.is_some()));
        if is_back && excursion.take().is_some() {
            journal.record_mode_restored(serial_number);
        }
    }

    fn serial_number(&mut self) -> Result<String, Error> {
        if self.notes.serial_number.is_none() {
            self.read_out(ReadOutNumber::SERIAL_NUMBER)?;
        }
        Ok(self.notes.serial_number.clone().unwrap_or_default())
    }
}
