//! A recorded capture as a table of text (CSV), as written by oscilloscopes and data loggers: the meaning of its columns is
//! detected from the first lines and can be corrected. Files are read elsewhere; here bytes are passed in, piece by piece.
//!
//! The columns are those named by SICK 8010701: SIN, REFSIN, COS, REFCOS against ground, or sine and cosine as the
//! differences; and further values of the same moment: the angle of a reference encoder, the absolute position.

mod detect;
mod encoding;
mod header;
mod import;

pub use detect::{Delimiter, HEAD, Layout, SampleClock, TableHints};
pub use encoding::decode_head;
pub use header::{Columns, TimeUnit, VoltUnit};
pub use import::Import;

use super::wiring::Wires;

/// Samples of a sine/cosine signal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Capture {
    /// Times in seconds; empty if the table has none.
    pub time_s: Vec<f64>,
    /// Sine channel in volts, the reference already taken off.
    pub sine_v: Vec<f64>,
    /// Cosine channel in volts, likewise.
    pub cosine_v: Vec<f64>,
    /// The four wires against ground as measured, if the table has the references.
    pub wires: Option<Wires>,
    /// The shaft's angle by a reference encoder in degrees, if the table has it: wrapped at a turn or not.
    pub reference_deg: Option<Vec<f64>>,
    /// Absolute positions in steps of 1/32 period, if the table has them.
    pub absolute: Option<Vec<i64>>,
    /// Rows without a measured value (empty, NaN, overload) after their time, and a truncated last line: they are left out.
    pub left_out: u64,
}

impl Capture {
    /// Returns REFSIN and REFCOS in volts, if the table has them.
    pub fn references_v(&self) -> Option<(&[f64], &[f64])> {
        self.wires.as_ref().map(|wires| (wires.refsin_v.as_slice(), wires.refcos_v.as_slice()))
    }
}

/// Why a table is not a capture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CaptureError {
    /// The table is empty.
    #[error("it is empty")]
    Empty,
    /// No line has numbers in two columns or more.
    #[error("no line has numbers")]
    NoNumbers,
    #[error("it has one column")]
    OneColumn,
    /// There are too few columns, and their names do not tell which is missing.
    #[error("it has {columns} columns")]
    TooFewColumns { columns: usize },
    /// A row ends before a column that is needed.
    #[error("row {row} has {columns} columns, {needed} are needed")]
    ShortRow {
        /// The line in the file, from 1.
        row: u64,
        columns: usize,
        needed: usize,
    },
    /// Something in a row is no number.
    #[error("row {row}, column {column}: {text:?} is not a number")]
    NotANumber {
        /// The line in the file, from 1.
        row: u64,
        /// The column, from 1.
        column: usize,
        text: String,
    },
    /// An absolute position is no whole number of steps.
    #[error("row {row}, column {column}: {text} is no whole number")]
    NotWhole {
        /// The line in the file, from 1.
        row: u64,
        /// The column, from 1.
        column: usize,
        text: String,
    },
    /// A number is NaN or infinite: a time, or a value of a table with too few rows.
    #[error("row {row}, column {column}: {text} is not finite")]
    NotFinite {
        /// The line in the file, from 1.
        row: u64,
        /// The column, from 1.
        column: usize,
        text: String,
    },
    /// More than half of the rows have no measured value.
    #[error("{left_out} of {rows} rows have no value, the first is row {row}")]
    NoValues {
        /// Rows without one.
        left_out: u64,
        rows: u64,
        /// Line of the first of these in the file, counted from 1.
        row: u64,
    },
    /// The header names a start and an increment of the time, and the line below does not give them.
    #[error("the header names Start and Increment, and row {row} has no numbers for them")]
    NoSampleClock {
        /// The line in the file, from 1.
        row: u64,
    },
    /// The header gives a start and an increment of the time, but the column of sample numbers contains something else.
    #[error("row {row}, column {column}: {text} is no sample number, though the header names Start and Increment")]
    NotASampleNumber {
        /// The line in the file, from 1.
        row: u64,
        /// The column, from 1.
        column: usize,
        text: String,
    },
    /// A quotation mark is not closed, so that all that follows belongs to one field.
    #[error("row {row} has a quotation mark that is not closed")]
    OpenQuote {
        /// The line in the file, from 1.
        row: u64,
    },
}
