//! The connection form of a BiSS C encoder: over its configuration pin, over an adapter on its bus, or virtual.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::Connect as Dialog;
use crate::bits::ByteOrder;
use crate::devices::biss::state::{BissForm, BissLinkKind};
use crate::devices::biss::views::say;
use crate::ui::Theme;
use crate::ui::controls::{choice, entry, paragraph, text_entry};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    echo, leave_supply, margin, network, parity, recording, segments, serial, unfolded,
};

/// The connection form of BiSS encoders.
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
        segments(ui, theme, &mut form.kind, ways);
        let words = match form.kind {
            BissLinkKind::Virtual | BissLinkKind::Replay => None,
            BissLinkKind::Pin => Some("connect.biss_pin_words"),
            BissLinkKind::Bus => Some("connect.biss_bus_words"),
        };
        if let Some(words) = words {
            paragraph(ui, theme.caption(say(theme, words)));
        }
        ui.add_space(theme.space.between);
        match form.kind {
            BissLinkKind::Virtual => simulated(ui, theme, form),
            BissLinkKind::Pin | BissLinkKind::Bus => {
                segments(ui, theme, &mut form.network, [(false, "connect.serial"), (true, "connect.tcp")]);
                if form.network {
                    network(ui, theme, &mut form.host, &mut form.tcp_port);
                } else {
                    serial(ui, theme, dialog, &mut form.port, actions);
                }
            }
            BissLinkKind::Replay => {
                recording(ui, theme, &mut form.file, actions);
                reached(ui, theme, form);
            }
        }
        if form.is_on_the_bus() {
            entry(ui, theme, &say(theme, "connect.biss_clock"), |ui| {
                text_entry(ui, &mut form.clock, 96.0, &say(theme, "connect.biss_clock"), "1000000");
                ui.label(theme.label("Hz"));
            });
        }
        if form.kind != BissLinkKind::Replay && unfolded(ui, theme, more) {
            if !form.is_on_the_bus() {
                entry(ui, theme, &theme.say("settings_card.baud"), |ui| {
                    text_entry(ui, &mut form.baud, 96.0, &theme.say("settings_card.baud"), "115200");
                    parity(ui, theme, &mut form.parity);
                });
                let word = say(theme, "connect.biss_order");
                entry(ui, theme, &word, |ui| {
                    let orders = [
                        (None, "connect.biss_order_auto"),
                        (Some(ByteOrder::LowFirst), "connect.biss_order_low"),
                        (Some(ByteOrder::HighFirst), "connect.biss_order_high"),
                    ];
                    choice(ui, &word, &mut form.order, orders.map(|(order, id)| (order, say(theme, id))));
                });
                echo(ui, theme, &mut form.echo);
            }
            entry(ui, theme, &say(theme, "connect.biss_frame"), |ui| {
                for (own, word, usual) in [
                    (&mut form.turns, "connect.biss_turns", "16"),
                    (&mut form.steps, "connect.biss_steps", "17"),
                    (&mut form.crc, "connect.biss_crc", "0x43"),
                ] {
                    let word = say(theme, word);
                    text_entry(ui, own, 48.0, &word, usual);
                    ui.label(theme.label(word));
                }
            });
            paragraph(ui, theme.caption(say(theme, "connect.biss_frame_words")));
            if form.is_on_the_bus() {
                leave_supply(ui, theme, &mut form.leave_supply);
            }
            margin(ui, theme, &mut form.margin);
        }
    }
}

/// Draws whether the encoder is connected by the configuration pin or the bus.
fn reached(ui: &mut Ui, theme: &Theme, form: &mut BissForm) {
    let word = say(theme, "connect.biss_reached");
    entry(ui, theme, &word, |ui| {
        let ways = [(true, "connect.biss_bus"), (false, "connect.biss_pin")];
        choice(ui, &word, &mut form.behind_adapter, ways.map(|(way, id)| (way, say(theme, id))));
    });
}

fn simulated(ui: &mut Ui, theme: &Theme, form: &mut BissForm) {
    reached(ui, theme, form);
    entry(ui, theme, &theme.say("connect.rpm"), |ui| {
        text_entry(ui, &mut form.rpm, 96.0, &theme.say("connect.rpm"), "0")
    });
    entry(ui, theme, &theme.say("connect.fault"), |ui| {
        text_entry(ui, &mut form.fault, 200.0, &theme.say("connect.fault"), "drop:0.01");
    });
}
