//! From the bytes of a table to samples: split by csv-core, numbers by fast-float2, no text kept of any field. The channels
//! are those of SICK 8010701.

use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

use super::detect::{HEAD, Layout, Wishes};
use super::header::Columns;
use super::{Capture, CaptureError, Wires};

/// A table that is being read.
#[derive(Debug)]
pub struct Import {
    layout: Layout,
    reader: Reader,
    /// The row so far, without delimiters and quotes, and where its fields end.
    row: Vec<u8>,
    written: usize,
    ends: Vec<usize>,
    ended: usize,
    last: Option<u8>,
    begun: bool,
    taken: Taken,
    capture: Capture,
}

/// Columns from 0, and factors.
#[derive(Clone, Copy, Debug)]
struct Taken {
    columns: Columns,
    seconds: f64,
    volts: f64,
    comma: bool,
}

/// What a field is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    Finite(f64),
    NotFinite,
    Text,
}

/// Longest row. What is longer is no table.
const LONGEST_ROW: usize = 1 << 20;
/// Letters of a wrong field that are told.
const SHOWN: usize = 24;

impl Import {
    /// Begins with the first bytes of a table ([`HEAD`] of them, or all there are), which are only looked at: they are
    /// to be [fed](Self::feed) as well.
    ///
    /// # Errors
    /// As [`Layout::detect`].
    pub fn begin(head: &[u8], wishes: &Wishes) -> Result<Self, CaptureError> {
        let head = head.get(..HEAD).unwrap_or(head);
        Ok(Import::with(Layout::detect(head, wishes)?))
    }

    /// Begins with a layout that is known.
    pub fn with(layout: Layout) -> Self {
        let taken = Taken {
            columns: layout.columns,
            seconds: layout.time_unit.factor(),
            volts: layout.volts_per_unit,
            comma: layout.decimal_comma,
        };
        let capture = Capture {
            wires: layout.columns.references.map(|_| Wires::default()),
            reference_deg: layout.columns.reference_angle.map(|_| Vec::new()),
            absolute: layout.columns.absolute.map(|_| Vec::new()),
            ..Capture::default()
        };
        Import {
            reader: ReaderBuilder::new().delimiter(layout.delimiter.byte()).build(),
            layout,
            row: vec![0; 1024],
            written: 0,
            ends: vec![0; 64],
            ended: 0,
            last: None,
            begun: false,
            taken,
            capture,
        }
    }

    /// How the table is read.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.capture.sine_v.len()
    }

    /// Takes the next bytes, from the beginning of the file on, in pieces of any size.
    ///
    /// # Errors
    /// [`CaptureError`] with the row and the column.
    pub fn feed(&mut self, bytes: &[u8]) -> Result<(), CaptureError> {
        let mut rest = bytes;
        if !self.begun && !rest.is_empty() {
            self.begun = true;
            rest = rest.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(rest);
        }
        while !rest.is_empty() {
            let used = self.step(rest)?;
            rest = rest.get(used..).unwrap_or_default();
        }
        Ok(())
    }

    /// The samples, after the last bytes.
    ///
    /// # Errors
    /// Where the last row is broken, or none had numbers.
    pub fn finish(mut self) -> Result<(Layout, Capture), CaptureError> {
        // No more bytes: a row without an end of line ends here.
        self.step(&[])?;
        if self.capture.sine_v.is_empty() { Err(CaptureError::NoNumbers) } else { Ok((self.layout, self.capture)) }
    }

    /// One call of the splitter; bytes used.
    fn step(&mut self, bytes: &[u8]) -> Result<usize, CaptureError> {
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
            ReadRecordResult::OutputFull | ReadRecordResult::OutputEndsFull => return Err(CaptureError::NoNumbers),
            ReadRecordResult::Record => {
                let ends = self.ends.get(..self.ended).unwrap_or_default();
                // After a row that ended with its line break, the splitter is in the next line.
                let line = self.reader.line() - u64::from(self.last == Some(b'\n'));
                if line >= self.layout.first_row {
                    self.taken.take(&mut self.row, ends, line, &mut self.capture)?;
                }
                (self.written, self.ended) = (0, 0);
            }
            ReadRecordResult::InputEmpty | ReadRecordResult::End => {}
        }
        Ok(used)
    }
}

