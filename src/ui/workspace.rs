//! The workspace: what the open tab shows of the session that is shown.

use egui::{Align, Layout, RichText, Ui};

use super::controls::{button, empty, paragraph, spinner};
use super::page::apart;
use super::panels::plot_ui;
use super::{Skin, Views, icons};
use crate::app::connect;
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, Studio, Tab, Wish};
use crate::devices::biss::views as biss;
use crate::devices::hiperdrive::views as hiperdrive;
use crate::devices::hiperface::views as hiperface;
use crate::devices::interbus::views as interbus;
use crate::devices::ssi::views as ssi;
use crate::signals::views as signals;

/// Draws the workspace.
pub(super) fn workspace_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    if views.plot.is_large()
        && let Some(device) = studio.shown()
    {
        let margin = egui::Margin::same(skin.space.groups as i8);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| plot_ui(ui, skin, device, views, actions));
        return;
    }
    match studio.settings.tab {
        Tab::Hiperface => hiperface_ui(ui, skin, studio, views, actions),
        Tab::Biss => biss_ui(ui, skin, studio, views, actions),
        Tab::Ssi => ssi_ui(ui, skin, studio, views, actions),
        Tab::Interbus => interbus_ui(ui, skin, studio, views, actions),
        Tab::Hiperdrive => hiperdrive_ui(ui, skin, studio, views, actions),
        Tab::Signals => {
            signals::page_ui(ui, skin, &studio.signals, studio.sine_cosine(), &mut views.signals, actions);
        }
    }
}

fn hiperface_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let (Some(encoder), Some(device)) = (studio.hiperface(), studio.shown()) else {
        return nothing(ui, skin, studio, actions);
    };
    running(ui, skin, device, None, actions);
    lost(ui, skin, device, actions);
    apart(ui, "page", |ui| hiperface::page_ui(ui, skin, (studio, device), encoder, views.hiperface(encoder), actions));
}

fn biss_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let (Some(encoder), Some(device)) = (studio.biss(), studio.shown()) else {
        return nothing(ui, skin, studio, actions);
    };
    let view = views.biss(encoder);
    let is_led = encoder.guide.as_ref().is_some_and(|guide| guide.is_running()) && view.page == biss::Page::Procedures;
    // How far it is stands below, step by step: here, what ending it does.
    let instead = is_led.then(|| skin.say("guide.cancel_note"));
    running(ui, skin, device, instead, actions);
    lost(ui, skin, device, actions);
    apart(ui, "page", |ui| biss::page_ui(ui, skin, (studio, device), encoder, view, actions));
}

fn ssi_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let (Some(encoder), Some(device)) = (studio.ssi(), studio.shown()) else {
        return nothing(ui, skin, studio, actions);
    };
    lost(ui, skin, device, actions);
    apart(ui, "page", |ui| ssi::page_ui(ui, skin, (studio, device), encoder, views.ssi(encoder), actions));
}

fn interbus_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let (Some(encoder), Some(device)) = (studio.interbus(), studio.shown()) else {
        return nothing(ui, skin, studio, actions);
    };
    running(ui, skin, device, None, actions);
    lost(ui, skin, device, actions);
    apart(ui, "page", |ui| interbus::page_ui(ui, skin, (studio, device), encoder, views.interbus(encoder), actions));
}

fn hiperdrive_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let (Some(unit), Some(device)) = (studio.hiperdrive(), studio.shown()) else {
        return nothing(ui, skin, studio, actions);
    };
    // Below, so that nothing moves away under the finger that holds a drive.
    if device.running().is_some() && !device.is_reviewing() {
        egui::Panel::bottom(egui::Id::unique(device.id()).with("hiperdrive_running"))
            .frame(egui::Frame::NONE.inner_margin(egui::Margin { left: 0, right: 0, top: 0, bottom: 8 }))
            .show_separator_line(false)
            .show(ui, |ui| running(ui, skin, device, None, actions));
    }
    lost(ui, skin, device, actions);
    apart(ui, "page", |ui| hiperdrive::page_ui(ui, skin, (studio, device), unit, views.hiperdrive(unit), actions));
}

