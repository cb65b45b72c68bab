//! The motor and OEM data page: the bytes of an area in the hex editor, their meaning, and the bar for writing edits.

use egui::{RichText, ScrollArea, Ui};

use crate::app::{Action, AnyDevice, DeviceCommand, Studio};
use crate::devices::biss::protocol::{Area, RegisterAddress};
use crate::devices::biss::state::explain;
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS, area_addresses};
use crate::devices::biss::views::translate;
use crate::ui::controls::{empty_placeholder, enabled_button, name, paragraph};
use crate::ui::widgets::{HexAddresses, HexEdit, HexModel, HexView, hex_editor, hex_lines, typed_view};
use crate::ui::{Theme, edit_bar, icons};

#[derive(Default)]
pub(super) struct DataUiState {
    area: usize,
    hex: HexView,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    (studio, device): (&Studio, &AnyDevice),
    encoder: &Encoder,
    view: &mut DataUiState,
    actions: &mut Vec<Action>,
) {
    let areas = encoder.description.as_ref().map(|own| own.areas()).unwrap_or_default();
    let Some(area) = areas.get(view.area).or_else(|| areas.first()) else {
        let words = if encoder.description.is_some() { "data.none" } else { "registers.nothing" };
        empty_placeholder(ui, theme, &translate(theme, words), None);
        return;
    };
    egui::Panel::bottom("data_foot").frame(egui::Frame::NONE).show_separator_line(false).show(ui, |ui| {
        edit_bar::edit_bar_ui(ui, theme, (studio, device), edit_bar::EditKind::Bytes, actions);
    });
    super::messages_ui(ui, theme, encoder, actions);
    let shown = encoder.visible_area(area);
    ui.horizontal_wrapped(|ui| {
        for (at, own) in areas.iter().enumerate() {
            let word = theme.format_text(&explain::name_text(&own.name));
            let response = ui.add(egui::Button::selectable(own == area, &word));
            if name(response, true, &word).clicked() && at != view.area {
                *view = DataUiState { area: at, ..DataUiState::default() };
            }
        }
        // If the area has not been read, this button is shown in the middle.
        let (ready, is_read) =
            (encoder.session.is_ready(), shown.as_ref().is_some_and(|own| encoder.memory.area_bytes(own).is_some()));
        if is_read && enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "data.read")).clicked() {
            actions.push(Action::device(encoder.session.id, Biss::ReadArea(area.first)));
        }
        let shown = shown.as_ref().unwrap_or(area);
        let text = TEXTS
            .text("data.banks")
            .with("first", format!("0x{:02X}", shown.first))
            .with("last", format!("0x{:02X}", shown.last))
            .with("bytes", shown.size());
        ui.label(theme.caption(theme.format_text(&text)));
    });
    ui.add_space(theme.space.inside);
    match shown.and_then(|own| encoder.memory.area_bytes(&own).zip(Some(own))) {
        Some(((read, wanted), own)) => area_bytes_ui(ui, theme, encoder, &own, (&read, &wanted), view, actions),
        None if encoder.profile().is_some() => {
            empty_placeholder(ui, theme, &translate(theme, "data.not_in_profile"), None);
        }
        None => {
            let read = (icons::ARROW_CLOCKWISE, translate(theme, "data.read"), encoder.session.is_ready());
            if empty_placeholder(ui, theme, &translate(theme, "data.not_read"), Some((read.0, &read.1, read.2))) {
                actions.push(Action::device(encoder.session.id, Biss::ReadArea(area.first)));
            }
        }
    }
}

fn area_bytes_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    area: &Area,
    (read, wanted): (&[u8], &[u8]),
    view: &mut DataUiState,
    actions: &mut Vec<Action>,
) {
    let read_only = encoder.not_editable_reason(area);
    if let Some(why) = &read_only {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::LOCK_SIMPLE).color(theme.palette.warn));
            paragraph(ui, theme.format_text(why));
        });
    }
    let beside = ui.available_width() >= 820.0;
    let lines = hex_lines(ui.available_height(), beside);
    let addresses = HexAddresses::Banked { first: area.first.into(), size: RegisterAddress::BANK_SIZE.into() };
    let model = HexModel { read_only: read_only.as_ref(), lines, addresses, ..HexModel::new(read, wanted) };
    let mut edits = Vec::new();
    let label = theme.format_text(&explain::name_text(&area.name));
    if beside {
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| edits = hex_editor(ui, theme, &label, &model, &mut view.hex));
            ui.add_space(theme.space.between);
            ui.vertical(|ui| {
                typed_view(ui, theme, view.hex.to_read(wanted));
            });
        });
    } else {
        ScrollArea::vertical().id_salt("area").auto_shrink(false).show(ui, |ui| {
            // Leave room for the focus ring.
            ui.add_space(theme.space.inside);
            edits = hex_editor(ui, theme, &label, &model, &mut view.hex);
            typed_view(ui, theme, view.hex.to_read(wanted));
        });
    }
    // The undo buttons of the edit bar behave in the same way as the keyboard shortcuts.
    if actions.iter().any(|own| matches!(own, Action::Command(_, DeviceCommand::Undo | DeviceCommand::Redo))) {
        view.hex.move_to_change(wanted);
    }
    let start = |offset: usize| -> Option<RegisterAddress> { area_addresses(area).nth(offset) };
    for edit in edits {
        let id = encoder.session.id;
        let own = |action| Action::device(id, action);
        actions.extend(match edit {
            HexEdit::Put { address, bytes } => start(address).map(|start| own(Biss::Put { start, bytes })),
            HexEdit::Undo => Some(Action::Command(id, DeviceCommand::Undo)),
            HexEdit::Redo => Some(Action::Command(id, DeviceCommand::Redo)),
            HexEdit::Revert { range } => {
                start(range.start).map(|start| own(Biss::Revert { start, count: range.len() }))
            }
        });
    }
}
