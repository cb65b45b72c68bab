//! The large display of a drive: position, state, speed and target.

use egui::{RichText, TextStyle, TextWrapMode, Ui, WidgetText};

use super::outside::warning_badge;
use crate::app::{Action, Rgb};
use crate::devices::hiperdrive::procedures::Temperature;
use crate::devices::hiperdrive::protocol::{PositionScale, State, to_turns_and_steps};
use crate::devices::hiperdrive::state::{HiperdriveAction, HiperdriveDevice, PositionUnit, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{icon_menu, paragraph, row};
use crate::ui::panels::live::{LOW_PANEL_HEIGHT, raw_row};
use crate::ui::{Theme, icons};

pub(crate) fn value_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, ink: Rgb) {
    let drive = unit.drive();
    let actual = unit.actual_values(drive);
    let ruler = unit.ruler(drive);
    let in_measure = |steps: i32, measure: PositionUnit| {
        // More than three decimals would be of no use.
        let decimals = ruler.decimal_places(measure).min(3);
        ruler.from_steps(steps.into(), measure).map(|value| theme.format_number(value, decimals))
    };
    let main = actual.map(|own| in_measure(own.position, unit.measure).unwrap_or_else(|| own.position.to_string()));
    let palette = theme.palette;
    let mut warning = warning_badge(theme, unit);
    ui.horizontal(|ui| {
        let shown = main.unwrap_or_else(|| "–".to_owned());
        let ink = if unit.outside_limits_text(drive).is_some() { palette.bad } else { ink };
        ui.label(RichText::new(shown).font(egui::FontId::monospace(theme.sizes.live)).color(ink));
        // The unit and the warning are on the same line, so that nothing below moves when the warning appears.
        let measure = theme.label(translate(theme, unit.measure.unit()));
        ui.label(measure);
        if let Some(badge) = warning.take_if(|own| fits_width(ui, own)) {
            ui.label(badge);
        }
    });
    // If there is no space for the warning, it is drawn before the state.
    let is_told_below = warning.is_some();
    let Some(actual) = actual else { return };
    let state = actual.status.state();
    let colour = match state {
        _ if is_told_below => palette.bad,
        State::Fault => palette.bad,
        State::Locked => palette.warn,
        State::Moving | State::Enabled => palette.good,
        State::NotReady | State::Ready | State::Operational => palette.muted,
    };
    let word = theme.format_text(&explain::state_text(state));
    // The text fits on one line beside the widest state, so the rows below do not move.
    let told_below = TEXTS.text("hd_outside.beside_state").with("state", &word);
    let word = if is_told_below { theme.format_text(&told_below) } else { word };
    let rpm = theme.format_number(unit.speed_scale(drive).rpm(actual.speed), 1);
    let speed = format!("{rpm} {}", theme.translate("unit.revolutions_per_minute"));
    if ui.available_height() < LOW_PANEL_HEIGHT {
        // In a low window, the plot needs the space.
        let words = format!("{word} · {speed}");
        ui.add(egui::Label::new(RichText::new(words).size(theme.sizes.caption).color(colour)).truncate());
        return;
    }
    row(ui, theme, &translate(theme, "hd_live.state"), RichText::new(word).color(colour));
    row(ui, theme, &translate(theme, "hd_effort.speed"), theme.monospace(speed));
    // The row is drawn even without a target, so that the buttons below stay in place when control is taken. Only a
    // move has a target, although the cyclic data always contain a number.
    let target = unit.moves.target(drive).map(|target| in_measure(target, unit.measure).unwrap_or_default());
    let target = target.map(|target| format!("{target} {}", translate(theme, unit.measure.unit())));
    let target = theme.monospace(target.unwrap_or_else(|| "–".to_owned()));
    row(ui, theme, &translate(theme, "hd_live.target"), target);
    if ruler.scale == PositionScale::FACTORY {
        let (turn, step) = to_turns_and_steps(actual.position);
        row(ui, theme, &theme.translate("live.turns"), theme.monospace(turn.to_string()));
        row(ui, theme, &theme.translate("live.step"), theme.monospace(step.to_string()));
    }
    raw_row(ui, theme, actual.position.to_string());
}

/// Draws the menu for selecting temperatures to record with the position.
pub(super) fn watch_menu(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let word = theme.translate("live.watch");
    let watched = unit.watched_temperatures();
    icon_menu(ui, icons::EYE, &word, |ui| {
        ui.set_max_width(240.0);
        ui.label(theme.heading(&word));
        paragraph(ui, theme.caption(translate(theme, "hd_watch.words")));
        let usual = [(Temperature::Device, "hd_parameter.11"), (Temperature::Drive(unit.drive()), "hd_parameter.119")];
        for (what, name) in usual {
            let mut on = watched.contains(&what);
            if ui.checkbox(&mut on, translate(theme, name)).changed() {
                actions.push(Action::device(unit.session.id, HiperdriveAction::Watch(what, on)));
            }
        }
    });
}

fn fits_width(ui: &Ui, text: &RichText) -> bool {
    let text = WidgetText::from(text.clone());
    let galley = text.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body);
    galley.size().x <= ui.available_width()
}
