//! The trace panel of the selected session: time, gap, direction, bytes, meaning. The newest frame is at the bottom and
//! stays visible until the user scrolls up or pauses the list. After that, the visible frames keep their place while
//! others arrive.

use egui::{Align, RichText, Ui};
use egui_extras::{Column, TableBuilder, TableRow};

use crate::app::{Action, SessionId, Studio, Text, TraceFault, TraceFilter, TraceLine, TraceLog, TraceMatches};
use crate::link::Direction;
use crate::ui::controls::{empty_placeholder, icon_button, name};
use crate::ui::entries::text_entry;
use crate::ui::{Theme, Views, icons};

const ROW: f32 = 18.0;
const TIME: &str = "%H:%M:%S%.3f";
/// Width of the search entry in points.
const SEARCH: f32 = 200.0;

#[derive(Default)]
pub(in crate::ui) struct TraceView {
    session: Option<SessionId>,
    filter: TraceFilter,
    matches: TraceMatches,
    /// Number of the first frame that is hidden because the list is paused.
    paused_at: Option<u64>,
    /// Number of rows that the log had removed when the list was last drawn with the same filter.
    removed: Option<u64>,
    offset: f32,
    /// Whether the user has scrolled up.
    is_behind: bool,
}

impl TraceView {
    fn select(&mut self, session: SessionId, log: &TraceLog) {
        if self.session.replace(session) != Some(session) {
            let filter = std::mem::take(&mut self.filter);
            *self = TraceView { session: Some(session), filter, ..TraceView::default() };
        }
        // A new connection starts a new log, to which an old pause does not apply.
        self.paused_at = self.paused_at.filter(|end| *end <= log.end());
    }
}

pub(in crate::ui) fn trace_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let shown = studio.selected_device().filter(|device| !device.trace().lines().is_empty());
    let Some((session, log)) = shown.map(|device| (device.id(), device.trace())) else {
        empty_placeholder(ui, theme, &theme.say("trace.nothing"), None);
        return;
    };
    let view = &mut views.trace;
    view.select(session, log);
    let jumps_to_end = toolbar(ui, theme, view, log, actions);
    let end = view.paused_at.unwrap_or(log.end());
    let (filters, language) = (!view.filter.is_empty(), theme.language);
    if filters {
        view.matches.update(log, &view.filter, language, end);
    }
    let matches = filters.then_some(&view.matches);
    let (rows, removed) = match matches {
        Some(matches) => (matches.numbers().len(), matches.removed()),
        None => (usize::try_from(end.saturating_sub(log.gone())).unwrap_or_default(), log.gone()),
    };
    let gone = view.removed.replace(removed).map_or(0, |before| removed.saturating_sub(before));
    if rows == 0 {
        let words = match view.filter.search.trim() {
            "" => theme.words(&Text::new("trace.no_faults").with("count", log.lines().len())),
            _ => theme.say("trace.no_match"),
        };
        empty_placeholder(ui, theme, &words, None);
        return;
    }
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    let pitch = ROW + ui.spacing().item_spacing.y;
    let mut table = TableBuilder::new(ui)
        .id_salt("trace")
        .auto_shrink(false)
        // Otherwise, the last rows of a low panel would be below its end.
        .min_scrolled_height(0.0)
        .stick_to_bottom(true);
    if jumps_to_end {
        table = table.scroll_to_row(rows - 1, Some(Align::BOTTOM)).animate_scrolling(false);
    } else if view.is_behind && gone > 0 {
        table = table.vertical_scroll_offset((view.offset - gone as f32 * pitch).max(0.0));
    }
    let drawn = table
        .column(Column::exact(96.0))
        .column(Column::exact(76.0))
        .column(Column::exact(16.0))
        .column(Column::initial(330.0).at_least(120.0).resizable(true).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(ROW, rows, |mut row| {
                let number = match matches {
                    Some(matches) => matches.numbers().get(row.index()).copied(),
                    None => Some(log.gone() + row.index() as u64),
                };
                let Some((number, line)) = number.and_then(|number| Some((number, log.line(number)?))) else { return };
                let before = number.checked_sub(1).and_then(|before| log.line(before));
                line_ui(&mut row, theme, log, line, before);
            });
        });
    view.offset = drawn.state.clamped_offset().y;
    view.is_behind = view.offset + drawn.inner_rect.height() < drawn.content_size.y - pitch / 2.0;
}

