//! Messages about motion: why a drive may not move, why a request was rejected, and how a motion ended.

use super::names::{parameter_name_text, state_text};
use crate::app::explain::link_error_text;
use crate::app::{Severity, Text};
use crate::devices::hiperdrive::jobs::MotionSnapshot;
use crate::devices::hiperdrive::procedures::cyclic::{ConnectionLoss, ParameterReading, ParameterResult};
use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionLock, MotionRejection, Phase, TargetState};
use crate::devices::hiperdrive::protocol::{ParameterNumber, State};
use crate::devices::hiperdrive::state::TEXTS;

/// Explains why motion is locked and what to do.
pub fn lock_text(lock: MotionLock) -> Text {
    TEXTS.text(match lock {
        MotionLock::Unread => "hd_lock.unread",
        MotionLock::NoTimeout => "hd_lock.no_timeout",
        MotionLock::LimitsUnconfirmed => "hd_lock.limits",
        MotionLock::NotRequested => "hd_lock.not_requested",
        MotionLock::Outdated => "hd_lock.old",
        MotionLock::NoAnswer => "hd_lock.no_answer",
    })
}

/// Explains why a request was rejected and what to do. `place` formats a position in the user's unit.
pub fn refusal_text(refusal: MotionRejection, place: impl Fn(i32) -> Text) -> Text {
    match refusal {
        MotionRejection::Locked(own) => lock_text(own),
        MotionRejection::NoEffort => TEXTS.text("hd_refused.no_effort"),
        MotionRejection::Outside { target, low, high } => TEXTS
            .text("hd_refused.outside")
            .with_text("target", place(target))
            .with_text("low", place(low))
            .with_text("high", place(high)),
        MotionRejection::Outward { position, low, high } => TEXTS
            .text("hd_refused.outward")
            .with_text("position", place(position))
            .with_text("low", place(low))
            .with_text("high", place(high)),
        MotionRejection::Unclear { position, low, high } => TEXTS
            .text("hd_refused.unclear")
            .with_text("position", place(position))
            .with_text("low", place(low))
            .with_text("high", place(high)),
        MotionRejection::Endless => TEXTS.text("hd_refused.endless"),
        MotionRejection::Fault => TEXTS.text("hd_refused.fault"),
        MotionRejection::SwitchOnLock => TEXTS.text("hd_refused.lock"),
        MotionRejection::NothingToPause => TEXTS.text("hd_refused.nothing_to_pause"),
        MotionRejection::NothingToResume => TEXTS.text("hd_refused.nothing_to_resume"),
        MotionRejection::Absent => TEXTS.text("hd_refused.absent"),
    }
}

/// Describes how an action ended and, if it failed, what to do.
pub fn end_text(ended: ActionEnd, place: impl Fn(i32) -> Text) -> Text {
    match ended {
        ActionEnd::Done => TEXTS.text("hd_end.done"),
        ActionEnd::Arrived => TEXTS.text("hd_end.arrived"),
        ActionEnd::RangeEnd => TEXTS.text("hd_end.range_end"),
        ActionEnd::Stopped => TEXTS.text("hd_end.stopped"),
        ActionEnd::Replaced => TEXTS.text("hd_end.replaced"),
        ActionEnd::Stale => TEXTS.text("hd_end.stale"),
        ActionEnd::Deaf => TEXTS.text("hd_end.deaf"),
        ActionEnd::Lost => TEXTS.text("hd_end.lost"),
        ActionEnd::Fault => TEXTS.text("hd_end.fault"),
        ActionEnd::Locked(own) => lock_text(own),
        ActionEnd::Refused(why) => refusal_text(why, place),
        ActionEnd::NoAnswer(own) => TEXTS.text("hd_end.no_answer").with_text("state", state_text(own)),
        ActionEnd::NotStarted => TEXTS.text("hd_end.not_started"),
        ActionEnd::Left(own) => TEXTS.text("hd_end.left").with_text("state", state_text(own)),
        ActionEnd::Short => TEXTS.text("hd_end.short"),
        ActionEnd::Beyond { position } => TEXTS.text("hd_end.beyond").with_text("position", place(position)),
        ActionEnd::WrongWay { position } => TEXTS.text("hd_end.wrong_way").with_text("position", place(position)),
    }
}

