//! Parses a table into rows. The csv-core crate splits the lines, and each edge is rounded to the nearest step.

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

use super::columns::{self, Columns};
use super::{
    CamTable, Column, LONGEST_NAME, TableEdge, TableNote, TableOptions, TableProblem, TableProblemKind, TableRow,
};
use crate::analysis::capture::Delimiter;
use crate::devices::interbus::profile::{OutsideRangeError, RoundedPosition, Unit};
use crate::devices::interbus::protocol::{CamNumber, Program, ProgramNumber};

/// Maximum number of rows in a cam table. A table for all cams of all programs has only 64.
const MAX_ROWS: usize = 1000;
/// Maximum number of characters that a message quotes from an invalid cell.
const MAX_EXCERPT_CHARS: usize = 24;

struct TableLine {
    /// Line number, counted from 1.
    number: u64,
    cells: Vec<String>,
}

/// A row that may not have been assigned a cam yet.
struct DraftRow {
    line: u64,
    /// Column to which error messages refer: the cam column, or else the name column, or else the first one.
    column: u64,
    program: ProgramNumber,
    cam: Option<CamNumber>,
    name: String,
    start: TableEdge,
    stop: TableEdge,
}

pub(super) fn read(options: &TableOptions, text: &str) -> CamTable {
    let text = text.trim_start_matches('\u{FEFF}');
    let delimiter = columns::delimiter(text);
    let lines = split(text, delimiter);
    let mut table = CamTable { delimiter: Some(delimiter), ..CamTable::default() };
    let Some(first) = lines.first() else {
        table.problems.push(TableProblem { line: 1, column: 1, kind: TableProblemKind::Empty });
        return table;
    };
    let columns = table.columns(options, first, &lines);
    if !table.problems.is_empty() {
        return table;
    }
    let mut drafts = Vec::new();
    for line in lines.iter().skip(usize::from(table.header)).take(MAX_ROWS) {
        match parse_draft(options, &columns, line, delimiter != Delimiter::Comma) {
            Ok(draft) => drafts.push(draft),
            Err(problem) => table.problems.push(problem),
        }
    }
    if drafts.is_empty() && table.problems.is_empty() {
        table.problems.push(TableProblem { line: first.number, column: 1, kind: TableProblemKind::Empty });
    }
    table.assign_cams(drafts);
    table.problems.sort_by_key(|problem| (problem.line, problem.column));
    table.note_multi_cam_names();
    table
}

impl CamTable {
    /// Identifies the columns, from the first line if that is a header.
    fn columns(&mut self, options: &TableOptions, first: &TableLine, lines: &[TableLine]) -> Columns {
        let cells: Vec<&str> = first.cells.iter().map(String::as_str).collect();
        let count = lines.iter().map(|line| line.cells.len()).max().unwrap_or_default();
        // A line without any number is a header.
        self.header = !cells.iter().any(|cell| parse_number(cell, true).is_some());
        if !self.header {
            return Columns::from_column_count(count);
        }
        let known = Columns::from_header(&cells);
        if known.is_none() {
            self.notes.push(TableNote::OtherHeader);
        }
        let columns = known.unwrap_or_else(|| Columns::from_column_count(count));
        let mut missing =
            [Column::Start, Column::Stop].into_iter().filter(|column| columns.index_of(*column).is_none());
        if let Some(column) = missing.next() {
            self.problems.push(TableProblem {
                line: first.number,
                column: 1,
                kind: TableProblemKind::NoColumn(column),
            });
        }
        let named = [Column::Start, Column::Stop].into_iter().filter_map(|column| cells.get(columns.index_of(column)?));
        let used = options.scale.unit();
        if let Some(header) = named.filter_map(|cell| columns::unit(cell)).find(|unit| *unit != used) {
            self.notes.push(TableNote::OtherUnit { header, used });
        }
        columns
    }

