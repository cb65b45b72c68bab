//! Actions of the Signals tab and results of its tasks.

use std::path::PathBuf;

use super::{Column, ExampleCapture, Measurement, Scope, SourceAction, Table, synchronise};
use crate::analysis::capture::{Delimiter, TimeUnit};
use crate::analysis::quality::Family;
use crate::store::ReadCaptureError;

#[derive(Clone, Debug, PartialEq)]
pub enum SignalsAction {
    Open(PathBuf),
    /// Read an example capture that ships with the program.
    Example(ExampleCapture),
    /// Set the delimiter, overriding the detected one.
    SetDelimiter(Delimiter),
    /// Set whether the decimal separator is a comma.
    SetDecimalComma(bool),
    /// Select a column by its number, starting at 1. `None` selects no column.
    SetColumn(Column, Option<usize>),
    SetTimeUnit(TimeUnit),
    /// Set the volts per unit of the table. The value must be finite and not zero.
    SetVolts(f64),
    /// Detect the format of the table again.
    Detect,
    Cancel,
    SetFamily(Family),
    SetPeriods(u32),
    /// Keep the displayed capture for comparison with others.
    Keep,
    DropComparison,
    Source(SourceAction),
    Synchronise(synchronise::SynchroniseAction),
}

pub enum TaskResult {
    /// A capture was read, or could not be read.
    Read {
        /// Number of the attempt. Results of earlier attempts are ignored.
        number: u32,
        read: Box<ReadCapture>,
    },
    /// New verdicts are available for the displayed capture.
    Rediagnosed {
        /// Number of the attempt. Results of earlier attempts are ignored.
        number: u32,
        measurement: Box<Measurement>,
    },
    Measured {
        /// Number of the start. Results of earlier starts are ignored.
        number: u32,
        measurement: Box<Measurement>,
    },
    /// A task could not be started, or ended without a result.
    Failed(FailedTask),
    /// A large value was dropped in the background.
    ValueDropped,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailedTask {
    Read(u32),
    Judge,
    Measure(u32),
}

pub struct ReadCapture {
    /// First lines of the table, with the detected format.
    pub(super) table: Table,
    pub(super) result: Result<(Measurement, Scope), ReadCaptureError>,
}
