//! Runs jobs on an adapter or a hub with its drives.

use std::thread::sleep;
use std::time::{Duration, Instant};

use super::HiperdriveCommands;
use super::args::DriveOption;
use crate::app::TypeMap;
use crate::cli::Result;
use crate::cli::commands::DeviceCommands;
use crate::cli::output::write_stderr;
use crate::cli::runner::{self, CliDevice};
use crate::cli::slow_reply_notice::ReplyTiming;
use crate::devices::hiperdrive::jobs::{DeviceMessage, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobStep, Motion};
use crate::devices::hiperdrive::procedures::Station;
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Value};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::result_of;
use crate::worker::Session;

/// Time to wait for the drives to stop. It is several times the longest send interval, so that a stop word is sent
/// before the program ends.
const STOP_TIME: Duration = Duration::from_millis(500);
/// Time to wait until the drives are switched off and the connection is closed.
const RELEASE_TIME: Duration = Duration::from_secs(1);
const CHECK_INTERVAL: Duration = Duration::from_millis(1);

pub(super) type Runner = runner::Runner<Hiperdrive>;

impl CliDevice for Hiperdrive {
    type Context = Motion;
    const COMMANDS: &'static dyn DeviceCommands = &HiperdriveCommands;

    fn prepare_context(session: &mut Session<Self>, _given: &TypeMap) -> Motion {
        session.motion()
    }

    fn print_message(remark: &DeviceMessage) {
        match remark {
            DeviceMessage::ControlLost => {
                write_stderr(&format!("{}\n", TEXTS.text("hd_cli.control_lost").terminal_text()))
            }
            DeviceMessage::RulesUnread(error) => {
                let why = explain::device_error_text(error).terminal_text();
                write_stderr(&format!("{} {why}\n", TEXTS.text("hd_end.rules").terminal_text()));
            }
            DeviceMessage::RulesRead => {}
        }
    }

    fn describe_step(doing: &JobStep) -> String {
        doing.to_string()
    }

    fn reply_times(session: &Session<Self>) -> Option<ReplyTiming> {
        let station = session.station();
        Some(ReplyTiming {
            replies: station.replies(),
            timeout: station.link.timeout,
            longest: Station::LONGEST_TIMEOUT,
        })
    }

    /// Stops the motion and waits for standstill. If the program is about to exit, also waits until the drives are
    /// switched off and released.
    fn interrupt_handler(motion: &Motion) -> Box<dyn Fn(bool) + Send> {
        let motion = motion.clone();
        Box::new(move |again| {
            motion.stop();
            let until = Instant::now() + STOP_TIME;
            while !motion.is_at_rest() && Instant::now() < until {
                sleep(CHECK_INTERVAL);
            }
            if again {
                motion.release_drives();
                let until = Instant::now() + RELEASE_TIME;
                while motion.is_connected() && Instant::now() < until {
                    sleep(CHECK_INTERVAL);
                }
            }
        })
    }
}

pub(super) fn value(runner: &mut Runner, number: ParameterNumber) -> Result<Value> {
    Ok(result_of!(runner.run(HiperdriveJob::Read(number))?, HiperdriveOutput::Value(_, value) => value))
}

/// Returns the drive selected by the user, or the first drive by default.
pub(super) fn drive(of: &DriveOption) -> DriveNumber {
    of.drive.and_then(DriveNumber::new).unwrap_or(DriveNumber::FIRST)
}
