//! The workspace: what the open tab shows of the session that is shown.

use egui::{RichText, Ui};

use super::controls::{button, empty, paragraph, spinner};
use super::panels::plot_ui;
use super::{Skin, Views, hiperface, icons, signals};
use crate::app::hiperface::{Action as Hiperface, Encoder, Phase};
use crate::app::{Action, Studio, Tab};
use crate::app::{connect, explain};

/// Draws the workspace.
pub(super) fn workspace_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    if views.plot.is_large()
        && let Some(encoder) = studio.encoder()
    {
        let margin = egui::Margin::same(skin.space.groups as i8);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| plot_ui(ui, skin, encoder, views, actions));
        return;
    }
    match studio.settings.tab {
        Tab::Hiperface => hiperface_ui(ui, skin, studio, views, actions),
        Tab::Signals => {
            signals::page_ui(ui, skin, &studio.signals, studio.encoder(), &mut views.signals, actions);
        }
    }
}

fn hiperface_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let Some(encoder) = studio.encoder() else {
        if empty(ui, skin, &skin.say("shell.empty"), Some((icons::PLUGS_CONNECTED, &skin.say("shell.connect"), true))) {
            actions.push(Action::Connect(connect::Action::Open));
        }
        ui.vertical_centered(|ui| {
            if button(ui, icons::FOLDER_OPEN, &skin.say("profile_card.open")).clicked() {
                actions.push(Action::AskOpen);
            }
        });
        return;
    };
    running(ui, skin, encoder, actions);
    lost(ui, skin, encoder, actions);
    hiperface::page_ui(ui, skin, studio, encoder, views.hiperface(encoder), actions);
}

/// What runs, how far it is, and a way to end it.
fn running(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let opening = encoder.phase == Phase::Opening;
    let running = encoder.line().and_then(|line| line.running());
    if !opening && running.is_none() {
        return;
    }
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal(|ui| {
            spinner(ui, skin);
            let words = match running {
                Some(running) => {
                    let what = skin.words(&running.what);
                    match &running.progress {
                        Some(progress) => {
                            let doing = skin.words(&explain::hiperface::doing(&progress.what));
                            format!("{what}  {}/{}  {doing}", progress.done, progress.total)
                        }
                        None => what,
                    }
                }
                None => skin.say("shell.opening"),
            };
            ui.label(skin.label(words));
            if let Some(running) = running {
                let stopping = running.stopping;
                let word = skin.say(if stopping { "shell.stopping" } else { "shell.cancel" });
                if super::controls::enabled_button(ui, !stopping, icons::X, &word).clicked() {
                    actions.push(Action::Stop);
                }
                if let Some(progress) = &running.progress {
                    let part = progress.done as f32 / progress.total.max(1) as f32;
                    ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(120.0));
                }
            }
        });
    });
}

/// Why there is no connection, and the way back.
fn lost(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let (Phase::Lost(why) | Phase::Silent(why)) = &encoder.phase else { return };
    let margin = egui::Margin { left: 24, right: 24, top: 8, bottom: 0 };
    egui::Frame::NONE.inner_margin(margin).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::PLUGS).color(skin.palette.bad));
            paragraph(ui, skin.words(why));
        });
        ui.horizontal_wrapped(|ui| {
            if encoder.staged.is_dirty() {
                ui.label(RichText::new(skin.say("shell.edits_kept")).color(skin.palette.staged));
            }
            let silent = matches!(encoder.phase, Phase::Silent(_));
            if silent
                && super::controls::enabled_button(
                    ui,
                    encoder.is_readable(),
                    icons::ARROW_CLOCKWISE,
                    &skin.say("memory.read"),
                )
                .clicked()
            {
                actions.push(Action::Hiperface(encoder.id, Hiperface::Read));
            }
            if !silent && button(ui, icons::ARROW_CLOCKWISE, &skin.say("shell.reconnect")).clicked() {
                actions.push(Action::Hiperface(encoder.id, Hiperface::Reconnect));
            }
            if button(ui, icons::PLUGS_CONNECTED, &skin.say("shell.connect")).clicked() {
                actions.push(Action::Connect(connect::Action::Open));
            }
        });
    });
}
