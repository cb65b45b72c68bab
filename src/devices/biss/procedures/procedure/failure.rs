//! Reasons why a procedure fails.

use super::{MotorRun, OperatorTask, StartBlocker};
use crate::devices::biss::procedures::Error;
use crate::devices::biss::protocol::{CalibrationStatus, DeviceMode, ProcedureKind, WiegandStatus};
use crate::profile::OperationError;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// An exchange failed, the encoder rejected a request, or the operation was cancelled.
    #[error(transparent)]
    Device(#[from] Error),
    #[error("the calibration ended with {status}")]
    Calibration { run: MotorRun, status: CalibrationStatus },
    #[error("the Wiegand test ended with {status}, error code 0x{code:02X}")]
    Wiegand {
        run: MotorRun,
        status: WiegandStatus,
        /// Error code from the encoder. Its meaning is not published.
        code: u8,
    },
    /// The active filter is not the balanced filter, which the calibration requires.
    #[error("the calibration requires the balanced filter, but the filter is 0x{code:02X}")]
    NotBalanced { code: u8 },
    /// The device mode read back differs from the one written.
    #[error("device mode {wanted} was written, but {found} was read back")]
    Mode { wanted: DeviceMode, found: DeviceMode },
    /// The procedure's status register did not reach the required value in time.
    #[error("the status of the procedure is 0x{found:02X} instead of 0x{expected:02X}")]
    Status { kind: ProcedureKind, expected: u8, found: u8 },
    #[error("the run has not ended after {seconds} s")]
    TooLong {
        run: MotorRun,
        /// How long the program has waited, in seconds.
        seconds: u64,
    },
    /// The operator did not complete the task in time.
    #[error("the conditions are not met: {blockers:?}")]
    NotReady { task: OperatorTask, blockers: Vec<StartBlocker> },
    /// A value read back differs from the one written.
    #[error("{item}: {expected} was written, but {got} was read back")]
    NotVerified { item: String, expected: String, got: String },
    /// The description of the encoder does not contain the procedure.
    #[error("this procedure is not described for this encoder")]
    NotDescribed { kind: ProcedureKind },
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
    pub fn is_cancelled(&self) -> bool {
        *self == Failure::Device(Error::Cancelled)
    }

    pub fn is_lost(&self) -> bool {
        matches!(self, Failure::Device(error) if error.is_lost())
    }
}
