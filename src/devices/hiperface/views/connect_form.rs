//! The connection form for HIPERFACE encoders, and the search for encoders with unknown settings.

use std::time::Duration;

use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::views::translate;

use egui::Ui;

use crate::app::Action;
use crate::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog};
use crate::devices::hiperface::procedures::find::FindOptions;
use crate::devices::hiperface::protocol::BAUDS;
use crate::devices::hiperface::state::explain;
use crate::devices::hiperface::state::{EncoderSearchForm, LinkForm, LinkKind, Search, SearchAction};
use crate::ui::controls::{
    button_with_reason, dropdown, entry, fill_width, labelled_button, paragraph, spinner, text_entry,
};
use crate::ui::dialogs::connect::TypedConnectForm;
use crate::ui::dialogs::connect::entries::{
    echo_ui, entries_ui, expandable_ui, network, parity, recording_file_ui, segmented_control, serial_port_ui,
    supply_choice_ui,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(crate) struct SearchUiState {
    one_encoder: bool,
    power_cycle: bool,
}

/// Time for the user to switch the supply of the encoder off and on again.
const POWER_CYCLE: Duration = Duration::from_secs(30);

pub(crate) struct HiperfaceConnectForm;

impl TypedConnectForm for HiperfaceConnectForm {
    type Form = LinkForm;
    type Memory = SearchUiState;

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        dialog: &Dialog,
        form: &mut LinkForm,
        (view, open): (&mut SearchUiState, &mut bool),
        actions: &mut Vec<Action>,
    ) {
        let kinds = [
            (LinkKind::Virtual, "connect.virtual"),
            (LinkKind::Serial, "connect.serial"),
            (LinkKind::Tcp, "connect.tcp"),
            (LinkKind::Adapter, "connect.adapter"),
            (LinkKind::Replay, "connect.replay"),
        ];
        segmented_control(ui, theme, &mut form.kind, kinds);
        ui.add_space(theme.space.between);
        match form.kind {
            LinkKind::Virtual => simulated_ui(ui, theme, form),
            LinkKind::Serial => serial_port_ui(ui, theme, dialog, &mut form.port, actions),
            LinkKind::Tcp => network(ui, theme, &mut form.host, &mut form.tcp_port),
            LinkKind::Adapter => adapter_ui(ui, theme, dialog, form, actions),
            LinkKind::Replay => recording_file_ui(ui, theme, &mut form.file, actions),
        }
        if form.kind != LinkKind::Replay {
            line_ui(ui, theme, form);
            more_settings_ui(ui, theme, form, open);
        }
        if form.kind != LinkKind::Replay {
            ui.add_space(theme.space.between);
            search(ui, theme, dialog, view, actions);
        }
    }
}

fn adapter_ui(ui: &mut Ui, theme: &Theme, dialog: &Dialog, form: &mut LinkForm, actions: &mut Vec<Action>) {
    paragraph(ui, theme.caption(translate(theme, "connect.adapter_words")));
    segmented_control(ui, theme, &mut form.network, [(false, "connect.serial"), (true, "connect.tcp")]);
    if form.network {
        network(ui, theme, &mut form.host, &mut form.tcp_port);
    } else {
        serial_port_ui(ui, theme, dialog, &mut form.port, actions);
    }
    entries_ui(ui, theme, translate, LinkForm::adapter_entries(), &mut form.typed);
}

fn simulated_ui(ui: &mut Ui, theme: &Theme, form: &mut LinkForm) {
    entry(ui, theme, &translate(theme, "connect.model"), |ui| {
        let mut at = LinkForm::model_names().position(|model| model == form.model).unwrap_or(0);
        let models = LinkForm::model_names().enumerate().map(|(at, model)| (at, model.to_ascii_uppercase()));
        if dropdown(ui, &translate(theme, "connect.model"), &mut at, models)
            && let Some(model) = LinkForm::model_names().nth(at)
        {
            model.clone_into(&mut form.model);
        }
    });
    entries_ui(ui, theme, translate, LinkForm::virtual_device_entries(), &mut form.typed);
}

