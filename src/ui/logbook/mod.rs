//! The logbook page, which lists all entries, also those of other computers that share the logbook, newest first. The
//! selected entry is shown next to the list with its old and new values, its backup and its origin.

mod detail;
mod sharing;

use egui::{Align, Id, Label, Layout, Rect, RichText, Sense, Ui, UiBuilder};
use egui_extras::{Column, TableBuilder, TableRow};
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::backups::time;
use super::controls::{dropdown, empty_placeholder, icon_button, problem_ui};
use super::device_view::PageInfo;
use super::entries::text_entry;
use super::page::page_margin;
use super::row_selection::selection_step;
use super::{Theme, icons};
use crate::app::{Action, LogbookMatches, Rgb, Studio, Text, entry_kind_text, outcome_text};
use crate::profile::ChangedItem;
use crate::store::{DeviceKey, Entry, EntryFilter, EntryId, EntryKind, LinkedEntry, Outcome};

/// The logbook page, as listed in the help.
pub(super) const PAGE: PageInfo = PageInfo::new(icons::BOOK_OPEN_TEXT, "logbook.title", "logbook.help");

const ROW: f32 = 22.0;
/// Width of the search entry in points.
const SEARCH: f32 = 200.0;
/// Widths of the time, result and device columns in points.
const TIME: f32 = 128.0;
const RESULT_COLUMN_WIDTH: f32 = 18.0;
const DEVICE: f32 = 212.0;
const NARROW_DEVICE: f32 = 168.0;
/// Width in points of the details next to the list.
const DETAIL_COLUMN_WIDTH: f32 = 330.0;
const NARROW_DETAIL: f32 = 272.0;
/// Minimum page width in points at which the normal widths are used.
const WIDE: f32 = 960.0;

#[derive(Default)]
pub(super) struct LogbookView {
    search: String,
    selected: Option<EntryId>,
    /// Whether the list must scroll to the selected entry.
    scrolls_to_selected: bool,
}

pub(super) fn logbook_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    view: &mut LogbookView,
    actions: &mut Vec<Action>,
) {
    let page = studio.logbook();
    if page.needs_search() {
        actions.push(Action::SearchLogbook(page.filter().clone()));
    }
    egui::Frame::NONE.inner_margin(page_margin(ui, theme)).show(ui, |ui| {
        let room = ui.available_rect_before_wrap();
        let (entries, line) = room.split_top_bottom_at_y(room.bottom() - sharing::HEIGHT);
        let entries = Rect { max: entries.max - egui::vec2(0.0, theme.space.between), ..entries };
        ui.scope_builder(UiBuilder::new().max_rect(entries), |ui| entries_ui(ui, theme, studio, view, actions));
        ui.scope_builder(UiBuilder::new().max_rect(line), |ui| sharing::sharing_ui(ui, theme, studio, actions));
    });
}

fn entries_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, view: &mut LogbookView, actions: &mut Vec<Action>) {
    let page = studio.logbook();
    match page.matches() {
        None => {
            ui.label(theme.label(theme.translate("logbook.reading")));
        }
        Some(Err(why)) => {
            problem_ui(ui, theme, Some(why));
            ui.add_space(theme.space.between);
            if icon_button(ui, true, icons::ARROW_CLOCKWISE, &theme.translate("logbook.refresh")).clicked() {
                actions.push(Action::SearchLogbook(page.filter().clone()));
            }
        }
        Some(Ok(matches)) => matches_ui(ui, theme, studio, view, matches, actions),
    }
}

fn matches_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    view: &mut LogbookView,
    matches: &LogbookMatches,
    actions: &mut Vec<Action>,
) {
    let is_empty = matches.entries.is_empty();
    if is_empty && *studio.logbook().filter() == EntryFilter::default() {
        empty_placeholder(ui, theme, &theme.translate("logbook.empty"), None);
        return;
    }
    toolbar_ui(ui, theme, studio, view, matches, actions);
    ui.add_space(theme.space.between);
    if is_empty {
        empty_placeholder(ui, theme, &theme.translate("logbook.no_match"), None);
        return;
    }
    let room = ui.available_rect_before_wrap();
    let detail = if room.width() < WIDE { NARROW_DETAIL } else { DETAIL_COLUMN_WIDTH };
    let (list, detail) = room.split_left_right_at_x(room.right() - detail);
    let list = Rect { max: list.max - egui::vec2(theme.space.groups, 0.0), ..list };
    ui.scope_builder(UiBuilder::new().max_rect(list), |ui| rows_ui(ui, theme, studio, view, &matches.entries));
    let selected = view.selected.and_then(|id| matches.entries.iter().find(|entry| entry.id == id));
    ui.scope_builder(UiBuilder::new().max_rect(detail), |ui| match selected {
        Some(entry) => detail::entry_ui(ui, theme, studio, view, entry, actions),
        None => {
            empty_placeholder(ui, theme, &theme.translate("logbook.select"), None);
        }
    });
}

