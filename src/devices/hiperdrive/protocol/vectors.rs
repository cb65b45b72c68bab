//! Tests of words and process data against the reference, including reserved bits and arbitrary input. Tests of
//! parameters and scaling are in the submodules.

use proptest::prelude::*;

use ControlBit as C;
use StatusBit as S;

use super::*;
use crate::bits::{hex, parse_hex};

mod numbers;
mod table;

const SINGLE: Layout = Layout { topology: Topology::Adapter, pkw: true, order: ByteOrder::Little };
const WITHOUT_PKW: Layout = Layout { pkw: false, ..SINGLE };

fn bytes(text: &str) -> Vec<u8> {
    parse_hex(text).unwrap()
}

fn control_word(word: u16) -> ControlWord {
    ControlWord::parse(word).unwrap()
}

fn status(word: u16) -> StatusWord {
    StatusWord::new(word)
}

/// The control words match section 3 of the reference.
#[test]
fn published_control_words_match() {
    use Direction::{Clockwise, Counterclockwise};
    use RunEnd::{Endless, RangeEnd};
    let cases = [
        (0x0000, ControlWord::OFF),
        (0x0400, ControlWord::READY),
        (0x0401, ControlWord::OPERATIONAL),
        (0x0409, ControlWord::ENABLED),
        (0x0481, ControlWord::ACKNOWLEDGE),
        // ZSW12 is clear in 2A37 and set in 3E37. An equal bit 6 starts nothing, and the opposite starts a job.
        (0x0439, ControlWord::without_job_start(status(0x2A37))),
        (0x0479, ControlWord::with_job_start(status(0x2A37))),
        (0x0479, ControlWord::without_job_start(status(0x3E37))),
        (0x0439, ControlWord::with_job_start(status(0x3E37))),
        (0x1419, ControlWord::speed_mode(Clockwise, RangeEnd)),
        (0x1459, ControlWord::speed_mode_running(Clockwise, RangeEnd)),
        (0x1409, ControlWord::speed_mode(Counterclockwise, RangeEnd)),
        (0x1449, ControlWord::speed_mode_running(Counterclockwise, RangeEnd)),
        (0x1439, ControlWord::speed_mode(Clockwise, Endless)),
        (0x1479, ControlWord::speed_mode_running(Clockwise, Endless)),
    ];
    for (expected, control) in cases {
        assert_eq!(format!("{:04X}", control.to_u16()), format!("{expected:04X}"));
        assert_eq!(ControlWord::parse(expected), Ok(control));
    }
    let names =
        |of: u16| control_word(of).set_bits().map(|(bit, name)| format!("{bit} {name}")).collect::<Vec<_>>().join(", ");
    assert_eq!(names(0x0479), "0 on, 3 enable operation, 4 no stop, 5 no pause, 6 job toggle, 10 control by PLC");
    assert_eq!(names(0x1459), "0 on, 3 enable operation, 4 clockwise, 6 run, 10 control by PLC, 12 speed mode");
    assert_eq!(names(0x0509), "0 on, 3 enable operation, 8 jog 1, 10 control by PLC");
}

/// Reserved bits (1, 2, 11, 13 to 15) are rejected, for example in PROFIdrive's 047F (reference, section 9).
#[test]
fn rejects_reserved_bits() {
    for bit in [1, 2, 11, 13, 14, 15] {
        let wrong = 0x0409 | 1 << bit;
        assert_eq!(ControlWord::parse(wrong), Err(ReservedBitsError { word: wrong }), "bit {bit}");
    }
    let refused = ControlWord::parse(0x047F).unwrap_err();
    assert_eq!(refused.to_string(), "control word 047F has reserved bits set (1, 2), which must be 0");
    let legal = (0..=u16::MAX).filter(|word| ControlWord::parse(*word).is_ok()).count();
    assert_eq!(legal, 1 << 10);
}

/// The stop word also clears the jog bits, because a stop does not end a jog step.
#[test]
fn stop_word_depends_on_mode() {
    for (before, stopped) in [
        (0x0479, 0x0469),
        (0x0439, 0x0429),
        (0x1459, 0x1419),
        (0x1449, 0x1409),
        (0x1479, 0x1439),
        (0x0509, 0x0409),
        (0x0400, 0x0400),
    ] {
        assert_eq!(control_word(before).with_stop().to_u16(), stopped, "{before:04X}");
    }
    assert_eq!(control_word(0x0479).with_pause().to_u16(), 0x0459);
    assert_eq!(control_word(0x0459).without_pause().to_u16(), 0x0479);
    assert_eq!(
        (control_word(0x1459).with_pause().to_u16(), control_word(0x1419).without_pause().to_u16()),
        (0x1459, 0x1419)
    );
}

