//! Labels and messages for the steps of the axis set-up: names, tasks and findings.

use super::{Axis, AxisChange, AxisStep, DriveFacts, Outcome, Power, RestartEvidence, StepStatus, TestTarget};
use crate::app::Text;
use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, SpeedTorque};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{ErrorCode, ScaleError};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::devices::hiperdrive::state::ruler::{PositionUnit, Ruler};

pub fn title(step: AxisStep) -> Text {
    TEXTS.text(match step {
        AxisStep::Request => "hd_axis.step_request",
        AxisStep::Scale => "hd_axis.step_scale",
        AxisStep::Confirm => "hd_axis.step_confirm",
        AxisStep::Jog => "hd_axis.step_jog",
        AxisStep::Reference => "hd_axis.step_reference",
        AxisStep::Lower => "hd_axis.step_lower",
        AxisStep::Upper => "hd_axis.step_upper",
        AxisStep::Test => "hd_axis.step_test",
        AxisStep::Save => "hd_axis.step_save",
        AxisStep::PowerCycle => "hd_axis.step_power",
    })
}

pub fn step_instructions(step: AxisStep, seen: &DriveFacts) -> Text {
    TEXTS.text(match step {
        AxisStep::Request => "hd_axis.do_request",
        AxisStep::Scale => "hd_axis.do_scale",
        AxisStep::Confirm => "hd_axis.do_confirm",
        AxisStep::Jog => "hd_axis.do_jog",
        AxisStep::Reference => "hd_axis.do_reference",
        AxisStep::Lower => "hd_axis.do_lower",
        AxisStep::Upper => "hd_axis.do_upper",
        AxisStep::Test => "hd_axis.do_test",
        AxisStep::Save => "hd_axis.do_save",
        AxisStep::PowerCycle if seen.is_virtual => "hd_axis.do_power_virtual",
        AxisStep::PowerCycle => "hd_axis.do_power",
    })
}

pub fn step_status(own: StepStatus) -> Text {
    TEXTS.text(match own {
        StepStatus::Done => "guide.done",
        StepStatus::Now => "guide.waits",
        StepStatus::Skipped => "guide.left_out",
        StepStatus::Failed => "guide.failed",
        StepStatus::Ahead => "guide.ahead",
    })
}

pub fn button_label(step: AxisStep) -> Text {
    TEXTS.text(match step {
        AxisStep::Request => "hd_axis.request",
        AxisStep::Reference => "hd_axis.set",
        AxisStep::Save => "hd_axis.save",
        AxisStep::PowerCycle => "hd_axis.mark",
        _ => "hd_axis.write",
    })
}

pub fn finding_text(axis: &Axis, step: AxisStep, seen: &DriveFacts) -> Option<Text> {
    let ruler = seen.ruler();
    let mm = |steps: i32| millimetres_text(ruler, steps.into());
    match step {
        AxisStep::Request => match (seen.requested?, seen.actual.map(|own| own.status.is_present())) {
            (true, Some(true)) => Some(TEXTS.text("hd_axis.found_drive")),
            (true, Some(false)) => Some(TEXTS.text("hd_axis.found_no_drive")),
            // Without data from the drive, nothing is known about its cable.
            (true, None) => None,
            (false, _) => Some(TEXTS.text("hd_axis.found_unrequested")),
        },
        AxisStep::Scale => {
            let ruler = ruler?;
            let text = TEXTS.text("hd_axis.found_scale").with("numerator", ruler.scale.numerator());
            let text = text.with("denominator", ruler.scale.denominator());
            let per_turn = ruler.scale.steps_per_turn();
            let decimals = if per_turn.fract() == 0.0 { 0 } else { 3 };
            Some(text.with_number("steps", per_turn, decimals))
        }
        AxisStep::Confirm | AxisStep::Upper => {
            // Confirmed limits remain displayed, even after other limits were taught.
            let confirmed = axis.confirmed.filter(|_| step == AxisStep::Confirm).map(|own| own.seen);
            let (low, high) = confirmed.or(seen.limits)?;
            Some(TEXTS.text("hd_axis.found_limits").with_text("low", mm(low)).with_text("high", mm(high)))
        }
        AxisStep::Jog => {
            let travel = axis.travel();
            let way = TEXTS.text(match travel.clockwise_is_up {
                Some(true) => "hd_axis.clockwise_up",
                Some(false) => "hd_axis.clockwise_down",
                None => return (travel.up + travel.down > 0).then(|| travel_text(ruler, travel.up, travel.down)),
            });
            let moved = travel_text(ruler, travel.up, travel.down);
            Some(TEXTS.text("hd_axis.found_jog").with_text("moved", moved).with_text("way", way))
        }
        AxisStep::Reference => {
            Some(TEXTS.text("hd_axis.found_reference").with_text("position", mm(axis.reference_position()?)))
        }
        AxisStep::Lower => {
            Some(TEXTS.text("hd_axis.found_lower").with_text("position", mm(axis.entries.lower_limit(ruler).ok()?)))
        }
        AxisStep::Test => {
            let good =
                TestTarget::ALL.into_iter().filter_map(|place| axis.test_outcome(place)).filter(Outcome::is_good);
            let worst = good.clone().map(|own| own.position_deviation().abs()).max()?;
            let text = TEXTS.text("hd_axis.found_test").with("count", good.count());
            Some(text.with_text("missed", millimetres_text(ruler, worst)))
        }
        AxisStep::Save => axis.is_saved().then(|| TEXTS.text("hd_axis.found_saved")),
        AxisStep::PowerCycle => power_text(axis, ruler),
    }
}

