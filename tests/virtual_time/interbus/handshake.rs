//! The handshake word by word, from the tables of reference 4 and 5: expected replies, words that are not a reply, and
//! all invalid ones.

use std::time::Duration;

use encoder_studio::devices::interbus::procedures::Master;
use encoder_studio::devices::interbus::procedures::write::{EndState, WrittenChanges};
use encoder_studio::devices::interbus::procedures::{
    Error, Exception, ExpectedWord, RequestedItem, Station, WordReply, identify, read_programs, select,
};
use encoder_studio::devices::interbus::profile::Op;
use encoder_studio::devices::interbus::protocol::{Parameter, StartupMode, WindowShift};

use super::scripted::{POSITION, Script, cams, carry_out, parameters};
use super::support::{program, station};

/// The word that sets 255 steps.
const STEPS: u32 = 0x0200_00FF;
const RUN: u32 = 0x8000_0000;

/// Adds the replies when the parameters are read back: 255 steps, 1 turn, clockwise, preset 0.
fn with_readback_replies(script: Script) -> Script {
    let value = |number: u32, value: u32| (0x2021_0000 + number, [0xA000_0000 | value]);
    [value(1, 255), value(2, 1), value(3, 3), value(4, 0)].iter().fold(script, |script, (out, words)| {
        // The values are read once to check them and once for the gear.
        script.on(*out, words).on(*out, words)
    })
}

fn worked_example() -> Vec<Op> {
    use Parameter::{Direction, Preset, Steps, Turns};
    parameters(&[(Steps, 255), (Turns, 1), (Direction, 3), (Preset, 0)])
}

/// In the worked example of reference 4, old echoes arrive first. Each word waits for its own echo.
#[test]
fn sends_worked_example_word_by_word() {
    let script = Script::new()
        .on(0x0200_00FF, &[POSITION, POSITION, 0xC200_00FF])
        .on(0x0400_0001, &[0xC200_00FF, 0xC200_00FF, 0xC400_0001])
        .on(0x0600_0003, &[0xC400_0001, 0xC600_0003])
        .on(0x0800_0000, &[0xC600_0003, 0xC800_0000])
        .on(0x8000_0000, &[0xC800_0000, 0xC800_0000, POSITION]);
    let (ended, _, sent) = carry_out(with_readback_replies(script), worked_example());
    assert_eq!(ended.unwrap(), WrittenChanges { ops: 1, written: 4, verified: 4, write_cycles: 1 });
    let own = &sent[..6];
    assert_eq!(own, [0x0200_00FF, 0x0400_0001, 0x0600_0003, 0x0800_0000, RUN, 0], "{sent:08X?}");
    assert_eq!(sent.last(), Some(&0));
}

/// The first replies are echoes with other data, busy words, and an echo that disappears in the next cycle.
#[test]
fn accepts_only_stable_exact_echo() {
    let cases: [(&str, &[u32]); 6] = [
        ("busy", &[0xC000_0000, 0xC000_0000, 0xC000_0000, 0xC200_00FF]),
        ("busy with data", &[0xC000_00FF, 0xC000_00FF, 0xC000_00FF, 0xC200_00FF]),
        ("the same code with other data", &[0xC200_0100, 0xC200_0100, 0xC200_0100, 0xC200_00FF]),
        ("gone again", &[0xC200_00FF, 0xC000_0000, 0xC200_00FF, POSITION, 0xC200_00FF]),
        ("the manufacturer's bit in it", &[POSITION, 0xE200_00FF]),
        ("an error of one cycle", &[0x8200_0000, 0xC200_00FF]),
    ];
    for (label, words) in cases {
        let script = with_readback_replies(Script::new().on(STEPS, words));
        let (ended, steps, _) = carry_out(script, parameters(&[(Parameter::Steps, 255)]));
        assert_eq!(ended.unwrap().verified, 1, "{label}");
        let echoed = steps.iter().filter(|step| step.out == STEPS && step.reply == WordReply::Echoed).count();
        assert!(echoed >= 1, "{label}");
        let run = steps.iter().position(|step| step.out == RUN).unwrap();
        assert_eq!(steps[run - 1].input & !0x2000_0000, 0xC200_00FF, "{label}: the echo stood before run");
    }
}

