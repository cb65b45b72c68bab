//! The position of an SSI encoder, large.

use egui::{RichText, Ui};

use crate::app::Rgb;
use crate::devices::ssi::protocol::{Meaning, Place};
use crate::devices::ssi::state::{Encoder, TEXTS};
use crate::devices::ssi::views::say;
use crate::ui::Skin;
use crate::ui::controls::row;
use crate::ui::panels::live::{LOW, mark as mark_ui};

pub(crate) fn value_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, ink: Rgb) {
    let last = encoder.last();
    let decoded = last.and_then(|seen| seen.decoded.as_ref());
    let place = decoded.and_then(|decoded| decoded.place);
    let (main, unit) = match place {
        Some((_, Place::Shaft { degrees, .. })) => (skin.number(degrees, 3), "°"),
        Some((_, Place::Length { millimetres })) => (skin.number(millimetres, 4), "mm"),
        None => ("–".to_owned(), ""),
    };
    let palette = skin.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(skin.sizes.live)).color(ink));
        ui.label(skin.label(unit));
        let Some(decoded) = decoded else { return };
        let is_warned = decoded.findings.iter().any(|finding| finding.meaning() == Meaning::Warning);
        let mark = match (decoded.is_valid, is_warned) {
            (false, _) => Some(("live.invalid", palette.bad)),
            (true, true) => Some(("live.warning", palette.warn)),
            (true, false) => None,
        };
        if let Some((word, ink)) = mark {
            mark_ui(ui, skin, word, ink);
        }
    });
    let Some(seen) = last else { return };
    let raw = format!("0x{:0width$X}", seen.word, width = usize::from(seen.clocks).div_ceil(4));
    if decoded.is_none() {
        let text = TEXTS.text("live.other_clocks").with("clocks", seen.clocks);
        ui.label(RichText::new(skin.words(&text)).size(skin.sizes.caption).color(palette.warn));
    }
    if ui.available_height() < LOW {
        // In a low window the plot needs the room.
        let mut words = raw;
        if let Some((_, Place::Shaft { turns, steps, .. })) = place {
            words = format!("{} {turns} · {} {steps} · {words}", skin.say("live.turns"), skin.say("live.step"));
        }
        ui.add(egui::Label::new(skin.caption(words)).truncate().selectable(true));
    } else {
        if let Some((position, Place::Shaft { turns, steps, .. })) = place {
            row(ui, skin, &skin.say("live.turns"), skin.mono(turns.to_string()));
            row(ui, skin, &skin.say("live.step"), skin.mono(steps.to_string()));
            row(ui, skin, &say(skin, "ssi_trial.position"), skin.mono(position.to_string()));
        }
        row(ui, skin, &skin.say("live.raw"), skin.mono(raw));
    }
    if let Some(stream) = encoder.streamed() {
        let clock_hz = encoder.identity.as_ref().map_or(0, |identity| identity.clock_hz);
        let text = TEXTS.text(if stream.is_limited() { "live.streamed_all" } else { "live.streamed" });
        let text = text.with_number("count", stream.hz(), 0).with_number("clock", f64::from(clock_hz) / 1e6, 1);
        ui.add(egui::Label::new(skin.caption(skin.words(&text))).wrap()).on_hover_text(skin.say("live.streamed_hint"));
    }
}
