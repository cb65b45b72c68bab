//! Profiles, backups, and the writes recorded in the logbook, for any kind of device.

use egui::{RichText, Ui};
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::controls::{
    card, committed_entry, empty_placeholder, enabled_button, entry, labelled_button, paragraph, show_error_below,
};
use super::{Theme, icons};
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, ComparisonSource, DeviceCommand, LibraryAction, Studio, Text, explain};
use crate::store::{AssetName, Entry, Outcome};

const COMPARE: &str = icons::ARROWS_OUT_LINE_HORIZONTAL;

pub fn page_ui(ui: &mut Ui, theme: &Theme, (studio, device): (&Studio, &AnyDevice), actions: &mut Vec<Action>) {
    profile_ui(ui, theme, device, actions);
    if *device.phase() == Phase::Offline {
        return;
    }
    theme.add_gap(ui);
    backups_ui(ui, theme, device, actions);
    theme.add_gap(ui);
    asset_ui(ui, theme, device, actions);
    theme.add_gap(ui);
    writes_ui(ui, theme, studio, device);
    if !device.logged_status_codes().is_empty() {
        theme.add_gap(ui);
        statuses_ui(ui, theme, device);
    }
}

fn profile_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    let savable = device.is_savable();
    card(ui, theme, "profile_card.title", |ui| {
        paragraph(ui, theme.label(theme.translate("profile_card.words")));
        ui.horizontal_wrapped(|ui| {
            if enabled_button(ui, savable, icons::FLOPPY_DISK, &theme.translate("profile_card.save")).clicked() {
                actions.push(Action::Save(device.id()));
            }
            if enabled_button(ui, savable, "", &theme.translate("profile_card.save_as")).clicked() {
                actions.push(device.command(DeviceCommand::AskSave));
            }
            if labelled_button(ui, icons::FOLDER_OPEN, &theme.translate("profile_card.open")).clicked() {
                actions.push(Action::AskOpen);
            }
            if labelled_button(ui, icons::FILE_TEXT, &theme.translate("shell.profiles")).clicked() {
                actions.push(Action::Library(LibraryAction::Open));
            }
            let comparable = device.is_comparable();
            if enabled_button(ui, comparable, COMPARE, &theme.translate("shell.compare")).clicked() {
                actions.push(device.command(DeviceCommand::AskCompare));
            }
        });
    });
}

fn backups_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    card(ui, theme, "backups_card.title", |ui| match device.backups() {
        None => {
            empty_placeholder(ui, theme, &theme.translate("backups_card.none"), None);
        }
        Some(Err(why)) => {
            ui.label(RichText::new(theme.format_text(why)).color(theme.palette.warn));
        }
        Some(Ok(backups)) if backups.is_empty() => {
            empty_placeholder(ui, theme, &theme.translate("backups_card.none"), None);
        }
        Some(Ok(backups)) => {
            paragraph(ui, theme.label(theme.translate("backups_card.words")));
            for backup in backups {
                ui.horizontal(|ui| {
                    ui.label(theme.monospace(time(backup.taken)));
                    let restore = enabled_button(
                        ui,
                        device.is_ready(),
                        icons::CLOCK_COUNTER_CLOCKWISE,
                        &theme.translate("backups_card.restore"),
                    );
                    if restore.clicked() {
                        actions.push(device.command(DeviceCommand::Restore(backup.path.clone())));
                    }
                    let compare = theme.translate("backups_card.compare");
                    if enabled_button(ui, device.is_comparable(), COMPARE, &compare).clicked() {
                        let source = ComparisonSource::Backup(backup.clone());
                        actions.push(device.command(DeviceCommand::Compare(Box::new(source))));
                    }
                    if labelled_button(ui, icons::FILE_TEXT, &theme.translate("backups_card.look")).clicked() {
                        actions.push(Action::Open(backup.path.clone()));
                    }
                    let name = backup.path.display().to_string();
                    ui.add(egui::Label::new(theme.caption(&name)).truncate());
                });
            }
        }
    });
}

/// Draws the entry for the asset and keeps its text while the user is typing.
fn asset_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    card(ui, theme, "asset_card.title", |ui| {
        paragraph(ui, theme.label(theme.translate("asset_card.words")));
        let id = egui::Id::unique(("asset_card.name", device.id()));
        let mut draft = ui.data(|data| data.get_temp::<Option<(String, Option<Text>)>>(id)).flatten();
        let (shown, label) = (device.asset().unwrap_or_default(), theme.translate("asset_card.name"));
        entry(ui, theme, &label, |ui| {
            committed_entry(ui, &mut draft, shown, 260.0, &label, |text| {
                let name = text.parse::<AssetName>().map_err(explain::asset_name_error_text)?;
                actions.push(device.command(DeviceCommand::Assign(name)));
                Ok(())
            })
        });
        show_error_below(ui, theme, draft.as_ref().and_then(|(_, problem)| problem.as_ref()));
        ui.data_mut(|data| data.insert_temp(id, draft));
    });
}

fn writes_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, device: &AnyDevice) {
    card(ui, theme, "writes_card.title", |ui| match device.logged_writes() {
        None => {
            ui.label(theme.label(theme.translate("writes_card.none")));
        }
        Some(Err(why)) => {
            paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.warn));
        }
        Some(Ok(writes)) if writes.is_empty() => {
            ui.label(theme.label(theme.translate("writes_card.none")));
        }
        Some(Ok(writes)) => {
            for write in writes {
                write_ui(ui, theme, studio, write);
            }
        }
    });
}

fn statuses_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice) {
    card(ui, theme, "statuses_card.title", |ui| {
        for status in device.logged_status_codes() {
            ui.horizontal(|ui| {
                ui.label(theme.monospace(time(status.at)));
                ui.add(egui::Label::new(&status.description).truncate());
            });
        }
    });
}

pub(super) fn time(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d  %H:%M:%S").to_string()
}

fn write_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, write: &Entry) {
    let palette = theme.palette;
    let (icon, colour, words) = match write.conclusion.as_ref().map(|end| &end.outcome) {
        Some(Outcome::Done) => (icons::CHECK_CIRCLE, palette.good, theme.translate("writes_card.done")),
        Some(Outcome::Cancelled) => (icons::STOP, palette.warn, theme.translate("writes_card.cancelled")),
        Some(Outcome::Failed(why)) => (icons::X_CIRCLE, palette.bad, why.clone()),
        None => (icons::QUESTION, palette.warn, theme.translate("writes_card.open")),
    };
    ui.horizontal(|ui| {
        ui.label(theme.monospace(time(write.at)));
        ui.label(RichText::new(icon).color(colour)).on_hover_text(&words);
        let cycles = Text::new("writes_card.cycles").with("cycles", write.write_cycles());
        ui.label(theme.label(theme.format_text(&cycles)));
        let changes = theme.format_text(&studio.entry_text(write));
        ui.add(egui::Label::new(theme.monospace(changes)).truncate());
    });
}
