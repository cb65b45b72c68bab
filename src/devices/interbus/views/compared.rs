//! The cam programs of two profiles in overlaid charts.

use egui::Ui;

use super::translate;
use super::widgets::{CamChart, cam_lanes};
use crate::devices::interbus::profile::{InterbusProfile, Scale};
use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::cams::{Chart, VisibleRange};
use crate::devices::interbus::state::staged::StagedEdits;
use crate::ui::Theme;
use crate::ui::controls::paragraph;

/// Draws each program in which two profiles differ, with the cams of the right profile and outlines of the left one's.
pub(super) fn programs_ui(ui: &mut Ui, theme: &Theme, left: &InterbusProfile, right: &InterbusProfile) {
    let [left, right] = [left, right].map(|own| StagedEdits::for_profile(own.image.clone(), own.names.clone()));
    let scale = Scale::default();
    let charts = ProgramNumber::all()
        .filter_map(|number| Some((Chart::from_edits(&left, number)?, Chart::from_edits(&right, number)?)));
    let mut differing = charts.filter(|(left, right)| left != right).peekable();
    let id = if differing.peek().is_some() { "ib_cams.compared" } else { "ib_cams.all_equal" };
    paragraph(ui, theme.label(translate(theme, id)));
    for (left, right) in differing {
        theme.add_gap(ui);
        let label = theme.format_text(&TEXTS.text("report.ib_program").with("program", right.program.get()));
        ui.label(theme.heading(&label));
        ui.add_space(theme.space.inside);
        let model = CamChart {
            label: &label,
            chart: &right,
            compared: Some(&left),
            scale: &scale,
            position: None,
            own: None,
            selected: None,
            movable: false,
            snaps: false,
        };
        ui.push_id(right.program.get(), |ui| cam_lanes(ui, theme, &model, VisibleRange::full(right.range)));
    }
}
