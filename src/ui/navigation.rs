//! The navigation, which shows the tabs and the pages of the open tab.

use egui::{Rect, Ui};

use super::controls::{icon_button, name};
use super::device_view::PageInfo;
use super::docks::Docks;
use super::views::device_in_tab;
use super::{Theme, Views, icons};
use crate::app::{Action, LOGBOOK_TAB, Studio};

pub(super) fn navigation_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    views: &mut Views,
    docks: &mut Docks,
    actions: &mut Vec<Action>,
) {
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    for tab in views.tabs.tabs() {
        let word = views.tabs.title(theme, tab);
        let text = egui::RichText::new(&word).font(theme.bold_font(theme.sizes.body));
        // In every other tab, the open page is marked instead.
        let is_shown = tab == LOGBOOK_TAB && tab == studio.settings.tab;
        let response = entry_ui(ui, is_shown, text, &word);
        if is_shown {
            highlight_current_page(ui, theme, response.rect);
        }
        if response.clicked() {
            views.plot.restore_size();
            actions.push(Action::ShowTab(tab));
        }
        if tab == studio.settings.tab {
            open_pages_ui(ui, theme, studio, views);
        }
    }
    // The footer is at the bottom, wherever the list of pages ends.
    let footer = ui.max_rect().with_min_y(ui.max_rect().bottom() - 28.0);
    let mut footer = ui.new_child(egui::UiBuilder::new().max_rect(footer));
    if icon_button(&mut footer, true, icons::ARROWS_CLOCKWISE, &theme.translate("shell.reset_layout")).clicked() {
        docks.reset();
    }
}

fn open_pages_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views) {
    let tab = studio.settings.tab;
    let pages = views.tabs.pages(tab);
    let pressed = if let Some(tool) = views.tool_pages(tab) {
        let pressed = pages_ui(ui, theme, &pages, tool.page(), |_| false);
        pressed.inspect(|page| tool.open(*page))
    } else {
        let Some(device) = device_in_tab(studio, tab) else { return };
        let Some(session) = views.session(device) else { return };
        let pressed = pages_ui(ui, theme, &pages, session.page(), |page| session.is_edited(device, page));
        pressed.inspect(|page| session.open(*page))
    };
    if pressed.is_some() {
        views.plot.restore_size();
    }
}

/// Draws the pages of a tab and returns the index of the clicked one. Pages for which `edited` returns `true` are
/// marked as having unwritten edits.
fn pages_ui(
    ui: &mut Ui,
    theme: &Theme,
    pages: &[PageInfo],
    shown: usize,
    edited: impl Fn(usize) -> bool,
) -> Option<usize> {
    let mut pressed = None;
    for (at, page) in pages.iter().enumerate() {
        let word = theme.translate(page.word);
        let text = egui::RichText::new(format!("{}  {word}", page.icon));
        let response = entry_ui(ui, shown == at, text, &word);
        if edited(at) {
            let place = response.rect.right_center() - egui::vec2(theme.space.groups, 0.0);
            let font = egui::FontId::proportional(theme.sizes.body);
            let ink = theme.palette.staged.into();
            ui.painter().text(place, egui::Align2::CENTER_CENTER, icons::PENCIL_SIMPLE, font, ink);
        }
        if shown == at {
            highlight_current_page(ui, theme, response.rect);
        }
        if response.clicked() {
            pressed = Some(at);
        }
    }
    pressed
}

fn highlight_current_page(ui: &Ui, theme: &Theme, entry: Rect) {
    let bar = entry.with_max_x(entry.left() + 3.0);
    ui.painter().rect_filled(bar, 1.0, theme.palette.accent);
}

fn entry_ui(ui: &mut Ui, is_shown: bool, text: egui::RichText, word: &str) -> egui::Response {
    let size = egui::vec2(ui.available_width(), 32.0);
    let button = egui::Button::selectable(is_shown, (text, egui::Atom::grow())).frame_when_inactive(false);
    name(ui.add(button.min_size(size)), true, word)
}
