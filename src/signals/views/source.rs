//! The sample source with its progress and errors, drawn at the top of every page that uses samples.

use egui::{Align, Layout, RichText, Ui, vec2};

use super::{adapter, table, virtual_encoder};
use crate::app::{Action, RecorderOwner};
use crate::buses::bridge::protocol::Capabilities;
use crate::signals::state::{
    ExampleCapture, Origin, Signals, SignalsAction as Signals_, SourceAction, SourceKind, TAB, TEXTS, TableSource,
};
use crate::signals::views::translate;
use crate::ui::controls::{badge, enabled_button, fill_width, icon_button, labelled_button, name, paragraph, spinner};
use crate::ui::widgets::series_colour;
use crate::ui::{Theme, icons};

/// Width of the buttons on an empty page, in points.
const BUTTON: f32 = 220.0;

#[derive(Default)]
pub(super) struct SourceUiState {
    table: table::TableUiState,
    settings: bool,
    adapter: bool,
}

/// Draws the sample source. Returns `true` if there is a capture to show below it.
pub(super) fn source_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SourceUiState,
    actions: &mut Vec<Action>,
) -> bool {
    reading_ui(ui, theme, signals, actions);
    problem_ui(ui, theme, signals);
    let running = signals.source().is_running();
    if signals.measurement().is_some() || running {
        displayed_capture_ui(ui, theme, signals, view, actions);
        ui.add_space(theme.space.between);
    }
    if view.adapter || signals.source().adapter_problem().is_some() {
        view.adapter = !adapter::card_ui(ui, theme, signals.source(), actions);
        ui.add_space(theme.space.between);
    }
    let (shown, failed) = (signals.measurement().is_some(), signals.problem().is_some());
    if (view.table.is_open || failed || !shown)
        && !running
        && let Some(own) = signals.table()
    {
        table::card_ui(ui, theme, own, &mut view.table, actions);
        ui.add_space(theme.space.between);
    }
    if !shown && !running {
        empty_page_ui(ui, theme, signals, view, actions);
    }
    shown
}

/// Draws the settings of the virtual encoder while they are open. Each page places them next to the result that they
/// affect.
pub(super) fn settings_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &SourceUiState,
    actions: &mut Vec<Action>,
) {
    if view.settings && current_source(signals) == Some(SourceKind::Encoder) {
        virtual_encoder::card_ui(ui, theme, signals.source(), actions);
        ui.add_space(theme.space.between);
    }
}

/// Returns the kind of source that is running or displayed. Returns `None` for a table.
fn current_source(signals: &Signals) -> Option<SourceKind> {
    if signals.source().is_running() {
        return Some(signals.source().kind());
    }
    match signals.measurement()?.origin {
        Origin::Virtual => Some(SourceKind::Encoder),
        Origin::Adapter { .. } => Some(SourceKind::Adapter),
        Origin::Table(_) => None,
    }
}

fn reading_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(reading) = signals.capture_reading() else { return };
    ui.horizontal(|ui| {
        spinner(ui, theme);
        ui.label(
            theme.label(theme.format_text(&TEXTS.text("signals.reading").with_text("name", reading.place.name()))),
        );
        if let Some(share) = reading.fraction_read() {
            ui.add(egui::ProgressBar::new(share as f32).desired_height(4.0).desired_width(160.0));
        }
        let word = translate(theme, if reading.is_cancelled() { "shell.stopping" } else { "shell.cancel" });
        if enabled_button(ui, !reading.is_cancelled(), icons::X, &word).clicked() {
            actions.push(Action::tool(Signals_::Cancel));
        }
    });
    ui.add_space(theme.space.between);
}

/// Draws the reason why a capture could not be read.
pub(super) fn problem_ui(ui: &mut Ui, theme: &Theme, signals: &Signals) {
    let Some(problem) = signals.problem() else { return };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::X_CIRCLE).color(theme.palette.bad));
        ui.vertical(|ui| {
            paragraph(ui, theme.format_text(problem));
            if let Some(measurement) = signals.measurement() {
                let text = TEXTS.text("signals.still_shown").with_text("name", measurement.origin.name());
                paragraph(ui, theme.caption(theme.format_text(&text)));
            }
        });
    });
    ui.add_space(theme.space.between);
}

fn displayed_capture_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SourceUiState,
    actions: &mut Vec<Action>,
) {
    theme.card_frame().inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
        fill_width(ui);
        ui.horizontal_wrapped(|ui| {
            title_ui(ui, theme, signals);
            source_menu_ui(ui, theme, view, actions);
            source_buttons_ui(ui, theme, signals, view, actions);
            save_capture_ui(ui, theme, signals, actions);
            report_ui(ui, theme, signals, actions);
            if signals.table().is_some() {
                toggle_ui(ui, icons::TABLE, &translate(theme, "signals.table"), &mut view.table.is_open);
            }
        });
        compared_capture_ui(ui, theme, signals, actions);
    });
}

