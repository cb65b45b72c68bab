//! Export of a layout in the formats of other programs.

use super::design::LayoutDesigner;
use crate::app::{Language, Text};
use crate::devices::ssi::protocol::{
    ExportText, bit_table, frame_drawing, generate_c99, scl_source, settings_sheet, structured_text,
    structured_text_32, timing_drawing, to_linuxcnc,
};
use crate::devices::ssi::state::explain;
use crate::drawing::Drawing;

/// Export format of a layout. Profiles are exported separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ExportFormat {
    C,
    /// Function block in IEC 61131-3 structured text.
    StructuredText,
    /// Function block in IEC 61131-3 structured text, for controllers with 32 bits.
    StructuredText32,
    Scl,
    LinuxCnc,
    Sheet,
    Table,
    Frame,
    Timing,
}

impl ExportFormat {
    pub const ALL: [ExportFormat; 9] = [
        ExportFormat::C,
        ExportFormat::StructuredText,
        ExportFormat::StructuredText32,
        ExportFormat::Scl,
        ExportFormat::LinuxCnc,
        ExportFormat::Sheet,
        ExportFormat::Table,
        ExportFormat::Frame,
        ExportFormat::Timing,
    ];

    pub const fn keyword(self) -> &'static str {
        match self {
            ExportFormat::C => "ssi_export.c",
            ExportFormat::StructuredText => "ssi_export.st",
            ExportFormat::StructuredText32 => "ssi_export.st_32",
            ExportFormat::Scl => "ssi_export.scl",
            ExportFormat::LinuxCnc => "ssi_export.linuxcnc",
            ExportFormat::Sheet => "ssi_export.sheet",
            ExportFormat::Table => "ssi_export.table",
            ExportFormat::Frame => "ssi_export.frame",
            ExportFormat::Timing => "ssi_export.timing",
        }
    }

    pub const fn hint_id(self) -> &'static str {
        match self {
            ExportFormat::C => "ssi_export.c_hint",
            ExportFormat::StructuredText => "ssi_export.st_hint",
            ExportFormat::StructuredText32 => "ssi_export.st_32_hint",
            ExportFormat::Scl => "ssi_export.scl_hint",
            ExportFormat::LinuxCnc => "ssi_export.linuxcnc_hint",
            ExportFormat::Sheet => "ssi_export.sheet_hint",
            ExportFormat::Table => "ssi_export.table_hint",
            ExportFormat::Frame => "ssi_export.frame_hint",
            ExportFormat::Timing => "ssi_export.timing_hint",
        }
    }

    pub const fn file_extensions(self) -> &'static [&'static str] {
        match self {
            ExportFormat::C => &["c"],
            ExportFormat::StructuredText | ExportFormat::StructuredText32 => &["st"],
            ExportFormat::Scl => &["scl"],
            ExportFormat::LinuxCnc | ExportFormat::Sheet => &["txt"],
            ExportFormat::Table => &["csv"],
            ExportFormat::Frame | ExportFormat::Timing => &["svg"],
        }
    }
}

impl LayoutDesigner {
    /// Returns the layout in the given format. Explanations are in the given language, and program code is in English.
    ///
    /// # Errors
    /// Returns an error with the property of the layout that the format cannot represent.
    pub fn export(&self, format: ExportFormat, language: Language) -> Result<String, Text> {
        if let Some(picture) = self.layout_drawing(format, language) {
            return Ok(picture.to_svg());
        }
        let layout = self.layout();
        let title = self.title();
        let say = |text: &ExportText| explain::export_text(text).to_string_in(language);
        Ok(match format {
            ExportFormat::C => generate_c99(layout, &title),
            ExportFormat::StructuredText => structured_text(layout, &title),
            ExportFormat::StructuredText32 => {
                structured_text_32(layout, &title).map_err(explain::word_width_error_text)?
            }
            ExportFormat::Scl => scl_source(layout, &title).map_err(explain::word_width_error_text)?,
            ExportFormat::LinuxCnc => to_linuxcnc(layout).map_err(|error| explain::format_error_text(&error))? + "\n",
            ExportFormat::Sheet => settings_sheet(layout, self.times(), &title, &say),
            ExportFormat::Table | ExportFormat::Frame | ExportFormat::Timing => bit_table(layout, &say),
        })
    }

    /// Returns the layout as a picture, or `None` if the format is text.
    pub fn layout_drawing(&self, format: ExportFormat, language: Language) -> Option<Drawing> {
        let (layout, title) = (self.layout(), self.title());
        let say = |text: &ExportText| explain::export_text(text).to_string_in(language);
        match format {
            ExportFormat::Frame => Some(frame_drawing(layout, None, &title, &say)),
            ExportFormat::Timing => {
                Some(timing_drawing(layout, &self.applicable_times(), &self.read_conditions(), &title, &say))
            }
            _ => None,
        }
    }
}
