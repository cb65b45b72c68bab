//! The actions of the encoder that is shown.

use std::path::PathBuf;

use super::commutation;
use crate::app::DeviceAction;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::procedures::Watch;
use crate::devices::hiperface::profile::{FieldRange, RestoreOptions};
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, LineSettings};
use crate::profile::PlanId;

pub enum HiperfaceAction {
    ReadStatus,
    /// Starts or stops reading a value while the position is polled.
    Watch(Watch, bool),
    ReadAnalogue(u8),
    /// Reads position, sine and cosine with the shaft at rest.
    ReadRest,
    ReadCounter,
    /// Runs the device check, after a restart if requested.
    Check {
        /// Send 53h first.
        restart: bool,
    },
    Reset,
    /// Changes the interface settings until the next restart.
    ConfigureForNow(LineSettings),
    UseCode {
        number: AccessCodeNumber,
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
    /// Prepares the plan again with other options, if the change is a restore.
    PlanAgain(RestoreOptions),
    /// Permits writing even though the encoder has reached its limit of write cycles.
    ForceWear(bool),
    Write(PlanId),
    CloseReview,
    Save(PathBuf),
    Commutation(commutation::CommutationAction),
}

impl DeviceAction for HiperfaceAction {}
