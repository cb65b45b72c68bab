//! Tests of the cyclic connection with packets from the reference (section 9) and with arbitrary packets.

use std::time::Duration;

use proptest::prelude::*;

use super::{Connection, ConnectionLoss, Drives};
use crate::buses::ethernet_ip::protocol::{ConnectionOwner, EPath, ForwardClose, RequestTimeout};
use crate::devices::hiperdrive::procedures::OpenedConnection;
use crate::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, MotionIntent, MotionRequest, Permit, SpeedTorque, TargetState,
};
use crate::devices::hiperdrive::protocol::{
    ByteOrder, Direction, DriveNumber, Layout, OutputData, OutputImage, Topology,
};
use crate::units::Moment;

fn at(ms: u64) -> Moment {
    Moment::START + Duration::from_millis(ms)
}

/// Returns the connection from the reference (section 9): ID 00020001 and an interval of 10 ms in both directions.
fn opened(topology: Topology, pkw: bool, order: ByteOrder) -> OpenedConnection {
    let owner = ConnectionOwner { connection_serial: 1, vendor: 0x1234, serial_number: 0xABCD };
    let close =
        ForwardClose { timeout: RequestTimeout::TWO_SECOND_TIMEOUT, owner, path: EPath::to_assemblies(104, 100, 101) };
    let interval = Duration::from_millis(10);
    OpenedConnection {
        to_target_id: 0x0002_0001,
        to_originator_id: 0x0002_0001,
        to_target_interval: interval,
        to_originator_interval: interval,
        timeout: interval * 8,
        layout: Layout { topology, pkw, order },
        port: 2222,
        group: None,
        close,
    }
}

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

const TO_TARGET: &str = "02 00 02 80 08 00 01 00 02 00 01 00 00 00 B1 00 16 00 01 00 01 00 00 00 39 04 64 64 00 80 02 00 \
                         00 00 00 00 00 00 00 00";
const TO_ORIGINATOR: &str = "02 00 02 80 08 00 01 00 02 00 01 00 00 00 B1 00 12 00 01 00 37 2A 00 00 00 80 02 00 \
                             00 00 00 00 00 00 00 00";

/// Returns a packet with a report of the first drive and the given sequence number.
fn report(sequence: u32, status: u16, position: i32) -> Vec<u8> {
    let mut bytes = hex(TO_ORIGINATOR);
    bytes[10..14].copy_from_slice(&sequence.to_le_bytes());
    bytes[20..22].copy_from_slice(&status.to_le_bytes());
    bytes[24..28].copy_from_slice(&position.to_le_bytes());
    bytes
}

#[test]
fn packets_match_reference() {
    let mut connection = Connection::new(&opened(Topology::Adapter, true, ByteOrder::Little), at(0));
    let out = OutputData { control: 0x0439, speed: 100, torque: 100, target: 163_840 };
    let image = OutputImage { drives: vec![out], pkw: None };
    assert_eq!(connection.next_packet(at(0), &image), hex(TO_TARGET));
    let came = connection.on_packet(at(4), &hex(TO_ORIGINATOR)).unwrap();
    assert_eq!((came.drives[0].status.to_u16(), came.drives[0].position), (0x2A37, 163_840));
    // In the next packet, both counts are one higher.
    let second = connection.next_packet(at(10), &image);
    assert_eq!((second[10], second[18]), (2, 2));
    // A target may send a header before its data.
    let mut with = hex(TO_ORIGINATOR);
    with.splice(20..20, [1, 0, 0, 0]);
    (with[10], with[16]) = (2, 0x16);
    assert_eq!(connection.on_packet(at(14), &with).unwrap().drives[0].position, 163_840);
    assert_eq!((connection.statistics().sent, connection.statistics().received), (2, 2));
}