/// Each error word of reference 2 is returned at each word of the worked example. The program then sends `80000000` and
/// `00000000`.
#[test]
fn error_at_any_step_restores_mode() {
    let words = [0x0200_00FF, 0x0400_0001, 0x0600_0003, 0x0800_0000, RUN];
    let errors = [
        (0x8200_0000, "wrong parameter data"),
        (0x8400_0000, "unknown parameter code"),
        (0x8600_0000, "parameters lost"),
        (0x9800_0005, "manufacturer's error"),
    ];
    for (at, word) in words.into_iter().enumerate() {
        for (error, meaning) in errors {
            let (ended, _, sent) = carry_out(Script::new().on(word, &[error]), worked_example());
            let interrupted = ended.unwrap_err();
            assert!(matches!(interrupted.cause, Error::Refused { sent, .. } if sent.emit() == word), "{interrupted}");
            assert!(interrupted.cause.to_string().contains(meaning), "{interrupted}");
            assert_eq!(interrupted.end_state, EndState::AsFound, "{interrupted}");
            assert_eq!((interrupted.done.ops, interrupted.done.write_cycles), (0, 1), "a store may have been spent");
            assert_eq!(interrupted.unfinished.unwrap().affected_items().len(), 4);
            // The words up to the rejected one were sent, followed by the return to the mode.
            assert_eq!(sent[..=at], words[..=at], "{sent:08X?}");
            assert!(sent[1 + at..].contains(&0) && sent.contains(&RUN), "{sent:08X?}");
            assert_eq!(sent.last(), Some(&0));
        }
    }
}

#[test]
fn encoder_rejects_edge_beyond_range() {
    let script = Script::new().on(0x4E00_0015, &[0x9800_0004]);
    let (ended, _, sent) = carry_out(script, cams(7, 0x15, 0x20, 0x80));
    let interrupted = ended.unwrap_err();
    assert!(interrupted.cause.to_string().contains("start or stop of a cam beyond the measuring range"));
    // The encoder is also returned to position mode.
    assert!(sent.ends_with(&[0x2080_0000, RUN, 0, 0x2021_0009, 0]), "{sent:08X?}");
}

/// If cam 0 starts at 0, its echo equals the busy word and must be stable for longer (reference 5).
#[test]
fn echo_equal_to_busy_must_last_longer() {
    let (ended, steps, sent) = carry_out(Script::new(), cams(0, 0, 0, 1));
    // The script returns 0 for every read-out, so the mask counts as not accepted.
    let interrupted = ended.unwrap_err();
    assert!(matches!(&interrupted.cause, Error::NotAccepted { item, wanted: 1, reads: 0 } if item == "cam-mask:1"));
    let cam = [0x4000_0000, 0x2020_0010, 0, 0x6000_0000, 0x2020_0020, 0, 0x2040_0001];
    assert!(sent.windows(7).any(|own| own == cam), "{sent:08X?}");
    let start = steps.iter().position(|step| step.out == 0x4000_0000).unwrap();
    let stop = steps.iter().position(|step| step.out == 0x6000_0000).unwrap();
    // The time is half the time limit.
    assert!(steps[stop].at.duration_since(steps[start].at).as_millis() >= 1000);
    // Here the encoder is really busy for 600 ms, and then rejects the word.
    let busy: Vec<u32> = std::iter::repeat_n(0xC000_0000, 120).chain([0x9800_0004]).collect();
    let interrupted = carry_out(Script::new().on(0x4000_0000, &busy), cams(0, 0, 0, 1)).0.unwrap_err();
    assert!(matches!(interrupted.cause, Error::Refused { sent, .. } if sent.emit() == 0x4000_0000), "{interrupted}");
}

