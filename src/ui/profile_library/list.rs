//! The list of profiles, by section. Only the visible rows are drawn.

use std::path::PathBuf;

use egui::{Align, Label, Layout, Rect, RichText, ScrollArea, Sense, Ui, UiBuilder, WidgetInfo, vec2};

use crate::app::{Action, LibraryAction, LibraryEntry, LibraryProblem, LibrarySection, ProfileLibrary, Rgb, Text};
use crate::ui::{Theme, icons};

/// Height of a row in points.
const ROW: f32 = 26.0;
/// Number of rows by which the page keys move the selection.
pub(super) const ROWS_PER_PAGE: isize = 12;
/// Width of the column with the icon in points.
const ICON: f32 = 26.0;
/// Width of the column with the name of the bus in points. It fits *HIPERDRIVE*.
const BUS: f32 = 84.0;
/// Fraction of the remaining width for the file name.
const NAME: f32 = 0.46;

/// State of the list.
#[derive(Default)]
pub(super) struct ListView {
    /// The profile that was selected in the last frame. The list scrolls to another one.
    shown: Option<PathBuf>,
}

enum Line<'l> {
    Heading(LibrarySection),
    Entry(&'l LibraryEntry),
}

pub(super) fn list_ui(
    ui: &mut Ui,
    theme: &Theme,
    library: &ProfileLibrary,
    view: &mut ListView,
    actions: &mut Vec<Action>,
) {
    let mut lines = Vec::new();
    let mut section = None;
    for entry in library.entries() {
        if section.replace(entry.section()) != Some(entry.section()) {
            lines.push(Line::Heading(entry.section()));
        }
        lines.push(Line::Entry(entry));
    }
    let selected = library.selected().map(LibraryEntry::path);
    let scrolls = view.shown.as_deref() != selected;
    view.shown = selected.map(ToOwned::to_owned);
    let is_selected = |line: &Line<'_>| matches!(line, Line::Entry(entry) if Some(entry.path()) == selected);
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().id_salt("profiles").auto_shrink(false).show_rows(ui, ROW, lines.len(), |ui, rows| {
        if let Some(at) = lines.iter().position(is_selected).filter(|_| scrolls) {
            let top = ui.max_rect().top() + (at as f32 - rows.start as f32) * ROW;
            ui.scroll_to_rect(Rect::from_x_y_ranges(ui.max_rect().x_range(), top..=top + ROW), None);
        }
        for line in lines.get(rows).unwrap_or_default() {
            match line {
                Line::Heading(section) => heading_ui(ui, theme, *section),
                Line::Entry(entry) => row_ui(ui, theme, entry, is_selected(line), actions),
            }
        }
    });
}

fn heading_ui(ui: &mut Ui, theme: &Theme, section: LibrarySection) {
    let word = match section {
        LibrarySection::Recent => "library.recent",
        LibrarySection::ReadyMade => "library.ready_made",
        LibrarySection::SameFolder => "library.same_folder",
    };
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    cell_ui(ui, rect.with_min_x(rect.left() + theme.space.inside), theme.caption(theme.translate(word)));
}

fn row_ui(ui: &mut Ui, theme: &Theme, entry: &LibraryEntry, is_selected: bool, actions: &mut Vec<Action>) {
    let palette = theme.palette;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::CLICK);
    if is_selected {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().selection.bg_fill);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let (icon, name_ink, ink) = match entry.problem() {
        None => (icons::FILE_TEXT, palette.text, palette.muted),
        Some(LibraryProblem::Missing(_)) => (icons::WARNING, palette.muted, palette.muted),
        Some(LibraryProblem::Invalid(_)) => (icons::X_CIRCLE, palette.text, palette.bad),
    };
    let summary = match (entry.problem(), entry.profile()) {
        (Some(problem), _) => first_sentence(&theme.format_text(problem.text())),
        (None, Some(profile)) => profile.summary(),
        (None, None) => String::new(),
    };
    let bus = entry.profile().map(|profile| profile.bus()).unwrap_or_default();
    let inner = rect.shrink2(vec2(theme.space.inside, 0.0));
    let (icon_cell, rest) = inner.split_left_right_at_x(inner.left() + ICON);
    let (rest, bus_cell) = rest.split_left_right_at_x(rest.right() - if bus.is_empty() { 0.0 } else { BUS });
    let (name_cell, summary_cell) = rest.split_left_right_at_fraction(NAME);
    let gap = |cell: Rect| cell.with_max_x(cell.right() - theme.space.between);
    let text = |words: &str, ink: Rgb| RichText::new(words).color(ink);
    cell_ui(ui, icon_cell, text(icon, if entry.problem().is_some() { ink } else { palette.muted }));
    cell_ui(ui, gap(name_cell), text(&entry.file_name(), name_ink));
    cell_ui(ui, gap(summary_cell), text(&summary, ink));
    cell_ui(ui, bus_cell, theme.caption(bus));
    let name = theme.format_text(&Text::new("library.group").with("group", entry.file_name()).with("count", &summary));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, is_selected, &name));
    let select = || Action::Library(LibraryAction::Select(entry.path().to_owned()));
    if response.double_clicked() {
        actions.extend([select(), Action::Library(LibraryAction::OpenSelected)]);
    } else if response.clicked() {
        actions.push(select());
    }
    response.on_hover_text(entry.path().display().to_string());
}

fn cell_ui(ui: &mut Ui, rect: Rect, text: RichText) {
    let layout = Layout::left_to_right(Align::Center);
    ui.scope_builder(UiBuilder::new().max_rect(rect).layout(layout), |ui| {
        ui.add(Label::new(text).truncate().selectable(false));
    });
}

/// Returns the first sentence of a message. The preview shows all of it.
fn first_sentence(words: &str) -> String {
    words.split_inclusive(". ").next().unwrap_or_default().trim_end().to_owned()
}
