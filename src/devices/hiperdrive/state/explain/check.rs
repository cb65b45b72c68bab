//! Messages of the device check.

use super::names::{error_code_explanation, state_text, variant_text};
use crate::app::Text;
use crate::app::check::CheckResultLine;
use crate::app::explain::literal_text;
use crate::buses::ethernet_ip::protocol::AddressSource;
use crate::devices::hiperdrive::procedures::check::{CheckFinding, CheckStep, HiperdriveStepResult};
use crate::devices::hiperdrive::protocol::{AddressSwitch, DriveNumber};
use crate::devices::hiperdrive::state::TEXTS;

pub fn check_lines(lines: &[HiperdriveStepResult]) -> Vec<CheckResultLine> {
    lines.iter().map(|line| CheckResultLine::from_step(line, check_step_text, finding_text)).collect()
}

pub(super) fn check_step_text(step: CheckStep) -> Text {
    let of = |id: &'static str, drive: DriveNumber| TEXTS.text(id).with("drive", drive.get());
    match step {
        CheckStep::Messages => TEXTS.text("check.messages"),
        CheckStep::Device => TEXTS.text("check.device"),
        CheckStep::Supply => TEXTS.text("check.control_supply"),
        CheckStep::Temperature => Text::new("check.warmth"),
        CheckStep::Address => TEXTS.text("check.ip_address"),
        CheckStep::Memory => TEXTS.text("check.memory"),
        CheckStep::Drives => TEXTS.text("check.drives"),
        CheckStep::Request(drive) => of("check.request", drive),
        CheckStep::Line(drive) => of("check.rs485", drive),
        CheckStep::Timeout(drive) => of("check.drive_timeout", drive),
        CheckStep::Errors(drive) => of("check.drive_errors", drive),
        CheckStep::DriveTemperature(drive) => of("check.drive_warmth", drive),
        CheckStep::Range(drive) => of("check.drive_range", drive),
    }
}

fn finding_text(finding: &CheckFinding) -> Text {
    match finding {
        CheckFinding::Replies { requested, slowest_ms, late } => {
            TEXTS.text("hd_check.replies").with("asked", requested).with("slowest", slowest_ms).with("late", late)
        }
        CheckFinding::Category(words) | CheckFinding::Version(words) => literal_text(words),
        CheckFinding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        CheckFinding::Supply(tenths) => TEXTS.text("hd_check.supply").with_number("volts", *tenths as f64 / 10.0, 1),
        CheckFinding::Temperature(celsius) => TEXTS.text("hd_check.celsius").with("celsius", celsius),
        CheckFinding::Switch(switch) => self::switch_text(*switch),
        CheckFinding::UnknownSwitch(number) => TEXTS.text("hd_check.unknown_switch").with("number", number),
        CheckFinding::Source(source) => self::source_text(*source),
        CheckFinding::Saved => TEXTS.text("hd_check.saved"),
        CheckFinding::NotSaved(number) => TEXTS.text("hd_check.not_saved").with("number", number),
        CheckFinding::Drive { number, variant: own, serial_number } => TEXTS
            .text("hd_check.drive")
            .with("drive", number.get())
            .with_text("variant", variant_text(*own))
            .with("serial", serial_number),
        CheckFinding::NoDrives => TEXTS.text("hd_check.no_drives"),
        CheckFinding::Requested => TEXTS.text("hd_check.requested"),
        CheckFinding::NotRequested => TEXTS.text("hd_check.not_requested"),
        CheckFinding::LookAtS3 => TEXTS.text("hd_check.look_at_s3"),
        CheckFinding::LineGood => TEXTS.text("hd_check.line_good"),
        CheckFinding::LineWord(0xFFFF) => TEXTS.text("hd_check.line_none"),
        CheckFinding::LineWord(word) => TEXTS.text("hd_check.line_word").with("word", format_hex(*word)),
        CheckFinding::Timeout(tenths) => {
            TEXTS.text("hd_check.timeout").with_number("seconds", *tenths as f64 / 10.0, 1)
        }
        CheckFinding::NoTimeout => TEXTS.text("hd_lock.no_timeout"),
        CheckFinding::State(own) => state_text(*own),
        CheckFinding::StrayStatus(word) => TEXTS.text("hd_check.stray").with("word", format_hex(*word)),
        CheckFinding::DriveWord(word) => TEXTS.text("hd_check.drive_word").with("word", format_hex(*word)),
        CheckFinding::MotionWord(word) => TEXTS.text("hd_check.motion_word").with("word", format_hex(*word)),
        CheckFinding::Error(code) => {
            let words = error_code_explanation(*code);
            TEXTS
                .text("hd_check.error")
                .with("code", format!("{:04X}", code.code()))
                .with_text("name", words.name)
                .with_text("cause", words.cause)
                .with_text("remedy", words.remedy)
        }
        CheckFinding::Faults(count) => TEXTS.text("hd_check.faults").with("count", count),
        CheckFinding::Range { numerator, denominator, lower, upper } => TEXTS
            .text("hd_check.range")
            .with("numerator", numerator)
            .with("denominator", denominator)
            .with("lower", lower)
            .with("upper", upper),
        CheckFinding::BadScale { numerator, denominator } => {
            TEXTS.text("hd_check.bad_scale").with("numerator", numerator).with("denominator", denominator)
        }
        CheckFinding::LimitsCrossed { lower, upper } => {
            TEXTS.text("hd_check.crossed").with("lower", lower).with("upper", upper)
        }
        CheckFinding::BeyondTravel { limit, turns, most } => {
            TEXTS.text("hd_check.beyond").with("limit", limit).with_number("turns", *turns, 1).with("most", most)
        }
        CheckFinding::Within(position) => TEXTS.text("hd_check.within").with("position", position),
        CheckFinding::Outside { position, lower, upper } => {
            TEXTS.text("hd_check.outside").with("position", position).with("lower", lower).with("upper", upper)
        }
    }
}

pub fn switch_text(switch: AddressSwitch) -> Text {
    match switch {
        AddressSwitch::Object => TEXTS.text("hd_switch.object"),
        AddressSwitch::Fixed(address) => TEXTS.text("hd_switch.fixed").with("address", address),
        AddressSwitch::Stored => TEXTS.text("hd_switch.stored"),
        AddressSwitch::Bootp => TEXTS.text("hd_switch.bootp"),
        AddressSwitch::Dhcp => TEXTS.text("hd_switch.dhcp"),
    }
}

pub fn source_text(source: AddressSource) -> Text {
    match source {
        AddressSource::Stored => TEXTS.text("hd_switch.source_stored"),
        AddressSource::Bootp => TEXTS.text("hd_switch.source_bootp"),
        AddressSource::Dhcp => TEXTS.text("hd_switch.source_dhcp"),
        AddressSource::Unknown(method) => TEXTS.text("hd_switch.source_other").with("method", method),
    }
}

fn format_hex(word: u16) -> String {
    format!("0x{word:04X}")
}