/// No device is on the desk: the ways to one.
fn nothing(ui: &mut Ui, skin: &Skin, studio: &Studio, actions: &mut Vec<Action>) {
    if empty(ui, skin, &skin.say("shell.empty"), Some((icons::PLUGS_CONNECTED, &skin.say("shell.connect"), true))) {
        actions.push(Action::Connect(connect::Action::Open));
    }
    ui.vertical_centered(|ui| {
        if button(ui, icons::PLAY, &skin.say("shell.virtual_device")).clicked() {
            actions.push(Action::OpenVirtual);
        }
        if button(ui, icons::FOLDER_OPEN, &skin.say("profile_card.open")).clicked() {
            actions.push(Action::AskOpen);
        }
        // A layout needs no device.
        if studio.settings.tab == Tab::Ssi && button(ui, icons::PLUS, &skin.say("ssi.new_layout")).clicked() {
            actions.push(Action::NewLayout);
        }
    });
}

/// What runs, how far it is, or what is to be known `instead`, and a way to end it.
fn running(ui: &mut Ui, skin: &Skin, device: &AnyDevice, instead: Option<String>, actions: &mut Vec<Action>) {
    let opening = *device.phase() == Phase::Opening;
    let running = device.running();
    // A review that is open says how far it is by itself.
    if !opening && (running.is_none() || device.is_reviewing()) {
        return;
    }
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal(|ui| {
            spinner(ui, skin);
            let is_told_below = instead.is_some();
            let words = match &running {
                _ if is_told_below => instead.unwrap_or_default(),
                Some(running) => {
                    let what = skin.words(&running.what);
                    match &running.progress {
                        Some((done, total, doing)) => format!("{what}  {done}/{total}  {}", skin.words(doing)),
                        None => what,
                    }
                }
                None => skin.say("shell.opening"),
            };
            // What is pressed stays where it is, however long the words are.
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if let Some(running) = running {
                    let stopping = running.stopping;
                    let word = skin.say(if stopping { "shell.stopping" } else { "shell.cancel" });
                    if super::controls::enabled_button(ui, !stopping, icons::X, &word).clicked() {
                        actions.push(Action::Stop);
                    }
                    if let Some((done, total, _)) = running.progress.filter(|_| !is_told_below) {
                        let part = done as f32 / total.max(1) as f32;
                        ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(120.0));
                    }
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(egui::Label::new(skin.label(words)).truncate());
                });
            });
        });
    });
}

/// Why there is no connection, and the way back.
fn lost(ui: &mut Ui, skin: &Skin, device: &AnyDevice, actions: &mut Vec<Action>) {
    let (Phase::Lost(why) | Phase::Silent(why)) = device.phase() else { return };
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::PLUGS).color(skin.palette.bad));
            paragraph(ui, skin.words(why));
        });
        ui.horizontal_wrapped(|ui| {
            if device.is_dirty() {
                ui.label(RichText::new(skin.say("shell.edits_kept")).color(skin.palette.staged));
            }
            let silent = matches!(device.phase(), Phase::Silent(_));
            if silent
                && super::controls::enabled_button(
                    ui,
                    device.is_readable(),
                    icons::ARROW_CLOCKWISE,
                    &skin.say("memory.read"),
                )
                .clicked()
            {
                actions.push(device.wish(Wish::Read));
            }
            if !silent && button(ui, icons::ARROW_CLOCKWISE, &skin.say("shell.reconnect")).clicked() {
                actions.push(device.wish(Wish::Reconnect));
            }
            if button(ui, icons::PLUGS_CONNECTED, &skin.say("shell.connect")).clicked() {
                actions.push(Action::Connect(connect::Action::Open));
            }
        });
    });
}
