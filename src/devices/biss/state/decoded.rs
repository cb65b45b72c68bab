//! Decoded register values as text. They follow the register's description, except in the data sheet and for registers
//! with a role.

use super::encoder::Encoder;
use super::format;
use super::table::RegisterEntry;
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::app::number::decimal_places;
use crate::devices::biss::protocol::{DecodedValue, Eds, EdsBank, ProfileId, Register, RegisterAddress, Role};
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as explained;

impl Encoder {
    /// Returns the meaning of a register value, or `None` if the register has not been read or its number is
    /// self-explanatory.
    pub fn describe_register(&self, shown: &RegisterEntry<'_>) -> Option<Text> {
        let register = &shown.row.register;
        let bytes = shown.bytes.as_deref()?;
        if let Some(text) = register.role.and_then(|role| self.role_meaning(role, bytes)) {
            return Some(text);
        }
        Some(match register.decode(bytes)? {
            DecodedValue::Scaled(value) => quantity_text(value, &register.unit),
            DecodedValue::Number(number) if !register.unit.is_empty() => quantity_text(number as f64, &register.unit),
            DecodedValue::Number(_) | DecodedValue::Hex(_) => return self.data_sheet_meaning(register, bytes),
            DecodedValue::Bits(set) if set.is_empty() => TEXTS.text("registers.no_bit"),
            DecodedValue::Bits(set) => {
                let named = |(bit, name): (u8, Option<_>)| {
                    name.map_or_else(|| literal_text(format!("b{bit}")), explained::name_text)
                };
                Text::new("plain.words").with_list("words", set.into_iter().map(named))
            }
            DecodedValue::Choice(_, Some(name)) => explained::name_text(name),
            DecodedValue::Choice(_, None) => TEXTS.text("registers.unknown_value"),
            DecodedValue::Text(text) => literal_text(text),
        })
    }

    fn role_meaning(&self, role: Role, bytes: &[u8]) -> Option<Text> {
        let description = self.description.as_deref()?;
        match (role, bytes) {
            (Role::BankSelect | Role::EdsBank, [bank]) => {
                let group = self.table.position(Some(*bank)).and_then(|at| self.table.groups().get(at));
                group.and_then(|group| group.name.as_ref()).map(explained::name_text)
            }
            (Role::Profile, [high, low]) => {
                let is_standard = ProfileId::new(u16::from_be_bytes([*high, *low])).is_standard_encoder_profile();
                Some(TEXTS.text(if is_standard { "registers.standard" } else { "registers.other_profile" }))
            }
            (Role::Password, [byte]) => {
                let is_open = *byte == description.lock()?.password;
                Some(TEXTS.text(if is_open { "registers.open" } else { "registers.locked" }))
            }
            (Role::DeviceId, bytes) => {
                let is_own = description.identity()?.device_id == bytes;
                Some(if is_own { literal_text(description.name()) } else { TEXTS.text("registers.other_device") })
            }
            _ => None,
        }
    }

    /// Returns the meaning of data sheet fields that a description cannot define, such as times, banks, polynomials and
    /// the checksum.
    fn data_sheet_meaning(&self, register: &Register, bytes: &[u8]) -> Option<Text> {
        let offset = register.address.address();
        let bank = [EdsBank::Common, EdsBank::Encoder]
            .into_iter()
            .find(|own| !register.name.is_empty() && register.address.bank() == Some(own.kit_number()))?;
        if offset == Eds::CHECKSUM_OFFSET {
            let all =
                self.memory.bytes(RegisterAddress::bank_start(bank.kit_number()), RegisterAddress::BANK_SIZE.into())?;
            return Some(match Eds::parse(bank, all.try_into().ok()?) {
                Ok(_) => TEXTS.text("sheet_card.sum"),
                Err(_) => TEXTS.text("registers.wrong_sum"),
            });
        }
        let field = bank.fields().iter().find(|field| field.offset == offset)?;
        let mut own = [0; 64];
        own.get_mut(usize::from(offset)..usize::from(offset) + bytes.len())?.copy_from_slice(bytes);
        format::explained_value_text(field.value(&own))
    }
}

