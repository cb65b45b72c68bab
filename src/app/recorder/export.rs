//! Export of samples as CSV. A thread receives the rows in batches and writes them, so that neither the window nor the
//! recording waits for the disk.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};

use super::line::within_range;
use super::{GroupId, Recorder, Series, UNTIMED_SAMPLE_INTERVAL_NS};
use crate::analysis::SampleTime;
use crate::analysis::history::{Flags, History};
use crate::store::{FileError, write_atomically_with};

/// Number of rows in a batch.
const ROWS: usize = 16_384;
const QUEUED_CHUNKS: usize = 2;

/// A running export to a table. If it is dropped before all rows have been passed on, no file is written.
#[derive(Debug)]
pub struct TableExport {
    pub path: PathBuf,
    number: ExportNumber,
    cancelled: Arc<AtomicBool>,
    written: Arc<AtomicU64>,
    total: u64,
    sender: Option<Sender<Chunk>>,
    next: Option<Chunk>,
    heads: Vec<ExportPosition>,
    columns: Vec<Column>,
    lost: u64,
    /// Time up to which the recording is exported, or `None` for an export of the visible part only.
    until: Option<SampleTime>,
}

/// The number of an export, unique within the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) struct ExportNumber(u64);

impl ExportNumber {
    fn new() -> Self {
        static NEXT_NUMBER: AtomicU64 = AtomicU64::new(0);
        ExportNumber(NEXT_NUMBER.fetch_add(1, Ordering::Relaxed))
    }
}

#[derive(Debug)]
pub struct ExportResult {
    pub(in crate::app) number: ExportNumber,
    pub path: PathBuf,
    /// Number of rows, or `None` if the export was cancelled and no file was written.
    pub rows: Result<Option<u64>, FileError>,
}

/// How far the samples of a group have been passed on to the export thread.
#[derive(Debug)]
struct ExportPosition {
    group: GroupId,
    next: u64,
    end: u64,
}

#[derive(Clone, Debug)]
struct Column {
    heading: String,
    head: usize,
    column: usize,
    factor: f64,
    range: Option<i64>,
    /// Whether the values are calculated from another line. A missing value then does not indicate a faulty sample.
    derived: bool,
}

#[derive(Debug)]
enum Chunk {
    Rows(Rows),
    /// Marks the end of the samples. Without it, the table is incomplete.
    End,
}

/// Rows of a table, each with a time and one cell per column.
#[derive(Debug, Default)]
struct Rows {
    times: Vec<SampleTime>,
    cells: Vec<Cell>,
}

/// A cell of a table. It is empty if the line has no sample at that time, and its sample may be invalid.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    value: Option<f64>,
    flags: Flags,
}

/// The part of an export that runs on a thread and writes rows as they arrive.
pub(in crate::app) struct ExportWriter {
    path: PathBuf,
    number: ExportNumber,
    counts: bool,
    headings: Vec<String>,
    receiver: Receiver<Chunk>,
    cancelled: Arc<AtomicBool>,
    written: Arc<AtomicU64>,
}

impl TableExport {
    pub fn progress(&self) -> (u64, u64) {
        (self.written.load(Ordering::Relaxed).min(self.total), self.total)
    }

    /// Returns the number of samples that were dropped from the recording before they could be written.
    pub fn dropped_samples(&self) -> u64 {
        self.lost
    }

    pub(super) fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

impl Recorder {
    pub fn export(&self) -> Option<&TableExport> {
        self.export.as_ref()
    }

