//! The cams page: the cams of a program as lanes, ring and table, and the encoder's cam output word.

mod bar;
mod chart;
mod import;
mod scale;
mod table;
mod window;

use egui::{Label, RichText, Ui};

use crate::app::Action;
use crate::devices::interbus::protocol::{DESIGN_WRITE_CYCLES, ProgramNumber};
use crate::devices::interbus::state::cams::Chart;
use crate::devices::interbus::state::{Encoder, InterbusAction as Interbus, TEXTS};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{card, empty_placeholder, enabled_button, two_columns};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct CamsUiState {
    program: Option<ProgramNumber>,
    chart: chart::CamChartUiState,
    table: table::CamTableUiState,
    scale: scale::CamScaleUiState,
    bar: bar::CamBarUiState,
}

impl CamsUiState {
    pub(super) fn displayed_program(&self) -> ProgramNumber {
        self.program.unwrap_or(ProgramNumber::FIRST)
    }
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut CamsUiState,
    actions: &mut Vec<Action>,
) {
    let program = view.displayed_program();
    view.program = Some(program);
    bar::bar_ui(ui, theme, encoder, program, view, actions);
    import::import_pasted_table(ui, encoder, program, actions);
    if let Some(table) = &encoder.import {
        ui.add_space(theme.space.between);
        import::card_ui(ui, theme, encoder, table, actions);
    }
    ui.add_space(theme.space.between);
    let Some(chart) = Chart::from_edits(&encoder.staged, program) else {
        unread_program_ui(ui, theme, encoder, program, actions);
        return;
    };
    chart::card_ui(ui, theme, encoder, &chart, &mut view.chart, actions);
    theme.add_gap(ui);
    table::card_ui(ui, theme, encoder, &chart, &mut view.table, actions);
    theme.add_gap(ui);
    two_columns(
        ui,
        theme,
        (actions, view),
        |ui, (actions, _)| window::card_ui(ui, theme, encoder, actions),
        |ui, (actions, view)| scale::card_ui(ui, theme, encoder, &mut view.scale, actions),
    );
}

fn unread_program_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, program: ProgramNumber, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("ib_cams.title"), |ui| {
        let id = encoder.session.id;
        if encoder.staged.edited_values().is_none() {
            empty_placeholder(ui, theme, &translate(theme, "ib_set.nothing"), None);
            return;
        }
        empty_placeholder(ui, theme, &translate(theme, "ib_cams.unread"), None);
        let cost = TEXTS.text("ib_cams.read_cost").with("cycles", DESIGN_WRITE_CYCLES);
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        ui.vertical_centered(|ui| {
            ui.add(Label::new(RichText::new(theme.format_text(&cost)).color(theme.palette.warn)).wrap());
            if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "ib_cams.read_one")).clicked() {
                actions.push(Action::device(id, Interbus::ReadPrograms(vec![program])));
            }
            if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "ib_cams.read_all")).clicked() {
                actions.push(Action::device(id, Interbus::ReadPrograms(ProgramNumber::all().collect())));
            }
            ui.add(Label::new(theme.caption(translate(theme, "ib_cams.read_words"))).wrap());
        });
    });
}