/// Formats a quantity with its unit and at most three decimals.
fn quantity_text(value: f64, unit: &str) -> Text {
    let value = (value * 1000.0).round() / 1000.0;
    TEXTS.text("registers.quantity").with_number("value", value, decimal_places(value)).with("unit", unit)
}

#[cfg(test)]
mod tests {
    use crate::app::session::Session;
    use std::sync::Arc;

    use super::*;
    use crate::app::KindRegistry;
    use crate::app::Language;
    use crate::app::studio::SessionId;
    use crate::devices::biss::protocol::Descriptions;

    fn meaning_text(encoder: &Encoder, at: &str, language: Language) -> String {
        let at: RegisterAddress = at.parse().unwrap();
        let group = &encoder.table.groups()[encoder.table.position(at.bank()).unwrap()];
        let row = group.rows().iter().position(|row| row.register.address == at).unwrap();
        let shown = group.entry(row, &encoder.memory).unwrap();
        encoder.describe_register(&shown).map(|text| text.to_string_in(language)).unwrap_or_default()
    }

    /// Covers every register in section 4 of the reference whose raw number is not self-explanatory.
    #[test]
    fn decodes_every_reference_register() {
        let mut encoder =
            Encoder::from_session(Session::for_link(SessionId::default(), "sim:".parse().unwrap(), KindRegistry::NONE));
        let kit = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").unwrap().clone();
        encoder.set_description(Some(Arc::new(kit.clone())));
        for register in kit.registers() {
            let bytes =
                if register.default.is_empty() { vec![0; register.width.into()] } else { register.default.clone() };
            encoder.memory.store_bytes(register.address, &bytes);
        }
        for bank in [EdsBank::Common, EdsBank::Encoder] {
            encoder
                .memory
                .store_bytes(RegisterAddress::bank_start(bank.kit_number()), &Eds::factory_default(bank).emit());
        }
        for (at, byte) in [("0x66", 0x4B), ("0x68", 0x12), ("0x40", 0x24), ("0x00:0x09", 53)] {
            encoder.memory.store_bytes(at.parse().unwrap(), &[byte]);
        }
        for (at, english, german) in [
            ("0x40", "OEM data", "OEM-Daten"),
            ("0x41", "EDS, common", "EDS, allgemein"),
            ("0x42", "BiSS profile 3", "BiSS-Profil 3"),
            ("0x66", "25 °C", "25 °C"),
            (
                "0x68",
                "multiturn synchronisation error, magnetic field too low",
                "Multiturn-Synchronisationsfehler, Magnetfeld zu schwach",
            ),
            ("0x6A", "operation", "Betrieb"),
            ("0x6B", "device modes locked", "Gerätemodi gesperrt"),
            ("0x6E", "balanced", "ausgewogen"),
            ("0x78", "POSITAL IXARC kit encoder", "POSITAL IXARC kit encoder"),
            ("0x7E", "Fr", "Fr"),
            ("0x00:0x09", "5.3 V", "5,3 V"),
            ("0x02:0x01", "2 banks", "2 Bänke"),
            ("0x02:0x05", "unit not documented", "Einheit nicht dokumentiert"),
            ("0x02:0x11", "1 slave address", "1 Slave-Adresse"),
            ("0x02:0x17", "0x43", "0x43"),
            ("0x02:0x3F", "checksum correct", "Prüfsumme stimmt"),
            ("0x03:0x04", "error, active low", "Fehler, low-aktiv"),
            ("0x03:0x30", "-40 °C", "-40 °C"),
            ("0x03:0x2C", "12000 1/min", "12000 1/min"),
        ] {
            assert_eq!(meaning_text(&encoder, at, Language::English), english, "{at}");
            assert_eq!(meaning_text(&encoder, at, Language::German), german, "{at}");
        }
        encoder.memory.store_bytes("0x03:0x0A".parse().unwrap(), &[0x0C]);
        assert_eq!(meaning_text(&encoder, "0x03:0x3F", Language::English), "wrong checksum");
    }
}
