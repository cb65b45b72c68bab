//! Large display of the position and of the values polled with it.

use egui::{RichText, Ui};

use crate::app::{Action, Rgb};
use crate::devices::hiperface::procedures::WatchedQuantity;
use crate::devices::hiperface::state::{self, Encoder, HiperfaceAction as Hiperface};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{enabled_button, icon_menu, paragraph, row, text_entry};
use crate::ui::panels::live::{LOW_PANEL_HEIGHT, raw_row, remark_ui, unknown_rows};
use crate::ui::{Theme, icons};

pub(crate) fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
    let record = &encoder.record;
    let reading = record.last();
    let position = reading.and_then(|reading| reading.position);
    let number = |value: f64, decimals: usize| theme.format_number(value, decimals);
    let (main, unit) = match (reading, position) {
        (_, Some(position)) if position.millimetres().is_some() => {
            (number(position.millimetres().unwrap_or_default(), 4), "mm".to_owned())
        }
        (_, Some(position)) => (number(position.degrees().unwrap_or_default(), 3), "°".to_owned()),
        (Some(reading), None) => (reading.raw.to_string(), translate(theme, "live.steps")),
        (None, None) => ("–".to_owned(), String::new()),
    };
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(theme.sizes.live)).color(ink));
        ui.label(theme.label(unit));
        if record.is_position_refused() {
            remark_ui(ui, theme, "live.refused", theme.palette.bad);
        } else if reading.is_some_and(|reading| !reading.valid) {
            remark_ui(ui, theme, "live.invalid", theme.palette.bad);
        }
    });
    let Some(reading) = reading else { return unknown_rows(ui, theme, &["live.turns", "live.step", "live.raw"]) };
    let place = position.and_then(|position| Some((position.turns()?, position.steps()?)));
    if ui.available_height() < LOW_PANEL_HEIGHT {
        // If the window is not high enough, the space is needed for the plot.
        let mut words = format!("{:08X}h", reading.raw);
        if let Some((turns, steps)) = place {
            words = format!(
                "{} {turns} · {} {steps} · {words}",
                theme.translate("live.turns"),
                theme.translate("live.step")
            );
        }
        ui.add(egui::Label::new(theme.caption(words)).truncate().selectable(true));
        return;
    }
    if let Some((turns, steps)) = place {
        row(ui, theme, &theme.translate("live.turns"), theme.monospace(turns.to_string()));
        row(ui, theme, &theme.translate("live.step"), theme.monospace(steps.to_string()));
    }
    raw_row(ui, theme, format!("{:08X}h  {}", reading.raw, reading.raw));
}

pub(crate) fn watch_menu(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    channel: &mut String,
    actions: &mut Vec<Action>,
) {
    let word = theme.translate("live.watch");
    let watched = encoder.record.watched_values();
    icon_menu(ui, icons::EYE, &word, |ui| {
        ui.set_max_width(240.0);
        ui.label(theme.heading(&word));
        paragraph(ui, theme.caption(translate(theme, "live.watch_words")));
        let usual = [WatchedQuantity::TEMPERATURE, WatchedQuantity::Counter];
        let more = watched.iter().copied().filter(|own| !usual.contains(own));
        for what in usual.into_iter().chain(more.collect::<Vec<_>>()) {
            let mut on = watched.contains(&what);
            if ui.checkbox(&mut on, theme.format_text(&state::watch_name(what))).changed() {
                actions.push(Action::device(encoder.session.id, Hiperface::Watch(what, on)));
            }
        }
        ui.horizontal(|ui| {
            ui.label(theme.label(translate(theme, "analogue_card.channel")));
            text_entry(ui, channel, 48.0, &translate(theme, "analogue_card.channel"), "48");
            let entered = state::forms::parse_channel(channel);
            if enabled_button(ui, entered.is_ok(), icons::PLUS, &translate(theme, "live.watch_add")).clicked()
                && let Ok(channel) = entered
            {
                actions.push(Action::device(
                    encoder.session.id,
                    Hiperface::Watch(WatchedQuantity::Analogue(channel), true),
                ));
            }
        });
    });
}
