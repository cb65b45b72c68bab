//! The guided procedures (manual 6.3 to 6.7). The code of a procedure runs straight through, from entering its device
//! mode to the return to operation mode. It instructs the operator at the motor through an [`Operator`], reports every
//! [`ProcedureStep`], and always ends in operation mode with the password cleared. If the encoder cannot be reached,
//! the known [`LeftState`] is reported instead, and [`return_to_operation`] completes the return later.
//!
//! | file | content |
//! |---|---|
//! | `guide` | the shared parts: modes, commands, statuses, restarts, operator, return to operation |
//! | `speed_monitor` | direction and speed of the shaft |
//! | `operator` | the operator at the motor: tasks, and reasons why a start is not possible |
//! | `left_state` | the state in which an encoder may be left |
//! | `steps` | the steps of each operation |
//! | `data`, `filter`, `preset`, `wiegand`, `calibration` | the five procedures of the manual |

mod calibration;
mod data;
mod failure;
mod filter;
mod guide;
mod left_state;
mod operator;
mod preset;
mod speed_monitor;
mod steps;
mod wiegand;

pub use calibration::CalibrationReport;
pub use failure::Failure;
pub(super) use guide::ProcedureContext;
pub use left_state::{Activity, LeftState, PossibleValues};
pub use operator::{
    MotorRun, Operator, OperatorAdvice, OperatorAnswer, OperatorChannel, OperatorPrompt, OperatorTask, SpeedRange,
    StartBlocker, UnattendedOperator,
};
pub use speed_monitor::ShaftMotion;
pub use steps::{ProcedureProgress, ProcedureStep, StepDetail, operation_steps};
pub use wiegand::WiegandReport;

use super::{Error, Master, PositionReading, identify};
use crate::devices::biss::profile::{Op, PresetParts};
use crate::devices::biss::protocol::{Descriptions, DeviceMode, PositionFilter, PresetValue, RegisterAddress};

#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// The operator skipped the whole procedure, or the rest of it after the first run.
    Skipped {
        after: Option<MotorRun>,
    },
    /// Registers were written, saved if required, and read back.
    Stored {
        registers: u64,
    },
    PresetStored {
        value: PresetValue,
        /// Width of the singleturn position in bits.
        singleturn_bits: u8,
    },
    PresetFired {
        parts: PresetParts,
        from: PositionReading,
        to: PositionReading,
    },
    FilterSelected(PositionFilter),
    Calibrated(CalibrationReport),
    Tested(WiegandReport),
}

impl ProcedureContext<'_, '_> {
    pub(super) fn execute(&mut self, op: &Op) -> Result<Outcome, Failure> {
        match op {
            Op::StoreData { area, registers } => self.store_data(area, registers),
            Op::StorePreset { to, .. } => self.store_preset(*to),
            Op::FirePreset { parts, value } => self.trigger_preset(*parts, *value),
            Op::SelectFilter { to, .. } => self.select_filter(*to),
            Op::Calibrate => self.calibrate(),
            Op::WiegandTest { save } => self.test_wiegand(*save),
            Op::WriteRegister { address, old, new, cycles } => {
                self.begin_step(ProcedureStep::Write);
                let ended = self.master.write(*address, *new);
                if !matches!(ended, Err(Error::Cancelled | Error::Refused { .. })) {
                    (0..*cycles).for_each(|_| self.count_write_cycle());
                }
                ended?;
                if old.is_some() {
                    self.begin_step(ProcedureStep::ReadBack);
                    self.run_uncancellable(|guide| guide.read_back(*address, *new))?;
                }
                Ok(Outcome::Stored { registers: 1 })
            }
        }
    }
}

/// Returns an encoder to operation mode, clears the password, and returns the previous mode. This also works after the
/// link was lost or another host changed the mode. If the encoder is silent during a calibration, the function waits
/// for it.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder does not return to operation.
pub fn return_to_operation(master: &mut Master<'_>, types: &Descriptions) -> Result<DeviceMode, Error> {
    if master.station().description.is_none() {
        master.with_reply_timeout(guide::SILENCE_LIMIT, |master| master.read(RegisterAddress::BANK_SELECT))?;
        identify(master, types)?;
    }
    let description = master.description()?;
    let Some(lock) = description.lock() else { return Ok(DeviceMode::OPERATION) };
    let mut standing = LeftState::in_operation(false);
    let back = |master: &mut Master<'_>| guide::return_to_operation(master, &description, lock, &mut standing);
    master.run_uncancellable(|master| master.with_reply_timeout(guide::SILENCE_LIMIT, back))
}
