//! Tests of allowed and stored values, and of the parameter words in the process data (reference, sections 4 to 6).

use super::super::ParameterError;
use super::*;
use crate::buses::ethernet_ip::protocol::GeneralStatus;
use crate::devices::hiperdrive::protocol::{Answer, PARAMETERS, PkwError, Task};

fn value(number: i64) -> Value {
    Value::Number(number)
}

/// Every parameter in the table can be read, and its value has the correct type.
#[test]
fn reads_every_parameter() {
    let mut bench = Bench::hub();
    for row in PARAMETERS {
        for own in if row.number < 100 { vec![row.number] } else { vec![row.number, row.number + 100] } {
            let value = bench.read(own);
            assert!(row.kind.emit(&value).is_ok(), "{own}: {value:?}");
        }
    }
    let mut read = |own| bench.station.read(bench.now, number(own));
    // The third port is empty, and a fifth port does not exist.
    assert_eq!((read(320), read(352), read(307)), (Ok(value(0)), Ok(value(0)), Err(ParameterError::State)));
    assert_eq!((read(507), read(25)), (Err(ParameterError::Unknown), Err(ParameterError::Unknown)));
    assert_eq!((read(13), read(120)), (Ok(Value::Text("HIPERDRIVE HUB-4".to_owned())), Ok(value(13))));
    // The limit of an HDA70 is 16000 turns.
    assert_eq!((read(160), read(152)), (Ok(value(1_048_576_000)), Ok(value(0))));
}

#[test]
fn rejections_have_matching_status() {
    let mut bench = Bench::single();
    let text = Value::Text("x".to_owned());
    for (own, refused, status) in [
        (107, ParameterError::ReadOnly, GeneralStatus::NOT_SETTABLE),
        (25, ParameterError::Unknown, GeneralStatus::NO_ATTRIBUTE),
        (207, ParameterError::Unknown, GeneralStatus::NO_ATTRIBUTE),
    ] {
        assert_eq!(bench.write(own, 1), Err(refused), "{own}");
        assert_eq!(refused.status(), status);
    }
    assert_eq!(bench.station.write(bench.now, number(24), &text), Err(ParameterError::Value));
    assert_eq!(bench.error(), ErrorCode::NONE);
    assert_eq!(bench.write(166, 351), Err(ParameterError::Value));
    assert_eq!((bench.error(), bench.read(166)), (ErrorCode::INVALID_VALUE, value(350)));
}

/// The upper limit (160) must be above the lower limit (158), with the position between them (reference, section 4).
#[test]
fn limits_must_contain_position() {
    let mut bench = Bench::single();
    assert_eq!(bench.write(158, 1), Err(ParameterError::Value), "the position is 0");
    assert_eq!(bench.write(160, -1), Err(ParameterError::Value));
    assert_eq!((bench.write(158, 0), bench.write(160, 0)), (Ok(()), Err(ParameterError::Value)));
    assert_eq!((bench.write(160, 1), bench.read(158), bench.read(160)), (Ok(()), value(0), value(1)));
}

/// Limits must be within ±512 turns of an HDA30 or ±16000 turns of an HDA70, in scaled steps. A jog step of the keys on
/// the drive must not exceed the travel (issue 21.10).
#[test]
fn rejects_limits_beyond_travel() {
    let mut bench = Bench::single();
    for (own, good, bad) in [
        (158, -33_554_432, -33_554_433),
        (160, 33_554_432, 33_554_433),
        (170, 67_108_864, 67_108_865),
        (176, -67_108_864, -67_108_865),
    ] {
        assert_eq!((bench.write(own, good), bench.write(own, bad)), (Ok(()), Err(ParameterError::Value)), "{own}");
        assert_eq!((bench.read(own), bench.error()), (value(good), ErrorCode::INVALID_VALUE), "{own}");
    }
    assert_eq!((bench.write(154, 400), bench.write(156, 256)), (Ok(()), Ok(())));
    assert_eq!((bench.write(160, 204_801), bench.write(160, 204_800)), (Err(ParameterError::Value), Ok(())));
    assert_eq!((bench.write(158, -204_801), bench.write(158, -204_800)), (Err(ParameterError::Value), Ok(())));
    let mut hub = Bench::hub();
    assert_eq!((hub.write(260, 1_048_576_001), hub.write(260, 1_048_575_999)), (Err(ParameterError::Value), Ok(())));
}

