//! Tests that the motion rules of a controlled drive are read repeatedly, whatever is polled and displayed. If they
//! cannot be read, nothing moves.

use crate::hiperdrive::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::LinkOpener;
use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use encoder_studio::app::{Action, Severity, Studio, StudioEnvironment};
use encoder_studio::devices::hiperdrive::jobs::DeviceConnection;
use encoder_studio::devices::hiperdrive::procedures::Station;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, ErrorCode, State, Value};
use encoder_studio::devices::hiperdrive::sim::{Config, Target};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};
use encoder_studio::link::{ByteLink, Clock, LinkError, RealClock, SimLink, SimPort};
use encoder_studio::units::{CharacterFormat, Moment};
use encoder_studio::worker::Session;

use crate::hiperdrive::{ONE, act, drive, number, unit, until_read};
use crate::hiperdrive_acts::{drive_until, start_long_move};
use crate::hiperdrive_motion::in_control;
use crate::screen::Screen;
use crate::support::{Desk, LONG, Outside};

fn two() -> DriveNumber {
    DriveNumber::new(2).unwrap()
}

/// Writes a value as another master would.
fn set(desk: &Desk, of: u16, value: i64) {
    let target = unit(desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), number(of), &Value::Number(value)).unwrap());
}

#[test]
fn reads_limits_at_any_polling_rate() {
    for pace in [None, Some(Duration::from_secs(3600))] {
        let mut desk = in_control("sim:");
        command(&mut desk, DeviceCommand::Poll(pace));
        desk.settle();
        set(&desk, 160, 65_536);
        let began = Instant::now();
        desk.until("they are read", |studio| {
            let own = studio.hiperdrive().unwrap();
            own.limits(ONE) == Some((-33_488_896, 65_536)) && own.may_move(ONE).is_ok()
        });
        assert!(began.elapsed() < Duration::from_secs(6), "{pace:?}: {:?}", began.elapsed());
        assert_eq!(unit(&desk).session.live_session().unwrap().polling_interval(), pace);
        // The rules also stay known afterwards.
        let began = Instant::now();
        desk.until("some time passes", |studio| {
            studio.hiperdrive().unwrap().may_move(ONE).unwrap();
            began.elapsed() > Duration::from_secs(5)
        });
    }
}

