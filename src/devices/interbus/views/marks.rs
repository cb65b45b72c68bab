//! The problems of the edited values, above every page: a smaller measuring range leaves cams beyond it, which are edited
//! on another page.

use egui::{RichText, Ui};

use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::Encoder;
use crate::ui::controls::paragraph;
use crate::ui::{Theme, icons};

/// Draws them, except those of a program that is shown with its own.
pub(super) fn marks_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, shown: Option<ProgramNumber>) {
    let marks = encoder.marks_beside(shown);
    for mark in &marks {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
            paragraph(ui, theme.words(mark));
        });
    }
    if !marks.is_empty() {
        ui.add_space(theme.space.between);
    }
}
