//! The workspace: the selected session in the open tab.

use egui::{Align, Layout, RichText, Ui};

use super::controls::{button, empty, paragraph, spinner};
use super::device_view::DeviceView;
use super::page::apart;
use super::panels::plot_ui;
use super::views::shown_in;
use super::{Theme, Views, icons};
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, DeviceCommand, Studio, connect};

pub(super) fn workspace_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    if views.plot.is_large()
        && let Some(device) = studio.selected_device()
    {
        let margin = egui::Margin::same(theme.space.groups as i8);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| plot_ui(ui, theme, device, views, actions));
        return;
    }
    let tab = studio.settings.tab;
    if let Some(tool) = views.tool(tab) {
        tool.page_ui(ui, theme, studio, actions);
        return;
    }
    let Some(device) = shown_in(studio, tab) else {
        return nothing(ui, theme, views.tabs.device(tab), actions);
    };
    let Some(session) = views.session(device) else { return };
    session.running_ui(ui, theme, device, actions);
    lost(ui, theme, device, actions);
    apart(ui, "page", |ui| session.page_ui(ui, theme, (studio, device), actions));
}

/// Draws the ways to open a device if none is open.
fn nothing(ui: &mut Ui, theme: &Theme, view: Option<&dyn DeviceView>, actions: &mut Vec<Action>) {
    if empty(ui, theme, &theme.say("shell.empty"), Some((icons::PLUGS_CONNECTED, &theme.say("shell.connect"), true))) {
        actions.push(Action::Connect(connect::ConnectAction::Open));
    }
    ui.vertical_centered(|ui| {
        if button(ui, icons::PLAY, &theme.say("shell.virtual_device")).clicked() {
            actions.push(Action::OpenVirtual);
        }
        if button(ui, icons::FOLDER_OPEN, &theme.say("profile_card.open")).clicked() {
            actions.push(Action::AskOpen);
        }
        if let Some(view) = view {
            view.empty_ui(ui, theme, actions);
        }
    });
}

/// Draws the running job with its progress, or `instead`, and the button that stops it.
pub(crate) fn running_ui(
    ui: &mut Ui,
    theme: &Theme,
    device: &AnyDevice,
    instead: Option<String>,
    actions: &mut Vec<Action>,
) {
    let opening = *device.phase() == Phase::Opening;
    let running = device.running();
    // An open review shows its own progress.
    if !opening && (running.is_none() || device.is_reviewing()) {
        return;
    }
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal(|ui| {
            spinner(ui, theme);
            let is_told_below = instead.is_some();
            let words = match &running {
                _ if is_told_below => instead.unwrap_or_default(),
                Some(running) => {
                    let what = theme.words(&running.title);
                    match &running.progress {
                        Some((done, total, doing)) => format!("{what}  {done}/{total}  {}", theme.words(doing)),
                        None => what,
                    }
                }
                None => theme.say("shell.opening"),
            };
            // The button stays in place, however long the text is.
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if let Some(running) = running {
                    let stopping = running.stopping;
                    let word = theme.say(if stopping { "shell.stopping" } else { "shell.cancel" });
                    if super::controls::enabled_button(ui, !stopping, icons::X, &word).clicked() {
                        actions.push(Action::Stop);
                    }
                    if let Some((done, total, _)) = running.progress.filter(|_| !is_told_below) {
                        let part = done as f32 / total.max(1) as f32;
                        ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(120.0));
                    }
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(theme.label(words)).truncate());
                });
            });
        });
    });
}

/// Draws why there is no connection, and the button to reconnect.
fn lost(ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    let (Phase::Lost(why) | Phase::Silent(why)) = device.phase() else { return };
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::PLUGS).color(theme.palette.bad));
            paragraph(ui, theme.words(why));
        });
        ui.horizontal_wrapped(|ui| {
            if device.is_dirty() {
                ui.label(RichText::new(theme.say("shell.edits_kept")).color(theme.palette.staged));
            }
            let silent = matches!(device.phase(), Phase::Silent(_));
            if silent
                && super::controls::enabled_button(
                    ui,
                    device.is_readable(),
                    icons::ARROW_CLOCKWISE,
                    &theme.say("memory.read"),
                )
                .clicked()
            {
                actions.push(device.command(DeviceCommand::Read));
            }
            if !silent && button(ui, icons::ARROW_CLOCKWISE, &theme.say("shell.reconnect")).clicked() {
                actions.push(device.command(DeviceCommand::Reconnect));
            }
            if button(ui, icons::PLUGS_CONNECTED, &theme.say("shell.connect")).clicked() {
                actions.push(Action::Connect(connect::ConnectAction::Open));
            }
        });
    });
}