#[test]
fn selected_drive_needs_fresh_limits() {
    let mut desk = in_control("sim:?hub=4&drives=1,1&requested=1");
    assert!(unit(&desk).may_move(two()).is_ok());
    set(&desk, 260, 65_536);
    act(&mut desk, Hiperdrive::SelectDrive(two()));
    drive(&mut desk, MotorCommand::Move { target: 65_537 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.old"]);
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(two()).is_ok());
    assert_eq!(unit(&desk).limits(two()), Some((-33_488_896, 65_536)), "by what it has now");
    drive(&mut desk, MotorCommand::Move { target: 65_537 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.old", "hd_refused.outside"]);
    let to_64 = |own: &HiperdriveDevice| MotorCommand::Step { by: 64 - own.actual_values(two()).unwrap().position };
    drive_until(&mut desk, to_64, "it moves", |studio| {
        studio.hiperdrive().unwrap().actual_values(two()).is_some_and(|own| own.position == 64)
    });
}

/// A connection that damages every reply while the flag is set. Cyclic packets are unchanged.
struct CorruptingLink(Box<dyn ByteLink>, Arc<AtomicBool>);

impl ByteLink for CorruptingLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.0.send(bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let before = into.len();
        self.0.receive(until, into)?;
        // The service of the reply follows the headers of the frame and of its items.
        if let Some(service) = into.get_mut(before + 40).filter(|_| self.1.load(Ordering::SeqCst)) {
            *service ^= 0x55;
        }
        Ok(())
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.0.set_format(format)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.0.check_connection()
    }
}

fn desk_with_corrupting_link() -> (Desk, Arc<AtomicBool>) {
    let bad = Arc::new(AtomicBool::default());
    let outside = Outside::new("");
    let is_bad = bad.clone();
    let world = StudioEnvironment {
        given: outside.world().given.with_value(LinkOpener::new(move |url, store| {
            let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
            let target = Target::new(&Config::from_pairs(&[]).unwrap());
            let connection = Arc::new(Mutex::new(target.connect_from(Ipv4Addr::UNSPECIFIED)));
            let stream = Box::new(SimLink::connect(connection, clock.clone()));
            let wire = Box::new(CorruptingLink(stream, is_bad.clone()));
            let port = Box::new(SimPort::new(Arc::new(Mutex::new(target.clone())), clock.clone()));
            let station = Station::from_query(&url.query, None, Duration::from_millis(20))?;
            let way = DeviceConnection { wire, port: Some(port), station, target: Some(target) };
            Ok(Session::for_target(way, clock, store))
        })),
        ..outside.world()
    };
    let mut desk = Desk { studio: Studio::new(world, Arc::new(|| {})), outside };
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open("sim:");
    until_read(&mut desk);
    act(&mut desk, Hiperdrive::Take);
    desk.until("it is in hand", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    (desk, bad)
}

#[test]
fn unreadable_limits_stop_motion() {
    let (mut desk, bad) = desk_with_corrupting_link();
    start_long_move(&mut desk);
    bad.store(true, Ordering::SeqCst);
    desk.until("it stands", |studio| !studio.is_moving());
    desk.until("that is told", |studio| {
        studio.services.log.current().is_some_and(|own| own.texts.iter().any(|text| text.id() == "hd_end.rules"))
    });
    assert!(unit(&desk).moves.is_open() && unit(&desk).session.is_polling(), "it is seen all the same");
    drive(&mut desk, MotorCommand::Step { by: 64 });
    assert_eq!(desk.notice_ids(Severity::Warning).last(), Some(&"hd_lock.old"));
    let began = Instant::now();
    desk.until("some time passes", |studio| {
        assert!(studio.hiperdrive().unwrap().may_move(ONE).is_err());
        began.elapsed() > Duration::from_secs(2)
    });
    assert_eq!(desk.notice_count("hd_end.rules"), 1);
    bad.store(false, Ordering::SeqCst);
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    desk.until("what was told is over", |studio| {
        studio.services.log.current().is_none_or(|own| own.texts.iter().all(|text| text.id() != "hd_end.rules"))
    });
    assert!(unit(&desk).moves.is_open() && began.elapsed() < LONG);
}

fn has_rules_notice(studio: &Studio) -> bool {
    studio.services.log.current().is_some_and(|own| own.texts.iter().any(|text| text.id() == "hd_end.rules"))
}

#[test]
fn releasing_control_clears_unreadable_limits_notice() {
    let (mut desk, bad) = desk_with_corrupting_link();
    bad.store(true, Ordering::SeqCst);
    desk.until("that is told", has_rules_notice);
    // The connection works again before the next reading.
    bad.store(false, Ordering::SeqCst);
    act(&mut desk, Hiperdrive::Give);
    desk.until("it is given back", |studio| {
        let own = studio.hiperdrive().unwrap();
        !own.moves.is_open() && own.session.is_ready()
    });
    assert!(!has_rules_notice(&desk.studio));
}

fn fail(desk: &Desk, own: DriveNumber) {
    let target = unit(desk).target.clone().unwrap();
    target
        .with_station(|station| station.drive(own).unwrap().inject_error(Moment::default(), ErrorCode::BLOCK_FORWARD));
}

fn has_fault_notice(studio: &Studio) -> bool {
    studio.services.log.current().is_some_and(|own| own.texts.iter().any(|text| text.id() == "hd_end.fault"))
}

/// Drive 1 failed while it moved, and drive 2 failed earlier. The notice about drive 1 must stay when drive 2 recovers.
#[test]
fn recovery_clears_only_own_fault_notice() {
    let mut desk = in_control("sim:?hub=4&drives=1,1&requested=1");
    act(&mut desk, Hiperdrive::SelectDrive(two()));
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(two()).is_ok());
    start_long_move(&mut desk);
    fail(&desk, two());
    desk.until("its fault is told", has_fault_notice);
    act(&mut desk, Hiperdrive::SelectDrive(ONE));
    desk.until("the other may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    start_long_move(&mut desk);
    fail(&desk, ONE);
    desk.until("both have failed", |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Fault));
    desk.until("that is told", |studio| has_fault_notice(studio) && studio.hiperdrive().unwrap().session.is_ready());
    assert_eq!(desk.notice_count("hd_end.fault"), 2);
    act(&mut desk, Hiperdrive::SelectDrive(two()));
    drive_until(
        &mut desk,
        |_| MotorCommand::Acknowledge,
        "it has recovered",
        |studio| studio.hiperdrive().unwrap().state(two()) == Some(State::Ready),
    );
    desk.settle();
    assert!(has_fault_notice(&desk.studio), "the other has not");
    act(&mut desk, Hiperdrive::SelectDrive(ONE));
    drive_until(&mut desk, |_| MotorCommand::Acknowledge, "all have recovered", |studio| !has_fault_notice(studio));
}

/// A reading of all states that began before the fault must not end the notice of the fault.
#[test]
fn outdated_reading_does_not_clear_fault_notice() {
    let mut desk = in_control("sim:?hub=4&drives=1,1,1,1&requested=1");
    for _ in 0..3 {
        start_long_move(&mut desk);
        act(&mut desk, Hiperdrive::ReadStatus);
        // The first drive has been read by now.
        std::thread::sleep(Duration::from_millis(40));
        fail(&desk, ONE);
        desk.until("it has failed", |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Fault));
        desk.until("everything is read", |studio| studio.hiperdrive().unwrap().session.is_ready());
        desk.settle();
        assert!(has_fault_notice(&desk.studio));
        drive_until(
            &mut desk,
            |_| MotorCommand::Acknowledge,
            "it has recovered",
            |studio| !has_fault_notice(studio) && studio.hiperdrive().unwrap().may_move(ONE).is_ok(),
        );
    }
}

/// Even if a drive is locked for two reasons, its limits are confirmed in only one place.
#[test]
fn confirms_limits_in_one_place() {
    let mut screen = Screen::open_in_tab(crate::tabs::HIPERDRIVE, "sim:", [1280.0, 900.0]);
    let is_ready = |studio: &Studio, open: bool| {
        let own = studio.hiperdrive();
        own.is_some_and(|own| own.survey.is_some() && own.session.is_ready() && own.moves.is_open() == open)
    };
    screen.until("it is read", |studio| is_ready(studio, false));
    let id = screen.studio().hiperdrive().unwrap().session.id;
    let target = screen.studio().hiperdrive().unwrap().target.clone().unwrap();
    for (of, value) in [(154, 400), (156, 256), (186, 255)] {
        target.with_station(|station| station.write(Moment::default(), number(of), &Value::Number(value)).unwrap());
    }
    screen.act(Action::device(id, Hiperdrive::Take));
    screen.until("it is locked", |studio| {
        is_ready(studio, true) && studio.hiperdrive().unwrap().moves.motion_locks(ONE).len() == 2
    });
    let confirm = screen.say("hd_limits.confirm");
    assert_eq!(screen.harness.query_all_by_label(&confirm).count(), 1);
}
