//! Readings of all parameters of a device. They are updated with data from the drives, and show when another master has
//! changed something.

use super::staged::is_editable;
use super::unit::HiperdriveDevice;
use crate::app::services::Services;
use crate::app::session::{HasDraft, HasMemory, HasProfile};
use crate::app::{SettingsReadState, Severity, Text};
use crate::devices::hiperdrive::procedures::dead_man::MotionLock;
use crate::devices::hiperdrive::procedures::{DisplayedLimits, DriveLimits, DriveReading, Identity, Survey};
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, NUMERATOR, REFERENCE};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, State, Value};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;

impl HiperdriveDevice {
    /// Adopts a reading of all parameters. Edits are kept, unless they belong to another device.
    pub(super) fn apply_survey(&mut self, survey: Survey, services: &mut Services) {
        self.session.last_read_time = Some(services.current_time().timestamp());
        if self.is_different_device(&survey.identity) {
            self.handle_device_replacement(&survey.identity.serial_number, services);
        }
        let first = self.survey.is_none();
        let image = image(&survey);
        self.handle_scale_change(&image);
        self.session.title = Some(title(&survey.identity));
        self.unsaved.read(&survey.values);
        let known = self.survey.as_ref().map(|own| own.wrong_lengths.as_slice()).unwrap_or_default();
        for error in survey.wrong_lengths.iter().filter(|error| !known.contains(error)) {
            let text = explain::wrong_length(error);
            services.notify(Severity::Warning, vec![text], Some(&self.session.name()));
        }
        let drives = survey.identity.drives.iter();
        self.staged.set_families(drives.filter_map(|own| Some((own.number, own.variant.row()?.family))).collect());
        self.staged.refresh(image);
        self.survey = Some(survey);
        self.readings.clear();
        // Values read under control may be newer than the survey.
        let differs = self.drives().into_iter().any(|drive| self.has_different_limits(drive));
        (self.is_stale, self.looks_at_all) = (differs, differs);
        if !self.drives().contains(&self.drive)
            && let Some(drive) = self.drives().first().copied()
        {
            self.show_drive(drive);
        }
        if first {
            self.load_draft(services);
            self.log_first_reply(services);
        }
        self.list_backups(services);
        self.handle_axes_survey();
    }

    /// Requires that the limits are confirmed after a change of scale.
    pub(super) fn handle_scale_change(&mut self, now: &Image) {
        let Some(before) = self.staged.base() else { return };
        let is_other = |drive: &DriveNumber| {
            let scales = before.scale(*drive).zip(now.scale(*drive));
            scales.is_some_and(|(before, now)| before != now)
        };
        for drive in now.drives().into_iter().filter(is_other).collect::<Vec<_>>() {
            self.moves.require_confirmation(drive);
        }
    }

    /// Reads all parameters again when control is taken. The same happens if the limits read under control differ from
    /// those in the parameter table.
    pub(super) fn handle_limit_change(&mut self) {
        if self.moves.take_control_opened() {
            (self.is_stale, self.marks) = (true, SettingsReadState::Unread);
        }
        for drive in self.moves.take_changed_limits() {
            if self.has_different_limits(drive) {
                (self.is_stale, self.looks_at_all) = (true, true);
            }
        }
    }

    /// Returns whether the limits, the scale or the reference of the drive differ from the displayed parameters.
    fn has_different_limits(&self, drive: DriveNumber) -> bool {
        let held = self.drive_limits(drive).filter(|_| self.moves.is_open());
        held.and_then(DriveLimits::displayed_limits).is_some_and(|own| {
            let shown = self.staged.base();
            let scale =
                shown.and_then(|image| image.for_drive(drive, NUMERATOR).zip(image.for_drive(drive, DENOMINATOR)));
            Some(own.limits) != shown.and_then(|image| image.limits(drive)) || Some(own.scale) != scale
        }) || held
            .and_then(|own| own.rules().reference)
            .zip(self.parameter_value(drive, REFERENCE))
            .is_some_and(|(own, shown)| own != shown)
    }

