//! Writes the active cams as a table. Reading the table back activates the same cams.

use std::fmt::Write;

use super::{CamNames, Scale, Unit};
use crate::devices::interbus::profile::Image;
use crate::devices::interbus::protocol::CamNumber;

/// Formats the active cams of all known programs as a table in machine units. The columns are separated by semicolons
/// with a decimal comma, and by commas otherwise. Reading the table back yields the same steps.
pub fn emit(image: &Image, names: &CamNames, scale: &Scale, decimal_comma: bool) -> String {
    let separator = if decimal_comma { ';' } else { ',' };
    let unit = match scale.unit() {
        Unit::Steps => "steps",
        Unit::Degrees => "deg",
        Unit::Millimetres => "mm",
    };
    let mut table = String::new();
    let header = ["program", "cam", "name", &format!("start [{unit}]"), &format!("stop [{unit}]")];
    append_row(&mut table, &header, separator);
    let range = image.parameters.steps;
    let number = |step| {
        let value = scale.value(step, range);
        let text = format!("{value:.*}", scale.decimal_places());
        if decimal_comma { text.replace('.', ",") } else { text }
    };
    for (program, own) in image.known_programs() {
        for (number_of, cam) in CamNumber::all().zip(&own.cams).filter(|(number, _)| own.is_on(*number)) {
            let Some(cam) = cam else { continue };
            let cells = [
                program.get().to_string(),
                number_of.get().to_string(),
                names.cam(program, number_of).to_owned(),
                number(cam.start.get()),
                number(cam.stop.get()),
            ];
            append_row(&mut table, &cells.each_ref().map(String::as_str), separator);
        }
    }
    table
}

fn append_row(table: &mut String, cells: &[&str], separator: char) {
    for (place, cell) in cells.iter().enumerate() {
        if place > 0 {
            table.push(separator);
        }
        if cell.contains([separator, '"', '\n', '\r']) {
            // Writing to a string cannot fail.
            let _ = write!(table, "\"{}\"", cell.replace('"', "\"\""));
        } else {
            table.push_str(cell);
        }
    }
    table.push('\n');
}
