//! Runs the program for a long time. The five virtual devices are polled as fast as their links allow, a virtual
//! encoder supplies sine and cosine, and the window is laid out and tessellated 60 times per second. Prints the frame
//! time for each page and the resource usage of the process at ten points in time, with the slope from the second point
//! on.
//!
//! `cargo bench -- soak 600` runs for ten minutes, `cargo bench` for one minute.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use egui_kittest::Harness;
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::{Action, DeviceCommand, Studio, StudioEnvironment, Tab, ThemeData};
use encoder_studio::kinds::program;
use encoder_studio::signals::state::{SignalsAction, SourceAction};
use encoder_studio::store::Store;
use encoder_studio::ui::{Window, install_fonts};

const TABS: [Tab; 6] = [
    Tab::named("Hiperface"),
    Tab::named("Biss"),
    Tab::named("Ssi"),
    Tab::named("Interbus"),
    Tab::named("Hiperdrive"),
    Tab::named("Signals"),
];
const DEVICES: usize = 5;
const POINTS: usize = 10;
const FRAME: Duration = Duration::from_micros(16_667);
/// Time for which each tab is displayed.
const SHOWN: Duration = Duration::from_secs(1);

pub(crate) struct Shown(Window);

impl eframe::App for Shown {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.0.draw(ui);
    }
}

pub(crate) type Screen = Harness<'static, Shown>;

pub(crate) fn run(parts: &[String]) {
    let seconds = parts.first().and_then(|word| word.parse().ok()).unwrap_or(60);
    let folder = tempfile::tempdir().unwrap();
    let mut screen = connected(folder.path());
    let devices: Vec<String> = screen.state().0.studio().devices().iter().map(|own| own.name()).collect();
    let (began, end) = (Instant::now(), Duration::from_secs(seconds));
    let mut frames: [Vec<f64>; TABS.len()] = Default::default();
    let mut points = vec![Usage::now(&screen)];
    println!("{} and a source of sine and cosine, {seconds} s", devices.join(", "));
    println!(
        "{:>7} {:>7} {:>9} {:>8} {:>8} {:>12} {:>8}",
        "s", "CPU %", "MB", "handles", "threads", "recorded MB", "dropped"
    );
    while began.elapsed() < end {
        let tab = (began.elapsed().as_millis() / SHOWN.as_millis()) as usize % TABS.len();
        let begun = Instant::now();
        if screen.state().0.studio().settings.tab != TABS[tab] {
            screen.state().0.studio().mailbox().send(Action::ShowTab(TABS[tab]));
        }
        screen.step();
        frames[tab].push(begun.elapsed().as_secs_f64() * 1e3);
        if began.elapsed() >= end.mul_f64(points.len() as f64 / POINTS as f64) {
            let point = Usage::now(&screen);
            point.print(points.last().unwrap(), began);
            points.push(point);
        }
        thread::sleep(FRAME.saturating_sub(begun.elapsed()));
    }
    println!("slope from the second point on, per hour:");
    let late = &points[1..];
    for (what, value) in [
        ("MB", (|own| own.bytes / 1e6) as fn(&Usage) -> f64),
        ("MB without the recordings", |own| (own.bytes - own.recorded) / 1e6),
        ("handles", |own| own.handles),
        ("threads", |own| own.threads),
    ] {
        println!("  {what:<31} {:>9.1}", slope(late, began, value) * 3600.0);
    }
    println!("time of a frame in ms, without the rasteriser: median, 99 %, most");
    for (tab, times) in TABS.iter().zip(&mut frames) {
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times.get((times.len() as f64 * share) as usize).or(times.last()).copied();
        let [middle, high, most] = [0.5, 0.99, 1.0].map(|share| at(share).unwrap_or(f64::NAN));
        println!("  {:<12} {middle:>7.2} {high:>7.2} {most:>7.2}", format!("{tab:?}"));
    }
}

/// Returns a window in which all virtual devices are polled and sine and cosine are recorded.
fn connected(folder: &Path) -> Screen {
    let mut screen = open_window(folder);
    connect_devices(&mut screen, DEVICES);
    screen.state().0.studio().mailbox().send(Action::tool(SignalsAction::Source(SourceAction::Start)));
    screen
}

