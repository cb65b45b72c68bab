//! Where the samples come from: above every page that is about them. Reading, its progress, and why it failed.

use egui::{RichText, Ui};

use super::{table, virtual_encoder};
use crate::app::signals::{Action as Signals_, Example, Origin, Place, Signals, SourceAction};
use crate::app::{Action, Text};
use crate::ui::controls::{badge, button, enabled_button, fill, icon_button, name, paragraph, spinner};
use crate::ui::widgets::series;
use crate::ui::{Skin, icons};

/// What is remembered of it.
#[derive(Default)]
pub(super) struct View {
    table: table::View,
    /// The virtual encoder's settings are shown.
    settings: bool,
}

/// Draws it. True: there is a capture to be shown below.
pub(super) fn source_ui(
    ui: &mut Ui,
    skin: &Skin,
    signals: &Signals,
    view: &mut View,
    actions: &mut Vec<Action>,
) -> bool {
    reading(ui, skin, signals, actions);
    problem(ui, skin, signals);
    let running = signals.source().is_running();
    if signals.measurement().is_some() || running {
        present(ui, skin, signals, view, actions);
        ui.add_space(skin.space.between);
    }
    let (shown, failed) = (signals.measurement().is_some(), signals.problem().is_some());
    if (view.table.is_open || failed || !shown)
        && !running
        && let Some(own) = signals.table()
    {
        table::card_ui(ui, skin, own, &mut view.table, actions);
        ui.add_space(skin.space.between);
    }
    if !shown && !running {
        nothing(ui, skin, signals, actions);
    }
    shown
}

/// The virtual encoder's settings, where they are wanted. A page draws them where what they change can be seen.
pub(super) fn settings_ui(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &View, actions: &mut Vec<Action>) {
    if view.settings && is_virtual(signals) {
        virtual_encoder::card_ui(ui, skin, signals.source(), actions);
        ui.add_space(skin.space.between);
    }
}

/// The virtual encoder is what is shown, or will be.
fn is_virtual(signals: &Signals) -> bool {
    let shown = signals.measurement().is_some_and(|own| own.origin == Origin::Virtual);
    shown || signals.source().is_running()
}

/// What is being read, how far it is, and a way to end it.
fn reading(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(reading) = signals.reading() else { return };
    ui.horizontal(|ui| {
        spinner(ui, skin);
        ui.label(skin.label(skin.words(&Text::new("signals.reading").with_text("name", reading.place.name()))));
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
                let text = Text::new("signals.still_shown").with_text("name", measurement.origin.name());
                paragraph(ui, skin.caption(skin.words(&text)));
            }
        });
    });
    ui.add_space(skin.space.between);
}

/// The capture that is shown, in one line, and what can be done with it.
fn present(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &mut View, actions: &mut Vec<Action>) {
    skin.card().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
        fill(ui);
        ui.horizontal_wrapped(|ui| {
            title(ui, skin, signals);
            source_menu(ui, skin, actions);
            source_buttons(ui, skin, signals, view, actions);
            keep_ui(ui, skin, signals, actions);
            if signals.table().is_some() {
                toggle(ui, icons::TABLE, &skin.say("signals.table"), &mut view.table.is_open);
            }
        });
        compared(ui, skin, signals, actions);
    });
}

