//! Export of a frame for other programs. The formats are decoders in C and structured text, a picture, a table,
//! settings for the SSI module of a PLC, and the format string of LinuxCNC.

mod c;
mod halves;
mod linuxcnc;
mod procedure;
mod sheet;
mod structured_text;
mod svg;
mod table;
#[cfg(test)]
mod tests;
mod text;

pub use c::generate_c99;
pub use halves::{WordWidthError, scl_source, structured_text_32};
pub use linuxcnc::{FormatError, UnsupportedProperty, from_linuxcnc, to_linuxcnc};
pub use sheet::settings_sheet;
pub use structured_text::structured_text;
pub use svg::{frame_drawing, timing_drawing};
pub use table::bit_table;
pub use text::{ExportText, SettingMeaning, TranslateFn, UnsupportedModuleFeature, english_text};

/// Converts a name to an identifier of letters, digits and underscores that does not start with a digit.
fn identifier(name: &str) -> String {
    let word: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    if word.starts_with(|c: char| c.is_ascii_digit()) || word.is_empty() { format!("_{word}") } else { word }
}