fn travel_text(ruler: Option<Ruler>, up: i64, down: i64) -> Text {
    let text = TEXTS.text("hd_axis.found_moved").with_text("up", millimetres_text(ruler, up));
    text.with_text("down", millimetres_text(ruler, down))
}

fn power_text(axis: &Axis, ruler: Option<Ruler>) -> Option<Text> {
    let (kept, moved, allowed, restart) = match axis.power()? {
        Power::On(_) => return Some(TEXTS.text("hd_axis.power_on")),
        Power::Gone(_) => return Some(TEXTS.text("hd_axis.power_gone")),
        Power::Back { kept, moved, allowed, restart, .. } => (kept, moved, allowed, restart),
    };
    let proof = TEXTS.text(match restart {
        RestartEvidence::Read => "hd_axis.restart_read",
        RestartEvidence::Switched => "hd_axis.restart_switched",
        RestartEvidence::ClaimedByUser => "hd_axis.restart_said",
        RestartEvidence::Unproven => "hd_axis.restart_unproven",
        RestartEvidence::Disproved => "hd_axis.not_restarted",
    });
    let Some(moved) = moved else { return Some(TEXTS.text("hd_axis.power_unknown")) };
    let id = match (kept, moved.abs() <= allowed) {
        (false, _) => "hd_axis.power_lost",
        (true, false) => "hd_axis.power_moved",
        (true, true) => "hd_axis.power_kept",
    };
    let text = TEXTS.text(id).with_text("moved", millimetres_text(ruler, moved));
    Some(text.with_text("allowed", millimetres_text(ruler, allowed)).with_text("restart", proof))
}

pub fn invalidated_step(step: AxisStep) -> Text {
    let why = TEXTS.text(match step {
        AxisStep::Request => "hd_axis.fell_request",
        AxisStep::Scale => "hd_axis.fell_scale",
        AxisStep::Confirm => "hd_axis.fell_confirm",
        AxisStep::Reference => "hd_axis.fell_reference",
        AxisStep::Upper => "hd_axis.fell_limits",
        AxisStep::Jog | AxisStep::Lower | AxisStep::Test | AxisStep::Save | AxisStep::PowerCycle => {
            "hd_axis.fell_undone"
        }
    });
    let text = TEXTS.text("hd_axis.fallen").with("number", step.index() + 1);
    text.with_text("step", title(step)).with_text("why", why)
}

/// Describes the fault of the drive, with its code if known. Returns `None` if there is no fault.
pub fn fault_text(seen: &DriveFacts) -> Option<Text> {
    if !seen.has_failed() {
        return None;
    }
    let Some(code) = seen.error.filter(|code| *code != ErrorCode::NONE) else {
        return Some(TEXTS.text("hd_axis.fault_unread"));
    };
    let words = explain::error_code_explanation(code);
    let text = TEXTS.text("hd_axis.fault").with("code", format!("{:04X}", code.code()));
    Some(text.with_text("name", words.name).with_text("remedy", words.remedy))
}

/// Describes the speed and torque of the jog buttons and the test moves.
pub fn speed_torque_text(id: &'static str) -> Text {
    let SpeedTorque { speed, torque } = SpeedTorque::DEFAULT_JOG;
    TEXTS.text(id).with("speed", speed.get()).with("torque", torque.get())
}