/// Process data have 8 bytes per drive, followed by 8 bytes of parameter words if the connection includes them
/// (reference, section 2). A packet contains 14 to 78 bytes of data.
#[test]
fn connection_determines_image_layout() {
    for (topology, pkw, data) in [
        (Topology::Adapter, false, 8),
        (Topology::Adapter, true, 16),
        (Topology::Hub4, false, 32),
        (Topology::Hub4, true, 40),
        (Topology::Hub8, false, 64),
        (Topology::Hub8, true, 72),
    ] {
        for (order, word) in [(ByteOrder::Little, [0x01, 0x04]), (ByteOrder::Big, [0x04, 0x01])] {
            let mut connection = Connection::new(&opened(topology, pkw, order), at(0));
            let mut drives = vec![OutputData::default(); topology.drives().into()];
            drives.last_mut().unwrap().control = 0x0401;
            let packet = connection.next_packet(at(0), &OutputImage { drives, pkw: None });
            // The overhead is 14 bytes of addresses, 4 bytes for the item, and 6 bytes for count and header.
            assert_eq!(packet.len(), 24 + data, "{topology:?} {pkw}");
            let place = 24 + 8 * (usize::from(topology.drives()) - 1);
            assert_eq!(packet[place..place + 2], word, "{topology:?} {pkw} {order:?}");
        }
    }
}

/// Each deadline is one interval after the previous one, regardless of delays. After a long delay, only one packet is
/// sent instead of all those missed.
#[test]
fn deadlines_do_not_drift() {
    let mut connection = Connection::new(&opened(Topology::Adapter, true, ByteOrder::Little), at(5));
    let image = OutputImage { drives: vec![OutputData::default()], pkw: None };
    let mut due = Vec::new();
    for late in [0, 3, 9, 0, 25, 0] {
        let now = connection.poll_at() + Duration::from_millis(late);
        connection.next_packet(now, &image);
        due.push(connection.poll_at().duration_since(Moment::START).as_millis());
    }
    assert_eq!(due, [15, 25, 35, 45, 80, 90]);
}

fn permit(_: DriveNumber) -> Permit {
    Permit::for_range(-1_000_000, 1_000_000)
}

/// An adapter whose drive obeys each command immediately.
struct Bench {
    drives: Drives,
    intent: MotionIntent,
    ms: u64,
    sequence: u32,
    status: u16,
    answers: bool,
}

impl Bench {
    fn new() -> Self {
        let drives = Drives::new(&opened(Topology::Adapter, true, ByteOrder::Little), &[DriveNumber::FIRST], 0, at(0));
        let intent = MotionIntent::idle(DriveNumber::FIRST, 0, at(0));
        Bench { drives, intent, ms: 0, sequence: 0, status: 0x2A30, answers: true }
    }

    fn act(&mut self, wish: MotionRequest) {
        self.intent = MotionIntent { request: wish, number: self.intent.number + 1, ..self.intent };
    }

    /// Runs one interval and returns the control word that was sent, if any.
    fn cycle(&mut self) -> Option<u16> {
        if self.answers {
            self.sequence += 1;
            let report = report(self.sequence, self.status, 0);
            assert!(self.drives.on_packet(at(self.ms), &report) || self.drives.is_finished());
        }
        self.intent.refreshed = at(self.ms);
        let packet = self.drives.poll(at(self.ms), &self.intent, permit);
        self.ms += 10;
        let word = packet.map(|packet| u16::from_le_bytes([packet[24], packet[25]]));
        if let Some(word) = word {
            let ready = [(0x0400, 1), (0x0001, 2), (0x0008, 4)]
                .into_iter()
                .map_while(|(bit, set)| (word & bit != 0).then_some(set));
            let moves = word & 0x1048 == 0x1048;
            self.status = 0x0A30 | ready.sum::<u16>() | if moves { 0x1000 } else { 0x2000 };
        }
        word
    }

    fn cycles(&mut self, count: usize) -> Vec<String> {
        let words = (0..count).filter_map(|_| self.cycle());
        let mut words: Vec<String> = words.map(|word| format!("{word:04X}")).collect();
        words.dedup();
        words
    }

    fn jogs() -> Self {
        let mut bench = Bench::new();
        bench.act(MotionRequest::Jog {
            direction: Direction::Clockwise,
            effort: SpeedTorque::DEFAULT_JOG,
            outward: false,
        });
        assert_eq!(bench.cycles(40).join(" "), "0400 0401 0409 1419 1459");
        bench
    }
}

