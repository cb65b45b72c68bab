//! A profile that others have changed in its file: both versions side by side, and which one is taken.

use egui::{RichText, ScrollArea, Ui};

use crate::app::diverged::{Diverged, Resolve, Row, Side};
use crate::app::{Action, Studio, Text};
use crate::profile::Changed;
use crate::ui::controls::{at_the_right, button, enabled_button, modal, options, paragraph, primary, problem};
use crate::ui::{Skin, icons};

/// Height of the list, so that a long one leaves the buttons in sight.
const LIST: f32 = 320.0;
/// Most characters of a value that are shown: a memory has thousands.
const SHOWN: usize = 60;

/// Draws the dialog, where there is something to decide.
pub(in crate::ui) fn diverged_ui(ctx: &egui::Context, skin: &Skin, studio: &Studio, actions: &mut Vec<Action>) {
    // A question that came of it stands before it.
    let Some(diverged) = studio.diverged.as_ref().filter(|_| studio.question.is_none()) else { return };
    modal(ctx, skin, "diverged", 640.0, |ui| {
        ui.label(skin.heading(skin.say("diverged.title")));
        ui.add_space(skin.space.between);
        let text = Text::new("diverged.words").with("path", diverged.path().display());
        paragraph(ui, skin.words(&text));
        ui.add_space(skin.space.between);
        ScrollArea::vertical().max_height(LIST).auto_shrink([false, true]).show(ui, |ui| {
            for (at, row) in diverged.rows().iter().enumerate() {
                row_ui(ui, skin, at, row, actions);
            }
        });
        problem(ui, skin, diverged.problem().as_ref());
        ui.add_space(skin.space.groups);
        buttons(ui, skin, diverged, actions);
    });
}

fn row_ui(ui: &mut Ui, skin: &Skin, at: usize, row: &Row, actions: &mut Vec<Action>) {
    let place = row.place();
    let who = match row.changed {
        Changed::There => "diverged.there",
        Changed::Here => "diverged.here",
        Changed::Both => "diverged.both",
    };
    ui.horizontal_wrapped(|ui| {
        ui.label(skin.mono(&place));
        ui.label(skin.caption(skin.say(who)));
        if row.take.is_none() {
            ui.label(RichText::new(skin.say("diverged.open")).color(skin.palette.warn));
        }
    });
    let says = |side: Side| row.says(side).map_or_else(|| skin.say("diverged.nothing"), shortened);
    let sides = [(Side::Theirs, "diverged.theirs"), (Side::Mine, "diverged.mine")];
    let choices = sides.map(|(side, word)| {
        let text = Text::new(word).with("value", says(side));
        (Some(side), skin.words(&text))
    });
    let mut take = row.take;
    if options(ui, &place, &mut take, choices)
        && let Some(side) = take
    {
        actions.push(Action::Resolve(Resolve::Take(at, side)));
    }
    ui.add_space(skin.space.between);
}

/// A value on one line, with its beginning.
fn shortened(value: &str) -> String {
    let words: Vec<&str> = value.split_whitespace().collect();
    let line = words.join(" ");
    if line.chars().count() <= SHOWN {
        return line;
    }
    format!("{}…", line.chars().take(SHOWN).collect::<String>())
}

fn buttons(ui: &mut Ui, skin: &Skin, diverged: &Diverged, actions: &mut Vec<Action>) {
    at_the_right(ui, |ui| {
        let can_merge = diverged.can_merge();
        if primary(ui, skin, can_merge, icons::FLOPPY_DISK, &skin.say("diverged.merge")).clicked() {
            actions.push(Action::Resolve(Resolve::Merge));
        }
        if enabled_button(ui, diverged.can_keep_mine(), "", &skin.say("diverged.keep_mine")).clicked() {
            actions.push(Action::Resolve(Resolve::KeepMine));
        }
        if enabled_button(ui, diverged.can_reload(), "", &skin.say("diverged.reload")).clicked() {
            actions.push(Action::Resolve(Resolve::Reload));
        }
        if button(ui, "", &skin.say("file.cancel")).clicked() {
            actions.push(Action::Resolve(Resolve::Close));
        }
    });
}
