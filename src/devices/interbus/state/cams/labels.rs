//! Texts of the cam chart.

use super::{Chart, Lane, OutputState};
use crate::app::Text;
use crate::devices::interbus::profile::{Edge, LONGEST_NAME, Scale, Unit};
use crate::devices::interbus::protocol::{Cam, CamNumber, GearError, Parameter, ProgramNumber, TURNS};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::staged::{EditError, EditFinding};

/// Returns the label of a cam: its number, and its name if it has one.
pub fn cam(lane: &Lane) -> Text {
    match &lane.name {
        Some(name) => TEXTS.text("cams.named").with("cam", lane.cam.get()).with("name", name),
        None => cam_name(lane.cam),
    }
}

pub fn cam_name(cam: CamNumber) -> Text {
    TEXTS.text("cams.cam").with("cam", cam.get())
}

pub fn edge_name(lane: &Lane, edge: Edge) -> Text {
    TEXTS
        .text(match edge {
            Edge::Start => "cams.start_of",
            Edge::Stop => "cams.stop_of",
        })
        .with_text("cam", cam_name(lane.cam))
}

/// Formats a position in steps, followed by the position in the unit of the scale if that is different.
pub fn position(step: u32, scale: &Scale, range: u32) -> Text {
    match scale.unit() {
        Unit::Steps if scale.zero() == 0 => TEXTS.text("cams.steps").with("step", step),
        unit => {
            let text = TEXTS.text("cams.scaled").with("step", step).with("unit", unit.symbol());
            text.with_number("value", scale.value(step, range), scale.decimal_places())
        }
    }
}

/// Formats a number on the ruler.
pub fn tick_label(value: f64, decimals: usize, unit: Unit) -> Text {
    TEXTS.text("cams.tick").with_number("value", value, decimals).with("unit", unit.symbol())
}

pub fn range_text(cam: Cam, scale: &Scale, range: u32) -> Text {
    let (start, stop) = (cam.start.get(), cam.stop.get());
    let text = TEXTS.text(if cam.wraps_around() { "cams.stretch_over" } else { "cams.stretch" });
    let text = text.with_text("start", position(start, scale, range)).with_text("stop", position(stop, scale, range));
    let whole = i64::from(range.max(1));
    text.with("count", (i64::from(stop) - i64::from(start)).rem_euclid(whole) + 1)
}

/// Describes where a cam is on and whether it is active.
pub fn lane_text(own: &Lane, scale: &Scale, range: u32) -> Text {
    let Some(edges) = own.edges else { return TEXTS.text("cams.no_edges") };
    let id = if own.on { "cams.works" } else { "cams.works_not" };
    TEXTS.text(id).with_text("where", range_text(edges, scale, range))
}

pub fn lane_problems(chart: &Chart, lane: &Lane) -> Vec<Text> {
    let beyond = lane.beyond.then(|| TEXTS.text("cams.beyond").with("last", chart.last_position()));
    let clash = lane.clashes.then(|| TEXTS.text("cams.clash").with("name", lane.name.as_deref().unwrap_or_default()));
    beyond.into_iter().chain(clash).collect()
}

/// Describes whether an output is on, and whether the encoder reports a different state.
pub fn output_text(lamp: OutputState) -> Text {
    let state = |on| TEXTS.text(if on { "cams.lamp_on" } else { "cams.lamp_off" });
    match (lamp.own, lamp.simulated) {
        (None, None) => TEXTS.text("cams.lamp_unknown"),
        (Some(own), Some(simulated)) if own != simulated => {
            TEXTS.text("cams.lamp_differs").with_text("own", state(own)).with_text("simulated", state(simulated))
        }
        (Some(own), _) => TEXTS.text("cams.lamp_own").with_text("own", state(own)),
        (None, Some(simulated)) => TEXTS.text("cams.lamp_simulated").with_text("simulated", state(simulated)),
    }
}

/// Returns the messages for the given findings. Cams of one program that are beyond the measuring range share a
/// message.
pub fn describe_findings(marks: &[EditFinding]) -> Vec<Text> {
    let beyond_in = |own: &EditFinding| matches!(own, EditFinding::Beyond { .. }).then(|| own.program()).flatten();
    let mut named = Vec::new();
    let mut texts = Vec::new();
    for own in marks {
        let Some(program) = beyond_in(own) else {
            texts.push(finding_text(own));
            continue;
        };
        if named.contains(&program) {
            continue;
        }
        named.push(program);
        let cams = marks.iter().filter_map(|other| match *other {
            EditFinding::Beyond { program: its, cam, .. } if its == program => Some(cam.get().to_string()),
            _ => None,
        });
        let cams: Vec<String> = cams.collect();
        texts.push(match *own {
            EditFinding::Beyond { last, .. } if cams.len() > 1 => {
                let text = TEXTS.text("cams.mark_beyond_several").with("program", program.get());
                text.with("cams", cams.join(", ")).with("last", last)
            }
            _ => finding_text(own),
        });
    }
    texts
}

fn finding_text(mark: &EditFinding) -> Text {
    let program = |id, program: ProgramNumber| TEXTS.text(id).with("program", program.get());
    match *mark {
        EditFinding::Gear(error) => gear(&error),
        EditFinding::Preset { last } => TEXTS.text("cams.mark_preset").with("last", last),
        EditFinding::Beyond { program: own, cam, last, .. } => {
            program("cams.mark_beyond", own).with("cam", cam.get()).with("last", last)
        }
        EditFinding::Clash { program: own, first, second, at } => {
            let text = program("cams.mark_clash", own).with("first", first.get()).with("second", second.get());
            text.with("at", at)
        }
    }
}

/// Explains why an edit was rejected, and what to do about it.
pub fn edit_error_text(error: &EditError) -> Text {
    let program = |id, program: ProgramNumber| TEXTS.text(id).with("program", program.get());
    match error {
        EditError::NothingRead => TEXTS.text("cams.nothing_read"),
        EditError::NotRead(own) => program("cams.not_read", *own),
        EditError::ShiftNotRead => TEXTS.text("cams.shift_not_read"),
        EditError::NoCam { program: own, cam } => program("cams.no_cam", *own).with("cam", cam.get()),
        EditError::Gear(error) => gear(error),
        EditError::Parameter(error) => {
            let id = match error.parameter {
                Parameter::Preset => "cams.preset_limit",
                _ => "cams.parameter_limit",
            };
            TEXTS.text(id).with("value", error.value).with("low", error.low).with("high", error.high)
        }
        EditError::Edge { edge, to, last } => {
            let id = match edge {
                Edge::Start => "cams.edge_start",
                Edge::Stop => "cams.edge_stop",
            };
            TEXTS.text(id).with("to", to).with("last", last)
        }
        EditError::Beyond { program: own, cam, last } => {
            program("cams.beyond_moved", *own).with("cam", cam.get()).with("last", last)
        }
        EditError::Name => TEXTS.text("cams.long_name").with("most", LONGEST_NAME),
    }
}

pub fn gear(error: &GearError) -> Text {
    match *error {
        GearError::Turns { turns } => TEXTS.text("cams.gear_turns").with("turns", turns).with("most", TURNS),
        GearError::Steps { steps, turns, most } => {
            TEXTS.text("cams.gear_steps").with("steps", steps).with("turns", turns).with("most", most)
        }
    }
}