    /// Assigns a cam to each row. Cams named by a row are assigned first, and the remaining cams go to the other rows.
    fn assign_cams(&mut self, drafts: Vec<DraftRow>) {
        let mut taken: Vec<(ProgramNumber, CamNumber, u64)> = Vec::new();
        let mut rows: Vec<Option<CamNumber>> = vec![None; drafts.len()];
        let wrong = |draft: &DraftRow, what| TableProblem { line: draft.line, column: draft.column, kind: what };
        for (draft, own) in drafts.iter().zip(&mut rows) {
            let Some(cam) = draft.cam else { continue };
            let earlier = taken.iter().find(|(program, number, _)| (*program, *number) == (draft.program, cam));
            match earlier.map(|(.., line)| *line) {
                Some(first) => {
                    self.problems.push(wrong(draft, TableProblemKind::Twice { program: draft.program, cam, first }));
                }
                None => {
                    taken.push((draft.program, cam, draft.line));
                    *own = Some(cam);
                }
            }
        }
        for (draft, own) in drafts.iter().zip(&mut rows).filter(|(draft, _)| draft.cam.is_none()) {
            let is_free =
                |cam: &CamNumber| !taken.iter().any(|(program, own, _)| (*program, *own) == (draft.program, *cam));
            *own = CamNumber::all().find(is_free);
            match own {
                Some(cam) => taken.push((draft.program, *cam, draft.line)),
                None => self.problems.push(wrong(draft, TableProblemKind::Full(draft.program))),
            }
        }
        let placed = drafts.into_iter().zip(rows).filter_map(|(draft, cam)| {
            let DraftRow { line, program, name, start, stop, .. } = draft;
            Some(TableRow { line, program, cam: cam?, name, start, stop })
        });
        self.rows = placed.collect();
    }

    /// Adds a note for each name shared by several pulses, because each pulse uses a separate cam.
    fn note_multi_cam_names(&mut self) {
        for program in ProgramNumber::all() {
            let mut tracks: Vec<(String, String, Vec<CamNumber>)> = Vec::new();
            for row in self.rows.iter().filter(|row| row.program == program && !row.name.is_empty()) {
                let track = row.name.to_lowercase();
                match tracks.iter_mut().find(|(own, ..)| *own == track) {
                    Some((.., cams)) => cams.push(row.cam),
                    None => tracks.push((track, row.name.clone(), vec![row.cam])),
                }
            }
            let several = tracks.into_iter().filter(|(.., cams)| cams.len() > 1);
            self.notes.extend(several.map(|(_, name, cams)| TableNote::Pulses { program, name, cams }));
        }
    }
}

fn split(text: &str, delimiter: Delimiter) -> Vec<TableLine> {
    let mut lines = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        // Each line is parsed as a row, so an unclosed quote affects only one line.
        let cells = split_cells(&mut ReaderBuilder::new().delimiter(delimiter.byte()).build(), line);
        if cells.iter().any(|cell| !cell.is_empty()) {
            lines.push(TableLine { number, cells });
        }
    }
    lines
}

/// Splits a line into cells, and removes quotes and surrounding blanks.
fn split_cells(reader: &mut Reader, line: &str) -> Vec<String> {
    // Since quotes are removed, the output is not longer than the input and has no more ends than characters.
    let (mut out, mut ends) = (vec![0; line.len() + 1], vec![0; line.len() + 2]);
    let (mut read, mut written, mut ended) = (0, 0, 0);
    loop {
        // An empty input tells the parser that the row has ended.
        let input = line.as_bytes().get(read..).unwrap_or_default();
        let (Some(room), Some(marks)) = (out.get_mut(written..), ends.get_mut(ended..)) else { break };
        let (result, taken, wrote, fields) = reader.read_record(input, room, marks);
        (read, written, ended) = (read + taken, written + wrote, ended + fields);
        if !matches!(result, ReadRecordResult::InputEmpty) || taken == 0 {
            break;
        }
    }
    let text = out.get(..written).unwrap_or_default();
    let mut begin = 0;
    let cells = ends.iter().take(ended).map(|end| {
        let cell = text.get(begin..*end).unwrap_or_default();
        begin = *end;
        String::from_utf8_lossy(cell).trim().to_owned()
    });
    cells.collect()
}

