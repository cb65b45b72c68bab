//! Tests of the fields and checksums against the data sheet in the reference, and of data sheets without a valid frame
//! layout.

use proptest::prelude::*;

use super::*;

/// Returns bank 2 from the reference, assembled by hand.
fn common() -> [u8; 64] {
    let mut bank = [0; 64];
    for (offset, bytes) in [
        (0x00, &[0x01, 0x02, 0x04, 0x43][..]),
        (0x05, &[0x1C, 0x30]),
        (0x0C, &[0x20]),
        (0x0E, &[0x01, 0xF4, 0x01, 0x01]),
        (0x14, &[0x03, 0x23, 0x00, 0x21]),
        (0x3F, &[0xF4]),
    ] {
        bank[offset..offset + bytes.len()].copy_from_slice(bytes);
    }
    bank
}

/// Returns bank 3 from the reference.
fn encoder() -> [u8; 64] {
    let mut bank = [0; 64];
    for (offset, bytes) in [
        (0x00, &[0x01, 0x01, 0x61, 0x29, 0x01, 0x02, 0xFF][..]),
        (0x0A, &[0x10, 0x00, 0x11]),
        (0x1F, &[0x21]),
        (0x2C, &[0x2E, 0xE0]),
        (0x30, &[0x00, 0xE9, 0x01, 0x7A, 0x13, 0x88, 0x2E, 0xE0, 0x00, 0x46]),
        (0x3F, &[0x31]),
    ] {
        bank[offset..offset + bytes.len()].copy_from_slice(bytes);
    }
    bank
}

fn with_checksum(mut bank: [u8; 64]) -> [u8; 64] {
    bank[63] = bank[..63].iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte));
    bank
}

/// The checksums F4h and 31h and all field values are taken from section 4 of the reference.
#[test]
fn published_data_sheet_parses() {
    let eds = Eds::parse(EdsBank::Common, common()).unwrap();
    assert_eq!(Eds::factory_default(EdsBank::Common), eds);
    assert_eq!(eds.emit(), common());
    let values: Vec<_> = eds.values().map(|(field, value)| (field.offset, value)).collect();
    assert_eq!(
        values,
        [
            (0x00, EdsValue::Number(1, "")),
            (0x01, EdsValue::Number(2, "banks")),
            (0x02, EdsValue::Bank(0x04)),
            (0x03, EdsValue::Bank(0x43)),
            (0x05, EdsValue::Ticks(28)),
            (0x06, EdsValue::Ticks(48)),
            (0x0B, EdsValue::NoLimit),
            (0x0C, EdsValue::Ticks(32)),
            (0x0E, EdsValue::Number(500, "ms")),
            (0x10, EdsValue::Number(1, "")),
            (0x11, EdsValue::Number(1, "slave addresses")),
            (0x14, EdsValue::Bank(0x03)),
            (0x15, EdsValue::Number(35, "bit")),
            (0x16, EdsValue::Code(0)),
            (0x17, EdsValue::Polynomial(0x43)),
        ]
    );

    let eds = Eds::parse(EdsBank::Encoder, encoder()).unwrap();
    assert_eq!(Eds::factory_default(EdsBank::Encoder), eds);
    let values: Vec<_> = eds.values().map(|(field, value)| (field.offset, value)).collect();
    assert_eq!(
        values,
        [
            (0x00, EdsValue::Number(1, "")),
            (0x01, EdsValue::Number(1, "banks")),
            (0x02, EdsValue::Profile(ProfileId::new(0x6129))),
            (0x04, EdsValue::Feedback(StatusBitMeaning::Error)),
            (0x05, EdsValue::Feedback(StatusBitMeaning::Warning)),
            (0x06, EdsValue::Number(255, "")),
            (0x08, EdsValue::EncoderType(0)),
            (0x0A, EdsValue::Number(16, "bit")),
            (0x0C, EdsValue::Number(17, "bit")),
            (0x1C, EdsValue::Polynomial(0x43)),
            (0x20, EdsValue::Code(0)),
            (0x2C, EdsValue::Number(12_000, "1/min")),
            (0x30, EdsValue::Kelvin(233)),
            (0x32, EdsValue::Kelvin(378)),
            (0x34, EdsValue::Number(5_000, "mV")),
            (0x36, EdsValue::Number(12_000, "mV")),
            (0x38, EdsValue::Number(70, "mA")),
        ]
    );
    assert_eq!(EdsValue::Kelvin(233).to_celsius(), Some(-40));
    assert_eq!(EdsValue::Kelvin(378).to_celsius(), Some(105));
}

