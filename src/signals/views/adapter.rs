//! The adapter settings: link, sample rate, supply and errors.

use egui::Ui;

use crate::analysis::quality::Family;
use crate::app::Action;
use crate::signals::state::{SignalsAction as Signals, Source, SourceAction, TEXTS, VIRTUAL_ADAPTER};
use crate::signals::views::translate;
use crate::ui::controls::{
    card_with_trailing, dropdown, entry, icon_button, labelled_button, paragraph, primary_button, show_error_below,
    text_entry,
};
use crate::ui::{Theme, icons};

/// Selectable sample rates, in samples per second. The adapter uses the nearest rate that it supports.
const RATES: [u32; 10] = [1_000, 2_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000];
const LINK_WIDTH: f32 = 280.0;

/// Draws the adapter settings. Returns `true` if they may be closed.
pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, source: &Source, actions: &mut Vec<Action>) -> bool {
    let mut ask = |action: SourceAction| actions.push(Action::tool(Signals::Source(action)));
    let (mut started, mut closed) = (false, false);
    let aside = |ui: &mut Ui| {
        closed = icon_button(ui, true, icons::X, &translate(theme, "adapter.close")).clicked();
    };
    card_with_trailing(ui, theme, TEXTS.text("adapter.title"), aside, |ui| {
        let word = translate(theme, "adapter.link_label");
        entry(ui, theme, &word, |ui| {
            let mut link = source.link().to_owned();
            let width = LINK_WIDTH.min(ui.available_width() - theme.space.between);
            let response = text_entry(ui, &mut link, width, &word, VIRTUAL_ADAPTER);
            if response.changed() {
                ask(SourceAction::SetLink(link));
            }
            if response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                started = true;
            }
        });
        let word = translate(theme, "adapter.rate");
        entry(ui, theme, &word, |ui| {
            let mut rate = source.sample_hz();
            let rates =
                RATES.map(|hz| (hz, theme.format_text(&TEXTS.text("adapter.kilohertz").with("count", hz / 1_000))));
            if dropdown(ui, &word, &mut rate, rates) {
                ask(SourceAction::SetSampleRate(rate));
            }
        });
        let word = translate(theme, "adapter.supply");
        entry(ui, theme, &word, |ui| {
            let mut supply = source.supplied_family();
            let families = Family::ALL.map(|family| (Some(family), supply_text(theme, family)));
            let elsewhere = (None, translate(theme, "adapter.supply_elsewhere"));
            if dropdown(ui, &word, &mut supply, std::iter::once(elsewhere).chain(families)) {
                ask(SourceAction::SetSupply(supply));
            }
        });
        paragraph(ui, theme.caption(translate(theme, "adapter.link_hint")));
        show_error_below(ui, theme, source.adapter_problem());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            started |= primary_button(ui, theme, true, icons::PLAY, &translate(theme, "adapter.start")).clicked();
            if source.link() != VIRTUAL_ADAPTER
                && labelled_button(ui, icons::CPU, &translate(theme, "adapter.use_virtual")).clicked()
            {
                ask(SourceAction::SetLink(VIRTUAL_ADAPTER.to_owned()));
            }
        });
    });
    if started {
        ask(SourceAction::StartAdapter);
    } else if closed {
        // Setting the link again clears the error, which the user has read.
        ask(SourceAction::SetLink(source.link().to_owned()));
    }
    started || closed
}

fn supply_text(theme: &Theme, family: Family) -> String {
    let voltage = family.supply_voltage();
    let volts = |millivolt: u16| f64::from(millivolt) / 1000.0;
    let text = TEXTS.text("adapter.supply_of").with("family", family.name());
    let text = text.with_number("volts", volts(voltage.nominal), 1).with_number("least", volts(voltage.least), 1);
    theme.format_text(&text.with_number("greatest", volts(voltage.greatest), 1))
}