/// A gateway returns the same word until its next bus cycle. Reading it more often does not prove that it is stable.
#[test]
fn repeated_reads_do_not_prove_stability() {
    let pace = Duration::from_millis(1);
    let cases: [(&str, u32, usize); 2] = [("an error", 0x8200_0000, 7), ("an echo of other data", 0xC200_0100, 60)];
    for (label, word, reads) in cases {
        let words: Vec<u32> = std::iter::repeat_n(word, reads).chain([0xC200_00FF]).collect();
        let script = with_readback_replies(Script { pace, ..Script::new() }.on(STEPS, &words));
        let (ended, ..) = carry_out(script, parameters(&[(Parameter::Steps, 255)]));
        assert_eq!(ended.unwrap().verified, 1, "{label}");
    }
}

/// An old confirmation may be for an earlier word, contain other data, have the manufacturer's bit set, and arrive late
/// (manual 5.3, "Encoder sends old confirmation"). It does not prove that there is another master (issue 22.2).
#[test]
fn skips_stale_echo() {
    // The old confirmation lasts 0.4 to 0.8 s at 5 ms per reading. The program never sent C2000100, the word of the
    // manual's example.
    for (stale, looks) in [(0xC200_0100, 80), (0xC200_0100, 160), (0xE200_00FF, 160), (0xC600_0004, 120)] {
        let old: Vec<u32> = std::iter::repeat_n(stale, looks).chain([0xC800_0000]).collect();
        let script = with_readback_replies(Script::new().on(STEPS, &[0xC000_0000, 0xC200_00FF]).on(0x0800_0000, &old));
        let (ended, ..) = carry_out(script, parameters(&[(Parameter::Steps, 255), (Parameter::Preset, 0)]));
        assert_eq!(ended.unwrap().verified, 2, "{stale:08X}");
        // The old confirmation arrives while a value is requested.
        let old: Vec<u32> = std::iter::repeat_n(stale, looks).chain([0xA000_0003]).collect();
        let identity = identify(&mut Master::for_job(Script::new().on(0x2021_0000, &old), &mut station("")));
        assert_eq!(identity.unwrap().serial_number, "3", "{stale:08X}");
    }
}

/// The message shows the echo but does not claim that another master sent it (issue 22.2).
#[test]
fn timeout_names_persistent_echo() {
    let (ended, ..) = carry_out(Script::new().on(STEPS, &[0xC600_0004]), worked_example());
    let cause = ended.unwrap_err().cause;
    let expected = "no acknowledgement within 2000 ms after OUT 020000FF; IN is C6000004, the acknowledgement of another \
                    word";
    assert_eq!(cause.to_string(), expected);
}

/// The busy word may contain the sent data (manual 10.4, X; reference 6.11a). An encoder that is busy for `busy`
/// milliseconds and then rejects the word has never accepted it (issue 22.1).
#[test]
fn processing_word_is_not_cam_0_echo() {
    for (word, echo) in
        [(0x4000_0015, 0xC000_0015), (0x6000_0020, 0xE000_0020), (0x2040_0001, 0xE040_0001), (0x2010_0008, 0xE010_0008)]
    {
        for looks in [3, 8, 18] {
            let busy: Vec<u32> = std::iter::repeat_n(echo, looks).chain([0x9800_0004]).collect();
            let mut ops = cams(0, 0x15, 0x20, 1);
            if let [Op::Program(change)] = ops.as_mut_slice() {
                change.shift = Some((WindowShift::default(), WindowShift::new(8).unwrap()));
            }
            let script = with_cam_replies(Script::new()).on(word, &busy);
            let cause = carry_out(script, ops).0.unwrap_err().cause;
            assert!(
                matches!(cause, Error::Refused { sent, .. } if sent.emit() == word),
                "{word:08X}, {looks}: {cause}"
            );
        }
    }
}

