//! Messages of the device check.

use super::{encoder_error_text, error_word_text, format_word, implausible_value_text, startup_mode_text};
use crate::app::Text;
use crate::app::check::CheckResultLine;
use crate::app::explain::cycle_count_text;
use crate::devices::interbus::procedures::check::{CheckFinding, CheckStep, InterbusStepResult};
use crate::devices::interbus::protocol::Reply;
use crate::devices::interbus::state::TEXTS;

pub fn check_lines(lines: &[InterbusStepResult]) -> Vec<CheckResultLine> {
    lines.iter().map(|line| CheckResultLine::from_step(line, check_step_text, finding_text)).collect()
}

fn check_step_text(step: CheckStep) -> Text {
    TEXTS.text(match step {
        CheckStep::Gateway => "check.gateway",
        CheckStep::WordOrder => "check.word_order",
        CheckStep::InputWord => "check.input_word",
        CheckStep::Identity => "check.identity",
        CheckStep::Handshake => "check.handshake",
        CheckStep::Temperature => "check.warmth",
        CheckStep::Wear => "check.stores",
    })
}

fn finding_text(finding: &CheckFinding) -> Text {
    match finding {
        CheckFinding::Replies { requested, slowest_ms } => {
            TEXTS.text("ib_check.replies").with("asked", requested).with("slowest", slowest_ms)
        }
        CheckFinding::OrderFits => TEXTS.text("ib_check.order_fits"),
        CheckFinding::OrderSwapped { input, swapped } => TEXTS
            .text("ib_check.order_swapped")
            .with("input", format_word(*input))
            .with("swapped", format_word(*swapped)),
        CheckFinding::Runs(input) => TEXTS.text("ib_check.runs").with("word", format_word(*input)),
        CheckFinding::StrayBits(input) => TEXTS.text("ib_check.stray").with("word", format_word(*input)),
        CheckFinding::Error(error) => TEXTS
            .text("ib_check.error")
            .with("word", format_word(Reply::Error(*error).emit()))
            .with_text("why", error_word_text(*error)),
        CheckFinding::Occupied(input) => TEXTS.text("ib_check.occupied").with("word", format_word(*input)),
        CheckFinding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        CheckFinding::SoftwareVersion(version) => TEXTS.text("ib_check.version").with("version", version),
        CheckFinding::Gear { steps, turns } => TEXTS.text("ib_check.gear").with("steps", steps).with("turns", turns),
        CheckFinding::Implausible(why) => implausible_value_text(*why),
        CheckFinding::PresetBeyond { preset, last } => {
            TEXTS.text("ib_check.preset_beyond").with("preset", preset).with("last", last)
        }
        CheckFinding::StepsMinusOne => TEXTS.text("ib_check.steps_minus_one"),
        CheckFinding::Mode(mode) => TEXTS.text("ib_check.mode").with_text("mode", startup_mode_text(*mode)),
        CheckFinding::ReadOuts { requested, each_ms } => {
            TEXTS.text("ib_check.read_outs").with("asked", requested).with("each", each_ms)
        }
        CheckFinding::Failed(error) => encoder_error_text(error),
        CheckFinding::Temperature(tenths) => {
            TEXTS.text("ib_check.celsius").with_number("celsius", f64::from(*tenths) / 10.0, 1)
        }
        CheckFinding::Wear { seen, limit } => {
            TEXTS.text("ib_check.wear").with_text("seen", cycle_count_text(*seen)).with("limit", limit)
        }
    }
}
