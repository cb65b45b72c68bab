//! The Live panel, which shows the position in large digits and a plot of its recording.

use std::time::Duration;

use egui::{RichText, Ui};

use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, DeviceCommand, RecorderOwner, Rgb, Studio, Text};
use crate::ui::controls::{dropdown, empty_placeholder, enabled_button, icon_button, label_width, name, row};
use crate::ui::page::with_stable_ids;
use crate::ui::{Theme, Views, icons, plot};

/// Selectable polling intervals in microseconds. At zero, each poll begins as soon as the previous one has ended.
const RATES: [(u64, &str); 4] =
    [(0, "live.fastest"), (50_000, "live.every_50"), (200_000, "live.every_200"), (1_000_000, "live.every_1000")];
/// Selectable sample intervals of a streaming adapter, in microseconds.
const STREAM_INTERVALS: [(u64, &str); 3] =
    [(50, "live.stream_20k"), (200, "live.stream_5k"), (1_000, "live.stream_1k")];
/// Polling interval in microseconds if the chosen one is not available.
const DEFAULT_INTERVAL_US: u64 = 50_000;

/// Panel height in points below which the numbers beside the position share one line.
pub(crate) const LOW_PANEL_HEIGHT: f32 = 460.0;

/// Minimum width of the rate selector, in points.
const MIN_RATE_WIDTH: f32 = 64.0;
/// Minimum width of the panel in points at which the first button has a label.
const ONE_ROW: f32 = 280.0;

/// Time in seconds after which an unchanged position is marked as paused.
const STALE_POSITION_DELAY_S: f32 = 0.4;

pub(in crate::ui) fn live_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let Some(device) = studio.selected_device() else {
        empty_placeholder(ui, theme, &theme.translate("live.nothing"), None);
        return;
    };
    let paused = is_paused(ui, device);
    let ink = if device.is_polling() && !paused { theme.palette.text } else { theme.palette.muted };
    if let Some(view) = views.tabs.device(device.tab()) {
        view.value_ui(ui, theme, device, ink);
    }
    pause_ui(ui, theme, device, paused);
    let alone = studio.settings.values_alone;
    with_stable_ids(ui, "controls", |ui| controls_ui(ui, theme, (device, alone), views, actions));
    ui.add_space(theme.space.between);
    if !alone && !views.plot.is_expanded() {
        with_stable_ids(ui, "plot", |ui| plot_ui(ui, theme, device, views, actions));
    }
}

/// Draws the reason why the values are paused. Its space is always reserved, so the content below does not move.
fn pause_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, paused: bool) {
    let size = egui::vec2(ui.available_width().max(0.0), theme.sizes.caption + theme.space.inside);
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_size(size);
        if let Some(running) = device.running_job().filter(|_| paused) {
            let text = Text::new("live.paused_by_job").with_text("job", running.title);
            ui.add(egui::Label::new(theme.caption(theme.format_text(&text))).truncate());
        }
    });
}

/// Returns whether a job keeps the position from being read. Very short jobs are ignored, because the number would
/// flicker.
fn is_paused(ui: &Ui, device: &AnyDevice) -> bool {
    let waits = device.is_polling() && device.is_busy();
    let id = egui::Id::unique(device.id()).with("job_pause");
    // The animation runs even without a job, so the next job starts from zero.
    let share = ui.ctx().animate_bool_with_time(id, waits, if waits { STALE_POSITION_DELAY_S } else { 0.0 });
    waits && share >= 1.0
}

pub(in crate::ui) fn plot_ui(
    ui: &mut Ui,
    theme: &Theme,
    device: &AnyDevice,
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let empty = theme.translate(if device.is_connected() { "live.no_curve" } else { "live.nothing" });
    let owner = RecorderOwner::Device(device.id());
    plot::plot_ui(ui, theme, device.recorder(), owner, &mut views.plot, &empty, actions);
    let dropped = device.dropped_count();
    if dropped > 0 {
        let text = Text::new("live.dropped").with("count", dropped);
        ui.label(RichText::new(theme.format_text(&text)).size(theme.sizes.caption).color(theme.palette.warn));
    }
}