/// Adds the replies for cam 0 of program 1 (15h to 20h), which is read before the program is left and again after
/// `80000000`.
fn with_cam_replies(script: Script) -> Script {
    [(0x2020_0010, 0xA000_0015), (0x2020_0020, 0xA000_0020)]
        .iter()
        .fold(script, |script, (out, value)| script.on(*out, &[*value]).on(*out, &[*value]))
}

/// A word that was acknowledged but not accepted is sent again before `80000000` stores the program, and is observed
/// for longer each time. If it is never accepted, no operation is reported as done (issue 22.1).
#[test]
fn reads_cam_0_before_leaving_program() {
    let script = with_cam_replies(
        Script::new().on(0x2020_0010, &[0xA000_0000]).on(0x2020_0010, &[0xA000_0000]).on(0x2020_0000, &[0xA000_0001]),
    );
    let (ended, steps, sent) = carry_out(script, cams(0, 0x15, 0x20, 1));
    let done = ended.unwrap();
    assert_eq!((done.verified, done.write_cycles), (2, 1));
    let setting = sent.iter().position(|word| *word == 0x4000_0015).unwrap();
    let run = setting + sent[setting..].iter().position(|word| *word == RUN).unwrap();
    let own: Vec<u32> = sent[setting..run].iter().copied().filter(|word| *word != 0).collect();
    let start = [0x4000_0015, 0x2020_0010];
    let expected = [&start[..], &start, &start, &[0x6000_0020, 0x2020_0020, 0x2040_0001]].concat();
    assert_eq!(own, expected, "{sent:08X?}");
    // A step is reported when it changes. The times are those from the word itself to the question after it.
    let watched: Vec<u128> = steps
        .windows(2)
        .filter(|pair| pair[0].out == 0x4000_0015)
        .map(|pair| pair[1].at.duration_since(pair[0].at).as_millis())
        .collect();
    assert!(watched.len() == 3 && watched[0] >= 100 && watched[1] >= 200 && watched[2] >= 400, "{watched:?}");
    // In this case, the encoder never accepts the word.
    let never = (0..9).fold(Script::new(), |script, _| script.on(0x2020_0010, &[0xA000_0007]));
    let interrupted = carry_out(never, cams(0, 0x15, 0x20, 1)).0.unwrap_err();
    assert_eq!(interrupted.cause.to_string(), "cam:1:0 start: 21 was written, but 7 was read back");
    assert_eq!((interrupted.done.ops, interrupted.done.write_cycles), (0, 1), "leading back may store what was set");
}

/// Exception codes 01 to 03 mean that nothing was written. With any other code, the gateway may have forwarded the word
/// (Modbus application protocol 1.1b3, chapter 7).
#[test]
fn restores_mode_after_uncertain_write() {
    for (code, wrote) in [(0x02, false), (0x04, true), (0x06, true), (0x0B, true), (0x0B, false)] {
        let script = Script { refuses: Some((STEPS, code, wrote)), ..Script::new() };
        let (ended, _, sent) = carry_out(script, worked_example());
        let interrupted = ended.unwrap_err();
        let asked = RequestedItem::Write { register: 0, word: STEPS };
        assert_eq!(interrupted.cause, Error::Exception { requested: asked, exception: Exception::new(code) });
        assert_eq!(interrupted.end_state, EndState::AsFound, "{code:02X}");
        assert_eq!(sent.contains(&STEPS), wrote, "{sent:08X?}");
        assert!(sent.ends_with(&[RUN, 0]), "{code:02X}: {sent:08X?}");
    }
    // If the first word is rejected, the encoder may already show a value.
    let script = Script { refuses: Some((0x2021_0009, 0x0B, true)), ..Script::new() };
    let (sent, mut station) = (script.sent.clone(), station(""));
    assert!(matches!(identify(&mut Master::for_job(script, &mut station)), Err(Error::Exception { .. })));
    assert_eq!(*sent.lock().unwrap(), [0x2021_0009, 0]);
}

