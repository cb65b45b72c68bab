//! Actions of the BiSS encoder on display.

use std::path::PathBuf;

use crate::app::DeviceAction;
use crate::app::studio::SessionId;
use crate::devices::biss::jobs::Change;
use crate::devices::biss::procedures::procedure::{Answer, Task};
use crate::devices::biss::profile::{MotorSource, MountingSteps};
use crate::devices::biss::protocol::{Register, RegisterAddress};

pub enum BissAction {
    /// Reads errors, warnings, temperature and device mode.
    ReadStatus,
    Check,
    /// Starts or stops reading the given register along with the position.
    Watch(Box<Register>, bool),
    /// Reads a bank, or the direct registers for `None`.
    ReadBank(Option<u8>),
    /// Reads a newly visible bank that has never been read, unless another job is running.
    SeeBank(Option<u8>),
    /// Reads the plain data area that starts at the given bank.
    ReadArea(u8),
    /// Edits bytes of plain data.
    Put {
        start: RegisterAddress,
        bytes: Vec<u8>,
    },
    Revert {
        start: RegisterAddress,
        count: usize,
    },
    Plan(Box<Change>),
    /// Plans a mounting run and shows its effect. The plain data comes from a profile that is open in another session.
    PlanMounting {
        /// Steps of the run, without the plain data.
        run: Box<MountingSteps>,
        motor: MotorSource,
        data: Option<SessionId>,
    },
    Answer(Task, Answer),
    CloseGuide,
    LeadBack,
    /// Turns the virtual encoder's shaft at a speed in revolutions per minute.
    Turn(f64),
    Save(PathBuf),
}

impl DeviceAction for BissAction {}
