//! Conversion of a table's bytes to samples without storing the text of the fields: csv-core splits the fields, and
//! fast-float2 parses the numbers. The channels are those of SICK 8010701.

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

use super::detect::{HEAD_BYTES, Layout, TableHints};
use super::encoding::Utf8Decoder;
use super::header::Columns;
use super::{Capture, CaptureError, Wires};

#[derive(Debug)]
pub struct TableImport {
    layout: Layout,
    reader: Reader,
    /// Fields of the current row, without delimiters and quotes. `ends` holds the end of each field.
    row: Vec<u8>,
    written: usize,
    ends: Vec<usize>,
    ended: usize,
    last: Option<u8>,
    decoder: Utf8Decoder,
    /// Line number of the first skipped row, and the error for its missing value.
    first_left_out: Option<(u64, CaptureError)>,
    taken: ColumnChoice,
    capture: Capture,
}

#[derive(Clone, Copy, Debug)]
struct ColumnChoice {
    columns: Columns,
    /// Start time, and length of the time column's unit, both in seconds.
    seconds: (f64, f64),
    volts: f64,
    comma: bool,
    counts: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CellNumber {
    Finite(f64),
    NotFinite,
    Text,
}

/// Maximum length of a row in bytes. Input with a longer row is not a table.
const LONGEST_ROW: usize = 1 << 20;
/// Minimum number of rows in a capture. A shorter table is rejected at its first missing value.
const MIN_ROWS: u64 = 6;
/// Maximum number of characters of an invalid field shown in a message.
const MAX_EXCERPT_CHARS: usize = 24;

impl TableImport {
    /// Begins an import with the first [`HEAD_BYTES`] bytes of a table, or with the whole of a shorter table. The bytes
    /// are only examined, and must also be passed to [`process`](Self::process).
    ///
    /// # Errors
    /// Returns the same errors as [`Layout::detect`].
    pub fn from_head(head: &[u8], hints: &TableHints) -> Result<Self, CaptureError> {
        let head = head.get(..HEAD_BYTES).unwrap_or(head);
        let import = TableImport::with_layout(Layout::detect(head, hints)?);
        Ok(TableImport { decoder: Utf8Decoder::detect(head), ..import })
    }

    pub fn with_layout(layout: Layout) -> Self {
        let taken = ColumnChoice {
            columns: layout.columns,
            seconds: match layout.clock {
                Some(clock) => (clock.start_s, clock.increment_s),
                None => (0.0, layout.time_unit.factor()),
            },
            volts: layout.volts_per_unit,
            comma: layout.decimal_comma,
            counts: layout.clock.is_some(),
        };
        let capture = Capture {
            wires: layout.columns.references.map(|_| Wires::default()),
            reference_deg: layout.columns.reference_angle.map(|_| Vec::new()),
            absolute: layout.columns.absolute.map(|_| Vec::new()),
            ..Capture::default()
        };
        TableImport {
            reader: ReaderBuilder::new().delimiter(layout.delimiter.byte()).build(),
            layout,
            row: vec![0; 1024],
            written: 0,
            ends: vec![0; 64],
            ended: 0,
            last: None,
            decoder: Utf8Decoder::detect(&[]),
            first_left_out: None,
            taken,
            capture,
        }
    }

    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    pub fn rows(&self) -> usize {
        self.capture.sine_v.len()
    }

    /// Processes the next bytes, in pieces of any size, from the beginning of the file.
    ///
    /// # Errors
    /// Returns a [`CaptureError`] that names the row and the column.
    pub fn process(&mut self, bytes: &[u8]) -> Result<(), CaptureError> {
        let decoded = self.decoder.decode(bytes);
        let mut rest = &*decoded;
        while !rest.is_empty() {
            let used = self.split_next_row(rest)?;
            rest = rest.get(used..).unwrap_or_default();
        }
        Ok(())
    }

    /// Completes the import and returns the samples.
    ///
    /// # Errors
    /// Returns an error if no row contains numbers, or if most rows have no value.
    pub fn finish(mut self) -> Result<(Layout, Capture), CaptureError> {
        // An unclosed quotation mark turns everything after it into one row, none of which was truncated.
        if self.last != Some(b'"') && self.lines_in_row() > 0 {
            return Err(self.open_quote());
        }
        // End of the input: a row without a line end stops at this point and may be truncated.
        if let Err(error) = self.split_next_row(&[]) {
            self.skip_row(self.reader.line(), error);
        }
        let (taken, skipped_rows) = (self.capture.sine_v.len() as u64, self.capture.skipped_rows);
        match self.first_left_out {
            Some((_, error)) if taken < MIN_ROWS => Err(error),
            Some((row, _)) if skipped_rows > taken => {
                Err(CaptureError::NoValues { skipped_rows, rows: taken + skipped_rows, row })
            }
            _ if taken == 0 => Err(CaptureError::NoNumbers),
            _ => Ok((self.layout, self.capture)),
        }
    }