/// Three intervals without a packet are a loss (reference, issue and manual). The stop word is still sent, since only
/// the return path may be interrupted. Afterwards, the drives are switched off, and nothing more is sent.
#[test]
fn lost_connection_stops_and_stays_lost() {
    let mut bench = Bench::jogs();
    bench.answers = false;
    assert_eq!(bench.cycles(3).join(" "), "1459");
    assert!(bench.drives.connection_loss().is_none());
    assert_eq!(bench.cycles(1).join(" "), "1419");
    assert_eq!(bench.drives.connection_loss(), Some(&ConnectionLoss::Silent { after: Duration::from_millis(40) }));
    assert_eq!(bench.drives.dead_man_switches().next().unwrap().last_end(), Some((1, ActionEnd::Lost)));
    bench.act(MotionRequest::Lead(TargetState::Enabled));
    assert_eq!(bench.cycles(100).join(" "), "1419 0401 0000");
    assert!(bench.drives.is_finished());
    bench.answers = true;
    bench.act(MotionRequest::Jog { direction: Direction::Clockwise, effort: SpeedTorque::DEFAULT_JOG, outward: false });
    assert_eq!(bench.cycles(100), Vec::<String>::new());
}

/// A computer that was busy for 70 ms may still have packets in its queue, so the connection is not lost yet. Once the
/// target's time-out (80 ms in this test) has passed, the drives have stopped by themselves.
#[test]
fn delayed_thread_reads_pending_packets_first() {
    for (away, lost) in [(70, false), (100, true)] {
        let mut bench = Bench::jogs();
        // When the thread wakes up, the packets received in the meantime are queued.
        bench.answers = false;
        bench.ms += away;
        assert_eq!(bench.cycles(1).join(" "), "1419", "the first word that leaves again");
        bench.answers = true;
        bench.cycles(3);
        assert_eq!(bench.drives.connection_loss().is_some(), lost, "{away} ms");
        // Without a known position, no motion continues.
        let how = if lost { ActionEnd::Lost } else { ActionEnd::Deaf };
        assert_eq!(bench.drives.dead_man_switches().next().unwrap().last_end(), Some((1, how)), "{away} ms");
    }
    // No packets arrive after the pause either.
    let mut bench = Bench::jogs();
    bench.answers = false;
    bench.ms += 40;
    bench.cycles(3);
    assert!(bench.drives.connection_loss().is_none(), "listened for 20 ms");
    bench.cycles(2);
    assert!(bench.drives.connection_loss().is_some(), "listened for 40 ms");
}

/// At rest, a lack of packets is tolerated until the target's own time-out of 80 ms (issue 21.13).
#[test]
fn tolerates_silence_at_rest_until_timeout() {
    let mut bench = Bench::new();
    bench.act(MotionRequest::Lead(TargetState::Enabled));
    bench.cycles(20);
    for missing in [3, 5, 7] {
        bench.answers = false;
        bench.cycles(missing);
        assert!(bench.drives.connection_loss().is_none(), "{missing} missing");
        bench.answers = true;
        bench.cycles(3);
    }
    // No motion starts in the meantime.
    bench.answers = false;
    bench.cycles(4);
    bench.act(MotionRequest::Jog { direction: Direction::Clockwise, effort: SpeedTorque::DEFAULT_JOG, outward: false });
    assert_eq!(bench.cycles(3).join(" "), "0409");
    assert_eq!(bench.drives.dead_man_switches().next().unwrap().last_end(), Some((2, ActionEnd::Deaf)));
    bench.cycles(2);
    assert_eq!(bench.drives.connection_loss(), Some(&ConnectionLoss::Silent { after: Duration::from_millis(90) }));
}

/// Closing the connection sends stop words until standstill, then three packets that switch the drives off.
#[test]
fn closing_connection_stops_and_switches_off() {
    let mut bench = Bench::jogs();
    bench.drives.close(at(bench.ms));
    let begun = bench.ms;
    let words: Vec<u16> = std::iter::from_fn(|| bench.cycle()).collect();
    assert_eq!(words.first(), Some(&0x1419));
    assert_eq!(words.iter().filter(|word| **word == 0).count(), 3);
    assert!(bench.drives.is_finished() && bench.drives.connection_loss().is_none());
    assert!(bench.ms - begun <= 250, "{} ms", bench.ms - begun);
}

/// If a drive does not stop, the connection ends after the last level of the stop sequence.
#[test]
fn unstoppable_drive_ends_connection() {
    let mut bench = Bench::jogs();
    bench.act(MotionRequest::Stop);
    let mut words = Vec::new();
    while let Some(word) = bench.cycle() {
        bench.status = 0x1A37;
        words.push(word);
    }
    words.dedup();
    assert_eq!(words, [0x1419, 0x0401, 0x0000]);
    assert_eq!(bench.drives.connection_loss(), Some(&ConnectionLoss::DoesNotStand(DriveNumber::FIRST)));
}

