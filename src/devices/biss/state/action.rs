//! Actions of the BiSS encoder on display.

use std::path::PathBuf;

use crate::app::DeviceAction;
use crate::app::studio::SessionId;
use crate::devices::biss::jobs::Change;
use crate::devices::biss::procedures::procedure::{Answer, Task};
use crate::devices::biss::profile::{MotorSource, MountingRun};
use crate::devices::biss::protocol::{Register, RegisterAddress};

pub enum BissAction {
    /// Read errors, warnings, temperature and device mode.
    ReadStatus,
    Check,
    /// Start or stop reading the given register along with the position while polling.
    Watch(Box<Register>, bool),
    /// Read a bank, or the direct registers for `None`.
    ReadBank(Option<u8>),
    /// Read a newly visible bank that has never been read, if nothing else is going on.
    SeeBank(Option<u8>),
    /// Read the plain data area that starts at the given bank.
    ReadArea(u8),
    /// Edit bytes of plain data.
    Put {
        start: RegisterAddress,
        bytes: Vec<u8>,
    },
    Revert {
        start: RegisterAddress,
        count: usize,
    },
    Plan(Box<Change>),
    /// Show the effect of a mounting run. The plain data comes from a profile that is open in another session.
    PlanMounting {
        /// The steps of the run, without the plain data.
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
