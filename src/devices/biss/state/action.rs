//! Actions on the displayed BiSS encoder.

use std::path::PathBuf;

use crate::app::DeviceAction;
use crate::app::studio::SessionId;
use crate::devices::biss::jobs::Change;
use crate::devices::biss::procedures::procedure::{OperatorAnswer, OperatorTask};
use crate::devices::biss::profile::{MotorSource, MountingSteps};
use crate::devices::biss::protocol::{Register, RegisterAddress};

pub enum BissAction {
    /// Reads errors, warnings, temperature and device mode.
    ReadStatus,
    Check,
    /// Starts or stops reading a register along with the position.
    Watch(Box<Register>, bool),
    /// Reads a bank, or the direct registers for `None`.
    ReadBank(Option<u8>),
    /// Reads a bank that has become visible for the first time. Ignored while a job is running.
    ReadVisibleBank(Option<u8>),
    /// Reads the data area that starts at the given bank.
    ReadArea(u8),
    /// Edits bytes of a data area.
    Put {
        start: RegisterAddress,
        bytes: Vec<u8>,
    },
    Revert {
        start: RegisterAddress,
        count: usize,
    },
    Plan(Box<Change>),
    /// Plans the procedures that follow mounting, for review. The data areas are filled from a profile that is open in
    /// another session.
    PlanMounting {
        /// Steps to perform, without the values for the data areas.
        run: Box<MountingSteps>,
        motor: MotorSource,
        data: Option<SessionId>,
    },
    Answer(OperatorTask, OperatorAnswer),
    CloseGuide,
    ReturnToOperation,
    /// Turns the shaft of the virtual encoder at a speed in revolutions per minute.
    Turn(f64),
    Save(PathBuf),
}

impl DeviceAction for BissAction {}
