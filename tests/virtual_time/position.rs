//! Setting the position: only at standstill, in phase unless otherwise requested, and reversible.

use encoder_studio::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput, JobError};
use encoder_studio::devices::hiperface::procedures::{Error, Station};
use encoder_studio::devices::hiperface::protocol::{Command, LineSettings};
use encoder_studio::link::Clock;
use encoder_studio::store::Logbook;

use crate::support::{Desk, MARGIN, backup};

fn set(wanted: u32, exact: bool) -> Change {
    Change::SetPosition { wanted, exact, synchronise: false, kit: false }
}

#[test]
fn rejects_moving_shaft() {
    for rpm in ["5", "-0.5", "3000"] {
        let error = Desk::new(&format!("rpm={rpm}")).prepare(set(0, true)).unwrap_err();
        assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error:?}");
    }
    let mut desk = Desk::new("");
    let prepared = desk.prepare(set(0, true)).unwrap();
    let now = desk.clock.now();
    desk.bus().encoder_mut(0).unwrap().set_rpm(now, 2.0);
    let error = desk.commit(&prepared).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error:?}");
    assert_eq!(desk.wear(), 0);
}

#[test]
fn keeps_five_lowest_bits_by_default() {
    // The SKM36 has 128 · 32 · 4096 positions and is at 000E0531h, which is phase 17.
    for (wanted, expected) in [(0, 17), (1, 17), (32, 17), (34, 49), (0x1234, 0x1231), (0x00FF_FFFF, 0x00FF_FFF1)] {
        let mut desk = Desk::new("");
        let prepared = desk.prepare(set(wanted, false)).unwrap();
        assert_eq!(prepared.wanted_position, (wanted != expected).then_some(wanted));
        desk.commit(&prepared).unwrap();
        assert_eq!(desk.bus().encoders()[0].position(desk.clock.now()), expected, "{wanted}");
        desk.change(set(wanted, true)).unwrap();
        assert_eq!(desk.bus().encoders()[0].position(desk.clock.now()), wanted);
    }
}

#[test]
fn records_previous_position() {
    let mut desk = Desk::new("");
    let done = desk.change(set(0, true)).unwrap();
    assert_eq!(backup(&done.backup.unwrap()).recorded.position, Some(0x000E_0531));
    let store = encoder_studio::store::Store::at_root(desk.folder.path());
    let key = encoder_studio::store::DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: "37h".to_owned(),
        serial_number: "GB0450179".to_owned(),
        is_virtual: true,
    };
    let entries = Logbook::open(&store.logbook_path()).unwrap().history(&key, 9).unwrap();
    assert_eq!(entries.len(), 1);
    assert_eq!((entries[0].description.as_str(), entries[0].planned_cycles), ("position: 918833 → 0", 1));
    assert_eq!(entries[0].conclusion.as_ref().unwrap().cycles_spent, 1);
}

/// The position of a shaft at rest may vary by one step. Around zero, it then jumps over the entire range.
#[test]
fn setting_zero_tolerates_dither() {
    for tenths in 1..=600 {
        let mut desk = Desk::new("");
        let prepared = desk.prepare(set(0, true)).unwrap();
        let now = desk.clock.now();
        // With 4096 steps per turn, a step takes 370 ms at 0.04 rpm, about the time from the plan to the read-back.
        desk.bus().encoder_mut(0).unwrap().set_rpm(now, -f64::from(tenths) / 10_000.0);
        let done = desk.commit(&prepared);
        let moved = matches!(done, Err(JobError::Device(Error::Moving { .. })));
        assert!(done.is_ok() || moved && tenths > 300, "{tenths}: {done:?}");
    }
}

#[test]
fn synchronises_only_kit_encoders() {
    let synchronise = |kit| Change::SetPosition { wanted: 0x40, exact: true, synchronise: true, kit };
    for kit in [false, true] {
        let error = Desk::new("").prepare(synchronise(kit)).unwrap_err();
        assert!(matches!(error, JobError::Device(Error::NotAKit { .. })), "{error:?}");
    }
    // The extended label does not show that the encoder is a kit encoder, so the user confirms it.
    assert!(Desk::new("model=sel37").prepare(synchronise(false)).is_err());
    let mut desk = Desk::new("model=sel37");
    desk.change(synchronise(true)).unwrap();
    assert_eq!(desk.bus().encoders()[0].wear().write_count(Command::Synchronise), 1);
    assert_eq!(desk.bus().encoders()[0].position(desk.clock.now()), 0x40);
}

/// A position has the time at which the encoder sampled it.
#[test]
fn position_has_sampling_time() {
    for query in ["rpm=3000", "rpm=-1200&fault=delay:60", "rpm=500&fault=delay:33&echo=on", "rpm=3000&pace=worst"] {
        let mut desk = Desk::new(query);
        for _ in 0..50 {
            let reading = match desk.run(HiperfaceJob::Position(None)) {
                Ok(HiperfaceOutput::Position(reading)) => reading,
                // An encoder that is slower than the manual allows may cause an error.
                Err(_) if query.contains("delay") => continue,
                other => panic!("{query}: {other:?}"),
            };
            let truth = desk.bus().encoders()[0].position(reading.at);
            assert!(reading.raw.abs_diff(truth) <= 1, "{query}: {} at {:?}, not {truth}", reading.raw, reading.at);
        }
    }
}

/// A full cycle consists of request, timeout, processing, reply and dead time. The goal is 95 % of the resulting rate.
#[test]
fn polls_at_full_protocol_speed() {
    for byte in [0xE0, 0xE4, 0xE5, 0xE6, 0xA6] {
        let settings = LineSettings::from_byte(byte);
        let mut station = Station::new(MARGIN);
        station.format = settings.character_format().unwrap();
        station.long_timeout = settings.has_long_timeout();
        let mut desk = Desk::with_station(&format!("settings={byte}&pace=worst"), station);
        desk.run(HiperfaceJob::Position(None)).unwrap();
        let before = desk.clock.now();
        for _ in 0..100 {
            desk.run(HiperfaceJob::Position(None)).unwrap();
        }
        let cycle = desk.clock.now().duration_since(before).as_secs_f64() / 100.0;
        // The request has three characters and the reply seven, each of 11 bits. Silence precedes and follows the
        // reply, and processing takes 10 ms.
        let silence = if settings.has_long_timeout() { 44.0 } else { 11.0 };
        let least = (10.0 * 11.0 + 2.0 * silence) / f64::from(settings.baud().unwrap().bits_per_second()) + 0.010;
        assert!(least >= cycle * 0.95, "{settings}: {cycle} s a cycle, {least} s needed");
        assert!(least <= cycle * 1.0001, "{settings}: {cycle} s a cycle is faster than allowed, {least} s");
    }
}

/// Stray bytes between requests are not part of the next reply. They do not count as a try or lower the line quality.
#[test]
fn reply_excludes_bytes_received_in_pause() {
    let mut desk = Desk::new("");
    desk.run(HiperfaceJob::Position(None)).unwrap();
    let now = desk.clock.now();
    desk.clock.sleep_until(now + std::time::Duration::from_secs(1));
    desk.tap().foreign.extend([0x40, 0x42, 0x00]);
    let sent = desk.tap().sent.len();
    desk.run(HiperfaceJob::Position(None)).unwrap();
    assert_eq!(desk.tap().sent.len(), sent + 1);
    assert_eq!(desk.session.station().line.damaged, 0);
}
