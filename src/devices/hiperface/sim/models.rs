//! The encoder models that can be simulated. Types and geometries are taken from SICK data sheets, and field FFh from
//! the manual, "Inhalt des Datenfeldes FFh".

use crate::devices::hiperface::protocol::Geometry;

/// An encoder model with factory settings. Data field 0 contains what a motor manufacturer would write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Name used in `sim:?model=`.
    pub name: &'static str,
    /// Type code in the reply to 52h. FFh refers to the extended label.
    pub encoder_type: u8,
    pub geometry: Geometry,
    /// Whether the encoder has no bearing. Only such an encoder supports command 63h.
    pub kit: bool,
    pub serial_number: &'static str,
    pub firmware_version: &'static str,
    /// Firmware date in the format `DD.MM.YY`.
    pub firmware_date: &'static str,
    /// EEPROM size in units of 16 bytes, as reported by command 52h. The encoder itself uses part of it.
    pub eeprom_units: u8,
    /// Number of 16-byte blocks available for data fields.
    pub user_blocks: u8,
    pub options: u8,
    /// Initial position in steps.
    pub position: u32,
    /// Temperature in degrees Celsius above which code 1Eh is reported.
    pub temperature_limit: i16,
    /// Content of data field 0, in multiples of 16 bytes. A field of 32 bytes has the status C9h. If the content is
    /// empty, the encoder does not have the field.
    pub name_plate: &'static [u8],
    /// Content of field FFh, which is padded with 00h to 64 bytes. If it is empty, the encoder has no extended label.
    pub extended_label: &'static [u8],
}

/// All models. The first is the default.
#[rustfmt::skip]
pub const MODELS: [Model; 3] = [
    Model { name: "skm36", encoder_type: 0x37, geometry: rotary_geometry(128, 4096), serial_number: "GB0450179", position: 0x000E_0531, ..COMMON },
    Model { name: "sks36", encoder_type: 0x32, geometry: rotary_geometry(128, 1),    serial_number: "GB0463022", position: 0x0000_0531, ..COMMON },
    Model { name: "sel37", encoder_type: 0xFF, geometry: rotary_geometry(16, 4096),  serial_number: "1730A0042", position: 0x000E_0531, kit: true, name_plate: KIT_MOTOR, extended_label: SEL37_LABEL, ..COMMON },
];

const COMMON: Model = Model {
    name: "",
    encoder_type: 0,
    geometry: rotary_geometry(1, 1),
    kit: false,
    serial_number: "",
    firmware_version: "V1.23",
    firmware_date: "01.02.16",
    eeprom_units: 0x80,
    user_blocks: 112,
    options: 0x01,
    position: 0,
    temperature_limit: 115,
    name_plate: MOTOR,
    extended_label: &[],
};

const fn rotary_geometry(periods: u32, turns: u32) -> Geometry {
    Geometry::Rotary { periods, turns }
}

/// Name plate of a servo motor in a drive manufacturer's format: designation, several big-endian words and a 32-bit
/// serial number. The words are the speed in 1/min, the rated and peak current in units of 10 mA, the pole pairs, the
/// voltage, and the commutation offset in units of 1/65536 turn.
const MOTOR: &[u8] = b"EMD71K-4 3000rpm\x0B\xB8\x01\x22\x03\x66\x00\x03\x00\xE6\x2A\x5F\x00\x01\xE2\x40";

/// Name plate of the motor with the kit encoder, in the same format.
const KIT_MOTOR: &[u8] = b"SMK42-08 4500rpm\x11\x94\x00\xB4\x02\x1C\x00\x04\x00\x30\x71\xC4\x00\x03\x0D\x40";

/// Extended label with 16 periods, 4096 turns, and the valid limits 0 and 1: channel 48h and 115 °C. The first byte is
/// the XOR of all others.
const SEL37_LABEL: &[u8] = b"\x53\x00\x00\x00\x00\x10\x00\x00\x10\x00SEL37-HFB0-K02    \x00\x03\x00\x48\x00\x73";

impl Model {
    pub fn find(name: &str) -> Option<&'static Model> {
        MODELS.iter().find(|model| model.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperface::protocol::ExtendedLabel;

    #[test]
    fn models_are_consistent() {
        for model in MODELS {
            assert_eq!(Model::find(model.name), Some(&model));
            assert_eq!(model.serial_number.len(), 9, "{}", model.name);
            assert_eq!(model.firmware_date.len(), 8, "{}", model.name);
            assert!(model.firmware_version.len() <= 20, "{}", model.name);
            assert_eq!(model.name_plate.len(), 32, "{}", model.name);
            assert!(u64::from(model.position) < model.geometry.position_count().unwrap(), "{}", model.name);
            assert_eq!(model.encoder_type == 0xFF, !model.extended_label.is_empty(), "{}", model.name);
        }
        assert_eq!(Model::find("skm37"), None);
    }

    #[test]
    fn kit_encoder_label_matches_reference() {
        let label = ExtendedLabel::parse(SEL37_LABEL).unwrap();
        assert!(label.checksum_fits);
        assert_eq!(label.designation, "SEL37-HFB0-K02");
        assert_eq!(label.geometry, Some(rotary_geometry(16, 4096)));
    }
}
