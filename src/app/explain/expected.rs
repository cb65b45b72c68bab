//! Descriptions of the values that a parameter, setting or entry accepts.

use crate::app::Text;
use crate::expected::{AllowedValues, Quantity};

pub fn expected_text(expected: &AllowedValues) -> Text {
    match expected {
        AllowedValues::Words(words) => match &**words {
            [before @ .., last] if !before.is_empty() => {
                Text::new("expected.words").with("before", before.join(", ")).with("last", last)
            }
            words => super::literal_text(words.concat()),
        },
        AllowedValues::OneOf(names) => Text::new("expected.one_of").with("list", names.join(", ")),
        AllowedValues::Range { quantity: own, low, high } => {
            let range = Text::new("expected.range").with_text("quantity", quantity_name(*own));
            range.with_formatted_number("low", low).with_formatted_number("high", high)
        }
        AllowedValues::Whole => Text::new("expected.whole"),
        AllowedValues::Number32 => Text::new("expected.number_32"),
        AllowedValues::Speed { most } => Text::new("expected.speed").with("most", most),
        AllowedValues::UnidirectionalSpeed { most } => Text::new("expected.revolutions").with("most", most),
        AllowedValues::Seconds { low, high } => {
            Text::new("expected.seconds").with_formatted_number("low", low).with_formatted_number("high", high)
        }
        AllowedValues::BitRate { low, high } => Text::new("expected.bit_rate").with("low", low).with("high", high),
        AllowedValues::Periods { most } => Text::new("expected.periods").with("most", most),
        AllowedValues::MostTurns { most } => Text::new("expected.turns").with("most", most),
        AllowedValues::StepsOfTurns { low, high } => {
            Text::new("expected.steps_of_turns").with("low", low).with("high", high)
        }
        AllowedValues::OnlyWith(other) => Text::new("expected.only_with").with("other", other),
        AllowedValues::Polynomial => Text::new("expected.polynomial"),
        AllowedValues::ShortFrame => Text::new("expected.short_frame"),
        AllowedValues::AddressOrOnlyOne => Text::new("expected.address_or_only_one"),
        AllowedValues::BusAddress { last } => Text::new("expected.bus_address").with("last", format!("{last:#04X}")),
        AllowedValues::FirstAddress { last } => {
            Text::new("expected.first_address").with("last", format!("{last:#04X}"))
        }
        AllowedValues::TimeoutBits => Text::new("expected.timeout_bits"),
        AllowedValues::TypeByte => Text::new("expected.type_byte"),
        AllowedValues::SettingsByte => Text::new("expected.settings_byte"),
        AllowedValues::SerialNumber => Text::new("expected.serial_number"),
        AllowedValues::Ascii { most } => Text::new("expected.ascii").with("most", most),
        AllowedValues::Steps => Text::new("expected.steps"),
        AllowedValues::AccessCodes => Text::new("expected.access_codes"),
        AllowedValues::FirmwareVersion => Text::new("expected.release"),
        AllowedValues::ErrorRegister => Text::new("expected.error_register"),
        AllowedValues::WriteCycles => Text::new("expected.write_cycles"),
        AllowedValues::Stores => Text::new("expected.stores"),
        AllowedValues::Pulses => Text::new("expected.pulses"),
        AllowedValues::Program => Text::new("expected.program"),
        AllowedValues::Hub => Text::new("expected.hub"),
        AllowedValues::SwitchDigits => Text::new("expected.switch_digits"),
        AllowedValues::Variant => Text::new("expected.variant"),
        AllowedValues::Places { count } => Text::new("expected.places").with("count", count),
        AllowedValues::Family => Text::new("expected.family"),
        AllowedValues::ErrorBits(names) => Text::new("expected.error_bits").with("names", names.join(", ")),
        AllowedValues::NoErrorBits => Text::new("expected.no_error_bits"),
        AllowedValues::Text => Text::new("expected.text"),
        AllowedValues::TextSuchAs(example) => {
            Text::new("expected.text_such_as").with("example", format!("{example:?}"))
        }
        AllowedValues::Byte => Text::new("expected.byte"),
        AllowedValues::Word => Text::new("expected.word"),
        AllowedValues::HexLines => Text::new("expected.hex_lines"),
        AllowedValues::Structure => Text::new("expected.structure"),
        AllowedValues::Names => Text::new("expected.names"),
        AllowedValues::List => Text::new("expected.list"),
        AllowedValues::Map => Text::new("expected.map").with("brace", "{"),
        AllowedValues::FourTenths => Text::new("expected.four_tenths"),
        AllowedValues::Banks => Text::new("expected.banks"),
        AllowedValues::Revolutions => Text::new("expected.revolutions_text"),
        AllowedValues::Fraction => Text::new("expected.fraction"),
        AllowedValues::Frame => Text::new("expected.frame"),
        AllowedValues::ParityBit => Text::new("expected.parity_bit"),
        AllowedValues::Repetition => Text::new("expected.repetition"),
        AllowedValues::Clocks => Text::new("expected.clocks"),
    }
}

