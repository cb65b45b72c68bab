//! The line at the bottom of the window. Its space is reserved, so nothing moves when a message appears. It displays
//! the notice, the reason why there is no connection, or the running job. Otherwise, it displays the last frame or
//! message. Its buttons open the lower panel.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, Layout, Panel, RichText, Sense, TextStyle, Ui, UiBuilder, vec2};

use super::controls::{enabled_button, icon_button, labelled_button, severity, spinner};
use super::page::with_stable_ids;
use super::views::device_in_tab;
use super::{Theme, Views, icons};
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, DeviceCommand, Notice, Studio, TraceFault, TraceLine, TraceLog, connect};
use crate::link::Direction;

/// Height of the status line, which fits two lines of small text.
const BAR_HEIGHT: f32 = 36.0;
/// Fraction of the width for the running job while a notice is displayed next to it.
const JOB_WIDTH_SHARE: f32 = 0.45;
const TIME: &str = "%H:%M:%S%.3f";

pub(super) fn status_line_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let margin = egui::Margin { left: 8, right: 12, top: 0, bottom: 0 };
    let frame = egui::Frame::NONE.fill(theme.palette.raised.into()).inner_margin(margin);
    let line = Panel::bottom("status").exact_size(BAR_HEIGHT).frame(frame).show(ui, |ui| {
        let whole = UiBuilder::new().sense(Sense::click());
        let response = ui.scope_builder(whole, |ui| {
            ui.horizontal_centered(|ui| {
                chevron_ui(ui, theme, studio, actions);
                let size = vec2(ui.available_width(), ui.available_height());
                ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
                    line_ui(ui, theme, studio, views, actions);
                });
            });
        });
        if response.response.clicked() {
            actions.push(match studio.services.log.current() {
                Some(_) => Action::Dismiss,
                None => Action::OpenLowerPanel(!studio.settings.lower_open),
            });
        }
    });
    if let Some(notice) = studio.services.log.current() {
        let (_, colour) = severity(theme, notice.severity);
        let place = line.response.rect;
        ui.painter().hline(place.x_range(), place.top(), egui::Stroke::new(2.0, colour));
    }
}

fn chevron_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let open = studio.settings.lower_open;
    let (icon, word) =
        if open { (icons::CARET_DOWN, "status_line.close") } else { (icons::CARET_RIGHT, "status_line.open") };
    if icon_button(ui, true, icon, &theme.translate(word)).clicked() {
        actions.push(Action::OpenLowerPanel(!open));
    }
}

/// Draws the status line from right to left, so the buttons keep their position regardless of the length of the text.
fn line_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let notice = studio.services.log.current();
    let device = device_in_tab(studio, studio.settings.tab);
    with_stable_ids(ui, "dismiss", |ui| match notice {
        Some(_) => {
            if icon_button(ui, true, icons::X, &theme.translate("shell.dismiss")).clicked() {
                actions.push(Action::Dismiss);
            }
        }
        None => {
            ui.allocate_exact_size(vec2(28.0, 28.0), Sense::hover());
        }
    });
    let works = device.filter(|device| has_running_job(*device));
    let lost = device.and_then(connection_problem);
    with_stable_ids(ui, "activity", |ui| {
        if let Some(device) = works {
            let share = if notice.is_some() { JOB_WIDTH_SHARE } else { 1.0 };
            let size = vec2(ui.available_width() * share, ui.available_height());
            ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
                if let Some(session) = views.session(device) {
                    session.running_ui(ui, theme, device, actions);
                }
            });
        } else if let Some((device, _)) = lost {
            reconnect_buttons_ui(ui, theme, device, actions);
        }
    });
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| match (notice, lost) {
        (Some(notice), _) => notice_ui(ui, theme, notice),
        (None, Some((device, why))) => {
            let mut words = theme.format_text(why);
            if device.is_dirty() {
                words = format!("{words} {}", theme.translate("shell.edits_kept"));
            }
            ui.label(RichText::new(icons::PLUGS).size(theme.sizes.section).color(theme.palette.bad));
            message(ui, theme, words, theme.palette.text.into());
        }
        (None, None) if works.is_none() && !studio.settings.lower_open => latest_message_ui(ui, theme, studio),
        (None, None) => {}
    });
}

/// Returns whether a job is running or a link is being opened. A job with an open review dialog does not count, because
/// the dialog shows its progress.
fn has_running_job(device: &AnyDevice) -> bool {
    *device.phase() == Phase::Opening || device.running_job().is_some() && !device.is_reviewing()
}

/// Returns the device, and the reason why its connection was lost or why it does not reply.
fn connection_problem(device: &AnyDevice) -> Option<(&AnyDevice, &crate::app::Text)> {
    match device.phase() {
        Phase::Lost(why) | Phase::Silent(why) => Some((device, why)),
        Phase::Opening | Phase::Connected | Phase::Offline => None,
    }
}

/// Draws the buttons for reconnecting, in reverse order.
fn reconnect_buttons_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    if labelled_button(ui, icons::PLUGS_CONNECTED, &theme.translate("shell.connect")).clicked() {
        actions.push(Action::Connect(connect::ConnectAction::Open));
    }
    if matches!(device.phase(), Phase::Silent(_)) {
        let word = theme.translate("memory.read");
        if enabled_button(ui, device.is_readable(), icons::ARROW_CLOCKWISE, &word).clicked() {
            actions.push(device.command(DeviceCommand::Read));
        }
    } else if labelled_button(ui, icons::ARROW_CLOCKWISE, &theme.translate("shell.reconnect")).clicked() {
        actions.push(device.command(DeviceCommand::Reconnect));
    }
}

