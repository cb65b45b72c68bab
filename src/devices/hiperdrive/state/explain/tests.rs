//! Tests of the messages about HIPERDRIVE drives, in both languages.

use std::time::Duration;

use super::{device_error_text, end_severity, end_text, lock_text, plan_error_text, warning_text, wrong_length};
use crate::app::explain::literal_text;
use crate::app::{Language, Severity, Text};
use crate::buses::ethernet_ip::protocol::{AddressError, GeneralStatus, Service};
use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionLock, MotionRejection};
use crate::devices::hiperdrive::procedures::{
    Error, ErrorReply as Refused, LateReplyError, ReplyDamage, RequestedItem, WrongLength,
};
use crate::devices::hiperdrive::profile::{Item, PlanError, TypeMismatch, Warning};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, OutOfRange, ParameterNumber, ParameterRange, State, Topology, ValueError, Variant,
};

const ONE: DriveNumber = DriveNumber::FIRST;

fn number(number: u16) -> ParameterNumber {
    ParameterNumber::new(number).unwrap()
}

/// Checks that messages are complete sentences, with all arguments filled in.
#[track_caller]
fn assert_complete(text: &Text, sentences: usize) {
    for words in [text.to_string_in(Language::English), text.to_string_in(Language::German), text.terminal_text()] {
        assert!(!words.contains(['{', '}']), "{words}");
        assert!(words.ends_with('.') && words.matches(['.', ':', ';', '?']).count() >= sentences, "{words}");
    }
}

#[test]
fn invalid_input_shows_cause_and_remedy() {
    let english = |text: &Text| text.to_string_in(Language::English);
    let out =
        OutOfRange { number: number(166), name: "maximum speed", value: 351, range: ParameterRange::Within(5, 350) };
    assert_eq!(
        english(&device_error_text(&Error::OutOfRange(out))),
        "Parameter 166 (Maximum speed) cannot be set to 351. Allowed values: 5 to 350."
    );
    let outside = PlanError::PositionOutside { drive: ONE, position: 5000, lower: 0, upper: 4000 };
    assert!(
        english(&plan_error_text(&outside)).starts_with("Drive 1 is at 5000 and would reject the limits 0 to 4000")
    );
    let read_only = PlanError::ReadOnly { item: Item(number(107)) };
    assert_eq!(
        english(&plan_error_text(&read_only)),
        "Parameter 107 (Actual position) is read-only. Choose another parameter."
    );
    assert_eq!(
        english(&device_error_text(&Error::NotRequested { drive: ONE })),
        "Drive 1 rejected the request because its parameter 152 (Requested) is 0. Set this parameter to 1 first."
    );
    let switch = end_text(ActionEnd::NotStarted, literal_text);
    assert!(english(&switch).contains("S3 of the hub is set to 0"), "{}", english(&switch));
    let master = device_error_text(&Error::OtherMaster { extended: 0x0106 });
    assert!(
        english(&master).starts_with("Another master already controls these drives (0x0106). Close its connection"),
        "{}",
        english(&master)
    );
}

#[test]
fn errors_show_cause_and_remedy() {
    let requested = RequestedItem::Set(number(158));
    let refusal =
        |status: u8| Refused { service: Service::SET, status: GeneralStatus::new(status), extended: Vec::new() };
    let late = LateReplyError { took: Duration::from_millis(1300), waited: Duration::from_millis(1050) };
    let ranged = |range| OutOfRange { number: number(186), name: "RS-485 time-out", value: 0, range };
    let length = WrongLength { number: number(107), name: "actual position", expected: 4, got: 2 };
    let errors = [
        Error::NeverSilent,
        Error::NoReply { requested: RequestedItem::Session, tries: 5, late: None },
        Error::NoReply { requested: RequestedItem::Session, tries: 5, late: Some(late) },
        Error::Damaged { requested: RequestedItem::Identity, tries: 5, cause: ReplyDamage::Empty },
        Error::Damaged { requested: RequestedItem::Mac, tries: 5, cause: ReplyDamage::Cut { bytes: 7 } },
        Error::InControl,
        Error::NoCyclic,
        Error::Unknown(number(44)),
        Error::NoNumber(900),
        Error::NoPlace { drive: ONE, topology: Topology::Hub4 },
        Error::NoDrive { drive: ONE },
        Error::OutOfRange(ranged(ParameterRange::WithinOrEqual(1, 100, 255))),
        Error::Refuses(ranged(ParameterRange::OneOf(&[9600, 19200, 38400]))),
        Error::Value { number: number(158), cause: ValueError::TextForNumber },
        length.into(),
        Error::ReadOnly { number: number(107), name: "actual position" },
        Error::WriteOnly { number: number(199), name: "reset drive" },
        Error::Motion { number: number(104), name: "target position" },
        Error::Moving { drive: ONE },
        Error::NotHiperdrive { product: "1769-L16ER".to_owned() },
        Error::NotAccepted { number: number(198), wanted: 100, reads: 128 },
        Error::NetworkNotTaken { attribute: 5 },
        Error::Busy { reads: 1, milliseconds: 2000 },
        Error::Changed { item: "158".to_owned() },
    ];
    for error in errors {
        assert_complete(&device_error_text(&error), 2);
    }
    // The message states both lengths in both languages (issue 21.9).
    for (language, said) in [
        (
            Language::English,
            "The value of parameter 107 (Actual position) was ignored because it has the wrong length (bytes received: 2, expected: 4)",
        ),
        (
            Language::German,
            "Der Wert von Parameter 107 (Istposition) wurde ignoriert, weil er die falsche Länge hat (Bytes empfangen: 2, erwartet: 4)",
        ),
    ] {
        assert!(
            wrong_length(&length).to_string_in(language).starts_with(said),
            "{}",
            wrong_length(&length).to_string_in(language)
        );
    }
    // If a longer time limit may help, the command line explains how to set it, and the window does not mention a link.
    for late in [None, Some(late)] {
        let text = device_error_text(&Error::NoReply { requested: RequestedItem::Session, tries: 5, late });
        assert!(text.terminal_text().contains("timeout=2000 in the link"), "{}", text.terminal_text());
        assert!(!text.to_string_in(Language::English).contains("timeout="));
    }
    for status in 0..=0x30 {
        assert_complete(&device_error_text(&Error::Refused { requested, refusal: refusal(status) }), 2);
    }
}

