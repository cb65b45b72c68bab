//! What an INTERBUS encoder sends, large: its position, its speed, or the outputs of a program.

use egui::{RichText, Ui};

use crate::app::Rgb;
use crate::devices::interbus::procedures::Reading;
use crate::devices::interbus::protocol::StartupMode;
use crate::devices::interbus::state::{Encoder, TEXTS};
use crate::devices::interbus::views::say;
use crate::ui::Skin;
use crate::ui::controls::{dot, row};
use crate::ui::panels::live::{LOW, mark};

/// Width that eight outputs need beside each other.
const LAMPS: f32 = 280.0;
/// Height of a row of them.
const LAMP: f32 = 16.0;

pub(crate) fn value_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, ink: Rgb) {
    let last = encoder.record.last();
    let (main, unit) = match (last.and_then(Reading::rpm), encoder.position()) {
        (Some(rpm), _) => (rpm.to_string(), skin.say("unit.revolutions_per_minute")),
        (None, Some(position)) => (position.to_string(), skin.say("unit.steps")),
        (None, None) => ("–".to_owned(), String::new()),
    };
    let palette = skin.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(skin.sizes.live)).color(ink));
        ui.label(skin.label(unit));
        if last.is_some_and(|reading| !reading.is_valid()) {
            mark(ui, skin, "live.invalid", palette.bad);
        } else if last.is_some_and(|reading| reading.stray() != 0) {
            mark(ui, skin, "live.warning", palette.warn);
        }
    });
    let Some(reading) = last else { return };
    let word = format!("0x{:08X}", reading.word);
    let place = reading.place();
    if ui.available_height() < LOW {
        // In a low window the plot needs the room.
        let place =
            place.map(|own| format!("{} {} · {}° · ", skin.say("live.turns"), own.turns, skin.number(own.degrees, 2)));
        let words = format!("{}{word}", place.unwrap_or_default());
        ui.add(egui::Label::new(skin.caption(words)).truncate().selectable(true));
    } else {
        if let Some(place) = place {
            row(ui, skin, &skin.say("live.turns"), skin.mono(place.turns.to_string()));
            row(ui, skin, &skin.say("live.step"), skin.mono(place.steps.to_string()));
            row(ui, skin, &say(skin, "ib_live.angle"), skin.mono(format!("{} °", skin.number(place.degrees, 3))));
        }
        row(ui, skin, &skin.say("live.raw"), skin.mono(word));
    }
    if let Some(StartupMode::Cams(program)) = reading.mode
        && let Some(output) = reading.cams()
    {
        let text = TEXTS.text("ib_startup.program").with("program", program.get());
        ui.label(skin.caption(skin.words(&text)));
        let beside = if ui.available_width() < LAMPS { 4 } else { 8 };
        ui.scope(|ui| {
            // Lamps are read, not touched.
            ui.spacing_mut().interact_size.y = LAMP;
            for first in (0..8).step_by(beside) {
                ui.horizontal(|ui| {
                    for cam in first..first + beside {
                        let on = output.outputs >> cam & 1 == 1;
                        dot(ui, on, if on { palette.good } else { palette.muted });
                        ui.label(skin.caption(cam.to_string()));
                    }
                });
            }
        });
    }
}
