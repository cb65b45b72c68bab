//! The device check in words.

use super::guide::mode;
use super::{mismatch, name};
use crate::app::Text;
use crate::app::check::CheckLine;
use crate::app::explain::plain;
use crate::devices::biss::procedures::check::{BissStepResult, Finding, Step};
use crate::devices::biss::protocol::Name;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::words::sheet;

pub fn check(lines: &[BissStepResult]) -> Vec<CheckLine> {
    lines.iter().map(|line| CheckLine::of(line, step, finding)).collect()
}

fn step(step: Step) -> Text {
    TEXTS.text(match step {
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
        Finding::Firmware(firmware) => TEXTS.text("check.firmware").with("firmware", firmware),
        Finding::Mismatch(found) => mismatch(found),
        Finding::Error(bit, name) => bit_words("check.error", *bit, name.as_ref()),
        Finding::Warning(bit, name) => bit_words("check.warning", *bit, name.as_ref()),
        Finding::NotTold => TEXTS.text("check.not_told"),
        Finding::Mode(found) => TEXTS.text("check.mode").with_text("mode", mode(*found)),
        Finding::Open => TEXTS.text("check.open"),
        Finding::Position(reading) if !reading.is_split_known => {
            TEXTS.text("check.place_raw").with("raw", reading.raw())
        }
        Finding::Position(reading) => TEXTS
            .text("check.place")
            .with("turns", reading.turns)
            .with("steps", reading.steps)
            .with_number("degrees", reading.degrees(), 3),
        Finding::ErrorBit => TEXTS.text("check.error_bit"),
        Finding::WarningBit => TEXTS.text("check.warning_bit"),
        Finding::NoPosition => TEXTS.text("check.no_position"),
        Finding::SumsFit => TEXTS.text("check.sums"),
        Finding::Sheet(error) => TEXTS.text("check.sheet").with_text("why", sheet(error)),
        Finding::NoSheet => TEXTS.text("check.no_sheet"),
        Finding::OtherFrame { sheet, description } => TEXTS
            .text("check.other_frame")
            .with("sheet", format!("{}+{}", sheet.0, sheet.1))
            .with("description", format!("{}+{}", description.0, description.1)),
        Finding::Temperature { celsius, low, high } => {
            TEXTS.text("check.temperature").with_number("celsius", *celsius, 0).with("low", low).with("high", high)
        }
        Finding::Supply { millivolt, low, high } => {
            TEXTS.text("check.supply").with("millivolt", millivolt).with("low", low).with("high", high)
        }
        Finding::Current { milliampere, high } => {
            TEXTS.text("check.current").with("milliampere", milliampere).with("high", high)
        }
        Finding::Wiegand(result) => TEXTS
            .text("check.pulses")
            .with_number("cw", result.lowest_cw.volts(), 1)
            .with_number("ccw", result.lowest_ccw.volts(), 1),
        Finding::NotTested => TEXTS.text("check.not_tested"),
        Finding::Readings { asked, damaged } => {
            TEXTS.text("check.readings").with("asked", asked).with("damaged", damaged)
        }
        Finding::Wear { seen, limit } => TEXTS.text("check.cycles").with("seen", seen).with("limit", limit),
    }
}

fn bit_words(id: &'static str, bit: u8, own: Option<&Name>) -> Text {
    let name = own.map_or_else(|| TEXTS.text("biss_status.unknown_bit"), name);
    TEXTS.text(id).with("bit", bit).with_text("name", name)
}
