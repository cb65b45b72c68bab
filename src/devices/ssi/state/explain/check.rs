//! Messages of the device check.

use super::finding_text as said;
use crate::app::Text;
use crate::app::check::CheckResultLine;
use crate::app::explain::literal_text;
use crate::devices::ssi::procedures::check::{CheckFinding, CheckStep, SsiStepResult};
use crate::devices::ssi::state::TEXTS;

pub fn check_lines(lines: &[SsiStepResult]) -> Vec<CheckResultLine> {
    lines.iter().map(|line| CheckResultLine::from_step(line, check_step_text, finding_text)).collect()
}

fn check_step_text(step: CheckStep) -> Text {
    TEXTS.text(match step {
        CheckStep::Adapter => "ssi_check.adapter",
        CheckStep::Supply => "ssi_check.supply",
        CheckStep::Line => "check.line",
        CheckStep::Layout => "ssi_check.layout",
        CheckStep::Errors => "ssi_check.errors",
        CheckStep::Motion => "ssi_check.motion",
    })
}

fn finding_text(finding: &CheckFinding) -> Text {
    match finding {
        CheckFinding::Adapter(name, firmware) => literal_text(format!("{name} {firmware}")),
        CheckFinding::Clock { asked, got } if asked == got => {
            TEXTS.text("ssi_check.clock").with_number("khz", f64::from(*got) / 1000.0, 0)
        }
        CheckFinding::Clock { asked, got } => TEXTS
            .text("ssi_check.other_clock")
            .with_number("asked", f64::from(*asked) / 1000.0, 0)
            .with_number("khz", f64::from(*got) / 1000.0, 0),
        CheckFinding::Supply { requested, measured, milliampere } => TEXTS
            .text("ssi_check.supplies")
            .with_number("wished", f64::from(*requested) / 1000.0, 1)
            .with_number("volts", f64::from(*measured) / 1000.0, 2)
            .with("milliampere", milliampere),
        CheckFinding::SuppliedElsewhere => TEXTS.text("ssi_check.elsewhere"),
        CheckFinding::Words { taken, different } => {
            TEXTS.text("ssi_check.words").with("taken", taken).with("different", different)
        }
        CheckFinding::FindingInWords { finding: what, count } => {
            TEXTS.text("ssi_check.said").with("count", count).with_text("what", said(what))
        }
        CheckFinding::Fits => TEXTS.text("ssi_check.fits"),
        CheckFinding::Silent => TEXTS.text("ssi_check.silent"),
        CheckFinding::Stands { position, steps } => {
            TEXTS.text("ssi_check.stands").with("position", position).with("steps", steps)
        }
        CheckFinding::Turns { most } => TEXTS.text("ssi_check.turns").with("most", most),
    }
}
