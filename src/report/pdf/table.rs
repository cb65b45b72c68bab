//! Layout of a table: column widths, rows that are not split between pages, and a heading on each page.

use super::canvas::{Colour, LINE, MUTED_COLOUR, TEXT};
use super::flow::{Flow, MARGIN, Style, WIDTH};
use super::typeface::Face;
use crate::report::{CellStyle, Mark, Row, Table};

const HEADING: Style = Style { face: Face::Text, size: 8.0, colour: MUTED_COLOUR };
/// Horizontal distance between two columns, in points.
const GAP: f32 = 9.0;
/// Distance between the text of a row and its rules, in points.
const PADDING: f32 = 2.4;
/// Digits whose width is the minimum width of a column with code.
const MIN_CODE_WIDTH_DIGITS: &str = "0000000";
const GOOD: Colour = [0x0b, 0x7a, 0x52];
const WARNING: Colour = [0xa9, 0x4b, 0x06];
const BAD: Colour = [0xc6, 0x28, 0x28];

/// A table with the widths of its columns.
pub(super) struct TableLayout<'a> {
    table: &'a Table,
    widths: Vec<f32>,
    heading_lines: Vec<Vec<String>>,
}

impl<'a> TableLayout<'a> {
    pub(super) fn new(flow: &Flow<'_>, table: &'a Table) -> Self {
        let widths = column_widths(flow, table);
        let headings = table.columns.iter().zip(&widths);
        let heading_lines = headings.map(|(column, width)| flow.lines(HEADING, &column.heading, *width)).collect();
        TableLayout { table, widths, heading_lines }
    }

    /// Returns the combined height of the heading and the first row, which are kept together.
    pub(super) fn lead_height(&self, flow: &Flow<'_>) -> f32 {
        let first = self.table.rows.first().map_or(0.0, |row| row_height(&self.row_lines(flow, row)));
        self.heading_height() + first
    }

    pub(super) fn place(&self, flow: &mut Flow<'_>) {
        flow.ensure_space(self.lead_height(flow));
        self.place_heading(flow);
        for row in &self.table.rows {
            let mut lines = self.row_lines(flow, row);
            if row_height(&lines) > flow.remaining_height() {
                flow.break_page();
                self.place_heading(flow);
            }
            // Only a row that is higher than a page is split.
            while row_height(&lines) > flow.remaining_height() {
                let fits = ((flow.remaining_height() - 2.0 * PADDING) / cell_style(CellStyle::Text).line_height())
                    .max(1.0) as usize;
                let rest = lines.iter_mut().map(|cell| cell.split_off(fits.min(cell.len()))).collect();
                self.place_row(flow, row, &lines);
                lines = rest;
                if lines.iter().all(Vec::is_empty) {
                    break;
                }
                flow.break_page();
                self.place_heading(flow);
            }
            if lines.iter().any(|cell| !cell.is_empty()) {
                self.place_row(flow, row, &lines);
            }
        }
        flow.y += 8.0;
    }

    fn heading_height(&self) -> f32 {
        let lines = self.heading_lines.iter().map(Vec::len).max().unwrap_or(0);
        lines as f32 * HEADING.line_height() + 2.0 * PADDING
    }

    fn row_lines(&self, flow: &Flow<'_>, row: &Row) -> Vec<Vec<String>> {
        let cells = row.cells.iter().zip(&self.table.columns).zip(&self.widths);
        cells.map(|((cell, column), width)| flow.lines(cell_style(column.style), cell, *width)).collect()
    }

    fn place_heading(&self, flow: &mut Flow<'_>) {
        let (top, height) = (flow.y, self.heading_height());
        let mut x = MARGIN;
        for ((lines, column), width) in self.heading_lines.iter().zip(&self.table.columns).zip(&self.widths) {
            // Headings are aligned to the rule below them.
            let above = height - PADDING - lines.len() as f32 * HEADING.line_height();
            for (line, number) in lines.iter().zip(0_u8..) {
                let y = top + above + f32::from(number) * HEADING.line_height();
                let right = if column.style == CellStyle::Number { width - flow.width(HEADING, line) } else { 0.0 };
                flow.text_at(x + right, y, HEADING, line);
            }
            x += width + GAP;
        }
        flow.y = top + height;
        flow.rule(MARGIN, flow.y, WIDTH, 0.6, MUTED_COLOUR);
    }

