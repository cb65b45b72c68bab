//! The details of a selected frame: all of its bytes and its decoded content.

use egui::text::LayoutJob;
use egui::{FontId, Label, RichText, ScrollArea, TextFormat, Ui};

use super::{TIME, frame_colour};
use crate::app::{Text, TraceLine, TraceLog};
use crate::link::Direction;
use crate::ui::controls::{fill_width, icon_button};
use crate::ui::{Theme, icons};

/// Number of bytes per line.
const COLUMNS: usize = 8;

/// Draws the frame. Returns whether to close it.
pub(super) fn frame_ui(ui: &mut Ui, theme: &Theme, log: &TraceLog, line: &TraceLine) -> bool {
    let mut closes = false;
    ui.horizontal(|ui| {
        let word = theme.translate(if line.direction == Direction::Sent { "trace.sent" } else { "trace.received" });
        ui.label(theme.label(word));
        let time = log.line_time(line).map(|time| time.strftime(TIME).to_string()).unwrap_or_default();
        ui.label(theme.monospace(time));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            closes = icon_button(ui, true, icons::X, &theme.translate("trace.close_frame")).clicked();
        });
    });
    ScrollArea::vertical().id_salt("frame").auto_shrink(false).show(ui, |ui| {
        fill_width(ui);
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        let colour = frame_colour(theme, line);
        for text in &line.meaning {
            ui.add(Label::new(RichText::new(theme.format_text(text)).color(colour)).wrap().selectable(true));
        }
        ui.add(Label::new(hex_dump(theme, line)).selectable(true));
        if line.header > 0 {
            let text = Text::new("trace.header").with("count", line.header);
            ui.add(Label::new(RichText::new(theme.format_text(&text)).color(theme.palette.muted)).wrap());
        }
    });
    closes
}

/// Returns the bytes in lines with their offsets. The bytes of the transport header are muted.
fn hex_dump(theme: &Theme, line: &TraceLine) -> LayoutJob {
    let font = FontId::monospace(theme.sizes.body);
    let format = |muted: bool| {
        let colour = if muted { theme.palette.muted } else { theme.palette.text };
        TextFormat { font_id: font.clone(), color: colour.into(), ..TextFormat::default() }
    };
    let bytes: Vec<&str> = line.bytes.split(' ').filter(|byte| !byte.is_empty()).collect();
    let mut job = LayoutJob::default();
    for (row, chunk) in bytes.chunks(COLUMNS).enumerate() {
        let newline = if row > 0 { "\n" } else { "" };
        job.append(&format!("{newline}{:04X} ", row * COLUMNS), 0.0, format(true));
        for (column, byte) in chunk.iter().enumerate() {
            job.append(&format!(" {byte}"), 0.0, format(row * COLUMNS + column < line.header));
        }
    }
    job
}
