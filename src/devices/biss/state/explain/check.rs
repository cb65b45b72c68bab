//! Labels and messages of the device check.

use super::guide::mode_text;
use super::{mismatch_text, name_text};
use crate::app::Text;
use crate::app::check::CheckResultLine;
use crate::app::explain::{cycle_count_text, literal_text};
use crate::devices::biss::procedures::check::{BissStepResult, CheckFinding, CheckStep};
use crate::devices::biss::protocol::Name;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::format::data_sheet_error_text;

pub fn check_lines(lines: &[BissStepResult]) -> Vec<CheckResultLine> {
    lines.iter().map(|line| CheckResultLine::from_step(line, check_step_text, finding_text)).collect()
}

fn check_step_text(step: CheckStep) -> Text {
    TEXTS.text(match step {
        CheckStep::Identity => "check.identity",
        CheckStep::Status => "check.status",
        CheckStep::Position => "check.position",
        CheckStep::DataSheet => "check.data_sheet",
        CheckStep::Limits => "check.limits",
        CheckStep::Wiegand => "check.wiegand",
        CheckStep::Readings => "check.line",
        CheckStep::Wear => "check.wear",
    })
}

fn finding_text(finding: &CheckFinding) -> Text {
    match finding {
        CheckFinding::Name(name) => literal_text(name),
        CheckFinding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        CheckFinding::Firmware(firmware) => TEXTS.text("check.firmware").with("firmware", firmware),
        CheckFinding::Mismatch(found) => mismatch_text(found),
        CheckFinding::Error(bit, name) => bit_text("check.error", *bit, name.as_ref()),
        CheckFinding::Warning(bit, name) => bit_text("check.warning", *bit, name.as_ref()),
        CheckFinding::NotReported => TEXTS.text("check.not_told"),
        CheckFinding::Mode(found) => TEXTS.text("check.mode").with_text("mode", mode_text(*found)),
        CheckFinding::Open => TEXTS.text("check.open"),
        CheckFinding::Position(reading) if !reading.is_split_known => {
            TEXTS.text("check.place_raw").with("raw", reading.position_word())
        }
        CheckFinding::Position(reading) => TEXTS
            .text("check.place")
            .with("turns", reading.turns)
            .with("steps", reading.steps)
            .with_number("degrees", reading.degrees_in_turn(), 3),
        CheckFinding::ErrorBit => TEXTS.text("check.error_bit"),
        CheckFinding::WarningBit => TEXTS.text("check.warning_bit"),
        CheckFinding::NoPosition => TEXTS.text("check.no_position"),
        CheckFinding::SumsFit => TEXTS.text("check.sums"),
        CheckFinding::Sheet(error) => TEXTS.text("check.sheet").with_text("why", data_sheet_error_text(error)),
        CheckFinding::NoSheet => TEXTS.text("check.no_sheet"),
        CheckFinding::FrameMismatch { sheet, description } => TEXTS
            .text("check.other_frame")
            .with("sheet", format!("{}+{}", sheet.0, sheet.1))
            .with("description", format!("{}+{}", description.0, description.1)),
        CheckFinding::Temperature { celsius, low, high } => {
            TEXTS.text("check.temperature").with_number("celsius", *celsius, 0).with("low", low).with("high", high)
        }
        CheckFinding::Supply { millivolt, low, high } => {
            TEXTS.text("check.supply").with("millivolt", millivolt).with("low", low).with("high", high)
        }
        CheckFinding::Current { milliampere, high } => {
            TEXTS.text("check.current").with("milliampere", milliampere).with("high", high)
        }
        CheckFinding::Wiegand(result) => TEXTS
            .text("check.pulses")
            .with_number("cw", result.lowest_cw.volts(), 1)
            .with_number("ccw", result.lowest_ccw.volts(), 1),
        CheckFinding::NotTested => TEXTS.text("check.not_tested"),
        CheckFinding::Readings { requested, damaged } => {
            TEXTS.text("check.readings").with("asked", requested).with("damaged", damaged)
        }
        CheckFinding::Wear { seen, limit } => {
            TEXTS.text("check.cycles").with_text("seen", cycle_count_text(*seen)).with("limit", limit)
        }
    }
}

fn bit_text(id: &'static str, bit: u8, own: Option<&Name>) -> Text {
    TEXTS.text(id).with("bit", bit).with_text("name", flag_text(own))
}

/// Returns the name of a status bit for display.
pub fn flag_text(name: Option<&Name>) -> Text {
    name.map_or_else(|| TEXTS.text("biss_status.unknown_bit"), name_text)
}
