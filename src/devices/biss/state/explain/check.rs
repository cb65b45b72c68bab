//! The device check in words.

use super::guide::mode;
use super::mismatch;
use super::name;
use crate::app::Text;
use crate::app::check::CheckLine;
use crate::app::explain::plain;
use crate::devices::biss::procedures::check::{Finding, Line, Step};
use crate::devices::biss::protocol::Name;
use crate::devices::biss::state::words::sheet;

/// The lines of a check.
pub fn check(lines: &[Line]) -> Vec<CheckLine> {
    lines.iter().map(|line| CheckLine::of(line, step, finding)).collect()
}

fn step(step: Step) -> Text {
    Text::new(match step {
        Step::Identity => "check.identity",
        Step::Status => "check.status",
        Step::Position => "check.position",
        Step::DataSheet => "check.data_sheet",
        Step::Limits => "check.limits",
        Step::Wiegand => "check.wiegand",
        Step::Readings => "check.line",
        Step::Wear => "check.wear",
    })
}

fn finding(finding: &Finding) -> Text {
    match finding {
        Finding::Name(name) => plain(name),
        Finding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        Finding::Firmware(firmware) => Text::new("check.firmware").with("firmware", firmware),
        Finding::Mismatch(found) => mismatch(found),
        Finding::Error(bit, name) => bit_words("check.error", *bit, name.as_ref()),
        Finding::Warning(bit, name) => bit_words("check.warning", *bit, name.as_ref()),
        Finding::NotTold => Text::new("check.not_told"),
        Finding::Mode(found) => Text::new("check.mode").with_text("mode", mode(*found)),
        Finding::Open => Text::new("check.open"),
        Finding::Position(reading) if !reading.is_split_known => {
            Text::new("check.place_raw").with("raw", reading.raw())
        }
        Finding::Position(reading) => Text::new("check.place")
            .with("turns", reading.turns)
            .with("steps", reading.steps)
            .with_number("degrees", reading.degrees(), 3),
        Finding::ErrorBit => Text::new("check.error_bit"),
        Finding::WarningBit => Text::new("check.warning_bit"),
        Finding::NoPosition => Text::new("check.no_position"),
        Finding::SumsFit => Text::new("check.sums"),
        Finding::Sheet(error) => Text::new("check.sheet").with_text("why", sheet(error)),
        Finding::NoSheet => Text::new("check.no_sheet"),
        Finding::OtherFrame { sheet, description } => Text::new("check.other_frame")
            .with("sheet", format!("{}+{}", sheet.0, sheet.1))
            .with("description", format!("{}+{}", description.0, description.1)),
        Finding::Temperature { celsius, low, high } => {
            Text::new("check.temperature").with_number("celsius", *celsius, 0).with("low", low).with("high", high)
        }
        Finding::Supply { millivolt, low, high } => {
            Text::new("check.supply").with("millivolt", millivolt).with("low", low).with("high", high)
        }
        Finding::Current { milliampere, high } => {
            Text::new("check.current").with("milliampere", milliampere).with("high", high)
        }
        Finding::Wiegand(result) => Text::new("check.pulses")
            .with_number("cw", result.lowest_cw.volts(), 1)
            .with_number("ccw", result.lowest_ccw.volts(), 1),
        Finding::NotTested => Text::new("check.not_tested"),
        Finding::Readings { asked, damaged } => {
            Text::new("check.readings").with("asked", asked).with("damaged", damaged)
        }
        Finding::Wear { seen, limit } => Text::new("check.cycles").with("seen", seen).with("limit", limit),
    }
}

fn bit_words(id: &'static str, bit: u8, own: Option<&Name>) -> Text {
    let name = own.map_or_else(|| Text::new("biss_status.unknown_bit"), name);
    Text::new(id).with("bit", bit).with_text("name", name)
}
