//! What things in a HIPERDRIVE are called: states, bits of its words, errors with cause and remedy, parameters.

use crate::app::Text;
use crate::app::explain::plain;
use crate::devices::hiperdrive::protocol::{ControlBit, ErrorCode, ParameterNumber, State, StatusBit, Variant};
use crate::devices::hiperdrive::state::TEXTS;

/// A state of the drive.
pub fn state(state: State) -> Text {
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

/// What a bit of the status word says when it is set.
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
        StatusBit::StandingStill => "hd_bit.standing_still",
        StatusBit::OverCurrent => "hd_bit.over_current",
        StatusBit::PositionLimit => "hd_bit.position_limit",
    })
}

/// What a bit of the control word says when it is set; bits 4 to 6 mean something else in speed mode.
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

/// An error in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ErrorWords {
    /// What it is called.
    pub name: Text,
    /// What brings it about.
    pub cause: Text,
    /// What to do before it is acknowledged.
    pub remedy: Text,
}

/// An error of the buffer: its name, what brings it about, what to do.
pub fn error(code: ErrorCode) -> ErrorWords {
    let (name, cause, remedy) = match code {
        ErrorCode::OVER_CURRENT => ("hd_error.over_current", "hd_cause.over_current", "hd_remedy.over_current"),
        ErrorCode::UNDER_VOLTAGE => ("hd_error.under_voltage", "hd_cause.under_voltage", "hd_remedy.under_voltage"),
        ErrorCode::OVER_TEMPERATURE => {
            ("hd_error.over_temperature", "hd_cause.over_temperature", "hd_remedy.over_temperature")
        }
        ErrorCode::FOLLOWING => ("hd_error.following", "hd_cause.following", "hd_remedy.following"),
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
    ErrorWords { name: TEXTS.text(name), cause: TEXTS.text(cause), remedy: TEXTS.text(remedy) }
}

/// A parameter, without its number and drive.
pub fn parameter(number: ParameterNumber) -> Text {
    let id = match number.base() {
        9 => "hd_parameter.supply",
        11 => "hd_parameter.warmth",
        12 => "hd_parameter.switch",
        13 => "hd_parameter.category",
        15 => "hd_parameter.name",
        16 => "hd_parameter.article",
        17 => "hd_parameter.serial",
        18 => "hd_parameter.produced",
        19 => "hd_parameter.version",
        47 => "hd_parameter.save",
        101 => "hd_parameter.control",
        102 => "hd_parameter.speed_percent",
        103 => "hd_parameter.torque_percent",
        104 => "hd_parameter.target",
        105 => "hd_parameter.status",
        106 => "hd_parameter.actual_speed",
        107 => "hd_parameter.actual_position",
        116 => "hd_parameter.word_drive",
        117 => "hd_parameter.word_motion",
        118 => "hd_parameter.word_bus",
        119 => "hd_parameter.drive_warmth",
        120 => "hd_parameter.variant",
        121 => "hd_parameter.drive_name",
        122 => "hd_parameter.drive_article",
        123 => "hd_parameter.drive_serial",
        124 => "hd_parameter.drive_produced",
        125 => "hd_parameter.drive_version",
        126 => "hd_parameter.volts",
        127 => "hd_parameter.amperes",
        128 => "hd_parameter.newton",
        129 => "hd_parameter.nominal_speed",
        152 => "hd_parameter.requested",
        154 => "hd_parameter.position_numerator",
        156 => "hd_parameter.position_denominator",
        158 => "hd_parameter.lower",
        160 => "hd_parameter.upper",
        162 => "hd_parameter.speed_numerator",
        164 => "hd_parameter.speed_denominator",
        166 => "hd_parameter.most_speed",
        170 => "hd_parameter.jog_one_step",
        172 => "hd_parameter.jog_one_speed",
        174 => "hd_parameter.jog_one_torque",
        176 => "hd_parameter.jog_two_step",
        178 => "hd_parameter.jog_two_speed",
        180 => "hd_parameter.jog_two_torque",
        182 => "hd_parameter.hand_wait",
        186 => "hd_parameter.timeout",
        188 => "hd_parameter.address",
        190 => "hd_parameter.baud",
        192 => "hd_parameter.complete",
        197 => "hd_parameter.faults",
        198 => "hd_parameter.reference",
        199 => "hd_parameter.reset",
        base @ (24..=42) if base % 2 == 0 => {
            return TEXTS.text("hd_parameter.register").with("number", (base - 22) / 2);
        }
        base @ (108..=115) => return TEXTS.text("hd_parameter.error").with("number", base - 107),
        _ => return TEXTS.text("hd_parameter.other").with("number", number),
    };
    TEXTS.text(id)
}

/// Which drive it is.
pub fn variant(variant: Variant) -> Text {
    match variant.row() {
        Some(row) => plain(row.name),
        None if variant == Variant::NONE => TEXTS.text("hd_variant.none"),
        None => TEXTS.text("hd_variant.other").with("number", format!("{:04X}", variant.number())),
    }
}
