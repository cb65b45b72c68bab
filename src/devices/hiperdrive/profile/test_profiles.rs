//! Test profiles: a hub with drives.

use super::{HiperdriveProfile, Image, ProfileDrive, ProfileIdentity};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Topology, Variant};

/// Factory values of an HDA30 drive that is requested (reference, sections 4 and 5).
const DRIVE: [(u16, i64); 13] = [
    (152, 1),
    (154, 256),
    (156, 1),
    (158, -33_488_896),
    (160, 33_488_896),
    (162, 10),
    (164, 1),
    (166, 350),
    (186, 20),
    (188, 1),
    (190, 38_400),
    (192, 5),
    (198, 0),
];

pub(super) fn parameter(own: u16) -> ParameterNumber {
    ParameterNumber::new(own).unwrap()
}

pub(super) fn drive(place: u8) -> DriveNumber {
    DriveNumber::new(place).unwrap()
}

pub(super) fn image_with_values(values: &[(u16, i64)]) -> Image {
    Image { values: values.iter().map(|(own, value)| (parameter(*own), *value)).collect() }
}

pub(super) fn image(places: &[u8]) -> Image {
    let mut image = image_with_values(&[(24, 0), (26, 7)]);
    for place in places {
        let own = DRIVE.iter().map(|(own, value)| (ParameterNumber::for_drive(*own, drive(*place)).unwrap(), *value));
        image.values.extend(own);
    }
    image
}

pub(super) fn identity(serial_number: &str, drives: &[(u8, &str)]) -> ProfileIdentity {
    ProfileIdentity {
        topology: Some(Topology::Hub4),
        name: "HIPERDRIVE".to_owned(),
        article_number: "7800.0100".to_owned(),
        serial_number: serial_number.to_owned(),
        version: "1.02".to_owned(),
        drives: drives
            .iter()
            .map(|(place, serial_number)| ProfileDrive {
                variant: Some(Variant::new(7)),
                name: "HDA30A".to_owned(),
                serial_number: (*serial_number).to_owned(),
                ..ProfileDrive::unknown_drive(drive(*place))
            })
            .collect(),
        unknown: Default::default(),
    }
}

/// Creates the profile of a hub with serial number 100, and drives 4711 and 4712 in ports 1 and 3.
pub(super) fn profile() -> HiperdriveProfile {
    HiperdriveProfile::from_image(identity("100", &[(1, "4711"), (3, "4712")]), image(&[1, 3]))
}
