//! The large live display: position, speed or the outputs of a cam program.

use egui::{RichText, Ui};

use crate::app::Rgb;
use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::StartupMode;
use crate::devices::interbus::state::{Encoder, TEXTS};
use crate::devices::interbus::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{connection_dot, row};
use crate::ui::panels::live::{LOW_PANEL_HEIGHT, raw_row, remark_ui};

/// Width of eight output indicators side by side.
const INDICATORS_WIDTH: f32 = 280.0;
const INDICATOR_SIZE: f32 = 16.0;

pub(crate) fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
    let last = encoder.record.last();
    let (main, unit) = match (last.and_then(WordReading::rpm), encoder.position()) {
        (Some(rpm), _) => (rpm.to_string(), theme.translate("unit.revolutions_per_minute")),
        (None, Some(position)) => (position.to_string(), theme.translate("unit.steps")),
        (None, None) => ("–".to_owned(), String::new()),
    };
    let palette = theme.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(theme.sizes.live)).color(ink));
        ui.label(theme.label(unit));
        if last.is_some_and(|reading| !reading.is_valid()) {
            remark_ui(ui, theme, "live.invalid", palette.bad);
        } else if last.is_some_and(|reading| reading.unexpected_bits() != 0) {
            remark_ui(ui, theme, "live.warning", palette.warn);
        }
    });
    // Rows of unknown values are drawn as well, so that the buttons below stay in place.
    let unknown = || "–".to_owned();
    let word = last.map_or_else(unknown, |reading| format!("0x{:08X}", reading.word));
    let place = last.and_then(WordReading::turn_position);
    let is_position = last.is_none_or(|reading| reading.rpm().is_none() && reading.cams().is_none());
    if ui.available_height() < LOW_PANEL_HEIGHT {
        // In a low window, there is only one line for the words, because the plot needs the space.
        let place = place.map(|own| {
            format!("{} {} · {}° · ", theme.translate("live.turns"), own.turns, theme.format_number(own.degrees, 2))
        });
        let words = format!("{}{word}", place.unwrap_or_default());
        ui.add(egui::Label::new(theme.caption(words)).truncate().selectable(true));
    } else {
        if is_position {
            let angle = |degrees| format!("{} °", theme.format_number(degrees, 3));
            let rows = [
                (theme.translate("live.turns"), place.as_ref().map(|place| place.turns.to_string())),
                (theme.translate("live.step"), place.as_ref().map(|place| place.steps.to_string())),
                (translate(theme, "ib_live.angle"), place.as_ref().map(|place| angle(place.degrees))),
            ];
            for (label, value) in rows {
                row(ui, theme, &label, theme.monospace(value.unwrap_or_else(unknown)));
            }
        }
        raw_row(ui, theme, word);
    }
    let Some(reading) = last else { return };
    if let Some(StartupMode::Cams(program)) = reading.mode
        && let Some(output) = reading.cams()
    {
        let text = TEXTS.text("ib_startup.program").with("program", program.get());
        ui.label(theme.caption(theme.format_text(&text)));
        let beside = if ui.available_width() < INDICATORS_WIDTH { 4 } else { 8 };
        ui.scope(|ui| {
            // The indicators are not interactive, so they can be less high than a button.
            ui.spacing_mut().interact_size.y = INDICATOR_SIZE;
            for first in (0..8).step_by(beside) {
                ui.horizontal(|ui| {
                    for cam in first..first + beside {
                        let on = output.outputs >> cam & 1 == 1;
                        connection_dot(ui, on, if on { palette.good } else { palette.muted });
                        ui.label(theme.caption(cam.to_string()));
                    }
                });
            }
        });
    }
}