/// Draws a short remark next to the position. It is truncated at the edge of the panel, so the panel never becomes
/// wider than the window.
pub(crate) fn remark_ui(ui: &mut Ui, theme: &Theme, word: &'static str, ink: Rgb) {
    ui.add(egui::Label::new(RichText::new(theme.translate(word)).color(ink)).truncate());
}

/// Draws placeholder rows until a position has been read, so the buttons below do not move later.
pub(crate) fn unknown_rows(ui: &mut Ui, theme: &Theme, labels: &[&'static str]) {
    const UNKNOWN: &str = "–";
    if ui.available_height() < LOW_PANEL_HEIGHT {
        ui.label(theme.caption(UNKNOWN));
        return;
    }
    for label in labels {
        row(ui, theme, &theme.translate(label), theme.monospace(UNKNOWN));
    }
}

/// Draws the position as sent by the device. It is drawn in a smaller font if it does not fit on one line.
pub(crate) fn raw_row(ui: &mut Ui, theme: &Theme, value: String) {
    let value = theme.monospace(value);
    let room = ui.available_width() - label_width(ui) - ui.spacing().item_spacing.x;
    let text = egui::WidgetText::from(value.clone());
    let galley = text.into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, egui::TextStyle::Monospace);
    let value = if galley.size().x > room { value.size(theme.sizes.caption) } else { value };
    row(ui, theme, &theme.translate("live.raw"), value);
}

fn controls_ui(
    ui: &mut Ui,
    theme: &Theme,
    (device, alone): (&AnyDevice, bool),
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let connected = *device.phase() == Phase::Connected;
    let polling = device.is_polling();
    let streams = if device.can_stream() { &STREAM_INTERVALS[..] } else { &[] };
    let rates: Vec<(u64, String)> =
        streams.iter().chain(&RATES).map(|(every, id)| (*every, theme.translate(id))).collect();
    let mut rate =
        Some(views.rate).filter(|rate| rates.iter().any(|(own, _)| own == rate)).unwrap_or(DEFAULT_INTERVAL_US);
    ui.horizontal_wrapped(|ui| {
        // At the usual width, they fit in one row.
        ui.spacing_mut().item_spacing.x = theme.space.inside;
        ui.spacing_mut().combo_width = MIN_RATE_WIDTH;
        let button = if ui.available_width() < ONE_ROW { icon_button } else { enabled_button };
        if polling {
            if button(ui, true, icons::PAUSE, &theme.translate("live.pause")).clicked() {
                actions.push(device.command(DeviceCommand::Poll(None)));
            }
        } else if button(ui, connected, icons::PLAY, &theme.translate("live.start")).clicked() {
            actions.push(device.command(DeviceCommand::Poll(Some(Duration::from_micros(rate)))));
        }
        if icon_button(ui, device.is_ready(), icons::ARROW_CLOCKWISE, &theme.translate("live.once")).clicked() {
            actions.push(device.command(DeviceCommand::ReadPosition));
        }
        if let Some(session) = views.session(device) {
            session.watch_menu(ui, theme, device, actions);
        }
        let word = theme.translate(if alone { "live.show_plot" } else { "live.hide_plot" });
        let plot = egui::Button::selectable(!alone, icons::CHART_LINE).min_size(egui::vec2(28.0, 28.0));
        if name(ui.add(plot), true, &word).on_hover_text(&word).clicked() {
            actions.push(Action::ShowValuesAlone(!alone));
        }
        if dropdown(ui, &theme.translate("live.rate"), &mut rate, rates) {
            views.rate = rate;
            if polling {
                actions.push(device.command(DeviceCommand::Poll(Some(Duration::from_micros(rate)))));
            }
        }
    });
}
