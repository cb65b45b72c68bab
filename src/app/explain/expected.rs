//! Descriptions of the values that a parameter, a setting or an entry accepts.

use crate::app::Text;
use crate::expected::{Expected, Quantity};

pub fn expected(expected: &Expected) -> Text {
    match expected {
        Expected::Words(words) => match &**words {
            [before @ .., last] if !before.is_empty() => {
                Text::new("expected.words").with("before", before.join(", ")).with("last", last)
            }
            words => super::plain(words.concat()),
        },
        Expected::OneOf(names) => Text::new("expected.one_of").with("list", names.join(", ")),
        Expected::Range { quantity: own, low, high } => {
            let range = Text::new("expected.range").with_text("quantity", quantity(*own));
            range.with_digits("low", low).with_digits("high", high)
        }
        Expected::Whole => Text::new("expected.whole"),
        Expected::Number32 => Text::new("expected.number_32"),
        Expected::Speed { most } => Text::new("expected.speed").with("most", most),
        Expected::RevolutionsAMinute { most } => Text::new("expected.revolutions").with("most", most),
        Expected::Seconds { low, high } => {
            Text::new("expected.seconds").with_digits("low", low).with_digits("high", high)
        }
        Expected::BitRate { low, high } => Text::new("expected.bit_rate").with("low", low).with("high", high),
        Expected::Periods { most } => Text::new("expected.periods").with("most", most),
        Expected::MostTurns { most } => Text::new("expected.turns").with("most", most),
        Expected::StepsOfTurns { low, high } => {
            Text::new("expected.steps_of_turns").with("low", low).with("high", high)
        }
        Expected::OnlyWith(other) => Text::new("expected.only_with").with("other", other),
        Expected::Polynomial => Text::new("expected.polynomial"),
        Expected::ShortFrame => Text::new("expected.short_frame"),
        Expected::AddressOrOnlyOne => Text::new("expected.address_or_only_one"),
        Expected::BusAddress { last } => Text::new("expected.bus_address").with("last", format!("{last:#04X}")),
        Expected::FirstAddress { last } => Text::new("expected.first_address").with("last", format!("{last:#04X}")),
        Expected::TimeoutBits => Text::new("expected.timeout_bits"),
        Expected::TypeByte => Text::new("expected.type_byte"),
        Expected::SettingsByte => Text::new("expected.settings_byte"),
        Expected::SerialNumber => Text::new("expected.serial_number"),
        Expected::Ascii { most } => Text::new("expected.ascii").with("most", most),
        Expected::Steps => Text::new("expected.steps"),
        Expected::AccessCodes => Text::new("expected.access_codes"),
        Expected::Release => Text::new("expected.release"),
        Expected::ErrorRegister => Text::new("expected.error_register"),
        Expected::WriteCycles => Text::new("expected.write_cycles"),
        Expected::Stores => Text::new("expected.stores"),
        Expected::Pulses => Text::new("expected.pulses"),
        Expected::Program => Text::new("expected.program"),
        Expected::Hub => Text::new("expected.hub"),
        Expected::SwitchDigits => Text::new("expected.switch_digits"),
        Expected::Variant => Text::new("expected.variant"),
        Expected::Places { count } => Text::new("expected.places").with("count", count),
        Expected::Family => Text::new("expected.family"),
        Expected::ErrorBits(names) => Text::new("expected.error_bits").with("names", names.join(", ")),
        Expected::NoErrorBits => Text::new("expected.no_error_bits"),
        Expected::Text => Text::new("expected.text"),
        Expected::TextSuchAs(example) => Text::new("expected.text_such_as").with("example", format!("{example:?}")),
        Expected::Byte => Text::new("expected.byte"),
        Expected::Word => Text::new("expected.word"),
        Expected::HexLines => Text::new("expected.hex_lines"),
        Expected::Structure => Text::new("expected.structure"),
        Expected::Names => Text::new("expected.names"),
        Expected::List => Text::new("expected.list"),
        Expected::Map => Text::new("expected.map").with("brace", "{"),
        Expected::FourTenths => Text::new("expected.four_tenths"),
        Expected::Banks => Text::new("expected.banks"),
        Expected::Revolutions => Text::new("expected.revolutions_text"),
        Expected::Fraction => Text::new("expected.fraction"),
        Expected::Frame => Text::new("expected.frame"),
        Expected::ParityBit => Text::new("expected.parity_bit"),
        Expected::Repetition => Text::new("expected.repetition"),
        Expected::Clocks => Text::new("expected.clocks"),
    }
}

