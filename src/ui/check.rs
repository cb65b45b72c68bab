//! Draws the results of a device check, for every kind of device.

use egui::{RichText, Ui};

use super::controls::paragraph;
use super::{Theme, icons};
use crate::analysis::check::Verdict;
use crate::app::Text;
use crate::app::check::{CheckResultLine, verdict_text};

/// Draws the results of the last check, or explains what a check does if there are none.
pub(crate) fn lines_ui(ui: &mut Ui, theme: &Theme, lines: Option<&[CheckResultLine]>, nothing: impl Into<Text>) {
    let Some(lines) = lines else {
        paragraph(ui, theme.label(theme.format_text(&nothing.into())));
        return;
    };
    let palette = theme.palette;
    for line in lines {
        let (icon, colour) = match line.verdict {
            Verdict::Skipped => (icons::INFO, palette.muted),
            Verdict::Good => (icons::CHECK_CIRCLE, palette.good),
            Verdict::Attention => (icons::WARNING, palette.warn),
            Verdict::Bad => (icons::X_CIRCLE, palette.bad),
        };
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icon).color(colour)).on_hover_text(theme.format_text(&verdict_text(line.verdict)));
            ui.vertical(|ui| {
                ui.label(theme.format_text(&line.step));
                for finding in &line.findings {
                    ui.add(egui::Label::new(theme.caption(theme.format_text(finding))).wrap().selectable(true));
                }
            });
        });
    }
}
