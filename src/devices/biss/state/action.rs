//! The actions of a BiSS encoder that is shown.

use std::path::PathBuf;

use crate::app::DeviceAction;
use crate::app::studio::SessionId;
use crate::devices::biss::jobs::Change;
use crate::devices::biss::procedures::procedure::{Answer, Task};
use crate::devices::biss::profile::{MotorSource, MountingRun};
use crate::devices::biss::protocol::{Register, RegisterAddress};

/// Something in the BiSS tab.
pub enum BissAction {
    /// Read errors, warnings, temperature and mode.
    ReadStatus,
    Check,
    /// While the position is read all the time, read this too, or no more.
    Watch(Box<Register>, bool),
    /// Read a bank; `None`: the direct registers.
    ReadBank(Option<u8>),
    /// Read a bank that has become visible and was never read, when nothing else is to be done.
    SeeBank(Option<u8>),
    /// Read a plain data area, by its first bank.
    ReadArea(u8),
    /// Edit bytes of plain data.
    Put {
        /// First byte.
        start: RegisterAddress,
        bytes: Vec<u8>,
    },
    Revert {
        /// First byte.
        start: RegisterAddress,
        count: usize,
    },
    Plan(Box<Change>),
    /// Show the effect of a mounting run; the plain data comes from a profile that is open in another session.
    PlanMounting {
        /// The steps, without the data.
        run: Box<MountingRun>,
        motor: MotorSource,
        data: Option<SessionId>,
    },
    Answer(Task, Answer),
    CloseGuide,
    LeadBack,
    /// Turn the virtual encoder's shaft, in revolutions per minute.
    Turn(f64),
    Save(PathBuf),
}

impl DeviceAction for BissAction {}
