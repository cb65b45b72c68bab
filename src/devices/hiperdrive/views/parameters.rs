//! The parameter table, with value, edit, range and factory setting of each parameter, and whether it is saved.

use std::collections::BTreeMap;
use std::iter::once;

use crate::devices::hiperdrive::views::translate;

use egui::{RichText, ScrollArea, Ui};

use super::scale;
use crate::app::{Action, Text};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber};
use crate::devices::hiperdrive::state::{Edit, HiperdriveAction as Hiperdrive, HiperdriveDevice, Row, forms};
use crate::ui::controls::{empty_placeholder, options, paragraph, text_entry};
use crate::ui::widgets::{
    RegisterEvent, RegisterGroup, RegisterKind, RegisterLocation, RegisterRow, RegisterTable, RegisterView,
    register_table,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct DriveParametersUiState {
    sought: String,
    shown: ParameterFilter,
    table: RegisterView,
    /// Parameters in the rows of the table when it was last drawn.
    lines: Vec<Vec<ParameterNumber>>,
    /// Whether the table was too narrow for all its columns when it was last drawn. The details of the selected row are
    /// then shown below the table.
    is_narrow: bool,
    scales: BTreeMap<DriveNumber, scale::ScaleUiState>,
}

/// Selection of the parameters shown, or of the scaling page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ParameterFilter {
    All,
    /// Shows the writable parameters. A search by name or number includes all parameters.
    #[default]
    Written,
    /// Shows parameters that are edited or have changed since the previous reading.
    Changed,
    Scale,
}

const SEARCH_WIDTH: f32 = 160.0;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut DriveParametersUiState,
    actions: &mut Vec<Action>,
) {
    header_ui(ui, theme, view);
    if let Some(refusal) = &unit.refusal {
        paragraph(ui, RichText::new(theme.format_text(refusal)).color(theme.palette.bad));
    }
    ui.add_space(theme.space.inside);
    if view.is_scale_shown() {
        ScrollArea::vertical().id_salt("scale").auto_shrink(false).show(ui, |ui| {
            let drive = unit.drive();
            let own = view.scales.entry(drive).or_default();
            ui.push_id(drive, |ui| scale::card_ui(ui, theme, unit, own, actions));
        });
        return;
    }
    let rows = once(Some(unit.drive())).chain(once(None)).map(|of| {
        let rows = unit.rows(of).into_iter().filter(|row| view.matches_filter(theme, row));
        rows.collect::<Vec<Row>>()
    });
    let rows: Vec<Vec<Row>> = rows.collect();
    view.follow_rows(&rows);
    let id = egui::Id::unique(unit.session.id).with("hiperdrive_parameters_foot");
    egui::Panel::bottom(id).frame(egui::Frame::NONE).show_separator_line(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        ui.add_space(theme.space.inside);
        // The message is below the table, so that the rows keep their position.
        if let Some(problem) = view.table.problem(theme) {
            let words = format!("{}  {problem}", icons::WARNING_CIRCLE);
            paragraph(ui, RichText::new(words).color(theme.palette.bad));
        } else if view.is_narrow {
            let row = view.table.selected().and_then(|place| rows.get(place.group)?.get(place.row));
            let words = row.map_or_else(|| translate(theme, "hd_params.select"), |row| row_details(theme, row));
            ui.add(egui::Label::new(theme.caption(words).color(theme.palette.text)).truncate());
        }
        paragraph(ui, theme.caption(translate(theme, "hd_params.controller")));
        paragraph(ui, theme.caption(translate(theme, "hd_params.not_kept")));
    });
    if rows.iter().all(Vec::is_empty) {
        empty_placeholder(ui, theme, &translate(theme, "hd_params.none"), None);
    } else {
        table_ui(ui, theme, unit, &rows, view, actions);
    }
}

/// Draws the search field and the filter.
fn header_ui(ui: &mut Ui, theme: &Theme, view: &mut DriveParametersUiState) {
    ui.horizontal_wrapped(|ui| {
        let sought = translate(theme, "hd_params.seek");
        if text_entry(ui, &mut view.sought, SEARCH_WIDTH, &sought, &sought).changed()
            && view.shown == ParameterFilter::Scale
        {
            view.shown = ParameterFilter::All;
        }
        let shown = [
            (ParameterFilter::All, "hd_params.all"),
            (ParameterFilter::Written, "hd_params.written"),
            (ParameterFilter::Changed, "hd_params.changed"),
            (ParameterFilter::Scale, "hd_scale.title"),
        ];
        if options(
            ui,
            &translate(theme, "hd_params.show"),
            &mut view.shown,
            shown.map(|(own, id)| (own, translate(theme, id))),
        ) {
            // Typed text takes effect before other rows are shown.
            ui.memory_mut(|memory| memory.stop_text_input());
        }
    });
}

impl DriveParametersUiState {
    /// Returns whether to show the scaling page. The editor in the table must be closed first.
    fn is_scale_shown(&self) -> bool {
        self.shown == ParameterFilter::Scale && (self.table.edited_location().is_none() || self.table.is_refused())
    }

    fn typed_number(&self) -> Option<ParameterNumber> {
        let place = self.table.edited_location()?;
        self.lines.get(place.group)?.get(place.row).copied()
    }

