//! The plot's toolbar: hold, follow, time span, cursors, trigger, lines with their units, and export.

use egui::{RichText, Ui};

use super::{Context, PlotUiState, chart, snapshot, trigger};
use crate::app::Action as Studio;
use crate::app::recorder::{Cursor, Recorder, RecorderAction, TriggerState};
use crate::ui::controls::{dropdown, enabled_button, icon_button, icon_menu, options};
use crate::ui::icons;

/// Selectable spans in seconds.
const SPANS: [(i64, &str); 10] = [
    (1, "recorder.span_1"),
    (5, "recorder.span_5"),
    (10, "recorder.span_10"),
    (30, "recorder.span_30"),
    (60, "recorder.span_60"),
    (300, "recorder.span_300"),
    (1_800, "recorder.span_1800"),
    (3_600, "recorder.span_3600"),
    (14_400, "recorder.span_14400"),
    (86_400, "recorder.span_86400"),
];

/// Minimum width in points at which all tools fit in one row. In a narrower panel, some of them are in a menu.
const ONE_ROW: f32 = 284.0;

pub(super) fn toolbar_ui(ui: &mut Ui, context: &mut Context<'_>, view: &mut PlotUiState) {
    let (theme, recorder) = (context.theme, context.recorder);
    let narrow = ui.available_width() < ONE_ROW;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(theme.space.inside, theme.space.inside);
        // The padding is reduced, so one row is enough in a side panel.
        ui.spacing_mut().button_padding.x = 6.0;
        let tool = |ui: &mut Ui, enabled: bool, icon: &str, id: &'static str| {
            icon_button(ui, enabled, icon, &theme.translate(id)).clicked()
        };
        let some = !recorder.is_empty();
        if recorder.follows_newest() {
            if tool(ui, some, icons::SNOWFLAKE, "recorder.pause") {
                context.push_action(RecorderAction::Pause);
            }
        } else if tool(ui, true, icons::FAST_FORWARD, "recorder.follow") {
            context.push_action(RecorderAction::Follow);
        }
        span_ui(ui, context);
        if narrow {
            more_menu_ui(ui, context, &mut view.trigger);
        } else {
            if tool(ui, some, icons::ARROWS_OUT_LINE_HORIZONTAL, "recorder.fit") {
                context.push_action(RecorderAction::Fit);
            }
            let cursors = has_cursors(recorder);
            if switch_ui(ui, context, some, cursors, icons::RULER, "recorder.cursors") {
                context.push_action(RecorderAction::ShowCursors(!cursors));
            }
            trigger_menu_ui(ui, context, &mut view.trigger);
        }
        lines_menu_ui(ui, context);
        export_menu_ui(ui, context, &mut view.shot);
        if let Some(large) = &mut view.large {
            let small = (icons::CORNERS_IN, "recorder.small");
            let (icon, id) = if *large { small } else { (icons::CORNERS_OUT, "recorder.large") };
            if tool(ui, true, icon, id) {
                *large = !*large;
            }
        }
    });
    state_ui(ui, context);
}

fn switch_ui(ui: &mut Ui, context: &Context<'_>, enabled: bool, on: bool, icon: &str, id: &'static str) -> bool {
    let word = context.theme.translate(id);
    let button = egui::Button::selectable(on, icon).frame_when_inactive(true).min_size(egui::vec2(28.0, 28.0));
    let response = ui.add_enabled(enabled, button);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Switch, enabled, on, &word));
    response.on_hover_text(&word).on_disabled_hover_text(&word).clicked()
}

/// Draws the selector for the time span. It shows a preset or the span that results from zooming.
fn span_ui(ui: &mut Ui, context: &mut Context<'_>) {
    const SECOND: i64 = 1_000_000_000;
    if context.recorder.counts_samples() {
        // Samples without times have no seconds. Their number is selected by zooming.
        return;
    }
    let (theme, span) = (context.theme, context.recorder.window_length());
    let mut chosen = span;
    let mut options: Vec<(i64, String)> =
        SPANS.into_iter().map(|(seconds, id)| (seconds * SECOND, theme.translate(id))).collect();
    if options.iter().all(|(own, _)| *own != span) {
        options.insert(0, (span, super::axes::format_short_duration(span, theme.language)));
    }
    ui.scope(|ui| {
        ui.spacing_mut().combo_width = 48.0;
        if dropdown(ui, &theme.translate("recorder.span"), &mut chosen, options) {
            context.push_action(RecorderAction::SetSpan(chosen));
        }
    });
}

fn has_cursors(recorder: &Recorder) -> bool {
    Cursor::BOTH.into_iter().any(|cursor| recorder.cursor(cursor).is_some())
}

