//! Decoder for process data words that the user types.

use egui::{RichText, Ui};

use crate::devices::interbus::protocol::{EncoderMode, READ_OUTS, WindowShift};
use crate::devices::interbus::state::reader::{Reading, WordSource};
use crate::devices::interbus::state::{TEXTS, explain, format};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{card, dropdown, entry, mono_entry, name, paragraph};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct WordReaderUiState {
    text: String,
    reading: Reading,
}

const WORD_WIDTH: f32 = 92.0;

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, view: &mut WordReaderUiState) {
    card(ui, theme, TEXTS.text("ib_reader.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_reader.words")));
        let WordReaderUiState { text, reading } = view;
        ui.horizontal_wrapped(|ui| {
            for way in WordSource::ALL {
                let word = translate(theme, way.keyword());
                let response = ui.add(egui::Button::selectable(reading.source == way, &word));
                if name(response, true, &word).clicked() {
                    reading.source = way;
                }
            }
        });
        if reading.source.has_mode() {
            let word = translate(theme, "ib_reader.mode");
            entry(ui, theme, &word, |ui| {
                dropdown(
                    ui,
                    &word,
                    &mut reading.mode,
                    EncoderMode::ALL.map(|mode| (mode, theme.format_text(&format::mode(mode)))),
                );
            });
        }
        if reading.source == WordSource::In && reading.mode == EncoderMode::Cam {
            let word = translate(theme, "ib_cams.shift");
            entry(ui, theme, &word, |ui| {
                let shifts = (0..=25).filter_map(WindowShift::new);
                dropdown(ui, &word, &mut reading.shift, shifts.map(|own| (own, own.get().to_string())));
            });
        }
        if reading.source == WordSource::In && reading.mode == EncoderMode::ReadOut {
            let word = translate(theme, "ib_reader.read_out");
            entry(ui, theme, &word, |ui| {
                let all = READ_OUTS
                    .iter()
                    .map(|row| (Some(row.read_out), theme.format_text(&explain::read_out(row.read_out))));
                dropdown(
                    ui,
                    &word,
                    &mut reading.read_out,
                    [(None, translate(theme, "ib_reader.any"))].into_iter().chain(all),
                );
            });
        }
        let word = translate(theme, "ib_reader.entry");
        let width = (ui.available_width() - 18.0).max(0.0);
        mono_entry(ui, theme, text, width, &word, &translate(theme, "ib_reader.hint"));
        for line in reading.decode_words(text) {
            ui.horizontal_top(|ui| {
                let own = ui.label(theme.monospace(&line.word));
                ui.add_space((WORD_WIDTH - own.rect.width()).max(0.0));
                match &line.meaning {
                    Ok(meaning) => {
                        ui.vertical(|ui| {
                            paragraph(ui, theme.format_text(meaning));
                            if let Some(warning) = &line.warning {
                                paragraph(ui, RichText::new(theme.format_text(warning)).color(theme.palette.warn));
                            }
                        });
                    }
                    Err(why) => {
                        ui.label(RichText::new(icons::X_CIRCLE).color(theme.palette.bad));
                        paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.bad));
                    }
                }
            });
        }
    });
}
