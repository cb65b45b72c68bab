//! Connecting: a link as a form, what was used before, the ports of this machine, and the search for an encoder whose
//! settings nobody remembers.

mod biss;
mod hiperdrive;
mod interbus;
mod ssi;

use std::time::Duration;

use egui::{RichText, ScrollArea, Ui};

use crate::app::connect::{Action as Connect, Connect as Dialog, LinkForm, LinkKind, Search, is_missing};
use crate::app::explain::hiperface as words;
use crate::app::{Action, Studio, Tab, Text};
use crate::device::hiperface::Echo;
use crate::device::hiperface::find::FindOptions;
use crate::link::LinkUrl;
use crate::protocol::hiperface::BAUDS;
use crate::ui::controls::{
    LABELS, allowed_button, at_the_right, button, choice, entry, fill, icon_button, modal, mono_entry, name, paragraph,
    primary, problem, spinner, text_entry,
};
use crate::ui::{Skin, icons};
use crate::units::Parity;

/// What the dialog remembers of the search's options.
#[derive(Default)]
pub(in crate::ui) struct ConnectView {
    one_encoder: bool,
    power_cycle: bool,
    more: bool,
}

/// How long to wait for the encoder's supply to be switched off and on.
const POWER_CYCLE: Duration = Duration::from_secs(30);
/// Links offered that were used before.
const LINKS: usize = 5;
const WIDTH: f32 = 600.0;
/// Height of two lines that say why it cannot go on.
const WHY: f32 = 40.0;

/// Draws the dialog, when it is open.
pub(in crate::ui) fn connect_ui(
    ctx: &egui::Context,
    skin: &Skin,
    studio: &Studio,
    view: &mut ConnectView,
    actions: &mut Vec<Action>,
) {
    let Some(dialog) = &studio.connect else { return };
    let height = (ctx.content_rect().height() - 250.0).min(540.0);
    let (mut form, mut biss, mut ssi) = (dialog.form.clone(), dialog.biss.clone(), dialog.ssi.clone());
    let (mut interbus, mut hiperdrive) = (dialog.interbus.clone(), dialog.hiperdrive.clone());
    modal(ctx, skin, "connect", WIDTH, |ui| {
        ui.horizontal(|ui| {
            ui.label(skin.heading(skin.say("connect.title")));
            ui.add_space(skin.space.groups);
            devices(ui, skin, dialog.device, actions);
        });
        ui.add_space(skin.space.inside);
        // Always as high: nothing jumps away under the pointer.
        ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
            used_before(ui, skin, studio.settings.links(dialog.device), actions);
            match dialog.device {
                Tab::Biss => biss::form_ui(ui, skin, dialog, &mut biss, &mut view.more, actions),
                Tab::Ssi => ssi::form_ui(ui, skin, dialog, &mut ssi, &mut view.more, actions),
                Tab::Interbus => interbus::form_ui(ui, skin, &mut interbus, &mut view.more, actions),
                Tab::Hiperdrive => hiperdrive::form_ui(ui, skin, dialog, &mut hiperdrive, &mut view.more, actions),
                Tab::Hiperface | Tab::Signals => hiperface(ui, skin, dialog, &mut form, view, actions),
            }
        });
        ui.add_space(skin.space.between);
        let url = dialog.url();
        link_ui(ui, skin, dialog, url.as_ref().ok(), actions);
        let searching = dialog.search.as_ref().is_some_and(Search::is_running).then(|| Text::new("connect.searching"));
        let refused = searching.or(url.err());
        why_ui(ui, skin, refused.as_ref().or(dialog.problem.as_ref()));
        at_the_right(ui, |ui| {
            let word = skin.say("connect.connect");
            if primary(ui, skin, refused.is_none(), icons::PLUGS_CONNECTED, &word).clicked() {
                actions.push(Action::Connect(Connect::Connect));
            }
            if button(ui, "", &skin.say("connect.cancel")).clicked() {
                actions.push(Action::Connect(Connect::Close));
            }
        });
    });
    // Before whatever else was clicked: that is to see it.
    if form != dialog.form {
        actions.insert(0, Action::Connect(Connect::Edit(Box::new(form))));
    }
    if biss != dialog.biss {
        actions.insert(0, Action::Connect(Connect::EditBiss(Box::new(biss))));
    }
    if interbus != dialog.interbus {
        actions.insert(0, Action::Connect(Connect::EditInterbus(Box::new(interbus))));
    }
    if hiperdrive != dialog.hiperdrive {
        actions.insert(0, Action::Connect(Connect::EditHiperdrive(Box::new(hiperdrive))));
    }
    if ssi != dialog.ssi {
        actions.insert(0, Action::Connect(Connect::EditSsi(Box::new(ssi))));
    }
}

