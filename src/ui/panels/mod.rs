//! The panels around the workspace: live values, the trace, jobs, the log.

mod lists;
pub(crate) mod live;
mod trace;

pub(super) use lists::{jobs_ui, log_ui};
pub(super) use live::{live_ui, plot_ui};
pub(super) use trace::trace_ui;

use egui::Ui;

use super::Skin;

/// A panel that has nothing to show says what would be here.
pub(super) fn nothing(ui: &mut Ui, skin: &Skin, words: &str) {
    ui.vertical_centered(|ui| {
        ui.add_space(skin.space.groups);
        ui.add(egui::Label::new(skin.label(words)).wrap());
    });
}
