//! All parameters of the device and of drive 1 (reference, section 4). The English names are not official, since the
//! manual has only German ones.

use std::ops::RangeInclusive;
use std::time::Duration;

use Kind::{I8, I16, I32, Text, U8, U16, U32};
use ParameterRange::{Any, OneOf, Within, WithinOrEqual};

use super::drive_parameter::{
    ACKNOWLEDGE, DENOMINATOR, DRIVE_REQUESTED, HAND_DRIVE_WAIT, LOWER_LIMIT, MAXIMUM_SPEED, MAXIMUM_SPEEDS, NO_TIMEOUT,
    NUMERATOR, POSITION, REFERENCE, RESET, RS485_ADDRESS, RS485_BAUD, RS485_COMPLETE, SPEED_DENOMINATOR,
    SPEED_NUMERATOR, TIMEOUT, UPPER_LIMIT, VARIANT,
};
use super::parameter::{FactoryValue, ParameterAccess, ParameterRange, ParameterRow, SlowValue};
use super::travel::StepLimit;
use super::value::Kind;

const fn read(number: u16, name: &'static str, kind: Kind, unit: &'static str) -> ParameterRow {
    ParameterRow {
        number,
        name,
        unit,
        kind,
        access: ParameterAccess::Read,
        saved: false,
        kept_by_device: number < 100,
        range: ParameterRange::Any,
        reach: None,
        factory: FactoryValue::None,
        slow: &[],
    }
}

impl ParameterRow {
    /// Returns this row with write access. The value is lost at power-off.
    const fn writable(self, range: ParameterRange, factory: FactoryValue) -> Self {
        ParameterRow { access: ParameterAccess::ReadWrite, range, factory, ..self }
    }

    /// Returns this row as that of a drive parameter stored by the adapter or hub. See sections 3.4 and 4.5 of the
    /// manual for parameter 152, and its parameter table for 190.
    const fn with_device_storage(self) -> Self {
        ParameterRow { kept_by_device: true, ..self }
    }

    const fn saved(self, range: ParameterRange, factory: FactoryValue) -> Self {
        ParameterRow { saved: true, ..self.writable(range, factory) }
    }

    const fn with_step_limit(self, reach: StepLimit) -> Self {
        ParameterRow { reach: Some(reach), ..self }
    }

    const fn with_write_durations(self, slow: &'static [SlowValue]) -> Self {
        ParameterRow { slow, ..self }
    }
}

/// Maximum time for a write to the EEPROM (manual 6.2, parameter 47). Every change to the TCP/IP object also takes this
/// time (manual 5).
pub const STORE_TIME: Duration = Duration::from_millis(200);
/// Maximum time for resetting a single drive. On an adapter, the value −4 of parameter 47 also takes this time.
const DRIVE_RESETS: Duration = Duration::from_secs(2);
/// Maximum time for resetting all drives of a hub.
const HUB_RESET_TIME: Duration = Duration::from_secs(8);

const fn store_duration(value: i64) -> SlowValue {
    SlowValue { value, adapter: STORE_TIME, hub: STORE_TIME }
}

const fn slow_values_for_all_drives(value: i64) -> SlowValue {
    SlowValue { value, adapter: DRIVE_RESETS, hub: HUB_RESET_TIME }
}

const fn slow_values_for_one_drive(value: i64) -> SlowValue {
    SlowValue { value, adapter: DRIVE_RESETS, hub: DRIVE_RESETS }
}

/// Values of parameter 47 that take long to apply. The manual gives no time for −3, −2 and −1. They are assumed to take
/// as long as −4, since all of them send all parameters to all drives over RS-485 (`D`).
const SAVE_AND_RESET: &[SlowValue] = &[
    slow_values_for_all_drives(-4),
    slow_values_for_all_drives(-3),
    slow_values_for_all_drives(-2),
    slow_values_for_all_drives(-1),
    store_duration(1),
];
/// The value of parameter 152 that takes long to apply. A change from 0 to 1 resets the drive. The time is derived
/// (`D`).
const REQUEST: &[SlowValue] = &[slow_values_for_one_drive(1)];
/// Values of parameter 199 that take long to apply. The time is derived (`D`).
const RESET_DRIVE: &[SlowValue] = &[slow_values_for_one_drive(0), slow_values_for_one_drive(1)];

const fn text(number: u16, name: &'static str, unit: &'static str) -> ParameterRow {
    read(number, name, Text, unit)
}

const fn register(number: u16, name: &'static str) -> ParameterRow {
    read(number, name, U32, "").saved(Any, FactoryValue::Number(0))
}

const fn error(number: u16, name: &'static str) -> ParameterRow {
    read(number, name, U16, "")
}

const fn percent(number: u16, name: &'static str) -> ParameterRow {
    read(number, name, U8, "%").writable(Within(1, 100), FactoryValue::Number(100))
}

const fn scale(number: u16, name: &'static str, factory: i64) -> ParameterRow {
    read(number, name, U16, "").saved(Within(1, 65535), FactoryValue::Number(factory))
}

const fn whole_range(range: RangeInclusive<u16>) -> ParameterRange {
    Within(*range.start() as i64, *range.end() as i64)
}