/// Whose samples these are.
fn title(ui: &mut Ui, skin: &Skin, signals: &Signals) {
    let palette = skin.palette;
    let source = signals.source();
    if is_virtual(signals) {
        ui.label(skin.heading(skin.words(&Origin::Virtual.name())));
        badge(ui, skin, &skin.say("shell.virtual"), palette.warn);
        let (id, colour) = match (source.is_running(), source.is_held()) {
            (true, true) => ("virtual.held", palette.staged),
            (true, false) => ("virtual.running", palette.good),
            (false, _) => ("virtual.stopped", palette.muted),
        };
        ui.label(RichText::new(skin.say(id)).color(colour));
        if source.lost() > 0 {
            let text = Text::new("virtual.lost").with("count", source.lost());
            ui.label(RichText::new(skin.words(&text)).color(palette.warn));
        }
    } else if let Some(measurement) = signals.measurement() {
        let name = skin.words(&measurement.origin.name());
        let response = ui.add(egui::Label::new(skin.heading(name)).truncate());
        match &measurement.origin {
            Origin::Table(Place::File(path)) => drop(response.on_hover_text(path.display().to_string())),
            Origin::Table(Place::Example(_)) => badge(ui, skin, &skin.say("signals.example"), palette.muted),
            Origin::Virtual => {}
        }
    }
    ui.add_space(skin.space.between);
}

/// Starting, holding and stopping the virtual encoder, and its settings.
fn source_buttons(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &mut View, actions: &mut Vec<Action>) {
    let source = signals.source();
    let mut ask = |action| actions.push(Action::Signals(Signals_::Source(action)));
    if !is_virtual(signals) {
        return;
    }
    if source.is_running() {
        if button(ui, icons::STOP, &skin.say("virtual.stop")).clicked() {
            ask(SourceAction::Stop);
        }
        let held = source.is_held();
        let (icon, id) = if held { (icons::PLAY, "virtual.go_on") } else { (icons::PAUSE, "virtual.hold") };
        if button(ui, icon, &skin.say(id)).clicked() {
            ask(SourceAction::Hold(!held));
        }
    } else if button(ui, icons::PLAY, &skin.say("virtual.again")).clicked() {
        ask(SourceAction::Start);
    }
    toggle(ui, icons::SLIDERS, &skin.say("virtual.settings"), &mut view.settings);
}

/// A button that shows something, or hides it.
fn toggle(ui: &mut Ui, icon: &str, word: &str, open: &mut bool) {
    let button = egui::Button::selectable(*open, format!("{icon}  {word}")).frame_when_inactive(true);
    if name(ui.add(button), true, word).clicked() {
        *open = !*open;
    }
}

/// Putting the capture aside, and what is put aside.
fn keep_ui(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let word = skin.say("compare.keep");
    let same =
        signals.comparison().zip(signals.measurement()).is_some_and(|(a, b)| std::sync::Arc::ptr_eq(a, b.results()));
    if enabled_button(ui, !same, icons::PUSH_PIN, &word).on_hover_text(skin.say("compare.keep_hint")).clicked() {
        actions.push(Action::Signals(Signals_::Keep));
    }
}

/// What the capture is compared with.
fn compared(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(kept) = signals.comparison() else { return };
    ui.horizontal(|ui| {
        let text = Text::new("compare.with").with_text("name", kept.origin.name());
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

/// Everything that samples can come from.
fn source_menu(ui: &mut Ui, skin: &Skin, actions: &mut Vec<Action>) {
    let word = skin.say("signals.source");
    let menu = ui.menu_button(format!("{word}  {}", icons::CARET_DOWN), |ui| {
        ui.set_width(220.0);
        let mut chosen = None;
        if button(ui, icons::FOLDER_OPEN, &skin.say("signals.open")).clicked() {
            chosen = Some(Action::AskOpen);
        }
        if button(ui, icons::WAVE_SINE, &skin.say("virtual.start")).clicked() {
            chosen = Some(Action::Signals(Signals_::Source(SourceAction::Start)));
        }
        ui.label(skin.caption(skin.say("signals.examples")));
        for example in Example::ALL {
            if button(ui, icons::FILE_TEXT, &skin.say(example.word())).clicked() {
                chosen = Some(Action::Signals(Signals_::Example(example)));
            }
        }
        if let Some(chosen) = chosen {
            actions.push(chosen);
            ui.close();
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
        if button(ui, icons::WAVE_SINE, &skin.say("virtual.start")).clicked() {
            actions.push(Action::Signals(Signals_::Source(SourceAction::Start)));
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
