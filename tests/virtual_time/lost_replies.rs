//! Loses each request and each reply in turn. Reads are repeated, and changes are never executed twice.

use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::{Change, DeviceMessage, HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, Command, DeviceAddress, StatusCode};
use encoder_studio::link::Clock;
use encoder_studio::worker::{Event, JobId};

use crate::support::Desk;

/// Executes a change repeatedly, losing each request and then each reply in turn. `judge` checks the result.
fn robbed(query: &str, change: &Change, setup: impl Fn(&mut Desk), judge: impl Fn(&mut Desk, &str)) {
    let mut frames = 0;
    for at in 0.. {
        for request in [true, false] {
            let mut desk = Desk::new(query);
            setup(&mut desk);
            let prepared = desk.prepare(change.clone()).unwrap();
            let already = desk.tap().sent.len();
            let worn = desk.wear();
            match request {
                true => desk.tap().swallow_request = Some(already + at),
                false => desk.tap().swallow_reply = Some(already + at),
            }
            let context = format!("{} {at} of {change:?}", if request { "request" } else { "reply" });
            let done = desk.commit(&prepared).unwrap_or_else(|error| panic!("{context}: {error:?}"));
            assert_eq!(done.written.ops, 1, "{context}");
            assert_eq!(desk.wear() - worn, 1, "{context}: written once");
            let told = done.written.write_cycles;
            assert!(told == 1 || request && told == 2, "{context}: {told} told");
            frames = desk.tap().sent.len() - already;
            *desk.tap() = Default::default();
            judge(&mut desk, &context);
        }
        if at >= frames {
            return;
        }
    }
}

#[test]
fn counter_increases_by_one() {
    for from in [0, 41, 0x00FF_FFFE] {
        let setup = |desk: &mut Desk| desk.bus().encoder_mut(0).unwrap().set_counter(from);
        robbed("", &Change::IncrementCounter, setup, |desk, context| {
            assert_eq!(desk.bus().encoders()[0].counter(), from + 1, "{context}");
        });
    }
}

#[test]
fn clears_counter_despite_lost_replies() {
    let setup = |desk: &mut Desk| desk.bus().encoder_mut(0).unwrap().set_counter(77);
    robbed("", &Change::ClearCounter, setup, |desk, context| {
        assert_eq!(desk.bus().encoders()[0].counter(), 0, "{context}");
    });
}

#[test]
fn uses_changed_access_code() {
    let zero = AccessCodeNumber::ZERO;
    let change = Change::ChangeCode { number: zero, new: AccessCode::new(0xC3) };
    robbed(
        "codes=0:9D",
        &change,
        |desk| desk.remember_code(0, 0x9D),
        |desk, context| {
            assert_eq!(desk.bus().encoders()[0].memory().code(zero).byte(), 0xC3, "{context}");
            // The session also knows the code that protects field 0.
            assert!(desk.save().unwrap().fields[0].bytes.is_some(), "{context}");
        },
    );
}

#[test]
fn follows_changed_address() {
    let change = Change::SetAddress(DeviceAddress::new(0x4B).unwrap());
    robbed(
        "",
        &change,
        |_| {},
        |desk, context| {
            assert_eq!(desk.bus().encoders()[0].address().byte(), 0x4B, "{context}");
            assert_eq!(desk.session.station().address, 0x4B, "{context}");
            desk.run(HiperfaceJob::Identify).unwrap();
        },
    );
}

#[test]
fn sets_position_despite_lost_replies() {
    let change = Change::SetPosition { wanted: 4096, exact: true, synchronise: false, kit: false };
    robbed(
        "",
        &change,
        |_| {},
        |desk, context| {
            assert_eq!(desk.bus().encoders()[0].position(desk.clock.now()), 4096, "{context}");
        },
    );
}

