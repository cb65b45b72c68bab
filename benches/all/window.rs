//! Measures the start-up time of the window and its load while open, compared with an empty window. Both are drawn in
//! software. Also measures the frame time with forty million samples in the plot, and whether an adapter's stream of 20
//! 000 frames per second is displayed without loss. Needs a display or Xvfb, and prints a message if neither is
//! available.
//!
//! `cargo bench -- window`

use encoder_studio::app::{DeviceCommand, Recording};
use std::io::Write as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

const STARTS: usize = 9;
const IDLE: Duration = Duration::from_secs(10);

pub(crate) fn run(parts: &[String]) {
    // This process was started again as a separate program.
    match parts.first().map(String::as_str) {
        Some("minimal") => return minimal(),
        Some("plot") => return plot(),
        Some("stream") => return stream(),
        _ => {}
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
        ours.push(wait_for(|| first_frame_time(&fs::read_to_string(&log).ok()?)));
        end(&mut child);
        let log = folder.path().join("minimal.log");
        let _ = fs::remove_file(&log);
        let mut child = display.start(own.to_str().unwrap(), &["window", "minimal"], folder.path());
        least.push(wait_for(|| first_frame_time(&fs::read_to_string(&log).ok()?)));
        end(&mut child);
    }
    println!("first picture, median of {STARTS} starts: {} ms", median(&mut ours));
    println!("a window with nothing in it:           {} ms", median(&mut least));
    let mut child = display.start(program, &[], folder.path());
    thread::sleep(Duration::from_secs(3));
    println!("idle, connected to the virtual encoder: {:.2} % of a processor", cpu_percent(&child));
    println!("resident memory of the same:            {:.0} MB", resident_mb(child.id()));
    end(&mut child);
    let mut child = display.start(program, &["--profile", "profiles/hiperface/multiturn-skm36.ron"], folder.path());
    thread::sleep(Duration::from_secs(3));
    println!("idle, a profile open:                   {:.2} % of a processor", cpu_percent(&child));
    end(&mut child);
    let capture = folder.path().join("capture.csv");
    write_capture(&capture);
    let mut child = display.start(own.to_str().unwrap(), &["window", "plot"], folder.path());
    let result = folder.path().join("plot.txt");
    wait_for_up_to(Duration::from_secs(300), || {
        fs::read_to_string(&result).ok().filter(|text| text.ends_with('\n')).map(|_| 0)
    });
    print!("{}", fs::read_to_string(&result).unwrap());
    end(&mut child);
    let mut child = display.start(own.to_str().unwrap(), &["window", "stream"], folder.path());
    let result = folder.path().join("stream.txt");
    wait_for_up_to(STREAMING_TIME * 4, || {
        fs::read_to_string(&result).ok().filter(|text| text.ends_with('\n')).map(|_| 0)
    });
    print!("{}", fs::read_to_string(&result).unwrap());
    end(&mut child);
}

const STREAMING_TIME: Duration = Duration::from_secs(15);

