//! Names for HIPERDRIVE: states, bits of the control and status words, errors with cause and remedy, and parameters.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::hiperdrive::protocol::drive_parameter::{NEWEST_ERROR, OLDEST_ERROR};
use crate::devices::hiperdrive::protocol::{ControlBit, ErrorCode, ParameterNumber, State, StatusBit, Variant};
use crate::devices::hiperdrive::state::TEXTS;

pub fn state_text(state: State) -> Text {
    TEXTS.text(match state {
        State::NotReady => "hd_state.not_ready",
        State::Ready => "hd_state.ready",
        State::Operational => "hd_state.operational",
        State::Enabled => "hd_state.enabled",
        State::Moving => "hd_state.moving",
        State::Fault => "hd_state.fault",
        State::Locked => "hd_state.locked",
    })
}

pub fn status_bit(bit: StatusBit) -> Text {
    TEXTS.text(match bit {
        StatusBit::Ready => "hd_bit.ready",
        StatusBit::Operational => "hd_bit.operational",
        StatusBit::OperationEnabled => "hd_bit.operation_enabled",
        StatusBit::Fault => "hd_bit.fault",
        StatusBit::NoOff2 => "hd_bit.no_off2",
        StatusBit::NoOff3 => "hd_bit.no_off3",
        StatusBit::SwitchOnLock => "hd_bit.switch_on_lock",
        StatusBit::Warning => "hd_bit.warning",
        StatusBit::NoFollowingError => "hd_bit.no_following_error",
        StatusBit::ControlRequested => "hd_bit.control_requested",
        StatusBit::TargetReached => "hd_bit.target_reached",
        StatusBit::ReferenceSet => "hd_bit.reference_set",
        StatusBit::SetpointAcknowledged => "hd_bit.setpoint_acknowledged",
        StatusBit::Standstill => "hd_bit.standing_still",
        StatusBit::OverCurrent => "hd_bit.over_current",
        StatusBit::PositionLimit => "hd_bit.position_limit",
    })
}

/// Returns the meaning of a control word bit when set. Bits 4 to 6 have another meaning in speed mode.
pub fn control_bit(bit: ControlBit, speed_mode: bool) -> Text {
    TEXTS.text(match (bit, speed_mode) {
        (ControlBit::On, _) => "hd_bit.control_on",
        (ControlBit::Enable, _) => "hd_bit.control_enable",
        (ControlBit::NoStop, false) => "hd_bit.control_no_stop",
        (ControlBit::NoStop, true) => "hd_bit.control_clockwise",
        (ControlBit::NoPause, false) => "hd_bit.control_no_pause",
        (ControlBit::NoPause, true) => "hd_bit.control_endless",
        (ControlBit::Start, false) => "hd_bit.control_job",
        (ControlBit::Start, true) => "hd_bit.control_run",
        (ControlBit::Acknowledge, _) => "hd_bit.control_acknowledge",
        (ControlBit::JogOne, _) => "hd_bit.control_jog_one",
        (ControlBit::JogTwo, _) => "hd_bit.control_jog_two",
        (ControlBit::Control, _) => "hd_bit.control_plc",
        (ControlBit::SpeedMode, _) => "hd_bit.control_speed_mode",
    })
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ErrorExplanation {
    pub name: Text,
    pub cause: Text,
    /// What to do before acknowledging the error.
    pub remedy: Text,
}

/// Returns the name, cause and remedy of an error in the error buffer.
pub fn error_code_explanation(code: ErrorCode) -> ErrorExplanation {
    let (name, cause, remedy) = match code {
        ErrorCode::OVER_CURRENT => ("hd_error.over_current", "hd_cause.over_current", "hd_remedy.over_current"),
        ErrorCode::UNDER_VOLTAGE => ("hd_error.under_voltage", "hd_cause.under_voltage", "hd_remedy.under_voltage"),
        ErrorCode::OVER_TEMPERATURE => {
            ("hd_error.over_temperature", "hd_cause.over_temperature", "hd_remedy.over_temperature")
        }
        ErrorCode::FOLLOWING_ERROR => ("hd_error.following", "hd_cause.following", "hd_remedy.following"),
        ErrorCode::BLOCK_REVERSE => ("hd_error.block_reverse", "hd_cause.block_reverse", "hd_remedy.block_reverse"),
        ErrorCode::BLOCK_FORWARD => ("hd_error.block_forward", "hd_cause.block_forward", "hd_remedy.block_forward"),
        ErrorCode::LOWER_LIMIT => ("hd_error.lower_limit", "hd_cause.lower_limit", "hd_remedy.lower_limit"),
        ErrorCode::UPPER_LIMIT => ("hd_error.upper_limit", "hd_cause.upper_limit", "hd_remedy.upper_limit"),
        ErrorCode::CONTROL_LOOP => ("hd_error.control_loop", "hd_cause.control_loop", "hd_remedy.control_loop"),
        ErrorCode::EEPROM => ("hd_error.eeprom", "hd_cause.eeprom", "hd_remedy.eeprom"),
        ErrorCode::START_IMPOSSIBLE => {
            ("hd_error.start_impossible", "hd_cause.start_impossible", "hd_remedy.start_impossible")
        }
        ErrorCode::INVALID_VALUE => ("hd_error.invalid_value", "hd_cause.invalid_value", "hd_remedy.invalid_value"),
        ErrorCode::SINCOS => ("hd_error.sincos", "hd_cause.sincos", "hd_remedy.sincos"),
        ErrorCode::INVALID_TARGET => ("hd_error.invalid_target", "hd_cause.invalid_target", "hd_remedy.invalid_target"),
        ErrorCode::CONNECTION_TIMEOUT => ("hd_error.timeout", "hd_cause.timeout", "hd_remedy.timeout"),
        ErrorCode::RS485 => ("hd_error.rs485", "hd_cause.rs485", "hd_remedy.rs485"),
        _ => ("hd_error.unknown", "hd_cause.unknown", "hd_remedy.unknown"),
    };
    ErrorExplanation { name: TEXTS.text(name), cause: TEXTS.text(cause), remedy: TEXTS.text(remedy) }
}

pub fn parameter_name_text(number: ParameterNumber) -> Text {
    match number.drive1_number() {
        base @ (24..=42) if base % 2 == 0 => TEXTS.text("hd_parameter.register").with("number", (base - 22) / 2),
        base @ (NEWEST_ERROR..=OLDEST_ERROR) => {
            TEXTS.text("hd_parameter.error").with("number", base - NEWEST_ERROR + 1)
        }
        base => match TEXTS.numbered_text("hd_parameter", base) {
            Some(name) => name,
            None => TEXTS.text("hd_parameter.other").with("number", number),
        },
    }
}

pub fn variant_text(variant: Variant) -> Text {
    match variant.row() {
        Some(row) => literal_text(row.name),
        None if variant == Variant::NONE => TEXTS.text("hd_variant.none"),
        None => TEXTS.text("hd_variant.other").with("number", format!("{:04X}", variant.number())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::protocol::PARAMETERS;

    #[test]
    fn parameters_and_names_match() {
        let other = |number| parameter_name_text(number).id() == "hd_parameter.other";
        for row in PARAMETERS {
            assert!(!other(ParameterNumber::new(row.number).unwrap()), "{}", row.number);
        }
        assert!(other(ParameterNumber::new(10).unwrap()));
        let numbers = TEXTS.ids().filter_map(|id| id.strip_prefix("hd_parameter.")?.parse::<u16>().ok());
        for number in numbers {
            assert!(PARAMETERS.iter().any(|row| row.number == number), "{number}");
        }
    }
}