/// A job starts on a level of bit 6, a run on an edge, if all conditions are met (reference, sections 3 and 8.10).
#[test]
fn control_word_starts_job_or_run() {
    let cases = [
        ("job", 0x0439, 0x0479, 0x2A37, Some(MotionStart::Job)),
        ("next job", 0x0479, 0x0439, 0x3E37, Some(MotionStart::Job)),
        ("bit 6 as acknowledged", 0x0439, 0x0479, 0x3E37, None),
        ("held", 0x0409, 0x0439, 0x2A37, None),
        ("a level, no edge", 0x0479, 0x0479, 0x2A37, Some(MotionStart::Job)),
        ("stopped", 0x0439, 0x0469, 0x2A37, None),
        ("paused", 0x0439, 0x0459, 0x2A37, None),
        ("not enabled yet", 0x0439, 0x0479, 0x2A33, None),
        ("fault", 0x0439, 0x0479, 0x2ABF, None),
        ("run", 0x1419, 0x1459, 0x2A37, Some(MotionStart::Run)),
        ("runs already", 0x1459, 0x1459, 0x1A37, None),
        // The run set ZSW12, and its stop left bit 6 clear. Clearing bit 12 therefore starts a job to a stale target.
        ("out of speed mode", 0x1419, 0x0439, 0x3E37, Some(MotionStart::Job)),
        ("out of it through 0400", 0x1419, 0x0400, 0x3E37, None),
        ("jog 1", 0x0409, 0x0509, 0x2A37, Some(MotionStart::JogOne)),
        ("jog 2", 0x0409, 0x0609, 0x2A37, Some(MotionStart::JogTwo)),
        ("jog 1 kept", 0x0509, 0x0509, 0x2A37, None),
    ];
    for (label, before, now, says, expected) in cases {
        assert_eq!(control_word(now).motion_start(control_word(before), status(says)), expected, "{label}");
    }
}

/// The status words and their states match sections 3 and 9 of the reference.
#[test]
fn published_status_words_match() {
    let cases = [
        (0x2A30, State::NotReady),
        (0x2A31, State::Ready),
        (0x2A33, State::Operational),
        (0x2A37, State::Enabled),
        (0x1A37, State::Moving),
        (0x0A37, State::Moving),
        (0x3E37, State::Enabled),
        (0x2AB8, State::Fault),
        (0x2A70, State::Locked),
        // A fault takes precedence over all other states, and the lock over the remaining ones.
        (0x2AFF, State::Fault),
        (0x2A77, State::Locked),
    ];
    for (word, state) in cases {
        assert_eq!(status(word).state(), state, "{word:04X}");
    }
    // Bits 4, 5, 9 and 11 are set for a detected drive, and bit 13 at standstill.
    let standing = StatusWord::DETECTED_DRIVE.with_bit(S::Standstill, true);
    assert_eq!((standing.to_u16(), standing.is_present()), (0x2A30, true));
    let set: Vec<u8> = standing.set_bits().map(StatusBit::bit_number).collect();
    assert_eq!(set, [4, 5, 9, 11, 13]);
    assert!(!status(0).is_present() && status(0).is_plausible() && standing.is_plausible());
    // Bit 11 is missing, as in every control word.
    assert!(!status(0x0439).is_plausible() && !status(0x047F).is_plausible());
    assert_eq!(status(0x3E37).with_bit(S::TargetReached, false).to_u16(), 0x3A37);
    let [moving, done] = [0x1A37, 0x3E37].map(|word| status(word).is_set(S::SetpointAcknowledged));
    assert!(moving && done);
}

