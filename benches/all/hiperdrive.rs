//! Measures how long after the release of a jog button the stop command reaches the drive's socket (at most one
//! interval plus 5 ms), and the jitter of a cyclic connection while a window is drawn. Each is compared with a naive
//! solution, a thread that sleeps for one interval and then checks.
//!
//! `cargo bench -- hiperdrive`; `HIPERDRIVE_RELEASES` (200) and `HIPERDRIVE_SECONDS` (20) set the number of releases
//! and the duration. A minute is enough for the naive solution.

use std::net::UdpSocket;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{JoinHandle, sleep, spawn};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, unbounded};
use encoder_studio::buses::ethernet_ip::protocol::{
    ConnectionOwner, EPath, ForwardClose, IoPacket, RealTimeFormat, RequestTimeout,
};
use encoder_studio::devices::hiperdrive::jobs::{Cyclic, Motion};
use encoder_studio::devices::hiperdrive::procedures::cyclic::{Drives, Histogram};
use encoder_studio::devices::hiperdrive::procedures::dead_man::{MotionIntent, MotionRequest, Permit, SpeedTorque};
use encoder_studio::devices::hiperdrive::procedures::{DriveLimits, MotionLimitParameters, OpenedConnection};
use encoder_studio::devices::hiperdrive::protocol::{
    ByteOrder, ControlWord, Direction, DriveNumber, Layout, OutputImage, Topology, Variant,
};
use encoder_studio::devices::hiperdrive::sim::{Station, StationConfig};
use encoder_studio::link::{Clock, DatagramChannel, DatagramPort, RealClock, UdpPort};

const INTERVAL: Duration = Duration::from_millis(10);
const LAYOUT: Layout = Layout { topology: Topology::Adapter, pkw: true, order: ByteOrder::Little };
const TO_TARGET: u32 = 0x0002_0001;
const TO_ORIGINATOR: u32 = 0x0003_0001;

fn opened(port: u16) -> OpenedConnection {
    let owner = ConnectionOwner { connection_serial: 1, vendor: 0x1234, serial_number: 0xABCD };
    let close =
        ForwardClose { timeout: RequestTimeout::TWO_SECOND_TIMEOUT, owner, path: EPath::to_assemblies(104, 100, 101) };
    OpenedConnection {
        to_target_id: TO_TARGET,
        to_originator_id: TO_ORIGINATOR,
        to_target_interval: INTERVAL,
        to_originator_interval: INTERVAL,
        timeout: INTERVAL * 8,
        layout: LAYOUT,
        port,
        group: None,
        close,
    }
}

