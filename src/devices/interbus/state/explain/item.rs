//! Names of items as part of a sentence.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::interbus::profile::{Direction, Edge};
use crate::devices::interbus::protocol::{CamNumber, Parameter, ReadOutNumber, StartupMode};
use crate::devices::interbus::state::TEXTS;

pub fn parameter_text(parameter: Parameter) -> Text {
    TEXTS.text(match parameter {
        Parameter::Steps => "ib_item.steps",
        Parameter::Turns => "ib_item.revolutions",
        Parameter::Direction => "ib_item.direction",
        Parameter::Preset => "ib_item.preset",
        Parameter::ZeroShift => "ib_item.zero_shift",
        Parameter::Default => "ib_item.default",
    })
}

/// Formats the value of a parameter. A direction is written as a word.
pub(super) fn parameter_value_text(parameter: Parameter, number: u32) -> Text {
    match Direction::from_code(number) {
        Some(own) if parameter == Parameter::Direction => direction_text(own),
        _ => literal_text(number),
    }
}

pub fn direction_text(direction: Direction) -> Text {
    TEXTS.text(match direction {
        Direction::Clockwise => "ib_item.clockwise",
        Direction::Counterclockwise => "ib_item.counterclockwise",
    })
}

pub fn cam_mask_text(mask: u8) -> Text {
    let on: Vec<String> =
        CamNumber::all().map(CamNumber::get).filter(|cam| mask >> cam & 1 != 0).map(|cam| cam.to_string()).collect();
    if on.is_empty() { TEXTS.text("ib_item.no_cam") } else { literal_text(on.join(", ")) }
}

pub(super) fn edge_text(cam: CamNumber, edge: Edge) -> Text {
    TEXTS
        .text(match edge {
            Edge::Start => "ib_item.start",
            Edge::Stop => "ib_item.stop",
        })
        .with("cam", cam.get())
}

pub fn startup_mode_text(mode: StartupMode) -> Text {
    match mode {
        StartupMode::K2 => TEXTS.text("ib_startup.k2"),
        StartupMode::K3 => TEXTS.text("ib_startup.k3"),
        StartupMode::Velocity => TEXTS.text("ib_startup.velocity"),
        StartupMode::Cams(program) => TEXTS.text("ib_startup.program").with("program", program.get()),
        StartupMode::Unknown(value) => TEXTS.text("ib_startup.unknown").with("code", value.get()),
    }
}

pub fn read_out(read_out: ReadOutNumber) -> Text {
    match (read_out.to_u16(), read_out.register()) {
        (_, Some(register)) => TEXTS.text("ib_doing.chip").with("register", register),
        (0x0, _) => TEXTS.text("ib_doing.serial"),
        (0x1, _) => TEXTS.text("ib_item.steps"),
        (0x2, _) => TEXTS.text("ib_item.revolutions"),
        (0x3, _) => TEXTS.text("ib_item.direction"),
        (0x4, _) => TEXTS.text("ib_item.preset"),
        (0x5, _) => TEXTS.text("ib_item.zero_shift"),
        (0x6, _) => TEXTS.text("ib_doing.preset_flag"),
        (0x7, _) => TEXTS.text("ib_doing.version"),
        (0x8, _) => TEXTS.text("ib_doing.time"),
        (0x9, _) => TEXTS.text("ib_doing.mode"),
        (0xA, _) => TEXTS.text("ib_doing.flags"),
        (0xC, _) => TEXTS.text("ib_doing.temperature"),
        (number, _) => TEXTS.text("ib_doing.other").with("number", format!("0x{number:X}")),
    }
}
