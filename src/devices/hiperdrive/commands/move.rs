//! The `move` command, which moves a drive to a position and is the only command that moves a drive. However the motion
//! ends, the drive is stopped and switched off.

use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, NEWEST_ERROR, NUMERATOR, TIMEOUT, UPPER_LIMIT,
};
use crate::devices::hiperdrive::state::TEXTS;

use serde_json::json;

use super::args::MoveArgs;
use super::inspect::error_text;
use super::run::{Runner, drive, value};
use crate::app::Text;
use crate::cli::args::CommonArgs;
use crate::cli::number::parse_number;
use crate::cli::output::Output;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result, Success};
use crate::devices::hiperdrive::jobs::{DriveSnapshot, HiperdriveJob, HiperdriveOutput};
use crate::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionRejection, MotionRequest, Permit, Phase, SpeedTorque, TargetState,
};
use crate::devices::hiperdrive::procedures::{DriveLimits, Identity, MotionLimitParameters};
use crate::devices::hiperdrive::protocol::{DriveNumber, ErrorCode, ParameterNumber, Percent, PositionScale, Value};
use crate::devices::hiperdrive::state::PositionUnit;
use crate::devices::hiperdrive::state::explain;
use crate::result_of;
use crate::units::Moment;

/// Interval for refreshing a motion request.
const MOTION_REFRESH_INTERVAL: Duration = Duration::from_millis(20);
/// Time limit for the stop sequence and for switching off.
const STOP_TIMEOUT: Duration = Duration::from_secs(3);

enum MotionOutcome {
    Ended(ActionEnd),
    Interrupted,
    Late,
}

pub(crate) fn execute_move(common: &CommonArgs, output: &Output, wanted: &MoveArgs) -> Result {
    let target = parse_number(&wanted.target)
        .ok_or_else(|| Failure::Usage(format!("{} is not a position: enter a number of steps", wanted.target)))?;
    if !wanted.yes {
        let what = "this moves the drive: make sure that it may move, and add --yes; nothing was changed";
        return Err(Failure::Usage(what.to_owned()));
    }
    let percent = |percent| Percent::new(percent).unwrap_or(Percent::FULL);
    let effort = SpeedTorque { speed: percent(wanted.speed), torque: percent(wanted.torque) };
    let mut runner = Runner::open(common)?;
    let drive = drive(&wanted.of);
    let identity = result_of!(runner.run(HiperdriveJob::Identify)?, HiperdriveOutput::Identity(identity) => identity);
    let (permit, scale) = read_permit(&mut runner, &identity, drive)?;
    // An impossible target is rejected before the cyclic connection is opened.
    let target = check_target(&permit, target)?;
    permit.check_request(MotionRequest::Move { target, effort }, Some(target)).map_err(rejection_failure)?;
    if let Some((low, high)) = permit.limits {
        output.print_message(&describe_range(drive, target, (low, high), scale));
    }
    result_of!(runner.run(HiperdriveJob::Take)?, HiperdriveOutput::Taken => {});
    let came = run_until_end(
        &runner,
        drive,
        MotionRequest::Move { target, effort },
        Duration::from_secs(wanted.timeout.into()),
    );
    let stood = stop_and_switch_off(&runner, drive);
    // Control is released even if the connection is lost. The loss has already been reported.
    let given = runner.run(HiperdriveJob::Give);
    let position = stood.map(|view| view.actual.position);
    let reached = matches!(came, MotionOutcome::Ended(ActionEnd::Arrived));
    let mut json = json!({"drive": drive.get(), "target": target, "position": position, "reached": reached});
    if reached {
        given?;
        let text = position.map_or_else(String::new, |position| format!("drive {} is at {position}\n", drive.get()));
        output.show(&json, &text)?;
        return Ok(Success::Completed);
    }
    let error = match came {
        MotionOutcome::Ended(ActionEnd::Fault) => read_newest_error(&mut runner, drive),
        _ => None,
    };
    if let (Some(error), Some(object)) = (error, json.as_object_mut()) {
        object.insert("error".to_owned(), json!({"code": error.code(), "text": error_text(error)}));
    }
    output.show(&json, "")?;
    let mut lines = stop_reasons(&came, stood, wanted.timeout);
    lines.extend(error.map(|error| format!("0x{:04X} {}", error.code(), error_text(error))));
    Err(Failure::Failed(lines))
}

/// Reads the error that stopped the drive, if the drive still reports the error.
fn read_newest_error(runner: &mut Runner, drive: DriveNumber) -> Option<ErrorCode> {
    let newest = value(runner, ParameterNumber::for_drive(NEWEST_ERROR, drive)?).ok()?;
    let Value::Number(code) = newest else { return None };
    u16::try_from(code).ok().map(ErrorCode::new).filter(|code| *code != ErrorCode::NONE)
}

/// Describes the target and the limits in the current scale, so that the user notices if the scale has changed.
fn describe_range(drive: DriveNumber, target: i32, (low, high): (i32, i32), scale: Option<PositionScale>) -> String {
    let turns = |steps: i32| match scale {
        Some(scale) => format!("{steps} ({:.2} turns)", f64::from(steps) / scale.steps_per_turn()),
        None => steps.to_string(),
    };
    format!("drive {} moves to {}, within {} to {}", drive.get(), turns(target), turns(low), turns(high))
}