    fn matches_filter(&self, theme: &Theme, row: &Row) -> bool {
        if self.typed_number() == Some(row.number) {
            return true;
        }
        let sought = self.sought.trim().to_lowercase();
        let fits = sought.is_empty()
            || row.number.get().to_string().contains(&sought)
            || theme.format_text(&row.name).to_lowercase().contains(&sought);
        fits && match self.shown {
            ParameterFilter::All | ParameterFilter::Scale => true,
            ParameterFilter::Written => row.is_editable || !sought.is_empty(),
            ParameterFilter::Changed => row.is_edited || row.previous_value.is_some(),
        }
    }

    /// Updates the view after rows have changed. The selection and the typed value stay with their parameters.
    fn follow_rows(&mut self, rows: &[Vec<Row>]) {
        let lines: Vec<Vec<_>> = rows.iter().map(|rows| rows.iter().map(|row| row.number).collect()).collect();
        if lines == self.lines {
            return;
        }
        let before = std::mem::replace(&mut self.lines, lines);
        let now = &self.lines;
        self.table.follow_registers(|place| {
            let number = before.get(place.group)?.get(place.row)?;
            let row = now.get(place.group)?.iter().position(|own| own == number)?;
            Some(RegisterLocation { row, ..place })
        });
    }
}

fn table_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    rows: &[Vec<Row>],
    view: &mut DriveParametersUiState,
    actions: &mut Vec<Action>,
) {
    let groups: Vec<RegisterGroup> = ["hd_params.drive", "hd_params.device"]
        .into_iter()
        .zip(rows)
        .map(|(title, rows)| RegisterGroup { title: translate(theme, title), note: String::new(), rows: rows.len() })
        .collect();
    let at = |place: RegisterLocation| rows.get(place.group)?.get(place.row);
    let row = |place: RegisterLocation| at(place).map(|row| register_row(theme, row)).unwrap_or_default();
    let label = theme.translate("page.parameters");
    let table = RegisterTable { label: &label, groups: &groups, row: &row, kind: RegisterKind::Numbers };
    let mut edits = Vec::new();
    let height = ui.available_height();
    let output = register_table(ui, theme, &table, height, &mut view.table, &mut |place, text| {
        if let Some(row) = at(place).filter(|row| text != parameter_text(row)) {
            edits.push(forms::parameter(row, text)?);
        }
        Ok(())
    });
    view.is_narrow = output.is_narrow;
    if let Some(RegisterEvent::Revert(place)) = output.event {
        edits.extend(at(place).map(|row| Edit::Revert(row.number)));
    }
    let act = |edit| Action::device(unit.session.id, Hiperdrive::Edit(Box::new(edit)));
    actions.extend(edits.into_iter().map(act));
}

/// Returns the contents of those columns in a row that are hidden or truncated in a narrow window.
fn row_details(theme: &Theme, row: &Row) -> String {
    let named =
        |id: &'static str, words: String| (!words.is_empty()).then(|| format!("{} {words}", theme.translate(id)));
    let range = row.range.as_ref().map(|range| theme.format_text(range)).unwrap_or_default();
    let meaning = Some(row_meaning(theme, row)).filter(|meaning| !meaning.is_empty());
    let columns =
        [meaning, named("widget.register_range", range), named("widget.register_factory", row.factory.clone())];
    let columns = columns.into_iter().flatten().map(|column| format!(" · {column}")).collect::<String>();
    format!("{} {}{columns}", row.number, theme.format_text(&row.name))
}

fn parameter_text(row: &Row) -> String {
    row.staged.map_or_else(|| row.shown.clone(), |staged| staged.to_string())
}

/// Returns the unit and the meaning of a value, or an empty string if there is no value.
fn row_meaning(theme: &Theme, row: &Row) -> String {
    let words = |text: Option<&Text>| text.map(|text| theme.format_text(text)).unwrap_or_default();
    if parameter_text(row).is_empty() {
        return String::new();
    }
    // A unit with a factor, such as 0.1 V, is shown with a multiplication sign.
    let unit = match words(row.unit.as_ref()) {
        unit if unit.starts_with('0') => format!("× {unit}"),
        unit => unit,
    };
    let meaning = [unit, words(row.meaning.as_ref())].into_iter().filter(|own| !own.is_empty());
    meaning.collect::<Vec<_>>().join(" · ")
}

fn register_row(theme: &Theme, row: &Row) -> RegisterRow {
    let words = |text: Option<&Text>| text.map(|text| theme.format_text(text)).unwrap_or_default();
    let value = parameter_text(row);
    RegisterRow {
        address: row.number.to_string(),
        name: theme.format_text(&row.name),
        meaning: row_meaning(theme, row),
        range: words(row.range.as_ref()),
        differs: row.is_editable && !row.factory.is_empty() && !value.is_empty() && value != row.factory,
        default: row.factory.clone(),
        changed: row.previous_value.is_some(),
        before: row.previous_value.map(|was| was.to_string()).unwrap_or_default(),
        edited: row.is_edited,
        kept: row.kind.saved.then(|| translate(theme, "hd_params.is_kept")),
        read_only: row.not_editable_reason().map(|why| theme.format_text(&why)),
        value,
        ..RegisterRow::default()
    }
}
