//! Tests of the words in the reference, in both directions, and of contradictions in the manual. Property tests cover
//! all other words.

use proptest::prelude::*;

use EncoderMode::{Cam as Cams, Parameterisation, Position, ReadOut as Reading, Velocity};
use Parameter as P;

use super::*;

fn value(number: u32) -> Value {
    Value::new(number).unwrap()
}

fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

fn shift(number: u8) -> WindowShift {
    WindowShift::new(number).unwrap()
}

fn set_command(parameter: Parameter, number: u32) -> Command {
    Command::Set(parameter, value(number))
}

fn program(number: u8) -> Command {
    Command::Cams(ProgramNumber::new(number))
}

/// Each row has a command, its word, and a mode in which the word has this meaning (references 3, 5 and 7).
#[test]
fn published_commands_match() {
    let register = |number| Command::ReadOut(ReadOutNumber::chip_register(number).unwrap());
    let cases = [
        ("normal", Command::Normal, 0x0000_0000, Position),
        ("run", Command::Run, 0x8000_0000, Parameterisation),
        ("preset", Command::Preset, 0x4000_0000, Position),
        ("FRABA preset", Command::FrabaPreset, 0x6000_0000, Position),
        ("steps 255", set_command(P::Steps, 255), 0x0200_00FF, Position),
        ("steps 360", set_command(P::Steps, 360), 0x0200_0168, Parameterisation),
        ("steps 4096", set_command(P::Steps, 4096), 0x0200_1000, Position),
        ("steps 8192", set_command(P::Steps, 8192), 0x0200_2000, Position),
        ("all steps", set_command(P::Steps, 0x1FF_FFFF), 0x03FF_FFFF, Position),
        ("turns 1", set_command(P::Turns, 1), 0x0400_0001, Parameterisation),
        ("turns 4096", set_command(P::Turns, 4096), 0x0400_1000, Position),
        ("clockwise", set_command(P::Direction, 3), 0x0600_0003, Position),
        ("counterclockwise", set_command(P::Direction, 4), 0x0600_0004, Position),
        ("preset 0", set_command(P::Preset, 0), 0x0800_0000, Position),
        ("preset 1000", set_command(P::Preset, 1000), 0x0800_03E8, Position),
        ("preset 123456", set_command(P::Preset, 123_456), 0x0801_E240, Position),
        ("zero shift 0", set_command(P::ZeroShift, 0), 0x0A00_0000, Position),
        ("default", set_command(P::Default, 0), 0x0E00_0000, Position),
        ("velocity start", Command::Velocity(true), 0x2040_0001, Position),
        ("velocity stop", Command::Velocity(false), 0x2040_0000, Velocity),
        ("serial number", Command::ReadOut(ReadOutNumber::SERIAL_NUMBER), 0x2021_0000, Reading),
        ("temperature", Command::ReadOut(ReadOutNumber::TEMPERATURE), 0x2021_000C, Position),
        ("chip register 5", register(5), 0x2021_005D, Reading),
        ("mode", Command::ReadOut(ReadOutNumber::STARTUP_MODE), 0x2021_0009, Cams),
        ("position mode", program(0), 0x2080_0000, Cams),
        ("program 1", program(1), 0x2080_0001, Position),
        ("program 8", program(8), 0x2080_0008, Cams),
        ("cam 3 start", Command::CamStart(cam(3), value(0x15)), 0x4600_0015, Cams),
        ("cam 3 stop", Command::CamStop(cam(3), value(0x213)), 0x6600_0213, Cams),
        ("cam 7 start", Command::CamStart(cam(7), Value::MAX), 0x4FFF_FFFF, Cams),
        ("cam 7 stop", Command::CamStop(cam(7), Value::MAX), 0x6FFF_FFFF, Cams),
        ("cam 1 start", Command::CamStart(cam(1), value(1000)), 0x4200_03E8, Cams),
        ("cam 1 stop", Command::CamStop(cam(1), value(2000)), 0x6200_07D0, Cams),
        ("mask 0 1 4 7", Command::Activate(0x93), 0x2040_0093, Cams),
        ("mask 3", Command::Activate(0x08), 0x2040_0008, Cams),
        ("shift 8", Command::Shift(shift(8)), 0x2010_0008, Cams),
        ("shift 25", Command::Shift(shift(25)), 0x2010_0019, Cams),
        ("read cam 3 start", Command::ReadCamStart(cam(3)), 0x2020_0013, Cams),
        ("read cam 3 stop", Command::ReadCamStop(cam(3)), 0x2020_0023, Cams),
        ("read mask", Command::ReadActivation, 0x2020_0000, Cams),
        ("read shift", Command::ReadShift, 0x2020_0040, Cams),
    ];
    for (label, command, word, mode) in cases {
        assert_eq!(format!("{:08X}", command.emit()), format!("{word:08X}"), "{label}");
        assert_eq!(Command::in_mode(word, mode), Ok(command), "{label}");
        assert!(Command::all_meanings(word).contains(&command), "{label}");
    }
    assert_eq!(ReadOutNumber::chip_register(16), None);
}