/// Runs the complete window with a plot of the position of a virtual BiSS encoder, while the virtual adapter streams 20
/// 000 frames per second.
fn stream() {
    use encoder_studio::app::{Action, Studio, StudioEnvironment, Tab, ThemeData};
    use encoder_studio::kinds::program;
    use encoder_studio::store::Store;
    use encoder_studio::ui::{Window, install_fonts};

    struct StreamingApp {
        window: Window,
        began: Option<Instant>,
        /// Duration of each frame in microseconds.
        took: Vec<u64>,
    }
    impl eframe::App for StreamingApp {
        fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
            let studio = self.window.studio();
            let ready = studio
                .selected_model::<encoder_studio::devices::biss::state::Encoder>()
                .filter(|own| own.session.is_ready() && own.survey.is_some());
            if let (None, Some(encoder)) = (self.began, ready) {
                let poll = DeviceCommand::Poll(Some(Duration::from_micros(50)));
                studio.mailbox().send(Action::Command(encoder.session.id, poll));
                self.began = Some(Instant::now());
            }
            let begun = Instant::now();
            self.window.draw(ui);
            if self.began.is_none() {
                ui.ctx().request_repaint_after(Duration::from_millis(20));
                return;
            }
            self.took.push(begun.elapsed().as_micros() as u64);
            let Some(encoder) = self.window.studio().selected_model::<encoder_studio::devices::biss::state::Encoder>()
            else {
                return;
            };
            if self.began.is_some_and(|began| began.elapsed() >= STREAMING_TIME) {
                let (pictures, positions, lost) =
                    (self.took.len(), encoder.record.position_count(), encoder.record.dropped_count());
                let middle = median(&mut self.took) as f64 / 1e3;
                let most = self.took[self.took.len() - 1] as f64 / 1e3;
                let seconds = STREAMING_TIME.as_secs();
                let text = format!(
                    "a stream of 20 000 frames/s, {seconds} s:       {positions} frames shown, {lost} lost; {pictures} pictures, \
                     {middle:.1} ms each, median, {most:.1} at most\n"
                );
                fs::write(format!("{}/stream.txt", std::env::var("XDG_DATA_HOME").unwrap()), text).unwrap();
                std::process::exit(0);
            }
        }
    }
    let folder = std::path::PathBuf::from(std::env::var("XDG_DATA_HOME").unwrap());
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size([1280.0, 800.0]),
        renderer: eframe::Renderer::Glow,
        ..Default::default()
    };
    eframe::run_native(
        "stream",
        options,
        Box::new(move |cc| {
            install_fonts(&cc.egui_ctx);
            let ctx = cc.egui_ctx.clone();
            let mut studio = Studio::new(
                StudioEnvironment::production(Store::at_root(&folder), program().studio),
                std::sync::Arc::new(move || ctx.request_repaint()),
            );
            studio.handle_action(Action::ShowTab(Tab::named("Biss")));
            // At 2 MHz, a frame of 43 clocks takes 21.5 µs plus 27 µs of waiting.
            studio.start_with(Some("sim:?bridge=on&clock=2000000&rpm=300".parse()?), None);
            let window = Window::new(studio, ThemeData::built_in()?, program().tabs);
            Ok(Box::new(StreamingApp { window, began: None, took: Vec::new() }))
        }),
    )
    .unwrap();
}

/// Number of samples per line. The four lines are sine, cosine, REFSIN and REFCOS, sampled every microsecond.
const SAMPLES: usize = 10_000_000;

fn write_capture(path: &std::path::Path) {
    let mut file = std::io::BufWriter::new(fs::File::create(path).unwrap());
    writeln!(file, "time [s],SIN [V],REFSIN [V],COS [V],REFCOS [V]").unwrap();
    for at in 0..SAMPLES {
        let angle = at as f64 * 1e-3;
        let noise = ((at.wrapping_mul(2_654_435_761) >> 16) % 1000) as f64 * 1e-5;
        let (sine, cosine) = (2.5 + 0.5 * angle.sin() + noise, 2.5 + 0.5 * angle.cos() - noise);
        writeln!(file, "{:.6},{sine:.4},2.5,{cosine:.4},2.5", at as f64 * 1e-6).unwrap();
    }
}

