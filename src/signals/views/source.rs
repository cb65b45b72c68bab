//! Where the samples come from: above every page that is about them. Reading, its progress, and why it failed.

use egui::{RichText, Ui};

use super::{adapter, table, virtual_encoder};
use crate::app::Action;
use crate::buses::bridge::protocol::Capabilities;
use crate::signals::state::{Action as Signals_, Example, Origin, Place, Signals, SourceAction, SourceKind, TEXTS};
use crate::signals::views::say;
use crate::ui::controls::{badge, button, enabled_button, fill, icon_button, name, paragraph, spinner};
use crate::ui::widgets::series;
use crate::ui::{Skin, icons};

/// What is remembered of it.
#[derive(Default)]
pub(super) struct View {
    table: table::View,
    /// The virtual encoder's settings are shown.
    settings: bool,
    /// Where the adapter is can be said.
    adapter: bool,
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
    if view.adapter || signals.source().adapter_problem().is_some() {
        view.adapter = !adapter::card_ui(ui, skin, signals.source(), actions);
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
        nothing(ui, skin, signals, view, actions);
    }
    shown
}

/// The virtual encoder's settings, where they are wanted. A page draws them where what they change can be seen.
pub(super) fn settings_ui(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &View, actions: &mut Vec<Action>) {
    if view.settings && live(signals) == Some(SourceKind::Encoder) {
        virtual_encoder::card_ui(ui, skin, signals.source(), actions);
        ui.add_space(skin.space.between);
    }
}

/// The source that is shown, or will be; `None`: a table is.
fn live(signals: &Signals) -> Option<SourceKind> {
    if signals.source().is_running() {
        return Some(signals.source().kind());
    }
    match signals.measurement()?.origin {
        Origin::Virtual => Some(SourceKind::Encoder),
        Origin::Adapter { .. } => Some(SourceKind::Adapter),
        Origin::Table(_) => None,
    }
}

/// What is being read, how far it is, and a way to end it.
fn reading(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(reading) = signals.reading() else { return };
    ui.horizontal(|ui| {
        spinner(ui, skin);
        ui.label(skin.label(skin.words(&TEXTS.text("signals.reading").with_text("name", reading.place.name()))));
        if let Some(share) = reading.share() {
            ui.add(egui::ProgressBar::new(share as f32).desired_height(4.0).desired_width(160.0));
        }
        let word = say(skin, if reading.is_cancelled() { "shell.stopping" } else { "shell.cancel" });
        if enabled_button(ui, !reading.is_cancelled(), icons::X, &word).clicked() {
            actions.push(Action::tool(Signals_::Cancel));
        }
    });
    ui.add_space(skin.space.between);
}

/// Why a capture could not be read. The other pages say it too.
pub(super) fn problem(ui: &mut Ui, skin: &Skin, signals: &Signals) {
    let Some(problem) = signals.problem() else { return };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::X_CIRCLE).color(skin.palette.bad));
        ui.vertical(|ui| {
            paragraph(ui, skin.words(problem));
            if let Some(measurement) = signals.measurement() {
                let text = TEXTS.text("signals.still_shown").with_text("name", measurement.origin.name());
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
            source_menu(ui, skin, view, actions);
            source_buttons(ui, skin, signals, view, actions);
            keep_ui(ui, skin, signals, actions);
            if signals.table().is_some() {
                toggle(ui, icons::TABLE, &say(skin, "signals.table"), &mut view.table.is_open);
            }
        });
        compared(ui, skin, signals, actions);
    });
}

/// Whose samples these are.
fn title(ui: &mut Ui, skin: &Skin, signals: &Signals) {
    let palette = skin.palette;
    if live(signals).is_some() {
        live_title(ui, skin, signals);
    } else if let Some(measurement) = signals.measurement() {
        let name = skin.words(&measurement.origin.name());
        let response = ui.add(egui::Label::new(skin.heading(name)).truncate());
        match &measurement.origin {
            Origin::Table(Place::File(path)) => drop(response.on_hover_text(path.display().to_string())),
            Origin::Table(Place::Example(_)) => badge(ui, skin, &say(skin, "signals.example"), palette.muted),
            Origin::Virtual | Origin::Adapter { .. } => {}
        }
    }
    ui.add_space(skin.space.between);
}

