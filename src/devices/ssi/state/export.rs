//! Export of a layout for other programs.

use super::design::Designer;
use crate::app::{Language, Text};
use crate::devices::ssi::protocol::{
    ExportText, Picture, bit_table, c99, frame_picture, scl, settings_sheet, structured_text, structured_text_32,
    timing_picture, to_linuxcnc,
};
use crate::devices::ssi::state::explain as words;

/// Export format of a layout; profiles are exported separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    C,
    /// IEC 61131-3 structured text function block.
    StructuredText,
    /// IEC 61131-3 structured text function block for 32-bit controllers.
    StructuredText32,
    Scl,
    LinuxCnc,
    Sheet,
    Table,
    Frame,
    Timing,
}

impl Format {
    pub const ALL: [Format; 9] = [
        Format::C,
        Format::StructuredText,
        Format::StructuredText32,
        Format::Scl,
        Format::LinuxCnc,
        Format::Sheet,
        Format::Table,
        Format::Frame,
        Format::Timing,
    ];

    pub const fn word(self) -> &'static str {
        match self {
            Format::C => "ssi_export.c",
            Format::StructuredText => "ssi_export.st",
            Format::StructuredText32 => "ssi_export.st_32",
            Format::Scl => "ssi_export.scl",
            Format::LinuxCnc => "ssi_export.linuxcnc",
            Format::Sheet => "ssi_export.sheet",
            Format::Table => "ssi_export.table",
            Format::Frame => "ssi_export.frame",
            Format::Timing => "ssi_export.timing",
        }
    }

    pub const fn hint(self) -> &'static str {
        match self {
            Format::C => "ssi_export.c_hint",
            Format::StructuredText => "ssi_export.st_hint",
            Format::StructuredText32 => "ssi_export.st_32_hint",
            Format::Scl => "ssi_export.scl_hint",
            Format::LinuxCnc => "ssi_export.linuxcnc_hint",
            Format::Sheet => "ssi_export.sheet_hint",
            Format::Table => "ssi_export.table_hint",
            Format::Frame => "ssi_export.frame_hint",
            Format::Timing => "ssi_export.timing_hint",
        }
    }

    pub const fn endings(self) -> &'static [&'static str] {
        match self {
            Format::C => &["c"],
            Format::StructuredText | Format::StructuredText32 => &["st"],
            Format::Scl => &["scl"],
            Format::LinuxCnc | Format::Sheet => &["txt"],
            Format::Table => &["csv"],
            Format::Frame | Format::Timing => &["svg"],
        }
    }
}

impl Designer {
    /// Returns the layout in the given format. The language applies to prose; program code is in English.
    ///
    /// # Errors
    /// The part of the layout that the format cannot represent.
    pub fn export(&self, format: Format, language: Language) -> Result<String, Text> {
        if let Some(picture) = self.picture(format, language) {
            return Ok(picture.svg());
        }
        let layout = self.layout();
        let title = self.title();
        let say = |text: &ExportText| words::export(text).words(language);
        Ok(match format {
            Format::C => c99(layout, &title),
            Format::StructuredText => structured_text(layout, &title),
            Format::StructuredText32 => structured_text_32(layout, &title).map_err(words::wide)?,
            Format::Scl => scl(layout, &title).map_err(words::wide)?,
            Format::LinuxCnc => to_linuxcnc(layout).map_err(|error| words::format(&error))? + "\n",
            Format::Sheet => settings_sheet(layout, self.times(), &title, &say),
            Format::Table | Format::Frame | Format::Timing => bit_table(layout, &say),
        })
    }

    /// Returns the layout as a picture, or `None` if the format is plain text.
    pub fn picture(&self, format: Format, language: Language) -> Option<Picture> {
        let (layout, title) = (self.layout(), self.title());
        let say = |text: &ExportText| words::export(text).words(language);
        match format {
            Format::Frame => Some(frame_picture(layout, None, &title, &say)),
            Format::Timing => Some(timing_picture(layout, &self.applicable_times(), &self.reads(), &title, &say)),
            _ => None,
        }
    }
}
