//! A profile of a kit encoder as a user might write it.

/// A profile with 00h to 3Fh in bank 24h, three bytes in bank 25h, and a preset of 270°.
pub(crate) const PROFILE: &str = r#"(
    schema: 1,
    device: "biss",
    identity: (
        serial_number: "12345678",
        profile_id: 0x6129,
        device_id: "01 01 68 11 00 01",
        manufacturer: "46 72",
        firmware: "1.6.0",
        description: "POSITAL IXARC kit encoder",
        multiturn_bits: 16,
        singleturn_bits: 17,
    ),
    filter: 0x03, // balanced
    preset: (singleturn: 98304, multiturn: 0),
    data: [
        (name: "EDS motor data", banks: (0x04, 0x23), empty: 0x00, listed: []),
        (name: "OEM data", banks: (0x24, 0x43), empty: 0x00, listed: [
            (bank: 0x24, bytes: ["00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F",
                                 "10 11 12 13 14 15 16 17 18 19 1A 1B 1C 1D 1E 1F",
                                 "20 21 22 23 24 25 26 27 28 29 2A 2B 2C 2D 2E 2F",
                                 "30 31 32 33 34 35 36 37 38 39 3A 3B 3C 3D 3E 3F"]),
            (bank: 0x25, bytes: ["A1 B2 C3 00 00 00 00 00 00 00 00 00 00 00 00 00",
                                 "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00",
                                 "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00",
                                 "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"]),
        ]),
    ],
)
"#;
