//! The review of a write: every operation old → new, what it costs and needs, the consent, how far it is, what came of it.

use egui::{RichText, ScrollArea, Ui};

use crate::app::hiperface::{Action as Hiperface, Encoder, Review, ReviewState, review as plan};
use crate::app::{Action, explain};
use crate::ui::controls::{enabled_button, modal, paragraph, primary, row, spinner};
use crate::ui::{Skin, icons};
use crate::worker::hiperface::{Committed, Prepared};

/// Draws the dialog, where a write is on its way.
pub(in crate::ui) fn review_ui(ctx: &egui::Context, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(review) = &encoder.review else { return };
    let width = (ctx.content_rect().width() - 64.0).min(760.0);
    modal(ctx, skin, "review", width, |ui| {
        ui.label(skin.heading(skin.words(&review.what)));
        ui.label(skin.label(encoder.session.name()));
        ui.add_space(skin.space.between);
        content(ui, skin, encoder, review, actions);
    });
}

fn content(ui: &mut Ui, skin: &Skin, encoder: &Encoder, review: &Review, actions: &mut Vec<Action>) {
    match &review.state {
        ReviewState::Planning => {
            ui.horizontal(|ui| {
                spinner(ui, skin);
                ui.label(skin.label(skin.say("review.planning")));
            });
            buttons(ui, skin, encoder, actions, "review.cancel", |_, _| {});
        }
        ReviewState::Ready(prepared) if prepared.plan.is_empty() => {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(skin.palette.good));
                ui.label(skin.say("review.nothing"));
            });
            remarks(ui, skin, prepared);
            options(ui, skin, encoder, review, actions);
            buttons(ui, skin, encoder, actions, "review.close", |_, _| {});
        }
        ReviewState::Ready(prepared) => {
            operations(ui, skin, prepared, None);
            remarks(ui, skin, prepared);
            options(ui, skin, encoder, review, actions);
            ui.label(skin.label(skin.say("review.way")));
            buttons(ui, skin, encoder, actions, "review.cancel", |ui, actions| {
                if primary(ui, skin, encoder.session.is_ready(), icons::DOWNLOAD_SIMPLE, &skin.say("review.write"))
                    .clicked()
                {
                    actions.push(Action::Hiperface(encoder.session.id, Hiperface::Write(prepared.plan.id())));
                }
            });
        }
        ReviewState::Writing(prepared) => {
            let progress =
                encoder.session.line().and_then(|line| line.running()).and_then(|running| running.progress.clone());
            let done = progress.as_ref().map_or(0, |progress| usize::try_from(progress.done).unwrap_or(usize::MAX));
            operations(ui, skin, prepared, Some(done));
            let part = done as f32 / prepared.plan.ops.len().max(1) as f32;
            ui.add(egui::ProgressBar::new(part).desired_height(4.0));
            let stopping =
                encoder.session.line().and_then(|line| line.running()).is_some_and(|running| running.stopping);
            ui.horizontal(|ui| {
                ui.label(skin.label(skin.say("review.writing")));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if enabled_button(ui, !stopping, icons::STOP, &skin.say("review.stop")).clicked() {
                        actions.push(Action::Stop);
                    }
                });
            });
        }
        ReviewState::Done(prepared, committed) => {
            done(ui, skin, prepared, committed);
            buttons(ui, skin, encoder, actions, "review.close", |_, _| {});
        }
        ReviewState::Failed { texts, begun } => {
            let (icon, colour) =
                if *begun { (icons::WARNING, skin.palette.warn) } else { (icons::X_CIRCLE, skin.palette.bad) };
            for (at, text) in texts.iter().enumerate() {
                ui.horizontal_top(|ui| {
                    ui.label(RichText::new(if at == 0 { icon } else { "  " }).color(colour));
                    ui.add(egui::Label::new(skin.words(text)).wrap().selectable(true));
                });
            }
            options(ui, skin, encoder, review, actions);
            buttons(ui, skin, encoder, actions, "review.close", |_, _| {});
        }
    }
}

fn buttons(
    ui: &mut Ui,
    skin: &Skin,
    encoder: &Encoder,
    actions: &mut Vec<Action>,
    close: &'static str,
    primary: impl FnOnce(&mut Ui, &mut Vec<Action>),
) {
    ui.add_space(skin.space.groups);
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        primary(ui, actions);
        if enabled_button(ui, true, "", &skin.say(close)).clicked() {
            actions.push(Action::Hiperface(encoder.session.id, Hiperface::CloseReview));
        }
    });
}

