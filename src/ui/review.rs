//! The review dialog before a write, for any kind of device. It shows every operation with its old and new value, the
//! cost and requirements of the write, the request for consent, the progress and the result.

use std::sync::Arc;

use egui::text::{LayoutJob, TextFormat};
use egui::{FontId, Galley, RichText, ScrollArea, Ui};

use super::controls::{enabled_button, modal, paragraph, primary_button, right_aligned, row, spinner};
use super::page::with_stable_ids;
use super::{Theme, icons};
use crate::app::review::{
    ChangeDescription, ExecutionMode, OperationDescription, PermitToggle, Question, ReviewSheet, Stage,
};
use crate::app::{Action, AnyDevice, ReviewAction, Rgb};

pub(super) fn review_ui(ctx: &egui::Context, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
    let Some(sheet) = device.review_sheet() else { return };
    let width = (ctx.content_rect().width() - 64.0).min(760.0);
    // Show as many operations as fit beside the texts of the dialog.
    let room = (ctx.content_rect().height() - REVIEW_CHROME_HEIGHT).clamp(MIN_LIST_HEIGHT, MAX_LIST_HEIGHT);
    modal(ctx, theme, "review", width, |ui| {
        ui.label(theme.heading(theme.format_text(&sheet.title)));
        ui.label(theme.label(device.name()));
        ui.add_space(theme.space.between);
        // The keyboard focus must not pass from a button of one stage to the next. A key that cancels there must not
        // write here.
        with_stable_ids(ui, std::mem::discriminant(&sheet.stage), |ui| {
            content_ui(ui, theme, device, (&sheet, room), actions)
        });
    });
}

fn content_ui(
    ui: &mut Ui,
    theme: &Theme,
    device: &AnyDevice,
    (sheet, room): (&ReviewSheet, f32),
    actions: &mut Vec<Action>,
) {
    match &sheet.stage {
        Stage::Planning => {
            ui.horizontal(|ui| {
                spinner(ui, theme);
                ui.label(theme.label(theme.translate("review.planning")));
            });
            buttons_ui(ui, theme, device, actions, "review.cancel", |_, _| {});
        }
        Stage::Nothing => {
            ui.horizontal(|ui| {
                // Values for which the user has chosen *leave* still differ.
                let (icon, colour, words) = if sheet.questions.is_empty() {
                    (icons::CHECK_CIRCLE, theme.palette.good, "review.nothing")
                } else {
                    (icons::INFO, theme.palette.accent, "review.nothing_so")
                };
                ui.label(RichText::new(icon).color(colour));
                ui.label(theme.translate(words));
            });
            remarks_ui(ui, theme, sheet);
            options_ui(ui, theme, device, sheet, actions);
            buttons_ui(ui, theme, device, actions, "review.close", |_, _| {});
        }
        Stage::Ready(plan) => {
            operations_ui(ui, theme, (&sheet.lines, room), None);
            remarks_ui(ui, theme, sheet);
            options_ui(ui, theme, device, sheet, actions);
            paragraph(ui, theme.label(theme.translate(sheet.execution_mode.summary_id())));
            buttons_ui(ui, theme, device, actions, "review.cancel", |ui, actions| {
                let icon =
                    if sheet.execution_mode == ExecutionMode::Writes { icons::DOWNLOAD_SIMPLE } else { icons::PLAY };
                // Without the permission, the write would be rejected.
                let may_wear = sheet.force_wear != Some(false);
                if primary_button(
                    ui,
                    theme,
                    device.is_ready() && may_wear,
                    icon,
                    &theme.translate(sheet.execution_mode.button_id()),
                )
                .clicked()
                {
                    actions.push(Action::Review(device.id(), ReviewAction::Write(*plan)));
                }
            });
        }
        Stage::Writing(done) => {
            operations_ui(ui, theme, (&sheet.lines, room), Some(*done));
            let part = *done as f32 / sheet.lines.len().max(1) as f32;
            ui.add(egui::ProgressBar::new(part).desired_height(4.0));
            setup_notice_ui(ui, theme, sheet);
            let stopping = device.running_job().is_some_and(|running| running.stopping);
            right_aligned(ui, |ui| {
                let word = theme.translate(if stopping { "shell.stopping" } else { "shell.cancel" });
                if enabled_button(ui, !stopping, icons::X, &word).clicked() {
                    actions.push(Action::Stop);
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    paragraph(ui, theme.label(theme.translate("review.writing")));
                });
            });
        }
        Stage::Done { verified, backup, logbook } => {
            operations_ui(ui, theme, (&sheet.lines, room), Some(usize::MAX));
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).size(theme.sizes.section).color(theme.palette.good));
                ui.label(theme.format_text(verified));
            });
            setup_notice_ui(ui, theme, sheet);
            if let Some(backup) = backup {
                row(ui, theme, &theme.translate("review.backup"), theme.monospace(backup.display().to_string()));
            }
            if let Some(why) = logbook {
                remark_ui(ui, icons::WARNING, theme.palette.warn, &theme.format_text(why));
            }
            buttons_ui(ui, theme, device, actions, "review.close", |_, _| {});
        }
        Stage::Failed { texts, begun, done } => {
            if !sheet.lines.is_empty() {
                operations_ui(ui, theme, (&sheet.lines, room), Some(*done));
            }
            let (icon, colour) =
                if *begun { (icons::WARNING, theme.palette.warn) } else { (icons::X_CIRCLE, theme.palette.bad) };
            let mut indent = 0.0;
            for (at, text) in texts.iter().enumerate() {
                ui.horizontal_top(|ui| {
                    if at == 0 {
                        indent = ui.label(RichText::new(icon).color(colour)).rect.width() + ui.spacing().item_spacing.x;
                    } else {
                        ui.add_space(indent);
                    }
                    ui.add(egui::Label::new(theme.format_text(text)).wrap().selectable(true));
                });
            }
            setup_notice_ui(ui, theme, sheet);
            options_ui(ui, theme, device, sheet, actions);
            buttons_ui(ui, theme, device, actions, "review.close", |_, _| {});
        }
    }
}