/// The IN words are from references 2 and 7.
#[test]
fn published_replies_match() {
    let code = |code| Code::new(code).unwrap();
    let error = |number, data| Reply::Error(ErrorWord { code: code(number), data: value(data) });
    let echo = |number, data| Reply::Echo { manufacturer: false, code: code(number), data: value(data) };
    let cases = [
        (0x0012_3456, Reply::Run { value: value(1_193_046), stray: 0 }),
        (0x0212_3456, Reply::Run { value: value(1_193_046), stray: 1 }),
        (0xC200_00FF, echo(1, 255)),
        (0xC000_0000, Reply::Busy { manufacturer: false, data: value(0) }),
        (0xE200_0001, Reply::Echo { manufacturer: true, code: code(1), data: value(1) }),
        (0x8200_0000, error(1, 0)),
        (0x8400_0000, error(2, 0)),
        (0x8600_0000, error(3, 0)),
        (0x9800_0004, error(0xC, 4)),
        (0x8000_0000, error(0, 0)),
        (0xA400_0000, Reply::UnknownReadOut(value(0))),
        (0xA000_0FA0, Reply::ReadOut(value(4000))),
        (0xA1FF_FF9C, Reply::ReadOut(value(0x1FF_FF9C))),
        (0xAA00_0001, Reply::Unknown { code: code(5), data: value(1) }),
    ];
    for (word, reply) in cases {
        assert_eq!(Reply::parse(word), reply, "{word:08X}");
        assert_eq!(reply.emit(), word);
    }
    let said = [
        (0x8200_0000, "wrong parameter data"),
        (0x8400_0000, "unknown parameter code"),
        (0x8600_0000, "parameters lost"),
        (0x9800_0004, "start or stop of a cam beyond the measuring range"),
        (0x9800_0005, "manufacturer's error"),
        (0x8000_0000, "position or cam value not valid"),
    ];
    for (word, meaning) in said {
        let Reply::Error(error) = Reply::parse(word) else { panic!("{word:08X}") };
        assert_eq!(error.meaning(), meaning);
    }
    assert_eq!(CamOutput::parse(0x8000_0000), Err(CamOutputError { word: 0x8000_0000 }));
}

