//! The connection form of HIPERDRIVE drives: virtual, or over the network, where one can ask who is there.

use egui::Ui;

use crate::app::connect::{Action as Connect, Connect as Dialog};
use crate::app::{Action, Text};
use crate::devices::hiperdrive::state::{
    Discovery, DiscoveryAction, DiscoveryFinder, HiperdriveForm, HiperdriveWay, TEXTS, VirtualHub,
};
use crate::devices::hiperdrive::views::say;
use crate::ui::controls::{button, choice, enabled_button, entry, paragraph, problem, spinner};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{place, recording, segments, typed, unfolded};
use crate::ui::{Skin, icons};

/// The connection form of HIPERDRIVE drives.
pub(crate) struct HiperdriveConnectForm;

impl TypedConnectForm for HiperdriveConnectForm {
    type Form = HiperdriveForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        skin: &Skin,
        dialog: &Dialog,
        form: &mut HiperdriveForm,
        ((), more): (&mut (), &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let ways = [
            (HiperdriveWay::Virtual, "connect.virtual"),
            (HiperdriveWay::Network, "connect.hd_network"),
            (HiperdriveWay::Replay, "connect.replay"),
        ];
        segments(ui, skin, &mut form.way, ways);
        ui.add_space(skin.space.between);
        match form.way {
            HiperdriveWay::Virtual => simulated(ui, skin, form),
            HiperdriveWay::Network => {
                place(
                    ui,
                    skin,
                    "connect.device_address",
                    (&mut form.host, "192.168.1.10"),
                    (&mut form.tcp_port, "44818"),
                );
                interval(ui, skin, form);
                ui.add_space(skin.space.inside);
                let finder = dialog.finder::<DiscoveryFinder>();
                discovery(ui, skin, finder.and_then(|own| own.discovery.as_ref()), actions);
            }
            HiperdriveWay::Replay => recording(ui, skin, &mut form.file, actions),
        }
        if form.way != HiperdriveWay::Replay && unfolded(ui, skin, more) {
            if form.way == HiperdriveWay::Virtual {
                interval(ui, skin, form);
            }
            let word = say(skin, "connect.byte_order");
            entry(ui, skin, &word, |ui| {
                let orders = [(false, "connect.little_endian"), (true, "connect.big_endian")];
                choice(ui, &word, &mut form.big_endian, orders.map(|(order, id)| (order, say(skin, id))));
            });
            let (_, rest) = HiperdriveForm::of_the_link();
            typed(ui, skin, say, rest, &mut form.typed);
        }
    }
}

fn simulated(ui: &mut Ui, skin: &Skin, form: &mut HiperdriveForm) {
    let word = say(skin, "connect.hub");
    entry(ui, skin, &word, |ui| {
        let hubs = [
            (VirtualHub::Adapter, "connect.hub_adapter"),
            (VirtualHub::Four, "connect.hub_four"),
            (VirtualHub::Eight, "connect.hub_eight"),
        ];
        choice(ui, &word, &mut form.hub, hubs.map(|(hub, id)| (hub, say(skin, id))));
    });
    let own = form.of_the_virtual();
    typed(ui, skin, say, own, &mut form.typed);
}

fn interval(ui: &mut Ui, skin: &Skin, form: &mut HiperdriveForm) {
    let (interval, _) = HiperdriveForm::of_the_link();
    typed(ui, skin, say, interval, &mut form.typed);
}

/// Who is there.
fn discovery(ui: &mut Ui, skin: &Skin, discovery: Option<&Discovery>, actions: &mut Vec<Action>) {
    let is_running = discovery.is_some_and(Discovery::is_running);
    ui.horizontal(|ui| {
        let word = say(skin, "connect.discover");
        if enabled_button(ui, !is_running, icons::MAGNIFYING_GLASS, &word).clicked() {
            actions.push(Action::Connect(Connect::find::<DiscoveryFinder>(DiscoveryAction::Discover)));
        }
        if is_running {
            spinner(ui, skin);
        }
        ui.label(skin.caption(say(skin, "connect.discover_words")));
    });
    match discovery.and_then(|own| own.found.as_ref()) {
        Some(Err(why)) => problem(ui, skin, Some(why)),
        Some(Ok(found)) if found.is_empty() => paragraph(ui, skin.caption(say(skin, "connect.nobody"))),
        _ => {}
    }
    for (at, device) in discovery.map(Discovery::devices).unwrap_or_default().iter().enumerate() {
        ui.horizontal(|ui| {
            let words = TEXTS.text("connect.use_device").with("address", device.address);
            if button(ui, icons::PLUGS_CONNECTED, &skin.words(&words)).clicked() {
                actions.push(Action::Connect(Connect::find::<DiscoveryFinder>(DiscoveryAction::Choose(at))));
            }
            ui.label(&device.name);
            let serial = Text::new("check.serial").with("number", device.serial_number);
            ui.label(skin.label(skin.words(&serial)));
            if !device.is_hiperdrive {
                ui.label(skin.caption(say(skin, "connect.other_maker")));
            }
        });
    }
}
