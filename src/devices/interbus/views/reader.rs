//! Words that somebody types, and what they say.

use egui::{RichText, Ui};

use crate::devices::interbus::protocol::{Mode, READ_OUTS, WindowShift};
use crate::devices::interbus::state::reader::{Reading, Way};
use crate::devices::interbus::state::{TEXTS, explain, words};
use crate::devices::interbus::views::say;
use crate::ui::controls::{card, choice, entry, mono_entry, name, paragraph};
use crate::ui::{Skin, icons};

/// What is typed, and with what it is read.
#[derive(Default)]
pub(super) struct View {
    text: String,
    reading: Reading,
}

/// Width of the column of words.
const WORD: f32 = 92.0;

pub(super) fn card_ui(ui: &mut Ui, skin: &Skin, view: &mut View) {
    card(ui, skin, TEXTS.text("ib_reader.title"), |ui| {
        paragraph(ui, skin.label(say(skin, "ib_reader.words")));
        let View { text, reading } = view;
        ui.horizontal_wrapped(|ui| {
            for way in Way::ALL {
                let word = say(skin, way.word());
                let response = ui.add(egui::Button::selectable(reading.way == way, &word));
                if name(response, true, &word).clicked() {
                    reading.way = way;
                }
            }
        });
        if reading.way.has_mode() {
            let word = say(skin, "ib_reader.mode");
            entry(ui, skin, &word, |ui| {
                choice(ui, &word, &mut reading.mode, Mode::ALL.map(|mode| (mode, skin.words(&words::mode(mode)))));
            });
        }
        if reading.way == Way::In && reading.mode == Mode::Cam {
            let word = say(skin, "ib_cams.shift");
            entry(ui, skin, &word, |ui| {
                let shifts = (0..=25).filter_map(WindowShift::new);
                choice(ui, &word, &mut reading.shift, shifts.map(|own| (own, own.get().to_string())));
            });
        }
        if reading.way == Way::In && reading.mode == Mode::ReadOut {
            let word = say(skin, "ib_reader.read_out");
            entry(ui, skin, &word, |ui| {
                let all =
                    READ_OUTS.iter().map(|row| (Some(row.read_out), skin.words(&explain::read_out(row.read_out))));
                choice(ui, &word, &mut reading.read_out, [(None, say(skin, "ib_reader.any"))].into_iter().chain(all));
            });
        }
        let word = say(skin, "ib_reader.entry");
        let width = (ui.available_width() - 18.0).max(0.0);
        mono_entry(ui, skin, text, width, &word, &say(skin, "ib_reader.hint"));
        for line in reading.lines(text) {
            ui.horizontal_top(|ui| {
                let own = ui.label(skin.mono(&line.word));
                ui.add_space((WORD - own.rect.width()).max(0.0));
                match &line.says {
                    Ok(says) => {
                        ui.vertical(|ui| {
                            paragraph(ui, skin.words(says));
                            if let Some(warning) = &line.warning {
                                paragraph(ui, RichText::new(skin.words(warning)).color(skin.palette.warn));
                            }
                        });
                    }
                    Err(why) => {
                        ui.label(RichText::new(icons::X_CIRCLE).color(skin.palette.bad));
                        paragraph(ui, RichText::new(skin.words(why)).color(skin.palette.bad));
                    }
                }
            });
        }
    });
}
