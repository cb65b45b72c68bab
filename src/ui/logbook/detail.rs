//! The selected entry of the logbook.

use std::path::Path;

use egui::{Label, RichText, ScrollArea, Ui};

use super::{LogbookView, description, device_name, format_change, moment, result, time, undone_by};
use crate::app::{
    Action, AnyDevice, ComparisonAction, ComparisonSource, DeviceCommand, MAX_NOTE_CHARS, Studio, Text, entry_kind_text,
};
use crate::store::{DeviceKey, Entry, EntryFilter, EntryKind, LinkedEntry, Origin};
use crate::ui::controls::{card, card_with_trailing, enabled_button, fill_width, paragraph, row, text_entry};
use crate::ui::{Theme, icons};

const COMPARE: &str = icons::ARROWS_OUT_LINE_HORIZONTAL;

pub(super) fn entry_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    view: &mut LogbookView,
    entry: &Entry,
    actions: &mut Vec<Action>,
) {
    ScrollArea::vertical().id_salt(entry.id).auto_shrink(false).show(ui, |ui| {
        fill_width(ui);
        let at = theme.monospace(time(entry.at)).color(theme.palette.muted);
        card_with_trailing(
            ui,
            theme,
            entry_kind_text(entry.kind),
            |ui| drop(ui.label(at)),
            |ui| {
                facts_ui(ui, theme, studio, entry);
                links_ui(ui, theme, studio, view, entry, actions);
                if !entry.items.is_empty() {
                    ui.add_space(theme.space.between);
                    items_ui(ui, theme, studio, entry);
                }
                if let Some(path) = &entry.backup {
                    ui.add_space(theme.space.between);
                    // The path of a saved profile is its description.
                    if entry.kind != EntryKind::Backup {
                        let hint = theme.translate("logbook.backup_hint");
                        ui.label(theme.label(theme.translate("logbook.backup"))).on_hover_text(hint);
                    }
                    if let Some(bench) = entry.origin.other_bench() {
                        let words =
                            Text::new("logbook.backup_elsewhere").with("bench", bench).with("path", path.display());
                        paragraph(ui, theme.caption(theme.format_text(&words)));
                    }
                    ui.horizontal_wrapped(|ui| {
                        if entry.kind.has_result() {
                            undo_ui(ui, theme, studio, entry, actions);
                        }
                        if entry.origin.other_bench().is_none() {
                            backup_ui(ui, theme, studio, (entry, path), actions);
                        }
                    });
                }
                ui.add_space(theme.space.inside);
                origin_ui(ui, theme, &entry.origin);
            },
        );
        theme.add_gap(ui);
        card(ui, theme, "logbook.note", |ui| {
            note_ui(ui, theme, studio, &entry.device, actions);
        });
    });
}

fn facts_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, entry: &Entry) {
    row(ui, theme, &theme.translate("logbook.device"), device_name(theme, studio, &entry.device, true));
    if let Some(asset) = entry.asset.as_ref().filter(|_| entry.kind != EntryKind::Assigned) {
        row(ui, theme, &theme.translate("asset_card.name"), asset);
    }
    let description = description(theme, studio, entry);
    if entry.items.is_empty() && !description.is_empty() {
        row(ui, theme, &theme.translate("logbook.text"), description);
    }
    if entry.kind.has_result() {
        let (_, colour, words) = result(theme, entry);
        row(ui, theme, &theme.translate("logbook.result"), RichText::new(words).color(colour));
        row(ui, theme, &theme.translate("logbook.cycles"), entry.write_cycles().to_string());
    }
}

/// Draws links to the entry that this one undoes and to the one that undid it.
fn links_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    view: &mut LogbookView,
    entry: &Entry,
    actions: &mut Vec<Action>,
) {
    let undoes = |link: LinkedEntry| theme.format_text(&Text::new("undo.undoes").with("time", moment(link.at)));
    let links =
        [entry.undoes.map(|link| (link, undoes(link))), entry.undone_by.map(|link| (link, undone_by(theme, link)))];
    for (link, words) in links.into_iter().flatten() {
        if !ui.link(words).on_hover_text(theme.translate("undo.show_entry")).clicked() {
            continue;
        }
        (view.selected, view.scrolls_to_selected) = (Some(link.id), true);
        let matches = studio.logbook().matches().and_then(|matches| matches.as_ref().ok());
        if !matches.is_some_and(|matches| matches.entries.iter().any(|own| own.id == link.id)) {
            view.search.clear();
            let filter = EntryFilter { device: Some(entry.device.clone()), ..EntryFilter::default() };
            actions.push(Action::SearchLogbook(filter));
        }
    }
}

