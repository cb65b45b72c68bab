//! The Jobs and Log panels, which show completed jobs and notices.

use egui::{RichText, ScrollArea, Ui};
use egui_extras::{Column, TableBuilder};

use crate::app::{JobState, Studio};
use crate::ui::controls::{empty_placeholder, severity};
use crate::ui::{Theme, icons};

const ROW_HEIGHT: f32 = 22.0;
/// Maximum number of notices drawn. The log file contains all of them.
const MAX_NOTICES: usize = 200;
const TIME: &str = "%H:%M:%S";

pub(in crate::ui) fn jobs_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    let jobs: Vec<_> = studio.services.jobs().rev().collect();
    if jobs.is_empty() {
        empty_placeholder(ui, theme, &theme.translate("jobs.nothing"), None);
        return;
    }
    let palette = theme.palette;
    TableBuilder::new(ui)
        .id_salt("jobs")
        .auto_shrink(false)
        // Otherwise, the last rows of a low panel would be cut off.
        .min_scrolled_height(0.0)
        .column(Column::exact(64.0))
        .column(Column::exact(72.0))
        .column(Column::exact(20.0))
        .column(Column::initial(220.0).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(ROW_HEIGHT, jobs.len(), |mut row| {
                let Some(job) = jobs.get(row.index()) else { return };
                row.col(|ui| {
                    ui.label(theme.monospace(job.since.strftime(TIME).to_string()).color(palette.muted));
                });
                row.col(|ui| {
                    if let Some(until) = &job.until {
                        let seconds = until.duration_since(&job.since).as_secs_f64();
                        ui.label(
                            theme.monospace(format!("{} s", theme.format_number(seconds, 2))).color(palette.muted),
                        );
                    }
                });
                let (icon, colour, words) = match &job.end {
                    JobState::Running => (icons::SPINNER, palette.accent, theme.translate("jobs.running")),
                    JobState::Done => (icons::CHECK_CIRCLE, palette.good, String::new()),
                    JobState::Failed(why) => (icons::X_CIRCLE, palette.bad, theme.format_text(why)),
                    JobState::Cancelled => (icons::STOP, palette.warn, theme.translate("jobs.cancelled")),
                };
                row.col(|ui| {
                    ui.label(RichText::new(icon).color(colour));
                });
                row.col(|ui| {
                    ui.label(theme.format_text(&job.title)).on_hover_text(&job.about);
                });
                row.col(|ui| {
                    ui.label(RichText::new(&words).color(colour)).on_hover_text(&words);
                });
            });
        });
}

pub(in crate::ui) fn log_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    let palette = theme.palette;
    if studio.services.log.notices().len() == 0 {
        empty_placeholder(ui, theme, &theme.translate("log.nothing"), None);
        return;
    }
    ScrollArea::vertical().id_salt("log").auto_shrink(false).show(ui, |ui| {
        for notice in studio.services.log.notices().rev().take(MAX_NOTICES) {
            let (icon, colour) = severity(theme, notice.severity);
            ui.horizontal_top(|ui| {
                ui.label(theme.monospace(notice.at.strftime(TIME).to_string()).color(palette.muted));
                ui.label(RichText::new(icon).color(colour));
                let words: Vec<String> = notice.texts.iter().map(|text| theme.format_text(text)).collect();
                let about = notice.device_prefix(|text| theme.format_text(text));
                ui.add(egui::Label::new(format!("{about}{}", words.join(" "))).wrap().selectable(true));
            });
        }
    });
}
