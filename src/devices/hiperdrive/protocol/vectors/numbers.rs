//! Tests of parameter words, parameters, scaling and tables against the reference.

use proptest::prelude::*;

use super::super::*;
use super::bytes;
use crate::bits::hex;

fn pkw(text: &str, order: ByteOrder) -> Pkw {
    Pkw::parse(bytes(text).try_into().unwrap(), order)
}

fn parameter(number: u16) -> ParameterNumber {
    ParameterNumber::new(number).unwrap()
}

fn millimetres(hundredths: u64) -> Length {
    Length { nanometres: hundredths * 10_000 }
}

/// The parameter words match section 9 of the reference. −511 turns are −33488896 steps, or FE010000h.
#[test]
fn published_parameter_words_match() {
    let little = ByteOrder::Little;
    let requests = [
        ("A6 10 00 00 00 00 00 00", Pkw::request(Task::Read, 166, 0, 0)),
        ("9E 30 00 00 00 00 01 FE", Pkw::request(Task::WriteDouble, 158, 0, (-33_488_896_i32).cast_unsigned())),
        ("A6 20 00 00 C8 00 00 00", Pkw::request(Task::WriteWord, 166, 0, 200)),
        ("2F 20 00 00 01 00 00 00", Pkw::request(Task::WriteWord, 47, 0, 1)),
        ("2F 20 00 00 FC FF 00 00", Pkw::request(Task::WriteWord, 47, 0, 0xFFFC)),
        ("BE 30 00 00 00 96 00 00", Pkw::request(Task::WriteDouble, 190, 0, 38_400)),
        ("79 60 00 00 00 00 00 00", Pkw::request(Task::ReadElement, 121, 0, 0)),
        ("79 90 00 00 00 00 00 00", Pkw::request(Task::Count, 121, 0, 0)),
        ("27 13 00 00 00 00 00 00", Pkw::request(Task::Read, 807, 0, 0)),
    ];
    for (text, request) in requests {
        assert_eq!((hex(&request.emit(little)), pkw(text, little)), (text.to_owned(), request));
    }
    let answers = [
        ("A6 10 00 00 5E 01 00 00", 0, Answer::Word(350)),
        ("9E 20 00 00 00 00 01 FE", 1, Answer::Double(0xFE01_0000)),
        ("9E 70 00 00 02 00 00 00", 1, Answer::Refused(PkwError::RANGE)),
        ("A6 10 00 00 C8 00 00 00", 2, Answer::Word(200)),
        // The bytes of "HDA3" are in the order received (U).
        ("79 50 00 00 48 44 41 33", 6, Answer::Double(0x3341_4448)),
        ("79 60 00 00 02 00 00 00", 7, Answer::Elements(2)),
    ];
    for (text, request, answer) in answers {
        let (reply, request) = (pkw(text, little), requests[request].1);
        assert_eq!((reply.answer_to(request), hex(&reply.emit(little))), (Some(answer), text.to_owned()));
    }
    let state = pkw("C6 70 00 00 11 00 00 00", little);
    assert_eq!((state.number(), state.answer()), (198, Answer::Refused(PkwError::STATE)));
    let big = pkw("10 A6 00 00 00 00 01 5E", ByteOrder::Big);
    assert_eq!(big, pkw("A6 10 00 00 5E 01 00 00", little));
    assert_eq!(hex(&big.emit(ByteOrder::Big)), "10 A6 00 00 00 00 01 5E");
}

/// A reply for another parameter or task is not accepted as the answer.
#[test]
fn reply_matches_only_its_request() {
    let read = Pkw::request(Task::Read, 166, 0, 0);
    let reply = |code: u16, number: u16| Pkw { pke: code << 12 | number, ind: 0, pwe: 5 };
    assert_eq!(reply(1, 158).answer_to(read), None, "another parameter");
    assert_eq!(reply(0, 166).answer_to(read), None, "the pause before it");
    assert_eq!(reply(4, 166).answer_to(read), None, "an element");
    assert_eq!(reply(2, 166).answer_to(read), Some(Answer::Double(5)));
    assert_eq!(reply(2, 166).answer_to(Pkw::request(Task::WriteWord, 166, 0, 5)), None, "a double word");
    assert_eq!(reply(0, 0).answer_to(Pkw::default()), Some(Answer::None));
    assert_eq!(reply(1, 166).answer_to(Pkw::default()), None, "the reply before it");
    assert_eq!(reply(1, 166).answer_to(reply(4, 166)), None, "no request");
    assert_eq!(reply(9, 166).answer(), Answer::Unknown);
    for (code, meaning) in [(0, "no such parameter"), (1, "read-only"), (5, "wrong type"), (99, "unknown error")] {
        assert_eq!(PkwError::new(code).meaning(), meaning);
    }
}

