//! Tests that every error states what happened and what to do, in both languages and with the relevant values.

use std::path::Path;

use super::*;
use crate::app::Language::{English, German};
use crate::devices::interbus::jobs::ChangeKind;
use crate::devices::interbus::procedures::write::{EndState, InterruptedWrite, WrittenChanges};
use crate::devices::interbus::procedures::{Exception, ReplyDamage, RequestedItem};
use crate::devices::interbus::profile::{Edge, Item, Op, PlanError, ProgramChange, TypeMismatch};
use crate::devices::interbus::protocol::{
    CamNumber, Code, Command, EncoderMode, Flags, ForbiddenCommandError, OutOfRange, Parameter, ProgramNumber,
    StartupMode, Value, WindowShift,
};
use crate::link::LinkErrorKind;
use crate::worker::NotStarted;

fn value(number: u32) -> Value {
    Value::new(number).unwrap()
}

fn error_word(word: u32) -> ErrorWord {
    ErrorWord { code: Code::from_word(word), data: Value::from_word(word) }
}

fn program(number: u8) -> StartupMode {
    StartupMode::Cams(ProgramNumber::new(number).unwrap())
}

#[track_caller]
fn assert_explains(text: &Text, facts: &[&str]) {
    for language in [English, German] {
        let words = text.to_string_in(language);
        assert!(facts.iter().all(|fact| words.contains(fact)), "{facts:?}: {words}");
        assert!(words.trim_end_matches('.').contains(['.', ';', ':']), "{words}");
        assert!(!words.contains('{') && words.ends_with('.'), "{words}");
    }
    assert_ne!(text.to_string_in(English), text.to_string_in(German));
}

#[test]
fn encoder_errors_name_remedy() {
    let requested = RequestedItem::Input { register: 16 };
    let standing = |found, is| LeftState { out: 0x2080_0003, parameterising: true, found, is };
    let set = Command::Set(Parameter::Steps, value(8193));
    let time_out = |awaited| Error::TimeOut { awaited, sent: 0x0200_2000, input: 0x12, milliseconds: 2000 };
    let cases = [
        (Error::NoReply { requested, tries: 3 }, vec!["16", "3"]),
        (
            Error::Damaged { requested, tries: 5, cause: ReplyDamage::Unit { requested: 1, got: 2 } },
            vec!["5", "unit 2", "1"],
        ),
        (Error::Damaged { requested, tries: 5, cause: ReplyDamage::NoFrame { bytes: 7 } }, vec!["7"]),
        (Error::Damaged { requested, tries: 5, cause: ReplyDamage::Function { requested: 4, got: 3 } }, vec!["3", "4"]),
        (Error::Damaged { requested, tries: 5, cause: ReplyDamage::Registers }, vec![]),
        (Error::NeverSilent, vec![]),
        (
            Error::Illegal(ForbiddenCommandError { command: Command::Preset, mode: EncoderMode::Cam }),
            vec!["0x40000000"],
        ),
        (Error::Refused { sent: set, error: error_word(0x8200_0000) }, vec!["0x02002001", "0x82000000"]),
        (Error::UnknownReadOut { command: Command::ReadShift }, vec!["0x20200040"]),
        (time_out(ExpectedWord::Echo), vec!["0x02002000", "2000", "0x00000012"]),
        (time_out(ExpectedWord::Value), vec!["0x02002000", "2000", "0x00000012"]),
        (time_out(ExpectedWord::Run), vec!["0x02002000", "2000", "0x00000012"]),
        (time_out(ExpectedWord::Preset), vec!["0x02002000", "2000", "0x00000012"]),
        (Error::OtherMaster { sent: 0, output: 0x4000_0000 }, vec!["0x40000000", "0x00000000"]),
        (Error::NotRunning { input: 0xC200_00FF }, vec!["0xC20000FF"]),
        (Error::WordOrder { input: 0x3456_0012, swapped: 0x0012_3456 }, vec!["0x34560012", "0x00123456", "order="]),
        (
            Error::Implausible(ImplausibleValue::Gear(GearError::Turns { turns: 65_536 })),
            vec!["65536", "4096", "order="],
        ),
        (
            Error::Implausible(ImplausibleValue::Gear(GearError::Steps { steps: 0, turns: 1, most: 8192 })),
            vec!["8192", "order="],
        ),
        (Error::Implausible(ImplausibleValue::Direction(77)), vec!["77", "order="]),
        (Error::Implausible(ImplausibleValue::Value { read: 0x2020_0040, value: 99 }), vec!["99", "0x20200040"]),
        (Error::NoMode { wanted: program(3), is: StartupMode::K3 }, vec!["3", "K3"]),
        (Error::NotSelectable { mode: StartupMode::K2 }, vec!["K2"]),
        (Error::UnknownMode { mode: StartupMode::Unknown(value(85)) }, vec!["85"]),
        (Error::Moving { from: 100, to: 180 }, vec!["100", "180"]),
        (Error::NotAccepted { item: "steps".to_owned(), wanted: 255, reads: 256 }, vec!["steps", "255", "256"]),
        (Error::Changed { item: "shift".to_owned() }, vec!["shift"]),
        (
            Error::ModeNotRestored {
                cause: Box::new(Error::NoReply { requested, tries: 3 }),
                standing: standing(Some(program(3)), Some(StartupMode::K3)),
            },
            vec!["16", "0x20800003", "3", "K3"],
        ),
        (
            Error::ModeNotRestored { cause: Box::new(Error::NeverSilent), standing: standing(None, None) },
            vec!["0x20800003"],
        ),
    ];
    for (error, facts) in cases {
        assert_explains(&encoder_error_text(&error), &facts);
    }
}

