//! Cam tables, as in a spreadsheet or on a machine drawing: read from a file or pasted text, and written. A row is a
//! pulse: program, cam or name, start and stop, in steps, degrees or millimetres of the machine.
//!
//! Invalid entries are reported by line and column; all others are read regardless. Each edge is rounded to encoder
//! steps, and its rounding error is recorded.

mod columns;
mod emit;
mod read;
#[cfg(test)]
mod tests;

pub use emit::emit as emit_table;

use super::{CamNames, Outside, Scale, Unit};
use crate::analysis::capture::Delimiter;
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, Value};

/// Options for reading a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableOptions {
    /// Scale of its edges.
    pub scale: Scale,
    /// Number of steps in the measuring range.
    pub range: u32,
    /// Program for rows that do not specify one.
    pub program: ProgramNumber,
}

/// A table that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CamTable {
    /// Delimiter of its columns.
    pub delimiter: Option<Delimiter>,
    /// Whether the first line contains the column names.
    pub header: bool,
    /// Valid rows in table order.
    pub rows: Vec<TableRow>,
    /// Problems in table order.
    pub problems: Vec<TableProblem>,
    /// Warnings about rows that are otherwise valid.
    pub notes: Vec<TableNote>,
}

/// A pulse.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// Line number, counted from 1.
    pub line: u64,
    /// Its program.
    pub program: ProgramNumber,
    /// Cam that the pulse uses.
    pub cam: CamNumber,
    /// Name of the pulse, which may be empty.
    pub name: String,
    /// Its first position.
    pub start: TableEdge,
    /// Its last one.
    pub stop: TableEdge,
}

/// A cam edge as requested and as rounded to encoder steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableEdge {
    /// Requested position from the table, in machine units.
    pub requested: f64,
    /// Position in encoder steps.
    pub step: u32,
    /// Rounding error, in units.
    pub off: f64,
}

/// A problem that prevented a table entry from being read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {kind}")]
pub struct TableProblem {
    /// Line number, counted from 1.
    pub line: u64,
    /// Column number, counted from 1.
    pub column: u64,
    /// The problem.
    pub kind: TableProblemKind,
}

/// Kinds of problems in a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableProblemKind {
    /// The table is empty.
    #[error("the table has no rows")]
    Empty,
    /// The header has no column for the start or stop.
    #[error("the header names no column for the {0}")]
    NoColumn(Column),
    /// The line ends before this column.
    #[error("the {0} is missing")]
    Missing(Column),
    /// Not a number.
    #[error("{text:?} is no number")]
    Number {
        /// As in the table.
        text: String,
    },
    /// Not a program.
    #[error("{text:?} is no cam program: there are 1 to 8")]
    Program {
        /// As in the table.
        text: String,
    },
    /// Not a cam.
    #[error("{text:?} is no cam: there are 0 to 7")]
    Cam {
        /// As in the table.
        text: String,
    },
    /// Beyond the measuring range.
    #[error("the {column} {0} within the measuring range", .outside)]
    Outside {
        /// The edge.
        column: Column,
        /// Requested position and the limits, in machine units.
        outside: Outside,
    },
    /// All eight cams of the program are in use.
    #[error("program {} has no cam left: it has eight", .0.get())]
    Full(ProgramNumber),
    /// The same cam of the program appears in an earlier line, which takes precedence.
    #[error("cam {} of program {} stands in line {first} already", cam.get(), program.get())]
    Twice {
        /// Program of the cam.
        program: ProgramNumber,
        /// The cam.
        cam: CamNumber,
        /// The line that counts.
        first: u64,
    },
    /// The name is too long.
    #[error("a name has at most {most} characters")]
    Name {
        /// The limit.
        most: usize,
    },
}

/// A note about valid rows.
#[derive(Clone, Debug, PartialEq)]
pub enum TableNote {
    /// Several pulses are on one track, each of which uses a cam of its own.
    Pulses {
        /// Program of the pulses.
        program: ProgramNumber,
        /// The track's name.
        name: String,
        /// Cams that the pulses use.
        cams: Vec<CamNumber>,
    },
    /// The first line contains no known column name, so the columns are read in the usual order.
    OtherHeader,
    /// The header names a unit other than the one used.
    OtherUnit {
        /// As in the header.
        header: Unit,
        /// The one that counts.
        used: Unit,
    },
}

/// Column by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// 1 to 8.
    Program,
    /// 0 to 7.
    Cam,
    /// A track.
    Name,
    /// The first position.
    Start,
    /// The last one.
    Stop,
}

/// A program imported from a table. Only its cams are active; the edges of other cams are left unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Filled {
    /// The program.
    pub program: ProgramNumber,
    /// Its cams.
    pub cams: [Option<Cam>; Program::CAMS],
    /// Names of the cams; empty for unnamed cams.
    pub names: [String; Program::CAMS],
}

/// Maximum length of a cam name in characters.
pub const LONGEST_NAME: usize = 40;

impl std::fmt::Display for Column {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Column::Program => "program",
            Column::Cam => "cam",
            Column::Name => "name",
            Column::Start => "start",
            Column::Stop => "stop",
        })
    }
}

impl TableOptions {
    /// Reads a table. Entries that are left out are reported.
    pub fn read(&self, text: &str) -> CamTable {
        read::read(self, text)
    }
}

impl CamTable {
    /// Returns the programs in the table, for use in edits.
    pub fn filled(&self) -> Vec<Filled> {
        let own = |program| self.rows.iter().filter(move |row| row.program == program);
        ProgramNumber::all()
            .filter(|program| own(*program).next().is_some())
            .map(|program| {
                let mut filled = Filled { program, cams: Default::default(), names: Default::default() };
                for row in own(program) {
                    let at = usize::from(row.cam.get());
                    if let Some((cam, name)) = filled.cams.get_mut(at).zip(filled.names.get_mut(at)) {
                        *cam = Some(row.cam());
                        name.clone_from(&row.name);
                    }
                }
                filled
            })
            .collect()
    }

    /// Returns the rows with an edge that was rounded.
    pub fn rounded(&self) -> impl Iterator<Item = &TableRow> {
        self.rows.iter().filter(|row| row.start.is_off() || row.stop.is_off())
    }

    /// Returns the largest rounding error of an edge, in machine units.
    pub fn most_off(&self) -> f64 {
        let edges = self.rows.iter().flat_map(|row| [row.start, row.stop]);
        edges.map(|edge| edge.off.abs()).fold(0.0, f64::max)
    }
}

impl TableRow {
    /// Returns its edges.
    pub fn cam(&self) -> Cam {
        Cam { start: Value::of_word(self.start.step), stop: Value::of_word(self.stop.step) }
    }
}

impl TableEdge {
    /// Returns whether the edge was rounded.
    pub fn is_off(self) -> bool {
        self.off.abs() > 1e-9 * self.requested.abs().max(1.0)
    }
}