/// Draws the user, computer and program version. Entries of older logbooks contain none of them.
fn origin_ui(ui: &mut Ui, theme: &Theme, origin: &Origin) {
    let Origin { user, bench, version } = origin;
    let words = theme.format_text(&Text::new("logbook.version").with("version", version));
    let version = (!version.is_empty()).then_some(words);
    let parts = [user.clone(), Some(bench.clone()), version];
    let parts: Vec<String> = parts.into_iter().flatten().filter(|part| !part.is_empty()).collect();
    if !parts.is_empty() {
        paragraph(ui, theme.caption(parts.join(" · ")));
    }
}

fn items_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, entry: &Entry) {
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    for item in &entry.items {
        let name = match entry.kind {
            EntryKind::Assigned => theme.translate("asset_card.name"),
            _ => theme.format_text(&studio.item_name(&entry.device.kind, &item.item, item.name.as_deref())),
        };
        paragraph(ui, theme.label(name));
        ui.add(Label::new(theme.monospace(format_change(item))).wrap().selectable(true));
    }
}

/// Draws the buttons for opening, comparing and restoring the backup. It can be restored only while the device is
/// connected.
fn backup_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, (entry, path): (&Entry, &Path), actions: &mut Vec<Action>) {
    let device = studio.device_for_key(&entry.device);
    if enabled_button(ui, true, icons::FILE_TEXT, &theme.translate("backups_card.look")).clicked() {
        actions.push(Action::Open(path.to_owned()));
    }
    if enabled_button(ui, true, COMPARE, &theme.translate("backups_card.compare")).clicked() {
        let left = Some(ComparisonSource::Entry(Box::new(entry.clone())));
        let right = device.map(|device| ComparisonSource::Session(device.id()));
        actions.push(Action::Comparison(ComparisonAction::Open { left, right }));
    }
    let restore = enabled_button(
        ui,
        device.is_some_and(|device| device.is_ready()),
        icons::CLOCK_COUNTER_CLOCKWISE,
        &theme.translate("backups_card.restore"),
    );
    let Some(device) = device else {
        let why = theme.translate("logbook.not_connected");
        restore.on_disabled_hover_text(&why);
        return;
    };
    if restore.clicked() {
        push_device_command(device, DeviceCommand::Restore(path.to_owned()), actions);
    }
}

/// Draws the button that plans the undo of a write. The tooltip of a disabled button shows the reason.
fn undo_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, entry: &Entry, actions: &mut Vec<Action>) {
    let target = studio.undo_target(entry);
    let button = enabled_button(ui, target.is_ok(), icons::ARROW_COUNTER_CLOCKWISE, &theme.translate("undo.button"));
    match target {
        Ok(device) => {
            if button.on_hover_text(theme.translate("undo.hint")).clicked() {
                push_device_command(device, DeviceCommand::UndoWrite(Box::new(entry.clone())), actions);
            }
        }
        Err(why) => drop(button.on_disabled_hover_text(theme.format_text(&why))),
    }
}

/// Selects a device and sends it a command.
fn push_device_command(device: &AnyDevice, command: DeviceCommand, actions: &mut Vec<Action>) {
    actions.push(Action::Select(device.id()));
    actions.push(device.command(command));
}

fn note_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, device: &DeviceKey, actions: &mut Vec<Action>) {
    let mut text = studio.logbook().note(device).to_owned();
    let word = theme.translate("logbook.note_text");
    let entry = text_entry(ui, &mut text, ui.available_width(), &word, &word);
    if entry.changed() {
        actions.push(Action::EditNote(device.clone(), text.clone()));
    }
    let entered = entry.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
    ui.horizontal(|ui| {
        let can_add =
            !text.trim().is_empty() && text.chars().count() <= MAX_NOTE_CHARS && !studio.logbook().is_saving_note();
        let add = enabled_button(ui, can_add, icons::PLUS, &theme.translate("logbook.add_note"));
        if can_add && (add.clicked() || entered) {
            actions.push(Action::AddNote(device.clone()));
        }
        if text.chars().count() > MAX_NOTE_CHARS {
            let words = Text::new("logbook.note_too_long").with("most", MAX_NOTE_CHARS);
            ui.label(RichText::new(theme.format_text(&words)).color(theme.palette.bad));
        }
    });
}