fn title_ui(ui: &mut Ui, theme: &Theme, signals: &Signals) {
    let palette = theme.palette;
    if current_source(signals).is_some() {
        live_title_ui(ui, theme, signals);
    } else if let Some(measurement) = signals.measurement() {
        let name = theme.format_text(&measurement.origin.name());
        let response = ui.add(egui::Label::new(theme.heading(name)).truncate());
        match &measurement.origin {
            Origin::Table(TableSource::File(path)) => drop(response.on_hover_text(path.display().to_string())),
            Origin::Table(TableSource::Example(_)) => {
                badge(ui, theme, &translate(theme, "signals.example"), palette.muted)
            }
            Origin::Virtual | Origin::Adapter { .. } => {}
        }
    }
    ui.add_space(theme.space.between);
}

fn live_title_ui(ui: &mut Ui, theme: &Theme, signals: &Signals) {
    let palette = theme.palette;
    let source = signals.source();
    let shown = signals.measurement().map(|own| &own.origin);
    let origin = match (source.is_running(), source.kind(), source.streaming_adapter()) {
        (true, SourceKind::Encoder, _) => Some(Origin::Virtual),
        (true, SourceKind::Adapter, Some(streaming)) => {
            Some(Origin::Adapter { name: streaming.hello.name.clone(), is_virtual: source.is_virtual() })
        }
        // The identity of the adapter is not known yet.
        (true, SourceKind::Adapter, None) => None,
        (false, ..) => shown.cloned(),
    };
    let name = origin.as_ref().map_or(TEXTS.text("adapter.title"), Origin::name);
    ui.add(egui::Label::new(theme.heading(theme.format_text(&name))).truncate());
    if matches!(origin, Some(Origin::Virtual | Origin::Adapter { is_virtual: true, .. })) {
        badge(ui, theme, &theme.translate("shell.virtual"), palette.warn);
    }
    let (id, colour) = match (source.is_running(), source.is_frozen()) {
        (true, _) if origin.is_none() => ("adapter.asking", palette.accent),
        (true, true) => ("virtual.held", palette.staged),
        (true, false) => ("virtual.running", palette.good),
        (false, _) => ("virtual.stopped", palette.muted),
    };
    let response = ui.label(RichText::new(translate(theme, id)).color(colour));
    if let Some(streaming) = source.streaming_adapter() {
        let rate = 1e9 / streaming.period_ns.max(1) as f64;
        let volts = f64::from(streaming.full_scale_microvolt) * 1e-6;
        let actual = TEXTS.text("adapter.actual").with_number("rate", rate, 0).with_number("volts", volts, 3);
        let hello = &streaming.hello;
        let who = [hello.name.as_str(), &hello.serial, &hello.firmware].join(" · ");
        response.on_hover_text(format!("{who}\n{}", theme.format_text(&actual)));
        if let Some((millivolt, milliampere)) = streaming.supplied {
            let text = TEXTS.text("adapter.supplied").with_number("volts", f64::from(millivolt) / 1000.0, 2);
            ui.label(theme.label(theme.format_text(&text.with("milliampere", milliampere))));
        } else if hello.capabilities.contains(Capabilities::SUPPLY) {
            let word = RichText::new(translate(theme, "adapter.supply_off")).color(palette.warn);
            ui.label(word).on_hover_text(translate(theme, "adapter.supply_off_hint"));
        }
    }
    if source.lost_samples() > 0 {
        let text = TEXTS.text("virtual.lost").with("count", source.lost_samples());
        ui.label(RichText::new(theme.format_text(&text)).color(palette.warn));
    }
}

fn source_buttons_ui(
    ui: &mut Ui,
    theme: &Theme,
    signals: &Signals,
    view: &mut SourceUiState,
    actions: &mut Vec<Action>,
) {
    let source = signals.source();
    let mut ask = |action| actions.push(Action::tool(Signals_::Source(action)));
    let Some(kind) = current_source(signals) else { return };
    if source.is_running() {
        if labelled_button(ui, icons::STOP, &translate(theme, "virtual.stop")).clicked() {
            ask(SourceAction::Stop);
        }
        let held = source.is_frozen();
        let (icon, id) = if held { (icons::PLAY, "virtual.go_on") } else { (icons::PAUSE, "virtual.hold") };
        if labelled_button(ui, icon, &translate(theme, id)).clicked() {
            ask(SourceAction::Freeze(!held));
        }
    } else if labelled_button(ui, icons::PLAY, &translate(theme, "virtual.again")).clicked() {
        ask(match kind {
            SourceKind::Encoder => SourceAction::Start,
            SourceKind::Adapter => SourceAction::StartAdapter,
        });
    }
    let open = match kind {
        SourceKind::Encoder => &mut view.settings,
        SourceKind::Adapter => &mut view.adapter,
    };
    toggle_ui(ui, icons::SLIDERS, &translate(theme, "virtual.settings"), open);
}

