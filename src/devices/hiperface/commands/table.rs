//! Positions as CSV for scripts, with commas as separators and a decimal point in every language.

use crate::devices::hiperface::procedures::PositionReading;
use crate::devices::hiperface::protocol::{Geometry, StatusCode};

/// Table of positions, in degrees for a rotary encoder and in millimetres for a linear encoder.
pub(super) struct PositionTable {
    linear: bool,
}

impl PositionTable {
    /// Returns the table for an encoder. An encoder of unknown geometry is treated as a rotary encoder.
    pub(super) fn for_geometry(geometry: Option<Geometry>) -> Self {
        PositionTable { linear: matches!(geometry, Some(Geometry::Linear { .. })) }
    }

    pub(super) fn header(&self) -> &'static str {
        match self.linear {
            true => "t_s,raw,turns,steps,millimetres,valid,codes\n",
            false => "t_s,raw,turns,steps,degrees,valid,codes\n",
        }
    }

    /// Returns a row of the table. Unknown values are empty. Each status code has two hexadecimal digits, and spaces
    /// separate the codes.
    pub(super) fn row(&self, reading: &PositionReading) -> String {
        let place = reading.position;
        let number = |number: Option<u64>| number.map_or_else(String::new, |number| number.to_string());
        let angle = match self.linear {
            true => place.and_then(|place| place.millimetres()),
            false => place.and_then(|place| place.degrees()),
        };
        format!(
            "{:.6},{},{},{},{},{},{}\n",
            reading.at.since_start().as_secs_f64(),
            reading.raw,
            number(place.and_then(|place| place.turns())),
            number(place.and_then(|place| place.steps())),
            angle.map_or_else(String::new, |angle| angle.to_string()),
            reading.valid,
            describe_codes(&reading.codes),
        )
    }

    pub(super) fn row_without_position(&self, codes: &[StatusCode]) -> String {
        format!(",,,,,false,{}\n", describe_codes(codes))
    }
}

fn describe_codes(codes: &[StatusCode]) -> String {
    codes.iter().map(|code| format!("{:02X}", code.byte())).collect::<Vec<_>>().join(" ")
}