fn quantity(quantity: Quantity) -> Text {
    Text::new(match quantity {
        Quantity::Number => "quantity.number",
        Quantity::Milliseconds => "quantity.milliseconds",
        Quantity::Microseconds => "quantity.microseconds",
        Quantity::Hertz => "quantity.hertz",
        Quantity::Bits => "quantity.bits",
        Quantity::Steps => "quantity.steps",
        Quantity::Turns => "quantity.turns",
        Quantity::Position => "quantity.position",
        Quantity::PlaceOfDisc => "quantity.place_of_disc",
        Quantity::Celsius => "quantity.celsius",
        Quantity::WholeCelsius => "quantity.whole_celsius",
        Quantity::TenthsOfRpm => "quantity.tenths_of_rpm",
        Quantity::Torque => "quantity.torque",
        Quantity::Version => "quantity.version",
        Quantity::Address => "quantity.address",
        Quantity::Port => "quantity.port",
        Quantity::Unit => "quantity.unit",
        Quantity::InputRegister => "quantity.input_register",
        Quantity::HoldingRegister => "quantity.holding_register",
        Quantity::Cycles => "quantity.cycles",
        Quantity::Encoders => "quantity.encoders",
        Quantity::SwitchPosition => "quantity.switch_position",
        Quantity::Volts => "quantity.volts",
        Quantity::DamagedFrames => "quantity.damaged_frames",
        Quantity::RefusedRequests => "quantity.refused_requests",
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::app::COMMON;
    use crate::app::Language::{English, German};
    use crate::app::explain::in_both_languages;
    use crate::expected::Limit;

    const QUANTITIES: [Quantity; 25] = [
        Quantity::Number,
        Quantity::Milliseconds,
        Quantity::Microseconds,
        Quantity::Hertz,
        Quantity::Bits,
        Quantity::Steps,
        Quantity::Turns,
        Quantity::Position,
        Quantity::PlaceOfDisc,
        Quantity::Celsius,
        Quantity::WholeCelsius,
        Quantity::TenthsOfRpm,
        Quantity::Torque,
        Quantity::Version,
        Quantity::Address,
        Quantity::Port,
        Quantity::Unit,
        Quantity::InputRegister,
        Quantity::HoldingRegister,
        Quantity::Cycles,
        Quantity::Encoders,
        Quantity::SwitchPosition,
        Quantity::Volts,
        Quantity::DamagedFrames,
        Quantity::RefusedRequests,
    ];

    fn samples() -> Vec<Expected> {
        vec![
            Expected::words(&["auto", "on", "off"]),
            Expected::OneOf(vec!["skm36".to_owned(), "sks36".to_owned()]),
            Expected::number(1, 8),
            Expected::Whole,
            Expected::Number32,
            Expected::Speed { most: 12_000 },
            Expected::RevolutionsAMinute { most: 1000 },
            Expected::Seconds { low: Limit::thousandths(500), high: 60.into() },
            Expected::BitRate { low: 300, high: 4_000_000 },
            Expected::Periods { most: 7 },
            Expected::MostTurns { most: 7 },
            Expected::StepsOfTurns { low: 1, high: 8192 },
            Expected::OnlyWith("periods="),
            Expected::Polynomial,
            Expected::ShortFrame,
            Expected::AddressOrOnlyOne,
            Expected::BusAddress { last: 0x5F },
            Expected::FirstAddress { last: 0x5E },
            Expected::TimeoutBits,
            Expected::TypeByte,
            Expected::SettingsByte,
            Expected::SerialNumber,
            Expected::Ascii { most: 32 },
            Expected::Steps,
            Expected::AccessCodes,
            Expected::Release,
            Expected::ErrorRegister,
            Expected::WriteCycles,
            Expected::Stores,
            Expected::Pulses,
            Expected::Program,
            Expected::Hub,
            Expected::SwitchDigits,
            Expected::Variant,
            Expected::Places { count: 4 },
            Expected::Family,
            Expected::ErrorBits(vec!["ERROR".to_owned()]),
            Expected::NoErrorBits,
            Expected::Text,
            Expected::TextSuchAs("0x24:0x10+3"),
            Expected::Byte,
            Expected::Word,
            Expected::HexLines,
            Expected::Structure,
            Expected::Names,
            Expected::List,
            Expected::Map,
            Expected::FourTenths,
            Expected::Banks,
            Expected::Revolutions,
            Expected::Fraction,
            Expected::Frame,
            Expected::ParityBit,
            Expected::Repetition,
            Expected::Clocks,
        ]
    }

    #[test]
    fn expected_values_are_explained_in_both_languages() {
        let mut told = BTreeSet::new();
        for own in samples() {
            let text = expected(&own);
            in_both_languages(&text, &own);
            told.insert(text.id());
        }
        for own in QUANTITIES {
            in_both_languages(&expected(&Expected::range(own, 1, 8)), &Expected::range(own, 1, 8));
            told.insert(quantity(own).id());
        }
        // A row that no sample reaches has a variant that is not above, or none.
        let rows = COMMON.ids().filter(|id| id.starts_with("expected.") || id.starts_with("quantity."));
        let missing: Vec<&str> = rows.filter(|id| !told.contains(id)).collect();
        assert!(missing.is_empty(), "no sample for {missing:?}");
    }

    #[test]
    fn limits_have_the_decimal_sign_of_the_language() {
        let volts = Expected::range(Quantity::Volts, Limit::thousandths(4750), Limit::thousandths(12_500));
        assert_eq!(expected(&volts).words(English), "a voltage in volts from 4.75 to 12.5");
        assert_eq!(expected(&volts).words(German), "eine Spannung in Volt von 4,75 bis 12,5");
    }
}
