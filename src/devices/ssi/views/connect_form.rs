//! The connection form for an SSI encoder, which is virtual or behind an adapter.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::ConnectDialog as Dialog;
use crate::devices::ssi::state::{SsiForm, SsiLinkKind};
use crate::devices::ssi::views::translate;
use crate::parameter::Entry;
use crate::ui::Theme;
use crate::ui::controls::paragraph;
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    entries_ui, expandable_ui, network, recording_file_ui, segmented_control, serial_port_ui, supply_choice_ui,
};

pub(crate) struct SsiConnectForm;

impl TypedConnectForm for SsiConnectForm {
    type Form = SsiForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        dialog: &Dialog,
        form: &mut SsiForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (SsiLinkKind::Virtual, "connect.virtual"),
            (SsiLinkKind::Adapter, "connect.adapter"),
            (SsiLinkKind::Replay, "connect.replay"),
        ];
        segmented_control(ui, theme, &mut form.kind, ways);
        if form.kind == SsiLinkKind::Adapter {
            paragraph(ui, theme.caption(translate(theme, "connect.ssi_words")));
        }
        ui.add_space(theme.space.between);
        match form.kind {
            SsiLinkKind::Virtual => {
                entries_ui(ui, theme, translate, SsiForm::virtual_device_entries(), &mut form.typed)
            }
            SsiLinkKind::Adapter => {
                segmented_control(ui, theme, &mut form.network, [(false, "connect.serial"), (true, "connect.tcp")]);
                if form.network {
                    network(ui, theme, &mut form.host, &mut form.tcp_port);
                } else {
                    serial_port_ui(ui, theme, dialog, &mut form.port, actions);
                }
            }
            SsiLinkKind::Replay => recording_file_ui(ui, theme, &mut form.file, actions),
        }
        if form.kind != SsiLinkKind::Replay && expandable_ui(ui, theme, more) {
            let (supply, rest) = SsiForm::link_entries();
            let none = translate(theme, "connect.voltage_none");
            entries_ui(
                ui,
                theme,
                translate,
                supply.into_iter().map(|own| Entry { hint: none.clone(), ..own }),
                &mut form.typed,
            );
            paragraph(ui, theme.caption(translate(theme, "connect.voltage_words")));
            supply_choice_ui(ui, theme, &mut form.leave_supply);
            entries_ui(ui, theme, translate, rest, &mut form.typed);
        }
    }
}