#[test]
fn plan_errors_and_motion_ends_show_remedy() {
    let item = Item(number(258));
    let (profile, here) = (|| "17".to_owned(), || "18".to_owned());
    let plans = [
        PlanError::OtherDevice { profile: profile(), device: here() },
        PlanError::OtherDrive { drive: ONE, profile: profile(), device: here() },
        TypeMismatch::Device { profile: Topology::Hub8, device: Topology::Adapter }.into(),
        TypeMismatch::Drive { drive: ONE, profile: Variant::new(7), device: Variant::OTHER }.into(),
        PlanError::Moves { item },
        PlanError::Acts { item },
        PlanError::NotRead { item },
        PlanError::LimitsCrossed { drive: ONE, lower: 2, upper: 1 },
        PlanError::PositionTooLarge { drive: ONE, position: i64::MAX },
        PlanError::ReferenceOutside { drive: ONE, position: 1, becomes: 0, lower: 64, upper: 128 },
        PlanError::Address(AddressError::None),
        PlanError::Source(7),
    ];
    plans.iter().for_each(|error| assert_complete(&plan_error_text(error), 2));
    let turns = (-511.0, 511.0);
    let warnings = [
        Warning::LimitsMove { drive: ONE, now: turns, then: (-83_722.24, 83_722.24) },
        Warning::AfterReset(item),
        Warning::NoTimeout(ONE),
        Warning::NotRequested(ONE),
    ];
    warnings.iter().for_each(|own| assert_complete(&warning_text(own), 2));
    let locks = [MotionLock::Unread, MotionLock::NoTimeout, MotionLock::LimitsUnconfirmed, MotionLock::NotRequested];
    let refusals = [
        MotionRejection::NoEffort,
        MotionRejection::Outside { target: 3, low: 1, high: 2 },
        MotionRejection::Endless,
        MotionRejection::Fault,
        MotionRejection::SwitchOnLock,
        MotionRejection::NothingToPause,
        MotionRejection::NothingToResume,
        MotionRejection::Absent,
    ];
    let bad = [
        ActionEnd::RangeEnd,
        ActionEnd::Stale,
        ActionEnd::Deaf,
        ActionEnd::Lost,
        ActionEnd::Fault,
        ActionEnd::NoAnswer(State::Ready),
        ActionEnd::NotStarted,
        ActionEnd::Left(State::Fault),
        ActionEnd::Short,
    ];
    locks.iter().for_each(|own| assert_complete(&lock_text(*own), 2));
    for own in bad.into_iter().chain(refusals.map(ActionEnd::Refused)).chain(locks.map(ActionEnd::Locked)) {
        assert_complete(&end_text(own, literal_text), 2);
        assert!(end_severity(own) >= Severity::Warning, "{own:?}");
    }
    for own in [ActionEnd::Done, ActionEnd::Arrived, ActionEnd::Stopped, ActionEnd::Replaced] {
        assert_complete(&end_text(own, literal_text), 1);
        assert_eq!(end_severity(own), Severity::Note, "no action is needed");
    }
}