fn buttons_ui(
    ui: &mut Ui,
    theme: &Theme,
    device: &AnyDevice,
    actions: &mut Vec<Action>,
    close: &'static str,
    primary: impl FnOnce(&mut Ui, &mut Vec<Action>),
) {
    theme.add_gap(ui);
    right_aligned(ui, |ui| {
        primary(ui, actions);
        if enabled_button(ui, true, "", &theme.translate(close)).clicked() {
            actions.push(Action::Review(device.id(), ReviewAction::Close));
        }
    });
}

/// Draws the operations and, during a write, the number of completed ones. Values are never truncated.
fn operations_ui(ui: &mut Ui, theme: &Theme, (lines, room): (&[OperationDescription], f32), done: Option<usize>) {
    let palette = theme.palette;
    theme.sunken_frame().show(ui, |ui| {
        ScrollArea::vertical().id_salt("operations").max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            for (at, line) in lines.iter().enumerate() {
                if at > 0 {
                    ui.separator();
                }
                let is_done = done.is_some_and(|done| at < done);
                // A value that was read back is no longer shown as staged.
                let ink = if is_done { palette.good } else { palette.staged };
                let (icon, colour) =
                    if is_done { (icons::CHECK, palette.good) } else { (icons::PENCIL_SIMPLE, palette.muted) };
                let item = theme.format_text(&line.item);
                let short = match line.changes.as_slice() {
                    [change] if change.part.is_none() => layout_change(ui, theme, &item, change, ink),
                    _ => None,
                };
                ui.horizontal(|ui| {
                    ui.label(RichText::new(icon).color(colour));
                    ui.label(&item);
                    if let Some(words) = &short {
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            ui.add(egui::Label::new(words.clone()).selectable(true));
                        });
                    }
                });
                if short.is_some() {
                    continue;
                }
                let heads = if done == Some(usize::MAX) {
                    ["review.before", "review.after"]
                } else {
                    ["review.old", "review.new"]
                };
                line.changes.iter().for_each(|change| change_ui(ui, theme, change, heads, ink));
            }
        });
    });
    ui.add_space(theme.space.between);
}

/// Returns the old and new value on one line, or `None` if they do not fit next to the item's name.
fn layout_change(ui: &Ui, theme: &Theme, item: &str, change: &ChangeDescription, ink: Rgb) -> Option<Arc<Galley>> {
    let mut job = LayoutJob::default();
    let font = FontId::monospace(theme.sizes.body);
    let parts = [
        (theme.format_text(&change.old), theme.palette.muted),
        ("  →  ".to_owned(), theme.palette.muted),
        (theme.format_text(&change.new), ink),
    ];
    for (words, ink) in parts {
        job.append(&words, 0.0, TextFormat::simple(font.clone(), ink.into()));
    }
    job.wrap.max_width = f32::INFINITY;
    let galley = ui.painter().layout_job(job);
    let item = ui.painter().layout_no_wrap(item.to_owned(), FontId::proportional(theme.sizes.body), ink.into());
    let beside = item.size().x + ICON_WIDTH + theme.space.groups;
    (galley.rows.len() == 1 && beside + galley.size().x <= ui.available_width()).then_some(galley)
}