/// The exception codes are from *Modbus application protocol* 1.1b3, chapter 7.
#[test]
fn gateway_exception_text_has_code() {
    let requested = RequestedItem::Write { register: 2048, word: 0x4000_0000 };
    for code in [1, 2, 3, 4, 5, 6, 8, 0xA, 0xB, 0x7F] {
        let exception = Exception::new(code);
        let text = encoder_error_text(&Error::Exception { requested, exception });
        assert_explains(&text, &[&format!("0x{code:02X}"), "2048", "0x40000000"]);
        assert!(
            text.to_string_in(English).contains(exception.name())
                && !text.to_string_in(German).contains(exception.name())
        );
    }
}

/// The error words are from reference 2.
#[test]
fn explains_error_words() {
    for word in [0x8200_0000, 0x8400_0000, 0x8600_0000, 0x9800_0004, 0x9800_0005, 0x8000_0000] {
        let sent = Command::Shift(WindowShift::default());
        assert_explains(
            &encoder_error_text(&Error::Refused { sent, error: error_word(word) }),
            &[&format!("0x{word:08X}"), "0x20100000"],
        );
    }
}

#[test]
fn plan_errors_name_both_limits() {
    let beyond = |edge| {
        let item = Item::Cam(ProgramNumber::new(2).unwrap(), CamNumber::new(5).unwrap());
        PlanError::CamBeyondRange { item, edge, position: 3600, last: 3599 }
    };
    let preset = OutOfRange { parameter: Parameter::Preset, value: 3600, low: 0, high: 3599 };
    let left = PlanError::MountingLeft { item: Item::Preset, value: 5000, low: 0, high: 3599 };
    let types = TypeMismatch { profile: Flags::new(value(2)), device: Flags::new(value(1)) };
    let cases = [
        (
            PlanError::OtherDevice { profile: "123".to_owned(), device: "456".to_owned() },
            vec!["123", "456"],
            Some("--allow-other-device"),
        ),
        (PlanError::TypeMismatch(types), vec!["ultiturn", "ingle"], Some("--allow-other-type")),
        (PlanError::Gear(GearError::Turns { turns: 4097 }), vec!["4097", "1", "4096"], None),
        (PlanError::Gear(GearError::Steps { steps: 8193, turns: 1, most: 8192 }), vec!["8193", "8192"], None),
        (PlanError::OutOfRange(preset), vec!["3600", "0", "3599"], None),
        (left, vec!["5000", "0", "3599"], Some("--with-mounting")),
        (beyond(Edge::Start), vec!["5", "2", "3600", "0", "3599"], None),
        (beyond(Edge::Stop), vec!["5", "2", "3600", "0", "3599"], None),
        (PlanError::NotRead { item: Item::Shift }, vec!["shift"], None),
    ];
    for (error, facts, option) in cases {
        let text = plan_error_text(&error);
        assert_explains(&text, &facts);
        assert!(option.is_none_or(|option| text.terminal_text().contains(option)), "{}", text.terminal_text());
        assert!(option.is_none_or(|option| !text.to_string_in(English).contains(option)), "no options in the window");
    }
    let worn = job_error_texts(&JobError::NotStarted(NotStarted::Worn { seen: 448, cost: 2, limit: 449 }));
    assert_explains(&worn[0], &["448", "2"]);
    assert!(worn[0].terminal_text().contains("450") && worn[0].terminal_text().contains("--force-wear"), "{worn:?}");
}

#[test]
fn interrupted_write_lists_remaining_steps() {
    let told = |write_cycles, left, kind| -> Vec<String> {
        let done = WrittenChanges { ops: 1, write_cycles, written: 1, verified: 1 };
        let shift = Some((WindowShift::default(), WindowShift::default()));
        let program = ProgramNumber::new(1).unwrap();
        let unfinished = Some(Op::Program(ProgramChange { program, cams: Vec::new(), mask: None, shift }));
        let interrupted = InterruptedWrite { done, unfinished, cause: Error::NeverSilent, end_state: left };
        let texts = write::interruption_text(&interrupted, Path::new("b.ron"), 3, kind);
        assert!(texts.iter().all(|text| text.to_string_in(English) != text.to_string_in(German)), "{texts:?}");
        texts.iter().map(Text::terminal_text).collect()
    };
    for (kind, what) in [
        (ChangeKind::Restore, "restore the profile again"),
        (ChangeKind::Edits, "the command again"),
        (ChangeKind::Preset, "whether the position was set"),
        (ChangeKind::Default, "to return to the previous values"),
    ] {
        let lines = told(2, EndState::AsFound, kind);
        assert!(lines.len() == 3 && lines[2].contains("b.ron") && lines[2].contains(what), "{lines:?}");
        assert!(lines[0].contains("1 of 3") && lines[1].contains("is running again") && lines[1].contains("shift"));
    }
    let standing = LeftState { out: 0, parameterising: true, found: None, is: None };
    let lines = told(2, EndState::Unknown(standing), ChangeKind::Restore);
    assert!(lines[1].contains("lead-back"), "{lines:?}");
}

