//! The cams of a program as a table with positions, names and switches.

use std::collections::BTreeMap;

use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::views::translate;

use egui::{RichText, Ui};

use crate::app::{Action, Text};
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{CamNumber, ProgramNumber};
use crate::devices::interbus::state::cams::{Chart, Lane, labels};
use crate::devices::interbus::state::{Edit, Encoder, InterbusAction as Interbus, forms};
use crate::ui::controls::{card, committed_entry, name, paragraph, problem_ui};
use crate::ui::{Theme, icons};

/// Typed text that has not been applied yet.
#[derive(Default)]
pub(super) struct CamTableUiState {
    drafts: BTreeMap<(ProgramNumber, CamNumber, Column), Draft>,
}

/// Typed text, and the reason if it was rejected.
type Draft = Option<(String, Option<Text>)>;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Column {
    Name,
    Start,
    Stop,
}

const CAM_WIDTH: f32 = 48.0;
const NAME_WIDTH: f32 = 160.0;
const NUMBER_WIDTH: f32 = 104.0;
/// Width added to the text of an entry by its frame.
const ENTRY_MARGIN: f32 = 16.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    chart: &Chart,
    view: &mut CamTableUiState,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("ib_cams.table"), |ui| {
        let wide = ui.available_width() > 680.0;
        ui.horizontal(|ui| {
            let heads = [
                (CAM_WIDTH, "ib_cams.cam"),
                (NAME_WIDTH, "ib_cams.name"),
                (NUMBER_WIDTH, "ib_cams.start"),
                (NUMBER_WIDTH, "ib_cams.stop"),
            ];
            for (width, id) in heads {
                cell_ui(ui, width, |ui| ui.label(theme.caption(translate(theme, id))));
            }
        });
        for lane in &chart.lanes {
            ui.horizontal(|ui| row_ui(ui, theme, encoder, (chart, lane), wide, view, actions));
        }
        for lane in &chart.lanes {
            for column in [Column::Name, Column::Start, Column::Stop] {
                let draft = view.drafts.get(&(chart.program, lane.cam, column));
                problem_ui(ui, theme, draft.and_then(|draft| draft.as_ref()?.1.as_ref()));
            }
        }
        paragraph(ui, theme.caption(translate(theme, "ib_cams.table_words")));
    });
}

fn cell_ui<R>(ui: &mut Ui, width: f32, content: impl FnOnce(&mut Ui) -> R) -> R {
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    let cell = ui.allocate_ui_with_layout(egui::vec2(width, ui.spacing().interact_size.y), layout, |ui| {
        ui.set_min_width(width);
        content(ui)
    });
    cell.inner
}

fn row_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    (chart, lane): (&Chart, &Lane),
    wide: bool,
    view: &mut CamTableUiState,
    actions: &mut Vec<Action>,
) {
    let (id, program, cam) = (encoder.session.id, chart.program, lane.cam);
    let mut put = |edit: Edit| actions.push(Action::device(id, Interbus::Edit(Box::new(edit))));
    let ink = if lane.edited { theme.palette.staged } else { theme.palette.text };
    let mut on = lane.on;
    let response = cell_ui(ui, CAM_WIDTH, |ui| ui.checkbox(&mut on, RichText::new(cam.get().to_string()).color(ink)));
    if name(response, true, &theme.format_text(&labels::cam_name(cam))).clicked() {
        put(Edit::Switch { program, cam, on });
    }
    let word = TEXTS.text("ib_cams.name_of").with("cam", cam.get());
    let draft = view.drafts.entry((program, cam, Column::Name)).or_default();
    let shown = lane.name.as_deref().unwrap_or_default();
    cell_ui(ui, NAME_WIDTH, |ui| {
        committed_entry(ui, draft, shown, NAME_WIDTH - ENTRY_MARGIN, &theme.format_text(&word), |text| {
            put(Edit::Name { program, cam, name: text.to_owned() });
            Ok(())
        })
    });
    for (column, edge) in [(Column::Start, Edge::Start), (Column::Stop, Edge::Stop)] {
        let draft = view.drafts.entry((program, cam, column)).or_default();
        let shown = chart
            .edge_position(cam, edge)
            .map_or_else(String::new, |own| forms::format_position(own, &encoder.scale, chart.range));
        let word = theme.format_text(&labels::edge_name(lane, edge));
        cell_ui(ui, NUMBER_WIDTH, |ui| {
            committed_entry(ui, draft, &shown, NUMBER_WIDTH - ENTRY_MARGIN, &word, |text| {
                let to = forms::parse_position(text, &encoder.scale, chart.range)?;
                put(match lane.edges {
                    Some(_) => Edit::Edge { program, cam, edge, to },
                    // The other edge has the same position until the user enters it.
                    None => Edit::Cam { program, cam, start: to, stop: to, on: false },
                });
                Ok(())
            })
        });
    }
    for trouble in labels::lane_problems(chart, lane) {
        ui.label(RichText::new(icons::WARNING).color(theme.palette.warn)).on_hover_text(theme.format_text(&trouble));
    }
    if wide && let Some(edges) = lane.edges {
        let text = labels::range_text(edges, &encoder.scale, chart.range);
        let ink = if lane.on { theme.label(theme.format_text(&text)) } else { theme.caption(theme.format_text(&text)) };
        ui.add(egui::Label::new(ink).truncate());
    }
}