    /// Returns the number of line breaks in the incomplete row. All of them are inside quotation marks.
    fn lines_in_row(&self) -> usize {
        let row = self.row.get(..self.written).unwrap_or_default();
        row.iter().filter(|byte| **byte == b'\n').count()
    }

    fn open_quote(&self) -> CaptureError {
        CaptureError::OpenQuote { row: self.reader.line().saturating_sub(self.lines_in_row() as u64) }
    }

    fn skip_row(&mut self, row: u64, why: CaptureError) {
        self.capture.skipped_rows += 1;
        self.first_left_out.get_or_insert((row, why));
    }

    /// Calls the CSV splitter once and returns the number of bytes that it has used.
    fn split_next_row(&mut self, bytes: &[u8]) -> Result<usize, CaptureError> {
        let row = self.row.get_mut(self.written..).unwrap_or_default();
        let ends = self.ends.get_mut(self.ended..).unwrap_or_default();
        let (result, used, written, ended) = self.reader.read_record(bytes, row, ends);
        self.written += written;
        self.ended += ended;
        if let Some(last) = used.checked_sub(1).and_then(|last| bytes.get(last)) {
            self.last = Some(*last);
        }
        match result {
            ReadRecordResult::OutputFull if self.row.len() < LONGEST_ROW => self.row.resize(self.row.len() * 2, 0),
            ReadRecordResult::OutputEndsFull if self.ends.len() < LONGEST_ROW => {
                self.ends.resize(self.ends.len() * 2, 0);
            }
            ReadRecordResult::OutputFull if self.lines_in_row() > 0 => return Err(self.open_quote()),
            ReadRecordResult::OutputFull | ReadRecordResult::OutputEndsFull => return Err(CaptureError::NoNumbers),
            ReadRecordResult::Record => {
                let ends = self.ends.get(..self.ended).unwrap_or_default();
                // After a row that ended with a line break, the splitter is already on the next line.
                let line = self.reader.line() - u64::from(self.last == Some(b'\n'));
                if line >= self.layout.first_row
                    && let Some(missing) = self.taken.append_row(&self.row, ends, line, &mut self.capture)?
                {
                    self.skip_row(line, missing);
                }
                (self.written, self.ended) = (0, 0);
            }
            ReadRecordResult::InputEmpty | ReadRecordResult::End => {}
        }
        Ok(used)
    }
}

impl ColumnChoice {
    /// Adds a row to the capture. Returns the error for the missing value if the row is skipped.
    fn append_row(
        &self,
        row: &[u8],
        ends: &[usize],
        line: u64,
        capture: &mut Capture,
    ) -> Result<Option<CaptureError>, CaptureError> {
        if ends.len() == 1
            && row.get(..ends.first().copied().unwrap_or(0)).is_some_and(|row| row.trim_ascii().is_empty())
        {
            return Ok(None);
        }
        let columns = &self.columns;
        // Every row needs a time. A table without it is broken.
        let time = columns.time.map(|column| self.time(row, ends, line, column)).transpose()?;
        let (refsin, refcos) = columns.references.unzip();
        let taken =
            [Some(columns.sine), Some(columns.cosine), refsin, refcos, columns.reference_angle, columns.absolute];
        let mut values = [None; 6];
        for (own, column) in values.iter_mut().zip(taken) {
            let Some(column) = column else { continue };
            match self.value(row, ends, line, column)? {
                Ok(value) => *own = Some(value),
                Err(missing) => return Ok(Some(missing)),
            }
        }
        let [sine, cosine, refsin, refcos, angle, steps] = values;
        let (sine, cosine) = (sine.unwrap_or_default(), cosine.unwrap_or_default());
        let steps = match (steps, columns.absolute) {
            (Some(steps), Some(column)) => {
                let not_whole = || CaptureError::NotWhole { row: line, column, text: steps.to_string() };
                Some(to_integer(steps).ok_or_else(not_whole)?)
            }
            _ => None,
        };
        let (mut sine, mut cosine) = (sine * self.volts, cosine * self.volts);
        if let (Some(refsin), Some(refcos), Some(wires)) = (refsin, refcos, &mut capture.wires) {
            let (refsin, refcos) = (refsin * self.volts, refcos * self.volts);
            wires.sin_v.push(sine);
            wires.refsin_v.push(refsin);
            wires.cos_v.push(cosine);
            wires.refcos_v.push(refcos);
            (sine, cosine) = (sine - refsin, cosine - refcos);
        }
        if let (Some(angle), Some(kept)) = (angle, &mut capture.reference_deg) {
            kept.push(angle);
        }
        if let (Some(steps), Some(kept)) = (steps, &mut capture.absolute) {
            kept.push(steps);
        }
        let (start, per_unit) = self.seconds;
        capture.time_s.extend(time.map(|time| start + time * per_unit));
        capture.sine_v.push(sine);
        capture.cosine_v.push(cosine);
        Ok(None)
    }

