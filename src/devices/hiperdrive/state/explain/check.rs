//! The device check in words.

use super::names::{error, state, variant};
use crate::app::Text;
use crate::app::check::CheckLine;
use crate::app::explain::plain;
use crate::buses::ethernet_ip::protocol::AddressSource;
use crate::devices::hiperdrive::procedures::check::{Finding, HiperdriveStepResult, Step};
use crate::devices::hiperdrive::protocol::{AddressSwitch, DriveNumber};
use crate::devices::hiperdrive::state::TEXTS;

pub fn check(lines: &[HiperdriveStepResult]) -> Vec<CheckLine> {
    lines.iter().map(|line| CheckLine::of(line, step, finding)).collect()
}

pub(super) fn step(step: Step) -> Text {
    let of = |id: &'static str, drive: DriveNumber| TEXTS.text(id).with("drive", drive.get());
    match step {
        Step::Messages => TEXTS.text("check.messages"),
        Step::Device => TEXTS.text("check.device"),
        Step::Supply => TEXTS.text("check.control_supply"),
        Step::Temperature => Text::new("check.warmth"),
        Step::Address => TEXTS.text("check.ip_address"),
        Step::Memory => TEXTS.text("check.memory"),
        Step::Drives => TEXTS.text("check.drives"),
        Step::Request(drive) => of("check.request", drive),
        Step::Line(drive) => of("check.rs485", drive),
        Step::Timeout(drive) => of("check.drive_timeout", drive),
        Step::Errors(drive) => of("check.drive_errors", drive),
        Step::DriveTemperature(drive) => of("check.drive_warmth", drive),
        Step::Range(drive) => of("check.drive_range", drive),
    }
}

fn finding(finding: &Finding) -> Text {
    match finding {
        Finding::Replies { asked, slowest_ms, late } => {
            TEXTS.text("hd_check.replies").with("asked", asked).with("slowest", slowest_ms).with("late", late)
        }
        Finding::Category(words) | Finding::Version(words) => plain(words),
        Finding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        Finding::Supply(tenths) => TEXTS.text("hd_check.supply").with_number("volts", *tenths as f64 / 10.0, 1),
        Finding::Temperature(celsius) => TEXTS.text("hd_check.celsius").with("celsius", celsius),
        Finding::Switch(switch) => self::switch(*switch),
        Finding::UnknownSwitch(number) => TEXTS.text("hd_check.unknown_switch").with("number", number),
        Finding::Source(source) => self::source(*source),
        Finding::Saved => TEXTS.text("hd_check.saved"),
        Finding::NotSaved(number) => TEXTS.text("hd_check.not_saved").with("number", number),
        Finding::Drive { number, variant: own, serial_number } => TEXTS
            .text("hd_check.drive")
            .with("drive", number.get())
            .with_text("variant", variant(*own))
            .with("serial", serial_number),
        Finding::NoDrives => TEXTS.text("hd_check.no_drives"),
        Finding::Requested => TEXTS.text("hd_check.requested"),
        Finding::NotRequested => TEXTS.text("hd_check.not_requested"),
        Finding::LookAtS3 => TEXTS.text("hd_check.look_at_s3"),
        Finding::LineGood => TEXTS.text("hd_check.line_good"),
        Finding::LineWord(0xFFFF) => TEXTS.text("hd_check.line_none"),
        Finding::LineWord(word) => TEXTS.text("hd_check.line_word").with("word", hex(*word)),
        Finding::Timeout(tenths) => TEXTS.text("hd_check.timeout").with_number("seconds", *tenths as f64 / 10.0, 1),
        Finding::NoTimeout => TEXTS.text("hd_lock.no_timeout"),
        Finding::State(own) => state(*own),
        Finding::StrayStatus(word) => TEXTS.text("hd_check.stray").with("word", hex(*word)),
        Finding::DriveWord(word) => TEXTS.text("hd_check.drive_word").with("word", hex(*word)),
        Finding::MotionWord(word) => TEXTS.text("hd_check.motion_word").with("word", hex(*word)),
        Finding::Error(code) => {
            let words = error(*code);
            TEXTS
                .text("hd_check.error")
                .with("code", format!("{:04X}", code.code()))
                .with_text("name", words.name)
                .with_text("cause", words.cause)
                .with_text("remedy", words.remedy)
        }
        Finding::Faults(count) => TEXTS.text("hd_check.faults").with("count", count),
        Finding::Range { numerator, denominator, lower, upper } => TEXTS
            .text("hd_check.range")
            .with("numerator", numerator)
            .with("denominator", denominator)
            .with("lower", lower)
            .with("upper", upper),
        Finding::BadScale { numerator, denominator } => {
            TEXTS.text("hd_check.bad_scale").with("numerator", numerator).with("denominator", denominator)
        }
        Finding::LimitsCrossed { lower, upper } => {
            TEXTS.text("hd_check.crossed").with("lower", lower).with("upper", upper)
        }
        Finding::BeyondTravel { limit, turns, most } => {
            TEXTS.text("hd_check.beyond").with("limit", limit).with_number("turns", *turns, 1).with("most", most)
        }
        Finding::Within(position) => TEXTS.text("hd_check.within").with("position", position),
        Finding::Outside { position, lower, upper } => {
            TEXTS.text("hd_check.outside").with("position", position).with("lower", lower).with("upper", upper)
        }
    }
}

/// Returns the setting of the address switches in words.
pub fn switch(switch: AddressSwitch) -> Text {
    match switch {
        AddressSwitch::Object => TEXTS.text("hd_switch.object"),
        AddressSwitch::Fixed(address) => TEXTS.text("hd_switch.fixed").with("address", address),
        AddressSwitch::Stored => TEXTS.text("hd_switch.stored"),
        AddressSwitch::Bootp => TEXTS.text("hd_switch.bootp"),
        AddressSwitch::Dhcp => TEXTS.text("hd_switch.dhcp"),
    }
}

/// Returns the source of the address in words.
pub fn source(source: AddressSource) -> Text {
    match source {
        AddressSource::Stored => TEXTS.text("hd_switch.source_stored"),
        AddressSource::Bootp => TEXTS.text("hd_switch.source_bootp"),
        AddressSource::Dhcp => TEXTS.text("hd_switch.source_dhcp"),
        AddressSource::Unknown(method) => TEXTS.text("hd_switch.source_other").with("method", method),
    }
}

fn hex(word: u16) -> String {
    format!("0x{word:04X}")
}