    fn place_row(&self, flow: &mut Flow<'_>, row: &Row, cells: &[Vec<String>]) {
        let (top, height) = (flow.y, row_height(cells));
        let last = cells.len().saturating_sub(1);
        let mut x = MARGIN;
        for (index, ((lines, column), width)) in cells.iter().zip(&self.table.columns).zip(&self.widths).enumerate() {
            let own = cell_style(column.style);
            let style = if index == last { marked(own, row.mark) } else { own };
            // Cells with a smaller font have the same baseline.
            let lower = (cell_style(CellStyle::Text).size - style.size) * 1.05;
            for (line, number) in lines.iter().zip(0_u16..) {
                let y = top + PADDING + lower + f32::from(number) * cell_style(CellStyle::Text).line_height();
                let right = if column.style == CellStyle::Number { width - flow.width(style, line) } else { 0.0 };
                flow.text_at(x + right, y, style, line);
            }
            x += width + GAP;
        }
        flow.y = top + height;
        flow.rule(MARGIN, flow.y, WIDTH, 0.4, LINE);
    }
}

fn row_height(cells: &[Vec<String>]) -> f32 {
    let lines = cells.iter().map(Vec::len).max().unwrap_or(0);
    lines as f32 * cell_style(CellStyle::Text).line_height() + 2.0 * PADDING
}

pub(super) const fn cell_style(style: CellStyle) -> Style {
    match style {
        CellStyle::Text | CellStyle::Short => Style { face: Face::Text, size: 9.0, colour: TEXT },
        CellStyle::Code | CellStyle::Number => Style { face: Face::Mono, size: 8.0, colour: TEXT },
    }
}

const fn marked(style: Style, mark: Mark) -> Style {
    match mark {
        Mark::None => style,
        Mark::Good => Style { colour: GOOD, ..style },
        Mark::Warning => Style { colour: WARNING, ..style },
        Mark::Bad => Style { colour: BAD, ..style },
    }
}

/// Returns the widths of the columns. Columns whose text must stay on one line are as wide as their content. The others
/// share the remaining width in proportion to their content.
fn column_widths(flow: &Flow<'_>, table: &Table) -> Vec<f32> {
    let available = WIDTH - GAP * table.columns.len().saturating_sub(1) as f32;
    let bounds: Vec<(f32, f32)> = table
        .columns
        .iter()
        .enumerate()
        .map(|(index, column)| {
            let style = cell_style(column.style);
            let cells = table.rows.iter().filter_map(|row| row.cells.get(index));
            let widest = cells.clone().map(|cell| flow.width(style, cell)).fold(0.0, f32::max);
            let words = |text: &str| text.split([' ', '\n']).map(|word| flow.width(style, word)).fold(0.0, f32::max);
            let longest = cells.map(|cell| words(cell)).fold(0.0, f32::max);
            let whole = flow.width(HEADING, &column.heading);
            let heading = column.heading.split(' ').map(|word| flow.width(HEADING, word)).fold(0.0, f32::max);
            match column.style {
                CellStyle::Short | CellStyle::Number => (widest.max(heading), widest.max(heading)),
                CellStyle::Text => (longest.max(heading).min(available / 3.0), widest.max(whole)),
                CellStyle::Code => {
                    let least = flow.width(style, MIN_CODE_WIDTH_DIGITS).max(longest.min(available / 6.0));
                    (least.max(heading).min(widest.max(heading)), widest.max(whole))
                }
            }
        })
        .collect();
    let least: f32 = bounds.iter().map(|(least, _)| least).sum();
    let wanted: f32 = bounds.iter().map(|(_, wanted)| wanted).sum();
    if wanted <= available {
        // The remaining width goes to the columns that may be broken.
        let flexible = |style| matches!(style, CellStyle::Text | CellStyle::Code);
        let growing = table.columns.iter().zip(&bounds).filter(|(column, _)| flexible(column.style));
        let total: f32 = growing.map(|(_, (_, wanted))| wanted).sum();
        let share = |column: &crate::report::Column, wanted: f32| match flexible(column.style) && total > 0.0 {
            true => wanted + (available - bounds.iter().map(|(_, wanted)| wanted).sum::<f32>()) * wanted / total,
            false => wanted,
        };
        return table.columns.iter().zip(&bounds).map(|(column, (_, wanted))| share(column, *wanted)).collect();
    }
    let part = ((available - least) / (wanted - least).max(1.0)).clamp(0.0, 1.0);
    let narrow = (available / least.max(1.0)).min(1.0);
    bounds.iter().map(|(least, wanted)| (least + (wanted - least) * part) * narrow).collect()
}
