//! Test profiles based on a kit encoder with factory settings.

use super::{Bank, BissProfile, DataImage, PresetSetting, ProfileIdentity, RecordedValues};
use crate::devices::biss::protocol::{Access, Area, Firmware, PositionFilter, PresetValue, ProfileId};

/// Returns the data areas from table 12 of the manual.
pub(super) fn data_areas() -> [Area; 2] {
    let area = |name: &str, first, last, open| Area {
        name: crate::devices::biss::protocol::Name::new(name),
        first,
        last,
        access: Access::Rw,
        open: Some(open),
    };
    [area("EDS motor data", 0x04, 0x23, 1), area("OEM data", 0x24, 0x43, 2)]
}

/// Returns the profile of a factory-new encoder with the latest known firmware.
pub(super) fn profile(serial_number: &str) -> BissProfile {
    let empty = |area: &Area| DataImage::new(area, area.banks().map(|number| Bank::filled_with(number, 0)).collect());
    BissProfile {
        identity: ProfileIdentity {
            serial_number: serial_number.to_owned(),
            profile_id: ProfileId::new(0x6129),
            device_id: [0x01, 0x01, 0x68, 0x11, 0x00, 0x01],
            manufacturer: *b"Fr",
            firmware: Some(Firmware::new(1, 6, 0)),
            description: "POSITAL IXARC kit encoder".to_owned(),
            multiturn_bits: Some(16),
            singleturn_bits: Some(17),
            unknown: Default::default(),
        },
        filter: Some(PositionFilter::Balanced),
        preset: Some(PresetSetting { value: PresetValue::default(), unknown: Default::default() }),
        recorded: RecordedValues::default(),
        mounting: Vec::new(),
        data: data_areas().iter().map(empty).collect(),
    }
}

/// Sets bytes in a bank, which is added to the profile if necessary.
pub(super) fn set_bank_bytes(profile: &mut BissProfile, number: u8, bytes: &[(usize, u8)]) {
    let mut bank = profile.bank(number).unwrap_or_else(|| Bank::filled_with(number, 0));
    for (at, byte) in bytes {
        if let Some(place) = bank.bytes.get_mut(*at) {
            *place = *byte;
        }
    }
    for image in profile.data.iter_mut().filter(|image| (image.first..=image.last).contains(&number)) {
        image.listed.retain(|listed| listed.bank.number != number);
        image.listed.push(bank.into());
        image.listed.sort_by_key(|listed| listed.bank.number);
    }
}
