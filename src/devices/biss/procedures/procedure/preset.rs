//! Preset, which stores a preset value or sets the current shaft position to it. In both cases, the encoder restarts.
//! See manual 6.7.

use super::guide::{OperatorDecision, ProcedureContext};
use super::{Activity, Failure, OperatorTask, Outcome, ProcedureStep};
use crate::devices::biss::procedures::PositionReading;
use crate::devices::biss::profile::{PresetParts, RegisterRange};
use crate::devices::biss::protocol::{
    PresetCommand, PresetStatus, PresetValue, Procedure, ProcedureKind, RegisterAddress,
};

/// Reciprocal of the allowed jitter around the new position, in revolutions. This allows 0.35°.
const PRESET_JITTER_DIVISOR: u64 = 1024;

impl ProcedureContext<'_, '_> {
    pub(super) fn store_preset(&mut self, to: PresetValue) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::Preset)?;
        let registers: Vec<(RegisterAddress, u8)> = value_range(&procedure)?.addresses().zip(to.emit()).collect();
        self.enter(&procedure)?;
        self.begin_step(ProcedureStep::Open);
        self.command(&procedure, PresetCommand::Edit.byte())?;
        self.await_status(&procedure, PresetStatus::WaitForValue.byte())?;
        self.set_activity(Activity::Entered);
        self.begin_step(ProcedureStep::Write);
        for (address, byte) in &registers {
            self.master.write(*address, *byte)?;
        }
        self.begin_step(ProcedureStep::Save);
        self.save(&procedure, PresetCommand::Save.byte())?;
        self.run_uncancellable(|guide| {
            guide.wait_for_restart()?;
            guide.begin_step(ProcedureStep::ReadBack);
            for (address, byte) in &registers {
                guide.read_back(*address, *byte)?;
            }
            let singleturn_bits = guide.master.station().frame_layout().singleturn_bits();
            Ok(Outcome::PresetStored { value: to, singleturn_bits })
        })
    }

    pub(super) fn trigger_preset(&mut self, parts: PresetParts, value: PresetValue) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::Preset)?;
        let OperatorDecision::Go(_) = self.run_operator_task(OperatorTask::HoldAtPresetAngle)? else {
            return Ok(Outcome::Skipped { after: None });
        };
        let from = self.master.position()?;
        self.enter(&procedure)?;
        self.begin_step(ProcedureStep::Fire);
        self.save(&procedure, parts.command().byte())?;
        self.run_uncancellable(|guide| {
            guide.wait_for_restart()?;
            guide.begin_step(ProcedureStep::ReadBack);
            let to = guide.master.position()?;
            let expected = preset(&from, parts, value);
            if shortest_distance(expected, &to) > ((1_u64 << to.singleturn_bits) / PRESET_JITTER_DIVISOR).max(1) {
                return Err(Failure::NotVerified {
                    item: "position".to_owned(),
                    expected: expected.to_string(),
                    got: to.position().to_string(),
                });
            }
            Ok(Outcome::PresetFired { parts, from, to })
        })
    }
}

fn value_range(procedure: &Procedure) -> Result<RegisterRange, Failure> {
    let range = procedure.data.and_then(|first| RegisterRange::new(first, PresetValue::BYTES));
    range.ok_or(Failure::NotDescribed { kind: procedure.kind })
}

/// Returns the position expected after the preset, as a single number of steps.
fn preset(from: &PositionReading, parts: PresetParts, value: PresetValue) -> u64 {
    let steps = if parts.includes_singleturn() { value.singleturn() } else { from.steps };
    let turns = if parts.includes_multiturn() { value.multiturn() } else { from.turns };
    u64::from(turns) << from.singleturn_bits | u64::from(steps)
}

/// Returns the number of steps between `place` and the reading in the shorter direction.
fn shortest_distance(place: u64, reading: &PositionReading) -> u64 {
    let bits = u32::from(reading.position_word().bits);
    let mask = 1_u64.checked_shl(bits).map_or(u64::MAX, |range| range - 1);
    let forward = place.wrapping_sub(reading.position()) & mask;
    let backward = reading.position().wrapping_sub(place) & mask;
    forward.min(backward)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Moment;

    fn reading(turns: u32, steps: u32) -> PositionReading {
        PositionReading {
            at: Moment::START,
            turns,
            steps,
            error: None,
            warning: None,
            crc_errors: 0,
            multiturn_bits: 16,
            singleturn_bits: 17,
            is_split_known: true,
            frame: None,
        }
    }

    #[test]
    fn preset_sets_selected_parts() {
        let value = PresetValue::new(0x18000, 3).unwrap();
        let from = reading(0x1234, 0x00FF);
        assert_eq!(preset(&from, PresetParts::Both, value), 3 << 17 | 0x18000);
        assert_eq!(preset(&from, PresetParts::Singleturn, value), 0x1234 << 17 | 0x18000);
        assert_eq!(preset(&from, PresetParts::Multiturn, value), 3 << 17 | 0xFF);
    }

    #[test]
    fn takes_shorter_direction() {
        assert_eq!(shortest_distance(0, &reading(0xFFFF, 0x1FFFF)), 1);
        assert_eq!(shortest_distance(1, &reading(0, 0)), 1);
        assert_eq!(shortest_distance(1 << 32, &reading(0, 0)), 1 << 32);
    }
}