/// Draws the filter and the number of entries.
fn toolbar_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    view: &mut LogbookView,
    matches: &LogbookMatches,
    actions: &mut Vec<Action>,
) {
    let mut filter = studio.logbook().filter().clone();
    let mut changed = false;
    ui.horizontal_wrapped(|ui| {
        let word = theme.translate("logbook.search");
        if text_entry(ui, &mut view.search, SEARCH, &word, &word).changed() {
            filter.search.clone_from(&view.search);
            changed = true;
        }
        // The device of the filter is the one after "all devices".
        let position = |device: &DeviceKey| matches.devices.iter().position(|own| own == device);
        let mut device = filter.device.as_ref().and_then(position).map_or(0, |at| at + 1);
        let devices = matches.devices.iter().map(|device| device_name(theme, studio, device, true));
        let options = std::iter::once(theme.translate("logbook.all_devices")).chain(devices).enumerate();
        if dropdown(ui, &theme.translate("logbook.device"), &mut device, options) {
            filter.device = device.checked_sub(1).and_then(|at| matches.devices.get(at)).cloned();
            changed = true;
        }
        // The asset of the filter is the one after "all assets". Without any asset, there is nothing to choose.
        if !matches.assets.is_empty() || filter.asset.is_some() {
            let position = |asset: &String| matches.assets.iter().position(|own| own == asset);
            let mut asset = filter.asset.as_ref().and_then(position).map_or(0, |at| at + 1);
            let options = std::iter::once(theme.translate("logbook.all_assets")).chain(matches.assets.iter().cloned());
            if dropdown(ui, &theme.translate("asset_card.name"), &mut asset, options.enumerate()) {
                filter.asset = asset.checked_sub(1).and_then(|at| matches.assets.get(at)).cloned();
                changed = true;
            }
        }
        let kinds = EntryKind::ALL.map(|kind| (Some(kind), theme.translate(entry_kind_text(kind))));
        let options = std::iter::once((None, theme.translate("logbook.all_kinds"))).chain(kinds);
        changed |= dropdown(ui, &theme.translate("logbook.kind"), &mut filter.what, options);
        if icon_button(ui, true, icons::ARROW_CLOCKWISE, &theme.translate("logbook.refresh")).clicked() {
            changed = true;
        }
        let count = matches.entries.len();
        let text = match (matches.has_more, count) {
            (true, _) => Text::new("logbook.newest").with("count", count),
            (false, 1) => Text::new("logbook.one"),
            (false, _) => Text::new("logbook.count").with("count", count),
        };
        ui.label(theme.label(theme.format_text(&text)));
    });
    if changed {
        actions.push(Action::SearchLogbook(filter));
    }
}

fn rows_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, view: &mut LogbookView, entries: &[Entry]) {
    let keys = Id::unique("logbook_keys");
    let selected = view.selected.and_then(|id| entries.iter().position(|entry| entry.id == id));
    let moved =
        selection_step(ui, keys).and_then(|step| selected?.checked_add_signed(step)).filter(|row| *row < entries.len());
    let selected = moved.or(selected);
    ui.spacing_mut().item_spacing.y = 0.0;
    let device = if ui.available_width() < WIDE - NARROW_DETAIL { NARROW_DEVICE } else { DEVICE };
    let mut table = TableBuilder::new(ui)
        .id_salt("logbook")
        .auto_shrink(false)
        .sense(Sense::click())
        .cell_layout(Layout::left_to_right(Align::Center))
        .min_scrolled_height(0.0);
    let jump = selected.filter(|_| view.scrolls_to_selected);
    if let Some(row) = moved.or(jump) {
        table = table.scroll_to_row(row, None).animate_scrolling(false);
        view.scrolls_to_selected = false;
    }
    let mut clicked = None;
    table
        .column(Column::exact(TIME))
        .column(Column::exact(RESULT_COLUMN_WIDTH))
        .column(Column::exact(device).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(ROW, entries.len(), |mut row| {
                let at = row.index();
                let Some(entry) = entries.get(at) else { return };
                row.set_selected(selected == Some(at));
                row_ui(&mut row, theme, studio, entry);
                if row.response().clicked() {
                    clicked = Some(at);
                }
            });
        });
    if clicked.is_some() {
        ui.memory_mut(|memory| memory.request_focus(keys));
    }
    let selected = clicked.or(selected).and_then(|row| entries.get(row));
    view.selected = selected.map(|entry| entry.id).or(view.selected);
}