/// Reads the parameters of a drive and returns the resulting motion permit (locks and limits), together with the
/// position scale.
fn read_permit(
    runner: &mut Runner,
    identity: &Identity,
    drive: DriveNumber,
) -> Result<(Permit, Option<PositionScale>)> {
    let variant =
        identity.drive_identity(drive).map_err(|error| to_failure(&explain::device_error_text(&error)))?.variant;
    let mut values = Vec::new();
    for base in [DRIVE_REQUESTED, NUMERATOR, DENOMINATOR, LOWER_LIMIT, UPPER_LIMIT, TIMEOUT] {
        let Some(number) = ParameterNumber::for_drive(base, drive) else { continue };
        if let Value::Number(value) = value(runner, number)? {
            values.push((base, value));
        }
    }
    let rules = MotionLimitParameters::from_parameters(|base| {
        values.iter().find(|(own, _)| *own == base).map(|(_, value)| *value)
    });
    // The parameters have just been read.
    let now = Moment::START;
    let limits = DriveLimits::from_rules(rules, (identity.topology, variant), now);
    Ok((limits.motion_permit(now, false), limits.scale()))
}

/// Checks that a target fits in 32 bits.
fn check_target(permit: &Permit, target: i64) -> Result<i32> {
    let (low, high) = permit.limits.unwrap_or((i32::MIN, i32::MAX));
    i32::try_from(target).map_err(|_| {
        let text = TEXTS.text("hd_refused.outside").with_text("target", steps_text(target));
        to_failure(&text.with_text("low", steps_text(low)).with_text("high", steps_text(high)))
    })
}

fn steps_text(steps: impl Into<i64>) -> Text {
    let unit = TEXTS.text(PositionUnit::Steps.unit());
    TEXTS.text("hd_entry.place").with("value", steps.into()).with_text("unit", unit)
}

fn rejection_failure(refusal: MotionRejection) -> Failure {
    to_failure(&explain::refusal_text(refusal, steps_text))
}

/// Refreshes the motion request until the motion ends, is interrupted, or times out.
fn run_until_end(runner: &Runner, drive: DriveNumber, wish: MotionRequest, patience: Duration) -> MotionOutcome {
    let motion = &runner.context;
    let until = Instant::now() + patience;
    let act = motion.request_motion(drive, wish);
    loop {
        // The Ctrl-C handler has stopped the drive, so the motion is no longer refreshed.
        if runner.is_interrupted() {
            motion.stop();
            return MotionOutcome::Interrupted;
        }
        motion.refresh();
        if let Some(ended) = action_end(runner, drive, act) {
            return if runner.is_interrupted() { MotionOutcome::Interrupted } else { MotionOutcome::Ended(ended) };
        }
        if Instant::now() >= until {
            motion.stop();
            return MotionOutcome::Late;
        }
        sleep(MOTION_REFRESH_INTERVAL);
    }
}

fn action_end(runner: &Runner, drive: DriveNumber, act: u64) -> Option<ActionEnd> {
    let view = runner.context.snapshot();
    let ended = view.drives.iter().find(|own| own.number == drive).and_then(|own| own.ended);
    match ended {
        Some((number, ended)) if number >= act => Some(ended),
        _ if !view.open => Some(ActionEnd::Lost),
        _ => None,
    }
}

/// Stops the drive, switches it off, and returns its last known state.
fn stop_and_switch_off(runner: &Runner, drive: DriveNumber) -> Option<DriveSnapshot> {
    let motion = &runner.context;
    let find = || motion.snapshot().drives.into_iter().find(|own| own.number == drive);
    let until = Instant::now() + STOP_TIMEOUT;
    while motion.is_open() && Instant::now() < until && find().is_some_and(|own| own.phase != Phase::Idle) {
        motion.refresh();
        sleep(MOTION_REFRESH_INTERVAL);
    }
    let stood = find();
    let act = motion.request_motion(drive, MotionRequest::Lead(TargetState::Off));
    while action_end(runner, drive, act).is_none() && Instant::now() < until {
        motion.refresh();
        sleep(MOTION_REFRESH_INTERVAL);
    }
    // The position is unknown without a report from the drive.
    stood.filter(|own| own.actual.status.is_present())
}

fn stop_reasons(came: &MotionOutcome, stood: Option<DriveSnapshot>, seconds: u16) -> Vec<String> {
    let first = match came {
        MotionOutcome::Ended(ended) => explain::end_text(*ended, steps_text).terminal_text(),
        MotionOutcome::Interrupted => "Interrupted: the drive was stopped.".to_owned(),
        MotionOutcome::Late => format!(
            "The drive did not reach its target within {seconds} s and was stopped. Use --timeout to allow more \
             time."
        ),
    };
    let place = match stood {
        Some(own) => format!("Drive {} is at {}.", own.number.get(), own.actual.position),
        None => "The position of the drive is not known.".to_owned(),
    };
    vec![first, place]
}
