//! After any failure of the host, its connections or its window during a motion, drives stop and stay stopped. The
//! drive runs in a separate process, and the test observes it over a second connection. The time limits are the safety
//! limits plus one second for a busy computer.

mod watched;
mod wires;

use std::process::Child;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use encoder_studio::devices::hiperdrive::jobs::{Hiperdrive, HiperdriveJob, HiperdriveOutput, Motion, open};
use encoder_studio::devices::hiperdrive::procedures::cyclic::ConnectionLoss;
use encoder_studio::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionRequest, SpeedTorque};
use encoder_studio::devices::hiperdrive::protocol::{ActualValues, Direction, DriveNumber, Percent, State};
use encoder_studio::store::Store;
use encoder_studio::worker::{Event, Session, Worker};

use super::support::{Bench, Simulated, ended, signal};
use wires::{Transport, Wires};

/// Additional time allowed for a busy computer.
const BUSY: Duration = Duration::from_secs(1);
/// Time without a report after which the user interface counts as frozen.
const UI_FREEZE_TIMEOUT: Duration = Duration::from_millis(300);
/// The requested packet interval in milliseconds. It is long enough for a busy computer.
const RPI: &str = "rpi=50";
/// Eight packet intervals plus the braking time.
const WATCHDOG: Duration = Duration::from_millis(500);
const FAST: SpeedTorque = SpeedTorque { speed: Percent::FULL, torque: Percent::FULL };
const JOG: MotionRequest = MotionRequest::Jog { direction: Direction::Clockwise, effort: FAST, outward: false };

/// A virtual drive, observed over a separate connection.
struct Drive {
    bench: Bench,
    simulated: Simulated,
    observer: Session<Hiperdrive>,
}

impl Drive {
    fn start() -> Self {
        let bench = Bench::new();
        let simulated = Simulated::start(&bench, &["hiperdrive", "--listen", "127.0.0.1:0"]);
        let url = format!("enip:{}", simulated.place).parse().unwrap();
        let observer = open(&url, Store::at_root(&bench.path("observer"))).unwrap();
        Drive { bench, simulated, observer }
    }

    fn actual(&mut self) -> ActualValues {
        match self.observer.run_inline(HiperdriveJob::Position(DriveNumber::FIRST)).unwrap() {
            HiperdriveOutput::Position(reading) => reading.actual,
            other => panic!("{other:?}"),
        }
    }

    fn moves(&mut self) -> bool {
        let actual = self.actual();
        actual.status.state() == State::Moving || actual.speed != 0
    }

    #[track_caller]
    fn begins(&mut self) {
        let until = Instant::now() + Duration::from_secs(10);
        while self.actual().speed == 0 {
            assert!(Instant::now() < until, "it does not move");
            sleep(Duration::from_millis(5));
        }
    }

    /// Checks that the drive stops within the limit and has not moved half a second later.
    #[track_caller]
    fn stops_within(&mut self, limit: Duration) {
        let until = Instant::now() + limit + BUSY;
        while self.moves() {
            assert!(Instant::now() < until, "it moves on: {:?}", self.actual());
            sleep(Duration::from_millis(5));
        }
        let stood = self.actual().position;
        sleep(Duration::from_millis(500));
        assert_eq!(self.actual().position, stood);
    }
}

/// A host in this process that controls the drive.
struct Host {
    worker: Worker<Hiperdrive>,
    motion: Motion,
}

impl Host {
    fn in_control(bench: &Bench, place: &str) -> Self {
        let url = format!("enip:{place}?{RPI}").parse().unwrap();
        let session = open(&url, Store::at_root(&bench.path("host"))).unwrap();
        let motion = session.motion();
        let mut host = Host { worker: Worker::spawn(session, Arc::new(|| ())).unwrap(), motion };
        host.run(HiperdriveJob::Take);
        host
    }

