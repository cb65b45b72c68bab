//! Measures how fast the position can be polled, compared with the minimum time that the protocol allows and with two
//! naive solutions: waiting for the longest time in the manual, and waiting for a fixed 250 ms after each request.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::HiperfaceJob;
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::protocol::{EncoderTypes, LineSettings};
use encoder_studio::devices::hiperface::sim::{Bus, Config};
use encoder_studio::link::{ByteLink, Clock, RealClock, SimLink, VirtualClock};
use encoder_studio::store::Store;
use encoder_studio::worker::Session;

/// Time in milliseconds that the virtual encoder needs to process command 42h.
const PROCESSING: f64 = 3.7;
/// Longest processing time for command 42h in the manual's table, in milliseconds.
const LONGEST: f64 = 10.0;
/// The interface settings with which the encoder is polled: 9600 and 38400 baud, even parity, time-out of 44 bits.
const SETTINGS: [u8; 2] = [0xE4, 0xE6];

/// Returns the minimum time for command 42h in milliseconds: a request of three characters, silence, processing, a
/// reply of seven characters, and silence. A character has 11 bits.
fn min_command_ms(baud: f64) -> f64 {
    (3.0 * 11.0 + 44.0 + 7.0 * 11.0 + 44.0) * 1000.0 / baud + PROCESSING
}

fn bus(settings: u8) -> Arc<Mutex<Bus>> {
    Arc::new(Mutex::new(Bus::new(&Config::from_pairs(&[("settings".to_owned(), settings.to_string())]).unwrap())))
}

fn median(mut cycles: Vec<f64>) -> f64 {
    cycles.sort_by(f64::total_cmp);
    cycles[cycles.len() / 2]
}

/// Polls like the program, and returns the median time between two positions in milliseconds.
fn studio(settings: u8, clock: Arc<dyn Clock>, count: usize) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let mut station = Station::new(Duration::from_millis(20));
    station.format = LineSettings::from_byte(settings).character_format().unwrap();
    let mut link = SimLink::connect(bus(settings), clock.clone());
    link.set_format(station.format).unwrap();
    let types = EncoderTypes::built_in();
    let mut session = Session::new(Box::new(link), clock.clone(), station, Store::at_root(folder.path()), types, true);
    session.run_inline(HiperfaceJob::Position(None)).unwrap();
    let cycle = |_| {
        let before = clock.now();
        session.run_inline(HiperfaceJob::Position(None)).unwrap();
        clock.now().duration_since(before).as_secs_f64() * 1e3
    };
    median((0..count).map(cycle).collect())
}

/// Polls naively by sending, waiting for a fixed time, and reading the received bytes.
fn naive(settings: u8, clock: &dyn Clock, owned: Arc<dyn Clock>, wait_ms: f64, count: usize) -> f64 {
    let mut link = SimLink::connect(bus(settings), owned);
    link.set_format(LineSettings::from_byte(settings).character_format().unwrap()).unwrap();
    let cycle = |_| {
        let before = clock.now();
        link.send(&[0x40, 0x42, 0x02]).unwrap();
        clock.sleep_until(before + Duration::from_secs_f64(wait_ms / 1e3));
        let mut reply = Vec::new();
        link.receive(clock.now(), &mut reply).unwrap();
        assert_eq!(reply.len(), 7);
        clock.now().duration_since(before).as_secs_f64() * 1e3
    };
    median((0..count).map(cycle).collect())
}

pub(crate) fn run() {
    println!("polling 42h, median cycle in ms and share of it that the protocol needs (goal: 95 % or more)");
    println!("{:<10} {:<8} {:>9} {:>9} {:>8}", "way", "time", "baud", "cycle", "share");
    for settings in SETTINGS {
        let baud = LineSettings::from_byte(settings).baud().unwrap().bits_per_second();
        let least = min_command_ms(f64::from(baud));
        let row = |way: &str, time: &str, cycle: f64| {
            println!("{way:<10} {time:<8} {baud:>9} {cycle:>9.3} {:>6.1} %", least / cycle * 100.0);
        };
        row("least", "-", least);
        row("studio", "virtual", studio(settings, Arc::new(VirtualClock::default()), 2000));
        row("studio", "real", studio(settings, Arc::new(RealClock::start()), 200));
        let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
        row("longest", "real", naive(settings, &*clock, clock.clone(), least - PROCESSING + LONGEST, 100));
        row("250 ms", "real", naive(settings, &*clock, clock.clone(), 250.0, 8));
    }
}