/// Message IDs for motions that failed without preventing the next one. The notices are removed when the next motion
/// starts.
pub const MOTION_ENDS: [&str; 9] = [
    "hd_end.range_end",
    "hd_end.stale",
    "hd_end.deaf",
    "hd_end.no_answer",
    "hd_end.not_started",
    "hd_end.left",
    "hd_end.short",
    "hd_end.beyond",
    "hd_end.wrong_way",
];

pub const fn end_severity(ended: ActionEnd) -> Severity {
    match ended {
        ActionEnd::Done | ActionEnd::Arrived | ActionEnd::Stopped | ActionEnd::Replaced => Severity::Note,
        ActionEnd::RangeEnd | ActionEnd::Refused(_) | ActionEnd::Locked(_) | ActionEnd::Short => Severity::Warning,
        ActionEnd::Stale
        | ActionEnd::Deaf
        | ActionEnd::Lost
        | ActionEnd::Fault
        | ActionEnd::NoAnswer(_)
        | ActionEnd::NotStarted
        | ActionEnd::Left(_)
        | ActionEnd::Beyond { .. }
        | ActionEnd::WrongWay { .. } => Severity::Error,
    }
}

pub fn target_state_text(goal: TargetState) -> Text {
    state_text(match goal {
        TargetState::Off => State::NotReady,
        TargetState::Ready => State::Ready,
        TargetState::Operational => State::Operational,
        TargetState::Enabled => State::Enabled,
    })
}

pub fn phase_text(phase: Phase) -> Text {
    match phase {
        Phase::Idle => TEXTS.text("hd_phase.idle"),
        Phase::Leading(own) => TEXTS.text("hd_phase.leading").with_text("goal", target_state_text(own)),
        Phase::Starting(_) => TEXTS.text("hd_phase.starting"),
        Phase::Moving(_) => TEXTS.text("hd_phase.moving"),
        Phase::Paused { .. } => TEXTS.text("hd_phase.paused"),
        Phase::Stopping(_) => TEXTS.text("hd_phase.stopping"),
    }
}

/// Message IDs used by [`cyclic_loss_text`]. The notices are removed when control is taken again.
pub const CONNECTION_LOSS_IDS: [&str; 6] =
    ["hd_lost.silent", "hd_lost.port", "hd_lost.does_not_stand", "hd_lost.session", "hd_lost.failed", "hd_end.lost"];

/// Explains why the cyclic connection was lost and what to do.
pub fn cyclic_loss_text(lost: Option<&ConnectionLoss>) -> Text {
    match lost {
        Some(ConnectionLoss::Silent { after }) => TEXTS.text("hd_lost.silent").with("milliseconds", after.as_millis()),
        Some(ConnectionLoss::Port(error)) => TEXTS.text("hd_lost.port").with_text("why", link_error_text(error)),
        Some(ConnectionLoss::DoesNotStand(drive)) => TEXTS.text("hd_lost.does_not_stand").with("drive", drive.get()),
        Some(ConnectionLoss::Session) => TEXTS.text("hd_lost.session"),
        Some(ConnectionLoss::Failed) => TEXTS.text("hd_lost.failed"),
        None => TEXTS.text("hd_end.lost"),
    }
}

/// Describes the values that are read through the parameter words of the cyclic connection.
pub fn parameter_words(view: &MotionSnapshot) -> Text {
    let Some(readings) = &view.parameters else { return TEXTS.text("hd_link.words_absent") };
    if readings.is_empty() {
        return TEXTS.text("hd_link.words_idle");
    }
    let texts: Vec<Text> =
        readings.iter().filter_map(|(number, reading)| parameter_reading(*number, reading)).collect();
    if texts.is_empty() {
        return TEXTS.text("hd_link.words_silent");
    }
    TEXTS.text("hd_link.words_read").with_list("readings", texts)
}

fn parameter_reading(number: ParameterNumber, reading: &ParameterReading) -> Option<Text> {
    let unit = number.row().map_or("", |row| row.unit);
    match reading.result {
        ParameterResult::Number(value) => {
            let text = TEXTS.text("hd_link.words_value").with_text("parameter", parameter_name_text(number));
            Some(text.with("value", value).with("unit", unit))
        }
        ParameterResult::Refused(why) => {
            let text = TEXTS.text("hd_link.words_refused").with_text("parameter", parameter_name_text(number));
            Some(text.with("code", why.code()))
        }
        ParameterResult::NoReply => None,
    }
}
