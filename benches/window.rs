//! How soon the window is there, and what it costs to keep it open: the program beside a window with nothing in it, both
//! drawn in software. Needs a display, or Xvfb; says so where there is neither.
//!
//! `cargo bench --bench window`

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic, missing_docs)]

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

const STARTS: usize = 9;
const IDLE: Duration = Duration::from_secs(10);

fn main() {
    if std::env::args().any(|argument| argument == "minimal") {
        minimal();
        return;
    }
    let Some(display) = Display::find() else {
        println!("skipped: there is no display, and Xvfb is not installed");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let own = std::env::current_exe().unwrap();
    let program = env!("CARGO_BIN_EXE_encoder-studio");
    let mut ours = Vec::new();
    let mut least = Vec::new();
    for _ in 0..STARTS {
        let log = folder.path().join("encoder-studio/encoder-studio.log");
        let _ = fs::remove_file(&log);
        let mut child = display.start(program, &[], folder.path());
        ours.push(wait_for(|| first_picture(&fs::read_to_string(&log).ok()?)));
        end(&mut child);
        let log = folder.path().join("minimal.log");
        let _ = fs::remove_file(&log);
        let mut child = display.start(own.to_str().unwrap(), &["minimal"], folder.path());
        least.push(wait_for(|| first_picture(&fs::read_to_string(&log).ok()?)));
        end(&mut child);
    }
    println!("first picture, median of {STARTS} starts: {} ms", median(&mut ours));
    println!("a window with nothing in it:           {} ms", median(&mut least));
    let mut child = display.start(program, &[], folder.path());
    thread::sleep(Duration::from_secs(3));
    println!("idle, connected to the virtual encoder: {:.2} % of a processor", busy(&child));
    end(&mut child);
    let mut child = display.start(program, &["--profile", "profiles/hiperface/multiturn-skm36.ron"], folder.path());
    thread::sleep(Duration::from_secs(3));
    println!("idle, a profile open:                   {:.2} % of a processor", busy(&child));
    end(&mut child);
}

/// The window that does nothing: what eframe, the driver and the X server need in any case.
fn minimal() {
    struct Nothing(Option<Instant>);
    impl eframe::App for Nothing {
        fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
            if ui.ctx().cumulative_frame_nr() > 0
                && let Some(began) = self.0.take()
            {
                let path = format!("{}/minimal.log", std::env::var("XDG_DATA_HOME").unwrap());
                fs::write(path, format!("first picture after {} ms\n", began.elapsed().as_millis())).unwrap();
            }
            ui.ctx().request_repaint();
        }
    }
    let began = Instant::now();
    let options = eframe::NativeOptions { renderer: eframe::Renderer::Glow, ..Default::default() };
    eframe::run_native("minimal", options, Box::new(move |_| Ok(Box::new(Nothing(Some(began)))))).unwrap();
}

fn first_picture(log: &str) -> Option<u64> {
    let (_, rest) = log.split_once("first picture after ")?;
    rest.split_once(" ms")?.0.parse().ok()
}

fn wait_for(mut look: impl FnMut() -> Option<u64>) -> u64 {
    let began = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(began.elapsed() < Duration::from_secs(20), "nothing in 20 s");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Share of one processor over some seconds, in percent.
fn busy(child: &Child) -> f64 {
    let ticks = || -> f64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
        let fields: Vec<&str> = stat.rsplit(") ").next().unwrap().split(' ').collect();
        // User and system time, in hundredths of a second.
        fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()
    };
    let before = ticks();
    thread::sleep(IDLE);
    (ticks() - before) / IDLE.as_secs_f64()
}

fn median(values: &mut [u64]) -> u64 {
    values.sort_unstable();
    values[values.len() / 2]
}

fn end(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}

/// The display of this session, or a virtual one.
struct Display {
    name: String,
    server: Option<Child>,
}

impl Display {
    fn find() -> Option<Self> {
        if let Ok(name) = std::env::var("DISPLAY")
            && !name.is_empty()
        {
            return Some(Display { name, server: None });
        }
        let name = ":97".to_owned();
        let server = Command::new("Xvfb")
            .args([&name, "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        wait_for(|| std::os::unix::net::UnixStream::connect("/tmp/.X11-unix/X97").ok().map(|_| 0));
        Some(Display { name, server: Some(server) })
    }

    fn start(&self, program: &str, arguments: &[&str], folder: &std::path::Path) -> Child {
        Command::new(program)
            .args(arguments)
            .env("DISPLAY", &self.name)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_DATA_HOME", folder)
            .env("XDG_CONFIG_HOME", folder)
            .env("LIBGL_ALWAYS_SOFTWARE", "1")
            .stderr(Stdio::null())
            .spawn()
            .unwrap()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some(server) = &mut self.server {
            end(server);
        }
    }
}