/// The classes and attributes match section 7 of the reference.
#[test]
fn parameters_map_to_cip_attributes() {
    for (own, class, attribute, drive, base) in [
        (47, 0x64, 0x2F, None, 47),
        (101, 0x65, 0x65, DriveNumber::new(1), 101),
        (107, 0x65, 0x6B, DriveNumber::new(1), 107),
        (198, 0x65, 0xC6, DriveNumber::new(1), 198),
        (199, 0x65, 0xC7, DriveNumber::new(1), 199),
        (201, 0x66, 0x65, DriveNumber::new(2), 101),
        (307, 0x67, 0x6B, DriveNumber::new(3), 107),
        (801, 0x6C, 0x65, DriveNumber::new(8), 101),
        (807, 0x6C, 0x6B, DriveNumber::new(8), 107),
    ] {
        let parameter = parameter(own);
        assert_eq!((parameter.class(), parameter.attribute()), (class, attribute), "{own}");
        assert_eq!((parameter.drive(), parameter.drive1_number()), (drive, base), "{own}");
        assert_eq!(ParameterNumber::from_attribute(class, attribute), Some(parameter), "{own}");
        let drives = drive.and_then(|drive| ParameterNumber::for_drive(base, drive));
        assert_eq!(drives, drive.map(|_| parameter), "{own}");
    }
    for (class, attribute) in [(0x63, 1), (0x64, 0), (0x64, 100), (0x65, 99), (0x65, 200), (0x6D, 101), (0xFFFF, 101)] {
        assert_eq!(ParameterNumber::from_attribute(class, attribute), None, "{class:X}/{attribute}");
    }
    assert_eq!((ParameterNumber::new(0), ParameterNumber::new(900)), (None, None));
    assert_eq!((DriveNumber::new(0), DriveNumber::new(9)), (None, None));
    assert_eq!(DriveNumber::all_in_topology(Topology::Hub4).map(DriveNumber::get).collect::<Vec<_>>(), [1, 2, 3, 4]);
}

/// The number of parameters and their factory values match section 4 of the reference.
#[test]
fn parameter_table_matches_reference() {
    assert!(PARAMETERS.is_sorted_by(|one, other| one.number < other.number));
    let numbers: Vec<u16> = PARAMETERS.iter().map(|row| row.number).collect();
    // The device has 9 read-only parameters, 10 registers, and parameter 47. A drive has 101 to 129, and 22 from 152 to
    // 199.
    let device = numbers.iter().filter(|number| **number < 100).count();
    let drive = numbers.iter().filter(|number| **number >= 100).count();
    assert_eq!((device, drive), (9 + 10 + 1, 29 + 22));
    assert!((101..=129).all(|number| numbers.contains(&number)));
    let saved: Vec<u16> = PARAMETERS.iter().filter(|row| row.saved && row.number > 100).map(|row| row.number).collect();
    assert_eq!(saved, [152, 154, 156, 158, 160, 162, 164, 166, 186, 188, 190, 192, 198]);
    let row = |own| parameter(own).row().unwrap();
    assert_eq!((row(107).kind, row(107).unit, row(107).access), (Kind::I32, "steps", ParameterAccess::Read));
    assert_eq!((row(166).kind, row(166).unit, row(166).factory), (Kind::U16, "0.1 rpm", FactoryValue::Number(350)));
    assert_eq!(
        (row(199).access, row(47).access, row(42).saved),
        (ParameterAccess::Write, ParameterAccess::ReadWrite, true)
    );
    assert_eq!((row(807).number, parameter(25).row().is_none(), parameter(148).row().is_none()), (107, true, true));
    // The factory limits are 511 and 16000 turns of 65536 steps.
    let factory = |own, topology, family| row(own).factory_value(topology, family);
    use Topology::{Adapter, Hub8};
    assert_eq!(factory(158, Adapter, Family::Short), Some(-33_488_896));
    assert_eq!(factory(160, Adapter, Family::Long), Some(1_048_576_000));
    assert_eq!(factory(160, Adapter, Family::Pse441), Some(8_323_072));
    assert_eq!((factory(152, Adapter, Family::Short), factory(152, Hub8, Family::Short)), (Some(1), Some(0)));
    assert_eq!((factory(176, Hub8, Family::Short), factory(192, Hub8, Family::Short)), (Some(-4096), None));
}