/// The read-outs and their units are from references 3 and 7.
#[test]
fn read_outs_have_units() {
    let read = |read_out: ReadOutNumber, word| match Reply::parse(word) {
        Reply::ReadOut(value) => read_out.value(value),
        other => panic!("{other:?}"),
    };
    assert_eq!(read(ReadOutNumber::SERIAL_NUMBER, 0xA000_0FA0), ReadOutValue::Plain(4000));
    assert_eq!(read(ReadOutNumber::TEMPERATURE, 0xA000_00FD), ReadOutValue::TenthsOfDegree(253));
    for word in [0xA1FF_FF9C, 0xA000_FF9C] {
        assert_eq!(read(ReadOutNumber::TEMPERATURE, word), ReadOutValue::TenthsOfDegree(-100), "{word:08X}");
    }
    assert_eq!(read(ReadOutNumber::TEMPERATURE, 0xA000_7FFF), ReadOutValue::TenthsOfDegree(0x7FFF));
    assert_eq!(read(ReadOutNumber::OPERATING_TIME, 0xA000_03E8), ReadOutValue::Minutes(10_000));
    let mode = |number| StartupMode::parse(value(number));
    let program = |number| StartupMode::Cams(ProgramNumber::new(number).unwrap());
    assert_eq!([mode(0), mode(1), mode(2)], [StartupMode::K2, StartupMode::K3, StartupMode::Velocity]);
    assert_eq!([mode(3), mode(0xA)], [program(1), program(8)]);
    assert_eq!([mode(0xB), mode(0x10)], [0xB, 0x10].map(|number| StartupMode::Unknown(value(number))));
    let flags = Flags::new(value(0b110));
    assert_eq!((flags.steps_minus_one(), flags.counts_turns(), flags.unknown_bits()), (false, true, 4));
    let names: Vec<&str> = READ_OUTS.iter().map(|row| row.name).collect();
    assert_eq!((names[3], names[10], names[11]), ("complement", "flags", "temperature"));
    let numbers: Vec<u16> = READ_OUTS.iter().map(|row| row.read_out.to_u16()).collect();
    assert_eq!(numbers, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0xA, 0xC]);
    assert_eq!((ReadOutNumber::new(0x5D).register(), ReadOutNumber::new(0xC).register()), (Some(5), None));
}

/// The labels are the numbers of the contradictions in reference 6. Number 8 is the echo of 255 steps.
#[test]
fn resolves_manual_contradictions() {
    assert_eq!(id_code(Class::K3, Interface::Standard), 55, "1: 37h");
    assert_eq!(Command::Preset.emit(), 0x4000_0000, "2: fired by bit 30");
    assert_eq!(Command::in_mode(0x0A00_03E8, Position), Ok(set_command(P::ZeroShift, 1000)), "2: which 0A does not");
    assert_eq!(Command::Activate(8).emit(), 0x2040_0008, "4: not 20200008");
    assert_eq!(Command::all_meanings(0x2020_0008), [Command::Unknown(0x2020_0008)], "4");
    assert_eq!(Command::all_meanings(0x2020_0030), [Command::Unknown(0x2020_0030)], "5: 40, not 30");
    for stop in [Command::Normal, Command::Run] {
        assert_eq!(stop.emit() >> 16 & 1, 0, "6: bit 16 ends a read-out");
        assert!(stop.is_legal_in(Reading), "6");
    }
    assert_eq!(Reply::echo_for(set_command(P::Steps, 255)).emit(), 0xC200_00FF, "8: not C2000100");
    assert_ne!(Reply::parse(0xC200_0100), Reply::echo_for(set_command(P::Steps, 255)), "8");
    assert_eq!(CamNumber::new(8), None, "9: eight cams");
    assert_eq!(Command::all_meanings(0x5000_0000), [Command::Unknown(0x5000_0000)], "9");
    assert_eq!(P::Default.row().code << 1, 0x0E, "10");
    assert!(matches!(Reply::parse(0xC000_0000), Reply::Busy { .. }), "11: processing");
    assert!(matches!(Reply::parse(0xC200_00FF), Reply::Echo { .. }), "11: received");
}

/// Some words mean different things in different modes, and some must not be sent (reference 6.3).
#[test]
fn mode_determines_word_meaning() {
    let (zero, start) = (value(0), Command::Velocity(true));
    let shared = [
        (0x4000_0000, Command::Preset, Command::CamStart(cam(0), zero)),
        (0x6000_0000, Command::FrabaPreset, Command::CamStop(cam(0), zero)),
        (0x2040_0001, start, Command::Activate(1)),
        (0x2040_0000, Command::Velocity(false), Command::Activate(0)),
    ];
    for (word, outside, inside) in shared {
        assert_eq!(Command::all_meanings(word), [outside, inside]);
        assert_eq!(Command::in_mode(word, Position), Ok(outside));
        assert_eq!(Command::in_mode(word, Cams), Ok(inside));
        assert_eq!(outside.ensure_legal(Cams), Err(ForbiddenCommandError { command: outside, mode: Cams }));
        assert_eq!(inside.ensure_legal(Position), Err(ForbiddenCommandError { command: inside, mode: Position }));
    }
    let refused = Command::in_mode(0x4600_0015, Position).unwrap_err().to_string();
    assert_eq!(refused, "46000015 (start of a cam) is not valid in position mode");
    for (command, legal) in [
        (set_command(P::Steps, 255), &[Position, Parameterisation][..]),
        (Command::Preset, &[Position]),
        (start, &[Position, Velocity]),
        (program(1), &[Position, Cams]),
        (Command::ReadShift, &[Cams]),
        (Command::ReadOut(ReadOutNumber::STARTUP_MODE), &[Position, Reading, Velocity, Cams]),
        (Command::Run, &EncoderMode::ALL),
        (Command::Unknown(1), &[]),
    ] {
        let modes: Vec<EncoderMode> = EncoderMode::ALL.into_iter().filter(|mode| command.is_legal_in(*mode)).collect();
        assert_eq!(modes, legal, "{command:?}");
    }
}