/// A position that equals the previous one does not prove that the tracks were aligned, so the alignment must not be
/// reported.
#[test]
fn does_not_assume_synchronisation() {
    let mut desk = Desk::new("model=sel37");
    let wanted = desk.bus().encoders()[0].position(desk.clock.now());
    let prepared = desk.prepare(Change::SetPosition { wanted, exact: true, synchronise: true, kit: true }).unwrap();
    for at in 0..30 {
        let mut desk = desk.copied();
        desk.tap().swallow_request = Some(at);
        let done = desk.commit(&prepared);
        let carried_out = desk.bus().encoders()[0].wear().write_count(Command::Synchronise);
        assert!(carried_out <= 1);
        assert!(done.is_err() || carried_out == 1, "frame {at} lost: {done:?}");
    }
}

/// After a failed job, the next one again has five tries.
#[test]
fn each_job_gets_all_tries() {
    let mut desk = Desk::new("");
    desk.tap().deaf_from = Some(0);
    desk.run(HiperfaceJob::Identify).unwrap_err();
    desk.clock.sleep_until(desk.clock.now() + Duration::from_secs(60));
    let sent = desk.tap().sent.len();
    desk.tap().deaf_from = None;
    desk.tap().swallow_reply = Some(sent);
    let identity = desk.run(HiperfaceJob::Identify).unwrap();
    assert!(matches!(identity, HiperfaceOutput::Identity(identity) if identity.serial.serial_number == "GB0450179"));
}

#[test]
fn silent_encoder_times_out() {
    for settings in ["E4", "E0", "E6"] {
        let format = encoder_studio::devices::hiperface::protocol::LineSettings::from_byte(
            u8::from_str_radix(settings, 16).unwrap(),
        );
        let mut station = encoder_studio::devices::hiperface::procedures::Station::new(crate::support::MARGIN);
        station.format = format.character_format().unwrap();
        for job in [HiperfaceJob::Position(None), HiperfaceJob::Status, HiperfaceJob::Save(Default::default())] {
            let mut desk = Desk::with_station(&format!("settings=0x{settings}&fault=silent-after:0"), station.clone());
            desk.run(job).unwrap_err();
            assert!(desk.clock.now().since_start() < Duration::from_secs(10), "{settings}: {:?}", desk.clock.now());
            assert!(desk.tap().sent.len() <= 5);
        }
    }
}

/// Request 50h removes a code from the encoder. Whichever reply is lost, each code is returned or counted as possibly
/// lost (issue 22.10).
#[test]
fn reports_lost_status_codes() {
    let queue = [StatusCode::TEMPERATURE, StatusCode::TOO_FAST, StatusCode::COUNTER_OVERFLOW];
    let mut counted = 0;
    for lost in 0..8 {
        let mut desk = Desk::new("");
        desk.run(HiperfaceJob::Identify).unwrap();
        queue.iter().for_each(|code| desk.bus().encoder_mut(0).unwrap().queue_code(*code));
        let already = desk.tap().sent.len();
        desk.tap().swallow_reply = Some(already + lost);
        let (mut codes, mut unheard) = (Vec::new(), 0);
        let end = desk.session.run(JobId::default(), HiperfaceJob::Status, &mut |event| match event {
            Event::DeviceMessage(DeviceMessage::Codes(own)) => codes.extend(own),
            Event::DeviceMessage(DeviceMessage::CodesLost(count)) => unheard += count,
            _ => {}
        });
        let Event::Finished(_, output) = end else { panic!("{lost}: {end:?}") };
        let HiperfaceOutput::Status(own) = *output else { panic!("{lost}") };
        codes.extend(own);
        let missing = queue.iter().filter(|code| !codes.contains(code)).count();
        assert!(missing <= unheard as usize, "reply {lost}: {codes:?}, {unheard} counted");
        counted += unheard;
    }
    assert!(counted > 0, "50h was among them");
}

/// A code can only have been lost if 50h was sent (issue 22.10).
#[test]
fn unrequested_codes_are_not_lost() {
    let mut desk = Desk::new("fault=silent-after:0");
    let mut told = Vec::new();
    let end = desk.session.run(JobId::default(), HiperfaceJob::Status, &mut |event| told.push(format!("{event:?}")));
    assert!(matches!(end, Event::Failed(..)), "{end:?}");
    assert!(!desk.tap().sent.iter().any(|frame| frame.get(1) == Some(&0x50)));
    assert!(!told.iter().any(|event| event.contains("CodesLost")), "{told:?}");
}
