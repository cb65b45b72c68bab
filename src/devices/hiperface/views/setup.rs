//! The setup page: position, synchronisation, address, line settings, access codes and restart. Every permanent change
//! is reviewed before it is written.

use egui::Ui;

use super::position::{self, PositionUiState};
use crate::app::{Action, Text, explain};
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::protocol::{AccessCodeNumber, BAUDS, LineSettings};
use crate::devices::hiperface::state::explain as words;
use crate::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, TEXTS, forms};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{
    card, clear_secret, dropdown, enabled_button, entry, folding_card, paragraph, row, secret_entry, show_error_below,
    text_entry, two_columns,
};
use crate::ui::{Theme, icons};
use crate::units::{CharacterFormat, Parity};

#[derive(Default)]
pub(super) struct SetupUiState {
    position: PositionUiState,
    address: String,
    address_problem: Option<Text>,
    settings: Option<SelectedSettings>,
    settings_problem: Option<Text>,
    code_number: AccessCodeNumber,
    code: String,
    new_code: String,
    new_again: String,
    code_problem: Option<Text>,
    /// Whether the user has confirmed that no motor currently depends on the encoder.
    is_motor_disabled: bool,
}

#[derive(Clone, Copy, PartialEq)]
struct SelectedSettings {
    format: CharacterFormat,
    long_timeout: bool,
    bus: bool,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut SetupUiState,
    actions: &mut Vec<Action>,
) {
    two_columns(
        ui,
        theme,
        (actions, view),
        |ui, (actions, view)| {
            position::card_ui(ui, theme, encoder, &mut view.position, actions);
            theme.add_gap(ui);
            access_codes_ui(ui, theme, encoder, view, actions);
        },
        |ui, (actions, view)| {
            address_ui(ui, theme, encoder, view, actions);
            theme.add_gap(ui);
            settings_ui(ui, theme, encoder, view, actions);
            theme.add_gap(ui);
            restart_ui(ui, theme, encoder, view, actions);
        },
    );
}

/// Submits a valid change, or stores the reason why it is invalid.
pub(super) fn submit_plan(
    encoder: &Encoder,
    change: Result<Change, Text>,
    problem: &mut Option<Text>,
    actions: &mut Vec<Action>,
) {
    match change {
        Ok(change) => {
            *problem = None;
            actions.push(Action::device(encoder.session.id, Hiperface::Plan(change)));
        }
        Err(why) => *problem = Some(why),
    }
}

fn access_codes_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut SetupUiState, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("codes_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "codes_card.words")));
        entry(ui, theme, &translate(theme, "codes_card.number"), |ui| {
            let numbers = AccessCodeNumber::all().map(|number| (number, number.to_string()));
            dropdown(ui, &translate(theme, "codes_card.number"), &mut view.code_number, numbers);
        });
        let number = view.code_number;
        let ready = encoder.session.is_ready();
        entry(ui, theme, &translate(theme, "codes_card.known"), |ui| {
            let response = secret_entry(ui, &mut view.code, 64.0, &translate(theme, "codes_card.known"));
            if enabled_button(ui, ready, icons::KEY, &translate(theme, "codes_card.use")).clicked() {
                let code = forms::access_code(&view.code);
                clear_secret(ui, &response, &mut view.code);
                match code {
                    Ok(code) => {
                        view.code_problem = None;
                        actions.push(Action::device(encoder.session.id, Hiperface::UseCode { number, code }));
                    }
                    Err(why) => view.code_problem = Some(why),
                }
            }
        });
        let new = entry(ui, theme, &translate(theme, "codes_card.new"), |ui| {
            secret_entry(ui, &mut view.new_code, 64.0, &translate(theme, "codes_card.new"))
        });
        entry(ui, theme, &translate(theme, "codes_card.again"), |ui| {
            let again = secret_entry(ui, &mut view.new_again, 64.0, &translate(theme, "codes_card.again"));
            if enabled_button(ui, ready, icons::PENCIL_SIMPLE, &translate(theme, "codes_card.change")).clicked() {
                let code = forms::new_access_code(&view.new_code, &view.new_again);
                clear_secret(ui, &new, &mut view.new_code);
                clear_secret(ui, &again, &mut view.new_again);
                let change = code.map(|new| Change::ChangeCode { number, new });
                submit_plan(encoder, change, &mut view.code_problem, actions);
            }
        });
        show_error_below(ui, theme, view.code_problem.as_ref());
    });
}