/// RUN is already on OUT, so 0 must be sent first.
#[test]
fn restoring_mode_creates_run_edge() {
    let script = Script { out: RUN, input: 0xC200_00FF, ..Script::new() };
    let (sent, mut station) = (script.sent.clone(), station(""));
    assert_eq!(Master::for_job(script, &mut station).end_interrupted_operation(), Ok(StartupMode::K3));
    assert_eq!(sent.lock().unwrap()[..2], [0, RUN]);
}

/// The shaft is two steps from the preset. The preset counts as applied only when the position equals it.
#[test]
fn triggers_preset_until_position_matches() {
    let fire = || vec![Op::FirePreset { value: POSITION + 2 }];
    let near: Vec<u32> = std::iter::repeat_n(POSITION, 6).chain([POSITION + 2]).collect();
    let (ended, steps, sent) = carry_out(Script::new().on(0x4000_0000, &near), fire());
    assert!(ended.is_ok() && sent.ends_with(&[0x4000_0000, 0]), "{sent:08X?}");
    let at = |out| steps.iter().filter(|step| step.out == out).map(|step| step.at).next_back().unwrap();
    assert!(at(0).duration_since(at(0x4000_0000)).as_millis() >= 95);
    // An encoder that does not accept the preset stays two steps away. The report names the word.
    let interrupted = carry_out(Script::new().on(0x4000_0000, &[POSITION]), fire()).0.unwrap_err();
    let missing =
        Error::TimeOut { awaited: ExpectedWord::Preset, sent: 0x4000_0000, input: POSITION, milliseconds: 2000 };
    assert_eq!(interrupted.cause, missing);
}

/// Cam words have another meaning in position mode, so the program must be selected and confirmed first.
#[test]
fn sends_cam_words_only_in_confirmed_mode() {
    let (_, _, sent) = carry_out(Script::new(), cams(3, 15, 213, 8));
    let first = sent.iter().position(|word| *word == 0x4600_000F).unwrap();
    assert_eq!(sent[first - 5..first], [0x2080_0001, RUN, 0, 0x2021_0009, 0], "{sent:08X?}");
    // If the encoder stays in position mode, none of these words is sent.
    let stays = Script::new().on(0x2021_0009, &[0xA000_0001]);
    let stays = (0..9).fold(stays, |script, _| script.on(0x2021_0009, &[0xA000_0001]));
    let (ended, _, sent) = carry_out(stays, cams(3, 15, 213, 8));
    let interrupted = ended.unwrap_err();
    assert!(matches!(interrupted.cause, Error::NoMode { is: StartupMode::K3, .. }), "{interrupted}");
    assert!(sent.iter().all(|word| word >> 29 != 0b010 && word >> 29 != 0b011), "{sent:08X?}");
}

#[test]
fn out_word_reveals_another_master() {
    let script = Script { output: Some(0x2040_0001), ..Script::new() }.on(STEPS, &[POSITION]);
    let interrupted = carry_out(script, worked_example()).0.unwrap_err();
    assert_eq!(interrupted.cause, Error::OtherMaster { sent: STEPS, output: 0x2040_0001 });
    assert_eq!(
        interrupted.cause.to_string(),
        "another master is writing to the encoder: OUT is 20400001, but 020000FF was written"
    );
}

#[test]
fn missing_reply_error_names_words() {
    for (word, awaited) in [(STEPS, ExpectedWord::Echo), (RUN, ExpectedWord::Run)] {
        let script = Script::new().on(word, &[0xC000_0000]).on(word, &[POSITION]);
        let (ended, _, sent) = carry_out(script, parameters(&[(Parameter::Steps, 255)]));
        let interrupted = ended.unwrap_err();
        let expected = Error::TimeOut { awaited, sent: word, input: 0xC000_0000, milliseconds: 2000 };
        match &interrupted.cause {
            // `80000000` does not return the encoder to its mode either, because the word is already on OUT.
            Error::ModeNotRestored { cause, standing } => {
                assert_eq!((**cause == expected, standing.out, standing.parameterising), (true, RUN, true));
            }
            cause => assert_eq!(*cause, expected),
        }
        assert!(sent.contains(&RUN));
    }
    let mut station = station("handshake=500");
    let script = Script::new().on(0x2021_0000, &[POSITION]);
    let error = identify(&mut Master::for_job(script, &mut station)).unwrap_err();
    assert_eq!(error.to_string(), "no value within 500 ms after OUT 20210000; IN is 000004D2");
}

