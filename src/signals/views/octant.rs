//! Comparison between a drive's octant table and the exact angle: the errors for several table sizes, and both results
//! for one pair of voltages.

use egui::Ui;

use crate::analysis::arctan::OctantTable;
use crate::signals::state::TEXTS;
use crate::signals::state::interpolation::{INTERVALS, interpolate, table_errors};
use crate::signals::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{card, dropdown, entry, labelled_number_entry, paragraph, problem_ui, row, split};

pub(super) struct OctantUiState {
    sine: String,
    cosine: String,
    intervals: usize,
}

impl Default for OctantUiState {
    fn default() -> Self {
        OctantUiState { sine: "0.25".to_owned(), cosine: "0.433".to_owned(), intervals: OctantTable::INTERVALS }
    }
}

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, view: &mut OctantUiState) {
    card(ui, theme, TEXTS.text("octant.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "octant.words")));
        ui.add_space(theme.space.inside);
        split(ui, theme, (0.5, 560.0), view, |ui, _| tables_ui(ui, theme), |ui, view| voltage_pair_ui(ui, theme, view));
    });
}

fn tables_ui(ui: &mut Ui, theme: &Theme) {
    ui.spacing_mut().interact_size.y = 20.0;
    egui::Grid::new("octant.title").spacing([theme.space.groups, theme.space.inside]).show(ui, |ui| {
        for id in ["octant.intervals", "octant.largest", "octant.of_period", "octant.bits"] {
            ui.label(theme.caption(translate(theme, id)));
        }
        ui.end_row();
        for table in table_errors() {
            ui.label(theme.monospace(table.intervals.to_string()));
            ui.label(theme.monospace(format!("{}°", theme.format_number(table.largest_deg, 5))));
            ui.label(theme.monospace(format!("1/{:.0}", table.parts)));
            ui.label(theme.monospace(theme.format_number(table.bits, 2)));
            ui.end_row();
        }
    });
}

fn voltage_pair_ui(ui: &mut Ui, theme: &Theme, view: &mut OctantUiState) {
    for (id, text) in [("octant.sine", &mut view.sine), ("octant.cosine", &mut view.cosine)] {
        labelled_number_entry(ui, theme, TEXTS.text(id), text, 88.0, "");
    }
    let word = translate(theme, "octant.intervals");
    entry(ui, theme, &word, |ui| {
        dropdown(ui, &word, &mut view.intervals, INTERVALS.map(|own| (own, own.to_string())));
    });
    match interpolate(&view.sine, &view.cosine, view.intervals) {
        Ok(found) => {
            for (id, phase) in [("octant.exact", found.exact), ("octant.table", found.table)] {
                let degrees = theme.format_number(phase.to_degrees(), 5);
                let periods = theme.format_number(phase.to_periods(), 6);
                row(
                    ui,
                    theme,
                    &translate(theme, id),
                    theme.monospace(format!("{degrees}°  φ {periods}  {:04X}h", phase.step(16))),
                );
            }
            let difference = format!("{}°", theme.format_number(found.difference_deg, 5));
            row(ui, theme, &translate(theme, "octant.difference"), theme.monospace(difference));
        }
        Err(why) => problem_ui(ui, theme, Some(&why)),
    }
}