/// The kinds of devices.
fn devices(ui: &mut Ui, skin: &Skin, device: Tab, actions: &mut Vec<Action>) {
    for own in Tab::DEVICES {
        let word = own.bus().unwrap_or_default();
        let text = RichText::new(word).font(skin.strong(skin.sizes.body));
        let response = ui.add(egui::Button::selectable(device == own, text));
        if name(response, true, word).clicked() && own != device {
            actions.push(Action::Connect(Connect::Device(own)));
        }
    }
}

fn hiperface(
    ui: &mut Ui,
    skin: &Skin,
    dialog: &Dialog,
    form: &mut LinkForm,
    view: &mut ConnectView,
    actions: &mut Vec<Action>,
) {
    kinds(ui, skin, form);
    ui.add_space(skin.space.between);
    match form.kind {
        LinkKind::Virtual => simulated(ui, skin, form),
        LinkKind::Serial => serial(ui, skin, dialog, &mut form.port, actions),
        LinkKind::Tcp => network(ui, skin, &mut form.host, &mut form.tcp_port),
        LinkKind::Replay => recording(ui, skin, &mut form.file, actions),
    }
    if form.kind != LinkKind::Replay {
        line(ui, skin, form);
        more(ui, skin, form, &mut view.more);
    }
    if form.kind != LinkKind::Replay {
        ui.add_space(skin.space.between);
        search(ui, skin, dialog, view, actions);
    }
}

fn used_before(ui: &mut Ui, skin: &Skin, links: &[String], actions: &mut Vec<Action>) {
    if links.is_empty() {
        return;
    }
    ui.label(skin.caption(skin.say("connect.used")));
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for link in links.iter().take(LINKS) {
            let response = ui.add(egui::Button::new(skin.mono(link)).frame_when_inactive(false).truncate());
            if response.clicked() {
                actions.push(Action::Connect(Connect::Use(link.clone())));
            }
        }
    });
    ui.add_space(skin.space.between);
}

fn kinds(ui: &mut Ui, skin: &Skin, form: &mut LinkForm) {
    ui.horizontal(|ui| {
        let kinds = [
            (LinkKind::Virtual, "connect.virtual"),
            (LinkKind::Serial, "connect.serial"),
            (LinkKind::Tcp, "connect.tcp"),
            (LinkKind::Replay, "connect.replay"),
        ];
        for (kind, id) in kinds {
            let word = skin.say(id);
            let response = ui.add(egui::Button::selectable(form.kind == kind, &word));
            if name(response, true, &word).clicked() {
                form.kind = kind;
            }
        }
    });
}

fn simulated(ui: &mut Ui, skin: &Skin, form: &mut LinkForm) {
    entry(ui, skin, &skin.say("connect.model"), |ui| {
        let mut at = LinkForm::models().position(|model| model == form.model).unwrap_or(0);
        let models = LinkForm::models().enumerate().map(|(at, model)| (at, model.to_ascii_uppercase()));
        if choice(ui, &skin.say("connect.model"), &mut at, models)
            && let Some(model) = LinkForm::models().nth(at)
        {
            model.clone_into(&mut form.model);
        }
    });
    entry(ui, skin, &skin.say("connect.rpm"), |ui| text_entry(ui, &mut form.rpm, 96.0, &skin.say("connect.rpm"), "0"));
    entry(ui, skin, &skin.say("connect.fault"), |ui| {
        text_entry(ui, &mut form.fault, 200.0, &skin.say("connect.fault"), "drop:0.01");
    });
}

fn serial(ui: &mut Ui, skin: &Skin, dialog: &Dialog, port: &mut String, actions: &mut Vec<Action>) {
    entry(ui, skin, &skin.say("connect.port"), |ui| {
        text_entry(ui, port, 300.0, &skin.say("connect.port"), "/dev/ttyUSB0");
        if icon_button(ui, dialog.ports.is_some(), icons::ARROW_CLOCKWISE, &skin.say("connect.list_ports")).clicked() {
            actions.push(Action::Connect(Connect::ListPorts));
        }
    });
    match &dialog.ports {
        None => {
            ui.label(skin.caption(skin.say("connect.listing")));
        }
        Some(Err(why)) => {
            paragraph(ui, RichText::new(skin.words(why)).color(skin.palette.warn));
        }
        Some(Ok(offers)) if offers.is_empty() => {
            paragraph(ui, skin.caption(skin.say("connect.no_ports")));
        }
        Some(Ok(offers)) => {
            for offer in offers {
                ui.horizontal(|ui| {
                    ui.add_space(LABELS);
                    let button = egui::Button::selectable(*port == offer.path, skin.mono(&offer.path));
                    if ui.add(button).clicked() {
                        port.clone_from(&offer.path);
                    }
                    ui.label(skin.label(&offer.description));
                    if !offer.listed {
                        ui.label(skin.caption(skin.say("connect.not_listed")));
                    }
                });
            }
        }
    }
}

