//! Error messages about adapters that apply to all buses.

use crate::app::Text;
use crate::buses::bridge::procedures::AdapterError;
use crate::buses::bridge::protocol::{BodyError, ErrorCode, Operation};
use crate::buses::bridge::state::TEXTS;

pub fn adapter_error_text(error: &AdapterError) -> Text {
    match error {
        AdapterError::Silent => TEXTS.text("adapter.silent"),
        AdapterError::Version { expected, got } => {
            TEXTS.text("adapter.version").with("got", got).with("expected", expected)
        }
        AdapterError::NoBiss { name } => TEXTS.text("adapter.no_biss").with("name", name),
        AdapterError::NoSsi { name } => TEXTS.text("adapter.no_ssi").with("name", name),
        AdapterError::NoAnalog { name } => TEXTS.text("adapter.no_analogue").with("name", name),
        AdapterError::NoUart { name } => TEXTS.text("adapter.no_uart").with("name", name),
        AdapterError::NoSupply { name } => TEXTS.text("adapter.no_supply").with("name", name),
        AdapterError::Overvoltage { given, measured, greatest } => TEXTS
            .text("adapter.overvoltage")
            .with_number("given", volts(*given), 2)
            .with_number("measured", volts(*measured), 2)
            .with_number("greatest", volts(*greatest), 2),
        AdapterError::StreamSilent => TEXTS.text("adapter.mute"),
        AdapterError::Restarted => TEXTS.text("adapter.restarted"),
        AdapterError::Data { cause } => TEXTS.text("adapter.data").with_text("why", body_error_text(cause)),
        AdapterError::Refused { operation, code, text } => TEXTS
            .text("adapter.refused")
            .with("operation", operation_number(*operation))
            .with_text("why", reason(*code))
            .with("text", text),
        AdapterError::Reply { operation, cause } => TEXTS
            .text("adapter.reply")
            .with("operation", operation_number(*operation))
            .with_text("why", body_error_text(cause)),
        AdapterError::Other { requested, got } => {
            TEXTS.text("adapter.other").with("asked", operation_number(*requested)).with("got", operation_number(*got))
        }
    }
}

fn reason(code: ErrorCode) -> Text {
    match code {
        ErrorCode::NOT_SUPPORTED => TEXTS.text("adapter.not_supported"),
        ErrorCode::BAD_ARGUMENT => TEXTS.text("adapter.bad_argument"),
        ErrorCode::BUSY => TEXTS.text("adapter.busy"),
        ErrorCode::NO_REPLY => TEXTS.text("adapter.no_answer"),
        ErrorCode::INVALID_REPLY => TEXTS.text("adapter.wrong_answer"),
        ErrorCode::OVERRUN => TEXTS.text("adapter.overrun"),
        other => TEXTS.text("adapter.unknown_code").with("code", other.byte()),
    }
}

fn body_error_text(error: &BodyError) -> Text {
    let of = |id, op: u8| TEXTS.text(id).with("operation", format!("0x{op:02X}"));
    match *error {
        BodyError::Length { op, got } => of("adapter.body_length", op).with("got", got),
        BodyError::Operation(op) => of("adapter.body_operation", op),
        BodyError::Value { op, field, got } => of("adapter.body_value", op).with("field", field).with("got", got),
        BodyError::Text { op } => of("adapter.body_text", op),
        BodyError::Version { expected, got } => {
            TEXTS.text("adapter.body_version").with("expected", expected).with("got", got)
        }
    }
}

fn volts(millivolt: u16) -> f64 {
    f64::from(millivolt) / 1000.0
}

fn operation_number(operation: Operation) -> String {
    format!("0x{:02X}", operation.byte())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::app::explain::{assert_in_both_languages, setting_error_text};
    use crate::buses::bridge::sim::Adapter;
    use crate::kinds::attachable_kinds;
    use crate::link::UrlQuery;

    #[test]
    fn error_codes_have_distinct_texts() {
        let words = |code: u8, language| {
            let text = "streaming".to_owned();
            let code = ErrorCode::new(code);
            adapter_error_text(&AdapterError::Refused { operation: Operation::BissConfig, code, text })
                .to_string_in(language)
        };
        let mut said: Vec<String> = (0..=7).map(|code| words(code, English)).collect();
        assert!(said.iter().all(|words| words.contains("0x20") && words.contains("streaming")), "{said:?}");
        assert!(said[0].contains('0') && said[7].contains('7'), "{said:?}");
        said.extend((0..=7).map(|code| words(code, German)));
        said.sort();
        said.dedup();
        assert_eq!(said.len(), 16);
    }

    #[test]
    fn explains_missing_capabilities_and_stream_ends() {
        let name = || "box".to_owned();
        let cause = BodyError::Operation(0x94);
        let cases = [
            (AdapterError::NoBiss { name: name() }, "box"),
            (AdapterError::NoSsi { name: name() }, "box"),
            (AdapterError::NoAnalog { name: name() }, "box"),
            (AdapterError::NoUart { name: name() }, "box"),
            (AdapterError::NoSupply { name: name() }, "box"),
            (AdapterError::Overvoltage { given: 5_000, measured: 5_600, greatest: 5_500 }, "60 V"),
            (AdapterError::StreamSilent, "."),
            (AdapterError::Restarted, "."),
            (AdapterError::Data { cause }, "0x94"),
            (AdapterError::Reply { operation: Operation::Hello, cause }, "0x94"),
            (AdapterError::Other { requested: Operation::Hello, got: Operation::Supply }, "0x02"),
        ];
        for (error, fact) in cases {
            let (english, german) =
                (adapter_error_text(&error).to_string_in(English), adapter_error_text(&error).to_string_in(German));
            assert!(english.contains(fact) && german.contains(fact), "{english} {german}");
            assert_ne!(english, german);
        }
    }

    #[test]
    fn explains_damaged_body_in_both_languages() {
        let errors = [
            BodyError::Length { op: 0x20, got: 3 },
            BodyError::Operation(0x94),
            BodyError::Value { op: 0x20, field: "voltage", got: 7 },
            BodyError::Text { op: 0x01 },
            BodyError::Version { expected: 1, got: 2 },
        ];
        for error in errors {
            assert_in_both_languages(&body_error_text(&error), &error);
        }
    }

    #[test]
    fn explains_setting_errors_in_both_languages() {
        let queries = "sed=1 seed=x firmware=1 serial=x rpm=x waver=x position=x temperature=x errors=x filter=x \
                       cycles=x pulses=x calibration=x calibration-silent=x echo=x order=x line=x noise=x ssi=x \
                       ssi-error=x ssi=afs60&ssi-error=x supply=x uart=x motor=x version=x";
        for text in queries.split_whitespace() {
            let query: UrlQuery = text.parse().unwrap();
            let error = Adapter::from_pairs(query.pairs(), attachable_kinds()).err().unwrap();
            assert_in_both_languages(&setting_error_text(&error), &error);
        }
    }
}
