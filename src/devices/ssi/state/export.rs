//! A layout for other programs, as text.

use super::design::Designer;
use crate::app::Text;
use crate::devices::ssi::protocol::{
    bit_table, c99, frame_svg, settings_sheet, structured_text, timing_svg, to_linuxcnc,
};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain as words;

/// A format of an exported layout, besides a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// A function in C99.
    C,
    /// A function block in IEC 61131-3 structured text.
    StructuredText,
    /// The format string of LinuxCNC.
    LinuxCnc,
    /// Settings for common SSI modules of controls.
    Sheet,
    /// A row for each clock.
    Table,
    /// A picture of the frame.
    Frame,
    /// A picture of a burst in time.
    Timing,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 7] = [
        Format::C,
        Format::StructuredText,
        Format::LinuxCnc,
        Format::Sheet,
        Format::Table,
        Format::Frame,
        Format::Timing,
    ];

    /// Returns the id of its text.
    pub const fn word(self) -> &'static str {
        match self {
            Format::C => "ssi_export.c",
            Format::StructuredText => "ssi_export.st",
            Format::LinuxCnc => "ssi_export.linuxcnc",
            Format::Sheet => "ssi_export.sheet",
            Format::Table => "ssi_export.table",
            Format::Frame => "ssi_export.frame",
            Format::Timing => "ssi_export.timing",
        }
    }

    /// Returns the id of its explanation.
    pub const fn hint(self) -> &'static str {
        match self {
            Format::C => "ssi_export.c_hint",
            Format::StructuredText => "ssi_export.st_hint",
            Format::LinuxCnc => "ssi_export.linuxcnc_hint",
            Format::Sheet => "ssi_export.sheet_hint",
            Format::Table => "ssi_export.table_hint",
            Format::Frame => "ssi_export.frame_hint",
            Format::Timing => "ssi_export.timing_hint",
        }
    }

    /// Returns the extensions of such files.
    pub const fn endings(self) -> &'static [&'static str] {
        match self {
            Format::C => &["c"],
            Format::StructuredText => &["st"],
            Format::LinuxCnc | Format::Sheet => &["txt"],
            Format::Table => &["csv"],
            Format::Frame | Format::Timing => &["svg"],
        }
    }

    /// Returns whether it is a picture rather than text.
    pub const fn is_picture(self) -> bool {
        matches!(self, Format::Frame | Format::Timing)
    }
}

impl Designer {
    /// Returns the layout as text.
    ///
    /// # Errors
    /// What the format cannot express; a timing diagram needs a family, whose times apply.
    pub fn export(&self, format: Format) -> Result<String, Text> {
        let layout = self.layout();
        let title = self.title();
        Ok(match format {
            Format::C => c99(layout, &title),
            Format::StructuredText => structured_text(layout, &title),
            Format::LinuxCnc => to_linuxcnc(layout).map_err(|error| words::format(&error))? + "\n",
            Format::Sheet => settings_sheet(layout, self.times(), &title),
            Format::Table => bit_table(layout),
            Format::Frame => frame_svg(layout, None, &title),
            Format::Timing => {
                let times = self.times().ok_or_else(|| TEXTS.text("ssi_timing.no_family"))?;
                timing_svg(layout, times, &self.reads(), &title)
            }
        })
    }
}
