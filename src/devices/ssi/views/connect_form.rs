//! The connection form of an SSI encoder: over an adapter, or virtual.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::Connect as Dialog;
use crate::devices::ssi::state::{SsiForm, SsiWay};
use crate::devices::ssi::views::say;
use crate::ui::Skin;
use crate::ui::controls::{entry, paragraph, text_entry};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{leave_supply, margin, network, recording, segments, serial, unfolded};

/// The connection form of SSI encoders.
pub(crate) struct SsiConnectForm;

impl TypedConnectForm for SsiConnectForm {
    type Form = SsiForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        skin: &Skin,
        dialog: &Dialog,
        form: &mut SsiForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (SsiWay::Virtual, "connect.virtual"),
            (SsiWay::Adapter, "connect.adapter"),
            (SsiWay::Replay, "connect.replay"),
        ];
        segments(ui, skin, &mut form.way, ways);
        if form.way == SsiWay::Adapter {
            paragraph(ui, skin.caption(say(skin, "connect.ssi_words")));
        }
        ui.add_space(skin.space.between);
        match form.way {
            SsiWay::Virtual => simulated(ui, skin, form),
            SsiWay::Adapter => {
                segments(ui, skin, &mut form.network, [(false, "connect.serial"), (true, "connect.tcp")]);
                if form.network {
                    network(ui, skin, &mut form.host, &mut form.tcp_port);
                } else {
                    serial(ui, skin, dialog, &mut form.port, actions);
                }
            }
            SsiWay::Replay => recording(ui, skin, &mut form.file, actions),
        }
        if form.way != SsiWay::Replay && unfolded(ui, skin, more) {
            let word = say(skin, "connect.voltage");
            entry(ui, skin, &word, |ui| {
                text_entry(ui, &mut form.voltage, 96.0, &word, &say(skin, "connect.voltage_none"));
                ui.label(skin.label("V"));
            });
            paragraph(ui, skin.caption(say(skin, "connect.voltage_words")));
            leave_supply(ui, skin, &mut form.leave_supply);
            margin(ui, skin, &mut form.margin);
        }
    }
}

fn simulated(ui: &mut Ui, skin: &Skin, form: &mut SsiForm) {
    let word = say(skin, "connect.ssi_layout");
    entry(ui, skin, &word, |ui| text_entry(ui, &mut form.layout, 260.0, &word, "atm60,code=gray"));
    entry(ui, skin, &skin.say("connect.rpm"), |ui| text_entry(ui, &mut form.rpm, 96.0, &skin.say("connect.rpm"), "0"));
    entry(ui, skin, &skin.say("connect.fault"), |ui| {
        text_entry(ui, &mut form.fault, 200.0, &skin.say("connect.fault"), "drop:0.01");
    });
}
