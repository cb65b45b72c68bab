//! Preview of a cam table before it is added to the edits.

use egui::{Event, RichText, Ui};

use crate::app::Action;
use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::cams::{labels, table_text};
use crate::devices::interbus::state::{Encoder, Import, InterbusAction as Interbus, TEXTS};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{card, labelled_button, paragraph, primary_button};
use crate::ui::{Theme, icons};

const MAX_LIST_HEIGHT: f32 = 200.0;

/// Imports a table from pasted text, unless it is pasted into a text field.
pub(super) fn import_pasted_table(ui: &Ui, encoder: &Encoder, program: ProgramNumber, actions: &mut Vec<Action>) {
    if ui.ctx().text_edit_focused() || encoder.staged.edited_values().is_none() {
        return;
    }
    let text = ui.input(|input| {
        input.events.iter().find_map(|event| if let Event::Paste(text) = event { Some(text.clone()) } else { None })
    });
    if let Some(text) = text.filter(|text| !text.trim().is_empty()) {
        actions.push(Action::device(encoder.session.id, Interbus::PasteTable(program, text)));
    }
}

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, import: &Import, actions: &mut Vec<Action>) {
    let Import { origin, table, .. } = import;
    let id = encoder.session.id;
    card(ui, theme, TEXTS.text("ib_table.title"), |ui| {
        let programs = table.to_programs().len();
        let text = TEXTS
            .text("ib_table.read")
            .with_text("origin", origin.clone())
            .with("rows", table.rows.len())
            .with("programs", programs);
        paragraph(ui, theme.format_text(&text));
        paragraph(ui, theme.caption(theme.format_text(&table_text::layout_text(table))));
        egui::ScrollArea::vertical().id_salt("table").max_height(MAX_LIST_HEIGHT).show(ui, |ui| {
            for problem in &table.problems {
                line_ui(ui, icons::X_CIRCLE, theme.palette.bad, theme.format_text(&table_text::problem_text(problem)));
            }
            for note in &table.notes {
                line_ui(ui, icons::INFO, theme.palette.accent, theme.format_text(&table_text::note_text(note)));
            }
            for row in table.rounded_rows() {
                let words = theme.format_text(&table_text::rounding_text(row, &encoder.scale));
                line_ui(ui, icons::RULER, theme.palette.muted, words);
            }
            if table.problems.is_empty() && table.rounded_rows().next().is_none() {
                paragraph(ui, theme.label(translate(theme, "ib_table.exact")));
            }
        });
        for filled in table.to_programs() {
            if encoder.staged.program(filled.program).is_none() && encoder.profile().is_none() {
                let unread = crate::devices::interbus::state::EditError::NotRead(filled.program);
                line_ui(ui, icons::WARNING, theme.palette.warn, theme.format_text(&labels::edit_error_text(&unread)));
            }
        }
        // A table with problems is never added, because the cam of an omitted line would be switched off.
        let is_whole = table.problems.is_empty();
        if !is_whole {
            paragraph(ui, theme.label(translate(theme, "ib_table.mend")));
        }
        ui.add_space(theme.space.inside);
        ui.horizontal(|ui| {
            if primary_button(
                ui,
                theme,
                is_whole && !table.rows.is_empty(),
                icons::CHECK,
                &translate(theme, "ib_table.take"),
            )
            .clicked()
            {
                actions.push(Action::device(id, Interbus::TakeTable(true)));
            }
            if labelled_button(ui, icons::X, &translate(theme, "ib_table.leave")).clicked() {
                actions.push(Action::device(id, Interbus::TakeTable(false)));
            }
        });
    });
}

fn line_ui(ui: &mut Ui, icon: &str, ink: crate::app::Rgb, words: String) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(ink));
        paragraph(ui, words);
    });
}