fn line_ui(ui: &mut Ui, theme: &Theme, form: &mut LinkForm) {
    entry(ui, theme, &theme.translate("settings_card.baud"), |ui| {
        let bauds = BAUDS.map(|baud| (baud, baud.to_string()));
        dropdown(ui, &theme.translate("settings_card.baud"), &mut form.baud, bauds);
        parity(ui, theme, &mut form.parity);
    });
    entry(ui, theme, &translate(theme, "connect.address"), |ui| {
        text_entry(ui, &mut form.address, 96.0, &translate(theme, "connect.address"), "40");
    });
}

fn more_settings_ui(ui: &mut Ui, theme: &Theme, form: &mut LinkForm, open: &mut bool) {
    if !expandable_ui(ui, theme, open) {
        return;
    }
    echo_ui(ui, theme, &mut form.echo);
    entry(ui, theme, &translate(theme, "settings_card.timeout"), |ui| {
        let times = [(true, "settings_card.timeout_long"), (false, "settings_card.timeout_short")];
        let times = times.map(|(long, id)| (long, translate(theme, id)));
        dropdown(ui, &translate(theme, "settings_card.timeout"), &mut form.long_timeout, times);
    });
    if form.kind == LinkKind::Adapter {
        supply_choice_ui(ui, theme, &mut form.leave_supply);
    }
    entries_ui(ui, theme, translate, LinkForm::link_entries(), &mut form.typed);
}

fn search(ui: &mut Ui, theme: &Theme, dialog: &Dialog, view: &mut SearchUiState, actions: &mut Vec<Action>) {
    let search = dialog.finder_as::<EncoderSearchForm>().and_then(|finder| finder.search.as_ref());
    let running = search.is_some_and(Search::is_running);
    theme.card_frame().show(ui, |ui| {
        fill_width(ui);
        ui.label(theme.heading(translate(theme, "find.title")));
        paragraph(ui, theme.label(translate(theme, "find.words")));
        ui.add_enabled_ui(!running, |ui| {
            ui.checkbox(&mut view.one_encoder, translate(theme, "find.one_encoder"));
            ui.add_enabled_ui(view.one_encoder, |ui| {
                ui.checkbox(&mut view.power_cycle, translate(theme, "find.power_cycle"));
            });
        });
        ui.horizontal(|ui| {
            if running {
                if labelled_button(ui, icons::X, &translate(theme, "find.stop")).clicked() {
                    actions.push(Action::Connect(Connect::StopSearch));
                }
                spinner(ui, theme);
            } else if button_with_reason(
                ui,
                theme,
                &dialog.url().map(drop),
                icons::MAGNIFYING_GLASS,
                &translate(theme, "find.start"),
            )
            .clicked()
            {
                let power_cycle = (view.one_encoder && view.power_cycle).then_some(POWER_CYCLE);
                let options = FindOptions { one_encoder: view.one_encoder, power_cycle };
                actions.push(find(SearchAction::Search(options)));
            }
            if let Some(progress) = search.and_then(Search::progress) {
                let part = progress.done as f32 / progress.total.max(1) as f32;
                ui.add(egui::ProgressBar::new(part).desired_height(4.0).desired_width(140.0));
                ui.label(
                    theme.monospace(theme.format_text(&explain::step_text(&progress.step))).color(theme.palette.muted),
                );
            }
        });
        if let Some(search) = search {
            search_results_ui(ui, theme, search, actions);
        }
    });
}

fn find(action: SearchAction) -> Action {
    Action::Connect(Connect::find::<EncoderSearchForm>(action))
}

fn search_results_ui(ui: &mut Ui, theme: &Theme, search: &Search, actions: &mut Vec<Action>) {
    for (at, found) in search.found.iter().enumerate() {
        ui.horizontal(|ui| {
            let word = TEXTS.text("find.choose").with("address", format!("{:02X}h", found.address));
            if labelled_button(ui, icons::PLUGS_CONNECTED, &theme.format_text(&word)).clicked() {
                actions.push(find(SearchAction::Choose(at)));
            }
            let talking = TEXTS.text("find.talking").with("format", found.format);
            let stored = TEXTS.text("find.stored").with_text("settings", explain::line_settings(found.label.settings));
            ui.label(theme.format_text(&talking));
            ui.label(theme.label(theme.format_text(&stored)));
        });
    }
    if let Some(end) = &search.end {
        paragraph(ui, theme.format_text(end));
    }
}
