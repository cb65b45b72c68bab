//! The device check in words.

use super::{encoder, implausible, refusal, startup, word};
use crate::app::Text;
use crate::app::check::CheckLine;
use crate::devices::interbus::procedures::check::{Finding, InterbusStepResult, Step};
use crate::devices::interbus::protocol::Reply;
use crate::devices::interbus::state::TEXTS;

pub fn check(lines: &[InterbusStepResult]) -> Vec<CheckLine> {
    lines.iter().map(|line| CheckLine::of(line, step, finding)).collect()
}

fn step(step: Step) -> Text {
    TEXTS.text(match step {
        Step::Gateway => "check.gateway",
        Step::WordOrder => "check.word_order",
        Step::InputWord => "check.input_word",
        Step::Identity => "check.identity",
        Step::Handshake => "check.handshake",
        Step::Temperature => "check.warmth",
        Step::Wear => "check.stores",
    })
}

fn finding(finding: &Finding) -> Text {
    match finding {
        Finding::Replies { asked, slowest_ms } => {
            TEXTS.text("ib_check.replies").with("asked", asked).with("slowest", slowest_ms)
        }
        Finding::OrderFits => TEXTS.text("ib_check.order_fits"),
        Finding::OrderSwapped { input, swapped } => {
            TEXTS.text("ib_check.order_swapped").with("input", word(*input)).with("swapped", word(*swapped))
        }
        Finding::Runs(input) => TEXTS.text("ib_check.runs").with("word", word(*input)),
        Finding::Stray(input) => TEXTS.text("ib_check.stray").with("word", word(*input)),
        Finding::Error(error) => TEXTS
            .text("ib_check.error")
            .with("word", word(Reply::Error(*error).emit()))
            .with_text("why", refusal(*error)),
        Finding::Occupied(input) => TEXTS.text("ib_check.occupied").with("word", word(*input)),
        Finding::SerialNumber(number) => Text::new("check.serial").with("number", number),
        Finding::SoftwareVersion(version) => TEXTS.text("ib_check.version").with("version", version),
        Finding::Gear { steps, turns } => TEXTS.text("ib_check.gear").with("steps", steps).with("turns", turns),
        Finding::Implausible(why) => implausible(*why),
        Finding::PresetBeyond { preset, last } => {
            TEXTS.text("ib_check.preset_beyond").with("preset", preset).with("last", last)
        }
        Finding::StepsMinusOne => TEXTS.text("ib_check.steps_minus_one"),
        Finding::Mode(mode) => TEXTS.text("ib_check.mode").with_text("mode", startup(*mode)),
        Finding::ReadOuts { asked, each_ms } => {
            TEXTS.text("ib_check.read_outs").with("asked", asked).with("each", each_ms)
        }
        Finding::Failed(error) => encoder(error),
        Finding::Temperature(tenths) => {
            TEXTS.text("ib_check.celsius").with_number("celsius", f64::from(*tenths) / 10.0, 1)
        }
        Finding::Wear { seen, limit } => TEXTS.text("ib_check.wear").with("seen", seen).with("limit", limit),
    }
}
