//! The dialog of the profile library: the search, the list of profiles, and a preview of the selected one.

mod list;
mod preview;

use egui::{Id, Key, Modifiers, Rect, Ui, UiBuilder, vec2};

use super::controls::{
    dropdown, empty_placeholder, enabled_button, labelled_button, modal, primary_button, right_aligned, spinner,
};
use super::entries::text_entry;
use super::{Theme, icons};
use crate::app::{Action, LibraryAction, LibraryEntry, ProfileLibrary, Studio, Text};

/// Maximum size of the dialog in points.
const WIDTH: f32 = 1080.0;
const HEIGHT: f32 = 720.0;
/// Space between the dialog and the window in points.
const MARGIN: f32 = 24.0;
/// Width of the search entry in points.
const SEARCH: f32 = 260.0;
/// Fraction of the width for the list.
const LIST_FRACTION: f32 = 0.58;

/// State of the dialog while it is open.
#[derive(Default)]
pub(super) struct LibraryView {
    /// The search entry, once it has been drawn.
    entry: Option<Id>,
    list: list::ListView,
}

pub(super) fn library_ui(
    ctx: &egui::Context,
    theme: &Theme,
    studio: &Studio,
    view: &mut LibraryView,
    actions: &mut Vec<Action>,
) {
    let Some(library) = studio.profile_library() else {
        *view = LibraryView::default();
        return;
    };
    let window = ctx.content_rect().size();
    let inside = 2.0 * (MARGIN + theme.space.groups);
    let size = vec2((window.x - inside).min(WIDTH), (window.y - inside).min(HEIGHT));
    modal(ctx, theme, "profile library", size.x, |ui| {
        ui.set_height(size.y);
        handle_keys(ui, view, actions);
        ui.label(theme.heading(theme.translate("library.title")));
        ui.add_space(theme.space.between);
        toolbar_ui(ui, theme, studio, library, view, actions);
        ui.add_space(theme.space.between);
        let below = ui.spacing().interact_size.y + theme.space.groups;
        let room = ui.available_rect_before_wrap();
        let (content, buttons) = room.split_top_bottom_at_y(room.bottom() - below);
        ui.scope_builder(UiBuilder::new().max_rect(content), |ui| content_ui(ui, theme, library, view, actions));
        let buttons = buttons.with_min_y(buttons.top() + theme.space.groups);
        ui.scope_builder(UiBuilder::new().max_rect(buttons), |ui| buttons_ui(ui, theme, library, actions));
    });
}

/// Handles the arrow keys and Enter while the search entry has the keyboard focus. It gets the focus unless another
/// widget of the dialog has it.
fn handle_keys(ui: &Ui, view: &LibraryView, actions: &mut Vec<Action>) {
    let is_on_top = ui.memory(|memory| memory.top_modal_layer()) == Some(ui.layer_id());
    let Some(entry) = view.entry.filter(|_| is_on_top && !egui::Popup::is_any_open(ui.ctx())) else { return };
    if ui.memory(|memory| memory.focused()).is_none() {
        ui.memory_mut(|memory| memory.request_focus(entry));
    }
    if !ui.memory(|memory| memory.has_focus(entry)) {
        return;
    }
    let page = list::ROWS_PER_PAGE;
    for (key, step) in [(Key::ArrowDown, 1), (Key::ArrowUp, -1), (Key::PageDown, page), (Key::PageUp, -page)] {
        let count = ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as isize;
        if count > 0 {
            actions.push(Action::Library(LibraryAction::Step(count * step)));
        }
    }
    if ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter)) {
        actions.push(Action::Library(LibraryAction::OpenSelected));
    }
}

/// Draws the search, the filter and the number of profiles.
fn toolbar_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    library: &ProfileLibrary,
    view: &mut LibraryView,
    actions: &mut Vec<Action>,
) {
    ui.horizontal(|ui| {
        let mut search = library.search().to_owned();
        let (label, hint) = (theme.translate("library.search"), theme.translate("library.search_hint"));
        let response = text_entry(ui, &mut search, SEARCH, &label, &hint);
        if view.entry.replace(response.id).is_none() {
            response.request_focus();
        }
        if response.changed() {
            actions.push(Action::Library(LibraryAction::Search(search)));
        }
        let mut kind = library.kind();
        let kinds = studio.profile_kinds().map(|(kind, bus)| (Some(kind), bus.to_owned()));
        let options = std::iter::once((None, theme.translate("library.all_kinds"))).chain(kinds);
        if dropdown(ui, &theme.translate("library.kind"), &mut kind, options) {
            actions.push(Action::Library(LibraryAction::ShowKind(kind)));
        }
        if library.is_reading() {
            spinner(ui, theme);
            ui.label(theme.label(theme.translate("library.reading")));
        } else {
            ui.label(theme.label(theme.format_text(&count_text(library))));
        }
    });
}

fn count_text(library: &ProfileLibrary) -> Text {
    let count = library.entries().count();
    match (library.is_truncated(), count) {
        (true, _) => Text::new("library.truncated").with("count", count),
        (false, 1) => Text::new("library.one"),
        (false, _) => Text::new("library.count").with("count", count),
    }
}

fn content_ui(ui: &mut Ui, theme: &Theme, library: &ProfileLibrary, view: &mut LibraryView, actions: &mut Vec<Action>) {
    if library.entries().next().is_none() {
        if !library.is_reading() {
            let word = if library.is_empty() { "library.empty" } else { "library.no_match" };
            empty_placeholder(ui, theme, &theme.translate(word), None);
        }
        return;
    }
    let room = ui.available_rect_before_wrap();
    let (list, detail) = room.split_left_right_at_fraction(LIST_FRACTION);
    let list = Rect { max: list.max - vec2(theme.space.groups, 0.0), ..list };
    ui.scope_builder(UiBuilder::new().max_rect(list), |ui| {
        list::list_ui(ui, theme, library, &mut view.list, actions);
    });
    ui.scope_builder(UiBuilder::new().max_rect(detail), |ui| {
        if let Some(entry) = library.selected() {
            preview::preview_ui(ui, theme, library, entry);
        }
    });
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, library: &ProfileLibrary, actions: &mut Vec<Action>) {
    let is_valid = library.selected().and_then(LibraryEntry::profile).is_some();
    right_aligned(ui, |ui| {
        if primary_button(ui, theme, is_valid, icons::FOLDER_OPEN, &theme.translate("file.open")).clicked() {
            actions.push(Action::Library(LibraryAction::OpenSelected));
        }
        let word = theme.translate("shell.compare");
        if enabled_button(ui, is_valid, icons::ARROWS_OUT_LINE_HORIZONTAL, &word).clicked() {
            actions.push(Action::Library(LibraryAction::CompareSelected));
        }
        if labelled_button(ui, "", &theme.translate("library.other_file")).clicked() {
            actions.push(Action::Library(LibraryAction::AskFile));
        }
        if labelled_button(ui, "", &theme.translate("about.close")).clicked() {
            actions.push(Action::Library(LibraryAction::Close));
        }
    });
}
