//! The angle by a drive's table and exactly: how good tables of several sizes are, and one pair of voltages both ways.

use egui::Ui;

use crate::analysis::arctan::OctantTable;
use crate::signals::state::TEXTS;
use crate::signals::state::interpolation::{INTERVALS, interpolate, table_errors};
use crate::signals::views::say;
use crate::ui::Skin;
use crate::ui::controls::{card, choice, entry, labelled_entry, paragraph, problem, row, split};

/// What is typed.
pub(super) struct View {
    sine: String,
    cosine: String,
    intervals: usize,
}

impl Default for View {
    fn default() -> Self {
        View { sine: "0.25".to_owned(), cosine: "0.433".to_owned(), intervals: OctantTable::INTERVALS }
    }
}

/// Draws the card.
pub(super) fn card_ui(ui: &mut Ui, skin: &Skin, view: &mut View) {
    card(ui, skin, TEXTS.text("octant.title"), |ui| {
        paragraph(ui, skin.label(say(skin, "octant.words")));
        ui.add_space(skin.space.inside);
        split(ui, skin, (0.5, 560.0), view, |ui, _| tables(ui, skin), |ui, view| pair(ui, skin, view));
    });
}

fn tables(ui: &mut Ui, skin: &Skin) {
    ui.spacing_mut().interact_size.y = 20.0;
    egui::Grid::new("octant.title").spacing([skin.space.groups, skin.space.inside]).show(ui, |ui| {
        for id in ["octant.intervals", "octant.largest", "octant.of_period", "octant.bits"] {
            ui.label(skin.caption(say(skin, id)));
        }
        ui.end_row();
        for table in table_errors() {
            ui.label(skin.mono(table.intervals.to_string()));
            ui.label(skin.mono(format!("{}°", skin.number(table.largest_deg, 5))));
            ui.label(skin.mono(format!("1/{:.0}", table.parts)));
            ui.label(skin.mono(skin.number(table.bits, 2)));
            ui.end_row();
        }
    });
}

fn pair(ui: &mut Ui, skin: &Skin, view: &mut View) {
    for (id, text) in [("octant.sine", &mut view.sine), ("octant.cosine", &mut view.cosine)] {
        labelled_entry(ui, skin, TEXTS.text(id), text, 88.0, "");
    }
    let word = say(skin, "octant.intervals");
    entry(ui, skin, &word, |ui| {
        choice(ui, &word, &mut view.intervals, INTERVALS.map(|own| (own, own.to_string())));
    });
    match interpolate(&view.sine, &view.cosine, view.intervals) {
        Ok(found) => {
            for (id, phase) in [("octant.exact", found.exact), ("octant.table", found.table)] {
                let degrees = skin.number(phase.degrees(), 5);
                let periods = skin.number(phase.periods(), 6);
                row(ui, skin, &say(skin, id), skin.mono(format!("{degrees}°  φ {periods}  {:04X}h", phase.step(16))));
            }
            let difference = format!("{}°", skin.number(found.difference_deg, 5));
            row(ui, skin, &say(skin, "octant.difference"), skin.mono(difference));
        }
        Err(why) => problem(ui, skin, Some(&why)),
    }
}
