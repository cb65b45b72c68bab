//! The table of a capture: its first lines, its detected format, and the user's corrections.

use super::TableSource;
use crate::analysis::capture::{Columns, Delimiter, Layout, TableHints, decode_head};

#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub place: TableSource,
    /// First lines of the table. Long lines are truncated.
    pub head: Vec<String>,
    pub hints: TableHints,
    /// Format of the table, if it can be detected.
    pub layout: Option<Layout>,
    /// Columns of REFSIN and REFCOS while only one of them is selected.
    pub partial_references: (Option<usize>, Option<usize>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    Time,
    Sine,
    Cosine,
    RefSine,
    RefCosine,
    /// Shaft angle measured by a reference encoder.
    ReferenceAngle,
    Absolute,
}

const LINES: usize = 6;
/// Maximum number of characters displayed per line.
const WIDTH: usize = 160;
/// Maximum number of columns offered for selection.
const MAX_COLUMNS: usize = 64;

impl Table {
    /// Creates a table from the beginning of a file.
    pub(super) fn from_head(place: TableSource, head: &[u8], hints: TableHints) -> Self {
        let text = decode_head(head);
        let shown = |line: &[u8]| {
            let text = String::from_utf8_lossy(line.trim_ascii_end()).replace('\t', "  →  ");
            let short: String = text.chars().take(WIDTH).collect();
            if short.len() < text.len() { short + "…" } else { short }
        };
        let lines = text.split(|byte| *byte == b'\n').take(LINES).map(shown).collect();
        let layout = Layout::detect(head, &hints).ok();
        Table { place, head: lines, hints, layout, partial_references: (None, None) }
    }

    pub fn delimiter(&self) -> Option<Delimiter> {
        self.hints.delimiter.or(self.layout.as_ref().map(|layout| layout.delimiter))
    }

    pub fn columns(&self) -> Option<Columns> {
        self.hints.columns.or(self.layout.as_ref().map(|layout| layout.columns))
    }

    /// Returns the column for a quantity, numbered from 1.
    pub fn column(&self, column: Column) -> Option<usize> {
        let columns = self.columns()?;
        match column {
            Column::Time => columns.time,
            Column::Sine => Some(columns.sine),
            Column::Cosine => Some(columns.cosine),
            Column::ReferenceAngle => columns.reference_angle,
            Column::Absolute => columns.absolute,
            Column::RefSine => columns.references.map(|(sine, _)| sine).or(self.partial_references.0),
            Column::RefCosine => columns.references.map(|(_, cosine)| cosine).or(self.partial_references.1),
        }
    }

    pub fn width(&self) -> usize {
        let delimiter = self.delimiter().map_or(',', |delimiter| char::from(delimiter.byte()));
        let fields = |line: &String| match delimiter {
            '\t' => line.matches('→').count() + 1,
            delimiter => line.matches(delimiter).count() + 1,
        };
        let named = self.layout.as_ref().map_or(0, |layout| layout.names.len());
        self.head.iter().map(fields).max().unwrap_or(0).max(named).min(MAX_COLUMNS)
    }

    pub fn name(&self, column: usize) -> Option<&str> {
        let name = self.layout.as_ref()?.names.get(column.checked_sub(1)?)?;
        Some(name.as_str()).filter(|name| !name.is_empty())
    }

    /// Selects a column. Returns `false` if the table cannot be read this way, for example because the other reference
    /// column is missing.
    pub(super) fn select_column(&mut self, column: Column, number: Option<usize>) -> bool {
        let mut columns = self.columns().unwrap_or(Columns::TIME_SINE_COSINE);
        match (column, number) {
            (Column::Time, number) => columns.time = number,
            (Column::ReferenceAngle, number) => columns.reference_angle = number,
            (Column::Absolute, number) => columns.absolute = number,
            (Column::Sine, Some(number)) => columns.sine = number,
            (Column::Cosine, Some(number)) => columns.cosine = number,
            (Column::Sine | Column::Cosine, None) => return false,
            (Column::RefSine | Column::RefCosine, number) => {
                let (mut sine, mut cosine) = (self.column(Column::RefSine), self.column(Column::RefCosine));
                *(if column == Column::RefSine { &mut sine } else { &mut cosine }) = number;
                let before = columns.references;
                columns.references = sine.zip(cosine);
                self.partial_references = if columns.references.is_some() { (None, None) } else { (sine, cosine) };
                if columns.references == before {
                    return false;
                }
            }
        }
        self.hints.columns = Some(columns);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::state::ExampleCapture;

    fn table(text: &str) -> Table {
        Table::from_head(TableSource::Example(ExampleCapture::Healthy), text.as_bytes(), TableHints::default())
    }

    #[test]
    fn shows_and_parses_first_lines() {
        let long = "x".repeat(500);
        let table =
            table(&format!("t (ms);SIN;COS\r\n0;0,1;0,5\r\n1;0,2;0,4\r\n{long}\r\n2;3;4\r\n3;4;5\r\n4;5;6\r\n"));
        assert_eq!(table.head.len(), 6);
        assert_eq!(table.head[..2], ["t (ms);SIN;COS", "0;0,1;0,5"]);
        assert_eq!(table.head[3].chars().count(), 161);
        assert_eq!((table.delimiter(), table.width()), (Some(Delimiter::Semicolon), 3));
        assert_eq!(table.column(Column::Sine), Some(2));
        assert_eq!((table.name(1), table.name(4), table.name(0)), (Some("t (ms)"), None, None));
    }

    #[test]
    fn references_require_both_columns() {
        let mut table = table("a,b,c,d,e\n0,1,2,3,4\n");
        assert!(!table.select_column(Column::RefSine, Some(3)), "the other one is missing");
        assert_eq!((table.column(Column::RefSine), table.hints.columns), (Some(3), None));
        assert!(table.select_column(Column::RefCosine, Some(5)));
        assert_eq!(table.columns().unwrap().references, Some((3, 5)));
        assert!(table.select_column(Column::RefSine, None), "without one of them both are not taken off");
        assert_eq!(table.columns().unwrap().references, None);
        assert_eq!(table.column(Column::RefCosine), Some(5));
        assert!(table.select_column(Column::Cosine, Some(4)) && table.select_column(Column::Time, None));
        let columns = table.hints.columns.unwrap();
        assert_eq!((columns.time, columns.sine, columns.cosine), (None, 2, 4));
        assert!(!table.select_column(Column::Sine, None));
    }

    #[test]
    fn plain_text_has_no_layout() {
        let table = table("no table at all");
        assert_eq!((table.layout, table.head), (None, vec!["no table at all".to_owned()]));
        assert_eq!(self::table("").width(), 1);
        assert_eq!(self::table("t\tsin\tcos\n0\t1\t2\n").width(), 3);
    }
}
