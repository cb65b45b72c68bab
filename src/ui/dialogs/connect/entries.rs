//! Entries shared by the connection forms.

use egui::{RichText, Ui};

use crate::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog, EnteredValues};
use crate::app::{Action, explain};
use crate::link::{Echo, PORT_EXAMPLE};
use crate::parameter::Entry;
use crate::ui::controls::{disclosure, dropdown, entry, icon_button, label_width, name, paragraph, text_entry};
use crate::ui::{Theme, icons};
use crate::units::Parity;

pub(crate) fn serial_port_ui(
    ui: &mut Ui,
    theme: &Theme,
    dialog: &Dialog,
    port: &mut String,
    actions: &mut Vec<Action>,
) {
    entry(ui, theme, &theme.translate("connect.port"), |ui| {
        text_entry(ui, port, 300.0, &theme.translate("connect.port"), PORT_EXAMPLE.port);
        if icon_button(ui, dialog.ports.is_some(), icons::ARROW_CLOCKWISE, &theme.translate("connect.list_ports"))
            .clicked()
        {
            actions.push(Action::Connect(Connect::ListPorts));
        }
    });
    match &dialog.ports {
        None => {
            ui.label(theme.caption(theme.translate("connect.listing")));
        }
        Some(Err(why)) => {
            paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.warn));
        }
        Some(Ok(offers)) if offers.is_empty() => {
            paragraph(ui, theme.caption(theme.translate("connect.no_ports")));
        }
        Some(Ok(offers)) => {
            for offer in offers {
                ui.horizontal(|ui| {
                    ui.add_space(label_width(ui));
                    let button = egui::Button::selectable(*port == offer.path, theme.monospace(&offer.path));
                    if ui.add(button).clicked() {
                        port.clone_from(&offer.path);
                    }
                    ui.label(theme.label(&offer.description));
                    if !offer.listed {
                        ui.label(theme.caption(theme.translate("connect.not_listed")));
                    }
                });
            }
        }
    }
}

pub(crate) fn network(ui: &mut Ui, theme: &Theme, host: &mut String, port: &mut String) {
    host_and_port_ui(ui, theme, "connect.host", (host, "192.168.0.7"), (port, "4001"));
    ui.label(theme.caption(theme.translate("connect.tcp_words")));
}

pub(crate) fn host_and_port_ui(
    ui: &mut Ui,
    theme: &Theme,
    id: &'static str,
    host: (&mut String, &str),
    port: (&mut String, &str),
) {
    let word = theme.translate(id);
    entry(ui, theme, &word, |ui| {
        text_entry(ui, host.0, 220.0, &word, host.1);
        text_entry(ui, port.0, 72.0, &theme.translate("connect.tcp_port"), port.1);
    });
}

pub(crate) fn recording_file_ui(ui: &mut Ui, theme: &Theme, file: &mut String, actions: &mut Vec<Action>) {
    entry(ui, theme, &theme.translate("connect.file"), |ui| {
        text_entry(ui, file, 360.0, &theme.translate("connect.file"), "capture.trace");
        if icon_button(ui, true, icons::FOLDER_OPEN, &theme.translate("connect.choose_file")).clicked() {
            actions.push(Action::Connect(Connect::AskRecording));
        }
    });
}

pub(crate) fn parity(ui: &mut Ui, theme: &Theme, own: &mut Parity) {
    let parities = [Parity::Even, Parity::Odd, Parity::None];
    let parities = parities.map(|parity| (parity, theme.format_text(&explain::parity_text(parity))));
    ui.label(theme.label(theme.translate("settings_card.parity")));
    dropdown(ui, &theme.translate("settings_card.parity"), own, parities);
}

/// Draws the heading that expands the rarely needed entries. Returns whether they are expanded.
pub(crate) fn expandable_ui(ui: &mut Ui, theme: &Theme, open: &mut bool) -> bool {
    disclosure(ui, RichText::new(theme.translate("connect.more")), open);
    *open
}

pub(crate) fn echo_ui(ui: &mut Ui, theme: &Theme, echo: &mut Echo) {
    entry(ui, theme, &theme.translate("connect.echo"), |ui| {
        let echoes =
            [(Echo::Unknown, "connect.echo_auto"), (Echo::On, "connect.echo_on"), (Echo::Off, "connect.echo_off")];
        let echoes = echoes.map(|(echo, id)| (echo, theme.translate(id)));
        dropdown(ui, &theme.translate("connect.echo"), echo, echoes);
    });
}

/// A function that translates a device message into the language of the window.
type TranslateFn = fn(&Theme, &'static str) -> String;

pub(crate) fn entries_ui(
    ui: &mut Ui,
    theme: &Theme,
    say: TranslateFn,
    entries: impl IntoIterator<Item = Entry>,
    typed: &mut EnteredValues,
) {
    for own in entries {
        let word = say(theme, own.label);
        entry(ui, theme, &word, |ui| field(ui, theme, &word, &own, typed));
    }
}

/// Draws parameter entries side by side, each followed by its label.
pub(crate) fn entry_row(
    ui: &mut Ui,
    theme: &Theme,
    say: TranslateFn,
    entries: impl IntoIterator<Item = Entry>,
    typed: &mut EnteredValues,
) {
    for own in entries {
        let word = say(theme, own.label);
        field(ui, theme, &word, &own, typed);
        ui.label(theme.label(word));
    }
}

pub(crate) fn field(ui: &mut Ui, theme: &Theme, word: &str, own: &Entry, typed: &mut EnteredValues) {
    let mut text = typed.get(own.key).to_owned();
    // The width depends on the hint, because a number needs less space than a list of faults.
    let width = match own.hint.len() {
        1..=4 => 56.0,
        _ if own.hint.parse::<f64>().is_ok() => 96.0,
        _ => 200.0,
    };
    if text_entry(ui, &mut text, width, word, &own.hint).changed() {
        typed.set(own.key, text);
    }
    if !own.unit.is_empty() {
        ui.label(theme.label(own.unit));
    }
}

/// Draws the checkbox for leaving the encoder's supply on when the adapter is closed.
pub(crate) fn supply_choice_ui(ui: &mut Ui, theme: &Theme, leave_on: &mut bool) {
    ui.checkbox(leave_on, theme.translate("connect.leave_supply"));
    paragraph(ui, theme.caption(theme.translate("connect.leave_supply_words")));
}

/// Draws a choice between a few options side by side.
pub(crate) fn segmented_control<T: PartialEq + Copy, const N: usize>(
    ui: &mut Ui,
    theme: &Theme,
    own: &mut T,
    all: [(T, &'static str); N],
) {
    ui.horizontal(|ui| {
        for (one, id) in all {
            let word = theme.translate(id);
            let response = ui.add(egui::Button::selectable(*own == one, &word));
            if name(response, true, &word).clicked() {
                *own = one;
            }
        }
    });
}
