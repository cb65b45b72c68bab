//! The compared items as a table: name, left value, copy button, right value. Bytes are shown in lines of 16, 8 or 4.

use egui::{Align, Color32, FontId, Label, Layout, RichText, Ui};
use egui_extras::{Column, TableBuilder, TableRow};

use crate::app::{Action, AnyDevice, ComparedRow, ComparedRows, ComparisonAction, ItemValue, Text};
use crate::bits::hex;
use crate::ui::Theme;
use crate::ui::controls::name;

/// Height of a row with one line in points.
const ROW: f32 = 26.0;
/// Height of each additional line of bytes in points.
const LINE: f32 = 17.0;
const HEADING: f32 = 30.0;
/// Width of the column with the buttons in points.
const BUTTON_COLUMN_WIDTH: f32 = 34.0;
/// Fraction of the table width for the names.
const NAMES: f32 = 0.32;
/// Number of equal bytes from which only the byte and the count are shown.
const MIN_COLLAPSED_BYTES: usize = 16;

/// A line of the table.
enum Line<'r> {
    Heading(&'r Text),
    Row(&'r ComparedRow),
}

pub(super) fn table_ui(
    ui: &mut Ui,
    theme: &Theme,
    target: Option<&AnyDevice>,
    rows: &ComparedRows,
    shows_all: bool,
    actions: &mut Vec<Action>,
) {
    let mut lines = Vec::new();
    for group in &rows.groups {
        let mut listed = group.rows.iter().filter(|row| shows_all || row.differs || row.is_taken).peekable();
        if listed.peek().is_some() {
            lines.extend(group.title.as_ref().map(Line::Heading));
        }
        lines.extend(listed.map(Line::Row));
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let room = ui.available_width()
        - BUTTON_COLUMN_WIDTH
        - ui.spacing().scroll.allocated_width()
        - 3.0 * ui.spacing().item_spacing.x;
    let names = (room * NAMES).floor();
    let values = ((room - names) / 2.0).floor();
    let in_line = bytes_in_line(ui, theme, values);
    let heights: Vec<f32> = lines.iter().map(|line| height(line, in_line)).collect();
    let captions = ["comparison.item", "comparison.left", "", "comparison.right"];
    TableBuilder::new(ui)
        .id_salt("comparison")
        .auto_shrink(false)
        .striped(false)
        .cell_layout(Layout::left_to_right(Align::Center))
        .min_scrolled_height(0.0)
        .column(Column::exact(names).clip(true))
        .column(Column::exact(values).clip(true))
        .column(Column::exact(BUTTON_COLUMN_WIDTH))
        .column(Column::exact(values).clip(true))
        .header(ROW, |mut header| {
            for id in captions {
                header.col(|ui| {
                    if !id.is_empty() {
                        ui.label(theme.caption(theme.translate(id)));
                    }
                });
            }
        })
        .body(|body| {
            body.heterogeneous_rows(heights.into_iter(), |mut row| match lines.get(row.index()) {
                Some(Line::Heading(title)) => {
                    let font = theme.bold_font(theme.sizes.body);
                    row.col(|ui| {
                        ui.add(Label::new(RichText::new(theme.format_text(title)).font(font)).extend());
                    });
                    (0..3).for_each(|_| drop(row.col(|_| ())));
                }
                Some(Line::Row(compared)) => row_ui(&mut row, theme, target, compared, in_line, actions),
                None => {}
            });
        });
}

fn row_ui(
    row: &mut TableRow<'_, '_>,
    theme: &Theme,
    target: Option<&AnyDevice>,
    compared: &ComparedRow,
    in_line: usize,
    actions: &mut Vec<Action>,
) {
    let ComparedRow { item, left, right, differs, is_taken, .. } = compared;
    let title = theme.format_text(&compared.name);
    let colour = if *differs { theme.palette.text } else { theme.palette.muted };
    row.col(|ui| {
        ui.add(Label::new(RichText::new(&title).color(colour)).truncate()).on_hover_text(theme.monospace(item));
    });
    let plain = |text: RichText| text.color(colour);
    row.col(|ui| value_ui(ui, theme, left.as_ref(), &plain, in_line));
    row.col(|ui| {
        let takes = *differs && left.is_some() && target.is_some_and(|device| device.accepts_item(item));
        if takes {
            let word = theme.format_text(&Text::new("comparison.take").with("item", &title));
            let button = name(ui.small_button("→"), true, &word).on_hover_text(&word);
            if button.clicked() {
                actions.push(Action::Comparison(ComparisonAction::Take(item.clone())));
            }
        }
    });
    let edited = |text: RichText| text.color(theme.palette.staged).underline();
    let style: &dyn Fn(RichText) -> RichText = if *is_taken { &edited } else { &plain };
    row.col(|ui| value_ui(ui, theme, right.as_ref(), style, in_line));
}

fn value_ui(
    ui: &mut Ui,
    theme: &Theme,
    value: Option<&ItemValue>,
    style: &dyn Fn(RichText) -> RichText,
    in_line: usize,
) {
    match value {
        None => {
            ui.label(theme.caption(theme.translate("comparison.absent")));
        }
        Some(ItemValue::Text(text)) => {
            ui.add(Label::new(style(RichText::new(theme.format_text(text)))).truncate().selectable(true));
        }
        Some(ItemValue::Bytes(bytes)) => {
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                for line in byte_lines(bytes, in_line) {
                    let words = match line {
                        ByteLine::Bytes(bytes) => hex(bytes),
                        ByteLine::Repeated(count, byte) => {
                            let text = Text::new("comparison.repeated").with("count", count);
                            theme.format_text(&text.with("byte", format!("{byte:02X}")))
                        }
                    };
                    ui.add(Label::new(style(theme.monospace(words))).extend().selectable(true));
                }
            });
        }
    }
}

enum ByteLine<'b> {
    Bytes(&'b [u8]),
    /// A repeated byte: its count and its value.
    Repeated(usize, u8),
}

/// Splits bytes into lines. At least [`MIN_COLLAPSED_BYTES`] equal bytes take a single line.
fn byte_lines(bytes: &[u8], in_line: usize) -> Vec<ByteLine<'_>> {
    match bytes.first() {
        Some(byte) if bytes.len() >= MIN_COLLAPSED_BYTES && bytes.iter().all(|own| own == byte) => {
            vec![ByteLine::Repeated(bytes.len(), *byte)]
        }
        _ => bytes.chunks(in_line).map(ByteLine::Bytes).collect(),
    }
}

/// Returns the number of bytes per line: 16, 8 or 4, depending on the width.
fn bytes_in_line(ui: &Ui, theme: &Theme, width: f32) -> usize {
    let font = FontId::monospace(theme.sizes.body);
    let byte = ui.painter().layout_no_wrap("00 ".to_owned(), font, Color32::PLACEHOLDER).size().x;
    [16_u8, 8].into_iter().find(|count| f32::from(*count) * byte <= width).unwrap_or(4).into()
}

fn height(line: &Line<'_>, in_line: usize) -> f32 {
    let Line::Row(row) = line else { return HEADING };
    let lines = |value: &Option<ItemValue>| match value {
        Some(ItemValue::Bytes(bytes)) => byte_lines(bytes, in_line).len(),
        _ => 1,
    };
    let lines = lines(&row.left).max(lines(&row.right)).max(1);
    ROW + LINE * (lines - 1) as f32
}
