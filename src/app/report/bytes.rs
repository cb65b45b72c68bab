//! Formats the bytes of a memory for a report.

use std::ops::Range;

use super::ReportContext;
use crate::app::Text;
use crate::bits::{UNPRINTABLE, ascii, hex};
use crate::report::{CellStyle, Table};

const ROW: usize = 16;

/// Formats bytes in rows of 16, with their ASCII text. `address` formats the address of a row, and `meaning` describes
/// a range of bytes. Consecutive rows of a repeated byte are combined.
pub fn byte_table(
    context: &ReportContext<'_>,
    bytes: &[u8],
    address: impl Fn(usize) -> String,
    meaning: impl Fn(Range<usize>) -> String,
) -> Table {
    let mut table = context.table([
        (Text::new("report.address"), CellStyle::Short),
        (Text::new("report.bytes"), CellStyle::Code),
        (Text::new("report.text"), CellStyle::Code),
        (Text::new("report.meaning"), CellStyle::Text),
    ]);
    let mut at = 0;
    while let Some(row) = bytes.get(at..bytes.len().min(at + ROW)).filter(|row| !row.is_empty()) {
        let (byte, same) = count_leading_repeats(bytes.get(at..).unwrap_or_default());
        let whole_rows = same / ROW * ROW;
        let end =
            if whole_rows > ROW && meaning(at..at + whole_rows).is_empty() { at + whole_rows } else { at + row.len() };
        let cells = if end > at + row.len() {
            let repeated = Text::new("report.repeated").with("count", end - at).with("byte", format!("{byte:02X}"));
            [address(at), context.localize(repeated), String::new(), String::new()]
        } else {
            let text = row.iter().map(|byte| ascii(*byte).unwrap_or(UNPRINTABLE)).collect();
            [address(at), hex(row), text, meaning(at..end)]
        };
        table.add_row(cells);
        at = end;
    }
    table
}

/// Returns the first byte and how often it is repeated from there.
fn count_leading_repeats(bytes: &[u8]) -> (u8, usize) {
    let first = bytes.first().copied().unwrap_or_default();
    (first, bytes.iter().take_while(|byte| **byte == first).count())
}
