//! The device page: identity of the device and its drives, device check, and wiring.

use egui::Ui;

use crate::app::{Action, DeviceCommand};
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::profile::Service;
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::check::lines_ui;
use crate::ui::controls::{
    card, card_with_trailing, empty_placeholder, enabled_button, folding_card, paragraph, row, two_columns,
};
use crate::ui::{Theme, icons};

const SERVICES: [(Service, &str); 5] = [
    (Service::Save, "hd_services.save"),
    (Service::Recall, "hd_services.recall"),
    (Service::Factory, "hd_services.factory"),
    (Service::FactoryAll, "hd_services.factory_all"),
    (Service::Reset, "hd_services.reset"),
];

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let is_profile = unit.profile().is_some();
    two_columns(
        ui,
        theme,
        &mut *actions,
        |ui, actions| {
            identity_ui(ui, theme, unit, actions);
            if !is_profile {
                theme.add_gap(ui);
                check_ui(ui, theme, unit, actions);
            }
        },
        |ui, _| {
            drives_ui(ui, theme, unit);
            theme.add_gap(ui);
            wiring_ui(ui, theme);
        },
    );
    if !is_profile {
        theme.add_gap(ui);
        service_buttons_ui(ui, theme, unit, actions);
    }
}

fn identity_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let read = |ui: &mut Ui| {
        if unit.profile().is_none()
            && enabled_button(
                ui,
                unit.session.is_readable(),
                icons::ARROW_CLOCKWISE,
                &translate(theme, "hd_device.read"),
            )
            .clicked()
        {
            actions.push(Action::Command(unit.session.id, DeviceCommand::Read));
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("hd_device.title"), read, |ui| {
        let Some(identity) = unit.identity() else {
            empty_placeholder(ui, theme, &translate(theme, "hd_device.nothing"), None);
            return;
        };
        paragraph(ui, theme.value(&identity.category));
        ui.add_space(theme.space.inside);
        for (label, value) in [
            ("hd_device.name", &identity.name),
            ("hd_device.article", &identity.article_number),
            ("hd_device.serial", &identity.serial_number),
            ("hd_device.date", &identity.production_date),
            ("hd_device.version", &identity.version),
        ] {
            row(ui, theme, &translate(theme, label), theme.monospace(value));
        }
    });
}

fn drives_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    card(ui, theme, TEXTS.text("hd_drives.title"), |ui| {
        let Some(identity) = unit.identity() else {
            empty_placeholder(ui, theme, &translate(theme, "hd_device.nothing"), None);
            return;
        };
        if identity.drives.is_empty() {
            empty_placeholder(ui, theme, &translate(theme, "hd_drives.none"), None);
        }
        for drive in &identity.drives {
            ui.horizontal_wrapped(|ui| {
                ui.label(theme.heading(drive.number.get().to_string()));
                ui.label(theme.monospace(&drive.name));
                let id = if drive.requested { "hd_drives.requested" } else { "hd_drives.not_requested" };
                ui.label(theme.caption(translate(theme, id)));
            });
            row(ui, theme, &translate(theme, "hd_device.serial"), theme.monospace(&drive.serial_number));
            row(ui, theme, &translate(theme, "hd_device.version"), theme.monospace(&drive.version));
            row(ui, theme, &translate(theme, "hd_device.article"), theme.monospace(&drive.article_number));
        }
        let places = identity.topology.drives();
        let taken = identity.drives.len();
        if taken < usize::from(places) {
            let text = TEXTS.text("hd_drives.empty").with("count", usize::from(places) - taken);
            paragraph(ui, theme.caption(theme.format_text(&text)));
        }
    });
}

fn check_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        if enabled_button(ui, unit.session.is_ready(), icons::LIST_CHECKS, &theme.translate("check_card.run")).clicked()
        {
            actions.push(Action::device(unit.session.id, Hiperdrive::Check));
        }
    };
    card_with_trailing(ui, theme, "check_card.title", run, |ui| {
        lines_ui(ui, theme, unit.check.as_deref(), TEXTS.text("hd_check.nothing"));
    });
}

fn service_buttons_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("hd_services.title"), |ui| {
        for (service, note) in SERVICES {
            if enabled_button(ui, unit.session.is_ready(), "", &theme.format_text(&explain::service_text(service)))
                .clicked()
            {
                let change = Change::Do(service);
                actions.push(Action::device(unit.session.id, Hiperdrive::Plan(Box::new(change))));
            }
            paragraph(ui, theme.caption(translate(theme, note)));
            ui.add_space(theme.space.inside);
        }
        paragraph(ui, theme.caption(translate(theme, "hd_services.controller")));
    });
}

const WIRING: [&str; 4] = ["hd_wiring.bus", "hd_wiring.supply", "hd_wiring.drives", "hd_wiring.manual"];

fn wiring_ui(ui: &mut Ui, theme: &Theme) {
    folding_card(ui, theme, "wiring.title", |ui| {
        for note in WIRING {
            paragraph(ui, theme.label(with_nonbreaking_pins(&translate(theme, note))));
        }
    });
}

/// Returns the text with each pin and its signal kept on the same line, such as `2 RS-485 − green`.
fn with_nonbreaking_pins(text: &str) -> String {
    let is_pin = |part: &str| part.starts_with(|first: char| first.is_ascii_digit()) && !part.contains(". ");
    let parts = text.split_inclusive(": ").flat_map(|part| part.split_inclusive(", "));
    let join = |part: &str| {
        let (pin, end) = part.strip_suffix(' ').map_or((part, ""), |pin| (pin, " "));
        if is_pin(pin) { pin.replace(' ', "\u{a0}") + end } else { part.to_owned() }
    };
    parts.map(join).collect()
}

#[cfg(test)]
mod tests {
    use super::{WIRING, with_nonbreaking_pins};
    use crate::devices::hiperdrive::state::TEXTS;
    use crate::ui::wiring::assert_notes;

    #[test]
    fn pin_and_signal_stay_on_one_line() {
        let kept = with_nonbreaking_pins("Each drive: 1 RS-485 + white, 2 RS-485 − green, 6 GND blue.");
        assert_eq!(kept.replace('\u{a0}', "_"), "Each drive: 1_RS-485_+_white, 2_RS-485_−_green, 6_GND_blue.");
    }

    /// The wiring card matches sections 3.1 (hub), 3.2 (S3 at 0 for motion over the bus) and 4.2 (bus adapter) of the
    /// HIPERDRIVE manual (issue 22.23).
    #[test]
    fn wiring_card_matches_manual() {
        assert_notes(&TEXTS, &WIRING, &["4-pin, D-coded", "1 TD+ white/green", "2 RD+ white/orange"]);
        assert_notes(&TEXTS, &WIRING, &["3 TD− green", "4 RD− orange", "four-wire cables only"]);
        assert_notes(&TEXTS, &WIRING, &["1 GND drive", "2 +24 V drive", "3 GND adapter", "4 +24 V adapter", "J1"]);
        assert_notes(&TEXTS, &WIRING, &["control supply 1 +24 V, 3 GND (5-pin, A-coded)", "M6"]);
        assert_notes(&TEXTS, &WIRING, &["1 RS-485 + white", "2 RS-485 − green", "3 +24 V orange", "4 GND black"]);
        assert_notes(&TEXTS, &WIRING, &["5 +24 V red", "6 GND blue", "S3 of a hub must be set to 0"]);
    }
}