#[test]
fn suspects_swapped_words() {
    let mut station = station("");
    // 1234h in the first register, 0 in the second.
    let script = Script::new().on(0x2021_0009, &[0x1234_0000]);
    let error = identify(&mut Master::for_job(script, &mut station)).unwrap_err();
    assert_eq!(error.to_string(), "IN 12340000 is plausible only as 00001234: the word order may be swapped");
}

/// The manual does not define what ends a mode. If `00000000` would end it, the word that selects the mode is left on
/// OUT.
#[test]
fn keeps_encoder_in_mode() {
    for (mode, holds) in [(5, RUN), (2, 0x2040_0001)] {
        let script = Script { normal_ends_modes: true, ..Script::in_mode(mode) };
        let sent = script.sent.clone();
        let mut station = station("");
        let mut master = Master::for_job(script, &mut station);
        let identity = identify(&mut master).unwrap();
        assert_eq!(identity.mode.emit(), mode);
        assert_eq!(sent.lock().unwrap().last(), Some(&holds), "mode {mode}: {:08X?}", sent.lock().unwrap());
    }
    // The same applies to a selected program. The next job already knows this.
    let mut station: Station = station("");
    let script = Script { normal_ends_modes: true, ..Script::new() };
    let sent = script.sent.clone();
    let mut master = Master::for_job(script, &mut station);
    let wanted = StartupMode::Cams(program(4));
    assert_eq!(select(&mut master, wanted).unwrap(), wanted);
    assert_eq!(sent.lock().unwrap().last(), Some(&RUN));
    assert_eq!(identify(&mut master).unwrap().mode, wanted);
    assert_eq!(sent.lock().unwrap().last(), Some(&RUN));
}

/// A requested cam value may remain after `00000000`. The request does not contain bit 16 either.
#[test]
fn ends_cam_readout_with_run() {
    let script = Script { normal_keeps_values: true, ..Script::new() }
        .on(0x2020_0013, &[0xA000_0015])
        .on(0x2020_0023, &[0xA000_0015, 0xA000_0015, 0xA000_0213]);
    let sent = script.sent.clone();
    let mut station = station("");
    let mut master = Master::for_job(script, &mut station);
    let (read, _) = read_programs(&mut master, &[program(1)], &mut |_, _, _| {}).unwrap();
    let cam = read[0].1.cams[3].unwrap();
    assert_eq!(cam.start.get(), 0x15);
    let sent = sent.lock().unwrap();
    assert!(sent.windows(4).any(|own| own == [0x2020_0013, 0, RUN, 0]), "{sent:08X?}");
}

/// Until the encoder has reported its mode, only the mode is requested.
#[test]
fn requests_mode_before_anything_else() {
    let script = Script::in_mode(0x55);
    let sent = script.sent.clone();
    let mut station = station("");
    let mut master = Master::for_job(script, &mut station);
    assert_eq!(identify(&mut master).unwrap().mode.emit(), 0x55);
    assert_eq!(sent.lock().unwrap().last(), Some(&0));
    // Nor is it sent afterwards, because the effect of 20800000 in that mode is unknown.
    for wanted in [StartupMode::K3, StartupMode::Velocity, StartupMode::Cams(program(1))] {
        let error = select(&mut master, wanted).unwrap_err();
        assert_eq!(error.to_string(), "the encoder is in the unknown mode 85, so only values were read");
    }
    let sent = sent.lock().unwrap();
    assert!(sent.iter().all(|word| *word == 0 || word >> 16 == 0x2021), "{sent:08X?}");
}