/// Which source, whether it runs, and what it lost.
fn live_title(ui: &mut Ui, skin: &Skin, signals: &Signals) {
    let palette = skin.palette;
    let source = signals.source();
    let shown = signals.measurement().map(|own| &own.origin);
    let origin = match (source.is_running(), source.kind(), source.streaming()) {
        (true, SourceKind::Encoder, _) => Some(Origin::Virtual),
        (true, SourceKind::Adapter, Some(streaming)) => {
            Some(Origin::Adapter { name: streaming.hello.name.clone(), is_virtual: source.is_virtual() })
        }
        // Who it is will be told.
        (true, SourceKind::Adapter, None) => None,
        (false, ..) => shown.cloned(),
    };
    let name = origin.as_ref().map_or(TEXTS.text("adapter.title"), Origin::name);
    ui.add(egui::Label::new(skin.heading(skin.words(&name))).truncate());
    if matches!(origin, Some(Origin::Virtual | Origin::Adapter { is_virtual: true, .. })) {
        badge(ui, skin, &skin.say("shell.virtual"), palette.warn);
    }
    let (id, colour) = match (source.is_running(), source.is_held()) {
        (true, _) if origin.is_none() => ("adapter.asking", palette.accent),
        (true, true) => ("virtual.held", palette.staged),
        (true, false) => ("virtual.running", palette.good),
        (false, _) => ("virtual.stopped", palette.muted),
    };
    let response = ui.label(RichText::new(say(skin, id)).color(colour));
    if let Some(streaming) = source.streaming() {
        let rate = 1e9 / streaming.period_ns.max(1) as f64;
        let volts = f64::from(streaming.full_scale_microvolt) * 1e-6;
        let actual = TEXTS.text("adapter.actual").with_number("rate", rate, 0).with_number("volts", volts, 3);
        let hello = &streaming.hello;
        let who = [hello.name.as_str(), &hello.serial, &hello.firmware].join(" · ");
        response.on_hover_text(format!("{who}\n{}", skin.words(&actual)));
        if let Some((millivolt, milliampere)) = streaming.supplied {
            let text = TEXTS.text("adapter.supplied").with_number("volts", f64::from(millivolt) / 1000.0, 2);
            ui.label(skin.label(skin.words(&text.with("milliampere", milliampere))));
        } else if hello.capabilities.has(Capabilities::SUPPLY) {
            let word = RichText::new(say(skin, "adapter.supply_off")).color(palette.warn);
            ui.label(word).on_hover_text(say(skin, "adapter.supply_off_hint"));
        }
    }
    if source.lost() > 0 {
        let text = TEXTS.text("virtual.lost").with("count", source.lost());
        ui.label(RichText::new(skin.words(&text)).color(palette.warn));
    }
}

/// Starting, holding and stopping what runs, and its settings.
fn source_buttons(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &mut View, actions: &mut Vec<Action>) {
    let source = signals.source();
    let mut ask = |action| actions.push(Action::tool(Signals_::Source(action)));
    let Some(kind) = live(signals) else { return };
    if source.is_running() {
        if button(ui, icons::STOP, &say(skin, "virtual.stop")).clicked() {
            ask(SourceAction::Stop);
        }
        let held = source.is_held();
        let (icon, id) = if held { (icons::PLAY, "virtual.go_on") } else { (icons::PAUSE, "virtual.hold") };
        if button(ui, icon, &say(skin, id)).clicked() {
            ask(SourceAction::Hold(!held));
        }
    } else if button(ui, icons::PLAY, &say(skin, "virtual.again")).clicked() {
        ask(match kind {
            SourceKind::Encoder => SourceAction::Start,
            SourceKind::Adapter => SourceAction::StartAdapter,
        });
    }
    let open = match kind {
        SourceKind::Encoder => &mut view.settings,
        SourceKind::Adapter => &mut view.adapter,
    };
    toggle(ui, icons::SLIDERS, &say(skin, "virtual.settings"), open);
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
    let word = say(skin, "compare.keep");
    let same =
        signals.comparison().zip(signals.measurement()).is_some_and(|(a, b)| std::sync::Arc::ptr_eq(a, b.results()));
    if enabled_button(ui, !same, icons::PUSH_PIN, &word).on_hover_text(say(skin, "compare.keep_hint")).clicked() {
        actions.push(Action::tool(Signals_::Keep));
    }
}

