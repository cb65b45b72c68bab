//! Running jobs on an adapter or a hub with its drives.

use crate::app::{Text, explain};
use crate::cli::Result;
use crate::cli::args::{Code, OfDrive};
use crate::cli::output::say;
use crate::cli::runner::{self, Runs, unexpected};
use crate::link::LinkUrl;
use crate::protocol::hiperdrive::{DriveNumber, ParameterNumber, Value};
use crate::store::Store;
use crate::worker::hiperdrive::{Doing, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobError, Motion, Remark, open};
use crate::worker::{OpenError, Session};

/// A session with an adapter or a hub on its thread.
pub(super) type Runner = runner::Runner<Hiperdrive>;

impl Runs for Hiperdrive {
    type Kept = Motion;
    const HAS_CODES: bool = false;

    fn open(url: &LinkUrl, store: Store) -> std::result::Result<Session<Self>, OpenError> {
        open(url, store)
    }

    /// Access codes of the environment are for other devices.
    fn begin(session: &mut Session<Self>, _codes: Vec<Code>) -> Motion {
        session.motion()
    }

    fn say(remark: &Remark) {
        match remark {
            Remark::ControlLost => say(&format!("{}\n", Text::new("hd_cli.control_lost").terminal())),
        }
    }

    fn doing(doing: &Doing) -> String {
        doing.to_string()
    }

    fn failure(error: &JobError) -> Vec<Text> {
        explain::hiperdrive::job(error)
    }
}

/// Reads a parameter.
pub(super) fn value(runner: &mut Runner, number: ParameterNumber) -> Result<Value> {
    match runner.run(HiperdriveJob::Read(number))? {
        HiperdriveOutput::Value(_, value) => Ok(value),
        other => Err(unexpected(&other)),
    }
}

/// The drive that is meant: the first, where none is named.
pub(super) fn drive(of: &OfDrive) -> DriveNumber {
    of.drive.and_then(DriveNumber::new).unwrap_or(DriveNumber::FIRST)
}
