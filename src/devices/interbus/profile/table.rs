//! Cam tables, as found in spreadsheets and machine drawings. They are read from a file or pasted text, and can be
//! saved. Each row defines one pulse with its program, cam or name, start and stop. Positions are in encoder steps, or
//! in degrees or millimetres of the machine.
//!
//! Invalid entries are reported with their line and column, and the rest is still read. Each edge is rounded to encoder
//! steps, and its rounding error is recorded.

mod columns;
mod emit;
mod read;
#[cfg(test)]
mod tests;

pub use emit::emit as emit_table;

use super::{CamNames, OutsideRangeError, Scale, Unit};
use crate::analysis::capture::Delimiter;
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, Value};

/// Options for reading a cam table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableOptions {
    /// Scale of the positions in the table.
    pub scale: Scale,
    /// Number of steps in the measuring range.
    pub range: u32,
    /// Program for rows that do not name one.
    pub program: ProgramNumber,
}

/// Content of a cam table, with the problems found in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CamTable {
    /// Delimiter between the columns.
    pub delimiter: Option<Delimiter>,
    /// Whether the first line is a header with column names.
    pub header: bool,
    /// Valid rows in table order.
    pub rows: Vec<TableRow>,
    /// Problems in table order.
    pub problems: Vec<TableProblem>,
    /// Notes about valid rows.
    pub notes: Vec<TableNote>,
}

/// A row of a cam table. Each row defines one pulse.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// Line number, counted from 1.
    pub line: u64,
    /// Program of the pulse.
    pub program: ProgramNumber,
    /// Cam that the pulse uses.
    pub cam: CamNumber,
    /// Name of the pulse, which may be empty.
    pub name: String,
    /// First position of the pulse.
    pub start: TableEdge,
    /// Last position of the pulse.
    pub stop: TableEdge,
}

/// A cam edge, both as given in the table and rounded to encoder steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableEdge {
    /// Requested position in the unit of the scale.
    pub requested: f64,
    /// Rounded position in encoder steps.
    pub step: u32,
    /// Rounding error in the unit of the scale.
    pub off: f64,
}

/// A problem that prevents a table entry from being read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}, column {column}: {kind}")]
pub struct TableProblem {
    /// Line number, counted from 1.
    pub line: u64,
    /// Column number, counted from 1.
    pub column: u64,
    /// Kind of the problem.
    pub kind: TableProblemKind,
}

/// Kinds of problems in a cam table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableProblemKind {
    /// The table is empty.
    #[error("the table has no rows")]
    Empty,
    /// The header has no column for the start or stop.
    #[error("the header has no column for the {0}")]
    NoColumn(Column),
    /// The line has no value in this column.
    #[error("the {0} is missing")]
    Missing(Column),
    /// The text is not a number.
    #[error("{text:?} is not a number")]
    Number {
        /// Text in the table.
        text: String,
    },
    /// The text is not a program number.
    #[error("{text:?} is not a cam program from 1 to 8")]
    Program {
        /// Text in the table.
        text: String,
    },
    /// The text is not a cam number.
    #[error("{text:?} is not a cam from 0 to 7")]
    Cam {
        /// Text in the table.
        text: String,
    },
    /// The edge is beyond the measuring range.
    #[error("the {column} {0} within the measuring range", .outside)]
    Outside {
        /// Column of the edge.
        column: Column,
        /// Requested position and the limits, in the unit of the scale.
        outside: OutsideRangeError,
    },
    /// All eight cams of the program are in use.
    #[error("all eight cams of program {} are in use", .0.get())]
    Full(ProgramNumber),
    /// The cam already appears in an earlier line, which takes precedence.
    #[error("cam {} of program {} is already defined in line {first}", cam.get(), program.get())]
    Twice {
        /// Program of the cam.
        program: ProgramNumber,
        /// The repeated cam.
        cam: CamNumber,
        /// Earlier line with this cam, counted from 1.
        first: u64,
    },
    /// The name is too long or contains control characters.
    #[error("the name must have at most {most} characters")]
    Name {
        /// Maximum number of characters.
        most: usize,
    },
}

/// A note about rows that are valid.
#[derive(Clone, Debug, PartialEq)]
pub enum TableNote {
    /// Several pulses of a program share a name, and each uses a separate cam.
    Pulses {
        /// Program of the pulses.
        program: ProgramNumber,
        /// Common name of the pulses.
        name: String,
        /// Cams that the pulses use.
        cams: Vec<CamNumber>,
    },
    /// The first line contains no known column name, so the columns are assumed to be in the standard order.
    OtherHeader,
    /// The unit in the header differs from the selected one.
    OtherUnit {
        /// Unit in the header.
        header: Unit,
        /// Selected unit, which is used.
        used: Unit,
    },
}

/// A column of a cam table, identified by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Number of the program, 1 to 8.
    Program,
    /// Number of the cam, 0 to 7.
    Cam,
    /// Name of the pulse.
    Name,
    /// First position of the pulse.
    Start,
    /// Last position of the pulse.
    Stop,
}

/// A program imported from a table. Cams that are not in the table become inactive but keep their edges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportedProgram {
    /// The program.
    pub program: ProgramNumber,
    /// Cams by number. Cams that the table does not contain are `None`.
    pub cams: [Option<Cam>; Program::CAMS],
    /// Names of the cams by number. Unnamed cams have an empty name.
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
    /// Reads a table. The result also reports the entries that were omitted.
    pub fn read(&self, text: &str) -> CamTable {
        read::read(self, text)
    }
}

impl CamTable {
    /// Returns the programs that the table contains.
    pub fn to_programs(&self) -> Vec<ImportedProgram> {
        let own = |program| self.rows.iter().filter(move |row| row.program == program);
        ProgramNumber::all()
            .filter(|program| own(*program).next().is_some())
            .map(|program| {
                let mut filled = ImportedProgram { program, cams: Default::default(), names: Default::default() };
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

    /// Returns the rows with at least one rounded edge.
    pub fn rounded_rows(&self) -> impl Iterator<Item = &TableRow> {
        self.rows.iter().filter(|row| row.start.is_rounded() || row.stop.is_rounded())
    }

    /// Returns the largest rounding error of any edge in the unit of the scale.
    pub fn max_rounding_error(&self) -> f64 {
        let edges = self.rows.iter().flat_map(|row| [row.start, row.stop]);
        edges.map(|edge| edge.off.abs()).fold(0.0, f64::max)
    }
}

impl TableRow {
    /// Returns the pulse as a cam.
    pub fn cam(&self) -> Cam {
        Cam { start: Value::from_word(self.start.step), stop: Value::from_word(self.stop.step) }
    }
}

impl TableEdge {
    /// Returns whether the position was rounded.
    pub fn is_rounded(self) -> bool {
        self.off.abs() > 1e-9 * self.requested.abs().max(1.0)
    }
}