    fn run(&mut self, job: HiperdriveJob) {
        let id = self.worker.submit(job).unwrap();
        loop {
            match self.worker.events().recv_timeout(Duration::from_secs(20)).unwrap() {
                Event::Finished(of, _) if of == id => return,
                Event::Failed(of, error) if of == id => panic!("{error}"),
                _ => {}
            }
        }
    }

    /// Holds the jog button for the given time.
    fn holds(&self, time: Duration) {
        let until = Instant::now() + time;
        while Instant::now() < until {
            self.motion.refresh();
            sleep(Duration::from_millis(20));
        }
    }

    /// Holds the jog button at full speed until the drive moves.
    fn jogs(&self, drive: &mut Drive) {
        let until = Instant::now() + Duration::from_secs(20);
        let mut act = 0;
        while drive.actual().speed <= 100 {
            assert!(Instant::now() < until, "it does not move: {:?}", self.motion);
            // A busy computer may have delayed the refreshes, so that the jog has already ended.
            let over = self.motion.snapshot().drives[0].ended.is_some_and(|(number, _)| number >= act);
            if act == 0 || over {
                act = self.motion.request_motion(DriveNumber::FIRST, JOG);
            }
            self.motion.refresh();
            sleep(Duration::from_millis(5));
        }
        self.motion.refresh();
    }

    fn ended(&self) -> Option<ActionEnd> {
        self.motion.snapshot().drives[0].ended.map(|(_, ended)| ended)
    }
}

#[test]
fn frozen_window_stops_drive() {
    let mut drive = Drive::start();
    let host = Host::in_control(&drive.bench, &drive.simulated.place.clone());
    host.jogs(&mut drive);
    // No further reports are sent.
    drive.stops_within(UI_FREEZE_TIMEOUT + WATCHDOG);
    assert_eq!(host.ended(), Some(ActionEnd::Stale));
    // When the window responds again and the button is still pressed, the drive does not move.
    let stood = drive.actual().position;
    host.holds(Duration::from_millis(500));
    assert_eq!(drive.actual().position, stood);
    assert!(host.motion.is_open());
    host.jogs(&mut drive);
    host.motion.stop();
    drive.stops_within(WATCHDOG);
    assert_eq!(host.ended(), Some(ActionEnd::Stopped));
}

/// Closing the window drops the session, which must stop the drive.
#[test]
fn closed_session_stops_drive() {
    let mut drive = Drive::start();
    let host = Host::in_control(&drive.bench, &drive.simulated.place.clone());
    host.jogs(&mut drive);
    assert!(host.worker.close(Duration::from_secs(5)));
    drive.stops_within(Duration::ZERO);
    assert_eq!(drive.actual().status.to_u16() & 0x000F, 0, "off, and no fault: it was told");
    // The drive is released, so the next host may control it.
    let next = Host::in_control(&drive.bench, &drive.simulated.place.clone());
    assert!(next.motion.is_open());
}

#[test]
fn cut_parameter_connection_stops_drive() {
    let mut drive = Drive::start();
    let wires = Wires::to(&drive.simulated.place);
    let host = Host::in_control(&drive.bench, &wires.place());
    host.jogs(&mut drive);
    wires.cut_stream();
    // An idle session checks its state every half second.
    let holding = host.motion.clone();
    let held = std::thread::spawn(move || {
        for _ in 0..100 {
            holding.refresh();
            sleep(Duration::from_millis(20));
        }
    });
    drive.stops_within(Duration::from_millis(500) + WATCHDOG);
    held.join().unwrap();
    assert_eq!(host.motion.snapshot().lost, Some(ConnectionLoss::Session));
}