    /// Starts to write a table of the displayed lines, for either the visible part or the whole recording.
    ///
    /// Returns the part that runs on a thread; [`pass_rows_to_export`](Self::pass_rows_to_export) supplies it with
    /// rows. Returns `None` if there is nothing to write or if another table is being written.
    pub(in crate::app) fn begin_export(&mut self, path: &Path, visible: bool) -> Option<ExportWriter> {
        if self.export.is_some() {
            return None;
        }
        let (from, to) = self.window_bounds();
        let mut heads: Vec<ExportPosition> = Vec::new();
        let mut columns = Vec::new();
        for line in self.selected_series().filter(|line| !visible || self.visible_series().any(|own| own.id == line.id))
        {
            let history = self.history(line)?;
            let range =
                if visible { history.indices_between(from, to.saturating_add_ns(1)) } else { history.indices() };
            let head = heads.iter().position(|head| head.group == line.group).unwrap_or(heads.len());
            if head == heads.len() {
                heads.push(ExportPosition { group: line.group, next: range.start, end: range.end });
            }
            columns.push(Column {
                heading: column_heading(line),
                head,
                column: line.column,
                factor: line.factor(),
                range: line.sample_wrap_range(),
                derived: line.derived,
            });
        }
        let total = heads.iter().map(|head| head.end.saturating_sub(head.next)).sum();
        if total == 0 {
            return None;
        }
        let (sender, receiver) = bounded(QUEUED_CHUNKS);
        let (cancelled, written) = (Arc::<AtomicBool>::default(), Arc::<AtomicU64>::default());
        let headings = columns.iter().map(|column: &Column| column.heading.clone()).collect();
        let number = ExportNumber::new();
        let writing = ExportWriter {
            path: path.to_owned(),
            number,
            counts: self.counts,
            headings,
            receiver,
            cancelled: cancelled.clone(),
            written: written.clone(),
        };
        self.export = Some(TableExport {
            path: path.to_owned(),
            number,
            cancelled,
            written,
            total,
            sender: Some(sender),
            next: None,
            heads,
            columns,
            lost: 0,
            until: self.recorded_span().map(|(_, last)| last).filter(|_| !visible),
        });
        self.pass_rows_to_export();
        Some(writing)
    }

    /// Passes on as many rows as possible without blocking. Called between two frames.
    pub(in crate::app) fn pass_rows_to_export(&mut self) {
        let Some(mut export) = self.export.take() else { return };
        if let Some(sender) = export.sender.clone() {
            let portion = match export.next.take() {
                Some(portion) => portion,
                None => self.next_rows(&mut export.heads, &export.columns, &mut export.lost),
            };
            let is_end = matches!(portion, Chunk::End);
            match sender.try_send(portion) {
                Ok(()) if is_end => export.sender = None,
                Ok(()) => {}
                Err(TrySendError::Full(portion)) => export.next = Some(portion),
                // The thread has ended, and reports the reason itself.
                Err(TrySendError::Disconnected(_)) => export.sender = None,
            }
        }
        self.export = Some(export);
    }

    /// Handles the end of the thread. Returns the number of lost samples, or `None` if the thread belongs to an earlier
    /// export.
    pub(in crate::app) fn end_export(&mut self, number: ExportNumber, written: bool) -> Option<u64> {
        let export = self.export.take_if(|export| export.number == number)?;
        if written && export.until.is_some() {
            self.saved = export.until;
        }
        Some(export.lost)
    }

    /// Returns the duration of the unexported part of the recording in nanoseconds.
    pub fn unexported_duration(&self) -> i64 {
        let Some((first, last)) = self.recorded_span() else { return 0 };
        last.nanoseconds_since(self.saved.map_or(first, |saved| saved.max(first)))
    }

