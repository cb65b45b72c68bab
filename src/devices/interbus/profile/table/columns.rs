//! Identifies table columns by their English or German headers or, without a header, by how many there are.

use super::Column;
use crate::analysis::capture::Delimiter;
use crate::devices::interbus::profile::Unit;

/// Zero-based indices of the table columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Columns {
    places: Vec<(Column, usize)>,
    /// Whether the cam column may contain names instead of numbers.
    pub(super) cam_or_name: bool,
}

/// Recognised header words in lower case.
const HEADER_WORDS: [(Column, &[&str]); 5] = [
    (Column::Program, &["program", "programm", "prog", "prg", "p"]),
    (Column::Cam, &["cam", "nocken", "nocke", "nr", "no", "number", "nummer", "output", "ausgang"]),
    (Column::Name, &["name", "track", "spur", "label", "signal", "bezeichnung", "funktion", "function"]),
    (Column::Start, &["start", "on", "from", "begin", "anfang", "ein", "von", "beginn", "einschaltpunkt"]),
    (Column::Stop, &["stop", "off", "to", "end", "ende", "aus", "bis", "stopp", "ausschaltpunkt"]),
];

impl Columns {
    /// Identifies the columns by their header, or returns `None` if the header names neither a start nor a stop.
    pub(super) fn from_header(cells: &[&str]) -> Option<Self> {
        let mut places: Vec<(Column, usize)> = Vec::new();
        for (place, cell) in cells.iter().enumerate() {
            let known = HEADER_WORDS.iter().find(|(column, words)| {
                words.contains(&first_word(cell).as_str()) && places.iter().all(|(own, _)| own != column)
            });
            places.extend(known.map(|(column, _)| (*column, place)));
        }
        let has = |column| places.iter().any(|(own, _)| *own == column);
        let has_edge = has(Column::Start) || has(Column::Stop);
        // If there is also a column of names, the column of cams contains only numbers.
        let cam_or_name = has(Column::Cam) && !has(Column::Name);
        has_edge.then_some(Columns { places, cam_or_name })
    }

    /// Returns the standard columns for a table without a header, given their number.
    pub(super) fn from_column_count(count: usize) -> Self {
        use Column::{Cam, Name, Program, Start, Stop};
        let order: &[Column] = match count {
            0..=2 => &[Start, Stop],
            3 => &[Cam, Start, Stop],
            4 => &[Program, Cam, Start, Stop],
            _ => &[Program, Cam, Name, Start, Stop],
        };
        let places = order.iter().copied().zip(0..).collect();
        Columns { places, cam_or_name: matches!(count, 3 | 4) }
    }

    pub(super) fn index_of(&self, column: Column) -> Option<usize> {
        self.places.iter().find(|(own, _)| *own == column).map(|(_, place)| *place)
    }
}

/// Returns the delimiter that occurs outside quotes on most lines. A tie is decided against the comma, which may be a
/// decimal separator.
pub(super) fn delimiter(text: &str) -> Delimiter {
    let has = |line: &str, sign: char| {
        let mut quoted = false;
        line.chars().any(|c| {
            quoted ^= c == '"';
            c == sign && !quoted
        })
    };
    let count = |sign| text.lines().filter(|line| has(line, sign)).count();
    let all = [(Delimiter::Comma, ','), (Delimiter::Semicolon, ';'), (Delimiter::Tab, '\t')];
    // If several are equally frequent, the last one is used.
    let most = all.into_iter().map(|(delimiter, sign)| (delimiter, count(sign))).max_by_key(|(_, count)| *count);
    most.filter(|(_, count)| *count > 0).map_or(Delimiter::Comma, |(delimiter, _)| delimiter)
}

pub(super) fn unit(cell: &str) -> Option<Unit> {
    let cell = cell.to_lowercase();
    let parts = cell.split(|c: char| !c.is_alphanumeric() && c != '°').filter(|part| !part.is_empty()).skip(1);
    parts.into_iter().find_map(|part| match part {
        "°" | "deg" | "degree" | "degrees" | "grad" => Some(Unit::Degrees),
        "mm" | "millimetre" | "millimetres" | "millimeter" => Some(Unit::Millimetres),
        "step" | "steps" | "schritt" | "schritte" | "inc" | "counts" => Some(Unit::Steps),
        _ => None,
    })
}

/// Returns the first word of a cell, in lower case.
fn first_word(cell: &str) -> String {
    let cell = cell.trim().trim_start_matches('\u{FEFF}').to_lowercase();
    cell.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}