/// Values within the limits are accepted, and values beyond them are rejected (reference, section 4).
#[test]
fn checks_parameter_ranges() {
    for (own, good, bad) in [
        (102, &[1, 100][..], &[0, 101][..]),
        (152, &[0, 1], &[2, -1]),
        (154, &[1, 65_535], &[0, 65_536]),
        (166, &[5, 350], &[4, 351]),
        (182, &[100, 10_000], &[99, 10_001]),
        (186, &[1, 100, 255], &[0, 101, 254, 256]),
        (188, &[0, 253], &[254]),
        (190, &[9600, 19_200, 38_400], &[0, 9601, 115_200]),
        (47, &[-4, -1, 1], &[-5, 0, 2]),
        (197, &[0], &[1]),
        (158, &[i64::from(i32::MIN), i64::from(i32::MAX)], &[i64::from(i32::MIN) - 1, i64::from(i32::MAX) + 1]),
        (13, &[], &[0]),
    ] {
        let parameter = parameter(own);
        let row = parameter.row().unwrap();
        for value in good {
            assert_eq!(row.check_value(parameter, *value, Travel::UNKNOWN), Ok(*value), "{own}");
        }
        for value in bad {
            assert!(row.check_value(parameter, *value, Travel::UNKNOWN).is_err(), "{own}: {value}");
        }
    }
    let message = |own, value| {
        let refused = parameter(own).row().unwrap().check_value(parameter(own), value, Travel::UNKNOWN);
        refused.unwrap_err().to_string()
    };
    assert_eq!(message(266, 400), "parameter 266 (maximum speed) cannot be 400 (allowed: 5 to 350)");
    assert_eq!(message(186, 0), "parameter 186 (RS-485 time-out) cannot be 0 (allowed: 1 to 100 or 255)");
    assert_eq!(message(190, 1), "parameter 190 (RS-485 baud rate) cannot be 1 (allowed: 9600, 19200, 38400)");
    assert_eq!(message(197, 3), "parameter 197 (faults since the acknowledgement) cannot be 3 (allowed: only 0)");
    assert_eq!(message(15, 3), "parameter 15 (name) contains text and cannot be 3");
}

/// Numbers have 1, 2 or 4 bytes, low byte first. The first byte of a string may be its length (reference, sections 7
/// and 9).
#[test]
fn value_length_matches_type() {
    for (kind, text, value) in [
        (Kind::I32, "00 80 02 00", 163_840),
        (Kind::I32, "00 00 01 FE", -33_488_896),
        (Kind::I16, "FC FF", -4),
        (Kind::U16, "00 04", 0x0400),
        (Kind::U8, "01", 1),
        (Kind::I8, "F6", -10),
        (Kind::U32, "FF FF FF FF", 4_294_967_295),
    ] {
        assert_eq!(kind.parse(&bytes(text)), Ok(Value::Number(value)));
        assert_eq!(kind.emit(&Value::Number(value)).map(|bytes| hex(&bytes)), Ok(text.to_owned()));
    }
    assert_eq!(Kind::U16.parse(&[1]), Err(ValueError::Length { expected: 2, got: 1 }));
    assert_eq!(Kind::I8.emit(&Value::Number(128)), Err(ValueError::Number { number: 128, low: -128, high: 127 }));
    assert!(Kind::U8.emit(&Value::Text("1".to_owned())).is_err() && Kind::Text.emit(&Value::Number(1)).is_err());
    let name = Value::Text("HIPERDRIVE HUB-4".to_owned());
    let plain = Kind::Text.emit(&name).unwrap();
    // The string has sixteen characters.
    for data in [plain.clone(), [vec![16], plain.clone()].concat(), [plain, vec![0, 0]].concat()] {
        assert_eq!(Kind::Text.parse(&data), Ok(name.clone()));
    }
    assert_eq!(Kind::Text.parse(&[]), Ok(Value::Text(String::new())));
}

/// The nominal data in parameters 126 to 129 are strings. A value with the prefix "A" is in tenths and always has one
/// decimal (manual 6.2).
#[test]
fn parses_nominal_data_in_tenths() {
    for (text, number) in [
        ("24", Some((24.0, 0))),
        ("A25", Some((2.5, 1))),
        ("A20", Some((2.0, 1))),
        ("A", None),
        ("", None),
        ("B25", None),
        ("A-5", None),
    ] {
        assert_eq!(nominal_value(text), number, "{text}");
    }
}