    /// Returns the reason if the parameters read so far are not sufficient to move the drive.
    pub(super) fn missing_parameters_reason(&self, drive: DriveNumber) -> Option<Text> {
        if self.is_stale {
            Some(explain::lock_text(MotionLock::Unread))
        } else if self.moves.is_open() && self.marks != SettingsReadState::Read {
            Some(TEXTS.text("hd_lock.settings"))
        } else if self.moves.is_open() && !self.moves.are_limits_valid(drive) {
            Some(explain::lock_text(MotionLock::Outdated))
        } else {
            None
        }
    }

    /// Checks whether the displayed limits of a drive can be confirmed. They must equal the limits of the drive, if
    /// these are known.
    ///
    /// # Errors
    /// Returns an error with the reason if the limits cannot be confirmed.
    pub fn check_can_confirm(&self, drive: DriveNumber) -> Result<(), Text> {
        self.displayed_limits_to_confirm(drive).map(|_| ())
    }

    /// Returns the displayed limits of a drive that would be confirmed.
    fn displayed_limits_to_confirm(&self, drive: DriveNumber) -> Result<DisplayedLimits, Text> {
        self.missing_parameters_reason(drive).map_or(Ok(()), Err)?;
        let seen = self.drive_limits(drive).and_then(DriveLimits::displayed_limits);
        seen.ok_or_else(|| explain::lock_text(MotionLock::Unread))
    }

    /// Confirms the displayed limits. Returns `false` if this failed; the user is then told why.
    pub(super) fn confirm_limits(&mut self, drive: DriveNumber, services: &mut Services) -> bool {
        // The limits are taken as shown, before another update, because the user has not seen later changes.
        let shown = self.displayed_limits_to_confirm(drive);
        self.moves.update();
        self.handle_limit_change();
        let counts = self.displayed_limits_to_confirm(drive).and(shown).and_then(|seen| {
            let counts = self.moves.confirm_limits(drive, seen);
            counts.then_some(()).ok_or_else(|| explain::lock_text(MotionLock::Unread))
        });
        if let Err(why) = &counts {
            self.report_drive_message(drive, Severity::Warning, vec![why.clone()], services);
        }
        counts.is_ok()
    }

    pub(super) fn take_reading(&mut self, reading: DriveReading) {
        let before = self.actual_values(reading.drive).map(|own| own.status.state());
        self.readings.insert(reading.drive, reading);
        self.request_fault_cause(reading.drive, before);
    }

    /// Requests the cause of a fault if the drive, whose previous state is `before`, has failed since then.
    pub(super) fn request_fault_cause(&mut self, drive: DriveNumber, before: Option<State>) {
        if self.state(drive) == Some(State::Fault) && before.is_some_and(|before| before != State::Fault) {
            self.looks_at_errors = true;
        }
    }

    pub(super) fn is_different_device(&self, identity: &Identity) -> bool {
        self.identity().is_some_and(|known| {
            (&known.category, &known.serial_number) != (&identity.category, &identity.serial_number)
        })
    }

    fn log_first_reply(&self, services: &mut Services) {
        let Some(identity) = self.identity() else { return };
        let fact = TEXTS
            .text("log.hiperdrive")
            .with("category", &identity.category)
            .with("serial", &identity.serial_number)
            .with("version", &identity.version)
            .with("drives", identity.drives.len());
        self.session.log_first_reply(vec![fact], services);
    }

    pub(super) fn forget_readings(&mut self) {
        self.readings.clear();
        (self.looks_at_errors, self.looks_at_all) = (false, false);
    }
}

fn image(survey: &Survey) -> Image {
    let editable = |(number, value): (&ParameterNumber, &Value)| match value {
        Value::Number(value) if number.row().is_some_and(is_editable) => Some((*number, *value)),
        _ => None,
    };
    Image { values: survey.values.iter().filter_map(editable).collect() }
}

/// Returns the name of a device as used in the log and in jobs.
fn title(identity: &Identity) -> String {
    format!("{} · {}", identity.category, identity.serial_number)
}