/// The advice to complete the write follows the advice to return the encoder to its mode (issue 22.5).
#[test]
fn advises_return_to_operation_first() {
    let standing = LeftState { out: 0, parameterising: true, found: None, is: None };
    for kind in [ChangeKind::Restore, ChangeKind::Edits, ChangeKind::Preset, ChangeKind::Default] {
        let done = WrittenChanges { ops: 1, write_cycles: 1, written: 1, verified: 1 };
        let last = |left| {
            let interrupted =
                InterruptedWrite { done: done.clone(), unfinished: None, cause: Error::NeverSilent, end_state: left };
            write::interruption_text(&interrupted, Path::new("b.ron"), 3, kind).pop().unwrap()
        };
        let (found, unknown) = (last(EndState::AsFound), last(EndState::Unknown(standing)));
        assert_eq!(
            unknown.terminal_text(),
            format!("First return the encoder to operation. {}", found.terminal_text())
        );
        assert!(
            unknown.to_string_in(German).starts_with("Zuerst den Geber in den Betrieb zurückführen. "),
            "{unknown:?}"
        );
        assert_eq!(write::severity_of(&unknown), write::severity_of(&found));
    }
}

/// If the number of earlier EEPROM write cycles is unknown, the message names the option that permits the write (issue
/// 22.4).
#[test]
fn unknown_wear_names_override() {
    let refused = job_error_texts(&JobError::NotStarted(NotStarted::WearUnknown { cost: 2 }));
    assert_explains(&refused[0], &["2"]);
    assert!(refused[0].terminal_text().contains("--force-wear"), "{refused:?}");
}

#[test]
fn describes_each_operation() {
    use crate::devices::interbus::profile::{CamChange, ParameterChange, ProgramChange};
    let words = |op: &Op| {
        let own = super::operation_texts(op);
        let one = |change: &crate::app::review::ChangeDescription| {
            let part = change.part.as_ref().map(|part| part.to_string_in(English) + ": ").unwrap_or_default();
            format!("{part}{} → {}", change.old.to_string_in(English), change.new.to_string_in(English))
        };
        (own.item.to_string_in(English), own.changes.iter().map(one).collect::<Vec<_>>())
    };
    let turned = ParameterChange { parameter: Parameter::Direction, from: 3, to: 4 };
    let expected = vec!["direction: clockwise → counterclockwise".to_owned()];
    assert_eq!(words(&Op::Parameterise(vec![turned])), ("Parameters (saved in one write cycle)".to_owned(), expected));
    let cam = |number| CamNumber::new(number).unwrap();
    let change = ProgramChange {
        program: ProgramNumber::new(2).unwrap(),
        cams: vec![
            CamChange { cam: cam(5), edge: Edge::Stop, from: value(10), to: value(20) },
            CamChange { cam: cam(6), edge: Edge::Start, from: value(900), to: value(910) },
            CamChange { cam: cam(6), edge: Edge::Stop, from: value(40), to: value(55) },
        ],
        mask: Some((0, 0x93)),
        shift: WindowShift::new(0).zip(WindowShift::new(8)),
    };
    let expected =
        ["cam 5, stop: 10 → 20", "cam 6: 900…40 → 910…55", "active cams: none → 0, 1, 4, 7", "window shift: 0 → 8"]
            .map(str::to_owned)
            .to_vec();
    assert_eq!(words(&Op::Program(change)), ("Cam program 2 (saved in one write cycle)".to_owned(), expected));
    let fired = words(&Op::FirePreset { value: 500 });
    assert_eq!(fired.1, ["position when the preset is set → 500"]);
    assert!(words(&Op::Default).1[0].contains("experimental"));
}

#[test]
fn only_lost_link_ends_connection() {
    let gone = || Error::Link(LinkError::new("plc:502", LinkErrorKind::Lost));
    let standing = LeftState { out: 0, parameterising: false, found: None, is: None };
    for error in [gone(), Error::ModeNotRestored { cause: Box::new(gone()), standing }] {
        assert_eq!(connection_loss_text(&JobError::Device(error)).unwrap().id(), "link.lost");
    }
    let silent = JobError::Device(Error::NoReply { requested: RequestedItem::Input { register: 0 }, tries: 3 });
    assert!(connection_loss_text(&silent).is_none() && is_no_response(&silent));
    assert!(!is_no_response(&JobError::Device(Error::NeverSilent)));
}
