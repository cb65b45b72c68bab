//! The first lines of a capture's table, and the detected format for the user to correct.

use egui::{ScrollArea, Ui};

use super::Draft;
use crate::analysis::capture::{Delimiter, TimeUnit};
use crate::app::Action;
use crate::signals::state::{Column, SignalsAction as Signals, TEXTS, Table, forms};
use crate::signals::views::translate;
use crate::ui::controls::{
    card_with_trailing, committed_entry, dropdown, entry, labelled_button, paragraph, problem_ui, two_columns,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct TableUiState {
    pub(super) is_open: bool,
    volts: Draft,
}

const COLUMNS: [(Column, &str); 7] = [
    (Column::Time, "columns.time"),
    (Column::Sine, "columns.sine"),
    (Column::Cosine, "columns.cosine"),
    (Column::RefSine, "columns.refsin"),
    (Column::RefCosine, "columns.refcos"),
    (Column::ReferenceAngle, "columns.reference_angle"),
    (Column::Absolute, "columns.absolute"),
];
const DELIMITERS: [(Delimiter, &str); 3] =
    [(Delimiter::Comma, "columns.comma"), (Delimiter::Semicolon, "columns.semicolon"), (Delimiter::Tab, "columns.tab")];
const TIME_UNITS: [(TimeUnit, &str); 4] = [
    (TimeUnit::Seconds, "s"),
    (TimeUnit::Milliseconds, "ms"),
    (TimeUnit::Microseconds, "µs"),
    (TimeUnit::Nanoseconds, "ns"),
];

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, table: &Table, view: &mut TableUiState, actions: &mut Vec<Action>) {
    let mut act = |action: Signals| actions.push(Action::tool(action));
    let mut again = false;
    let aside = |ui: &mut Ui| {
        again = labelled_button(ui, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "columns.detect")).clicked();
    };
    card_with_trailing(ui, theme, TEXTS.text("columns.title"), aside, |ui| {
        lines_ui(ui, theme, table);
        ui.add_space(theme.space.between);
        two_columns(
            ui,
            theme,
            (&mut *view, &mut act),
            |ui, (_, act)| columns_ui(ui, theme, table, *act),
            |ui, (view, act)| {
                form_ui(ui, theme, table, *act);
                volts(ui, theme, table, view, *act);
            },
        );
        if let Some((_, Some(why))) = &view.volts {
            problem_ui(ui, theme, Some(why));
        }
        if let Some(clock) = table.layout.as_ref().and_then(|layout| layout.clock) {
            let text = TEXTS.text("columns.clock").with("start", clock.start_s).with("increment", clock.increment_s);
            paragraph(ui, theme.caption(theme.format_text(&text)));
        }
        if table.partial_references != (None, None) {
            paragraph(ui, theme.caption(translate(theme, "columns.half_chosen")));
        }
    });
    if again {
        view.volts = None;
        act(Signals::Detect);
    }
}

fn lines_ui(ui: &mut Ui, theme: &Theme, table: &Table) {
    let first = table.layout.as_ref().map_or(0, |layout| layout.first_row);
    theme.sunken_frame().show(ui, |ui| {
        ui.set_min_width(ui.available_width().max(0.0));
        ScrollArea::horizontal().id_salt("lines").auto_shrink([false, true]).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            for (number, line) in (1_u64..).zip(&table.head) {
                let colour = if number >= first { theme.palette.text } else { theme.palette.muted };
                let text = theme.monospace(format!("{number:>2}  {line}")).size(theme.sizes.caption).color(colour);
                ui.label(text);
            }
        });
    });
}

fn form_ui(ui: &mut Ui, theme: &Theme, table: &Table, act: &mut impl FnMut(Signals)) {
    let word = translate(theme, "columns.delimiter");
    let mut delimiter = table.delimiter();
    entry(ui, theme, &word, |ui| {
        let options = DELIMITERS.map(|(own, id)| (Some(own), translate(theme, id)));
        if dropdown(ui, &word, &mut delimiter, options) {
            delimiter.into_iter().for_each(|own| act(Signals::SetDelimiter(own)));
        }
    });
    let word = translate(theme, "columns.decimal");
    let mut comma = table.hints.decimal_comma.or(table.layout.as_ref().map(|layout| layout.decimal_comma));
    entry(ui, theme, &word, |ui| {
        let options =
            [(Some(false), translate(theme, "columns.point")), (Some(true), translate(theme, "columns.comma"))];
        if dropdown(ui, &word, &mut comma, options) {
            comma.into_iter().for_each(|own| act(Signals::SetDecimalComma(own)));
        }
    });
}

fn columns_ui(ui: &mut Ui, theme: &Theme, table: &Table, act: &mut impl FnMut(Signals)) {
    for (column, id) in COLUMNS {
        let word = translate(theme, id);
        let mut number = table.column(column);
        let needed = matches!(column, Column::Sine | Column::Cosine);
        entry(ui, theme, &word, |ui| {
            let none = (!needed).then(|| (None, translate(theme, "columns.none")));
            let width = table.width().max(number.unwrap_or(0));
            let numbers = (1..=width).map(|own| match table.name(own) {
                Some(name) => (Some(own), format!("{own}: {name}")),
                None => (Some(own), own.to_string()),
            });
            if dropdown(ui, &word, &mut number, none.into_iter().chain(numbers)) {
                act(Signals::SetColumn(column, number));
            }
        });
        if column == Column::Time && number.is_some() {
            let word = translate(theme, "columns.time_unit");
            let mut unit = table.hints.time_unit.or(table.layout.as_ref().map(|layout| layout.time_unit));
            entry(ui, theme, &word, |ui| {
                let options = TIME_UNITS.map(|(own, word)| (Some(own), word.to_owned()));
                if dropdown(ui, &word, &mut unit, options) {
                    unit.into_iter().for_each(|own| act(Signals::SetTimeUnit(own)));
                }
            });
        }
    }
}

fn volts(ui: &mut Ui, theme: &Theme, table: &Table, view: &mut TableUiState, act: &mut impl FnMut(Signals)) {
    let volts = table.hints.volts_per_unit.or(table.layout.as_ref().map(|layout| layout.volts_per_unit));
    let shown = volts.map(|volts| theme.format_significant_digits(volts)).unwrap_or_default();
    let word = translate(theme, "columns.volts");
    entry(ui, theme, &word, |ui| {
        committed_entry(ui, &mut view.volts, &shown, 64.0, &word, |text| {
            act(Signals::SetVolts(forms::volts_per_unit(text)?));
            Ok(())
        });
    });
}
