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
    /// Starts or stops reading a value along with the position.
    Watch(WatchedQuantity, bool),
    ReadAnalogue(u8),
    /// Reads the position, sine and cosine while the shaft is at rest.
    ReadRest,
    ReadCounter,
    Check {
        /// Whether the encoder is restarted first with command 53h.
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
    /// Prepares the plan again. A restore is planned with the given options. Any other plan is prepared without
    /// changes.
    PlanAgain(RestoreOptions),
    /// Permits or forbids writing to an encoder that has reached its limit of write cycles.
    ForceWear(bool),
    Write(PlanId),
    CloseReview,
    Save(PathBuf),
    Commutation(commutation::CommutationAction),
}

impl DeviceAction for HiperfaceAction {}