fn address_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut SetupUiState, actions: &mut Vec<Action>) {
    let now = encoder.identity.as_ref().map_or_else(|| "–".to_owned(), |own| format!("{:02X}h", own.address));
    folding_card(ui, theme, TEXTS.text("address_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "address_card.words")));
        entry(ui, theme, &translate(theme, "address_card.now"), |ui| ui.label(theme.monospace(now)));
        entry(ui, theme, &translate(theme, "address_card.new"), |ui| {
            text_entry(ui, &mut view.address, 64.0, &translate(theme, "address_card.new"), "41");
            if enabled_button(
                ui,
                encoder.session.is_ready(),
                icons::PENCIL_SIMPLE,
                &translate(theme, "address_card.plan"),
            )
            .clicked()
            {
                let change = forms::address(&view.address).map(Change::SetAddress);
                submit_plan(encoder, change, &mut view.address_problem, actions);
            }
        });
        show_error_below(ui, theme, view.address_problem.as_ref());
    });
}

fn settings_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut SetupUiState, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("settings_card.title"), |ui| {
        let Some(stored) = encoder.identity.as_ref().map(|identity| identity.label.settings) else {
            ui.label(theme.label(translate(theme, "settings_card.nothing")));
            return;
        };
        let stored_words = theme.format_text(&words::line_settings(stored));
        row(ui, theme, &translate(theme, "settings_card.stored"), stored_words);
        let mut chosen = view.settings.unwrap_or_else(|| initial_selection(stored));
        entry(ui, theme, &theme.translate("settings_card.baud"), |ui| {
            let bauds = BAUDS.map(|baud| (baud, baud.to_string()));
            dropdown(ui, &theme.translate("settings_card.baud"), &mut chosen.format.baud, bauds);
        });
        entry(ui, theme, &theme.translate("settings_card.parity"), |ui| {
            let parities = [Parity::Even, Parity::Odd, Parity::None];
            let parities = parities.map(|parity| (parity, theme.format_text(&explain::parity_text(parity))));
            dropdown(ui, &theme.translate("settings_card.parity"), &mut chosen.format.parity, parities);
        });
        entry(ui, theme, &translate(theme, "settings_card.timeout"), |ui| {
            let times = [(true, "settings_card.timeout_long"), (false, "settings_card.timeout_short")];
            let times = times.map(|(long, id)| (long, translate(theme, id)));
            dropdown(ui, &translate(theme, "settings_card.timeout"), &mut chosen.long_timeout, times);
        });
        ui.checkbox(&mut chosen.bus, translate(theme, "settings_card.bus"));
        view.settings = Some(chosen).filter(|chosen| *chosen != initial_selection(stored));
        let ready = encoder.session.is_ready();
        ui.add_space(theme.space.inside);
        ui.horizontal_wrapped(|ui| {
            let wanted = || forms::settings(stored, chosen.format, chosen.long_timeout, chosen.bus);
            let store = enabled_button(ui, ready, icons::FLOPPY_DISK, &translate(theme, "settings_card.plan"));
            if store.on_hover_text(translate(theme, "settings_card.plan_hint")).clicked() {
                submit_plan(encoder, wanted().map(Change::Configure), &mut view.settings_problem, actions);
            }
            let now = enabled_button(ui, ready, icons::LIGHTNING, &translate(theme, "settings_card.now"));
            if now.on_hover_text(translate(theme, "settings_card.now_hint")).clicked() {
                match wanted() {
                    Ok(wanted) => actions.push(Action::device(encoder.session.id, Hiperface::ConfigureForNow(wanted))),
                    Err(why) => view.settings_problem = Some(why),
                }
            }
        });
        show_error_below(ui, theme, view.settings_problem.as_ref());
    });
}

fn initial_selection(stored: LineSettings) -> SelectedSettings {
    SelectedSettings {
        format: stored.character_format().unwrap_or(CharacterFormat::FACTORY),
        long_timeout: stored.has_long_timeout(),
        bus: stored.is_bus(),
    }
}

fn restart_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, view: &mut SetupUiState, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("restart_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "restart_card.words")));
        ui.checkbox(&mut view.is_motor_disabled, translate(theme, "restart_card.disabled"));
        let allowed = encoder.session.is_ready() && view.is_motor_disabled;
        if enabled_button(ui, allowed, icons::POWER, &translate(theme, "restart_card.run")).clicked() {
            view.is_motor_disabled = false;
            actions.push(Action::device(encoder.session.id, Hiperface::Reset));
        }
    });
}
