//! Import of a recorded capture from a text table (CSV) as written by oscilloscopes and data loggers. The meaning of
//! the columns is detected from the first lines and can be corrected. The caller reads the file and passes its bytes
//! piece by piece.
//!
//! The columns are those named by SICK 8010701: SIN, REFSIN, COS and REFCOS against ground, or sine and cosine as
//! differences. Further columns may hold the simultaneous angle of a reference encoder and the absolute position.

mod detect;
mod encoding;
mod header;
mod import;

pub use detect::{Delimiter, HEAD_BYTES, Layout, SampleClock, TableHints};
pub use encoding::decode_head;
pub use header::{Columns, TimeUnit, VoltUnit};
pub use import::TableImport;

use super::wiring::Wires;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capture {
    /// Times in seconds. Empty if the table has no time column.
    pub time_s: Vec<f64>,
    /// Sine channel in volts, with the reference subtracted.
    pub sine_v: Vec<f64>,
    /// Cosine channel in volts, with the reference subtracted.
    pub cosine_v: Vec<f64>,
    /// Voltages of the four wires against ground, if the table contains the references.
    pub wires: Option<Wires>,
    /// Shaft angle of a reference encoder in degrees, if the table contains it. The angle may be wrapped or unwrapped.
    pub reference_deg: Option<Vec<f64>>,
    /// Absolute positions in steps of 1/32 period, if the table contains them.
    pub absolute: Option<Vec<i64>>,
    /// Number of skipped rows: those without a measured value (empty, NaN or overload), and a truncated last line.
    pub skipped_rows: u64,
}

impl Capture {
    /// Returns REFSIN and REFCOS in volts, if the table contains them.
    pub fn references_v(&self) -> Option<(&[f64], &[f64])> {
        self.wires.as_ref().map(|wires| (wires.refsin_v.as_slice(), wires.refcos_v.as_slice()))
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CaptureError {
    #[error("it is empty")]
    Empty,
    /// No line has numbers in two or more columns.
    #[error("no line contains numbers")]
    NoNumbers,
    #[error("it has one column")]
    OneColumn,
    /// The table has too few columns, and their names do not show which ones are missing.
    #[error("it has {columns} columns")]
    TooFewColumns { columns: usize },
    /// A row ends before a required column.
    #[error("row {row} has {columns} columns, but {needed} are required")]
    ShortRow {
        /// Line number in the file, counted from 1.
        row: u64,
        columns: usize,
        needed: usize,
    },
    #[error("row {row}, column {column}: {text:?} is not a number")]
    NotANumber {
        /// Line number in the file, counted from 1.
        row: u64,
        /// Column number, counted from 1.
        column: usize,
        text: String,
    },
    /// An absolute position is not a whole number of steps.
    #[error("row {row}, column {column}: {text} is not a whole number")]
    NotWhole {
        /// Line number in the file, counted from 1.
        row: u64,
        /// Column number, counted from 1.
        column: usize,
        text: String,
    },
    /// A time is NaN or infinite. In a very short table, the cause may also be a measured value.
    #[error("row {row}, column {column}: {text} is not finite")]
    NotFinite {
        /// Line number in the file, counted from 1.
        row: u64,
        /// Column number, counted from 1.
        column: usize,
        text: String,
    },
    /// More than half of the rows have no measured value.
    #[error("{skipped_rows} of {rows} rows have no value (the first one is row {row})")]
    NoValues {
        /// Number of rows without a measured value.
        skipped_rows: u64,
        rows: u64,
        /// Line number in the file of the first row without a measured value, counted from 1.
        row: u64,
    },
    /// The header has columns for a start time and an increment, but the line below does not contain their values.
    #[error("the header contains Start and Increment, but row {row} has no numbers for them")]
    NoSampleClock {
        /// Line number in the file, counted from 1.
        row: u64,
    },
    /// The header has a start time and an increment, but the first column contains something other than a sample
    /// number.
    #[error(
        "row {row}, column {column}: {text} is not a sample number, although the header contains Start and Increment"
    )]
    NotASampleNumber {
        /// Line number in the file, counted from 1.
        row: u64,
        /// Column number, counted from 1.
        column: usize,
        text: String,
    },
    /// A quotation mark is not closed, so the rest of the file would be a single field.
    #[error("row {row} has no closing quotation mark")]
    OpenQuote {
        /// Line number in the file, counted from 1.
        row: u64,
    },
}
