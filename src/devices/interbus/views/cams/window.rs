//! Shows how the window shift determines the layout of the cam output word.

use egui::Ui;

use crate::app::Action;
use crate::devices::interbus::protocol::{StartupMode, WindowShift};
use crate::devices::interbus::state::{Edit, Encoder, InterbusAction as Interbus, TEXTS};
use crate::devices::interbus::views::translate;
use crate::devices::interbus::views::widgets::{WordLayout, word_layout};
use crate::ui::Theme;
use crate::ui::controls::{dropdown, entry, folding_card, paragraph};

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("ib_window.title"), |ui| {
        let known = encoder.staged.edited_values().and_then(|wanted| wanted.image.shift);
        let own = known.unwrap_or_default();
        let word = translate(theme, "ib_cams.shift");
        let mut wanted = own;
        entry(ui, theme, &word, |ui| {
            let shifts = (0..=25).filter_map(WindowShift::new).map(|own| (own, own.get().to_string()));
            if dropdown(ui, &word, &mut wanted, shifts) {
                let edit = Box::new(Edit::Shift(wanted));
                actions.push(Action::device(encoder.session.id, Interbus::Edit(edit)));
            }
            let before = encoder.shift();
            if let Some(before) = before.filter(|before| Some(*before) != known) {
                let was = TEXTS.text("ib_set.was").with("value", before.get());
                ui.label(egui::RichText::new(theme.format_text(&was)).color(theme.palette.staged));
            }
        });
        let label = translate(theme, "ib_window.label");
        let sends = encoder
            .record
            .last()
            .filter(|_| encoder.session.is_polling())
            .filter(|own| matches!(own.mode, Some(StartupMode::Cams(_))));
        let shown = sends.filter(|_| encoder.shift() == Some(own)).map(|own| own.word);
        word_layout(ui, theme, &WordLayout { label: &label, shift: own, word: shown, range: encoder.step_count() });
        paragraph(ui, theme.caption(translate(theme, "ib_window.words")));
    });
}
