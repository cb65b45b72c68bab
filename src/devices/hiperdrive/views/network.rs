//! Network settings: the TCP/IP object with its edited values, the outcome at the next power-up, and the meaning of the
//! address switches.

use egui::{RichText, Ui};

use crate::app::{Action, DeviceCommand, Severity, Text};
use crate::buses::ethernet_ip::protocol::AddressSource;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::profile::NetworkSettings;
use crate::devices::hiperdrive::state::network::{self, Form};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, TEXTS};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{
    button_with_reason, empty_placeholder, enabled_button, entry, folding_card, folding_card_with_trailing, mono_entry,
    options, paragraph, problem_ui, row, severity, split,
};
use crate::ui::{Theme, icons};

/// Values that have been typed but not written yet.
#[derive(Default)]
pub(super) struct NetworkUiState {
    /// Settings of the device at the time when typing began.
    of: Option<NetworkSettings>,
    form: Option<Form>,
}

const ADDRESS_WIDTH: f32 = 148.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut NetworkUiState,
    actions: &mut Vec<Action>,
) {
    if unit.profile().is_some() {
        switches_ui(ui, theme, unit);
        return;
    }
    split(
        ui,
        theme,
        (0.5, 640.0),
        (view, actions),
        |ui, (view, actions)| settings_ui(ui, theme, unit, view, actions),
        |ui, _| switches_ui(ui, theme, unit),
    );
}

fn settings_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut NetworkUiState,
    actions: &mut Vec<Action>,
) {
    let id = unit.session.id;
    let mut asked = Vec::new();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, unit.session.is_ready(), icons::ARROW_CLOCKWISE, &translate(theme, "hd_net.read"))
            .clicked()
        {
            asked.push(Action::Command(id, DeviceCommand::Read));
        }
    };
    folding_card_with_trailing(ui, theme, TEXTS.text("hd_net.title"), read, |ui| {
        let Some(now) = unit.network_settings() else {
            empty_placeholder(ui, theme, &translate(theme, "hd_net.nothing"), None);
            return;
        };
        // Text entered for other settings does not apply to these.
        if view.of.as_ref() != Some(&now) {
            (view.of, view.form) = (Some(now.clone()), None);
        }
        let before = Form::from_settings(&now);
        let mut form = view.form.clone().unwrap_or_else(|| before.clone());
        form_ui(ui, theme, &before, &mut form);
        if let Some(mac) = unit.network().and_then(|own| own.mac) {
            let mac: Vec<String> = mac.iter().map(|byte| format!("{byte:02X}")).collect();
            row(ui, theme, &translate(theme, "hd_net.mac"), theme.monospace(mac.join(":")));
        }
        ui.add_space(theme.space.between);
        let wanted = form.settings(&now);
        change_preview_ui(ui, theme, unit, &now, &wanted);
        ui.add_space(theme.space.inside);
        let allowed = match (&wanted, unit.check_can_plan()) {
            (_, Err(why)) => Err(why),
            (Err(why), _) => Err(why.clone()),
            (Ok(own), Ok(())) if *own == now => Err(TEXTS.text("hd_net.no_change")),
            (Ok(own), Ok(())) => Ok(own.clone()),
        };
        ui.horizontal_wrapped(|ui| {
            let may = allowed.as_ref().map(|_| ()).map_err(Clone::clone);
            if button_with_reason(ui, theme, &may, icons::LIST_CHECKS, &translate(theme, "hd_net.write")).clicked()
                && let Ok(own) = allowed
            {
                let change = Change::Network(own);
                actions.push(Action::device(id, Hiperdrive::Plan(Box::new(change))));
            }
            if enabled_button(ui, form != before, icons::ARROW_U_UP_LEFT, &translate(theme, "hd_net.revert")).clicked()
            {
                form = before.clone();
            }
        });
        view.form = (form != before).then_some(form);
    });
    actions.append(&mut asked);
}

fn form_ui(ui: &mut Ui, theme: &Theme, before: &Form, form: &mut Form) {
    let word = translate(theme, "hd_net.source");
    let mut sources = vec![AddressSource::Dhcp, AddressSource::Bootp, AddressSource::Stored];
    if !sources.contains(&before.source) {
        sources.push(before.source);
    }
    let named = sources.into_iter().map(|own| (own, theme.format_text(&network::source(own))));
    // The options are below their name, since a narrow column has no space beside it.
    ui.label(theme.label(word.as_str()));
    options(ui, &word, &mut form.source, named);
    ui.add_space(theme.space.inside);
    let types = form.are_addresses_editable();
    let [first, second] = &mut form.name_servers;
    let [first_before, second_before] = &before.name_servers;
    for (id, own, was, is_needed) in [
        ("hd_net.address", &mut form.address, &before.address, true),
        ("hd_net.mask", &mut form.mask, &before.mask, true),
        ("hd_net.gateway", &mut form.gateway, &before.gateway, false),
        ("hd_net.name_server", first, first_before, false),
        ("hd_net.second_server", second, second_before, false),
        ("hd_net.domain", &mut form.domain, &before.domain, false),
    ] {
        let word = translate(theme, id);
        if !types {
            let shown = if was.is_empty() { translate(theme, "hd_axis.none") } else { was.clone() };
            row(ui, theme, &word, theme.monospace(shown));
            continue;
        }
        entry(ui, theme, &word, |ui| {
            let hint = if is_needed { String::new() } else { translate(theme, "hd_net.optional") };
            mono_entry(ui, theme, own, ADDRESS_WIDTH, &word, &hint);
            if own != was && !was.is_empty() {
                let was = TEXTS.text("hd_net.was").with("value", was);
                ui.add(egui::Label::new(RichText::new(theme.format_text(&was)).color(theme.palette.staged)).truncate());
            }
        });
    }
}

fn change_preview_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    now: &NetworkSettings,
    wanted: &Result<NetworkSettings, Text>,
) {
    ui.label(theme.label(translate(theme, "hd_net.at_power_up")));
    match wanted {
        Err(why) => problem_ui(ui, theme, Some(why)),
        Ok(wanted) => {
            for (own, text) in network::consequence_texts(unit.address_switch(), now, wanted, unit.host_address()) {
                line_ui(ui, theme, own, &text);
            }
        }
    }
}

fn line_ui(ui: &mut Ui, theme: &Theme, own: Severity, text: &Text) {
    let (icon, ink) = severity(theme, own);
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(ink));
        paragraph(ui, theme.format_text(text));
    });
}

fn switches_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    folding_card(ui, theme, TEXTS.text("hd_net.switches"), |ui| {
        let switch = unit.address_switch();
        if let Some(own) = switch {
            row(ui, theme, &translate(theme, "hd_net.switch_now"), theme.value(own.number().to_string()));
            ui.add_space(theme.space.inside);
        }
        for position in network::switch_positions(switch) {
            let words = theme.format_text(&position.meaning);
            ui.horizontal_top(|ui| {
                let ink = if position.is_now { theme.palette.accent } else { theme.palette.muted };
                let mark = if position.is_now { icons::CARET_RIGHT } else { "" };
                for (width, text) in [(16.0, RichText::new(mark)), (44.0, theme.monospace(position.digits))] {
                    let size = egui::vec2(width, 18.0);
                    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Min), |ui| {
                        ui.set_min_width(width);
                        ui.label(text.color(ink));
                    });
                }
                let text = RichText::new(words);
                paragraph(ui, if position.is_now { text } else { text.color(theme.palette.muted) });
            });
        }
        ui.add_space(theme.space.inside);
        paragraph(ui, theme.caption(translate(theme, "hd_net.switch_words")));
    });
}
