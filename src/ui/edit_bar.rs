//! The bar on pages that edit a memory, for any device. It shows the number of edits and the buttons for discarding and
//! writing them.

use egui::{RichText, Ui, WidgetInfo};

use super::controls::{enabled_button, icon_button, name, primary_button};
use super::{Theme, icons};
use crate::app::session::{Phase, Source};
use crate::app::{Action, AnyDevice, DeviceCommand, Studio, Text};

/// Width of the bar in points below which the discard button has no label.
const NARROW_WIDTH: f32 = 660.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKind {
    Bytes,
    Values,
}

pub fn edit_bar_ui(
    ui: &mut Ui,
    theme: &Theme,
    (studio, device): (&Studio, &AnyDevice),
    edited: EditKind,
    actions: &mut Vec<Action>,
) {
    ui.add_space(theme.space.between);
    let dirty = device.is_dirty();
    let width = ui.available_width();
    ui.horizontal(|ui| {
        if icon_button(ui, device.can_undo(), icons::ARROW_U_UP_LEFT, &theme.translate("memory.undo")).clicked() {
            actions.push(device.command(DeviceCommand::Undo));
        }
        if icon_button(ui, device.can_redo(), icons::ARROW_U_UP_RIGHT, &theme.translate("memory.redo")).clicked() {
            actions.push(device.command(DeviceCommand::Redo));
        }
        let narrow = width < NARROW_WIDTH;
        let revert = if narrow { icon_button } else { enabled_button };
        if revert(ui, dirty, icons::ARROW_COUNTER_CLOCKWISE, &theme.translate("memory.revert")).clicked() {
            actions.push(device.command(DeviceCommand::RevertAll));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if *device.phase() == Phase::Offline {
                if primary_button(ui, theme, dirty, icons::FLOPPY_DISK, &theme.translate("profile_card.save")).clicked()
                {
                    actions.push(Action::Save(device.id()));
                }
                write_targets_ui(ui, theme, studio, device, actions);
            } else {
                let word = theme.translate("memory.review");
                let write = primary_button(ui, theme, dirty && device.is_ready(), icons::DOWNLOAD_SIMPLE, &word);
                if write.on_hover_text(theme.translate("memory.review_hint")).clicked() {
                    actions.push(device.command(DeviceCommand::Review));
                }
            }
            if dirty {
                let count = device.edit_count();
                let text = Text::new(match (device.source(), count, edited) {
                    (Source::Link(_), 1, EditKind::Bytes) => "memory.edited_one",
                    (Source::Link(_), _, EditKind::Bytes) => "memory.edited",
                    (Source::File { .. } | Source::New { .. }, 1, EditKind::Bytes) => "memory.unsaved_one",
                    (Source::File { .. } | Source::New { .. }, _, EditKind::Bytes) => "memory.unsaved",
                    (Source::Link(_), 1, EditKind::Values) => "values.edited_one",
                    (Source::Link(_), _, EditKind::Values) => "values.edited",
                    (Source::File { .. } | Source::New { .. }, 1, EditKind::Values) => "values.unsaved_one",
                    (Source::File { .. } | Source::New { .. }, _, EditKind::Values) => "values.unsaved",
                })
                .with("count", count);
                edits_ui(ui, theme, count, &theme.format_text(&text));
            }
        });
    });
}

/// Draws the number of edits. A label that does not fit is omitted.
fn edits_ui(ui: &mut Ui, theme: &Theme, count: usize, words: &str) {
    let color = theme.palette.staged;
    let font = egui::TextStyle::Body.resolve(ui.style());
    let has_room = ui.painter().layout_no_wrap(words.to_owned(), font, color.into()).size().x <= ui.available_width();
    let shown = if has_room { words.to_owned() } else { format!("{}  {count}", icons::PENCIL_SIMPLE) };
    let label = ui.add(egui::Label::new(RichText::new(shown).color(color)).extend());
    label.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words));
    label.on_hover_text(words);
}

/// Draws the list of connected devices to which the profile can be written.
fn write_targets_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, device: &AnyDevice, actions: &mut Vec<Action>) {
    let own = |other: &&AnyDevice| other.tab() == device.tab() && *other.phase() == Phase::Connected;
    let targets: Vec<&AnyDevice> = studio.devices().iter().map(Box::as_ref).filter(own).collect();
    let word = theme.translate("memory.write_into");
    ui.add_enabled_ui(!targets.is_empty(), |ui| {
        let menu = ui.menu_button(format!("{}  {word}", icons::DOWNLOAD_SIMPLE), |ui| {
            for target in &targets {
                if ui.add_enabled(target.is_ready(), egui::Button::new(target.name())).clicked() {
                    actions.push(device.command(DeviceCommand::WriteInto(target.id())));
                    ui.close();
                }
            }
        });
        name(menu.response, true, &word).on_disabled_hover_text(theme.translate("memory.no_target"));
    });
}