fn row_ui(row: &mut TableRow<'_, '_>, theme: &Theme, studio: &Studio, entry: &Entry) {
    row.col(|ui| {
        let minutes = entry.at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string();
        ui.label(theme.monospace(minutes).color(theme.palette.muted)).on_hover_text(time(entry.at));
    });
    row.col(|ui| {
        let (icon, colour, words) = match entry.undone_by {
            Some(undo) => (icons::ARROW_COUNTER_CLOCKWISE, theme.palette.muted, undone_by(theme, undo)),
            None => result(theme, entry),
        };
        ui.label(RichText::new(icon).color(colour)).on_hover_text(words);
    });
    row.col(|ui| {
        let name = RichText::new(device_name(theme, studio, &entry.device, false));
        // The word "virtual" may be cut.
        let name = if entry.device.is_virtual { name.color(theme.palette.muted) } else { name };
        ui.add(Label::new(name).truncate());
    });
    row.col(|ui| {
        let text = format!(
            "{}  {}",
            theme.translate(entry_kind_text(entry.kind)),
            description(theme, studio, entry).replace('\n', " ")
        );
        ui.add(Label::new(text).truncate());
    });
}

/// Formats a time for use in a sentence.
fn moment(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d %H:%M:%S").to_string()
}

/// Returns the text stating when a write was undone.
fn undone_by(theme: &Theme, undo: LinkedEntry) -> String {
    theme.format_text(&Text::new("undo.undone_by").with("time", moment(undo.at)))
}

/// Returns the icon, colour and text for the outcome of an entry.
fn result(theme: &Theme, entry: &Entry) -> (&'static str, Rgb, String) {
    let palette = theme.palette;
    let words = outcome_text(entry).unwrap_or_else(|| Text::new(entry_kind_text(entry.kind)));
    let words = theme.format_text(&words);
    match entry.conclusion.as_ref().map(|end| &end.outcome) {
        Some(Outcome::Done) => (icons::CHECK_CIRCLE, palette.good, words),
        Some(Outcome::Cancelled) => (icons::STOP, palette.warn, words),
        Some(Outcome::Failed(_)) => (icons::X_CIRCLE, palette.bad, words),
        None => match entry.kind {
            EntryKind::Connected => (icons::PLUGS_CONNECTED, palette.muted, words),
            EntryKind::Assigned => (icons::PUSH_PIN, palette.muted, words),
            EntryKind::Status => (icons::WARNING_CIRCLE, palette.warn, words),
            EntryKind::Backup => (icons::FLOPPY_DISK, palette.muted, words),
            EntryKind::Check => (icons::LIST_CHECKS, palette.muted, words),
            EntryKind::Note => (icons::PENCIL_SIMPLE, palette.accent, words),
            EntryKind::Write | EntryKind::Restore | EntryKind::Preset | EntryKind::Procedure => {
                (icons::QUESTION, palette.warn, words)
            }
        },
    }
}

/// Returns the description of an entry. It does not repeat what the kind of the entry already states.
fn description(theme: &Theme, studio: &Studio, entry: &Entry) -> String {
    match (entry.kind, entry.items.as_slice(), &entry.backup) {
        (EntryKind::Connected, ..) => String::new(),
        (EntryKind::Assigned, [ChangedItem { old: None, new: Some(new), .. }], _) => new.clone(),
        (EntryKind::Assigned, [item], _) => format_change(item),
        (EntryKind::Backup, _, Some(path)) => path.display().to_string(),
        _ => theme.format_text(&studio.entry_text(entry)),
    }
}

/// Formats the old and new value of an item.
fn format_change(item: &ChangedItem) -> String {
    let [old, new] = [&item.old, &item.new].map(|value| value.as_deref().unwrap_or("–"));
    format!("{old}  →  {new}")
}

/// Returns the name of a device: its bus and serial number, and optionally its type.
fn device_name(theme: &Theme, studio: &Studio, device: &DeviceKey, has_type: bool) -> String {
    let DeviceKey { kind, device_type, serial_number, is_virtual } = device;
    let bus = studio.bus(kind).unwrap_or(kind);
    let device_type = if has_type { device_type.as_str() } else { "" };
    let parts = [bus, device_type, serial_number.as_str()];
    let name = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" · ");
    if *is_virtual { theme.format_text(&Text::new("logbook.virtual").with("device", name)) } else { name }
}
