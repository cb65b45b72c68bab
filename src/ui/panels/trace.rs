//! The trace panel of the selected session: time, direction, bytes, meaning. The newest entry is at the bottom and
//! stays visible until the user scrolls away; what is read then stays in its place while others come and go.

use egui::{Align, RichText, Ui};
use egui_extras::{Column, TableBuilder};

use crate::app::{SessionId, Studio, Text, TraceFault};
use crate::link::Direction;
use crate::ui::controls::{empty_placeholder, name};
use crate::ui::{Theme, Views, icons};

const ROW: f32 = 18.0;
const TIME: &str = "%H:%M:%S%.3f";

#[derive(Default)]
pub(in crate::ui) struct TraceView {
    /// Session of the displayed frames, and the number of frames already dropped when the list was last drawn.
    of: Option<(SessionId, u64)>,
    offset: f32,
    is_behind: bool,
}

pub(in crate::ui) fn trace_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views) {
    let shown = studio.selected_device().filter(|device| !device.trace().lines().is_empty());
    let Some((session, trace)) = shown.map(|device| (device.id(), device.trace())) else {
        empty_placeholder(ui, theme, &theme.say("trace.nothing"), None);
        return;
    };
    let palette = theme.palette;
    let view = &mut views.trace;
    let gone = match view.of.replace((session, trace.gone())) {
        Some((before, gone)) if before == session => trace.gone().saturating_sub(gone),
        _ => {
            view.is_behind = false;
            0
        }
    };
    let mut follows = !view.is_behind;
    ui.horizontal(|ui| {
        let word = theme.say("trace.follow");
        let follow = egui::Button::selectable(follows, format!("{}  {word}", icons::FAST_FORWARD));
        let follow = name(ui.add(follow.frame_when_inactive(true)), true, &word);
        follows |= follow.on_hover_text(theme.say("trace.follow_hint")).clicked();
        if trace.dropped_count() > 0 {
            let text = Text::new("trace.dropped").with("count", trace.dropped_count());
            ui.label(RichText::new(theme.words(&text)).color(palette.warn));
        }
    });
    let lines = trace.lines();
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    let pitch = ROW + ui.spacing().item_spacing.y;
    let mut table = TableBuilder::new(ui)
        .id_salt("trace")
        .auto_shrink(false)
        // Else the last rows of a low panel are below its end.
        .min_scrolled_height(0.0)
        .stick_to_bottom(true);
    if view.is_behind && follows {
        table = table.scroll_to_row(lines.len().saturating_sub(1), Some(Align::BOTTOM)).animate_scrolling(false);
    } else if view.is_behind && gone > 0 {
        table = table.vertical_scroll_offset((view.offset - gone as f32 * pitch).max(0.0));
    }
    let shown = table
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
                    let time = trace.line_time(line).map(|time| time.strftime(TIME).to_string()).unwrap_or_default();
                    ui.label(theme.monospace(time).color(palette.muted));
                });
                row.col(|ui| {
                    ui.label(theme.monospace(arrow).color(palette.accent));
                });
                row.col(|ui| {
                    ui.label(theme.monospace(&line.bytes).color(colour));
                });
                let meaning = line.words(theme.language);
                row.col(|ui| {
                    ui.label(RichText::new(&meaning).color(colour));
                });
            });
        });
    view.offset = shown.state.clamped_offset().y;
    view.is_behind = view.offset + shown.inner_rect.height() < shown.content_size.y - pitch / 2.0;
}