/// The echoes are from references 4 and 5, except that the echo of a cam is an assumption.
#[test]
fn mode_determines_echo() {
    assert_eq!(Reply::parse(0xC200_00FF).echoed_command(Parameterisation), Some(set_command(P::Steps, 255)));
    assert_eq!(Reply::parse(0xC200_00FF).echoed_command(Cams), Some(Command::CamStart(cam(1), value(255))));
    assert_eq!(Reply::parse(0xE600_0213).echoed_command(Cams), Some(Command::CamStop(cam(3), value(0x213))));
    assert_eq!(Reply::parse(0xE040_0008).echoed_command(Cams), Some(Command::Activate(8)));
    assert_eq!(Reply::parse(0xC000_0000).echoed_command(Parameterisation), None);
    assert_eq!(Reply::parse(0xA000_00FF).echoed_command(Parameterisation), None);
    // The worked example of the reference.
    let example = [(P::Steps, 255, 0xC200_00FF), (P::Turns, 1, 0xC400_0001), (P::Direction, 3, 0xC600_0003)];
    for (parameter, number, word) in example {
        assert_eq!(Reply::echo_for(set_command(parameter, number)).emit(), word);
    }
}

/// Words with the position window at different shifts, all with cam 5 on (reference 7).
#[test]
fn published_cam_outputs_match() {
    for (word, at) in [(0x01CD_EF20, 0), (0x01AB_CD20, 8), (0x00BC_DE20, 4), (0x0000_0020, 25)] {
        let output = CamOutput::at_position(value(0x1AB_CDEF), 1 << 5, shift(at));
        assert_eq!(format!("{:08X}", output.emit()), format!("{word:08X}"), "shift {at}");
        assert_eq!(CamOutput::parse(word), Ok(output));
        assert_eq!(output.position_bits(shift(at)), 0x1AB_CDEF & shift(at).mask());
    }
    // The window contains the lowest 17 bits, the highest 17 bits, or none.
    assert_eq!([0, 8, 25].map(|at| shift(at).mask()), [0x1_FFFF, 0x1FF_FF00, 0]);
    let bits = [0, 7, 8, 24, 25, 31].map(|bit| CamOutput::bit(bit, shift(8)).unwrap());
    let expected =
        [CamBit::Cam(0), CamBit::Cam(7), CamBit::Position(8), CamBit::Position(24), CamBit::Zero, CamBit::Invalid];
    assert_eq!(bits, expected);
    assert_eq!(CamOutput::bit(8, shift(25)), Some(CamBit::Zero));
    assert_eq!((CamOutput::bit(32, shift(0)), WindowShift::new(26)), (None, None));
}

/// The identification codes are from references 1 and 7.
#[test]
fn class_id_codes_match() {
    use Interface::{Loop2, OpticalFibre, Standard};
    for class in [Class::K1, Class::K2] {
        assert_eq!([Standard, OpticalFibre, Loop2].map(|interface| id_code(class, interface)), [54, 54, 178]);
    }
    assert_eq!([Standard, OpticalFibre, Loop2].map(|interface| id_code(Class::K3, interface)), [55, 55, 179]);
    assert_eq!(devices_with_id(0xB3).collect::<Vec<_>>(), [(Class::K3, Loop2)]);
    assert_eq!((devices_with_id(54).count(), devices_with_id(0).count()), (4, 0));
    assert_eq!(Class::ALL.map(Class::bytes), [(2, 0), (4, 0), (4, 4)]);
    let (k1, k2) = (SingleWord::parse_k1(0x1FFF), SingleWord::parse_k2(0x0312_3456));
    assert_eq!(
        (SingleWord::parse_k1(0x0FFF).position(), k1.position(), k1.unexpected_bits()),
        (value(4095), value(4095), 0x1000)
    );
    assert_eq!((k2.position(), k2.unexpected_bits()), (value(0x112_3456), 0x0200_0000));
    assert_eq!((k1.emit(), k2.emit()), (0x1FFF, 0x0312_3456));
}