/// The transitions match section 3 of the reference.
#[test]
fn state_machine_matches_reference() {
    use State::{Enabled, Fault, Locked, Moving, NotReady, Operational, Ready};
    let cases = [
        (NotReady, 0x0000, 0x0400, Ready),
        (NotReady, 0x0000, 0x0001, NotReady),
        (Ready, 0x0400, 0x0000, NotReady),
        (Ready, 0x0400, 0x0401, Operational),
        // The state advances one step at a time.
        (Ready, 0x0400, 0x0409, Operational),
        (Operational, 0x0401, 0x0400, Ready),
        (Operational, 0x0401, 0x0409, Enabled),
        (Operational, 0x0401, 0x0000, NotReady),
        (Enabled, 0x0409, 0x0401, Operational),
        (Enabled, 0x0409, 0x0408, Ready),
        (Enabled, 0x0409, 0x0009, NotReady),
        (Enabled, 0x0439, 0x0479, Enabled),
        (Moving, 0x0479, 0x0400, Ready),
        (Moving, 0x0479, 0x0000, NotReady),
        (Fault, 0x0401, 0x0481, Fault),
        (Fault, 0x0481, 0x0401, Locked),
        (Fault, 0x0481, 0x0481, Fault),
        (Fault, 0x0401, 0x0400, Fault),
        (Locked, 0x0401, 0x0401, Locked),
        (Locked, 0x0401, 0x0400, Ready),
        (Locked, 0x0401, 0x0000, NotReady),
        // Bit 0 is already clear, so there is no falling edge.
        (Locked, 0x0400, 0x0400, Locked),
    ];
    for (from, before, now, to) in cases {
        assert_eq!(
            from.after_control_word(control_word(before), control_word(now)),
            to,
            "{from}: {before:04X} {now:04X}"
        );
    }
    for (from, trigger, to) in [
        (Enabled, Trigger::Starts, Moving),
        (Moving, Trigger::Starts, Moving),
        (Moving, Trigger::Ends, Enabled),
        (Moving, Trigger::Fails, Fault),
        (Operational, Trigger::Fails, Fault),
        (Ready, Trigger::Fails, Ready),
        (Operational, Trigger::Starts, Operational),
    ] {
        assert_eq!(from.after_event(trigger), to, "{from}");
    }
    let keys: Vec<State> = State::ALL.into_iter().filter(|state| state.allows_key_operation()).collect();
    assert_eq!(keys, [NotReady, Ready, Fault, Locked]);
    // The word of a row has the effect of the row if it follows the word that keeps the state.
    for (state, kept) in
        [(NotReady, 0), (Ready, 0x400), (Operational, 0x401), (Enabled, 0x409), (Fault, 0x481), (Locked, 0x401)]
    {
        for row in state.transitions() {
            let Some(control) = row.word else { continue };
            assert_eq!(
                state.after_control_word(control_word(kept), control),
                row.to,
                "{state} by {:04X}",
                control.to_u16()
            );
        }
    }
}

/// Returns the status word of a drive state according to section 3 of the reference.
fn status_word_for(state: State) -> StatusWord {
    let word = match state {
        State::NotReady => 0x2A30,
        State::Ready => 0x2A31,
        State::Operational => 0x2A33,
        State::Enabled => 0x2A37,
        State::Moving => 0x1A37,
        State::Fault => 0x2AB8,
        State::Locked => 0x2A70,
    };
    status(word)
}

/// The control words match section 3 of the reference. No step is complete before its word has been sent.
#[test]
fn recipes_reach_target_state() {
    let walk = |steps: &[Step], mut before: ControlWord, mut state: State| {
        let mut words = Vec::new();
        for step in steps {
            assert!(
                step.until.is_empty() || !step.is_done(status_word_for(state)),
                "{state} before {:04X}",
                step.word.to_u16()
            );
            state = state.after_control_word(before, step.word);
            assert!(step.is_done(status_word_for(state)), "{state} after {:04X}", step.word.to_u16());
            before = step.word;
            words.push(step.word.to_u16());
        }
        (words, state)
    };
    let enabled = walk(&ENABLE, ControlWord::OFF, State::NotReady);
    assert_eq!(enabled, (vec![0x0000, 0x0400, 0x0401, 0x0409], State::Enabled));
    let acknowledged = walk(&ACKNOWLEDGE, ControlWord::ENABLED, State::Fault);
    assert_eq!(acknowledged, (vec![0x0481, 0x0401, 0x0400, 0x0401, 0x0409], State::Enabled));
    let unlocked = walk(&UNLOCK, ControlWord::READY, State::Locked);
    assert_eq!(unlocked, (vec![0x0401, 0x0400], State::Ready));
}

