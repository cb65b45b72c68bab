//! Connection form of an INTERBUS encoder.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::ConnectDialog as Dialog;
use crate::devices::interbus::state::{InterbusForm, InterbusLinkKind};
use crate::devices::interbus::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{dropdown, entry, paragraph};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    entries_ui, expandable_ui, host_and_port_ui, recording_file_ui, segmented_control,
};

pub(crate) struct InterbusConnectForm;

impl TypedConnectForm for InterbusConnectForm {
    type Form = InterbusForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        _dialog: &Dialog,
        form: &mut InterbusForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (InterbusLinkKind::Virtual, "connect.virtual"),
            (InterbusLinkKind::Gateway, "connect.gateway"),
            (InterbusLinkKind::Replay, "connect.replay"),
        ];
        segmented_control(ui, theme, &mut form.kind, ways);
        if form.kind == InterbusLinkKind::Gateway {
            paragraph(ui, theme.caption(translate(theme, "connect.gateway_words")));
        }
        ui.add_space(theme.space.between);
        match form.kind {
            InterbusLinkKind::Virtual => {
                entries_ui(ui, theme, translate, InterbusForm::virtual_device_entries(), &mut form.typed)
            }
            InterbusLinkKind::Gateway => {
                host_and_port_ui(
                    ui,
                    theme,
                    "connect.device_address",
                    (&mut form.host, "192.168.1.10"),
                    (&mut form.tcp_port, "502"),
                );
                register_addresses_ui(ui, theme, form);
            }
            InterbusLinkKind::Replay => {
                recording_file_ui(ui, theme, &mut form.file, actions);
                order_ui(ui, theme, form);
            }
        }
        if form.kind != InterbusLinkKind::Replay && expandable_ui(ui, theme, more) {
            if form.kind == InterbusLinkKind::Virtual {
                register_addresses_ui(ui, theme, form);
            }
            let (_, rest) = InterbusForm::link_entries();
            entries_ui(ui, theme, translate, rest, &mut form.typed);
        }
    }
}

fn register_addresses_ui(ui: &mut Ui, theme: &Theme, form: &mut InterbusForm) {
    let (registers, _) = InterbusForm::link_entries();
    entries_ui(ui, theme, translate, registers, &mut form.typed);
    order_ui(ui, theme, form);
}

fn order_ui(ui: &mut Ui, theme: &Theme, form: &mut InterbusForm) {
    let word = translate(theme, "connect.word_order");
    entry(ui, theme, &word, |ui| {
        let orders = [(false, "connect.high_first"), (true, "connect.low_first")];
        dropdown(ui, &word, &mut form.low_first, orders.map(|(order, id)| (order, translate(theme, id))));
    });
}