/// A set position is rounded to the nearest multiple of 64. It must be within the limits and can be set only at
/// standstill (reference, section 5).
#[test]
fn sets_position() {
    let mut bench = Bench::single();
    for (given, becomes) in [(100, 128), (31, 0), (-33, -64), (163_840, 163_840)] {
        assert_eq!(bench.write(198, given), Ok(()));
        assert_eq!((i64::from(bench.position()), bench.read(198)), (becomes, value(becomes)));
    }
    assert_eq!(bench.write(198, 33_554_432), Err(ParameterError::Value));
    assert_eq!(bench.write(197, 0), Ok(()));
    // The drive moves by one turn from 2.5 turns.
    bench.start(229_376);
    assert_eq!(bench.write(198, 0), Err(ParameterError::State));
    bench.until(0x3E37);
    assert_eq!(bench.position(), 229_376);
}

/// A scale of 400 steps per turn changes the position but not the numeric limits (reference, sections 3 and 5).
#[test]
fn scaling_keeps_numeric_limits() {
    let mut bench = Bench::single();
    assert_eq!((bench.write(154, 400), bench.write(156, 256)), (Ok(()), Ok(())));
    assert_eq!(bench.read(160), value(33_488_896));
    bench.start(400);
    bench.until(0x3E37);
    assert_eq!(bench.position(), 400);
    assert_eq!((bench.write(154, 256), bench.write(156, 1)), (Ok(()), Ok(())));
    assert_eq!(bench.position(), 65_536, "a turn");
    // With 100/1 instead of 10/1, the speed is in hundredths of rpm.
    assert_eq!(bench.write(162, 100), Ok(()));
    bench.out[FIRST].target = 655_360;
    bench.word(0x0439);
    bench.run(500);
    assert_eq!(bench.actual(FIRST).speed, 3500);
}

/// Parameter 47 saves, recalls and resets. Values that are never saved are lost at power-off (reference, section 4).
#[test]
fn saved_parameters_survive_power_cycle() {
    let mut bench = Bench::single();
    let set = [(24, 7), (166, 200), (170, 64)];
    let write_all =
        |bench: &mut Bench| set.iter().for_each(|(own, value)| assert_eq!(bench.write(*own, *value), Ok(())));
    let read_all = |bench: &mut Bench| set.map(|(own, _)| bench.read(own));
    let factory = [value(0), value(350), value(4096)];
    write_all(&mut bench);
    bench.station.power_cycle(bench.now);
    assert_eq!(read_all(&mut bench), factory);
    write_all(&mut bench);
    assert_eq!(bench.write(47, 1), Ok(()));
    assert_eq!((bench.read(47), bench.write(166, 100)), (value(1), Err(ParameterError::State)), "it is at work");
    bench.now = bench.now + Duration::from_millis(200);
    assert_eq!(bench.read(47), value(0));
    bench.station.power_cycle(bench.now);
    assert_eq!(read_all(&mut bench), [value(7), value(200), value(4096)], "jog steps are never saved");
    assert_eq!(bench.write(47, -3), Ok(()));
    bench.now = bench.now + Duration::from_millis(200);
    assert_eq!(read_all(&mut bench), factory);
    bench.station.power_cycle(bench.now);
    assert_eq!(read_all(&mut bench), factory, "−3 has saved");
    assert_eq!(bench.write(47, 2), Err(ParameterError::Value));
}

/// Values −1 and −2 of parameter 47 affect only parameters that the adapter or hub itself stores (manual, 47): its
/// registers and, for each drive, the request (152) and the baud rate (190). Scale, limits and reference of a drive
/// stay unchanged (issue 21.6 d).
#[test]
fn recall_restores_only_device_parameters() {
    let own = [24, 152, 190];
    let of_the_drive = [154, 156, 158, 160, 166, 198];
    let mut bench = Bench::single();
    bench.write(24, 7).unwrap();
    bench.write(47, 1).unwrap();
    bench.now = bench.now + Duration::from_millis(200);
    let set =
        [(24, 8), (152, 0), (190, 9600), (154, 400), (156, 256), (158, -1000), (160, 1000), (166, 200), (198, 128)];
    for (order, expected) in [(-2, [7, 1, 38_400]), (-1, [0, 1, 38_400])] {
        set.iter().for_each(|(number, value)| assert_eq!(bench.write(*number, *value), Ok(()), "{number}"));
        assert_eq!(bench.write(47, order), Ok(()));
        bench.now = bench.now + Duration::from_millis(200);
        assert_eq!(own.map(|number| bench.read(number)), expected.map(value), "{order}");
        assert_eq!(
            of_the_drive.map(|number| bench.read(number)),
            [400, 256, -1000, 1000, 200, 128].map(value),
            "{order}"
        );
        assert_eq!(bench.position(), 128);
    }
}

