//! Encoder types, which define the periods and turns for each type code in the reply to 52h. The built-in table is the
//! file `assets/devices/hiperface/encoder_types.ron`, and users can add their own encoders.

use std::ops::RangeInclusive;

use serde::Deserialize;

use super::Geometry;

/// Row of the encoder type table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncoderType {
    /// Type code.
    pub code: u8,
    /// Family name from the data sheet.
    pub name: String,
    /// Periods and turns, or `None` if the extended label or the user must provide them.
    pub geometry: Option<Geometry>,
    /// Whether the encoder is a kit without a bearing. Its code tracks are aligned with 63h after mounting.
    pub kit: bool,
}

/// The encoder type table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncoderTypes(Vec<EncoderType>);

/// Reason why an encoder type table is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypeTableError {
    /// The table is not valid RON.
    #[error("line {line}, column {column}: {problem}")]
    Syntax {
        /// Line number, counted from 1.
        line: usize,
        /// Column number, counted from 1.
        column: usize,
        /// Message of the parser.
        problem: String,
    },
    /// A number is out of range.
    #[error("type {code:02X}h: {entry} must be between {} and {}", range.start(), range.end())]
    Range {
        /// Type code of the row.
        code: u8,
        /// The invalid entry.
        entry: GeometryEntry,
        /// Valid range.
        range: RangeInclusive<u32>,
    },
}

/// Numeric entry of a row. It is displayed under the name that it has in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GeometryEntry {
    /// Periods per turn.
    #[error("periods")]
    Periods,
    /// Number of turns.
    #[error("turns")]
    Turns,
    /// Length of a period in nanometres.
    #[error("period_nm")]
    PeriodLength,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    types: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    code: u8,
    name: String,
    #[serde(default)]
    shape: Option<EncoderShape>,
    #[serde(default)]
    kit: bool,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum EncoderShape {
    Rotary { periods: u32, turns: u32 },
    Linear { period_nm: u32 },
}

impl EncoderTypes {
    /// The table that is shipped with the program, as RON.
    pub const BUILT_IN: &'static str = include_str!("../../../../assets/devices/hiperface/encoder_types.ron");

    /// Parses an encoder type table.
    ///
    /// # Errors
    /// Returns [`TypeTableError::Syntax`] if the table is not valid RON or has unknown keys, or
    /// [`TypeTableError::Range`] if a number is out of range.
    pub fn parse(text: &str) -> Result<Self, TypeTableError> {
        let file: File = ron::from_str(text).map_err(|error| TypeTableError::Syntax {
            line: error.span.start.line,
            column: error.span.start.col,
            problem: error.code.to_string(),
        })?;
        file.types.into_iter().map(Row::into_encoder_type).collect::<Result<_, _>>().map(EncoderTypes)
    }

    /// Returns the built-in table.
    pub fn built_in() -> Self {
        // A test checks that the table can be parsed. With an empty table, every type would be unknown.
        Self::parse(Self::BUILT_IN).unwrap_or(EncoderTypes(Vec::new()))
    }

    /// Returns the rows of both tables. If both have a row for a type code, the row of `other` applies.
    #[must_use]
    pub fn merged_with(self, other: EncoderTypes) -> Self {
        let mut rows = other.0;
        rows.extend(self.0);
        EncoderTypes(rows)
    }

    /// Returns the row for a type code.
    pub fn find(&self, code: u8) -> Option<&EncoderType> {
        self.0.iter().find(|row| row.code == code)
    }
}

impl Row {
    /// Upper limit for the number of periods, and for periods × turns. The other five of the 32 bits in the position
    /// word count the steps within a period.
    const MAX_PERIODS_AND_TURNS: u32 = 1 << 27;

    fn into_encoder_type(self) -> Result<EncoderType, TypeTableError> {
        let geometry = match self.shape {
            None => None,
            Some(EncoderShape::Rotary { periods, turns }) => {
                self.check_range(GeometryEntry::Periods, periods, 1..=Self::MAX_PERIODS_AND_TURNS)?;
                self.check_range(GeometryEntry::Turns, turns, 1..=Self::MAX_PERIODS_AND_TURNS / periods)?;
                Some(Geometry::Rotary { periods, turns })
            }
            Some(EncoderShape::Linear { period_nm }) => {
                self.check_range(GeometryEntry::PeriodLength, period_nm, 1..=u32::MAX)?;
                Some(Geometry::Linear { period_nm, periods: 0 })
            }
        };
        Ok(EncoderType { code: self.code, name: self.name, geometry, kit: self.kit })
    }

    fn check_range(&self, entry: GeometryEntry, value: u32, range: RangeInclusive<u32>) -> Result<(), TypeTableError> {
        if range.contains(&value) { Ok(()) } else { Err(TypeTableError::Range { code: self.code, entry, range }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_table_matches_reference() {
        let types = EncoderTypes::parse(EncoderTypes::BUILT_IN).unwrap();
        // code, periods, turns, total bits
        let cases = [
            (0x02, 512, 1, 14),
            (0x07, 512, 4096, 26),
            (0x22, 1024, 1, 15),
            (0x27, 1024, 4096, 27),
            (0x32, 128, 1, 12),
            (0x37, 128, 4096, 24),
            (0x42, 16, 1, 9),
            (0x47, 16, 4096, 21),
        ];
        for (code, periods, turns, bits) in cases {
            let geometry = types.find(code).unwrap().geometry.unwrap();
            assert_eq!(geometry, Geometry::Rotary { periods, turns }, "{code:02X}");
            assert_eq!(geometry.position_count(), Some(1 << bits), "{code:02X}");
        }
        for (code, mm) in [(0x90, 1), (0x91, 2), (0x92, 4), (0x93, 8), (0x94, 16)] {
            let geometry = types.find(code).unwrap().geometry;
            assert_eq!(geometry, Some(Geometry::Linear { period_nm: mm * 1_000_000, periods: 0 }), "{code:02X}");
        }
        assert_eq!(types.find(0xFF).unwrap().geometry, None);
        assert_eq!(types.find(0x82).unwrap().geometry, None);
        assert_eq!(types.find(0x11), None);
    }

    #[test]
    fn user_row_overrides_built_in() {
        let own = r#"(types: [(code: 0x37, name: "XYZ", shape: Some(rotary(periods: 64, turns: 1)))])"#;
        let types = EncoderTypes::built_in().merged_with(EncoderTypes::parse(own).unwrap());
        assert_eq!(types.find(0x37).unwrap().name, "XYZ");
        assert_eq!(types.find(0x22).unwrap().geometry, Some(Geometry::Rotary { periods: 1024, turns: 1 }));
    }

    #[test]
    fn bad_table_error_has_location() {
        let zero = r#"(types: [(code: 1, name: "x", shape: Some(rotary(periods: 0, turns: 1)))])"#;
        let refused = EncoderTypes::parse(zero);
        assert!(matches!(refused, Err(TypeTableError::Range { code: 1, entry: GeometryEntry::Periods, .. })));
        let misspelt = "(types: [\n(code: 1, nam: \"x\")])";
        assert!(matches!(EncoderTypes::parse(misspelt), Err(TypeTableError::Syntax { line: 2, .. })));
        assert!(EncoderTypes::parse("").is_err());
    }
}
