//! Shows the position of an SSI encoder in large digits.

use egui::{RichText, Ui};

use crate::app::Rgb;
use crate::devices::ssi::protocol::{BitMeaning, Location};
use crate::devices::ssi::state::{Encoder, TEXTS};
use crate::devices::ssi::views::translate;
use crate::ui::Theme;
use crate::ui::controls::row;
use crate::ui::panels::live::{LOW_PANEL_HEIGHT, raw_row, remark_ui as mark_ui};

pub(crate) fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
    let last = encoder.last();
    let decoded = last.and_then(|seen| seen.decoded.as_ref());
    let place = decoded.and_then(|decoded| decoded.place);
    let (main, unit) = match place {
        Some((_, Location::Shaft { degrees, .. })) => (theme.format_number(degrees, 3), "°"),
        Some((_, Location::Length { millimetres })) => (theme.format_number(millimetres, 4), "mm"),
        None => ("–".to_owned(), ""),
    };
    let palette = theme.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(theme.sizes.live)).color(ink));
        ui.label(theme.label(unit));
        let Some(decoded) = decoded else { return };
        let is_warned = decoded.findings.iter().any(|finding| finding.meaning() == BitMeaning::Warning);
        let mark = match (decoded.is_valid, is_warned) {
            (false, _) => Some(("live.invalid", palette.bad)),
            (true, true) => Some(("live.warning", palette.warn)),
            (true, false) => None,
        };
        if let Some((word, ink)) = mark {
            mark_ui(ui, theme, word, ink);
        }
    });
    let Some(seen) = last else { return };
    let raw = format!("0x{:0width$X}", seen.word, width = usize::from(seen.clocks).div_ceil(4));
    if decoded.is_none() {
        let text = TEXTS.text("live.other_clocks").with("clocks", seen.clocks);
        ui.label(RichText::new(theme.format_text(&text)).size(theme.sizes.caption).color(palette.warn));
    }
    if ui.available_height() < LOW_PANEL_HEIGHT {
        // In a low window, the plot needs the space.
        let mut words = raw;
        if let Some((_, Location::Shaft { turns, steps, .. })) = place {
            words = format!(
                "{} {turns} · {} {steps} · {words}",
                theme.translate("live.turns"),
                theme.translate("live.step")
            );
        }
        ui.add(egui::Label::new(theme.caption(words)).truncate().selectable(true));
    } else {
        if let Some((position, Location::Shaft { turns, steps, .. })) = place {
            row(ui, theme, &theme.translate("live.turns"), theme.monospace(turns.to_string()));
            row(ui, theme, &theme.translate("live.step"), theme.monospace(steps.to_string()));
            row(ui, theme, &translate(theme, "ssi_trial.position"), theme.monospace(position.to_string()));
        }
        raw_row(ui, theme, raw);
    }
    if let Some(stream) = encoder.current_stream() {
        let clock_hz = encoder.identity.as_ref().map_or(0, |identity| identity.clock_hz);
        let text = TEXTS.text(if stream.is_limited() { "live.streamed_all" } else { "live.streamed" });
        let text =
            text.with_number("count", stream.frame_rate_hz(), 0).with_number("clock", f64::from(clock_hz) / 1e6, 1);
        ui.add(egui::Label::new(theme.caption(theme.format_text(&text))).wrap())
            .on_hover_text(theme.translate("live.streamed_hint"));
    }
}
