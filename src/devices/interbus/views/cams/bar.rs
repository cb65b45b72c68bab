//! The program bar, for selecting a cam program and for changing all of it at once.

use egui::{RichText, Ui};

use super::CamsUiState as Page;
use crate::app::{Action, Language, Text};
use crate::devices::interbus::protocol::{DESIGN_WRITE_CYCLES, ProgramNumber};
use crate::devices::interbus::state::{Edit, Encoder, InterbusAction as Interbus, TEXTS, forms};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{
    entry, icon_button, icon_menu, labelled_button, name, paragraph, show_error_below, text_entry,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct CamBarUiState {
    by: String,
    refused: Option<Text>,
}

pub(super) fn bar_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    program: ProgramNumber,
    view: &mut Page,
    actions: &mut Vec<Action>,
) {
    let marks = encoder.staged.edited_values().map(|wanted| wanted.findings()).unwrap_or_default();
    ui.horizontal_wrapped(|ui| {
        ui.label(theme.label(translate(theme, "ib_cams.program")));
        for own in ProgramNumber::all() {
            let content = encoder.staged.program(own);
            let ink = match content {
                None => theme.palette.muted,
                _ if marks.iter().any(|mark| mark.program() == Some(own)) => theme.palette.warn,
                _ if encoder.staged.is_program_edited(own) => theme.palette.staged,
                _ => theme.palette.text,
            };
            let text = RichText::new(own.get().to_string()).color(ink);
            let response = ui.add(egui::Button::selectable(own == program, text).min_size([30.0, 28.0].into()));
            let word = TEXTS.text("ib_startup.program").with("program", own.get());
            if name(response, true, &theme.format_text(&word)).clicked() {
                view.program = Some(own);
            }
        }
        if encoder.staged.program(program).is_some() {
            reread_button_ui(ui, theme, encoder, program, actions);
            program_menu_ui(ui, theme, encoder, program, &mut view.bar, actions);
        }
        tables_ui(ui, theme, encoder, program, actions);
    });
}

fn reread_button_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, program: ProgramNumber, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_ready() && encoder.is_stopped();
    let cost = TEXTS.text("ib_cams.read_cost").with("cycles", DESIGN_WRITE_CYCLES);
    let button = icon_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "ib_cams.read_again"));
    if button.on_hover_text(theme.format_text(&cost)).clicked() {
        actions.push(Action::device(encoder.session.id, Interbus::ReadPrograms(vec![program])));
    }
}

fn program_menu_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    program: ProgramNumber,
    view: &mut CamBarUiState,
    actions: &mut Vec<Action>,
) {
    let id = encoder.session.id;
    let mut put = |edit: Edit| actions.push(Action::device(id, Interbus::Edit(Box::new(edit))));
    icon_menu(ui, icons::PENCIL_SIMPLE, &translate(theme, "ib_cams.whole"), |ui| {
        ui.set_max_width(300.0);
        ui.label(theme.heading(translate(theme, "ib_cams.copy")));
        ui.horizontal_wrapped(|ui| {
            for to in ProgramNumber::all().filter(|to| *to != program) {
                let word = to.get().to_string();
                let text = TEXTS.text("ib_cams.copy_to").with("program", to.get());
                if name(ui.button(&word), true, &theme.format_text(&text)).clicked() {
                    put(Edit::Copy { from: program, to });
                }
            }
        });
        ui.add_space(theme.space.inside);
        ui.label(theme.heading(translate(theme, "ib_cams.move")));
        if labelled_button(ui, icons::ARROWS_OUT_LINE_HORIZONTAL, &translate(theme, "ib_cams.mirror")).clicked() {
            put(Edit::Mirror(program));
        }
        let word = translate(theme, "ib_cams.by");
        entry(ui, theme, &word, |ui| {
            text_entry(ui, &mut view.by, 80.0, &word, "-100");
            if labelled_button(ui, icons::CHECK, &translate(theme, "ib_cams.rotate")).clicked() {
                match forms::parse_offset(&view.by) {
                    Ok(by) => {
                        view.refused = None;
                        put(Edit::Rotate { program, by });
                    }
                    Err(why) => view.refused = Some(why),
                }
            }
        });
        show_error_below(ui, theme, view.refused.as_ref());
        paragraph(ui, theme.caption(translate(theme, "ib_cams.move_words")));
    });
}

fn tables_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, program: ProgramNumber, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    icon_menu(ui, icons::TABLE, &translate(theme, "ib_cams.tables"), |ui| {
        ui.set_max_width(300.0);
        if labelled_button(ui, icons::FOLDER_OPEN, &translate(theme, "ib_table.open")).clicked() {
            actions.push(Action::device(id, Interbus::AskTable(program)));
            ui.close();
        }
        if labelled_button(ui, icons::COPY, &translate(theme, "ib_table.paste")).clicked() {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
            ui.close();
        }
        if labelled_button(ui, icons::FLOPPY_DISK, &translate(theme, "ib_table.save")).clicked() {
            actions
                .push(Action::device(id, Interbus::AskSaveTable { decimal_comma: theme.language == Language::German }));
            ui.close();
        }
        paragraph(ui, theme.caption(translate(theme, "ib_table.words")));
    });
}
