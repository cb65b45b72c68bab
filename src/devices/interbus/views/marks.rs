//! Problems of the edited values, shown below every page so that buttons and entries do not move. An edit on one page
//! may cause problems on another, such as cams beyond a shorter measuring range.

use egui::{RichText, Ui};

use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::Encoder;
use crate::ui::controls::{paragraph, problem_ui};
use crate::ui::{Theme, icons, page};

/// Draws the marks and the reason why the last edit was rejected. Marks of the program `shown` come first.
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
