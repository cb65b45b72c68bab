//! Actions of the Signals tab, and the results of its tasks.

use std::path::PathBuf;

use super::{Column, Example, Measurement, Scope, SourceAction, Table, synchronise};
use crate::analysis::capture::{Delimiter, TimeUnit};
use crate::analysis::quality::Family;
use crate::store::ReadCaptureError;

#[derive(Clone, Debug, PartialEq)]
pub enum SignalsAction {
    Open(PathBuf),
    /// Read one of the captures that ship with the program.
    Example(Example),
    /// Another delimiter than the one found.
    SetDelimiter(Delimiter),
    /// Numbers have a decimal comma, or not.
    SetDecimalComma(bool),
    /// Select another column, from 1; `None`: no column.
    SetColumn(Column, Option<usize>),
    SetTimeUnit(TimeUnit),
    /// Volts in one unit of the table; finite, not zero.
    SetVolts(f64),
    /// Find all of that out again.
    Detect,
    Cancel,
    SetFamily(Family),
    /// Signal periods in one revolution, at least 1.
    SetPeriods(u32),
    /// Put the capture that is shown aside, to be compared with those that come.
    Keep,
    /// Compare no longer.
    DropComparison,
    /// An action about the source: the virtual encoder, or an adapter.
    Source(SourceAction),
    Synchronise(synchronise::SynchroniseAction),
}

pub enum Done {
    /// A capture was read, or not.
    Read {
        /// Number of the attempt: only the latest counts.
        number: u32,
        read: Box<Read>,
    },
    /// The displayed capture was judged again.
    Judged {
        /// Number of the attempt: only the latest counts.
        number: u32,
        measurement: Box<Measurement>,
    },
    Measured {
        /// Number of the start: only the latest counts.
        number: u32,
        measurement: Box<Measurement>,
    },
    /// A task could not be started, or broke off.
    Failed(Failed),
    /// Something large is no more.
    LetGo,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failed {
    Read(u32),
    /// Judging the capture that is shown again.
    Judge,
    Measure(u32),
}

pub struct Read {
    /// Its first lines, and the detected format.
    pub(super) table: Table,
    pub(super) result: Result<(Measurement, Scope), ReadCaptureError>,
}
