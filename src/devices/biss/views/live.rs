//! The position of a BiSS encoder, large, and the registers that are read beside it.

use egui::{RichText, Ui};

use crate::app::{Action, Rgb};
use crate::devices::biss::procedures::PositionReading;
use crate::devices::biss::protocol::{Register, Role};
use crate::devices::biss::state::explain as words;
use crate::devices::biss::state::{Action as Biss, Encoder, Mark, TEXTS};
use crate::devices::biss::views::say;
use crate::ui::controls::{icon_menu, paragraph, row};
use crate::ui::panels::live::{LOW, mark as mark_ui};
use crate::ui::{Skin, icons};

pub(crate) fn value_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, ink: Rgb) {
    let reading = encoder.record.last();
    let raw = |own: &PositionReading| skin.word(own.raw());
    let main = reading.map(|own| own.angle().map_or_else(|| raw(own), |angle| skin.number(angle, 3)));
    let main = main.unwrap_or_else(|| "–".to_owned());
    let is_angle = reading.is_none_or(|own| own.is_split_known);
    let palette = skin.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(skin.sizes.live)).color(ink));
        ui.label(skin.label(if is_angle { "°".to_owned() } else { skin.say("live.raw") }));
        if let Some(mark) = encoder.mark() {
            let (word, ink) = match mark {
                Mark::Invalid => ("live.invalid", palette.bad),
                Mark::Warned => ("live.warning", palette.warn),
            };
            mark_ui(ui, skin, word, ink);
        }
    });
    let Some(reading) = reading else { return };
    if !is_angle {
        row(ui, skin, &skin.say("unit.steps"), skin.mono(reading.position().to_string()));
    } else if ui.available_height() < LOW {
        // In a low window the plot needs the room.
        let (turns, steps) = (skin.say("live.turns"), skin.say("live.step"));
        let words = format!("{turns} {} · {steps} {}", reading.turns, reading.steps);
        ui.add(egui::Label::new(skin.caption(words)).truncate().selectable(true));
    } else {
        row(ui, skin, &skin.say("live.turns"), skin.mono(reading.turns.to_string()));
        row(ui, skin, &skin.say("live.step"), skin.mono(reading.steps.to_string()));
        row(ui, skin, &skin.say("live.raw"), skin.mono(skin.word(reading.raw())));
    }
    if let Some(stream) = encoder.streamed() {
        let id = if stream.is_limited { "live.streamed_all" } else { "live.streamed" };
        let text = TEXTS.text(id).with_number("count", stream.hz(), 0);
        let words = skin.words(&text.with_number("clock", f64::from(stream.clock_hz) / 1e6, 1));
        ui.add(egui::Label::new(skin.caption(words)).wrap()).on_hover_text(skin.say("live.streamed_hint"));
    }
    let errors = encoder.record.crc_errors();
    if errors > 0 {
        let text = TEXTS.text("frame_card.crc_errors").with("count", errors);
        ui.label(RichText::new(skin.words(&text)).size(skin.sizes.caption).color(palette.warn));
    }
}

/// What is read beside the position: the usual registers here, any other in the register table.
pub(crate) fn watch_menu(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let word = skin.say("live.watch");
    let Some(description) = &encoder.description else { return };
    let watched = encoder.record.watched();
    icon_menu(ui, icons::EYE, &word, |ui| {
        ui.set_max_width(260.0);
        ui.label(skin.heading(&word));
        paragraph(ui, skin.caption(say(skin, "live.watch_registers")));
        let usual = [Role::Temperature, Role::Errors, Role::Warnings, Role::Mode];
        let usual: Vec<Register> = usual.iter().filter_map(|role| description.with_role(*role).cloned()).collect();
        let more = watched.iter().filter(|own| usual.iter().all(|other| other.address != own.address)).cloned();
        for register in usual.iter().cloned().chain(more) {
            let mut on = watched.iter().any(|own| own.address == register.address);
            let name = if register.name.is_empty() {
                register.address.to_string()
            } else {
                skin.words(&words::name(&register.name))
            };
            if ui.checkbox(&mut on, name).changed() {
                actions.push(Action::device(encoder.session.id, Biss::Watch(Box::new(register), on)));
            }
        }
    });
}
