//! The page of the commutation assistant: preparation, readings, results, and two ways to store the offset.

mod result;

use egui::{RichText, Ui};

use crate::analysis::quality::Verdict;
use crate::app::{Action, Text};
use crate::devices::hiperface::state::commutation::{
    CommutationAction as Assistant, CommutationOffset, EnergisedVector, Form, Source, VectorSlot, reading_kind_text,
    reading_permission,
};
use crate::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, TEXTS};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{
    button_with_reason, card, card_with_trailing, dropdown, entry, folding_card, icon_button, labelled_number_entry,
    paragraph, split, text_entry, verdict_ui,
};
use crate::ui::{Theme, icons};

const ENTRY_WIDTH: f32 = 96.0;
const LIMIT: f32 = 56.0;
const READ_BUTTON_WIDTH: f32 = 160.0;
const POSITION_WIDTH: f32 = 104.0;
/// Minimum width in points for showing the position on the same line as its buttons.
const MIN_ONE_LINE_WIDTH: f32 = 430.0;
/// Minimum width in points for two entries in one row.
const MIN_TWO_ENTRIES_WIDTH: f32 = 420.0;
const MESSAGE_LINES: f32 = 2.0;
/// Minimum width in points for two columns.
const MIN_TWO_COLUMN_WIDTH: f32 = 700.0;

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let mut form = encoder.commutation.form.clone();
    // The report is shown below the shorter of two columns, or at the end of a single column.
    let wide = ui.available_width() >= MIN_TWO_COLUMN_WIDTH;
    split(
        ui,
        theme,
        (0.5, MIN_TWO_COLUMN_WIDTH),
        (&mut *actions, &mut form),
        |ui, (_, form)| {
            preparation_ui(ui, theme, form);
            theme.add_gap(ui);
            motor_ui(ui, theme, encoder, form);
            if wide {
                theme.add_gap(ui);
                result::report_ui(ui, theme, encoder);
            }
        },
        |ui, (actions, form)| {
            rest_position_ui(ui, theme, encoder, form, actions);
            theme.add_gap(ui);
            second_vector_ui(ui, theme, encoder, form, actions);
            theme.add_gap(ui);
            result::offset_ui(ui, theme, encoder, form);
            theme.add_gap(ui);
            result::field_ui(ui, theme, encoder, form, actions);
            theme.add_gap(ui);
            result::position_ui(ui, theme, encoder, form, actions);
        },
    );
    if !wide {
        theme.add_gap(ui);
        result::report_ui(ui, theme, encoder);
    }
    if form != encoder.commutation.form {
        actions.push(assistant_action(encoder, Assistant::Edit(Box::new(form))));
    }
}

fn assistant_action(encoder: &Encoder, action: Assistant) -> Action {
    Action::device(encoder.session.id, Hiperface::Commutation(action))
}

fn preparation_ui(ui: &mut Ui, theme: &Theme, form: &mut Form) {
    card(ui, theme, TEXTS.text("commutation.before"), |ui| {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
            paragraph(ui, RichText::new(translate(theme, "commutation.danger")).color(theme.palette.warn));
        });
        ui.horizontal_wrapped(|ui| {
            ui.checkbox(&mut form.disabled, translate(theme, "commutation.disabled"));
            ui.checkbox(&mut form.uncoupled, translate(theme, "commutation.uncoupled"));
            ui.checkbox(&mut form.released, translate(theme, "commutation.released"));
        });
        let (current, time) = form.limit_problems();
        limits_ui(ui, theme, form);
        problem_ui(ui, theme, current.as_ref());
        problem_ui(ui, theme, time.as_ref());
        entry(ui, theme, &translate(theme, "commutation.vector"), |ui| {
            let vectors = EnergisedVector::ALL.map(|vector| (vector, translate(theme, vector.keyword())));
            dropdown(ui, &translate(theme, "commutation.vector"), &mut form.vector, vectors);
        });
        if form.vector == EnergisedVector::Other {
            number_ui(ui, theme, "commutation.vector_angle", &mut form.vector_deg, "0");
        }
    });
}

fn limits_ui(ui: &mut Ui, theme: &Theme, form: &mut Form) {
    let (current, time) = (&mut form.current_a, &mut form.time_s);
    number_pair_ui(ui, theme, ("commutation.current", current, ""), ("commutation.time", time, ""));
}

