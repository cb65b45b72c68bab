//! The actions of the encoder that is shown.

use std::path::PathBuf;

use super::commutation;
use crate::app::DeviceAction;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::procedures::Watch;
use crate::devices::hiperface::profile::{FieldRange, RestoreOptions};
use crate::devices::hiperface::protocol::{AccessCode, CodeNumber, LineSettings};
use crate::profile::PlanId;

pub enum HiperfaceAction {
    ReadStatus,
    /// Start or stop reading a value while the position is polled.
    Watch(Watch, bool),
    ReadAnalogue(u8),
    /// Read the shaft at rest: position, sine and cosine.
    ReadRest,
    ReadCounter,
    /// Run the device check; with a restart first if set.
    Check {
        /// Send 53h first.
        restart: bool,
    },
    Reset,
    /// Change the interface settings until the next restart.
    ConfigureForNow(LineSettings),
    UseCode {
        number: CodeNumber,
        code: AccessCode,
    },
    Put {
        field: u8,
        /// First byte.
        address: usize,
        bytes: Vec<u8>,
    },
    Revert(FieldRange),
    Plan(Change),
    /// Prepare the plan again with other options, if the change is a restore.
    PlanAgain(RestoreOptions),
    /// Write even though the encoder has reached its limit of write cycles.
    ForceWear(bool),
    Write(PlanId),
    CloseReview,
    Save(PathBuf),
    Commutation(commutation::CommutationAction),
}

impl DeviceAction for HiperfaceAction {}
