//! Setting the position: at rest only, in phase unless wished otherwise, and with a way back.

use encoder_studio::device::hiperface::Error;
use encoder_studio::link::Clock;
use encoder_studio::protocol::hiperface::Command;
use encoder_studio::store::Logbook;
use encoder_studio::worker::hiperface::{Change, HiperfaceJob, HiperfaceOutput, JobError};

use crate::support::{Desk, backup};

fn set(wanted: u32, exact: bool) -> Change {
    Change::SetPosition { wanted, exact, synchronise: false, kit: false }
}

#[test]
fn a_moving_shaft_is_refused_when_planning_and_when_writing() {
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
fn the_five_lowest_bits_stay_unless_wished_otherwise() {
    // SKM36: 128 · 32 · 4096 positions; it stands at 000E0531h, phase 17.
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
fn the_way_back_is_kept() {
    let mut desk = Desk::new("");
    let done = desk.change(set(0, true)).unwrap();
    assert_eq!(backup(&done.backup.unwrap()).recorded.position, Some(0x000E_0531));
    let store = encoder_studio::store::Store::at(desk.folder.path());
    let key = encoder_studio::store::DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: "37h".to_owned(),
        serial_number: "GB0450179".to_owned(),
        is_virtual: true,
    };
    let entries = Logbook::open(&store.logbook_path()).unwrap().history(&key, 9).unwrap();
    assert_eq!(entries.len(), 1);
    assert_eq!((entries[0].what.as_str(), entries[0].planned_cycles), ("position", 1));
    assert_eq!(entries[0].conclusion.as_ref().unwrap().cycles_spent, 1);
}

/// A shaft at rest dithers by a step. At zero that is the whole range.
#[test]
fn zero_may_dither() {
    for tenths in 1..=600 {
        let mut desk = Desk::new("");
        let prepared = desk.prepare(set(0, true)).unwrap();
        let now = desk.clock.now();
        // 4096 steps a turn: at 0.04/min a step takes 370 ms, about as long as from the plan to the read-back.
        desk.bus().encoder_mut(0).unwrap().set_rpm(now, -f64::from(tenths) / 10_000.0);
        let done = desk.commit(&prepared);
        let moved = matches!(done, Err(JobError::Device(Error::Moving { .. })));
        assert!(done.is_ok() || moved && tenths > 300, "{tenths}: {done:?}");
    }
}

#[test]
fn only_a_kit_is_synchronised() {
    let synchronise = |kit| Change::SetPosition { wanted: 0x40, exact: true, synchronise: true, kit };
    for kit in [false, true] {
        let error = Desk::new("").prepare(synchronise(kit)).unwrap_err();
        assert!(matches!(error, JobError::Device(Error::NotAKit { .. })), "{error:?}");
    }
    // Its extended label does not say that it is a kit: the user does.
    assert!(Desk::new("model=sel37").prepare(synchronise(false)).is_err());
    let mut desk = Desk::new("model=sel37");
    desk.change(synchronise(true)).unwrap();
    assert_eq!(desk.bus().encoders()[0].wear().writes(Command::Synchronise), 1);
    assert_eq!(desk.bus().encoders()[0].position(desk.clock.now()), 0x40);
}

/// The moment that comes with a position is the one at which the encoder sampled it.
#[test]
fn a_position_comes_with_its_moment() {
    for query in ["rpm=3000", "rpm=-1200&fault=delay:60", "rpm=500&fault=delay:33&echo=on", "rpm=3000&pace=worst"] {
        let mut desk = Desk::new(query);
        for _ in 0..50 {
            let reading = match desk.run(HiperfaceJob::Position(None)) {
                Ok(HiperfaceOutput::Position(reading)) => reading,
                // An encoder slower than the manual allows may be an error.
                Err(_) if query.contains("delay") => continue,
                other => panic!("{query}: {other:?}"),
            };
            let truth = desk.bus().encoders()[0].position(reading.at);
            assert!(reading.raw.abs_diff(truth) <= 1, "{query}: {} at {:?}, not {truth}", reading.raw, reading.at);
        }
    }
}