/// The operations; while they are carried out, with the number of those that are done. What is written is never cut off.
fn operations(ui: &mut Ui, skin: &Skin, prepared: &Prepared, done: Option<usize>) {
    let palette = skin.palette;
    skin.sunken().show(ui, |ui| {
        ScrollArea::vertical().id_salt("operations").max_height(280.0).auto_shrink([false, true]).show(ui, |ui| {
            for (at, line) in plan::lines(&prepared.plan).iter().enumerate() {
                if at > 0 {
                    ui.separator();
                }
                ui.horizontal(|ui| {
                    let is_done = done.is_some_and(|done| at < done);
                    let icon = if is_done { icons::CHECK } else { icons::PENCIL_SIMPLE };
                    let colour = if is_done { palette.good } else { palette.muted };
                    ui.label(RichText::new(icon).color(colour));
                    ui.label(skin.words(&line.item));
                });
                let heads = if done == Some(usize::MAX) {
                    ["review.before", "review.after"]
                } else {
                    ["review.old", "review.new"]
                };
                let words = [(&line.old, palette.muted), (&line.new, palette.staged)];
                for (head, (words, colour)) in heads.into_iter().zip(words) {
                    ui.horizontal_top(|ui| {
                        ui.spacing_mut().interact_size.y = 18.0;
                        ui.add_space(skin.space.around);
                        let head = ui.label(skin.caption(skin.say(head)));
                        ui.add_space((HEADS - head.rect.width()).max(0.0));
                        paragraph(ui, skin.mono(skin.words(words)).color(colour));
                    });
                }
            }
        });
    });
    ui.add_space(skin.space.between);
}

/// Width of the column that says which is old and which is new.
const HEADS: f32 = 56.0;

fn remarks(ui: &mut Ui, skin: &Skin, prepared: &Prepared) {
    let palette = skin.palette;
    for text in plan::warnings(prepared) {
        remark(ui, icons::WARNING, palette.warn, &skin.words(&text));
    }
    for text in plan::needs(&prepared.plan) {
        remark(ui, icons::INFO, palette.accent, &skin.words(&text));
    }
    if !prepared.plan.is_empty() {
        remark(ui, icons::MEMORY, palette.muted, &skin.words(&plan::cost(prepared)));
    }
}

fn remark(ui: &mut Ui, icon: &str, colour: crate::app::Rgb, words: &str) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, words);
    });
}

/// What a restore may do, and writing although the encoder counts as worn.
fn options(ui: &mut Ui, skin: &Skin, encoder: &Encoder, review: &Review, actions: &mut Vec<Action>) {
    if let Some(options) = review.options() {
        let mut wanted = options;
        ui.add_space(skin.space.inside);
        ui.checkbox(&mut wanted.allow_other_device, skin.say("review.allow_other"));
        ui.checkbox(&mut wanted.with_mounting, skin.say("review.with_mounting"))
            .on_hover_text(skin.say("review.with_mounting_hint"));
        ui.checkbox(&mut wanted.recreate, skin.say("review.recreate")).on_hover_text(skin.say("review.recreate_hint"));
        if wanted != options {
            actions.push(Action::Hiperface(encoder.session.id, Hiperface::PlanAgain(wanted)));
        }
    }
    let worn = review.prepared().is_some_and(plan::is_worn);
    if worn {
        let mut force = review.force_wear;
        ui.checkbox(&mut force, skin.say("review.force_wear"));
        if force != review.force_wear {
            actions.push(Action::Hiperface(encoder.session.id, Hiperface::ForceWear(force)));
        }
    }
}

fn done(ui: &mut Ui, skin: &Skin, prepared: &Prepared, committed: &Committed) {
    operations(ui, skin, prepared, Some(usize::MAX));
    ui.horizontal(|ui| {
        ui.label(RichText::new(icons::CHECK_CIRCLE).size(skin.sizes.section).color(skin.palette.good));
        ui.label(skin.words(&explain::hiperface::verified(&committed.written)));
    });
    if let Some(backup) = &committed.backup {
        row(ui, skin, &skin.say("review.backup"), skin.mono(backup.display().to_string()));
    }
    if let Some(why) = &committed.logbook_warning {
        remark(ui, icons::WARNING, skin.palette.warn, &skin.words(&explain::logbook(why)));
    }
}