/// An action for another drive stops the first one.
#[test]
fn moves_only_one_drive_at_once() {
    let second = DriveNumber::new(2).unwrap();
    let mut drives =
        Drives::new(&opened(Topology::Hub4, false, ByteOrder::Little), &[DriveNumber::FIRST, second], 0, at(0));
    let effort = SpeedTorque::DEFAULT_JOG;
    let mut intent = MotionIntent::idle(DriveNumber::FIRST, 1, at(0));
    let mut moves = [false; 4];
    for ms in (0..3000).step_by(10) {
        intent = match ms {
            500 => MotionIntent { request: MotionRequest::Move { target: 9999, effort }, number: 2, ..intent },
            1500 => MotionIntent { drive: second, number: 3, ..intent },
            _ => intent,
        };
        intent.refreshed = at(ms);
        let Some(packet) = drives.poll(at(ms), &intent, permit) else { continue };
        let words = [0, 8, 16, 24].map(|place| u16::from_le_bytes([packet[24 + place], packet[25 + place]]));
        // Each port, with or without a drive, replies according to its control word.
        let mut image = Vec::new();
        for (word, moves) in words.into_iter().zip(&mut moves) {
            let level = [(0x0400, 1), (0x0001, 2), (0x0008, 4)]
                .into_iter()
                .map_while(|(bit, set)| (word & bit != 0).then_some(set));
            *moves = word & 0x0078 == 0x0078;
            let status = 0x0A30u16 | level.sum::<u16>() | if *moves { 0x1000 } else { 0x2000 };
            image.extend(status.to_le_bytes());
            image.extend([0; 6]);
        }
        let mut report = hex(TO_ORIGINATOR);
        report.truncate(20);
        report[10..14].copy_from_slice(&(ms as u32 + 1).to_le_bytes());
        report[16] = 34;
        report.extend(image);
        assert!(drives.on_packet(at(ms + 1), &report));
        assert!(!(moves[0] && moves[1]), "both at {ms}");
        assert_eq!((words[2], words[3]), (0, 0));
        match ms {
            1000..1500 => assert_eq!(moves, [true, false, false, false], "{ms}"),
            2000.. => assert_eq!(moves, [false, true, false, false], "{ms}"),
            _ => {}
        }
    }
}

proptest! {
    /// Every packet is counted. A malformed packet neither moves a drive nor keeps the connection alive.
    #[test]
    fn arbitrary_packets_never_move_drives(packets in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..80), 1..40)) {
        let mut bench = Bench::new();
        bench.cycles(5);
        bench.answers = false;
        let before = bench.drives.statistics().clone();
        for packet in &packets {
            bench.drives.on_packet(at(bench.ms), packet);
        }
        let after = bench.drives.statistics();
        prop_assert_eq!(after.malformed + after.received + after.stale, before.malformed + before.received + packets.len() as u64);
        prop_assert_eq!(after.received, before.received);
        // At rest, the connection is kept as long as the target waits, which is eight intervals in this test.
        bench.cycles(8);
        prop_assert!(bench.drives.connection_loss().is_none());
        bench.cycles(2);
        prop_assert!(bench.drives.connection_loss().is_some());
    }

    /// A truncated, damaged, repeated or late report causes no panic and is counted at most once.
    #[test]
    fn counts_corrupt_reports_at_most_once(
        reports in prop::collection::vec((0u32..40, 0usize..37, 0usize..400, 0u8..4), 1..60)
    ) {
        let mut connection = Connection::new(&opened(Topology::Adapter, true, ByteOrder::Little), at(0));
        let mut counted = Vec::new();
        for (sequence, cut, bit, damage) in &reports {
            let mut packet = report(*sequence, 0x2A37, 0);
            match damage {
                1 => packet.truncate(*cut),
                2 => packet[bit / 8 % 36] ^= 1 << (bit % 8),
                _ => {}
            }
            let came = connection.on_packet(at(1), &packet);
            if came.is_some() && *damage != 2 {
                counted.push(*sequence);
            }
        }
        prop_assert!(counted.is_sorted_by(|one, other| one < other) || reports.iter().any(|report| report.3 == 2));
        let figures = connection.statistics();
        prop_assert_eq!(figures.received + figures.stale + figures.malformed, reports.len() as u64);
    }
}