    /// Returns the next rows, in chronological order over all groups. Samples with the same time share a row.
    fn next_rows(&self, heads: &mut [ExportPosition], columns: &[Column], lost: &mut u64) -> Chunk {
        // The histories have the order of the heads. A group that was removed no longer has samples.
        let histories: Vec<Option<&History>> =
            heads.iter().map(|head| self.groups.get(&head.group).map(|group| &group.history)).collect();
        for (head, history) in heads.iter_mut().zip(&histories) {
            // Samples that were removed in the meantime are lost.
            let start = history.map_or(head.end, |history| history.indices().start.min(head.end));
            *lost += start.saturating_sub(head.next);
            head.next = head.next.max(start);
        }
        let mut rows = Rows::default();
        let mut due = vec![None; heads.len()];
        while rows.times.len() < ROWS {
            let time = |(head, history): (&ExportPosition, &Option<&History>)| {
                (head.next < head.end).then(|| history.and_then(|history| history.time(head.next))).flatten()
            };
            let Some(now) = heads.iter().zip(&histories).filter_map(time).min() else { break };
            for ((due, head), history) in due.iter_mut().zip(heads.iter_mut()).zip(&histories) {
                *due = (time((&*head, history)) == Some(now)).then_some(head.next);
                head.next += u64::from(due.is_some());
            }
            rows.times.push(now);
            rows.cells.extend(columns.iter().map(|column| export_cell(column, &histories, &due)));
        }
        if rows.times.is_empty() { Chunk::End } else { Chunk::Rows(rows) }
    }
}

fn export_cell(column: &Column, histories: &[Option<&History>], due: &[Option<u64>]) -> Cell {
    let sample = || {
        let index = (*due.get(column.head)?)?;
        (*histories.get(column.head)?)?.sample(column.column, index)
    };
    let Some(sample) = sample() else { return Cell::default() };
    let value = within_range(sample.value, column.range) * column.factor;
    let value = Some(value).filter(|value| value.is_finite() && !sample.flags.contains(Flags::BAD));
    let flags = if column.derived { Flags::NONE } else { sample.flags };
    Cell { value, flags }
}

/// Returns the heading of a column with name and unit. It does not depend on the language of the window.
fn column_heading(line: &Series) -> String {
    match line.scale() {
        Some(scale) => format!("{} [{}]", line.heading, scale.unit.terminal_text()),
        None => line.heading.clone(),
    }
}

impl ExportWriter {
    /// Writes rows until all have arrived. Calls `wake` whenever more rows can be passed on.
    pub(in crate::app) fn run(self, wake: &dyn Fn()) -> ExportResult {
        let mut given_up = false;
        let rows = write_atomically_with(&self.path, |file| {
            given_up = !self.write(file, wake)?;
            // An incomplete table must not replace an existing file.
            if given_up { Err(io::ErrorKind::Interrupted.into()) } else { Ok(()) }
        });
        let rows = match rows {
            Ok(()) => Ok(Some(self.written.load(Ordering::Relaxed))),
            Err(_) if given_up => Ok(None),
            Err(error) => Err(error),
        };
        ExportResult { number: self.number, path: self.path, rows }
    }

    /// Writes the table. Returns `false` if the export was cancelled.
    fn write(&self, file: &mut dyn Write, wake: &dyn Fn()) -> io::Result<bool> {
        let mut text = String::from(if self.counts { "sample" } else { "time [s]" });
        for heading in &self.headings {
            text.push(',');
            // Headings are not quoted, so a comma would start another column.
            text.push_str(&heading.replace([',', '"'], " "));
        }
        text.push_str(",remark\n");
        file.write_all(text.as_bytes())?;
        // Further rows can be passed on now.
        wake();
        for portion in &self.receiver {
            wake();
            if self.cancelled.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let rows = match portion {
                Chunk::Rows(rows) => rows,
                Chunk::End => return Ok(true),
            };
            text.clear();
            rows.text(self.headings.len(), self.counts, &mut text);
            file.write_all(text.as_bytes())?;
            self.written.fetch_add(rows.times.len() as u64, Ordering::Relaxed);
        }
        // The export was dropped before the end of the samples.
        Ok(false)
    }
}

impl Rows {
    fn text(&self, columns: usize, counts: bool, text: &mut String) {
        use std::fmt::Write as _;
        for (time, cells) in self.times.iter().zip(self.cells.chunks(columns.max(1))) {
            let nanoseconds = time.as_nanoseconds();
            let sign = if nanoseconds < 0 { "-" } else { "" };
            let whole = nanoseconds.unsigned_abs();
            // Writing to a string cannot fail.
            let _ = if counts {
                write!(text, "{}", nanoseconds.div_euclid(UNTIMED_SAMPLE_INTERVAL_NS))
            } else {
                write!(text, "{sign}{}.{:09}", whole / 1_000_000_000, whole % 1_000_000_000)
            };
            let mut flags = Flags::NONE;
            for cell in cells {
                flags |= cell.flags;
                text.push(',');
                if let Some(value) = cell.value {
                    let _ = write!(text, "{value}");
                }
            }
            text.push(',');
            text.push_str(flag_remark(flags));
            text.push('\n');
        }
    }
}

/// Returns the most severe flag in a row.
fn flag_remark(flags: Flags) -> &'static str {
    if flags.contains(Flags::BAD) {
        "bad"
    } else if flags.contains(Flags::WARNING) {
        "warning"
    } else if flags.contains(Flags::BREAK) {
        "gap"
    } else {
        ""
    }
}