fn toggle_ui(ui: &mut Ui, icon: &str, word: &str, open: &mut bool) {
    let button = egui::Button::selectable(*open, format!("{icon}  {word}")).frame_when_inactive(true);
    if name(ui.add(button), true, word).clicked() {
        *open = !*open;
    }
}

/// Draws the button for keeping the displayed capture for comparison.
fn save_capture_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, actions: &mut Vec<Action>) {
    let word = translate(theme, "compare.keep");
    let same = signals
        .comparison_result()
        .zip(signals.measurement())
        .is_some_and(|(a, b)| std::sync::Arc::ptr_eq(a, b.results()));
    if enabled_button(ui, !same, icons::PUSH_PIN, &word).on_hover_text(translate(theme, "compare.keep_hint")).clicked()
    {
        actions.push(Action::tool(Signals_::Keep));
    }
}

fn report_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, actions: &mut Vec<Action>) {
    let word = theme.translate("shell.report");
    if enabled_button(ui, signals.measurement().is_some(), icons::FILE_TEXT, &word).clicked() {
        actions.push(Action::AskReport(RecorderOwner::Tool(TAB)));
    }
}

fn compared_capture_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, actions: &mut Vec<Action>) {
    let Some(kept) = signals.comparison_result() else { return };
    ui.horizontal(|ui| {
        let text = TEXTS.text("compare.with").with_text("name", kept.origin.name());
        let (rect, _) = ui.allocate_exact_size(egui::vec2(18.0, 12.0), egui::Sense::hover());
        let ends = [rect.left_center(), rect.right_center()];
        let stroke = egui::Stroke::new(2.0, series_colour(theme, 1));
        ui.painter().extend(egui::Shape::dashed_line(&ends, stroke, 5.0, 3.0));
        ui.add(egui::Label::new(theme.label(theme.format_text(&text))).truncate());
        if icon_button(ui, true, icons::X, &translate(theme, "compare.drop")).clicked() {
            actions.push(Action::tool(Signals_::DropComparison));
        }
    });
}

fn source_menu_ui(ui: &mut Ui, theme: &Theme, view: &mut SourceUiState, actions: &mut Vec<Action>) {
    let word = translate(theme, "signals.source");
    let menu = ui.menu_button(format!("{word}  {}", icons::CARET_DOWN), |ui| {
        ui.set_width(220.0);
        let mut chosen = None;
        if labelled_button(ui, icons::FOLDER_OPEN, &translate(theme, "signals.open")).clicked() {
            chosen = Some(Action::AskOpen);
        }
        if labelled_button(ui, icons::WAVE_SINE, &translate(theme, "virtual.start")).clicked() {
            chosen = Some(Action::tool(Signals_::Source(SourceAction::Start)));
        }
        if labelled_button(ui, icons::PLUGS, &translate(theme, "adapter.open")).clicked() {
            view.adapter = true;
            ui.close();
        }
        ui.label(theme.caption(translate(theme, "signals.examples")));
        for example in ExampleCapture::ALL {
            if labelled_button(ui, icons::FILE_TEXT, &translate(theme, example.keyword())).clicked() {
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

/// Draws the empty page, with buttons to load a capture or start a source.
fn empty_page_ui(ui: &mut Ui, theme: &Theme, signals: &Signals, view: &mut SourceUiState, actions: &mut Vec<Action>) {
    if signals.capture_reading().is_some() {
        return;
    }
    ui.vertical_centered(|ui| {
        ui.add_space(theme.space.around);
        ui.label(RichText::new(icons::WAVE_SINE).size(theme.sizes.live).color(theme.palette.muted));
        ui.add_space(theme.space.between);
        ui.add(egui::Label::new(theme.label(translate(theme, "signals.nothing"))).wrap());
        ui.add_space(theme.space.between);
        let size = vec2(BUTTON.min(ui.available_width()), 0.0);
        ui.allocate_ui_with_layout(size, Layout::top_down_justified(Align::Center), |ui| {
            if labelled_button(ui, icons::FOLDER_OPEN, &translate(theme, "signals.open")).clicked() {
                actions.push(Action::AskOpen);
            }
            if labelled_button(ui, icons::WAVE_SINE, &translate(theme, "virtual.start")).clicked() {
                actions.push(Action::tool(Signals_::Source(SourceAction::Start)));
            }
            if labelled_button(ui, icons::PLUGS, &translate(theme, "adapter.open")).clicked() {
                view.adapter = true;
            }
            theme.add_gap(ui);
            ui.label(theme.caption(translate(theme, "signals.try_example")));
            for example in ExampleCapture::ALL {
                if labelled_button(ui, icons::WAVE_SINE, &translate(theme, example.keyword())).clicked() {
                    actions.push(Action::tool(Signals_::Example(example)));
                }
            }
        });
    });
}
