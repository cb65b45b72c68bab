//! The workspace, which shows the selected session of the open tab.

use egui::{Align, Layout, Ui, vec2};

use super::controls::{labelled_button, primary_button};
use super::device_view::DeviceView;
use super::logbook::logbook_ui;
use super::page::with_stable_ids;
use super::panels::plot_ui;
use super::views::device_in_tab;
use super::{Theme, Views, icons};
use crate::app::{Action, LOGBOOK_TAB, LibraryAction, Studio, connect};

/// Fraction of the height left empty above the options in an empty tab.
const EMPTY_TAB_TOP_SHARE: f32 = 0.22;
/// Width of an option in an empty tab, in points.
const OPTION_WIDTH: f32 = 240.0;

pub(super) fn workspace_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    if views.plot.is_expanded()
        && let Some(device) = studio.selected_device()
    {
        let margin = egui::Margin::same(theme.space.groups as i8);
        egui::Frame::NONE.inner_margin(margin).show(ui, |ui| plot_ui(ui, theme, device, views, actions));
        return;
    }
    let tab = studio.settings.tab;
    if let Some(tool) = views.tool_pages(tab) {
        tool.page_ui(ui, theme, studio, actions);
        return;
    }
    if tab == LOGBOOK_TAB {
        return logbook_ui(ui, theme, studio, &mut views.logbook, actions);
    }
    let Some(device) = device_in_tab(studio, tab) else {
        return empty_page_ui(ui, theme, views.tabs.device(tab), actions);
    };
    let Some(session) = views.session(device) else { return };
    with_stable_ids(ui, "page", |ui| session.page_ui(ui, theme, (studio, device), actions));
}

/// Draws the buttons for opening a device, which are shown while no device is open.
fn empty_page_ui(ui: &mut Ui, theme: &Theme, view: Option<&dyn DeviceView>, actions: &mut Vec<Action>) {
    ui.add_space((ui.available_height() * EMPTY_TAB_TOP_SHARE).round());
    ui.vertical_centered(|ui| {
        if let Some(view) = view {
            ui.label(theme.heading(view.kind().bus_name()));
        }
        ui.add(egui::Label::new(theme.label(theme.translate("shell.empty"))).wrap());
        theme.add_gap(ui);
        let size = vec2(OPTION_WIDTH.min(ui.available_width()), 0.0);
        ui.allocate_ui_with_layout(size, Layout::top_down_justified(Align::Center), |ui| {
            if primary_button(ui, theme, true, icons::PLUGS_CONNECTED, &theme.translate("shell.connect")).clicked() {
                actions.push(Action::Connect(connect::ConnectAction::Open));
            }
            if labelled_button(ui, icons::PLAY, &theme.translate("shell.virtual_device")).clicked() {
                actions.push(Action::OpenVirtual);
            }
            if labelled_button(ui, icons::FOLDER_OPEN, &theme.translate("profile_card.open")).clicked() {
                actions.push(Action::AskOpen);
            }
            if labelled_button(ui, icons::FILE_TEXT, &theme.translate("shell.profiles")).clicked() {
                actions.push(Action::Library(LibraryAction::Open));
            }
            if let Some(view) = view {
                view.empty_ui(ui, theme, actions);
            }
        });
    });
}