/// The conversions match the table in section 5 of the reference and the examples in the manual.
#[test]
fn converts_steps_to_turns_and_millimetres() {
    for (numerator, denominator, steps) in [(256, 1, 65_536), (400, 256, 400), (100, 256, 100), (20, 256, 20)] {
        let scale = PositionScale::new(numerator, denominator).unwrap();
        assert_eq!(scale.steps_of_turns(1), Some(steps));
        assert_eq!(scale.steps_per_turn(), f64::from(steps));
        assert_eq!(scale.to_turns(-steps), -1.0);
    }
    // One degree is 182.04 steps at 65536 steps per turn, and 1.11 at 400. 5 degrees are 5.6 steps at 400.
    for (numerator, denominator, degrees, steps) in
        [(256, 1, 1.0, 183), (400, 256, 1.0, 2), (400, 256, 5.0, 6), (20, 256, 1.0, 1), (65_535, 1, 1e12, u32::MAX)]
    {
        let scale = PositionScale::new(numerator, denominator).unwrap();
        assert_eq!(scale.degrees_to_steps(degrees), steps);
    }
    let scale = |pitch, step| PositionScale::for_spindle(millimetres(pitch), millimetres(step));
    let factors = |scale: PositionScale| (scale.numerator(), scale.denominator());
    // Pitches of 4 mm, 1 mm and 2 mm with steps of 1/100, 1/100 and 1/10 mm.
    for (pitch, step, expected) in [(400, 1, (400, 256)), (100, 1, (100, 256)), (200, 10, (20, 256))] {
        assert_eq!(scale(pitch, step).map(factors), Ok(expected));
    }
    // 1 mm / 0.03 mm = 100/3 steps = 256 · 25/192.
    assert_eq!(scale(100, 3).map(factors), Ok((25, 192)));
    // 4 mm contain 4000000 steps of 1 nm. Divided by 256, this is 15625/1.
    let nanometre = Length { nanometres: 1 };
    assert_eq!(PositionScale::for_spindle(millimetres(400), nanometre).map(factors), Ok((15_625, 1)));
    assert_eq!(
        PositionScale::for_spindle(Length { nanometres: 4_000_001 }, nanometre),
        Err(ScaleError::TooFine { steps: 4_000_001, numerator: 4_000_001, denominator: 256 })
    );
    assert_eq!(scale(0, 1), Err(ScaleError::NoLength));
    assert_eq!((PositionScale::new(0, 1), PositionScale::new(1, 0)), (Err(ScaleError::Zero), Err(ScaleError::Zero)));
    let four = scale(400, 1).unwrap();
    assert!((four.to_millimetres(150, millimetres(400)) - 1.5).abs() < 1e-12);
    // Limits in steps mean other turns under another scale: 33488896 / 400 = 83722.24 turns.
    for (turns, steps) in [(512, 33_554_432), (-511, -33_488_896), (16_000, 1_048_576_000), (127, 8_323_072)] {
        assert_eq!(PositionScale::FACTORY.steps_of_turns(turns), Some(steps));
    }
    assert_eq!(PositionScale::FACTORY.steps_of_turns(40_000), None);
    assert!((four.to_turns(33_488_896) - 83_722.24).abs() < 1e-6);
}

/// The conversions match sections 2 and 5 of the reference.
#[test]
fn converts_turns_torque_and_speed() {
    for (position, expected) in [(-1, (-1, 65_535)), (0, (0, 0)), (163_840, (2, 32_768)), (i32::MIN, (-32_768, 0))] {
        assert_eq!(to_turns_and_steps(position), expected);
    }
    for (position, reference) in [(31, 0), (32, 64), (33, 64), (100, 128), (-33, -64), (163_840, 163_840)] {
        assert_eq!(nearest_reference(position), Some(reference), "{position}");
    }
    assert_eq!((nearest_reference(i32::MAX), nearest_reference(i32::MIN)), (None, Some(i32::MIN)));
    for (given, effective) in [(1, 25), (25, 25), (26, 50), (50, 50), (51, 75), (75, 75), (76, 100), (100, 100), (0, 0)]
    {
        assert_eq!(effective_torque(given), effective);
    }
    assert_eq!((SpeedScale::FACTORY.rpm(800), SpeedScale::FACTORY.speed(-1.5)), (80.0, -15));
    let other = SpeedScale::new(1, 2).unwrap();
    assert_eq!((other.rpm(10), other.speed(1e9)), (20.0, i16::MAX));
    assert_eq!(SpeedScale::new(0, 1), Err(ScaleError::Zero));
}

