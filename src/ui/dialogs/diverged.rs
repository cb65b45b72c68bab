//! The dialog shown when another program has changed the file of an open profile. It compares both versions.

use egui::{RichText, ScrollArea, Ui};

use crate::app::diverged::{ConflictResolution, ProfileConflict, Row, Side};
use crate::app::{Action, Studio, Text};
use crate::profile::ChangedSide;
use crate::ui::controls::{
    enabled_button, labelled_button, modal, options, paragraph, primary_button, problem_ui, right_aligned,
};
use crate::ui::{Theme, icons};

/// Maximum height of the list in points. The buttons stay visible below a long list.
const MAX_LIST_HEIGHT: f32 = 320.0;
/// Maximum number of characters shown of a value. Memory contents may have thousands of them.
const MAX_VALUE_CHARS: usize = 60;

/// Draws the dialog if there is a conflict.
pub(in crate::ui) fn diverged_ui(ctx: &egui::Context, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    // If the choice leads to a question, the question is shown first.
    let Some(diverged) = studio.diverged.as_ref().filter(|_| studio.question.is_none()) else { return };
    modal(ctx, theme, "diverged", 640.0, |ui| {
        ui.label(theme.heading(theme.translate("diverged.title")));
        ui.add_space(theme.space.between);
        let text = Text::new("diverged.words").with("path", diverged.path().display());
        paragraph(ui, theme.format_text(&text));
        ui.add_space(theme.space.between);
        ScrollArea::vertical().max_height(MAX_LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
            for (at, row) in diverged.rows().iter().enumerate() {
                row_ui(ui, theme, at, row, actions);
            }
        });
        problem_ui(ui, theme, diverged.problem_text().as_ref());
        theme.add_gap(ui);
        buttons_ui(ui, theme, diverged, actions);
    });
}

fn row_ui(ui: &mut Ui, theme: &Theme, at: usize, row: &Row, actions: &mut Vec<Action>) {
    let place = row.location();
    let who = match row.changed {
        ChangedSide::There => "diverged.there",
        ChangedSide::Here => "diverged.here",
        ChangedSide::Both => "diverged.both",
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(theme.monospace(&place));
        ui.label(theme.caption(theme.translate(who)));
        if row.take.is_none() {
            ui.label(RichText::new(theme.translate("diverged.open")).color(theme.palette.warn));
        }
    });
    let value = |side: Side| row.value(side).map_or_else(|| theme.translate("diverged.nothing"), shortened_text);
    let sides = [(Side::Theirs, "diverged.theirs"), (Side::Mine, "diverged.mine")];
    let choices = sides.map(|(side, word)| {
        let text = Text::new(word).with("value", value(side));
        (Some(side), theme.format_text(&text))
    });
    let mut take = row.take;
    if options(ui, &place, &mut take, choices)
        && let Some(side) = take
    {
        actions.push(Action::Resolve(ConflictResolution::Take(at, side)));
    }
    ui.add_space(theme.space.between);
}

fn shortened_text(value: &str) -> String {
    let words: Vec<&str> = value.split_whitespace().collect();
    let line = words.join(" ");
    if line.chars().count() <= MAX_VALUE_CHARS {
        return line;
    }
    format!("{}…", line.chars().take(MAX_VALUE_CHARS).collect::<String>())
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, diverged: &ProfileConflict, actions: &mut Vec<Action>) {
    right_aligned(ui, |ui| {
        let can_merge = diverged.can_merge();
        if primary_button(ui, theme, can_merge, icons::FLOPPY_DISK, &theme.translate("diverged.merge")).clicked() {
            actions.push(Action::Resolve(ConflictResolution::Merge));
        }
        if enabled_button(ui, diverged.can_overwrite_file(), "", &theme.translate("diverged.keep_mine")).clicked() {
            actions.push(Action::Resolve(ConflictResolution::KeepMine));
        }
        if enabled_button(ui, diverged.can_reload(), "", &theme.translate("diverged.reload")).clicked() {
            actions.push(Action::Resolve(ConflictResolution::Reload));
        }
        if labelled_button(ui, "", &theme.translate("file.cancel")).clicked() {
            actions.push(Action::Resolve(ConflictResolution::Close));
        }
    });
}