/// Draws two number fields, in one row if there is enough space. Each argument contains a field's label ID, entered
/// text and hint.
fn number_pair_ui(
    ui: &mut Ui,
    theme: &Theme,
    (one, first, first_hint): (&'static str, &mut String, &str),
    (other, second, second_hint): (&'static str, &mut String, &str),
) {
    if ui.available_width() < MIN_TWO_ENTRIES_WIDTH {
        number_ui(ui, theme, one, first, first_hint);
        number_ui(ui, theme, other, second, second_hint);
        return;
    }
    let [one, other] = [one, other].map(|id| translate(theme, id));
    entry(ui, theme, &one, |ui| {
        text_entry(ui, first, ENTRY_WIDTH, &one, first_hint);
        ui.add_space(theme.space.between);
        ui.label(theme.label(&other));
        text_entry(ui, second, ENTRY_WIDTH, &other, second_hint);
    });
}

fn problem_ui(ui: &mut Ui, theme: &Theme, problem: Option<&Text>) {
    if let Some(why) = problem {
        paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.bad));
    }
}

fn motor_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form) {
    card(ui, theme, TEXTS.text("commutation.motor"), |ui| {
        let of_type = Form::default().signal_periods(encoder.geometry()).map(|periods| periods.to_string());
        let of_type = of_type.unwrap_or_default();
        let (pairs, periods) = (&mut form.pole_pairs, &mut form.periods);
        number_pair_ui(ui, theme, ("commutation.pole_pairs", pairs, ""), ("commutation.periods", periods, &of_type));
        if let Some(words) = form.periods_warning(encoder.geometry()) {
            verdict_ui(ui, theme, Verdict::Warn, &words);
        }
        entry(ui, theme, &translate(theme, "commutation.direction"), |ui| {
            let directions = [(false, "commutation.with"), (true, "commutation.against")];
            let directions = directions.map(|(reversed, id)| (reversed, translate(theme, id)));
            dropdown(ui, &translate(theme, "commutation.direction"), &mut form.reversed, directions);
        });
        let beside = ui.available_width() >= MIN_TWO_ENTRIES_WIDTH;
        entry(ui, theme, &translate(theme, "commutation.source"), |ui| {
            let sources = [
                (Source::Signals, "commutation.from_signals"),
                (Source::Typed, "commutation.from_typed"),
                (Source::Absolute, "commutation.from_absolute"),
            ];
            let sources = sources.map(|(source, id)| (source, translate(theme, id)));
            dropdown(ui, &translate(theme, "commutation.source"), &mut form.source, sources);
            if beside {
                let limit = translate(theme, "commutation.limit");
                ui.add_space(theme.space.between);
                ui.label(theme.label(&limit));
                let entry = text_entry(ui, &mut form.limit_deg, LIMIT, &limit, "5");
                entry.on_hover_text(translate(theme, "commutation.limit_hint"));
            }
        });
        if form.source == Source::Typed {
            number_ui(ui, theme, "commutation.phase", &mut form.phase, &theme.format_number(0.0, 4));
        }
        if !beside {
            let limit = number_ui(ui, theme, "commutation.limit", &mut form.limit_deg, "5");
            limit.on_hover_text(translate(theme, "commutation.limit_hint"));
        }
        // The offset card names the missing or invalid entry.
    });
}

fn number_ui(ui: &mut Ui, theme: &Theme, id: &'static str, text: &mut String, hint: &str) -> egui::Response {
    labelled_number_entry(ui, theme, TEXTS.text(id), text, ENTRY_WIDTH, hint)
}

