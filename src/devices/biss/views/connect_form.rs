//! The connection form for encoders on the configuration pin, encoders on the bus of an adapter, and virtual encoders.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::ConnectDialog as Dialog;
use crate::bits::ByteOrder;
use crate::devices::biss::state::{BissForm, BissLinkKind};
use crate::devices::biss::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{dropdown, entry, paragraph};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    echo_ui, entries_ui, entry_row, expandable_ui, field, network, parity, recording_file_ui, segmented_control,
    serial_port_ui, supply_choice_ui,
};

pub(crate) struct BissConnectForm;

impl TypedConnectForm for BissConnectForm {
    type Form = BissForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        dialog: &Dialog,
        form: &mut BissForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (BissLinkKind::Virtual, "connect.virtual"),
            (BissLinkKind::Pin, "connect.biss_pin"),
            (BissLinkKind::Bus, "connect.biss_bus"),
            (BissLinkKind::Replay, "connect.replay"),
        ];
        segmented_control(ui, theme, &mut form.kind, ways);
        let words = match form.kind {
            BissLinkKind::Virtual | BissLinkKind::Replay => None,
            BissLinkKind::Pin => Some("connect.biss_pin_words"),
            BissLinkKind::Bus => Some("connect.biss_bus_words"),
        };
        if let Some(words) = words {
            paragraph(ui, theme.caption(translate(theme, words)));
        }
        ui.add_space(theme.space.between);
        match form.kind {
            BissLinkKind::Virtual => simulated_ui(ui, theme, form),
            BissLinkKind::Pin | BissLinkKind::Bus => {
                segmented_control(ui, theme, &mut form.network, [(false, "connect.serial"), (true, "connect.tcp")]);
                if form.network {
                    network(ui, theme, &mut form.host, &mut form.tcp_port);
                } else {
                    serial_port_ui(ui, theme, dialog, &mut form.port, actions);
                }
            }
            BissLinkKind::Replay => {
                recording_file_ui(ui, theme, &mut form.file, actions);
                connection_point_ui(ui, theme, form);
            }
        }
        if form.uses_bus() {
            entries_ui(ui, theme, translate, BissForm::bus_entries(), &mut form.typed);
        }
        if form.kind != BissLinkKind::Replay && expandable_ui(ui, theme, more) {
            if !form.uses_bus() {
                let (baud, others) = BissForm::pin_entries();
                for own in baud {
                    let word = translate(theme, own.label);
                    entry(ui, theme, &word, |ui| {
                        field(ui, theme, &word, &own, &mut form.typed);
                        parity(ui, theme, &mut form.parity);
                    });
                }
                entries_ui(ui, theme, translate, others, &mut form.typed);
                let word = translate(theme, "connect.biss_order");
                entry(ui, theme, &word, |ui| {
                    let orders = [
                        (None, "connect.biss_order_auto"),
                        (Some(ByteOrder::LowFirst), "connect.biss_order_low"),
                        (Some(ByteOrder::HighFirst), "connect.biss_order_high"),
                    ];
                    dropdown(ui, &word, &mut form.order, orders.map(|(order, id)| (order, translate(theme, id))));
                });
                echo_ui(ui, theme, &mut form.echo);
            }
            let (frame, line) = BissForm::common_entries();
            entry(ui, theme, &translate(theme, "connect.biss_frame"), |ui| {
                entry_row(ui, theme, translate, frame, &mut form.typed);
            });
            paragraph(ui, theme.caption(translate(theme, "connect.biss_frame_words")));
            if form.uses_bus() {
                supply_choice_ui(ui, theme, &mut form.leave_supply);
            }
            entries_ui(ui, theme, translate, line, &mut form.typed);
        }
    }
}

fn connection_point_ui(ui: &mut Ui, theme: &Theme, form: &mut BissForm) {
    let word = translate(theme, "connect.biss_reached");
    entry(ui, theme, &word, |ui| {
        let ways = [(true, "connect.biss_bus"), (false, "connect.biss_pin")];
        dropdown(ui, &word, &mut form.behind_adapter, ways.map(|(way, id)| (way, translate(theme, id))));
    });
}

fn simulated_ui(ui: &mut Ui, theme: &Theme, form: &mut BissForm) {
    connection_point_ui(ui, theme, form);
    entries_ui(ui, theme, translate, BissForm::virtual_device_entries(), &mut form.typed);
}