#[test]
fn cut_packet_wires_stop_drive() {
    for (ways, told) in [
        (&[Transport::ToTarget, Transport::ToHost][..], false),
        (&[Transport::ToTarget], false),
        (&[Transport::ToHost], true),
    ] {
        let mut drive = Drive::start();
        let wires = Wires::to(&drive.simulated.place);
        let host = Host::in_control(&drive.bench, &wires.place());
        host.jogs(&mut drive);
        ways.iter().for_each(|way| wires.cut(*way));
        drive.stops_within(WATCHDOG);
        // If only the return direction is cut, the drive receives the stop. Otherwise, its watchdog stops it, which is
        // a fault.
        let faulty = drive.actual().status.state() == State::Fault;
        assert_eq!(faulty, !told, "{ways:?}");
        let until = Instant::now() + Duration::from_secs(5);
        while host.motion.is_open() {
            assert!(Instant::now() < until, "{ways:?}: the loss is not noticed");
            sleep(Duration::from_millis(10));
        }
        assert!(matches!(host.motion.snapshot().lost, Some(ConnectionLoss::Silent { .. })), "{ways:?}");
        // After the connection is restored, the drive remains stopped even if the button is held.
        ways.iter().for_each(|way| wires.restore(*way));
        let stood = drive.actual().position;
        host.motion.request_motion(DriveNumber::FIRST, JOG);
        host.holds(Duration::from_millis(500));
        assert_eq!(drive.actual().position, stood);
    }
}

/// While random bytes arrive in both directions at full speed, releasing the button still stops the drive.
#[test]
fn release_stops_drive_during_flood() {
    let mut drive = Drive::start();
    let wires = Wires::to(&drive.simulated.place);
    let host = Host::in_control(&drive.bench, &wires.place());
    host.jogs(&mut drive);
    let flood = wires.flood();
    host.holds(Duration::from_millis(300));
    host.motion.stop();
    drive.stops_within(WATCHDOG + UI_FREEZE_TIMEOUT);
    assert!(flood.end() > 1000);
    let figures = host.motion.snapshot().link;
    assert!(figures.malformed > 0, "{figures:?}");
}

/// Starts the `move` command in a separate process.
fn moving(drive: &mut Drive) -> Child {
    let link = format!("enip:{}?{RPI}", drive.simulated.place);
    let arguments = ["move", "hiperdrive", "30000000", "--yes", "--link", &link];
    let child = drive.bench.program(&arguments).spawn().unwrap();
    drive.begins();
    child
}

#[test]
fn killed_process_stops_drive() {
    let mut drive = Drive::start();
    let mut child = moving(&mut drive);
    signal(&child, "KILL");
    drive.stops_within(WATCHDOG);
    child.wait().unwrap();
    assert_eq!(drive.actual().status.state(), State::Fault, "its watchdog has stopped it");
}

#[test]
fn frozen_process_stops_drive() {
    let mut drive = Drive::start();
    let child = moving(&mut drive);
    signal(&child, "STOP");
    drive.stops_within(WATCHDOG);
    let stood = drive.actual().position;
    signal(&child, "CONT");
    let ran = ended(child, Instant::now());
    assert_eq!((ran.status, drive.actual().position), (Some(1), stood), "{ran:?}");
}

#[test]
fn interrupt_stops_drive() {
    let mut drive = Drive::start();
    let child = moving(&mut drive);
    signal(&child, "INT");
    drive.stops_within(WATCHDOG);
    let ran = ended(child, Instant::now());
    let position = drive.actual().position.to_string();
    ran.fails(1, &["stopped", &position]);
    assert_eq!(drive.actual().status.to_u16() & 0x000F, 0, "off, and no fault");
}

/// After any signal that ends a command, even if sent twice, the drive is stopped and off, and its watchdog reports no
/// fault (issue 21.1).
#[test]
fn terminating_signals_stop_drive() {
    for (name, times) in [("TERM", 1), ("HUP", 1), ("TERM", 2), ("INT", 2)] {
        let mut drive = Drive::start();
        let child = moving(&mut drive);
        for _ in 0..times {
            signal(&child, name);
            sleep(Duration::from_millis(30));
        }
        drive.stops_within(WATCHDOG);
        let ran = ended(child, Instant::now());
        assert!(ran.status.is_some_and(|status| status != 0), "{name}: {ran:?}");
        assert_eq!(drive.actual().status.to_u16() & 0x000F, 0, "{name}, {times} times: off, and no fault");
    }
}