/// What the capture is compared with.
fn compared(ui: &mut Ui, skin: &Skin, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(kept) = signals.comparison() else { return };
    ui.horizontal(|ui| {
        let text = TEXTS.text("compare.with").with_text("name", kept.origin.name());
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 12.0), egui::Sense::hover());
        let ends = [rect.left_center(), rect.right_center()];
        let stroke = egui::Stroke::new(2.0, series(skin, 1));
        ui.painter().extend(egui::Shape::dashed_line(&ends, stroke, 5.0, 3.0));
        ui.add(egui::Label::new(skin.label(skin.words(&text))).truncate());
        if icon_button(ui, true, icons::X, &say(skin, "compare.drop")).clicked() {
            actions.push(Action::tool(Signals_::DropComparison));
        }
    });
}

/// Everything that samples can come from.
fn source_menu(ui: &mut Ui, skin: &Skin, view: &mut View, actions: &mut Vec<Action>) {
    let word = say(skin, "signals.source");
    let menu = ui.menu_button(format!("{word}  {}", icons::CARET_DOWN), |ui| {
        ui.set_width(220.0);
        let mut chosen = None;
        if button(ui, icons::FOLDER_OPEN, &say(skin, "signals.open")).clicked() {
            chosen = Some(Action::AskOpen);
        }
        if button(ui, icons::WAVE_SINE, &say(skin, "virtual.start")).clicked() {
            chosen = Some(Action::tool(Signals_::Source(SourceAction::Start)));
        }
        if button(ui, icons::PLUGS, &say(skin, "adapter.open")).clicked() {
            view.adapter = true;
            ui.close();
        }
        ui.label(skin.caption(say(skin, "signals.examples")));
        for example in Example::ALL {
            if button(ui, icons::FILE_TEXT, &say(skin, example.word())).clicked() {
                chosen = Some(Action::tool(Signals_::Example(example)));
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
fn nothing(ui: &mut Ui, skin: &Skin, signals: &Signals, view: &mut View, actions: &mut Vec<Action>) {
    if signals.reading().is_some() {
        return;
    }
    ui.vertical_centered(|ui| {
        ui.add_space(skin.space.around);
        ui.label(RichText::new(icons::WAVE_SINE).size(skin.sizes.live).color(skin.palette.muted));
        ui.add_space(skin.space.between);
        ui.add(egui::Label::new(skin.label(say(skin, "signals.nothing"))).wrap());
        ui.add_space(skin.space.between);
        if button(ui, icons::FOLDER_OPEN, &say(skin, "signals.open")).clicked() {
            actions.push(Action::AskOpen);
        }
        if button(ui, icons::WAVE_SINE, &say(skin, "virtual.start")).clicked() {
            actions.push(Action::tool(Signals_::Source(SourceAction::Start)));
        }
        if button(ui, icons::PLUGS, &say(skin, "adapter.open")).clicked() {
            view.adapter = true;
        }
        ui.add_space(skin.space.groups);
        ui.label(skin.caption(say(skin, "signals.try_example")));
        for example in Example::ALL {
            if button(ui, icons::WAVE_SINE, &say(skin, example.word())).clicked() {
                actions.push(Action::tool(Signals_::Example(example)));
            }
        }
    });
}