/// A reset does not affect the set position, saved or not. The factory settings restore the position of the shaft,
/// which is between 0 and 1 turn (manual, 198; issue 21.6 d).
#[test]
fn position_survives_reset() {
    let mut bench = Bench::single();
    bench.start(81_920);
    bench.until(0x3E37);
    bench.word(0x0400);
    assert_eq!(bench.write(198, 640_000), Ok(()));
    for restart in [199, 47] {
        bench.write(restart, if restart == 47 { -4 } else { 0 }).unwrap();
        bench.run(2000);
        assert_eq!((bench.read(198), bench.position()), (value(640_000), 640_000), "{restart}");
    }
    bench.station.power_cycle(bench.now);
    assert_eq!((bench.read(198), bench.position()), (value(640_000), 640_000));
    // The shaft was turned by 1.25 turns, so it is at step 16 384 of 65 536.
    assert_eq!(bench.write(199, 1), Ok(()));
    assert_eq!((bench.read(198), bench.position()), (value(0), 16_384));
}

/// After 47 = −4, the drives restart within 2 s, with their positions unchanged.
#[test]
fn resets_drives() {
    let mut bench = Bench::single();
    bench.start(65_536);
    bench.until(0x3E37);
    assert_eq!(bench.write(47, -4), Ok(()));
    assert_eq!(bench.actual(FIRST).status.to_u16(), 0x2A30);
    bench.run(500);
    assert_eq!((bench.read(47), bench.actual(FIRST).status.to_u16()), (value(1), 0x2A30));
    bench.run(1500);
    assert_eq!((bench.read(47), bench.position()), (value(0), 65_536));
}

/// A request is repeated until its answer arrives, and the answer stays for as long as the request (reference, sections
/// 6 and 9).
#[test]
fn answers_parameter_words() {
    let mut bench = Bench::hub();
    let mut ask = |request: Pkw| {
        bench.pkw = Some(request);
        bench.cycle();
        let reply = bench.station.image(bench.now).pkw.unwrap();
        bench.cycle();
        assert_eq!(bench.station.image(bench.now).pkw, Some(reply));
        reply.answer_to(request)
    };
    let read = |own| Pkw::request(Task::Read, own, 0, 0);
    let refused = |error| Some(Answer::Refused(error));
    assert_eq!(ask(read(166)), Some(Answer::Word(350)));
    assert_eq!(ask(Pkw::request(Task::WriteWord, 166, 0, 200)), Some(Answer::Word(200)));
    assert_eq!(ask(read(166)), Some(Answer::Word(200)));
    assert_eq!(ask(read(266)), Some(Answer::Word(350)), "of drive 2");
    assert_eq!(
        ask(Pkw::request(Task::WriteDouble, 158, 0, (-65_536_i32).cast_unsigned())),
        Some(Answer::Double(0xFFFF_0000))
    );
    assert_eq!(ask(read(158)), Some(Answer::Double(0xFFFF_0000)));
    // The value −4096 as a double word.
    assert_eq!(ask(read(176)), Some(Answer::Double(0xFFFF_F000)));
    assert_eq!(ask(Pkw::request(Task::WriteWord, 166, 0, 351)), refused(PkwError::RANGE));
    assert_eq!(ask(Pkw::request(Task::WriteWord, 158, 0, 1)), refused(PkwError::TYPE));
    assert_eq!(ask(Pkw::request(Task::WriteDouble, 107, 0, 1)), refused(PkwError::READ_ONLY));
    assert_eq!(ask(read(25)), refused(PkwError::NO_PARAMETER));
    assert_eq!(ask(read(307)), refused(PkwError::STATE), "no drive is connected");
    assert_eq!(ask(read(121)), refused(PkwError::TYPE));
    // "HDA70" has two elements, "HDA7" and "0", with the first character in the lowest byte.
    let element = |element| Pkw::request(Task::ReadElement, 121, element, 0);
    assert_eq!(ask(Pkw::request(Task::Count, 121, 0, 0)), Some(Answer::Elements(2)));
    assert_eq!(ask(element(0)), Some(Answer::Double(0x3741_4448)));
    assert_eq!((ask(element(1)), ask(element(2))), (Some(Answer::Double(0x30)), refused(PkwError::NO_ELEMENT)));
    assert_eq!(ask(Pkw::request(Task::Count, 166, 0, 0)), refused(PkwError::NO_ARRAY));
    assert_eq!(ask(Pkw::default()), Some(Answer::None));
}