/// Draws search, filter, pause and save. Returns whether the newest frame is to be shown.
fn toolbar(ui: &mut Ui, theme: &Theme, view: &mut TraceView, log: &TraceLog, actions: &mut Vec<Action>) -> bool {
    let mut jumps_to_end = false;
    ui.horizontal(|ui| {
        let follows = !view.is_behind && view.paused_at.is_none();
        let word = theme.say("trace.follow");
        let follow = egui::Button::selectable(follows, format!("{}  {word}", icons::FAST_FORWARD));
        let follow = name(ui.add(follow.frame_when_inactive(true)), true, &word);
        if follow.on_hover_text(theme.say("trace.follow_hint")).clicked() {
            view.paused_at = follows.then(|| log.end());
            jumps_to_end = !follows;
        }
        let mut changed = false;
        let word = theme.say("trace.faults");
        let faults = egui::Button::selectable(view.filter.faults_only, format!("{}  {word}", icons::WARNING));
        if name(ui.add(faults.frame_when_inactive(true)), true, &word).clicked() {
            view.filter.faults_only = !view.filter.faults_only;
            changed = true;
        }
        let word = theme.say("trace.search");
        if text_entry(ui, &mut view.filter.search, SEARCH, &word, &word).changed() {
            changed = true;
        }
        if changed {
            view.removed = None;
            jumps_to_end = true;
        }
        if icon_button(ui, true, icons::FLOPPY_DISK, &theme.say("trace.save")).clicked() {
            actions.extend(view.session.map(Action::AskTrace));
        }
        if let Some(end) = view.paused_at {
            let text = Text::new("trace.paused").with("count", log.end().saturating_sub(end));
            ui.label(theme.label(theme.words(&text)));
        } else if !view.filter.is_empty() {
            let shown = view.matches.numbers().len();
            let text = Text::new("trace.matches").with("shown", shown).with("all", log.lines().len());
            ui.label(theme.label(theme.words(&text)));
        }
        if log.dropped_count() > 0 {
            let text = Text::new("trace.dropped").with("count", log.dropped_count());
            ui.add(egui::Label::new(RichText::new(theme.words(&text)).color(theme.palette.warn)).truncate());
        }
    });
    jumps_to_end
}

fn line_ui(row: &mut TableRow<'_, '_>, theme: &Theme, log: &TraceLog, line: &TraceLine, before: Option<&TraceLine>) {
    let palette = theme.palette;
    let arrow = if line.direction == Direction::Sent { "→" } else { "←" };
    let colour = match (line.fault, line.direction) {
        (Some(TraceFault::Broken), _) => palette.bad,
        (Some(TraceFault::Reported), _) => palette.warn,
        (None, Direction::Sent) => palette.muted,
        (None, Direction::Received) => palette.text,
    };
    row.col(|ui| {
        let time = log.line_time(line).map(|time| time.strftime(TIME).to_string()).unwrap_or_default();
        ui.label(theme.monospace(time).color(palette.muted));
    });
    row.col(|ui| {
        let Some(before) = before else { return };
        let seconds = line.at.since(before.at).as_secs_f64();
        let gap = match seconds {
            10.0.. => format!("+{} s", theme.number(seconds, 1)),
            _ => format!("+{} ms", theme.number(seconds * 1e3, 1)),
        };
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(theme.space.inside);
            ui.label(theme.monospace(gap).color(palette.muted));
        });
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
}
