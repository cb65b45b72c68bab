//! The connection form for HIPERDRIVE drives, either virtual or in the network, with device discovery.

use egui::Ui;

use crate::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog};
use crate::app::{Action, Text};
use crate::devices::hiperdrive::state::{
    Discovery, DiscoveryAction, DiscoveryFinder, HiperdriveForm, HiperdriveLinkKind, TEXTS, VirtualHub,
};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{dropdown, enabled_button, entry, labelled_button, paragraph, problem_ui, spinner};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    entries_ui, expandable_ui, host_and_port_ui, recording_file_ui, segmented_control,
};
use crate::ui::{Theme, icons};

pub(crate) struct HiperdriveConnectForm;

impl TypedConnectForm for HiperdriveConnectForm {
    type Form = HiperdriveForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        dialog: &Dialog,
        form: &mut HiperdriveForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (HiperdriveLinkKind::Virtual, "connect.virtual"),
            (HiperdriveLinkKind::Network, "connect.hd_network"),
            (HiperdriveLinkKind::Replay, "connect.replay"),
        ];
        segmented_control(ui, theme, &mut form.kind, ways);
        ui.add_space(theme.space.between);
        match form.kind {
            HiperdriveLinkKind::Virtual => simulated_ui(ui, theme, form),
            HiperdriveLinkKind::Network => {
                host_and_port_ui(
                    ui,
                    theme,
                    "connect.device_address",
                    (&mut form.host, "192.168.1.10"),
                    (&mut form.tcp_port, "44818"),
                );
                setpoint_interval_ui(ui, theme, form);
                ui.add_space(theme.space.inside);
                let finder = dialog.finder_as::<DiscoveryFinder>();
                discovery_ui(ui, theme, finder.and_then(|own| own.discovery.as_ref()), actions);
            }
            HiperdriveLinkKind::Replay => recording_file_ui(ui, theme, &mut form.file, actions),
        }
        if form.kind != HiperdriveLinkKind::Replay && expandable_ui(ui, theme, more) {
            if form.kind == HiperdriveLinkKind::Virtual {
                setpoint_interval_ui(ui, theme, form);
            }
            let word = translate(theme, "connect.byte_order");
            entry(ui, theme, &word, |ui| {
                let orders = [(false, "connect.little_endian"), (true, "connect.big_endian")];
                dropdown(ui, &word, &mut form.big_endian, orders.map(|(order, id)| (order, translate(theme, id))));
            });
            let (_, rest) = HiperdriveForm::link_entries();
            entries_ui(ui, theme, translate, rest, &mut form.typed);
        }
    }
}

fn simulated_ui(ui: &mut Ui, theme: &Theme, form: &mut HiperdriveForm) {
    let word = translate(theme, "connect.hub");
    entry(ui, theme, &word, |ui| {
        let hubs = [
            (VirtualHub::Adapter, "connect.hub_adapter"),
            (VirtualHub::Four, "connect.hub_four"),
            (VirtualHub::Eight, "connect.hub_eight"),
        ];
        dropdown(ui, &word, &mut form.hub, hubs.map(|(hub, id)| (hub, translate(theme, id))));
    });
    let own = form.virtual_device_entries();
    entries_ui(ui, theme, translate, own, &mut form.typed);
}

fn setpoint_interval_ui(ui: &mut Ui, theme: &Theme, form: &mut HiperdriveForm) {
    let (interval, _) = HiperdriveForm::link_entries();
    entries_ui(ui, theme, translate, interval, &mut form.typed);
}

fn discovery_ui(ui: &mut Ui, theme: &Theme, discovery: Option<&Discovery>, actions: &mut Vec<Action>) {
    let is_running = discovery.is_some_and(Discovery::is_running);
    ui.horizontal(|ui| {
        let word = translate(theme, "connect.discover");
        if enabled_button(ui, !is_running, icons::MAGNIFYING_GLASS, &word).clicked() {
            actions.push(Action::Connect(Connect::find::<DiscoveryFinder>(DiscoveryAction::Discover)));
        }
        if is_running {
            spinner(ui, theme);
        }
        ui.label(theme.caption(translate(theme, "connect.discover_words")));
    });
    match discovery.and_then(|own| own.found.as_ref()) {
        Some(Err(why)) => problem_ui(ui, theme, Some(why)),
        Some(Ok(found)) if found.is_empty() => {
            paragraph(ui, theme.caption(translate(theme, "connect.no_device_found")))
        }
        _ => {}
    }
    for (at, device) in discovery.map(Discovery::devices).unwrap_or_default().iter().enumerate() {
        ui.horizontal(|ui| {
            let words = TEXTS.text("connect.use_device").with("address", device.address);
            if labelled_button(ui, icons::PLUGS_CONNECTED, &theme.format_text(&words)).clicked() {
                actions.push(Action::Connect(Connect::find::<DiscoveryFinder>(DiscoveryAction::Choose(at))));
            }
            ui.label(&device.name);
            let serial = Text::new("check.serial").with("number", device.serial_number);
            ui.label(theme.label(theme.format_text(&serial)));
            if !device.is_hiperdrive {
                ui.label(theme.caption(translate(theme, "connect.other_maker")));
            }
        });
    }
}