fn quantity_name(quantity: Quantity) -> Text {
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
    use crate::app::explain::assert_in_both_languages;
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

    fn samples() -> Vec<AllowedValues> {
        vec![
            AllowedValues::words(&["auto", "on", "off"]),
            AllowedValues::OneOf(vec!["skm36".to_owned(), "sks36".to_owned()]),
            AllowedValues::number_range(1, 8),
            AllowedValues::Whole,
            AllowedValues::Number32,
            AllowedValues::Speed { most: 12_000 },
            AllowedValues::UnidirectionalSpeed { most: 1000 },
            AllowedValues::Seconds { low: Limit::from_thousandths(500), high: 60.into() },
            AllowedValues::BitRate { low: 300, high: 4_000_000 },
            AllowedValues::Periods { most: 7 },
            AllowedValues::MostTurns { most: 7 },
            AllowedValues::StepsOfTurns { low: 1, high: 8192 },
            AllowedValues::OnlyWith("periods="),
            AllowedValues::Polynomial,
            AllowedValues::ShortFrame,
            AllowedValues::AddressOrOnlyOne,
            AllowedValues::BusAddress { last: 0x5F },
            AllowedValues::FirstAddress { last: 0x5E },
            AllowedValues::TimeoutBits,
            AllowedValues::TypeByte,
            AllowedValues::SettingsByte,
            AllowedValues::SerialNumber,
            AllowedValues::Ascii { most: 32 },
            AllowedValues::Steps,
            AllowedValues::AccessCodes,
            AllowedValues::FirmwareVersion,
            AllowedValues::ErrorRegister,
            AllowedValues::WriteCycles,
            AllowedValues::Stores,
            AllowedValues::Pulses,
            AllowedValues::Program,
            AllowedValues::Hub,
            AllowedValues::SwitchDigits,
            AllowedValues::Variant,
            AllowedValues::Places { count: 4 },
            AllowedValues::Family,
            AllowedValues::ErrorBits(vec!["ERROR".to_owned()]),
            AllowedValues::NoErrorBits,
            AllowedValues::Text,
            AllowedValues::TextSuchAs("0x24:0x10+3"),
            AllowedValues::Byte,
            AllowedValues::Word,
            AllowedValues::HexLines,
            AllowedValues::Structure,
            AllowedValues::Names,
            AllowedValues::List,
            AllowedValues::Map,
            AllowedValues::FourTenths,
            AllowedValues::Banks,
            AllowedValues::Revolutions,
            AllowedValues::Fraction,
            AllowedValues::Frame,
            AllowedValues::ParityBit,
            AllowedValues::Repetition,
            AllowedValues::Clocks,
        ]
    }

    #[test]
    fn explains_expected_values_in_both_languages() {
        let mut told = BTreeSet::new();
        for own in samples() {
            let text = expected_text(&own);
            assert_in_both_languages(&text, &own);
            told.insert(text.id());
        }
        for own in QUANTITIES {
            assert_in_both_languages(
                &expected_text(&AllowedValues::range(own, 1, 8)),
                &AllowedValues::range(own, 1, 8),
            );
            told.insert(quantity_name(own).id());
        }
        // A row that no sample produces has a variant that is not listed above, or none.
        let rows = COMMON.ids().filter(|id| id.starts_with("expected.") || id.starts_with("quantity."));
        let missing: Vec<&str> = rows.filter(|id| !told.contains(id)).collect();
        assert!(missing.is_empty(), "no sample for {missing:?}");
    }

    #[test]
    fn formats_limits_for_language() {
        let volts =
            AllowedValues::range(Quantity::Volts, Limit::from_thousandths(4750), Limit::from_thousandths(12_500));
        assert_eq!(expected_text(&volts).to_string_in(English), "a voltage in volts from 4.75 to 12.5");
        assert_eq!(expected_text(&volts).to_string_in(German), "eine Spannung in Volt von 4,75 bis 12,5");
    }
}
