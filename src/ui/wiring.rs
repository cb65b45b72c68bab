//! A list of the wires or pins of an encoder with their signals.

use egui::Ui;

use super::Theme;
use super::controls::paragraph;
use crate::app::Catalogue;

/// Draws a list of wires with texts from a catalogue. `width` is the width of the wire name column.
pub(crate) fn wires_ui(
    ui: &mut Ui,
    theme: &Theme,
    texts: &'static Catalogue,
    width: f32,
    wires: &[(&str, &'static str)],
) {
    for (wire, words) in wires {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            let name = ui.label(theme.monospace(*wire));
            ui.add_space((width - name.rect.width()).max(0.0));
            paragraph(ui, theme.label(theme.format_text(&texts.text(words))));
        });
    }
}

/// Checks that each wire has the given name and English text, and that its German text differs.
#[cfg(test)]
pub(crate) fn assert_wires(texts: &'static Catalogue, wires: &[(&str, &'static str)], expected: &[(&str, &[&str])]) {
    assert_eq!(wires.len(), expected.len());
    for ((wire, id), (name, facts)) in wires.iter().zip(expected) {
        assert_eq!(wire, name);
        assert_notes(texts, &[*id], facts);
    }
}

/// Checks that the notes of a card have the given English texts, and that their German texts differ.
#[cfg(test)]
pub(crate) fn assert_notes(texts: &'static Catalogue, notes: &[&'static str], facts: &[&str]) {
    use crate::app::Language::{English, German};
    let said = |language| notes.iter().map(|id| texts.text(id).to_string_in(language)).collect::<Vec<_>>().join(" ");
    let (english, german) = (said(English), said(German));
    for fact in facts {
        assert!(english.contains(fact), "{fact}: {english}");
    }
    assert_ne!(english, german);
}
