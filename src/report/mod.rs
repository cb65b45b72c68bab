//! The document model of reports, which consist of sections with label–value pairs, tables and drawings in one
//! language. It does not depend on devices and does no I/O. Two renderers, [`html`] and [`pdf`], turn the same document
//! into pages.

mod content_hash;
pub mod html;
pub mod pdf;

use serde::Serialize;

pub use content_hash::{ContentHash, sha256_hex};

use crate::drawing::Drawing;

/// A report about a device, a profile or a capture. All texts are in the language of the report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Language of the texts as a BCP 47 tag such as `en`.
    pub language: &'static str,
    /// Type of report, such as "Device report".
    pub subject: String,
    /// Name of the device or the file.
    pub title: String,
    /// Company that issues the report, if the settings name one.
    pub company: Option<Company>,
    /// Origin of the values: source, time, program and asset.
    pub origin: Vec<Fact>,
    /// Sections of the report.
    pub sections: Vec<Section>,
    /// Fixed texts around the content, such as the label of the print time.
    pub labels: Labels,
}

/// A company that issues reports.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Company {
    /// Name of the company.
    pub name: String,
    /// Logo as the bytes of a PNG file, if there is one.
    pub logo: Option<Vec<u8>>,
}

/// Fixed texts around the content of a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Labels {
    /// Label of the report number.
    pub number: String,
    /// Label of the content hash.
    pub content_hash: String,
    /// Label of the print time.
    pub printed: String,
    /// Word before a page number.
    pub page: String,
    /// Word between a page number and the number of pages, such as "of".
    pub of: String,
    /// Statement that the report is not a calibration certificate.
    pub no_certificate: String,
    /// Labels of the signature lines.
    pub signatures: Vec<String>,
}

/// A section of a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Heading of the section.
    pub title: String,
    /// Content blocks in reading order.
    pub blocks: Vec<Block>,
}

/// A block of content in a section.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Block {
    /// A paragraph of text.
    Paragraph(String),
    /// A heading within the section.
    Heading(String),
    /// A list of labels with their values.
    Facts(Vec<Fact>),
    /// A table.
    Table(Table),
    /// A drawing.
    Drawing(Drawing),
}

/// A label with its value.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    /// Label that describes the value.
    pub label: String,
    /// Value with its unit.
    pub value: String,
    /// Style in which the value is printed.
    pub style: CellStyle,
}

/// A table. Each row has a cell for each column.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Columns, from left to right.
    pub columns: Vec<Column>,
    /// Rows, from top to bottom.
    pub rows: Vec<Row>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Heading, which may be empty.
    pub heading: String,
    /// Style of the cells in this column.
    pub style: CellStyle,
}

/// The style of a value or a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum CellStyle {
    /// Text that may be broken into several lines.
    Text,
    /// Text that stays on one line, such as a unit or a time.
    Short,
    /// Bytes or addresses in a monospaced font, which may be broken between bytes.
    Code,
    /// A number in a monospaced font, aligned to the right.
    Number,
}

/// A row of a table, with an optional verdict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
    /// Cells, from left to right.
    pub cells: Vec<String>,
    /// Verdict on the row.
    pub mark: Mark,
}

/// A verdict on a row of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum Mark {
    /// The row has no verdict.
    #[default]
    None,
    /// The value is within the limits.
    Good,
    /// The row contains a warning.
    Warning,
    /// The row contains an error.
    Bad,
}

impl Section {
    /// Creates an empty section.
    pub fn new(title: impl Into<String>) -> Self {
        Section { title: title.into(), blocks: Vec::new() }
    }

    /// Adds a block. Table columns without entries are omitted.
    #[must_use]
    pub fn with(mut self, mut block: Block) -> Self {
        if let Block::Table(table) = &mut block {
            table.remove_empty_columns();
        }
        self.blocks.push(block);
        self
    }
}

impl Fact {
    /// Creates a label–value pair whose value is text.
    pub fn new(label: impl Into<String>, value: impl Into<String>) -> Self {
        Fact { label: label.into(), value: value.into(), style: CellStyle::Text }
    }

    /// Creates a label–value pair whose value is an identifier, an address or bytes.
    pub fn code(label: impl Into<String>, value: impl Into<String>) -> Self {
        Fact { style: CellStyle::Code, ..Fact::new(label, value) }
    }
}

impl Table {
    /// Creates a table without rows.
    pub fn new(columns: impl IntoIterator<Item = (String, CellStyle)>) -> Self {
        let columns = columns.into_iter().map(|(heading, style)| Column { heading, style }).collect();
        Table { columns, rows: Vec::new() }
    }

    /// Adds a row without a verdict.
    pub fn add_row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.add_marked_row(Mark::None, cells);
    }

    /// Adds a row with a verdict.
    pub fn add_marked_row(&mut self, mark: Mark, cells: impl IntoIterator<Item = String>) {
        self.rows.push(Row { cells: cells.into_iter().collect(), mark });
    }

    /// Removes columns in which every cell is empty.
    fn remove_empty_columns(&mut self) {
        let is_used =
            |index: usize| self.rows.iter().any(|row| row.cells.get(index).is_some_and(|cell| !cell.is_empty()));
        let used: Vec<bool> = (0..self.columns.len()).map(is_used).collect();
        let mut flags = used.iter().copied();
        self.columns.retain(|_| flags.next().unwrap_or(true));
        for row in &mut self.rows {
            let mut flags = used.iter().copied();
            row.cells.retain(|_| flags.next().unwrap_or(true));
        }
    }
}