fn parse_draft(
    options: &TableOptions,
    columns: &Columns,
    line: &TableLine,
    comma: bool,
) -> Result<DraftRow, TableProblem> {
    let at = |column| columns.index_of(column).map_or(1, |place| place as u64 + 1);
    let wrong = |column, what| TableProblem { line: line.number, column: at(column), kind: what };
    let cell = |column| columns.index_of(column).and_then(|place| line.cells.get(place)).map_or("", String::as_str);
    let program = match cell(Column::Program) {
        "" => options.program,
        text => {
            let own = parse_whole(text, &["program", "programm", "p"])
                .and_then(|own| ProgramNumber::new(u8::try_from(own).ok()?));
            own.ok_or_else(|| wrong(Column::Program, TableProblemKind::Program { text: text_excerpt(text) }))?
        }
    };
    let (mut cam, mut name) = (None, cell(Column::Name).to_owned());
    let text = cell(Column::Cam);
    match parse_whole(text, &["cam", "nocken", "nocke"]) {
        Some(own) => {
            let own = u8::try_from(own).ok().and_then(CamNumber::new);
            cam = Some(own.ok_or_else(|| wrong(Column::Cam, TableProblemKind::Cam { text: text_excerpt(text) }))?);
        }
        None if text.is_empty() => {}
        None if columns.cam_or_name => text.clone_into(&mut name),
        None => return Err(wrong(Column::Cam, TableProblemKind::Cam { text: text_excerpt(text) })),
    }
    if name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
        let column = if columns.cam_or_name { Column::Cam } else { Column::Name };
        return Err(wrong(column, TableProblemKind::Name { most: LONGEST_NAME }));
    }
    let value = |column| match cell(column) {
        "" => Err(wrong(column, TableProblemKind::Missing(column))),
        text => parse_number(text, comma)
            .ok_or_else(|| wrong(column, TableProblemKind::Number { text: text_excerpt(text) })),
    };
    let (start, stop) = (value(Column::Start)?, value(Column::Stop)?);
    let outside = |column| move |outside| wrong(column, TableProblemKind::Outside { column, outside });
    let (start, stop) = parse_edges(options, start, stop, outside(Column::Start), outside(Column::Stop))?;
    let column = if columns.index_of(Column::Cam).is_some() { at(Column::Cam) } else { at(Column::Name) };
    Ok(DraftRow { line: line.number, column, program, cam, name, start, stop })
}

/// Returns both edges in steps. If a pulse spans the whole range, it stops one step before its start.
fn parse_edges(
    options: &TableOptions,
    start: f64,
    stop: f64,
    start_outside: impl Fn(OutsideRangeError) -> TableProblem,
    stop_outside: impl Fn(OutsideRangeError) -> TableProblem,
) -> Result<(TableEdge, TableEdge), TableProblem> {
    let (scale, range) = (&options.scale, options.range);
    let edge = |requested, RoundedPosition { step, off }| TableEdge { requested, step, off };
    let first = scale.round_position(start, range).map_err(start_outside)?;
    let span = scale.range_length(range);
    let one = span / f64::from(range.max(1));
    if scale.wraps_around(range) && scale.unit() != Unit::Steps && (stop - start - span).abs() < one / 2.0 {
        let step = first.step.checked_sub(1).unwrap_or(range.saturating_sub(1));
        let off = start + first.off + span - one - stop;
        return Ok((edge(start, first), TableEdge { requested: stop, step, off }));
    }
    let last = scale.round_position(stop, range).map_err(stop_outside)?;
    Ok((edge(start, first), edge(stop, last)))
}

/// Parses a number, optionally followed by a unit. A decimal comma is accepted only if `comma` is set.
fn parse_number(text: &str, comma: bool) -> Option<f64> {
    let text = text.trim();
    let text =
        ["°", "mm", "deg", "Grad", "grad"].iter().find_map(|unit| text.strip_suffix(unit)).unwrap_or(text).trim_end();
    let text = text.replace('−', "-");
    let text = if comma { text.replace(',', ".") } else { text };
    // The number parser would accept words such as `inf`.
    let is_plain = text.bytes().all(|c| c.is_ascii_digit() || matches!(c, b'.' | b'-' | b'+' | b'e' | b'E'));
    text.parse().ok().filter(|value: &f64| is_plain && value.is_finite())
}

/// Parses a whole number, optionally preceded by one of the given words.
fn parse_whole(text: &str, words: &[&str]) -> Option<u64> {
    let text = text.trim().to_lowercase();
    let bare = words.iter().find_map(|word| text.strip_prefix(word)).map_or(text.as_str(), str::trim);
    // Only digits are accepted, because 1e3 may be a name.
    let is_whole = !bare.is_empty() && bare.bytes().all(|c| c.is_ascii_digit());
    bare.parse().ok().filter(|_| is_whole)
}

fn text_excerpt(text: &str) -> String {
    let mut excerpt: String = text.chars().filter(|c| !c.is_control()).take(MAX_EXCERPT_CHARS).collect();
    if text.chars().count() > MAX_EXCERPT_CHARS {
        excerpt.push('…');
    }
    excerpt
}

/// A table has room for every cam of every program.
const _: () = assert!(MAX_ROWS >= Program::CAMS * ProgramNumber::COUNT);