impl Taken {
    fn take(&self, row: &mut [u8], ends: &[usize], line: u64, capture: &mut Capture) -> Result<(), CaptureError> {
        if ends.len() == 1
            && row.get(..ends.first().copied().unwrap_or(0)).is_some_and(|row| row.trim_ascii().is_empty())
        {
            return Ok(());
        }
        let mut value = |column: usize| self.value(row, ends, line, column);
        let time = self.columns.time.map(&mut value).transpose()?;
        let mut sine = value(self.columns.sine)? * self.volts;
        let mut cosine = value(self.columns.cosine)? * self.volts;
        if let (Some((refsin, refcos)), Some(wires)) = (self.columns.references, &mut capture.wires) {
            let (refsin, refcos) = (value(refsin)? * self.volts, value(refcos)? * self.volts);
            wires.sin_v.push(sine);
            wires.refsin_v.push(refsin);
            wires.cos_v.push(cosine);
            wires.refcos_v.push(refcos);
            (sine, cosine) = (sine - refsin, cosine - refcos);
        }
        if let (Some(column), Some(kept)) = (self.columns.reference_angle, &mut capture.reference_deg) {
            kept.push(value(column)?);
        }
        if let (Some(column), Some(kept)) = (self.columns.absolute, &mut capture.absolute) {
            let steps = value(column)?;
            let not_whole = || CaptureError::NotWhole { row: line, column, text: steps.to_string() };
            kept.push(whole(steps).ok_or_else(not_whole)?);
        }
        capture.time_s.extend(time.map(|time| time * self.seconds));
        capture.sine_v.push(sine);
        capture.cosine_v.push(cosine);
        Ok(())
    }

    fn value(&self, row: &mut [u8], ends: &[usize], line: u64, column: usize) -> Result<f64, CaptureError> {
        let at = column.saturating_sub(1);
        let start = at.checked_sub(1).and_then(|before| ends.get(before)).copied().unwrap_or(0);
        let short = || CaptureError::ShortRow { row: line, columns: ends.len(), needed: self.columns.last() };
        let end = *ends.get(at).ok_or_else(short)?;
        let field = row.get(start..end).unwrap_or_default().trim_ascii();
        match number(field, self.comma) {
            Number::Finite(value) => Ok(value),
            Number::NotFinite => Err(CaptureError::NotFinite { row: line, column, text: shown(field) }),
            Number::Text => Err(CaptureError::NotANumber { row: line, column, text: shown(field) }),
        }
    }
}

/// The whole number that a value is; nothing beyond 2⁵³, where not every number can be told from the next.
pub(super) fn whole(value: f64) -> Option<i64> {
    const MOST: f64 = (1_i64 << 53) as f64;
    (value.fract() == 0.0 && value.abs() <= MOST).then_some(value as i64)
}

/// Reads a field without spaces around it.
pub(super) fn number(field: &[u8], comma: bool) -> Number {
    let field = field.strip_prefix(b"+").filter(|rest| rest.first() != Some(&b'-')).unwrap_or(field);
    let parsed = match field.iter().position(|byte| *byte == b',') {
        Some(at) if comma => with_point(field, at),
        _ => fast_float2::parse::<f64, _>(field).ok(),
    };
    match parsed {
        Some(value) if value.is_finite() => Number::Finite(value),
        Some(_) => Number::NotFinite,
        None => Number::Text,
    }
}

fn with_point(field: &[u8], comma: usize) -> Option<f64> {
    /// More digits than a double has, with sign and exponent.
    const LONGEST: usize = 64;
    let mut copy = [0; LONGEST];
    let copy = copy.get_mut(..field.len())?;
    copy.copy_from_slice(field);
    *copy.get_mut(comma)? = b'.';
    fast_float2::parse(copy).ok()
}

fn shown(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    let short: String = text.chars().take(SHOWN).collect();
    if short.len() < text.len() { short + "…" } else { short }
}
