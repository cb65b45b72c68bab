//! Comparison between a drive's octant table and the exact angle within a period. See SICK 8010701, interpolation, and
//! section 3 of the project's sine/cosine reference.

use std::sync::LazyLock;

use super::forms;
use crate::analysis::arctan::{self, DEGREES, OctantTable, Phase};
use crate::app::Text;
use crate::signals::state::TEXTS;

/// Table sizes to compare, in intervals.
pub const INTERVALS: [usize; 4] = [16, 32, 64, 128];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctantTableError {
    pub intervals: usize,
    pub largest_deg: f64,
    /// Number of parts into which a period is divided if each part equals the largest error.
    pub parts: f64,
    /// Resolution in bits per period at which one step equals the largest error.
    pub bits: f64,
}

/// The phase for one pair of voltages, calculated exactly and with an octant table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolatedPhase {
    pub exact: Phase,
    pub table: Phase,
    /// Table phase minus exact phase in electrical degrees, within ±180.
    pub difference_deg: f64,
}

pub fn table_errors() -> &'static [OctantTableError] {
    static ERRORS: LazyLock<Vec<OctantTableError>> = LazyLock::new(|| INTERVALS.map(table_error).to_vec());
    &ERRORS
}

/// Returns the largest error of a table with the given number of intervals.
fn table_error(intervals: usize) -> OctantTableError {
    const POINTS_PER_INTERVAL: usize = 64;
    let table = OctantTable::new(intervals);
    let error = |place: usize| {
        let t = place as f64 / (intervals * POINTS_PER_INTERVAL) as f64;
        let both = table.phase(t, 1.0).zip(arctan::from_voltages(t, 1.0));
        both.map_or(0.0, |(table, exact)| (table.to_degrees() - exact.to_degrees()).abs())
    };
    let largest_deg = (0..=intervals * POINTS_PER_INTERVAL).map(error).fold(0.0, f64::max);
    let parts = DEGREES / largest_deg;
    OctantTableError { intervals, largest_deg, parts, bits: parts.log2() }
}

/// Calculates the phase of the typed voltages, both exactly and with a table. `intervals` is the size of the table. The
/// voltages must not contain an offset.
///
/// # Errors
/// Returns an error if an entry is not a number or both voltages are zero.
pub fn interpolate(sine: &str, cosine: &str, intervals: usize) -> Result<InterpolatedPhase, Text> {
    let (sine, cosine) = (forms::parse_number(sine)?, forms::parse_number(cosine)?);
    let both = arctan::from_voltages(sine, cosine).zip(OctantTable::new(intervals).phase(sine, cosine));
    let (exact, table) = both.ok_or_else(|| TEXTS.text("octant.no_signal"))?;
    let apart = table.to_degrees() - exact.to_degrees();
    let difference_deg = apart - DEGREES * (apart / DEGREES).round();
    Ok(InterpolatedPhase { exact, table, difference_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tables match section 3 in number of intervals, largest error in radians, and parts per period.
    #[test]
    fn tables_match_section_3() {
        let expected =
            [(16, 3.17e-4, 19_830.0), (32, 7.93e-5, 79_255.0), (64, 1.98e-5, 317_064.0), (128, 4.96e-6, 1_268_002.0)];
        for (found, (intervals, radians, parts)) in table_errors().iter().zip(expected) {
            assert_eq!(found.intervals, intervals);
            assert!((found.largest_deg.to_radians() / radians - 1.0).abs() < 3e-3, "{found:?}");
            assert!((found.parts / parts - 1.0).abs() < 1e-3, "{found:?}");
        }
        assert!((table_errors()[1].bits - 16.27).abs() < 0.01);
    }

    #[test]
    fn pairs_match_section_3() {
        for (sine, cosine, exact, table) in [
            ("0", "0.5", 0.0, 0.0),
            ("0,25", "0,433012702", 30.0, 29.995_47),
            ("0.433012702", "-0.25", 120.0, 119.995_47),
            ("0.1", "0.48989795", 11.536_96, 11.534_35),
            ("-0.2", "0.45825757", 336.421_82, 336.422_38),
        ] {
            let found = interpolate(sine, cosine, 32).unwrap();
            assert!((found.exact.to_degrees() - exact).abs() < 2e-5, "{sine} {cosine}: {found:?}");
            assert!((found.table.to_degrees() - table).abs() < 2e-5, "{sine} {cosine}: {found:?}");
            assert!((found.difference_deg - (table - exact)).abs() < 2e-5, "{sine} {cosine}: {found:?}");
        }
        for (sine, cosine) in [("0", "0"), ("", "1"), ("1", "x"), ("NaN", "1"), ("1e999", "1")] {
            assert!(interpolate(sine, cosine, 32).is_err(), "{sine} {cosine}");
        }
    }
}