/// The data match section 9 of the reference: 2.5 turns (163840) at 100 % in both byte orders, and −1 turn (−65536) at
/// 50 % and 75 %.
#[test]
fn published_output_data_matches() {
    let setpoint = |control: u16, speed, torque, target| Setpoint {
        control: control_word(control),
        speed: Percent::new(speed).unwrap(),
        torque: Percent::new(torque).unwrap(),
        target,
    };
    let zeros = "00 00 00 00 00 00 00 00";
    let cases = [
        ("00 00 64 64 00 80 02 00", setpoint(0x0000, 100, 100, 163_840)),
        ("00 04 64 64 00 80 02 00", setpoint(0x0400, 100, 100, 163_840)),
        ("01 04 64 64 00 80 02 00", setpoint(0x0401, 100, 100, 163_840)),
        ("09 04 64 64 00 80 02 00", setpoint(0x0409, 100, 100, 163_840)),
        ("39 04 64 64 00 80 02 00", setpoint(0x0439, 100, 100, 163_840)),
        ("79 04 64 64 00 80 02 00", setpoint(0x0479, 100, 100, 163_840)),
        ("39 04 32 4B 00 00 FF FF", setpoint(0x0439, 50, 75, -65_536)),
        ("19 14 19 64 00 00 00 00", setpoint(0x1419, 25, 100, 0)),
        ("59 14 19 64 00 00 00 00", setpoint(0x1459, 25, 100, 0)),
    ];
    for (text, setpoint) in cases {
        let bare = OutputImage { drives: vec![setpoint.into()], pkw: None };
        assert_eq!(
            (hex(&bare.emit(WITHOUT_PKW)), OutputImage::parse(&bytes(text), WITHOUT_PKW)),
            (text.to_owned(), Ok(bare.clone()))
        );
        let with = OutputImage { pkw: Some(Pkw::default()), ..bare };
        assert_eq!(hex(&with.emit(SINGLE)), format!("{text} {zeros}"));
        assert_eq!(with.drives[0].control_word(), Ok(setpoint.control));
    }
    // Control word 0400, 0 %, and the position 100000 = 186A0h.
    let actual = ActualValues { status: status(0x3E37), speed: 0, position: 100_000 };
    let image = OutputImage { drives: vec![Setpoint::holding(actual).into()], pkw: None };
    assert_eq!(hex(&image.emit(WITHOUT_PKW)), "00 04 00 00 A0 86 01 00");
    let big = Layout { order: ByteOrder::Big, ..WITHOUT_PKW };
    let image = OutputImage { drives: vec![setpoint(0x0479, 100, 100, 163_840).into()], pkw: None };
    assert_eq!(hex(&image.emit(big)), "04 79 64 64 00 02 80 00");
    assert_eq!(OutputImage::parse(&bytes("04 79 64 64 00 02 80 00"), big), Ok(image));
    let odd = OutputImage::parse(&bytes("7F 04 64 FF 00 00 00 00"), WITHOUT_PKW).unwrap().drives[0];
    assert_eq!((odd.control_word(), odd.torque), (Err(ReservedBitsError { word: 0x047F }), 255));
    assert_eq!((Percent::new(101), Percent::new(100)), (None, Some(Percent::FULL)));
}

/// Data from a drive match section 9 of the reference.
#[test]
fn published_input_data_matches() {
    let cases = [
        ("37 1A 20 03 A0 86 01 00", 0x1A37, 800, 100_000),
        ("37 3E 00 00 00 80 02 00", 0x3E37, 0, 163_840),
        // Calculated by hand: a speed of −1.5 rpm is −15 = FFF1h, and the position is −1 step.
        ("37 1A F1 FF FF FF FF FF", 0x1A37, -15, -1),
    ];
    for (text, word, speed, position) in cases {
        let image = InputImage { drives: vec![ActualValues { status: status(word), speed, position }], pkw: None };
        assert_eq!(
            (hex(&image.emit(WITHOUT_PKW)), InputImage::parse(&bytes(text), WITHOUT_PKW)),
            (text.to_owned(), Ok(image))
        );
    }
    let actual = InputImage::parse(&bytes(cases[0].0), WITHOUT_PKW).unwrap().drives[0];
    assert_eq!((actual.status.state(), SpeedScale::FACTORY.rpm(actual.speed)), (State::Moving, 80.0));
    assert_eq!(to_turns_and_steps(actual.position), (1, 34_464));
}

