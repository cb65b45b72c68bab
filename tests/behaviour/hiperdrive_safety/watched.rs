//! Drives of a hub that disobey the commands of the cyclic connection: they ignore their limits, a target or a pause,
//! or turn the wrong way. The hub is simulated in Python and records the commands. Its other drive must never be moved.

use std::fs;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use encoder_studio::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionRequest, Phase};
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, State};

use super::super::support::{Bench, Foreign};
use super::{FAST, Host, JOG};

/// Steps per turn.
const TURN: i32 = 65_536;
/// Steps per degree, rounded up.
const DEGREE: i32 = 183;
/// Maximum number of packets already sent when the first report shows the defect.
const PACKETS_IN_FLIGHT: usize = 2;

fn third() -> DriveNumber {
    DriveNumber::new(3).unwrap()
}

/// A packet for a drive, as received by the hub.
#[derive(Debug)]
struct Packet {
    position: i32,
    moves: bool,
    drive: u8,
}

/// A hub whose third drive has a defect, and the host that moves it.
struct Hub {
    host: Host,
    foreign: Foreign,
    record: PathBuf,
}

impl Hub {
    fn with(bench: &Bench, commands: &[&str]) -> Option<Self> {
        let mut foreign = bench.moving_target(&["--topology=hub4", "--drives=1,3"])?;
        for command in [&["drive 3"], commands].concat() {
            foreign.command(command);
        }
        let host = Host::in_control(bench, &foreign.place);
        Some(Hub { host, foreign, record: bench.path("record") })
    }

    fn phase(&self) -> Phase {
        self.host.motion.snapshot().drives.iter().find(|own| own.number == third()).unwrap().phase
    }

    /// Waits for an action to end and returns the outcome.
    #[track_caller]
    fn until_over(&self, act: u64) -> ActionEnd {
        let until = Instant::now() + Duration::from_secs(20);
        loop {
            self.host.motion.refresh();
            let view = self.host.motion.snapshot();
            match view.drives.iter().find(|own| own.number == third()).unwrap().ended {
                Some((number, ended)) if number >= act => return ended,
                _ => assert!(Instant::now() < until, "it never ends: {view:?}"),
            }
            sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the drive is at standstill. Returns its recorded packets and the number of those received before the
    /// defect was first reported.
    fn record(&mut self) -> (Vec<Packet>, usize) {
        let until = Instant::now() + Duration::from_secs(20);
        while self.host.motion.snapshot().drives.iter().any(|own| own.actual.status.state() == State::Moving) {
            assert!(Instant::now() < until, "it never stands");
            sleep(Duration::from_millis(5));
        }
        let text = fs::read_to_string(&self.record).unwrap();
        self.foreign.kill();
        let (mut packets, mut told) = (Vec::new(), None);
        for line in text.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            match words[..] {
                ["P", _, _, _, _, position, moves, drive] => packets.push(Packet {
                    position: position.parse().unwrap(),
                    moves: moves == "1",
                    drive: drive.parse().unwrap(),
                }),
                ["E", _, "BEYOND" | "PAST" | "WRONG"] => told = told.or(Some(packets.len())),
                _ => {}
            }
        }
        assert!(packets.iter().all(|packet| packet.drive == 3 || !packet.moves), "the drive beside it was commanded");
        packets.retain(|packet| packet.drive == 3);
        // The record has one line per packet for each of the two drives.
        (packets, told.expect("it did what it was told") / 2)
    }
}

fn moving(packets: &[Packet]) -> Vec<&Packet> {
    packets.iter().filter(|packet| packet.moves).collect()
}

/// The drive receives no motion command after the report that shows the defect (issue 21.4).
#[test]
fn stops_hub_drive_ignoring_limits() {
    let bench = Bench::new();
    let Some(mut hub) = Hub::with(&bench, &["limits -65536 65536", "unlimited on"]) else { return };
    let act = hub.host.motion.request_motion(third(), JOG);
    let ended = hub.until_over(act);
    assert!(
        matches!(ended, ActionEnd::Beyond { position } if position > TURN) || ended == ActionEnd::RangeEnd,
        "{ended:?}"
    );
    let (packets, told) = hub.record();
    assert!(!moving(&packets[..told]).is_empty(), "it was moved");
    let after = moving(&packets[told..]);
    assert!(after.len() <= PACKETS_IN_FLIGHT, "{after:?}");
}

#[test]
fn stops_hub_drive_turning_wrong_way() {
    for wish in [JOG, MotionRequest::Move { target: 3 * TURN, effort: FAST }] {
        let bench = Bench::new();
        let Some(mut hub) = Hub::with(&bench, &["reverse on"]) else { return };
        let act = hub.host.motion.request_motion(third(), wish);
        let ended = hub.until_over(act);
        assert!(matches!(ended, ActionEnd::WrongWay { position } if position < -DEGREE), "{wish:?}: {ended:?}");
        let (packets, _) = hub.record();
        let wrong: Vec<&Packet> = moving(&packets).into_iter().filter(|own| own.position < -DEGREE).collect();
        assert!(wrong.len() <= PACKETS_IN_FLIGHT + 1, "{wish:?}: {wrong:?}");
    }
}

#[test]
fn stops_hub_drive_passing_target() {
    let bench = Bench::new();
    let Some(mut hub) = Hub::with(&bench, &["overrun on"]) else { return };
    let act = hub.host.motion.request_motion(third(), MotionRequest::Move { target: TURN, effort: FAST });
    let ended = hub.until_over(act);
    assert!(matches!(ended, ActionEnd::WrongWay { position } if position > TURN), "{ended:?}");
    let (packets, _) = hub.record();
    // The drive's accuracy is ±2.5°, so it may pass its target by three whole degrees.
    let past: Vec<&Packet> = moving(&packets).into_iter().filter(|own| own.position > TURN + 3 * DEGREE).collect();
    assert!(past.len() <= PACKETS_IN_FLIGHT + 1, "{past:?}");
}

/// The drive is stopped when it has moved for longer than it needs to brake (issue 21.4).
#[test]
fn stops_hub_drive_ignoring_pause() {
    let bench = Bench::new();
    let Some(mut hub) = Hub::with(&bench, &["pauseless on"]) else { return };
    hub.host.motion.request_motion(third(), MotionRequest::Move { target: 20 * TURN, effort: FAST });
    let until = Instant::now() + Duration::from_secs(20);
    while !matches!(hub.phase(), Phase::Moving(_)) {
        assert!(Instant::now() < until, "it does not move: {:?}", hub.phase());
        hub.host.motion.refresh();
        sleep(Duration::from_millis(5));
    }
    let act = hub.host.motion.request_motion(third(), MotionRequest::Pause);
    let ended = hub.until_over(act - 1);
    assert_eq!(ended, ActionEnd::Left(State::Moving));
    hub.host.holds(Duration::from_millis(500));
    let text = fs::read_to_string(&hub.record).unwrap();
    hub.foreign.kill();
    let last = text.lines().rev().find(|line| line.starts_with("P ") && line.ends_with(" 3")).unwrap();
    let words: Vec<&str> = last.split(' ').collect();
    // Bit 4 is 0, which means stop.
    assert_eq!(u16::from_str_radix(words[3], 16).unwrap() & 0x0010, 0, "{last}");
    assert!(text.contains(" STAND"), "{last}");
}
