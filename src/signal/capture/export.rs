//! From samples to a table of text that the import takes as it is: names with units, numbers with all their digits.
//! Semicolons and decimal commas where the language has them. Files are written elsewhere; here rows become text.

use std::fmt::Write;

use super::Capture;

/// A table to be written.
#[derive(Debug)]
pub struct Export<'a> {
    capture: &'a Capture,
    decimal_comma: bool,
}

impl<'a> Export<'a> {
    /// A table of all columns that the capture has.
    pub fn of(capture: &'a Capture, decimal_comma: bool) -> Self {
        Export { capture, decimal_comma }
    }

    /// Rows below the header.
    pub fn rows(&self) -> usize {
        self.capture.sine_v.len().min(self.capture.cosine_v.len())
    }

    /// The first line. SIN and COS are against ground where the references are known, else they are the differences.
    pub fn header(&self) -> String {
        let Capture { time_s, references_v, reference_deg, absolute, .. } = self.capture;
        let mut names = Vec::new();
        names.extend((!time_s.is_empty()).then_some("time [s]"));
        names.extend_from_slice(match references_v {
            Some(_) => &["SIN [V]", "REFSIN [V]", "COS [V]", "REFCOS [V]"],
            None => &["sine [V]", "cosine [V]"],
        });
        names.extend(reference_deg.as_ref().map(|_| "reference [deg]"));
        names.extend(absolute.as_ref().map(|_| "absolute"));
        names.join(if self.decimal_comma { ";" } else { "," }) + "\n"
    }

    /// Appends a row, from 0; nothing where there is none.
    pub fn row(&self, row: usize, text: &mut String) {
        let Capture { time_s, sine_v, cosine_v, references_v, reference_deg, absolute } = self.capture;
        let (Some(sine), Some(cosine)) = (sine_v.get(row), cosine_v.get(row)) else { return };
        let start = text.len();
        let delimiter = if self.decimal_comma { ';' } else { ',' };
        let mut write = |value: &dyn std::fmt::Display| {
            if text.len() > start {
                text.push(delimiter);
            }
            let from = text.len();
            // Writing to a text cannot fail.
            let _ = write!(text, "{value}");
            if self.decimal_comma
                && let Some(point) = text.get(from..).and_then(|number| number.find('.'))
            {
                text.replace_range(from + point..=from + point, ",");
            }
        };
        if let Some(time) = time_s.get(row) {
            write(time);
        }
        match references_v.as_ref().and_then(|(refsin, refcos)| Some((refsin.get(row)?, refcos.get(row)?))) {
            Some((refsin, refcos)) => {
                [sine + refsin, *refsin, cosine + refcos, *refcos].iter().for_each(|volts| write(volts));
            }
            None => [sine, cosine].into_iter().for_each(|volts| write(volts)),
        }
        if let Some(angle) = reference_deg.as_ref().and_then(|angles| angles.get(row)) {
            write(angle);
        }
        if let Some(steps) = absolute.as_ref().and_then(|positions| positions.get(row)) {
            write(steps);
        }
        text.push('\n');
    }
}
