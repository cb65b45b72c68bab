//! Eight programs of eight cams: the open one as lanes, as a ring and as a table, and the word in which an encoder sends
//! its outputs.

mod bar;
mod chart;
mod import;
mod scale;
mod table;
mod window;

use egui::Ui;

use crate::app::Action;
use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::cams::Chart;
use crate::devices::interbus::state::{Action as Interbus, Encoder, TEXTS};
use crate::devices::interbus::views::say;
use crate::ui::controls::{card, empty, enabled_button, paragraph, two_columns};
use crate::ui::{Skin, icons};

/// What is chosen and typed.
#[derive(Default)]
pub(super) struct View {
    program: Option<ProgramNumber>,
    chart: chart::View,
    table: table::View,
    scale: scale::View,
    bar: bar::View,
}

impl View {
    /// The program that is open.
    pub(super) fn shown(&self) -> ProgramNumber {
        self.program.unwrap_or(ProgramNumber::FIRST)
    }
}

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, view: &mut View, actions: &mut Vec<Action>) {
    let program = view.shown();
    view.program = Some(program);
    bar::bar_ui(ui, skin, encoder, program, view, actions);
    import::pasted(ui, encoder, program, actions);
    if let Some(table) = &encoder.import {
        ui.add_space(skin.space.between);
        import::card_ui(ui, skin, encoder, table, actions);
    }
    ui.add_space(skin.space.between);
    let Some(chart) = Chart::of(&encoder.staged, program) else {
        unread(ui, skin, encoder, program, actions);
        return;
    };
    chart::card_ui(ui, skin, encoder, &chart, &mut view.chart, actions);
    ui.add_space(skin.space.groups);
    table::card_ui(ui, skin, encoder, &chart, &mut view.table, actions);
    ui.add_space(skin.space.groups);
    two_columns(
        ui,
        skin,
        (actions, view),
        |ui, (actions, _)| window::card_ui(ui, skin, encoder, actions),
        |ui, (actions, view)| scale::card_ui(ui, skin, encoder, &mut view.scale, actions),
    );
}

/// A program of which nothing is known, and the way to know it.
fn unread(ui: &mut Ui, skin: &Skin, encoder: &Encoder, program: ProgramNumber, actions: &mut Vec<Action>) {
    card(ui, skin, TEXTS.text("ib_cams.title"), |ui| {
        let id = encoder.session.id;
        if encoder.staged.wanted().is_none() {
            empty(ui, skin, &say(skin, "ib_set.nothing"), None);
            return;
        }
        empty(ui, skin, &say(skin, "ib_cams.unread"), None);
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        ui.vertical_centered(|ui| {
            if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &say(skin, "ib_cams.read_one")).clicked() {
                actions.push(Action::device(id, Interbus::ReadPrograms(vec![program])));
            }
            if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &say(skin, "ib_cams.read_all")).clicked() {
                actions.push(Action::device(id, Interbus::ReadPrograms(ProgramNumber::all().collect())));
            }
        });
        paragraph(ui, skin.caption(say(skin, "ib_cams.read_words")));
    });
}