/// The tables match sections 1 and 4 of the reference.
#[test]
fn code_tables_match_reference() {
    assert!(ERROR_CODES.is_sorted_by(|one, other| one.code.code() < other.code.code()));
    assert_eq!(ErrorCode::FOLLOWING_ERROR.to_string(), "8203 following error");
    assert_eq!(ErrorCode::new(0x8999).to_string(), "8999 unknown error");
    assert!(ErrorCode::NONE.row().is_none());
    let variant = |number| Variant::new(number).row().map(|row| (row.name, row.family));
    assert_eq!((variant(1), variant(13)), (Some(("HRA25A", Family::Short)), Some(("HDA70", Family::Long))));
    assert_eq!((variant(9), variant(0), variant(0xFFFF)), (Some(("HDA30E", Family::Short)), None, None));
    let all = LedSubject::Drives.row(DriveLedState::RedGreen).map(|row| row.meaning);
    let one = LedSubject::Drive.row(DriveLedState::RedGreen).map(|row| row.meaning);
    assert_eq!((all, one), (Some("a requested drive has an error"), Some("drive error")));
    assert!(LedSubject::Drive.row(DriveLedState::Alternating).is_none());
    let twins = |row: &NetworkLedRow| {
        BUS_LEDS.iter().filter(|other| (other.lamp, other.light) == (row.lamp, row.light)).count()
    };
    assert!(BUS_LEDS.iter().all(|row| twins(row) == 1));
    // The LED has seven states for all drives of a hub and for the drive of an adapter, and four for a single drive of
    // a hub (manual 3.3 and 4.4).
    for (subject, lights) in [(LedSubject::Adapter, 7), (LedSubject::Drives, 7), (LedSubject::Drive, 4)] {
        let rows = subject.rows();
        let is_own = |row: &LedRow| rows.iter().filter(|other| other.light == row.light).count() == 1;
        assert!(rows.len() == lights && rows.iter().all(is_own), "{subject:?}");
    }
    assert_eq!(PORT_LEDS.map(|row| row.light), [PortLedState::Off, PortLedState::Link, PortLedState::Active]);
    let duplicate = NetworkLed::Network.row(NetworkLedState::Red).map(|row| row.meaning);
    assert_eq!(duplicate, Some("another device has the same address"));
    assert_eq!(AddressSwitch::parse(5), Some(AddressSwitch::Fixed("192.168.1.5".parse().unwrap())));
    assert_eq!([0, 97, 98, 99].map(AddressSwitch::parse), {
        use AddressSwitch::{Bootp, Dhcp, Object, Stored};
        [Object, Stored, Bootp, Dhcp].map(Some)
    });
    assert_eq!(AddressSwitch::parse(100), None);
    assert!((0..=99).all(|number| AddressSwitch::parse(number).map(AddressSwitch::number) == Some(number)));
}

proptest! {
    #[test]
    fn parameter_words_round_trip(bytes: [u8; 8], request: [u8; 8]) {
        for order in [ByteOrder::Little, ByteOrder::Big] {
            let reply = Pkw::parse(bytes, order);
            prop_assert_eq!(reply.emit(order), bytes);
            let _ = reply.answer_to(Pkw::parse(request, order));
        }
    }

    #[test]
    fn parameter_addresses_round_trip(own in 1u16..900) {
        let parameter = parameter(own);
        prop_assert_eq!(ParameterNumber::from_attribute(parameter.class(), parameter.attribute()), Some(parameter));
    }

    #[test]
    fn scale_matches_requested_step(pitch in 1u64..20_000_000, step in 1u64..1_000_000) {
        let (pitch, step) = (Length { nanometres: pitch }, Length { nanometres: step });
        if let Ok(scale) = PositionScale::for_spindle(pitch, step) {
            // 256 · numerator / denominator = pitch / step.
            let left = 256 * u64::from(scale.numerator()) * step.nanometres;
            prop_assert_eq!(left, pitch.nanometres * u64::from(scale.denominator()));
        }
    }

    #[test]
    fn numbers_of_each_type_round_trip(number: i64) {
        for kind in [Kind::U8, Kind::I8, Kind::U16, Kind::I16, Kind::U32, Kind::I32] {
            match kind.emit(&Value::Number(number)) {
                Ok(data) => prop_assert_eq!(kind.parse(&data), Ok(Value::Number(number))),
                Err(why) => {
                    let (low, high) = kind.limits().unwrap();
                    prop_assert_eq!(why, ValueError::Number { number, low, high });
                }
            }
        }
    }
}