fn notice_ui(ui: &mut Ui, theme: &Theme, notice: &Notice) {
    let (icon, colour) = severity(theme, notice.severity);
    ui.label(RichText::new(icon).size(theme.sizes.section).color(colour));
    message(ui, theme, notice_text(theme, notice), theme.palette.text.into());
}

fn notice_text(theme: &Theme, notice: &Notice) -> String {
    let words: Vec<String> = notice.texts.iter().map(|text| theme.format_text(text)).collect();
    format!("{}{}", notice.device_prefix(|text| theme.format_text(text)), words.join(" "))
}

/// Draws a message in the remaining space, in small text on two lines if it does not fit on one.
fn message(ui: &mut Ui, theme: &Theme, words: String, colour: Color32) {
    let body = TextStyle::Body.resolve(ui.style());
    let width = ui.painter().layout_no_wrap(words.clone(), body.clone(), colour).size().x;
    if width <= ui.available_width() {
        ui.label(RichText::new(words).color(colour));
        return;
    }
    let small = TextFormat::simple(TextStyle::Small.resolve(ui.style()), colour);
    let mut job = LayoutJob::single_section(words, small);
    job.wrap.max_rows = 2;
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    ui.add(egui::Label::new(job).wrap().selectable(false));
}

/// Draws the last frame of the displayed device, or the last message if that is newer.
fn latest_message_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    let frame = studio.selected_device().and_then(|device| Some((device.trace(), last_frame_line(device.trace())?)));
    let frame = frame.and_then(|(trace, line)| Some((trace.line_time(line)?, line)));
    let message = studio.services.log.notices().next_back();
    match (frame, message) {
        (Some((at, line)), message) if message.is_none_or(|message| message.at <= at) => {
            frame_ui(ui, theme, &at.strftime(TIME).to_string(), line);
        }
        (_, Some(notice)) => {
            let (icon, colour) = severity(theme, notice.severity);
            let time = notice.at.strftime(TIME).to_string();
            ui.label(theme.monospace(time).size(theme.sizes.caption).color(theme.palette.muted));
            ui.label(RichText::new(icon).color(colour));
            let words = theme.label(notice_text(theme, notice));
            ui.add(egui::Label::new(words).truncate());
        }
        (_, None) => {
            ui.label(theme.label(theme.translate("log.nothing")));
        }
    }
}

/// Returns the last reply if it is one of the last two frames, and the last frame otherwise. The status line thus does
/// not alternate between requests and replies.
fn last_frame_line(trace: &TraceLog) -> Option<&TraceLine> {
    let mut newest = trace.lines().iter().rev().take(2);
    let is_reply = |line: &&TraceLine| line.direction == Direction::Received;
    newest.find(is_reply).or_else(|| trace.lines().back())
}

fn frame_ui(ui: &mut Ui, theme: &Theme, time: &str, line: &TraceLine) {
    let palette = theme.palette;
    let arrow = if line.direction == Direction::Sent { "→" } else { "←" };
    let colour = match line.fault {
        Some(TraceFault::Broken) => palette.bad,
        Some(TraceFault::Reported) => palette.warn,
        None => palette.muted,
    };
    ui.label(theme.monospace(time).size(theme.sizes.caption).color(palette.muted));
    ui.label(theme.monospace(arrow).color(palette.accent));
    let most = (ui.available_width() * 0.4).max(0.0);
    ui.scope(|ui| {
        ui.set_max_width(most);
        ui.add(egui::Label::new(theme.monospace(&line.bytes).color(colour)).truncate());
    });
    ui.add(egui::Label::new(RichText::new(line.to_string_in(theme.language)).color(colour)).truncate());
}

/// Draws the running job and the stop button, right-aligned. `instead` replaces the job's title and progress if given.
pub(crate) fn running_ui(
    ui: &mut Ui,
    theme: &Theme,
    device: &AnyDevice,
    instead: Option<String>,
    actions: &mut Vec<Action>,
) {
    let running = device.running_job();
    let is_told_below = instead.is_some();
    let words = match &running {
        _ if is_told_below => instead.unwrap_or_default(),
        Some(running) => {
            let what = theme.format_text(&running.title);
            match &running.progress {
                Some((done, total, doing)) => format!("{what}  {done}/{total}  {}", theme.format_text(doing)),
                None => what,
            }
        }
        None => theme.translate("shell.opening"),
    };
    if let Some(running) = running {
        let stopping = running.stopping;
        let word = theme.translate(if stopping { "shell.stopping" } else { "shell.cancel" });
        if enabled_button(ui, !stopping, icons::X, &word).clicked() {
            actions.push(Action::Stop);
        }
        if let Some((done, total, _)) = running.progress.filter(|_| !is_told_below) {
            let part = done as f32 / total.max(1) as f32;
            ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(120.0));
        }
    }
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        spinner(ui, theme);
        ui.add(egui::Label::new(theme.label(words)).truncate());
    });
}
