//! Opens the window. Without a display, a one-line error is reported.

use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Instant;

use super::live_pace::processor_time;
use super::renderer::renderers_to_try;
use super::{TabViews, Window, install_fonts, termination};
use crate::app::{KindRegistry, Studio, StudioEnvironment, ThemeData, WakeCallback, explain};
use crate::cli::Window as Start;
use crate::store::{LogFile, Store};

/// Opens the window with the given kinds of devices and tabs. Returns when the window is closed.
///
/// # Errors
/// Returns a one-line reason if the window could not be opened.
pub fn run(start: Start, kinds: KindRegistry, tabs: TabViews) -> Result<(), String> {
    open(start, kinds, tabs).inspect_err(|why| show_without_terminal(why))
}

fn open(start: Start, kinds: KindRegistry, tabs: TabViews) -> Result<(), String> {
    let began = Instant::now();
    if !has_display() {
        return Err(NO_DISPLAY_MESSAGE.to_owned());
    }
    let store = Store::for_user().map_err(|error| explain::store_error_text(&error).terminal_text())?;
    let log = LogFile::start(&store.log_path());
    let cleaned = store.clone();
    // The program does not wait for this, so a slow disk does not delay the window.
    thread::spawn(move || cleaned.remove_leftovers());
    let look = ThemeData::built_in().map_err(|why| format!("assets/theme.ron: {why}"))?;
    // The window is created after the application state. Until then, no window has to be woken.
    let context: Arc<OnceLock<egui::Context>> = Arc::default();
    let waker = context.clone();
    let wake: WakeCallback = Arc::new(move || {
        if let Some(context) = waker.get() {
            context.request_repaint();
        }
    });
    let mut studio =
        Studio::new(StudioEnvironment { given: start.given, ..StudioEnvironment::production(store, kinds) }, wake);
    let (width, height) = studio.settings.size.unwrap_or((1280, 800));
    studio.start_with(start.link, start.profile);
    termination::install_handlers(&studio);
    let options = |renderer| eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("encoder-studio")
            .with_app_id("encoder-studio")
            .with_icon(icon())
            .with_inner_size([width as f32, height as f32])
            .with_min_inner_size([880.0, 500.0])
            .with_drag_and_drop(true),
        renderer,
        ..eframe::NativeOptions::default()
    };
    // If a renderer fails, the next one uses these parts.
    let mut parts = Some((studio, look, tabs));
    let mut result = Err(NOT_OPENED.to_owned());
    for renderer in renderers_to_try() {
        let create: eframe::AppCreator<'_> = Box::new(|cc| {
            let (studio, look, tabs) = parts.take().ok_or("the window exists already")?;
            install_fonts(&cc.egui_ctx);
            let _ = context.set(cc.egui_ctx.clone());
            let window = Window::new(studio, look, tabs).with_processor_time(processor_time);
            Ok(Box::new(StudioApp { window, began: Some(began) }))
        });
        match eframe::run_native("encoder-studio", options(renderer), create) {
            Ok(()) => result = Ok(()),
            // The messages of the library are meant for programmers and contain paths of the build computer.
            Err(error) => tracing::error!("{renderer}: {error}"),
        }
        if parts.is_none() {
            break;
        }
    }
    if let Ok(log) = log {
        log.wait_until_written();
    }
    result
}

/// Returns the window icon. Wayland instead uses the icon of the desktop entry that has the same name as the app id.
fn icon() -> egui::IconData {
    eframe::icon_data::from_png_bytes(ICON).unwrap_or_default()
}

/// The application window, run by eframe.
pub(crate) struct StudioApp {
    window: Window,
    /// Start time of the program, or `None` after the first frame has been shown.
    began: Option<Instant>,
}

impl eframe::App for StudioApp {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.window.logic(ctx);
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        self.window.split_input(ctx, input);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        // When the second frame begins, the first one is on the screen.
        if ui.ctx().cumulative_frame_nr() > 0
            && let Some(began) = self.began.take()
        {
            tracing::info!("first picture after {} ms", began.elapsed().as_millis());
        }
        if self.began.is_some() {
            ui.ctx().request_repaint();
        }
        self.window.draw(ui);
    }
}

const ICON: &[u8] = include_bytes!("../../assets/icon/64.png");
const NO_DISPLAY_MESSAGE: &str = "There is no display for the window (DISPLAY and WAYLAND_DISPLAY are not set); without one: \
                          encoder-studio identify, status, position, save, diff, restore, verify, read, write, do, \
                          find, decode, analyse, simulate, ports (see encoder-studio help).";
#[cfg(windows)]
const NOT_OPENED: &str = "The window cannot be opened: neither OpenGL 2 nor Direct3D 12 can draw it (the log file says \
                          more). Install the driver of the graphics card; without a window: encoder-studio help.";
#[cfg(not(windows))]
const NOT_OPENED: &str = "The window cannot be opened: the display does not answer, or a run-time package is missing (the \
                          README lists them; the log file says more). Without a window: encoder-studio help.";

/// Shows a message in a system dialog if the program was started without a terminal.
#[cfg(windows)]
fn show_without_terminal(message: &str) {
    use std::os::windows::io::AsRawHandle as _;
    if std::io::stderr().as_raw_handle().is_null() {
        let dialog = rfd::MessageDialog::new().set_level(rfd::MessageLevel::Error);
        dialog.set_title("encoder-studio").set_description(message).show();
    }
}

/// Does nothing. On other systems, the desktop logs the message.
#[cfg(not(windows))]
const fn show_without_terminal(_message: &str) {}

fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || set("DISPLAY") || set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET")
}
