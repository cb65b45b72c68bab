//! Problems with the edited values. They are shown at the bottom of every page so that no controls move, and because an
//! edit on one page may affect another: a shorter measuring range may leave cams beyond it.

use egui::{RichText, Ui};

use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::Encoder;
use crate::ui::controls::{paragraph, problem_ui};
use crate::ui::{Theme, icons, page};

/// Draws the problems, those of the program `shown` first, and the reason why the last edit was rejected.
pub(super) fn marks_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, shown: Option<ProgramNumber>) {
    let marks = encoder.visible_marks(shown);
    if marks.is_empty() && encoder.refusal.is_none() {
        return;
    }
    let around = page::side_margin(ui, theme);
    let frame = egui::Frame::NONE.inner_margin(egui::Margin { left: around, right: around, top: 8, bottom: 4 });
    let id = egui::Id::unique(encoder.session.id).with("interbus_marks");
    egui::Panel::bottom(id).frame(frame).show_separator_line(false).show(ui, |ui| {
        for mark in &marks {
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
                paragraph(ui, theme.format_text(mark));
            });
        }
        problem_ui(ui, theme, encoder.refusal.as_ref());
    });
}