/// The process data have 16 bytes for an adapter and 40 or 72 for a hub, or 8 fewer without parameter words (reference,
/// section 2).
#[test]
fn published_lengths_match() {
    let layout = |topology, pkw| Layout { topology, pkw, order: ByteOrder::Little };
    let [single, four, eight] = Topology::ALL;
    for (topology, with) in [(single, 16), (four, 40), (eight, 72)] {
        assert_eq!((layout(topology, true).byte_length(), layout(topology, false).byte_length()), (with, with - 8));
        for pkw in [true, false] {
            let layout = layout(topology, pkw);
            assert_eq!(Layout::all_with_length(layout.byte_length()).collect::<Vec<_>>(), [layout]);
        }
        assert_eq!(Topology::from_category(topology.category()), Some(topology));
    }
    assert_eq!(Layout::all_with_length(24).count(), 0);
    // The data of drive 3 begin at byte 16, and the parameter words follow the drives. Unset values are zero.
    for (topology, at) in [(four, 32), (eight, 64)] {
        let drives =
            vec![OutputData::default(), OutputData::default(), OutputData { target: -1, ..OutputData::default() }];
        let request = Pkw::request(Task::Read, 166, 0, 0);
        let image = OutputImage { drives, pkw: Some(request) };
        let bytes = image.emit(layout(topology, true));
        assert_eq!((hex(&bytes[20..24]), hex(&bytes[at..at + 2])), ("FF FF FF FF".to_owned(), "A6 10".to_owned()));
        assert_eq!(bytes.iter().filter(|byte| **byte != 0).count(), 6);
        let parsed = OutputImage::parse(&bytes, layout(topology, true)).unwrap();
        assert_eq!((parsed.drives.len(), parsed.pkw), (at / 8, Some(request)));
    }
    let wrong = ProcessImageError { expected: 40, got: 39 };
    assert_eq!(InputImage::parse(&[0; 39], layout(four, true)), Err(wrong));
    assert_eq!(OutputImage::parse(&[0; 41], layout(four, true)), Err(ProcessImageError { got: 41, ..wrong }));
}

proptest! {
    #[test]
    fn never_sets_reserved_or_jog_bits(says: u16, clockwise: bool, endless: bool, from: u16) {
        let says = status(says);
        let direction = if clockwise { Direction::Clockwise } else { Direction::Counterclockwise };
        let end = if endless { RunEnd::Endless } else { RunEnd::RangeEnd };
        let before = control_word(from & !0xE806);
        for control in [
            ControlWord::without_job_start(says),
            ControlWord::with_job_start(says),
            ControlWord::speed_mode(direction, end),
            ControlWord::speed_mode_running(direction, end),
            before.with_stop(),
        ] {
            prop_assert_eq!(ControlWord::parse(control.to_u16()), Ok(control));
            prop_assert!(!control.is_set(C::JogOne) && !control.is_set(C::JogTwo));
        }
        prop_assert_eq!(before.with_stop().motion_start(before, says), None);
        prop_assert_eq!(ControlWord::without_job_start(says).motion_start(before, says), None);
        prop_assert_eq!(ControlWord::READY.motion_start(before, says), None);
    }

    #[test]
    fn images_round_trip(data: Vec<u8>, big: bool) {
        let order = if big { ByteOrder::Big } else { ByteOrder::Little };
        for layout in Topology::ALL.into_iter().flat_map(|topology| [true, false].map(|pkw| Layout { topology, pkw, order })) {
            let data: Vec<u8> = data.iter().copied().chain(std::iter::repeat(0xA5)).take(layout.byte_length()).collect();
            prop_assert_eq!(OutputImage::parse(&data, layout).unwrap().emit(layout), data.clone());
            prop_assert_eq!(InputImage::parse(&data, layout).unwrap().emit(layout), data);
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(data: Vec<u8>) {
        for layout in Layout::all_with_length(data.len()).chain([SINGLE, WITHOUT_PKW]) {
            let _ = (OutputImage::parse(&data, layout), InputImage::parse(&data, layout));
        }
        for row in PARAMETERS {
            let _ = row.kind.parse(&data);
        }
    }
}