fn rest_position_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form, actions: &mut Vec<Action>) {
    let commutation = &encoder.commutation;
    let any = VectorSlot::ALL.into_iter().any(|slot| commutation.reading_at(slot).is_some());
    let mut clear = false;
    let aside = |ui: &mut Ui| {
        clear = icon_button(ui, any, icons::TRASH, &translate(theme, "commutation.clear")).clicked();
    };
    card_with_trailing(ui, theme, TEXTS.text("commutation.rest"), aside, |ui| {
        paragraph(ui, theme.label(translate(theme, "commutation.rest_words")));
        let [one, other, _] = &mut form.typed;
        slot_ui(ui, theme, encoder, VectorSlot::OneSide, one, actions);
        slot_ui(ui, theme, encoder, VectorSlot::OtherSide, other, actions);
        let warn = |words: Text| RichText::new(theme.format_text(&words)).color(theme.palette.warn);
        let message = match (&commutation.problem, commutation.offset(encoder.geometry())) {
            (Some(problem), _) => RichText::new(theme.format_text(problem)).color(theme.palette.bad),
            (None, Err(why)) if any => warn(why),
            (None, Err(_)) => RichText::new(""),
            (None, Ok(_)) if commutation.are_sides_identical() => warn(TEXTS.text("commutation.sides_equal")),
            (None, Ok(CommutationOffset { apart_deg: None, .. })) => warn(TEXTS.text("commutation.only_one_side")),
            (None, Ok(CommutationOffset { apart_deg: Some(apart), fine_periods, .. })) => {
                let text = TEXTS.text("commutation.rest_value").with_number("apart", apart, 2);
                RichText::new(theme.format_text(&text.with_number("mean", fine_periods, 5)))
            }
        };
        fixed_height_message_ui(ui, theme, message);
    });
    if clear {
        actions.push(assistant_action(encoder, Assistant::Clear));
    }
}

fn second_vector_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("commutation.second"), |ui| {
        paragraph(ui, theme.label(translate(theme, "commutation.second_words")));
        number_ui(ui, theme, "commutation.second_angle", &mut form.second_deg, "90");
        let [_, _, typed] = &mut form.typed;
        slot_ui(ui, theme, encoder, VectorSlot::Second, typed, actions);
        match encoder.commutation.second_vector_result(encoder.geometry()) {
            Some(Ok((verdict, words))) => verdict_ui(ui, theme, verdict, &words),
            Some(Err(why)) => paragraph(ui, theme.label(theme.format_text(&why))),
            None => {}
        }
    });
}

/// Draws a message in a space of fixed height, so that the layout does not shift when the message appears or
/// disappears.
pub(super) fn fixed_height_message_ui(ui: &mut Ui, theme: &Theme, message: RichText) {
    let room = egui::vec2(ui.available_width(), MESSAGE_LINES * theme.sizes.body * 1.4);
    ui.allocate_ui(room, |ui| {
        ui.set_min_height(room.y);
        paragraph(ui, message);
    });
}

/// Draws the controls for one reading: a button to read the position, and an input field to type it.
fn slot_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    slot: VectorSlot,
    typed: &mut String,
    actions: &mut Vec<Action>,
) {
    let commutation = &encoder.commutation;
    let (read, take) = match slot {
        VectorSlot::OneSide => ("commutation.read_one", "commutation.use_one"),
        VectorSlot::OtherSide => ("commutation.read_other", "commutation.use_other"),
        VectorSlot::Second => ("commutation.read_second", "commutation.use_second"),
    };
    let beside = ui.available_width() >= MIN_ONE_LINE_WIDTH;
    ui.horizontal_wrapped(|ui| {
        let allowed = reading_permission(commutation, encoder.session.is_ready());
        // All buttons have the same width, so that the entries are aligned in a column.
        let size = egui::vec2(READ_BUTTON_WIDTH.min(ui.available_width()), ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(size.x);
            if button_with_reason(ui, theme, &allowed, icons::CROSSHAIR, &translate(theme, read)).clicked() {
                actions.push(assistant_action(encoder, Assistant::Read(slot)));
            }
        });
        // Each reading has its own label for screen readers.
        let label = format!("{} · {}", translate(theme, slot.keyword()), translate(theme, "commutation.fine"));
        let response = text_entry(ui, typed, POSITION_WIDTH, &label, &translate(theme, "commutation.or_type"));
        let enter = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let filled = !typed.trim().is_empty();
        if icon_button(ui, filled, icons::CHECK, &translate(theme, take)).clicked() || (enter && filled) {
            actions.push(assistant_action(encoder, Assistant::Use(slot)));
        }
        if beside {
            value_ui(ui, theme, encoder, slot);
        }
    });
    if !beside {
        ui.horizontal(|ui| value_ui(ui, theme, encoder, slot));
    }
}

/// Draws the position of a reading and its source, or a dash without a reading.
fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, slot: VectorSlot) {
    let Some(reading) = encoder.commutation.reading_at(slot) else {
        ui.label(theme.monospace("–").color(theme.palette.muted));
        return;
    };
    ui.label(theme.monospace(theme.format_number(reading.fine_periods, 5)));
    let words = theme.format_text(&reading_kind_text(reading));
    ui.add(egui::Label::new(theme.caption(&words)).truncate()).on_hover_text(words);
}
