//! The device check in words.

use super::finding as said;
use crate::app::Text;
use crate::app::check::CheckLine;
use crate::app::explain::plain;
use crate::devices::ssi::procedures::check::{Finding, SsiStepResult, Step};
use crate::devices::ssi::state::TEXTS;

pub fn check(lines: &[SsiStepResult]) -> Vec<CheckLine> {
    lines.iter().map(|line| CheckLine::of(line, step, finding)).collect()
}

fn step(step: Step) -> Text {
    TEXTS.text(match step {
        Step::Adapter => "ssi_check.adapter",
        Step::Supply => "ssi_check.supply",
        Step::Line => "check.line",
        Step::Layout => "ssi_check.layout",
        Step::Errors => "ssi_check.errors",
        Step::Motion => "ssi_check.motion",
    })
}

fn finding(finding: &Finding) -> Text {
    match finding {
        Finding::Adapter(name, firmware) => plain(format!("{name} {firmware}")),
        Finding::Clock { asked, got } if asked == got => {
            TEXTS.text("ssi_check.clock").with_number("khz", f64::from(*got) / 1000.0, 0)
        }
        Finding::Clock { asked, got } => TEXTS
            .text("ssi_check.other_clock")
            .with_number("asked", f64::from(*asked) / 1000.0, 0)
            .with_number("khz", f64::from(*got) / 1000.0, 0),
        Finding::Supply { wished, measured, milliampere } => TEXTS
            .text("ssi_check.supplies")
            .with_number("wished", f64::from(*wished) / 1000.0, 1)
            .with_number("volts", f64::from(*measured) / 1000.0, 2)
            .with("milliampere", milliampere),
        Finding::SuppliedElsewhere => TEXTS.text("ssi_check.elsewhere"),
        Finding::Words { taken, different } => {
            TEXTS.text("ssi_check.words").with("taken", taken).with("different", different)
        }
        Finding::Said { what, count } => {
            TEXTS.text("ssi_check.said").with("count", count).with_text("what", said(what))
        }
        Finding::Fits => TEXTS.text("ssi_check.fits"),
        Finding::Silent => TEXTS.text("ssi_check.silent"),
        Finding::Stands { position, steps } => {
            TEXTS.text("ssi_check.stands").with("position", position).with("steps", steps)
        }
        Finding::Turns { most } => TEXTS.text("ssi_check.turns").with("most", most),
    }
}
