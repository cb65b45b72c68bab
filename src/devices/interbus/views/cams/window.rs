//! The word in which an encoder sends its outputs, as the shift of the window lays it out.

use egui::Ui;

use crate::app::Action;
use crate::devices::interbus::protocol::{StartupMode, WindowShift};
use crate::devices::interbus::state::{Action as Interbus, Edit, Encoder, TEXTS};
use crate::devices::interbus::views::say;
use crate::devices::interbus::views::widgets::{WordLayout, word_layout};
use crate::ui::Skin;
use crate::ui::controls::{card, choice, entry, paragraph};

pub(super) fn card_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    card(ui, skin, TEXTS.text("ib_window.title"), |ui| {
        let known = encoder.staged.wanted().and_then(|wanted| wanted.image.shift);
        let own = known.unwrap_or_default();
        let word = say(skin, "ib_cams.shift");
        let mut wanted = own;
        entry(ui, skin, &word, |ui| {
            let shifts = (0..=25).filter_map(WindowShift::new).map(|own| (own, own.get().to_string()));
            if choice(ui, &word, &mut wanted, shifts) {
                let edit = Box::new(Edit::Shift(wanted));
                actions.push(Action::device(encoder.session.id, Interbus::Edit(edit)));
            }
            let before = encoder.shift();
            if let Some(before) = before.filter(|before| Some(*before) != known) {
                let was = TEXTS.text("ib_set.was").with("value", before.get());
                ui.label(egui::RichText::new(skin.words(&was)).color(skin.palette.staged));
            }
        });
        let label = say(skin, "ib_window.label");
        let sends = encoder.record.last().filter(|own| matches!(own.mode, Some(StartupMode::Cams(_))));
        let shown = sends.filter(|_| encoder.shift() == Some(own)).map(|own| own.word);
        word_layout(ui, skin, &WordLayout { label: &label, shift: own, word: shown, range: encoder.range() });
        paragraph(ui, skin.caption(say(skin, "ib_window.words")));
    });
}