#[test]
fn detects_changed_byte() {
    for (bank, bytes) in [(EdsBank::Common, common()), (EdsBank::Encoder, encoder())] {
        for bit in 0..64 * 8 {
            let mut damaged = bytes;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(matches!(Eds::parse(bank, damaged), Err(EdsError::Checksum { .. })), "{bank:?} bit {bit}");
        }
    }
    let mut damaged = common();
    damaged[63] = 0;
    let error = Eds::parse(EdsBank::Common, damaged).unwrap_err();
    assert_eq!(error.to_string(), "EDS bank 0x02: checksum 00 instead of F4");
}

#[test]
fn decodes_special_values() {
    let mut bank = common();
    (bank[0x02], bank[0x03], bank[0x05], bank[0x0C], bank[0x17]) = (0xFF, 0x05, 0x00, 0x00, 0x00);
    let eds = Eds::parse(EdsBank::Common, with_checksum(bank)).unwrap();
    let value = |offset| eds.values().find(|(field, _)| field.offset == offset).unwrap().1;
    assert_eq!(value(0x02), EdsValue::NotAvailable);
    assert_eq!(value(0x05), EdsValue::Adaptive);
    assert_eq!(value(0x0C), EdsValue::Ticks(0));
    assert_eq!(value(0x17), EdsValue::Polynomial(0));
}

#[test]
fn derives_frame_format_from_data_sheet() {
    let with = |changes: &[(usize, u8)]| {
        let mut bank = encoder();
        changes.iter().for_each(|(offset, byte)| bank[*offset] = *byte);
        Eds::parse(EdsBank::Encoder, with_checksum(bank)).unwrap()
    };
    let of_length = |bits| {
        let mut bank = common();
        bank[0x15] = bits;
        Eds::parse(EdsBank::Common, with_checksum(bank)).unwrap()
    };
    assert_eq!(layout(&of_length(35), &with(&[])), Ok(Layout::default()));
    let single = layout(&of_length(19), &with(&[(0x0A, 0)])).unwrap();
    assert_eq!((single.multiturn_bits(), single.singleturn_bits(), single.bits()), (0, 17, 25));
    let bare = layout(&of_length(33), &with(&[(0x04, 0), (0x05, 0), (0x1F, 0)])).unwrap();
    assert_eq!((bare.has_error_bit(), bare.has_warning_bit(), bare.crc_bits()), (false, false, 0));
    let sixteen = layout(&of_length(35), &with(&[(0x1E, 0x88), (0x1F, 0x10), (0x1D, 0x00), (0x23, 0x05)])).unwrap();
    assert_eq!(sixteen.crc(), Some(&Crc::new(0x1_1021, 5, true).unwrap()));

    let refused = [
        (of_length(35), with(&[(0x0A, 15)]), EdsError::DataLength { common: 35, encoder: 34 }),
        (of_length(35), with(&[(0x04, 7)]), EdsError::Feedback { number: 1, code: 7 }),
        (of_length(35), with(&[(0x05, 1)]), EdsError::Feedback { number: 2, code: 1 }),
        (of_length(35), with(&[(0x0A, 33)]), LayoutError::Field { field: "multiturn", bits: 33 }.into()),
        (of_length(35), with(&[(0x23, 0x40)]), CrcError::Start { start: 0x40, width: 6 }.into()),
    ];
    for (common, encoder, error) in refused {
        assert_eq!(layout(&common, &encoder), Err(error));
    }
}

proptest! {
    #[test]
    fn arbitrary_banks_round_trip(mut bytes in proptest::array::uniform32(any::<[u8; 2]>())) {
        let mut bank = [0; 64];
        bank.iter_mut().zip(bytes.iter_mut().flatten()).for_each(|(place, byte)| *place = *byte);
        let bank = with_checksum(bank);
        let [common, encoder] = [EdsBank::Common, EdsBank::Encoder].map(|kind| Eds::parse(kind, bank).unwrap());
        prop_assert_eq!(common.emit(), bank);
        prop_assert_eq!(encoder.values().count(), 17);
        let _ = layout(&common, &encoder);
    }
}