/// The LED states are from reference 1.
#[test]
fn led_states_match_reference() {
    use LedState::{Blinking, Off, On};
    let says = |ul, ba, rc, rbda| Leds { ul, ba, rc, rbda }.row().map(|row| row.meaning);
    assert_eq!(says(On, Off, On, Off), Some("no run"));
    assert_eq!(says(On, Blinking, On, Off), Some("configured"));
    assert_eq!(says(On, On, On, On), Some("run"));
    assert_eq!(says(On, Off, Off, On), Some("bus error"));
    assert_eq!(says(Off, Off, Off, Off), None);
}

/// The positions are from reference 7, where wrapping is an assumption.
#[test]
fn gear_rounds_down() {
    let cases = [
        (255, 1, 0, 0),
        (255, 1, 4095, 127),
        (255, 1, 8191, 254),
        (255, 1, 8192, 255),
        (360, 1, 4096, 180),
        (360, 1, 12_345, 542),
        (1000, 10, 24_676, 301),
    ];
    for (steps, turns, raw, scaled) in cases {
        let gear = Gear::new(steps, turns).unwrap();
        assert_eq!(gear.scaled_value(raw), scaled, "{steps} steps, {turns} turns, {raw}");
    }
    let gear = Gear::new(255, 1).unwrap();
    assert_eq!((gear.position(8191), gear.position(8192), gear.position(12_287)), (value(254), value(0), value(127)));
    assert_eq!(Gear::new(8193, 1), Err(GearError::Steps { steps: 8193, turns: 1, most: 8192 }));
    assert_eq!(Gear::new(1, 4097), Err(GearError::Turns { turns: 4097 }));
    assert!(Gear::new(0, 1).is_err() && Gear::new(1, 0).is_err());
    let all = Gear::new(0x1FF_FFFF, 4096).unwrap();
    assert_eq!(all.position(all.total_disc_steps() - 1), value(0x1FF_FFFE));
    assert!(Gear::new(0x200_0000, 4096).is_err());
}

/// Some limits of the parameters depend on the gear (reference 3).
#[test]
fn checks_parameter_limits() {
    let gear = Gear::new(3600, 10).unwrap();
    for (parameter, low, high) in [
        (P::Steps, 1, 81_920),
        (P::Turns, 1, 4096),
        (P::Direction, 3, 4),
        (P::Preset, 0, 3599),
        // The zero shift must be within the measuring range (issue 22.6).
        (P::ZeroShift, 0, 3599),
        (P::Default, 0, 0),
    ] {
        assert_eq!(parameter.valid_range(gear), low..=high, "{parameter:?}");
        assert_eq!(parameter.check_value(high, gear), Ok(value(high)));
        let refused = OutOfRange { parameter, value: high + 1, low, high };
        assert_eq!(parameter.check_value(high + 1, gear), Err(refused));
    }
    let refused = P::Preset.check_value(3600, gear).unwrap_err();
    assert_eq!(refused.to_string(), "preset: 3600 is outside the range 0 to 3599");
    for (row, code) in PARAMETERS.iter().zip([1, 2, 3, 4, 5, 7]) {
        assert_eq!((row.code, row.parameter.row().code), (code, code));
        assert_eq!(P::from_code(Code::new(code).unwrap()), Some(row.parameter));
    }
    assert_eq!(P::from_code(Code::new(6).unwrap()), None);
}

