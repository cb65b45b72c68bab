//! Profiles, backups, and what was written into a device, whatever its kind.

use egui::{RichText, Ui};
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::controls::{button, card, empty, enabled_button, paragraph};
use super::{Skin, icons};
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, DeviceCommand};
use crate::store::{Entry, Outcome};

/// Draws the page.
pub fn page_ui(ui: &mut Ui, skin: &Skin, device: &AnyDevice, actions: &mut Vec<Action>) {
    profile(ui, skin, device, actions);
    if *device.phase() == Phase::Offline {
        return;
    }
    ui.add_space(skin.space.groups);
    backups(ui, skin, device, actions);
    ui.add_space(skin.space.groups);
    writes(ui, skin, device);
    if !device.statuses().is_empty() {
        ui.add_space(skin.space.groups);
        statuses(ui, skin, device);
    }
}

fn profile(ui: &mut Ui, skin: &Skin, device: &AnyDevice, actions: &mut Vec<Action>) {
    let savable = device.is_savable();
    card(ui, skin, "profile_card.title", |ui| {
        paragraph(ui, skin.label(skin.say("profile_card.words")));
        ui.horizontal(|ui| {
            if enabled_button(ui, savable, icons::FLOPPY_DISK, &skin.say("profile_card.save")).clicked() {
                actions.push(Action::Save(device.id()));
            }
            if enabled_button(ui, savable, "", &skin.say("profile_card.save_as")).clicked() {
                actions.push(device.command(DeviceCommand::AskSave));
            }
            if button(ui, icons::FOLDER_OPEN, &skin.say("profile_card.open")).clicked() {
                actions.push(Action::AskOpen);
            }
        });
    });
}

fn backups(ui: &mut Ui, skin: &Skin, device: &AnyDevice, actions: &mut Vec<Action>) {
    card(ui, skin, "backups_card.title", |ui| match device.backups() {
        None => {
            empty(ui, skin, &skin.say("backups_card.none"), None);
        }
        Some(Err(why)) => {
            ui.label(RichText::new(skin.words(why)).color(skin.palette.warn));
        }
        Some(Ok(backups)) if backups.is_empty() => {
            empty(ui, skin, &skin.say("backups_card.none"), None);
        }
        Some(Ok(backups)) => {
            paragraph(ui, skin.label(skin.say("backups_card.words")));
            for backup in backups {
                ui.horizontal(|ui| {
                    ui.label(skin.mono(time(backup.taken)));
                    let restore = enabled_button(
                        ui,
                        device.is_ready(),
                        icons::CLOCK_COUNTER_CLOCKWISE,
                        &skin.say("backups_card.restore"),
                    );
                    if restore.clicked() {
                        actions.push(device.command(DeviceCommand::Restore(backup.path.clone())));
                    }
                    if button(ui, icons::FILE_TEXT, &skin.say("backups_card.look")).clicked() {
                        actions.push(Action::Open(backup.path.clone()));
                    }
                    let name = backup.path.display().to_string();
                    ui.add(egui::Label::new(skin.caption(&name)).truncate());
                });
            }
        }
    });
}

fn writes(ui: &mut Ui, skin: &Skin, device: &AnyDevice) {
    card(ui, skin, "writes_card.title", |ui| match device.writes() {
        None => {
            ui.label(skin.label(skin.say("writes_card.none")));
        }
        Some(Err(why)) => {
            paragraph(ui, RichText::new(skin.words(why)).color(skin.palette.warn));
        }
        Some(Ok(writes)) if writes.is_empty() => {
            ui.label(skin.label(skin.say("writes_card.none")));
        }
        Some(Ok(writes)) => {
            for write in writes {
                write_ui(ui, skin, write);
            }
        }
    });
}

/// Status codes that were read: the device does not tell them again.
fn statuses(ui: &mut Ui, skin: &Skin, device: &AnyDevice) {
    card(ui, skin, "statuses_card.title", |ui| {
        for status in device.statuses() {
            ui.horizontal(|ui| {
                ui.label(skin.mono(time(status.at)));
                ui.add(egui::Label::new(&status.codes).truncate());
            });
        }
    });
}

/// A time of the logbook, where this computer is.
fn time(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d  %H:%M:%S").to_string()
}

fn write_ui(ui: &mut Ui, skin: &Skin, write: &Entry) {
    let palette = skin.palette;
    let (icon, colour, words) = match write.conclusion.as_ref().map(|end| &end.outcome) {
        Some(Outcome::Done) => (icons::CHECK_CIRCLE, palette.good, skin.say("writes_card.done")),
        Some(Outcome::Cancelled) => (icons::STOP, palette.warn, skin.say("writes_card.cancelled")),
        Some(Outcome::Failed(why)) => (icons::X_CIRCLE, palette.bad, why.clone()),
        None => (icons::QUESTION, palette.warn, skin.say("writes_card.open")),
    };
    ui.horizontal(|ui| {
        ui.label(skin.mono(time(write.at)));
        ui.label(RichText::new(icon).color(colour)).on_hover_text(&words);
        let cycles = write.conclusion.as_ref().map_or(write.planned_cycles, |end| end.cycles_spent);
        let cycles = crate::app::Text::new("writes_card.cycles").with("cycles", cycles);
        ui.label(skin.label(skin.words(&cycles)));
        ui.add(egui::Label::new(skin.mono(&write.what)).truncate());
    });
}
