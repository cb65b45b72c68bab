//! Messages of the device check.

use super::encoder_error_text;
use super::format::{field_status, position_text, raw_position_text, status_with_number};
use crate::app::Text;
use crate::app::check::CheckResultLine;
use crate::app::explain::literal_text;
use crate::devices::hiperface::procedures::LineQuality;
use crate::devices::hiperface::procedures::check::{CheckFinding, CheckStep, HiperfaceStepResult};
use crate::devices::hiperface::state::TEXTS;

pub fn check_lines(lines: &[HiperfaceStepResult]) -> Vec<CheckResultLine> {
    lines.iter().map(|line| CheckResultLine::from_step(line, check_step_text, finding_text)).collect()
}

fn check_step_text(step: CheckStep) -> Text {
    TEXTS.text(match step {
        CheckStep::Restart => "check.restart",
        CheckStep::Status => "check.status",
        CheckStep::Identity => "check.identity",
        CheckStep::Position => "check.position",
        CheckStep::Limits => "check.limits",
        CheckStep::DataFields => "check.data_fields",
        CheckStep::Line => "check.line",
    })
}

pub fn line_quality(quality: &LineQuality) -> Text {
    let [retries, damaged, silent, late] = quality.counts();
    TEXTS
        .text(if quality.has_errors() { "line.troubled" } else { "line.good" })
        .with("requests", quality.requests)
        .with("retries", retries)
        .with("damaged", damaged)
        .with("silent", silent)
        .with("late", late)
}

fn finding_text(finding: &CheckFinding) -> Text {
    match finding {
        CheckFinding::Code(code) => status_with_number(*code),
        CheckFinding::Position(found) => position_text(*found),
        CheckFinding::RawPosition(raw) => raw_position_text(*raw),
        CheckFinding::Name(name) => literal_text(name),
        CheckFinding::SerialNumber(number) => literal_text(number),
        CheckFinding::Limit { channel, value, limit } => {
            let channel = format!("{channel:02X}h");
            TEXTS.text("check.limit").with("channel", channel).with("value", value).with("limit", limit)
        }
        CheckFinding::Field { number, status } => {
            TEXTS.text("check.field").with("number", number).with_text("status", field_status(*status))
        }
        CheckFinding::FieldLocked { number, status } => TEXTS
            .text("check.field_locked")
            .with("number", number)
            .with_text("status", field_status(*status))
            .with("code", status.code()),
        CheckFinding::FieldRefused { number, codes } => TEXTS
            .text("check.field_refused")
            .with("number", number)
            .with_list("codes", codes.iter().copied().map(status_with_number)),
        CheckFinding::FieldUnreadable { number, why } => {
            TEXTS.text("check.field_unreadable").with("number", number).with_text("why", encoder_error_text(why))
        }
        CheckFinding::Unreadable(why) => encoder_error_text(why),
        CheckFinding::Line(quality) => line_quality(quality),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::hiperface::protocol::{DataFieldStatus, StatusCode};

    #[test]
    fn finding_text_fits_terminal_and_window() {
        let status = DataFieldStatus::from_byte(0xAA);
        let cases = [
            (
                CheckFinding::FieldLocked { number: 1, status },
                "1: 48 bytes, write protected, code 2, code required, access code 2 is unknown",
                "Datenfeld 1: 48 Bytes, schreibgeschützt, Zugriffsschlüssel 2, Schlüssel erforderlich, \
                 Zugriffsschlüssel 2 ist unbekannt",
            ),
            (
                CheckFinding::FieldRefused { number: 3, codes: vec![StatusCode::WRONG_CODE, StatusCode::TEMPERATURE] },
                "3: 0Fh wrong access code, 1Eh critical encoder temperature",
                "Datenfeld 3: 0Fh falscher Zugriffsschlüssel, 1Eh kritische Gebertemperatur",
            ),
            (
                CheckFinding::Limit { channel: 0x48, value: 42, limit: 115 },
                "48h: 42 ≤ 115",
                "Kanal 48h: 42, Grenzwert 115",
            ),
            (CheckFinding::RawPosition(7), "7", "7 Schritte"),
            (CheckFinding::Name("SKM36".to_owned()), "SKM36", "SKM36"),
        ];
        for (found, terminal, german) in cases {
            assert_eq!(finding_text(&found).terminal_text(), terminal);
            assert_eq!(finding_text(&found).to_string_in(Language::German), german);
        }
    }
}
