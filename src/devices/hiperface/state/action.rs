//! Actions on the displayed encoder.

use std::path::PathBuf;

use super::commutation;
use crate::app::DeviceAction;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::procedures::WatchedQuantity;
use crate::devices::hiperface::profile::{FieldRange, RestoreOptions};
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, LineSettings};
use crate::profile::PlanId;

pub enum HiperfaceAction {
    ReadStatus,
    /// Starts or stops polling a value in addition to the position.
    Watch(WatchedQuantity, bool),
    ReadAnalogue(u8),
    /// Reads the position, sine and cosine while the shaft is at rest.
    ReadRest,
    ReadCounter,
    Check {
        /// Whether to restart the encoder first (53h).
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
        /// Index of the first byte.
        address: usize,
        bytes: Vec<u8>,
    },
    Revert(FieldRange),
    Plan(Change),
    /// Prepares the plan again. The options apply only to a restore.
    PlanAgain(RestoreOptions),
    /// Allows or forbids writing to an encoder that has reached its limit of write cycles.
    ForceWear(bool),
    Write(PlanId),
    CloseReview,
    Save(PathBuf),
    Commutation(commutation::CommutationAction),
}

impl DeviceAction for HiperfaceAction {}