fn network(ui: &mut Ui, skin: &Skin, host: &mut String, port: &mut String) {
    place(ui, skin, "connect.host", (host, "192.168.0.7"), (port, "4001"));
    ui.label(skin.caption(skin.say("connect.tcp_words")));
}

/// Host and port, each with what it may look like.
fn place(ui: &mut Ui, skin: &Skin, id: &'static str, host: (&mut String, &str), port: (&mut String, &str)) {
    let word = skin.say(id);
    entry(ui, skin, &word, |ui| {
        text_entry(ui, host.0, 220.0, &word, host.1);
        text_entry(ui, port.0, 72.0, &skin.say("connect.tcp_port"), port.1);
    });
}

fn recording(ui: &mut Ui, skin: &Skin, file: &mut String, actions: &mut Vec<Action>) {
    entry(ui, skin, &skin.say("connect.file"), |ui| {
        text_entry(ui, file, 360.0, &skin.say("connect.file"), "capture.trace");
        if icon_button(ui, true, icons::FOLDER_OPEN, &skin.say("connect.choose_file")).clicked() {
            actions.push(Action::Connect(Connect::AskRecording));
        }
    });
}

fn line(ui: &mut Ui, skin: &Skin, form: &mut LinkForm) {
    entry(ui, skin, &skin.say("settings_card.baud"), |ui| {
        let bauds = BAUDS.map(|baud| (baud, baud.to_string()));
        choice(ui, &skin.say("settings_card.baud"), &mut form.baud, bauds);
        parity(ui, skin, &mut form.parity);
    });
    entry(ui, skin, &skin.say("connect.address"), |ui| {
        text_entry(ui, &mut form.address, 96.0, &skin.say("connect.address"), "40");
    });
}

/// The parity, beside the speed.
fn parity(ui: &mut Ui, skin: &Skin, own: &mut Parity) {
    let parities = [Parity::Even, Parity::Odd, Parity::None];
    let parities = parities.map(|parity| (parity, skin.words(&words::parity(parity))));
    ui.label(skin.label(skin.say("settings_card.parity")));
    choice(ui, &skin.say("settings_card.parity"), own, parities);
}

/// What is rarely needed.
fn more(ui: &mut Ui, skin: &Skin, form: &mut LinkForm, open: &mut bool) {
    if !unfolded(ui, skin, open) {
        return;
    }
    echo(ui, skin, &mut form.echo);
    entry(ui, skin, &skin.say("settings_card.timeout"), |ui| {
        let times = [(true, "settings_card.timeout_long"), (false, "settings_card.timeout_short")];
        let times = times.map(|(long, id)| (long, skin.say(id)));
        choice(ui, &skin.say("settings_card.timeout"), &mut form.long_timeout, times);
    });
    margin(ui, skin, &mut form.margin);
    entry(ui, skin, &skin.say("connect.periods"), |ui| {
        text_entry(ui, &mut form.periods, 72.0, &skin.say("connect.periods"), "128");
        ui.label(skin.label(skin.say("connect.turns")));
        text_entry(ui, &mut form.turns, 72.0, &skin.say("connect.turns"), "4096");
    });
}

/// The heading over what is rarely needed; whether it is unfolded.
fn unfolded(ui: &mut Ui, skin: &Skin, open: &mut bool) -> bool {
    let icon = if *open { icons::CARET_DOWN } else { icons::CARET_RIGHT };
    let word = skin.say("connect.more");
    let response = ui.add(egui::Button::new(format!("{icon}  {word}")).frame(false));
    if name(response, true, &word).clicked() {
        *open = !*open;
    }
    *open
}

fn echo(ui: &mut Ui, skin: &Skin, echo: &mut Echo) {
    entry(ui, skin, &skin.say("connect.echo"), |ui| {
        let echoes =
            [(Echo::Unknown, "connect.echo_auto"), (Echo::On, "connect.echo_on"), (Echo::Off, "connect.echo_off")];
        let echoes = echoes.map(|(echo, id)| (echo, skin.say(id)));
        choice(ui, &skin.say("connect.echo"), echo, echoes);
    });
}

fn margin(ui: &mut Ui, skin: &Skin, margin: &mut String) {
    entry(ui, skin, &skin.say("connect.margin"), |ui| {
        text_entry(ui, margin, 72.0, &skin.say("connect.margin"), "50");
        ui.label(skin.label("ms"));
    });
}