/// Returns the window in its state after the program has started. `folder` holds its files.
pub(crate) fn open_window(folder: &Path) -> Screen {
    let environment = StudioEnvironment::production(Store::at_root(folder), program().studio);
    let mut studio = Studio::new(environment, Arc::new(|| {}));
    studio.start_with(None, None);
    Harness::builder().with_size([1280.0, 800.0]).build_eframe(|cc| {
        install_fonts(&cc.egui_ctx);
        Shown(Window::new(studio, ThemeData::built_in().unwrap(), program().tabs))
    })
}

/// Connects virtual devices, at most one of each kind, and polls them as fast as their links allow. The first one is
/// already connected when the program starts.
pub(crate) fn connect_devices(screen: &mut Screen, wanted: usize) {
    until(screen, "the first device", |studio| polled(studio) == 1);
    for (tab, count) in TABS[1..wanted].iter().zip(2..) {
        let mailbox = screen.state().0.studio().mailbox();
        mailbox.send(Action::ShowTab(*tab));
        mailbox.send(Action::Connect(Connect::Open));
        mailbox.send(Action::Connect(Connect::Use("sim:".to_owned())));
        mailbox.send(Action::Connect(Connect::Connect));
        until(screen, "a device is polled", |studio| polled(studio) == count);
    }
}

/// Draws frames until a condition is met. Devices that become ready are polled as fast as their links allow.
fn until(screen: &mut Screen, what: &str, condition: impl Fn(&Studio) -> bool) {
    let began = Instant::now();
    loop {
        screen.step();
        let studio = screen.state().0.studio();
        for device in studio.devices().iter().filter(|own| own.is_ready() && !own.is_polling()) {
            studio.mailbox().send(device.command(DeviceCommand::Poll(Some(Duration::ZERO))));
        }
        if condition(studio) {
            return;
        }
        assert!(began.elapsed() < Duration::from_secs(30), "never: {what}");
        thread::sleep(FRAME);
    }
}

fn polled(studio: &Studio) -> usize {
    studio.devices().iter().filter(|own| own.is_polling()).count()
}

/// The resource usage of the process at one point in time.
struct Usage {
    at: Instant,
    /// User and system time in seconds.
    busy: f64,
    bytes: f64,
    handles: f64,
    threads: f64,
    /// Memory of all recordings in bytes.
    recorded: f64,
    dropped: u64,
}

impl Usage {
    fn now(screen: &Screen) -> Self {
        let stat = fs::read_to_string("/proc/self/stat").unwrap();
        let fields: Vec<&str> = stat.rsplit(") ").next().unwrap().split(' ').collect();
        let count = |folder| fs::read_dir(folder).unwrap().count() as f64;
        let devices = screen.state().0.studio().devices();
        Usage {
            at: Instant::now(),
            // The fields are in hundredths of a second.
            busy: (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0,
            // The field is a number of pages of 4 KiB.
            bytes: fields[21].parse::<f64>().unwrap() * 4096.0,
            handles: count("/proc/self/fd"),
            threads: count("/proc/self/task"),
            recorded: devices.iter().map(|own| own.recorder().memory() as f64).sum(),
            dropped: devices.iter().map(|own| own.dropped_count()).sum(),
        }
    }

    fn print(&self, before: &Usage, began: Instant) {
        let busy = (self.busy - before.busy) / self.at.duration_since(before.at).as_secs_f64() * 100.0;
        println!(
            "{:>7.0} {busy:>7.1} {:>9.1} {:>8} {:>8} {:>12.2} {:>8}",
            self.at.duration_since(began).as_secs_f64(),
            self.bytes / 1e6,
            self.handles,
            self.threads,
            self.recorded / 1e6,
            self.dropped
        );
    }
}

/// Returns the slope per second of the least-squares line through the points.
fn slope(points: &[Usage], began: Instant, value: impl Fn(&Usage) -> f64) -> f64 {
    let pairs: Vec<(f64, f64)> =
        points.iter().map(|own| (own.at.duration_since(began).as_secs_f64(), value(own))).collect();
    let count = pairs.len() as f64;
    let (x, y) = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0 / count, sum.1 + pair.1 / count));
    let across = pairs.iter().map(|pair| (pair.0 - x) * (pair.1 - y)).sum::<f64>();
    across / pairs.iter().map(|pair| (pair.0 - x).powi(2)).sum::<f64>()
}