fn change_ui(ui: &mut Ui, theme: &Theme, change: &ChangeDescription, heads: [&'static str; 2], ink: Rgb) {
    if let Some(part) = &change.part {
        ui.horizontal(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            ui.add_space(theme.space.around);
            ui.label(theme.monospace(theme.format_text(part)));
        });
    }
    let words = [(&change.old, theme.palette.muted), (&change.new, ink)];
    for (head, (words, colour)) in heads.into_iter().zip(words) {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            ui.add_space(theme.space.around);
            let head = ui.label(theme.caption(theme.translate(head)));
            ui.add_space((HEADINGS_WIDTH - head.rect.width()).max(0.0));
            paragraph(ui, theme.monospace(theme.format_text(words)).color(colour));
        });
    }
}

/// Minimum height of the operation list in points. The next constants are its maximum height and the height of
/// everything around it.
const MIN_LIST_HEIGHT: f32 = 200.0;
const MAX_LIST_HEIGHT: f32 = 440.0;
const REVIEW_CHROME_HEIGHT: f32 = 424.0;
/// Width of the icon before an item, including the gap after the icon.
const ICON_WIDTH: f32 = 24.0;
/// Width of the column for the "old" and "new" labels.
const HEADINGS_WIDTH: f32 = 56.0;

fn remarks_ui(ui: &mut Ui, theme: &Theme, sheet: &ReviewSheet) {
    let palette = theme.palette;
    setup_notice_ui(ui, theme, sheet);
    for text in &sheet.warnings {
        remark_ui(ui, icons::WARNING, palette.warn, &theme.format_text(text));
    }
    for text in &sheet.needs {
        remark_ui(ui, icons::INFO, palette.accent, &theme.format_text(text));
    }
    if let Some(cost) = &sheet.cost {
        remark_ui(ui, icons::MEMORY, palette.muted, &theme.format_text(cost));
    }
    for text in &sheet.undo {
        remark_ui(ui, icons::ARROW_COUNTER_CLOCKWISE, palette.muted, &theme.format_text(text));
    }
}

/// Draws a red notice above the operations that lists the values to set up again after the write.
fn setup_notice_ui(ui: &mut Ui, theme: &Theme, sheet: &ReviewSheet) {
    let Some(text) = &sheet.redo else { return };
    let colour = theme.palette.bad;
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::WARNING).color(colour));
        paragraph(ui, RichText::new(theme.format_text(text)).color(colour));
    });
}

fn remark_ui(ui: &mut Ui, icon: &str, colour: Rgb, words: &str) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, words);
    });
}

fn question_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, question: &Question, actions: &mut Vec<Action>) {
    remark_ui(ui, icons::WARNING, theme.palette.warn, &theme.format_text(&question.title));
    ui.horizontal(|ui| {
        ui.add_space(ICON_WIDTH);
        for (is_on, word) in [(false, &question.no), (true, &question.yes)] {
            if ui.radio(question.is_on == is_on, theme.format_text(word)).clicked() && question.is_on != is_on {
                actions.push(Action::Review(device.id(), ReviewAction::Toggle(question.permit)));
            }
        }
    });
}

/// Draws the permissions that the user can grant, including writing to a device whose memory is worn.
fn options_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, sheet: &ReviewSheet, actions: &mut Vec<Action>) {
    if !sheet.toggles.is_empty() {
        ui.add_space(theme.space.inside);
    }
    for question in &sheet.questions {
        question_ui(ui, theme, device, question, actions);
    }
    for PermitToggle { permit, mut is_on } in sheet.toggles.iter().copied() {
        let mut response = ui.checkbox(&mut is_on, theme.translate(permit.keyword()));
        if let Some(hint) = permit.hint_id() {
            response = response.on_hover_text(theme.translate(hint));
        }
        if response.changed() {
            actions.push(Action::Review(device.id(), ReviewAction::Toggle(permit)));
        }
    }
    let force_wear = match sheet {
        sheet if sheet.is_uncounted => "review.force_uncounted",
        sheet if sheet.is_incomplete => "review.force_incomplete",
        _ => "review.force_wear",
    };
    if let Some(mut force) = sheet.force_wear
        && ui.checkbox(&mut force, theme.translate(force_wear)).changed()
    {
        actions.push(Action::Review(device.id(), ReviewAction::ForceWear(force)));
    }
}