/// Whether the adapter leaves the encoder's supply on at the end.
fn leave_supply(ui: &mut Ui, skin: &Skin, leave_on: &mut bool) {
    ui.checkbox(leave_on, skin.say("connect.leave_supply"));
    paragraph(ui, skin.caption(skin.say("connect.leave_supply_words")));
}

/// The link as the command line takes it: it follows the form, and the form follows it.
fn link_ui(ui: &mut Ui, skin: &Skin, dialog: &Dialog, url: Option<&LinkUrl>, actions: &mut Vec<Action>) {
    let hint = Text::new("connect.link_hint").with("link", dialog.example());
    let (word, hint) = (skin.say("connect.link"), skin.words(&hint));
    let mut link = dialog.link();
    entry(ui, skin, &word, |ui| {
        let width = (ui.available_width() - 52.0).max(0.0);
        if mono_entry(ui, skin, &mut link, width, &word, &hint).changed() {
            actions.push(Action::Connect(Connect::Use(link)));
        }
        if icon_button(ui, url.is_some(), icons::COPY, &skin.say("shell.copy_link")).clicked()
            && let Some(url) = url
        {
            ui.copy_text(url.to_string());
        }
    });
}

/// Why it cannot go on. Two lines stand free for it, so that the buttons do not jump away under the pointer.
fn why_ui(ui: &mut Ui, skin: &Skin, why: Option<&Text>) {
    let top = ui.cursor().top();
    match why {
        Some(why) if is_missing(why) => paragraph(ui, skin.label(skin.words(why))),
        why => problem(ui, skin, why),
    }
    let rest = top + WHY - ui.cursor().top();
    ui.add_space(rest.max(0.0));
}

fn search(ui: &mut Ui, skin: &Skin, dialog: &Dialog, view: &mut ConnectView, actions: &mut Vec<Action>) {
    let running = dialog.search.as_ref().is_some_and(Search::is_running);
    skin.card().show(ui, |ui| {
        fill(ui);
        ui.label(skin.heading(skin.say("find.title")));
        paragraph(ui, skin.label(skin.say("find.words")));
        ui.add_enabled_ui(!running, |ui| {
            ui.checkbox(&mut view.one_encoder, skin.say("find.one_encoder"));
            ui.add_enabled_ui(view.one_encoder, |ui| {
                ui.checkbox(&mut view.power_cycle, skin.say("find.power_cycle"));
            });
        });
        ui.horizontal(|ui| {
            if running {
                if button(ui, icons::X, &skin.say("find.stop")).clicked() {
                    actions.push(Action::Connect(Connect::StopSearch));
                }
                spinner(ui, skin);
            } else if allowed_button(
                ui,
                skin,
                &dialog.url().map(drop),
                icons::MAGNIFYING_GLASS,
                &skin.say("find.start"),
            )
            .clicked()
            {
                let power_cycle = (view.one_encoder && view.power_cycle).then_some(POWER_CYCLE);
                let options = FindOptions { one_encoder: view.one_encoder, power_cycle };
                actions.push(Action::Connect(Connect::Search(options)));
            }
            if let Some(progress) = dialog.search.as_ref().and_then(Search::progress) {
                let part = progress.done as f32 / progress.total.max(1) as f32;
                ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(140.0));
                ui.label(skin.mono(skin.words(&words::doing(&progress.what))).color(skin.palette.muted));
            }
        });
        if let Some(search) = &dialog.search {
            found(ui, skin, search, actions);
        }
    });
}

fn found(ui: &mut Ui, skin: &Skin, search: &Search, actions: &mut Vec<Action>) {
    for (at, found) in search.found.iter().enumerate() {
        ui.horizontal(|ui| {
            let word = Text::new("find.choose").with("address", format!("{:02X}h", found.address));
            if button(ui, icons::PLUGS_CONNECTED, &skin.words(&word)).clicked() {
                actions.push(Action::Connect(Connect::Choose(at)));
            }
            let talking = Text::new("find.talking").with("format", found.format);
            let stored = Text::new("find.stored").with_text("settings", words::line_settings(found.label.settings));
            ui.label(skin.words(&talking));
            ui.label(skin.label(skin.words(&stored)));
        });
    }
    if let Some(end) = &search.end {
        paragraph(ui, skin.words(end));
    }
}

/// One of a few, side by side.
fn segments<T: PartialEq + Copy, const N: usize>(ui: &mut Ui, skin: &Skin, own: &mut T, all: [(T, &'static str); N]) {
    ui.horizontal(|ui| {
        for (one, id) in all {
            let word = skin.say(id);
            let response = ui.add(egui::Button::selectable(*own == one, &word));
            if name(response, true, &word).clicked() {
                *own = one;
            }
        }
    });
}