/// Runs the complete window with the capture in its scope. Each frame shows a different part, and frames follow each
/// other without a pause.
fn plot() {
    use encoder_studio::analysis::SampleTime;
    use encoder_studio::app::{Action, Studio, StudioEnvironment, ThemeData, recorder};
    use encoder_studio::kinds::program;
    use encoder_studio::signals::state as signals;
    use encoder_studio::store::Store;
    use encoder_studio::ui::{Window, install_fonts};

    const MEASURED_FRAMES: usize = 150;
    use encoder_studio::signals::state::Signals;

    struct PlottingApp {
        window: Window,
        /// Time at which each frame was drawn.
        times: Vec<Instant>,
    }
    impl eframe::App for PlottingApp {
        fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
            let studio = self.window.studio();
            if studio.tool_as::<Signals>().and_then(Signals::measurement).is_some() {
                self.times.push(Instant::now());
                let span = SAMPLES as i64 * 1000;
                let share = [1.0, 0.5, 0.1, 1e-3][self.times.len() % 4];
                let length = (span as f64 * share) as i64;
                let from = (span - length) / 300 * (self.times.len() % 300) as i64;
                let (from, to) = (SampleTime::from_nanoseconds(from), SampleTime::from_nanoseconds(from + length));
                let mailbox = studio.mailbox();
                mailbox.send(Action::Recorder(
                    encoder_studio::app::RecorderOwner::Tool(encoder_studio::app::Tab::named("Signals")),
                    recorder::RecorderAction::Look(from, to),
                ));
                if self.times.len() == 1 {
                    let lines = studio.tool_as::<Signals>().expect("there is a Signals tab").scope().recorder.series();
                    for (at, line) in lines.iter().enumerate() {
                        // The plot shows sine, cosine and both references.
                        let shown = [0, 1, 4, 6].contains(&at);
                        mailbox.send(Action::Recorder(
                            encoder_studio::app::RecorderOwner::Tool(encoder_studio::app::Tab::named("Signals")),
                            recorder::RecorderAction::Show(line.id, shown),
                        ));
                    }
                }
            }
            self.window.draw(ui);
            ui.ctx().request_repaint();
            if self.times.len() > MEASURED_FRAMES {
                // The first frames lay out letters and fill the memory, so they are left out.
                let mut took: Vec<u64> =
                    self.times.windows(2).skip(20).map(|pair| (pair[1] - pair[0]).as_micros() as u64).collect();
                let folder = std::env::var("XDG_DATA_HOME").unwrap();
                let median = median(&mut took) as f64 / 1e3;
                let most = took[took.len() - 1] as f64 / 1e3;
                let text = format!(
                    "the window with 4 × 10 M samples:       {median:.1} ms a picture, median, {most:.1} at most; {:.0} MB resident, \
                     {:.0} MB of raw samples and times\n",
                    resident_mb(std::process::id()),
                    (5 * SAMPLES * 8) as f64 / 1e6
                );
                fs::write(format!("{folder}/plot.txt"), text).unwrap();
                self.times.clear();
                std::process::exit(0);
            }
        }
    }
    let folder = std::path::PathBuf::from(std::env::var("XDG_DATA_HOME").unwrap());
    let mut studio = Studio::new(
        StudioEnvironment::production(Store::at_root(&folder), program().studio),
        std::sync::Arc::new(|| {}),
    );
    studio.start_with(None, None);
    studio.handle_action(Action::tool(signals::SignalsAction::Open(folder.join("capture.csv"))));
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size([1280.0, 800.0]),
        renderer: eframe::Renderer::Glow,
        ..Default::default()
    };
    let look = ThemeData::built_in().unwrap();
    eframe::run_native(
        "plot",
        options,
        Box::new(move |cc| {
            install_fonts(&cc.egui_ctx);
            Ok(Box::new(PlottingApp { window: Window::new(studio, look, program().tabs), times: Vec::new() }))
        }),
    )
    .unwrap();
}

/// Runs an empty window as a baseline. It shows the minimum cost of eframe, the driver and the X server.
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

fn first_frame_time(log: &str) -> Option<u64> {
    let (_, rest) = log.split_once("first picture after ")?;
    rest.split_once(" ms")?.0.parse().ok()
}

fn wait_for(look: impl FnMut() -> Option<u64>) -> u64 {
    wait_for_up_to(Duration::from_secs(20), look)
}

fn wait_for_up_to(patience: Duration, mut look: impl FnMut() -> Option<u64>) -> u64 {
    let began = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(began.elapsed() < patience, "nothing in {patience:?}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Returns the resident memory of a process in megabytes.
fn resident_mb(process: u32) -> f64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    kilobytes.trim().trim_end_matches(" kB").parse::<f64>().unwrap() * 1.024e-3
}

/// Returns the CPU usage of a child process over ten seconds, in percent of one core.
fn cpu_percent(child: &Child) -> f64 {
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

/// The display of the desktop session, or a virtual one.
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