fn more_menu_ui(ui: &mut Ui, context: &mut Context<'_>, form: &mut trigger::Form) {
    let (theme, recorder) = (context.theme, context.recorder);
    let some = !recorder.is_empty();
    let mut actions = Vec::new();
    icon_menu(ui, icons::SLIDERS, &theme.translate("recorder.more"), |ui| {
        let word = theme.translate("recorder.fit");
        if enabled_button(ui, some, icons::ARROWS_OUT_LINE_HORIZONTAL, &word).clicked() {
            actions.push(RecorderAction::Fit);
            ui.close();
        }
        let mut cursors = has_cursors(recorder);
        let check = egui::Checkbox::new(&mut cursors, theme.translate("recorder.cursors"));
        if ui.add_enabled(some, check).changed() {
            actions.push(RecorderAction::ShowCursors(cursors));
        }
        if recorder.visible_series().next().is_some() {
            ui.separator();
            trigger::form_ui(ui, theme, recorder, form, &mut actions);
        }
    });
    actions.into_iter().for_each(|action| context.push_action(action));
}

fn trigger_menu_ui(ui: &mut Ui, context: &mut Context<'_>, form: &mut trigger::Form) {
    let icon = icons::LIGHTNING;
    let lines = context.recorder.visible_series().next().is_some();
    if !lines {
        icon_button(ui, false, icon, &context.theme.translate("recorder.trigger"));
        return;
    }
    let theme = context.theme;
    let mut actions = Vec::new();
    icon_menu(ui, icon, &theme.translate("recorder.trigger"), |ui| {
        trigger::form_ui(ui, theme, context.recorder, form, &mut actions);
    });
    actions.into_iter().for_each(|action| context.push_action(action));
}

fn lines_menu_ui(ui: &mut Ui, context: &mut Context<'_>) {
    let (theme, recorder) = (context.theme, context.recorder);
    let mut actions = Vec::new();
    icon_menu(ui, icons::LIST_CHECKS, &theme.translate("recorder.lines"), |ui| {
        ui.set_width(300.0);
        for line in recorder.series() {
            let mut shown = line.shown;
            let words = theme.format_text(&line.name);
            let text = RichText::new(&words).color(chart::series_colour(theme, line));
            if ui.checkbox(&mut shown, text).changed() {
                actions.push(RecorderAction::Show(line.id, shown));
            }
            let mut scale = line.scale_number();
            let units = line.scales().iter().map(|scale| theme.format_text(&scale.unit)).enumerate();
            if line.scales().len() > 1 && options(ui, &words, &mut scale, units) {
                actions.push(RecorderAction::SetScale(line.id, scale));
            }
        }
        ui.separator();
        let mut one_axis = recorder.has_one_axis();
        if ui.checkbox(&mut one_axis, theme.translate("recorder.one_axis")).changed() {
            actions.push(RecorderAction::ShareAxis(one_axis));
        }
    });
    actions.into_iter().for_each(|action| context.push_action(action));
}

fn export_menu_ui(ui: &mut Ui, context: &mut Context<'_>, shot: &mut snapshot::Screenshot) {
    let theme = context.theme;
    let (some, owner) = (!context.recorder.is_empty(), context.owner);
    let mut chosen = None;
    icon_menu(ui, icons::DOWNLOAD_SIMPLE, &theme.translate("recorder.export"), |ui| {
        ui.set_min_width(200.0);
        for (id, visible) in [("recorder.csv_visible", true), ("recorder.csv_all", false)] {
            if ui.add_enabled(some, egui::Button::new(theme.translate(id))).clicked() {
                chosen = Some(Studio::AskTable { owner, visible });
                ui.close();
            }
        }
        if ui.button(theme.translate("recorder.png")).clicked() {
            shot.request(ui.ctx());
            ui.close();
        }
        ui.separator();
        if enabled_button(ui, some, icons::TRASH, &theme.translate("live.clear")).clicked() {
            chosen = Some(Studio::AskClearRecording(owner));
            ui.close();
        }
    });
    context.actions.extend(chosen);
}

/// Draws the status of the trigger and of an export in progress.
fn state_ui(ui: &mut Ui, context: &mut Context<'_>) {
    let (theme, recorder) = (context.theme, context.recorder);
    if let Some((_, state)) = recorder.trigger() {
        let id = match state {
            TriggerState::Armed => "recorder.armed",
            TriggerState::Fired(_) => "recorder.fired",
            TriggerState::Held(_) => "recorder.held",
            TriggerState::Missed => "recorder.missed",
        };
        ui.horizontal(|ui| {
            ui.label(RichText::new(icons::LIGHTNING).color(theme.palette.accent));
            ui.label(theme.caption(theme.translate(id)));
            if ui.small_button(theme.translate("recorder.disarm")).clicked() {
                context.push_action(RecorderAction::Disarm);
            }
        });
    }
    if let Some(export) = recorder.export() {
        let (done, total) = export.progress();
        ui.horizontal(|ui| {
            let part = done as f32 / total.max(1) as f32;
            ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(80.0));
            ui.label(theme.caption(theme.translate("recorder.writing")));
            if ui.small_button(theme.translate("shell.cancel")).clicked() {
                context.push_action(RecorderAction::CancelExport);
            }
        });
    }
}