/// A virtual drive with its own socket and clock. It records when each control word arrives.
struct Target {
    port: u16,
    words: Receiver<(Instant, ControlWord)>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Target {
    fn start(host: u16) -> Self {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let port = socket.local_addr().unwrap().port();
        let (sender, words) = unbounded();
        let end = Arc::new(AtomicBool::new(false));
        let ends = end.clone();
        let thread = spawn(move || {
            let clock = RealClock::start();
            let mut station = Station::new(StationConfig::default());
            station.open(clock.now(), INTERVAL * 8);
            let (mut due, mut sequence) = (Instant::now() + INTERVAL, 0);
            let mut buffer = [0; 256];
            while !ends.load(Ordering::Relaxed) {
                let left = due.saturating_duration_since(Instant::now());
                if left.is_zero() {
                    due += INTERVAL;
                    sequence += 1;
                    let data = station.image(clock.now()).emit(LAYOUT);
                    let count = sequence as u16;
                    let packet = IoPacket { connection: TO_ORIGINATOR, sequence, count, header: None, data };
                    socket.send_to(&packet.emit(), ("127.0.0.1", host)).unwrap();
                    continue;
                }
                socket.set_read_timeout(Some(left)).unwrap();
                let Ok((count, _)) = socket.recv_from(&mut buffer) else { continue };
                let at = Instant::now();
                let packet = IoPacket::parse(&buffer[..count], RealTimeFormat::Header).unwrap();
                let image = OutputImage::parse(&packet.data, LAYOUT).unwrap();
                let word = image.drives[0].control_word().unwrap();
                station.handle_process_data(clock.now(), &image, true);
                sender.send((at, word)).unwrap();
            }
        });
        Target { port, words, end, thread: Some(thread) }
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn permit() -> Permit {
    Permit::for_range(-33_000_000, 33_000_000)
}

/// An implementation of a cyclic connection.
trait DeviceConnection {
    fn name(&self) -> &'static str;
    fn intend(&self, wish: MotionRequest);
    fn refresh(&self);
    /// Returns a histogram of the received packets by the errors of their intervals.
    fn arrivals(&self) -> Histogram;
}

/// A function that opens a connection to a drive.
type OpenConnection = fn() -> (Box<dyn DeviceConnection>, Target);

/// The program's own connection.
struct ProgramConnection {
    motion: Motion,
    _cyclic: Cyclic,
}

impl DeviceConnection for ProgramConnection {
    fn name(&self) -> &'static str {
        "absolute deadlines"
    }

    fn intend(&self, wish: MotionRequest) {
        self.motion.request_motion(DriveNumber::FIRST, wish);
    }

    fn refresh(&self) {
        self.motion.refresh();
    }

    fn arrivals(&self) -> Histogram {
        self.motion.snapshot().link.intervals
    }
}

/// A naive connection: a loop that sleeps, checks and sends.
struct Naive {
    shared: Arc<Mutex<(MotionIntent, Histogram)>>,
    clock: Arc<RealClock>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl DeviceConnection for Naive {
    fn name(&self) -> &'static str {
        "sleep, then look"
    }

    fn intend(&self, wish: MotionRequest) {
        let intent = &mut self.shared.lock().unwrap().0;
        *intent = MotionIntent { request: wish, number: intent.number + 1, refreshed: self.clock.now(), ..*intent };
    }

    fn refresh(&self) {
        self.shared.lock().unwrap().0.refreshed = self.clock.now();
    }

    fn arrivals(&self) -> Histogram {
        self.shared.lock().unwrap().1.clone()
    }
}

impl Drop for Naive {
    fn drop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

fn port() -> (Box<dyn DatagramChannel>, Target, Arc<RealClock>) {
    let clock = Arc::new(RealClock::start());
    let mut packets = UdpPort::new("127.0.0.1:44818", clock.clone()).open().unwrap();
    let target = Target::start(packets.port());
    packets.set_target_port(target.port);
    (packets, target, clock)
}

fn ours() -> (Box<dyn DeviceConnection>, Target) {
    let (packets, target, clock) = port();
    let motion = Motion::new(clock.clone());
    let rules = MotionLimitParameters {
        requested: Some(1),
        scale: Some((256, 1)),
        limits: Some((-33_000_000, 33_000_000)),
        timeout: Some(20),
        reference: Some(0),
    };
    // The limits are not read again here, so the time of their reading lies after the end of the benchmark.
    let read = clock.now() + Duration::from_secs(3600);
    motion
        .publish_limits(DriveNumber::FIRST, DriveLimits::from_rules(rules, (Topology::Adapter, Variant::new(7)), read));
    let cyclic = Cyclic::start(packets, &opened(target.port), &[DriveNumber::FIRST], clock, &motion).unwrap();
    (Box::new(ProgramConnection { motion, _cyclic: cyclic }), target)
}

fn naive() -> (Box<dyn DeviceConnection>, Target) {
    let (mut packets, target, clock) = port();
    let intent = MotionIntent::idle(DriveNumber::FIRST, 1, clock.now());
    let shared = Arc::new(Mutex::new((intent, Histogram::default())));
    let end = Arc::new(AtomicBool::new(false));
    let (ends, cell, time) = (end.clone(), shared.clone(), clock.clone());
    let mut drives = Drives::new(&opened(target.port), &[DriveNumber::FIRST], 1, clock.now());
    let thread = spawn(move || {
        let mut packet = Vec::new();
        while !ends.load(Ordering::Relaxed) {
            sleep(INTERVAL);
            while packets.receive(time.now(), &mut packet).unwrap() {
                drives.on_packet(time.now(), &packet);
            }
            let intent = cell.lock().unwrap().0;
            if let Some(packet) = drives.poll(drives.poll_at().max(time.now()), &intent, |_| permit()) {
                packets.send(&packet).unwrap();
            }
            cell.lock().unwrap().1 = drives.statistics().intervals.clone();
        }
    });
    (Box::new(Naive { shared, clock, end, thread: Some(thread) }), target)
}

/// Returns the times from the release of a jog button to the arrival of the stop command, in milliseconds and in
/// ascending order.
fn releases(way: &dyn DeviceConnection, target: &Target, count: usize) -> Vec<f64> {
    let mut random = fastrand::Rng::with_seed(7);
    let mut took = Vec::with_capacity(count);
    sleep(INTERVAL * 5);
    while took.len() < count {
        way.intend(MotionRequest::Jog {
            direction: Direction::Clockwise,
            effort: SpeedTorque::DEFAULT_JOG,
            outward: false,
        });
        let held = Instant::now() + Duration::from_micros(random.u64(120_000..160_000));
        while Instant::now() < held {
            way.refresh();
            sleep(Duration::from_millis(7).min(held.saturating_duration_since(Instant::now())));
        }
        let moved = target.words.try_iter().last().is_some_and(|(_, word)| !word.is_at_rest());
        let released = Instant::now();
        way.intend(MotionRequest::Stop);
        let stands = target.words.iter().find(|(at, word)| *at >= released && word.is_at_rest()).unwrap();
        assert!(moved, "the jog has not begun");
        took.push((stands.0 - released).as_secs_f64() * 1e3);
        sleep(Duration::from_millis(200));
        target.words.try_iter().for_each(drop);
    }
    took.sort_by(f64::total_cmp);
    took
}

/// Measures the intervals between packets, both on arrival at the target's socket and on arrival at the host.
fn measure_intervals(way: &dyn DeviceConnection, target: &Target, time: Duration) -> [Histogram; 2] {
    sleep(INTERVAL * 5);
    target.words.try_iter().for_each(drop);
    let end = Instant::now() + time;
    let mut sent = Histogram::default();
    let mut before = None;
    while Instant::now() < end {
        let Ok((at, _)) = target.words.recv_timeout(Duration::from_secs(1)) else { continue };
        if let Some(before) = before.replace(at) {
            sent.count(INTERVAL, at - before);
        }
    }
    [sent, way.arrivals()]
}

/// Starts a thread that imitates the load of a window: 60 frames per second, with the processor busy half of the time.
fn window() -> (Arc<AtomicBool>, JoinHandle<()>) {
    let end = Arc::new(AtomicBool::new(false));
    let ends = end.clone();
    let thread = spawn(move || {
        while !ends.load(Ordering::Relaxed) {
            let begun = Instant::now();
            while begun.elapsed() < Duration::from_millis(8) {
                std::hint::black_box(fastrand::u64(..));
            }
            sleep(Duration::from_micros(16_667).saturating_sub(begun.elapsed()));
        }
    });
    (end, thread)
}

/// Returns the CPU time used by this process in seconds, or 0 if the system does not report it.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> =
        stat.rsplit(") ").next().unwrap_or("").split(' ').map(|f| f.parse().unwrap_or(0.0)).collect();
    // User and system time in hundredths of a second.
    fields.get(11..13).map_or(0.0, |times| times.iter().sum::<f64>() / 100.0)
}

fn setting(name: &str, otherwise: usize) -> usize {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

pub(crate) fn run() {
    let count = setting("HIPERDRIVE_RELEASES", 200);
    let time = Duration::from_secs(setting("HIPERDRIVE_SECONDS", 20) as u64);
    let ways: [OpenConnection; 2] = [ours, naive];
    println!("From a release to the stop word at the socket, {count} releases at 10 ms (asked for: at most 15 ms)\n");
    for way in ways {
        let (way, target) = way();
        let took = releases(way.as_ref(), &target, count);
        let of = |part: f64| took[((took.len() - 1) as f64 * part) as usize];
        let (median, most) = (of(0.5), of(1.0));
        println!("{:20} median {median:6.2} ms, 99 % {:6.2} ms, most {most:6.2} ms", way.name(), of(0.99));
    }
    println!("\nA cyclic connection at 10 ms beside a window that draws at 60 Hz");
    let minute = Duration::from_secs(60);
    for (way, time) in ways.into_iter().zip([time, time.min(minute)]) {
        let (way, target) = way();
        let before = processor_seconds();
        sleep(Duration::from_secs(2));
        let used = (processor_seconds() - before) / 2.0 * 100.0;
        let (end, drawing) = window();
        let [sent, came] = measure_intervals(way.as_ref(), &target, time);
        end.store(true, Ordering::Relaxed);
        drawing.join().unwrap();
        let seconds = time.as_secs();
        println!("\n{}, {seconds} s: {used:.1} % of a processor, target and this bench included", way.name());
        println!("{:>22} {:>10} {:>10}", "off by µs", "sent", "came");
        for (sent, came) in sent.buckets().zip(came.buckets()) {
            let edge = |edge: Option<i64>| edge.map_or("…".to_owned(), |edge| edge.to_string());
            let range = format!("{} to {}", edge(sent.from_us), edge(sent.below_us));
            println!("{range:>22} {:>10} {:>10}", sent.count, came.count);
        }
        for (name, histogram) in [("sent", &sent), ("came", &came)] {
            let (least, most) = histogram.deviation_range_us().unwrap_or_default();
            println!("{name}: {} intervals, off by {least} to {most} µs", histogram.total());
        }
    }
}