    fn time(&self, row: &[u8], ends: &[usize], line: u64, column: usize) -> Result<f64, CaptureError> {
        let field = self.field(row, ends, line, column)?;
        match parse_number(field, self.comma) {
            CellNumber::Finite(value) if self.counts && to_integer(value).is_none() => {
                Err(CaptureError::NotASampleNumber { row: line, column, text: display_field(field) })
            }
            CellNumber::Finite(value) => Ok(value),
            CellNumber::NotFinite => Err(CaptureError::NotFinite { row: line, column, text: display_field(field) }),
            CellNumber::Text => Err(CaptureError::NotANumber { row: line, column, text: display_field(field) }),
        }
    }

    /// Parses a value. The inner error means that the instrument has recorded no value.
    fn value(
        &self,
        row: &[u8],
        ends: &[usize],
        line: u64,
        column: usize,
    ) -> Result<Result<f64, CaptureError>, CaptureError> {
        let field = self.field(row, ends, line, column)?;
        let not_a_number = || CaptureError::NotANumber { row: line, column, text: display_field(field) };
        match parse_number(field, self.comma) {
            CellNumber::Finite(value) => Ok(Ok(value)),
            CellNumber::NotFinite => Ok(Err(CaptureError::NotFinite { row: line, column, text: display_field(field) })),
            CellNumber::Text if is_missing_value(field) => Ok(Err(not_a_number())),
            CellNumber::Text => Err(not_a_number()),
        }
    }

    /// Returns the field of a row in the given column, without surrounding spaces.
    fn field<'r>(&self, row: &'r [u8], ends: &[usize], line: u64, column: usize) -> Result<&'r [u8], CaptureError> {
        let at = column.saturating_sub(1);
        let start = at.checked_sub(1).and_then(|before| ends.get(before)).copied().unwrap_or(0);
        let short = || CaptureError::ShortRow { row: line, columns: ends.len(), needed: self.columns.last() };
        let end = *ends.get(at).ok_or_else(short)?;
        Ok(row.get(start..end).unwrap_or_default().trim_ascii())
    }
}

/// Returns whether a field marks a missing value in the notation of an instrument. Such a field is empty, has only
/// dashes, or reports an overload.
pub(super) fn is_missing_value(field: &[u8]) -> bool {
    const MISSING_VALUE_MARKERS: [&str; 10] =
        ["overload", "overrange", "overflow", "ovld", "ol", "over", "clipped", "\u{221e}", "-\u{221e}", "n/a"];
    let text = String::from_utf8_lossy(field).to_lowercase();
    text.chars().all(|sign| matches!(sign, '-' | '*' | '?')) && text.len() != 1
        || MISSING_VALUE_MARKERS.contains(&text.as_str())
}

/// Returns the value as an integer. Returns `None` beyond 2⁵³, where an `f64` cannot hold every integer.
pub(super) fn to_integer(value: f64) -> Option<i64> {
    const MAX_EXACT_INTEGER: f64 = (1_i64 << 53) as f64;
    (value.fract() == 0.0 && value.abs() <= MAX_EXACT_INTEGER).then_some(value as i64)
}

/// Values that SCPI instruments send for an overload (9.9E37) and for "not a number" (9.91E37). See SCPI-99, 7.2.1.
const NO_VALUE: std::ops::RangeInclusive<f64> = 9.9e37..=9.91e37;

/// Parses a field that has no surrounding spaces.
pub(super) fn parse_number(field: &[u8], comma: bool) -> CellNumber {
    let field = field.strip_prefix(b"+").filter(|rest| rest.first() != Some(&b'-')).unwrap_or(field);
    let parsed = match field.iter().position(|byte| *byte == b',') {
        Some(at) if comma => parse_with_decimal_comma(field, at),
        _ => fast_float2::parse::<f64, _>(field).ok(),
    };
    match parsed {
        Some(value) if value.is_finite() && !NO_VALUE.contains(&value.abs()) => CellNumber::Finite(value),
        Some(_) => CellNumber::NotFinite,
        None => CellNumber::Text,
    }
}

fn parse_with_decimal_comma(field: &[u8], comma: usize) -> Option<f64> {
    /// Maximum length of a number in bytes. No `f64` needs as many digits, including its sign and exponent.
    const MAX_NUMBER_LEN: usize = 64;
    let mut copy = [0; MAX_NUMBER_LEN];
    let copy = copy.get_mut(..field.len())?;
    copy.copy_from_slice(field);
    *copy.get_mut(comma)? = b'.';
    fast_float2::parse(copy).ok()
}

fn display_field(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    let short: String = text.chars().take(MAX_EXCERPT_CHARS).collect();
    if short.len() < text.len() { short + "…" } else { short }
}