/// A cam is also on at its edges (reference 7).
#[test]
fn cams_are_on_between_edges() {
    let on = |start, stop, at| Cam { start: value(start), stop: value(stop) }.is_on(value(at));
    assert_eq!([15, 213, 214, 14].map(|at| on(15, 213, at)), [true, true, false, false]);
    assert_eq!([5, 50, 100, 99, 20, 21].map(|at| on(100, 20, at)), [true, false, true, false, true, false]);
    assert_eq!([6, 7, 8].map(|at| on(7, 7, at)), [false, true, false]);
    let mut program = Program { mask: 0b1000, ..Program::default() };
    program.cams[3] = Some(Cam { start: value(0x15), stop: value(0x213) });
    program.cams[4] = program.cams[3];
    assert_eq!([0x14, 0x15, 0x213, 0x214].map(|at| program.outputs(value(at))), [0, 8, 8, 0]);
}

/// Generates programs with many cams that are short, or that lie at or across the ends of the range.
fn arbitrary_programs() -> impl Strategy<Value = [Program; 8]> {
    let edge = prop_oneof![0_u32..40, 0x1FF_FFD0_u32..=0x1FF_FFFF, 0..=0x1FF_FFFF_u32];
    let cam = (edge.clone(), edge).prop_map(|(start, stop)| Cam { start: value(start), stop: value(stop) });
    let cams = prop::collection::vec(prop::option::of(cam), 64);
    let masks = prop::array::uniform8(any::<u8>());
    (cams, masks).prop_map(|(cams, masks)| {
        let program = |at: usize| Program { cams: cams[8 * at..8 * at + 8].try_into().unwrap(), mask: masks[at] };
        std::array::from_fn(program)
    })
}

proptest! {
    #[test]
    fn every_word_round_trips(word: u32) {
        for command in Command::all_meanings(word) {
            prop_assert_eq!(command.emit(), word);
        }
        prop_assert_eq!(Reply::parse(word).emit(), word);
        if let Ok(output) = CamOutput::parse(word) {
            prop_assert_eq!(output.emit(), word);
        }
        for mode in EncoderMode::ALL {
            if let Ok(command) = Command::in_mode(word, mode) {
                prop_assert!(command.is_legal_in(mode) && command.emit() == word);
            }
        }
    }

    /// Random words seldom begin like the words in the manual, so these do.
    #[test]
    fn documented_word_prefixes_round_trip(high in prop::sample::select(vec![0x2010, 0x2020, 0x2021, 0x2040, 0x2080]), low: u16) {
        let word = high << 16 | u32::from(low);
        for command in Command::all_meanings(word) {
            prop_assert_eq!(command.emit(), word);
        }
    }

    #[test]
    fn word_has_one_meaning_per_mode(word: u32, mode in prop::sample::select(EncoderMode::ALL.to_vec())) {
        let legal = Command::all_meanings(word).into_iter().filter(|command| command.is_legal_in(mode)).count();
        prop_assert!(legal <= 1);
    }

    /// The formula for the window is from the reference.
    #[test]
    fn window_matches_formula(position in 0..=0x1FF_FFFF_u32, outputs: u8, at in 0..=25_u8) {
        let output = CamOutput::at_position(value(position), outputs, shift(at));
        let window = (u64::from(position) << 8 >> at) & 0x01FF_FF00;
        prop_assert_eq!(u64::from(output.emit()), window | u64::from(outputs));
        prop_assert_eq!(output.position_bits(shift(at)), position & shift(at).mask());
    }

    /// At all edges, next to them, and at a random position, the outputs equal those of the original programs.
    #[test]
    fn compiled_programs_match_originals(programs in arbitrary_programs(), anywhere in 0..=0x1FF_FFFF_u32) {
        let compiled = CompiledPrograms::new(&programs);
        let cams = programs.iter().flat_map(|program| program.cams.iter().flatten());
        let edges = cams.flat_map(|cam| [cam.start.get(), cam.stop.get()]);
        let near = edges.flat_map(|edge| [edge.saturating_sub(1), edge, (edge + 1).min(0x1FF_FFFF)]);
        for at in near.chain([0, anywhere, 0x1FF_FFFF]) {
            let expected = programs.map(|program| program.outputs(value(at)));
            prop_assert_eq!(compiled.outputs(value(at)), expected, "{}", at);
        }
    }
}
