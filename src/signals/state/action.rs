//! Actions of the Signals tab, and the results of its tasks.

use std::path::PathBuf;

use super::{Column, ExampleCapture, Measurement, Scope, SourceAction, Table, synchronise};
use crate::analysis::capture::{Delimiter, TimeUnit};
use crate::analysis::quality::Family;
use crate::store::ReadCaptureError;

#[derive(Clone, Debug, PartialEq)]
pub enum SignalsAction {
    Open(PathBuf),
    /// Reads one of the example captures that ship with the program.
    Example(ExampleCapture),
    /// Replaces the detected delimiter.
    SetDelimiter(Delimiter),
    /// Sets whether numbers have a decimal comma.
    SetDecimalComma(bool),
    /// Selects another column, counted from 1, or no column with `None`.
    SetColumn(Column, Option<usize>),
    SetTimeUnit(TimeUnit),
    /// Sets the volts per unit of the table, which must be finite and not zero.
    SetVolts(f64),
    /// Detects the table's format again.
    Detect,
    Cancel,
    SetFamily(Family),
    /// Sets the signal periods per revolution, at least 1.
    SetPeriods(u32),
    /// Keeps the displayed capture for comparison with later ones.
    Keep,
    DropComparison,
    Source(SourceAction),
    Synchronise(synchronise::SynchroniseAction),
}

pub enum Done {
    /// Reports that a capture has been read or that reading has failed.
    Read {
        /// Number of the attempt. Only the latest attempt counts.
        number: u32,
        read: Box<Read>,
    },
    /// Reports that the displayed capture has been judged again.
    Judged {
        /// Number of the attempt. Only the latest attempt counts.
        number: u32,
        measurement: Box<Measurement>,
    },
    Measured {
        /// Number of the start. Only the latest start counts.
        number: u32,
        measurement: Box<Measurement>,
    },
    /// Reports that a task could not be started or ended without a result.
    Failed(FailedTask),
    /// Reports that a large value has been dropped.
    LetGo,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailedTask {
    Read(u32),
    /// Judges the displayed capture again.
    Judge,
    Measure(u32),
}

pub struct Read {
    /// First lines of the table, with the detected format.
    pub(super) table: Table,
    pub(super) result: Result<(Measurement, Scope), ReadCaptureError>,
}
