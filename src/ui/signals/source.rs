//! Where the samples come from: above every page that is about them. Reading, its progress, and why it failed.

use egui::{RichText, Ui};

use super::table;
use crate::app::signals::{Action as Signals_, Example, Origin, Signals};
use crate::app::{Action, Text};
use crate::ui::controls::{badge, button, enabled_button, fill, icon_button, name, paragraph, spinner};
use crate::ui::widgets::series;
use crate::ui::{Skin, icons};

/// Draws it. True: there is a capture to be shown below.
pub(super) fn source_ui(
    ui: &mut Ui,
    skin: &Skin,
    signals: &Signals,
    view: &mut table::View,
    actions: &mut Vec<Action>,
) -> bool {
    reading(ui, skin, signals, actions);
    problem(ui, skin, signals);
    match signals.measurement() {
        Some(_) => {
            present(ui, skin, signals, view, actions);
            let open = view.is_open || signals.problem().is_some();
            if open && let Some(own) = signals.table() {
                ui.add_space(skin.space.between);
                table::card_ui(ui, skin, own, view, actions);
            }
            ui.add_space(skin.space.groups);
        }
        None => {
            if let Some(own) = signals.table() {
                table::card_ui(ui, skin, own, view, actions);
                ui.add_space(skin.space.groups);
            }
            nothing(ui, skin, signals, actions);
        }
    }
    signals.measurement().is_some()
}

/// What is being read, how far it is, and a way to end it.
fn reading(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(reading) = signals.reading() else { return };
    ui.horizontal(|ui| {
        spinner(ui, skin);
        ui.label(skin.label(skin.words(&Text::new("signals.reading").with("name", reading.origin.name()))));
        if let Some(share) = reading.share() {
            ui.add(egui::ProgressBar::new(share as f32).desired_height(4.0).desired_width(160.0));
        }
        let word = skin.say(if reading.is_cancelled() { "shell.stopping" } else { "shell.cancel" });
        if enabled_button(ui, !reading.is_cancelled(), icons::X, &word).clicked() {
            actions.push(Action::Signals(Signals_::Cancel));
        }
    });
    ui.add_space(skin.space.between);
}

fn problem(ui: &mut Ui, skin: &Skin, signals: &Signals) {
    let Some(problem) = signals.problem() else { return };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::X_CIRCLE).color(skin.palette.bad));
        ui.vertical(|ui| {
            paragraph(ui, skin.words(problem));
            if let Some(measurement) = signals.measurement() {
                let text = Text::new("signals.still_shown").with("name", measurement.origin.name());
                paragraph(ui, skin.caption(skin.words(&text)));
            }
        });
    });
    ui.add_space(skin.space.between);
}

/// The capture that is shown, in one line.
fn present(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &mut table::View, actions: &mut Vec<Action>) {
    let Some(measurement) = signals.measurement() else { return };
    skin.card().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
        fill(ui);
        ui.horizontal_wrapped(|ui| {
            let heading = egui::Label::new(skin.heading(measurement.origin.name())).truncate();
            let response = ui.add(heading);
            if let Origin::File(path) = &measurement.origin {
                response.on_hover_text(path.display().to_string());
            }
            if matches!(measurement.origin, Origin::Example(_)) {
                badge(ui, skin, &skin.say("signals.example"), skin.palette.muted);
            }
            ui.add_space(skin.space.between);
            if button(ui, icons::FOLDER_OPEN, &skin.say("signals.open")).clicked() {
                actions.push(Action::AskOpen);
            }
            examples_menu(ui, skin, actions);
            keep_ui(ui, skin, signals, actions);
            let word = skin.say("signals.table");
            let toggle = egui::Button::selectable(view.is_open, format!("{}  {word}", icons::TABLE));
            if name(ui.add(toggle.frame_when_inactive(true)), true, &word).clicked() {
                view.is_open = !view.is_open;
            }
        });
        compared(ui, skin, signals, actions);
    });
}

/// Putting the capture aside, and what is put aside.
fn keep_ui(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let word = skin.say("compare.keep");
    let same = signals.comparison().zip(signals.measurement()).is_some_and(|(a, b)| std::sync::Arc::ptr_eq(a, b));
    if enabled_button(ui, !same, icons::PUSH_PIN, &word).on_hover_text(skin.say("compare.keep_hint")).clicked() {
        actions.push(Action::Signals(Signals_::Keep));
    }
}

/// What the capture is compared with.
fn compared(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(kept) = signals.comparison() else { return };
    ui.horizontal(|ui| {
        let text = Text::new("compare.with").with("name", kept.origin.name());
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 12.0), egui::Sense::hover());
        let ends = [rect.left_center(), rect.right_center()];
        let stroke = egui::Stroke::new(2.0, series(skin, 1));
        ui.painter().extend(egui::Shape::dashed_line(&ends, stroke, 5.0, 3.0));
        ui.add(egui::Label::new(skin.label(skin.words(&text))).truncate());
        if icon_button(ui, true, icons::X, &skin.say("compare.drop")).clicked() {
            actions.push(Action::Signals(Signals_::DropComparison));
        }
    });
}

fn examples_menu(ui: &mut Ui, skin: &Skin, actions: &mut Vec<Action>) {
    let word = skin.say("signals.examples");
    let menu = ui.menu_button(format!("{word}  {}", icons::CARET_DOWN), |ui| {
        for example in Example::ALL {
            if ui.button(skin.say(example.word())).clicked() {
                actions.push(Action::Signals(Signals_::Example(example)));
                ui.close();
            }
        }
    });
    name(menu.response, true, &word);
}

/// What would be here, and what fills it.
fn nothing(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    if signals.reading().is_some() {
        return;
    }
    ui.vertical_centered(|ui| {
        ui.add_space(skin.space.around);
        ui.label(RichText::new(icons::WAVE_SINE).size(skin.sizes.live).color(skin.palette.muted));
        ui.add_space(skin.space.between);
        ui.add(egui::Label::new(skin.label(skin.say("signals.nothing"))).wrap());
        ui.add_space(skin.space.between);
        if button(ui, icons::FOLDER_OPEN, &skin.say("signals.open")).clicked() {
            actions.push(Action::AskOpen);
        }
        ui.add_space(skin.space.groups);
        ui.label(skin.caption(skin.say("signals.try_example")));
        for example in Example::ALL {
            if button(ui, icons::WAVE_SINE, &skin.say(example.word())).clicked() {
                actions.push(Action::Signals(Signals_::Example(example)));
            }
        }
    });
}