pub fn outcome_text(outcome: &Outcome, seen: &DriveFacts) -> Text {
    let mm = |steps: i64| millimetres_text(seen.ruler(), steps);
    if outcome.ended == ActionEnd::Arrived {
        let text = TEXTS.text("hd_axis.arrived").with_text("position", mm(outcome.position.into()));
        return text.with_text("missed", mm(outcome.position_deviation()));
    }
    let why = explain::end_text(outcome.ended, |steps| mm(steps.into()));
    TEXTS.text("hd_axis.not_arrived").with_text("position", mm(outcome.position.into())).with_text("why", why)
}

/// Lists the values that are known to differ from the saved values. Returns `None` if there are none.
pub fn differences(seen: &DriveFacts) -> Option<Text> {
    let difference = |own: super::differences::Difference| {
        let id = if own.number == REFERENCE { "hd_axis.differs_place" } else { "hd_axis.differs" };
        TEXTS.text(id).with("number", own.number).with("now", own.now).with("saved", own.saved)
    };
    let all: Vec<Text> = seen.differences().into_iter().map(difference).collect();
    (!all.is_empty()).then(|| TEXTS.text("hd_axis.unsaved").with_list("differences", all))
}

/// Describes how many values were written back. Returns `None` if there were none.
pub fn write_back_text(axis: &Axis, seen: &DriveFacts) -> Option<Text> {
    if axis.returned.is_empty() {
        return None;
    }
    let is_there = |(number, value): &&(u16, i64)| seen.values.get(number) == Some(value);
    let good = axis.returned.iter().filter(is_there).count();
    let text = TEXTS.text("hd_axis.returned").with("count", good);
    Some(text.with("all", axis.returned.len()))
}

/// Returns a message if parameters were written back but the position must still be set.
pub fn unrestored_position_text(axis: &Axis, seen: &DriveFacts) -> Option<Text> {
    let is_set = axis.changes().iter().any(|own| matches!(own, AxisChange::Position(_)));
    let is_left = !axis.returned.is_empty() && (is_set || super::differences::is_position_different(seen));
    is_left.then(|| TEXTS.text("hd_axis.place_left"))
}

/// Returns a message if the position has changed unobserved since the reference was set.
pub fn unexplained_change_text(axis: &Axis, seen: &DriveFacts) -> Option<Text> {
    let way = axis.unexplained?;
    Some(TEXTS.text("hd_axis.unexplained").with_text("way", millimetres_text(seen.ruler(), way)))
}

pub fn target_text(place: TestTarget) -> Text {
    TEXTS.text(match place {
        TestTarget::Middle => "hd_axis.middle",
        TestTarget::Lower => "hd_axis.to_lower",
        TestTarget::Upper => "hd_axis.to_upper",
    })
}

/// Lists the changes made. A parameter that was written more than once is listed with its last value.
pub fn changes_text(axis: &Axis) -> Text {
    let number = |own: &AxisChange| match own {
        AxisChange::Parameter(number, _) => *number,
        AxisChange::Position(_) => REFERENCE,
    };
    let all = axis.changes();
    let is_last = |(at, own): &(usize, &AxisChange)| !all.iter().skip(at + 1).any(|later| number(later) == number(own));
    let last = all.iter().enumerate().filter(is_last);
    TEXTS.text("hd_axis.was_written").with_list("changes", last.map(|(_, own)| change_text(own)))
}

fn change_text(own: &AxisChange) -> Text {
    let text = TEXTS.text("hd_axis.changed");
    match own {
        AxisChange::Parameter(number, value) => text.with("number", number).with("value", value),
        AxisChange::Position(steps) => text.with("number", REFERENCE).with("value", steps),
    }
}

/// Formats steps in millimetres, with enough decimals to distinguish adjacent steps. If the spindle is unknown, the
/// result is in steps.
pub fn millimetres_text(ruler: Option<Ruler>, steps: i64) -> Text {
    match ruler.and_then(|ruler| Some((ruler.from_steps(steps, PositionUnit::Millimetres)?, ruler))) {
        Some((value, ruler)) => {
            let decimals = ruler.decimal_places(PositionUnit::Millimetres).min(4);
            TEXTS.text("hd_axis.millimetres").with_number("value", value, decimals)
        }
        None => TEXTS.text("hd_axis.steps").with("value", steps),
    }
}

pub fn scale(error: &ScaleError) -> Text {
    match error {
        ScaleError::TooFine { steps, .. } => TEXTS.text("hd_axis.too_fine").with("steps", steps),
        ScaleError::Zero | ScaleError::NoLength => TEXTS.text("hd_axis.no_length"),
    }
}