/// All parameters by number. Parameters 11 and 119 are assumed to be signed, since the manual gives only their width
/// (`U`).
pub const PARAMETERS: &[ParameterRow] = &[
    read(9, "control supply", U16, "0.1 V"),
    read(11, "device temperature", I16, "°C"),
    read(12, "address switch", U16, ""),
    text(13, "category", ""),
    text(15, "name", ""),
    text(16, "article number", ""),
    read(17, "serial number", U16, ""),
    text(18, "production date", ""),
    text(19, "software version", ""),
    register(24, "free register 1"),
    register(26, "free register 2"),
    register(28, "free register 3"),
    register(30, "free register 4"),
    register(32, "free register 5"),
    register(34, "free register 6"),
    register(36, "free register 7"),
    register(38, "free register 8"),
    register(40, "free register 9"),
    register(42, "free register 10"),
    read(47, "save and reset", I16, "")
        .writable(OneOf(&[-4, -3, -2, -1, 1]), FactoryValue::None)
        .with_write_durations(SAVE_AND_RESET),
    read(101, "control word", U16, "").writable(Any, FactoryValue::Number(0)),
    percent(102, "speed"),
    percent(103, "torque"),
    read(104, "target position", I32, "steps").writable(Any, FactoryValue::Number(0)),
    read(105, "status word", U16, ""),
    read(106, "actual speed", I16, "0.1 rpm"),
    read(POSITION, "actual position", I32, "steps"),
    error(108, "error 1"),
    error(109, "error 2"),
    error(110, "error 3"),
    error(111, "error 4"),
    error(112, "error 5"),
    error(113, "error 6"),
    error(114, "error 7"),
    error(115, "error 8"),
    error(116, "drive error word"),
    error(117, "motion status"),
    error(118, "communication error"),
    read(119, "drive temperature", I8, "°C"),
    read(VARIANT, "variant", U16, ""),
    text(121, "drive name", ""),
    text(122, "drive article number", ""),
    text(123, "drive serial number", ""),
    text(124, "drive production date", ""),
    text(125, "drive software version", ""),
    text(126, "nominal voltage", "V"),
    text(127, "nominal current", "A"),
    text(128, "nominal torque", "Nm"),
    text(129, "nominal speed", "rpm"),
    read(DRIVE_REQUESTED, "requested", U8, "")
        .saved(Within(0, 1), FactoryValue::Topology { adapter: 1, hub: 0 })
        .with_device_storage()
        .with_write_durations(REQUEST),
    scale(NUMERATOR, "position scale numerator", 256),
    scale(DENOMINATOR, "position scale denominator", 1),
    read(LOWER_LIMIT, "lower limit", I32, "steps")
        .saved(Any, FactoryValue::Turns(-1))
        .with_step_limit(StepLimit::Position),
    read(UPPER_LIMIT, "upper limit", I32, "steps")
        .saved(Any, FactoryValue::Turns(1))
        .with_step_limit(StepLimit::Position),
    scale(SPEED_NUMERATOR, "speed scale numerator", 10),
    scale(SPEED_DENOMINATOR, "speed scale denominator", 1),
    read(MAXIMUM_SPEED, "maximum speed", U16, "0.1 rpm").saved(whole_range(MAXIMUM_SPEEDS), FactoryValue::Number(350)),
    read(170, "jog 1 step", I32, "steps").writable(Any, FactoryValue::Number(4096)).with_step_limit(StepLimit::Step),
    percent(172, "jog 1 speed"),
    percent(174, "jog 1 torque"),
    read(176, "jog 2 step", I32, "steps").writable(Any, FactoryValue::Number(-4096)).with_step_limit(StepLimit::Step),
    percent(178, "jog 2 speed"),
    percent(180, "jog 2 torque"),
    read(HAND_DRIVE_WAIT, "wait before hand drive", U16, "ms").writable(Within(100, 10000), FactoryValue::Number(1000)),
    read(TIMEOUT, "RS-485 time-out", U16, "0.1 s").saved(WithinOrEqual(1, 100, NO_TIMEOUT), FactoryValue::Number(20)),
    read(RS485_ADDRESS, "RS-485 address", U8, "").saved(Within(0, 253), FactoryValue::Number(1)),
    read(RS485_BAUD, "RS-485 baud rate", U32, "baud")
        .saved(OneOf(&[9600, 19200, 38400]), FactoryValue::Number(38400))
        .with_device_storage(),
    read(RS485_COMPLETE, "RS-485 complete time", U16, "ms").saved(Any, FactoryValue::Automatic),
    read(ACKNOWLEDGE, "faults since the acknowledgement", U8, "").writable(Within(0, 0), FactoryValue::None),
    read(REFERENCE, "set actual position", I32, "steps")
        .saved(Any, FactoryValue::Number(0))
        .with_step_limit(StepLimit::Position),
    ParameterRow {
        access: ParameterAccess::Write,
        ..read(RESET, "reset drive", U8, "").writable(Within(0, 1), FactoryValue::None)
    }
    .with_write_durations(RESET_DRIVE),
];
