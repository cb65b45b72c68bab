//! Why a procedure did not reach its end.

use super::{Blocker, Run, Task};
use crate::devices::biss::procedures::Error;
use crate::devices::biss::protocol::{CalibrationStatus, DeviceMode, ProcedureKind, WiegandStatus};
use crate::profile::OperationError;

/// Why a procedure did not reach its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The line, the encoder's refusal, or the user's wish.
    #[error(transparent)]
    Device(#[from] Error),
    /// The calibration says why.
    #[error("the calibration ended with {status}")]
    Calibration {
        /// In the clockwise run the table is lost with it.
        run: Run,
        /// What the encoder says.
        status: CalibrationStatus,
    },
    /// The Wiegand test says why.
    #[error("the Wiegand test ended with {status}, error code 0x{code:02X}")]
    Wiegand {
        /// In which run.
        run: Run,
        /// What the encoder says.
        status: WiegandStatus,
        /// Its error code; what it means is not published.
        code: u8,
    },
    /// The filter in force is not the balanced one.
    #[error("the calibration needs the balanced filter, and 0x{code:02X} is in force")]
    NotBalanced {
        /// The filter's code.
        code: u8,
    },
    /// The device mode that was written does not read back.
    #[error("device mode {wanted} was written and {found} is there")]
    Mode {
        /// What was written.
        wanted: DeviceMode,
        /// What reads back.
        found: DeviceMode,
    },
    /// A status register never said what it has to.
    #[error("the status of the procedure is 0x{found:02X} where 0x{expected:02X} is needed")]
    Status {
        /// Which procedure.
        kind: ProcedureKind,
        /// What it has to say.
        expected: u8,
        /// What it says.
        found: u8,
    },
    /// A run has no end.
    #[error("the run has not ended after {seconds} s")]
    TooLong {
        /// Which.
        run: Run,
        /// How long it was waited for.
        seconds: u64,
    },
    /// What was asked of the person did not come about in the time that was given for it.
    #[error("what has to be is not: {blockers:?}")]
    NotReady {
        /// What was asked.
        task: Task,
        /// What stands against it.
        blockers: Vec<Blocker>,
    },
    /// What was read back is not what was written.
    #[error("{item} reads {got} after writing {expected}")]
    NotVerified {
        /// What was written.
        item: String,
        /// As it should be.
        expected: String,
        /// As it is.
        got: String,
    },
    /// The description of this encoder does not have what the plan needs.
    #[error("nothing describes how this encoder does that")]
    NotDescribed {
        /// Which procedure.
        kind: ProcedureKind,
    },
}

impl OperationError for Failure {
    type Device = Error;

    fn device(&self) -> Option<&Error> {
        match self {
            Failure::Device(error) => Some(error),
            _ => None,
        }
    }

    fn is_only_cancelled(&self) -> bool {
        self.is_cancelled()
    }
}

impl Failure {
    /// The user wished it.
    pub fn is_cancelled(&self) -> bool {
        *self == Failure::Device(Error::Cancelled)
    }

    /// The encoder can no longer be reached.
    pub fn is_lost(&self) -> bool {
        matches!(self, Failure::Device(error) if error.is_lost())
    }
}
