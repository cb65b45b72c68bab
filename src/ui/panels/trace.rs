//! The trace panel of the selected session: time, direction, bytes, meaning. The newest entry is at the bottom and stays
//! visible until the user scrolls away.

use egui::{RichText, Ui};
use egui_extras::{Column, TableBuilder};

use crate::app::{AnyDevice, Studio, TraceFault};
use crate::link::Direction;
use crate::ui::controls::empty;
use crate::ui::{Theme, Views};

const ROW: f32 = 18.0;
const TIME: &str = "%H:%M:%S%.3f";

/// Draws the panel.
pub(in crate::ui) fn trace_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, _views: &mut Views) {
    let lines = studio.selected_device().map(AnyDevice::trace);
    let Some(trace) = lines.filter(|trace| !trace.lines().is_empty()) else {
        empty(ui, theme, &theme.say("trace.nothing"), None);
        return;
    };
    let palette = theme.palette;
    if trace.dropped() > 0 {
        let text = crate::app::Text::new("trace.dropped").with("count", trace.dropped());
        ui.label(RichText::new(theme.words(&text)).color(palette.warn));
    }
    let lines = trace.lines();
    TableBuilder::new(ui)
        .id_salt("trace")
        .auto_shrink(false)
        .stick_to_bottom(true)
        .column(Column::exact(96.0))
        .column(Column::exact(16.0))
        .column(Column::initial(330.0).at_least(120.0).resizable(true).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(ROW, lines.len(), |mut row| {
                let Some(line) = lines.get(row.index()) else { return };
                let arrow = if line.direction == Direction::Sent { "→" } else { "←" };
                let colour = match (line.fault, line.direction) {
                    (Some(TraceFault::Broken), _) => palette.bad,
                    (Some(TraceFault::Reported), _) => palette.warn,
                    (None, Direction::Sent) => palette.muted,
                    (None, Direction::Received) => palette.text,
                };
                row.col(|ui| {
                    let time = trace.time_of(line).map(|time| time.strftime(TIME).to_string()).unwrap_or_default();
                    ui.label(theme.mono(time).color(palette.muted));
                });
                row.col(|ui| {
                    ui.label(theme.mono(arrow).color(palette.accent));
                });
                row.col(|ui| {
                    ui.label(theme.mono(&line.bytes).color(colour));
                });
                let meaning = line.words(theme.language);
                row.col(|ui| {
                    ui.label(RichText::new(&meaning).color(colour));
                });
            });
        });
}
