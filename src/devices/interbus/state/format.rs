//! Names of parameters, values, modes, LEDs and jobs of an INTERBUS encoder.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::interbus::profile::Direction;
use crate::devices::interbus::protocol::{
    EncoderMode, Flags, Interface, LedRow, Parameter, ReadOutNumber, ReadOutValue, Value,
};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain::{direction_text, startup_mode_text};

pub fn parameter(parameter: Parameter) -> Text {
    TEXTS.text(match parameter {
        Parameter::Steps => "ib_parameter.steps",
        Parameter::Turns => "ib_parameter.turns",
        Parameter::Direction => "ib_parameter.direction",
        Parameter::Preset => "ib_parameter.preset",
        Parameter::ZeroShift => "ib_parameter.zero_shift",
        Parameter::Default => "ib_parameter.default",
    })
}

pub fn setting(parameter: Parameter, number: u32) -> Text {
    match (parameter, Direction::from_code(number)) {
        (Parameter::Direction, Some(own)) => direction_text(own),
        _ => literal_text(number),
    }
}

/// Returns the name of a mode as part of a sentence.
pub fn mode(mode: EncoderMode) -> Text {
    TEXTS.text(match mode {
        EncoderMode::Position => "ib_mode.position",
        EncoderMode::Parameterisation => "ib_mode.parameterisation",
        EncoderMode::ReadOut => "ib_mode.read_out",
        EncoderMode::Velocity => "ib_mode.velocity",
        EncoderMode::Cam => "ib_mode.cam",
    })
}

pub fn read_out_value(value: ReadOutValue) -> Text {
    match value {
        ReadOutValue::Plain(number) => literal_text(format!("{number} (0x{number:X})")),
        ReadOutValue::Minutes(minutes) => TEXTS.text("ib_read_out.minutes").with("minutes", minutes).with_number(
            "hours",
            f64::from(minutes) / 60.0,
            1,
        ),
        ReadOutValue::TenthsOfDegree(tenths) => temperature_text(tenths),
        ReadOutValue::StartupMode(own) => startup_mode_text(own),
        ReadOutValue::Flags(own) => flags_text(own),
    }
}

/// Formats a temperature that is given in tenths of a degree Celsius.
pub fn temperature_text(tenths: i32) -> Text {
    TEXTS.text("ib_read_out.celsius").with_number("celsius", f64::from(tenths) / 10.0, 1)
}

pub fn flags_text(flags: Flags) -> Text {
    let turns = TEXTS.text(if flags.counts_turns() { "ib_flags.multiturn" } else { "ib_flags.single_turn" });
    let mut all = vec![turns];
    if flags.steps_minus_one() {
        all.push(TEXTS.text("ib_flags.steps_minus_one"));
    }
    if flags.unknown_bits() != 0 {
        all.push(TEXTS.text("ib_flags.unknown").with("bits", format!("0x{:X}", flags.unknown_bits())));
    }
    TEXTS.text("ib_flags.all").with_list("flags", all)
}

/// Returns the meaning of an LED combination and a remedy.
pub fn led_labels(row: &LedRow) -> (Text, Text) {
    use crate::devices::interbus::protocol::LedState::{Blinking, On};
    let (meaning, remedy) = match (row.leds.ba, row.leds.rbda) {
        (On, _) => ("ib_leds.run", "ib_leds.run_remedy"),
        (Blinking, _) => ("ib_leds.configured", "ib_leds.configured_remedy"),
        (_, On) => ("ib_leds.bus_error", "ib_leds.bus_error_remedy"),
        _ => ("ib_leds.no_run", "ib_leds.no_run_remedy"),
    };
    (TEXTS.text(meaning), TEXTS.text(remedy))
}

pub fn interface(interface: Interface) -> Text {
    TEXTS.text(match interface {
        Interface::Standard => "ib_id.standard",
        Interface::OpticalFibre => "ib_id.fibre",
        Interface::Loop2 => "ib_id.loop2",
    })
}

pub fn range_text(steps: u32, turns: u32) -> Text {
    let id = if turns == 1 { "ib_card.range_one" } else { "ib_card.range_of" };
    TEXTS.text(id).with("steps", steps).with("turns", turns)
}

/// Formats the value of a read-out.
pub fn read_value(what: ReadOutNumber, value: Value) -> Text {
    match (what.to_u16(), Direction::from_code(value.get())) {
        (0x3, Some(own)) => direction_text(own),
        // These values are counts or identifiers, so their bits need no explanation.
        (0x0..=0x7, _) => literal_text(value.get()),
        _ => read_out_value(what.value(value)),
    }
}
