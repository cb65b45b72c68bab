//! Words that change the selected cam program (reference 5).

use super::{Activity, Encoder, INVALID, InWordContent, WordFault};
use crate::devices::interbus::protocol::{CamNumber, Gear, Program, StartupMode, Value};
use crate::devices::interbus::sim::memory::{StoredSettings, cam_mut};
use crate::units::Moment;

pub(super) struct Setting<'a>(&'a mut Program);

impl Setting<'_> {
    pub(super) fn start(&mut self, cam: CamNumber, value: Value, gear: Gear) -> Result<(), WordFault> {
        if let Some(cam) = cam_mut(self.0, cam) {
            cam.start = check_in_range(value, gear)?;
        }
        Ok(())
    }

    pub(super) fn set_stop(&mut self, cam: CamNumber, value: Value, gear: Gear) -> Result<(), WordFault> {
        if let Some(cam) = cam_mut(self.0, cam) {
            cam.stop = check_in_range(value, gear)?;
        }
        Ok(())
    }

    /// Sets the mask of active cams (reference 6.9). A mask of more than 8 bits is rejected as wrong data (`U`: not
    /// documented).
    pub(super) fn set_active_cams(&mut self, mask: u16) -> Result<(), WordFault> {
        self.0.mask = u8::try_from(mask).map_err(|_| WordFault::WrongData)?;
        Ok(())
    }
}

fn check_in_range(value: Value, gear: Gear) -> Result<Value, WordFault> {
    if value.get() < gear.total_steps() { Ok(value) } else { Err(WordFault::BeyondRange) }
}

impl Encoder {
    pub(super) fn set_cams(
        &mut self,
        now: Moment,
        change: impl FnOnce(&mut Setting<'_>, Gear) -> Result<(), WordFault>,
    ) {
        let StartupMode::Cams(number) = self.mode else { return };
        let gear = self.memory.gear;
        let Some(program) = self.memory.program_mut(number) else { return };
        let taken = change(&mut Setting(program), gear).map(|()| StoredSettings::Program(number));
        self.complete_setting(now, taken);
    }

    /// Ends a read-out. If values were set but not stored, the position and outputs remain invalid.
    pub(super) fn end_read_out(&mut self) {
        match self.unstored {
            None => self.enter_activity(Activity::Running, InWordContent::Live),
            Some(_) => self.enter_activity(Activity::Setting, InWordContent::Word(INVALID)),
        }
    }
}
