//! File formats of reports.

use std::path::Path;

use jiff::Zoned;

use crate::app::{Language, Text};
use crate::report::pdf::PdfError;
use crate::report::{Report, html, pdf};

/// File format of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportFormat {
    Html,
    Pdf,
}

impl ReportFormat {
    /// File extensions of all formats.
    pub const EXTENSIONS: &[&str] = &["html", "pdf"];

    /// Returns the format that matches the file extension, or `None` if no format matches.
    pub fn of_file(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "html" | "htm" => Some(ReportFormat::Html),
            "pdf" => Some(ReportFormat::Pdf),
            _ => None,
        }
    }

    /// Renders a report as file content. `printed` is the time stated in the report.
    ///
    /// # Errors
    /// Returns a message if the PDF document cannot be created.
    pub fn render(self, report: &Report, printed: &str) -> Result<Vec<u8>, Text> {
        match self {
            ReportFormat::Html => Ok(html::render(report, printed).into_bytes()),
            ReportFormat::Pdf => pdf::render(report, printed).map_err(|error| pdf_error_text(&error)),
        }
    }
}

/// Formats the current time for a report, in the time zone of this computer.
pub fn current_time_text(now: &Zoned, language: Language) -> String {
    let form = match language {
        Language::English => "%Y-%m-%d %H:%M:%S %Z",
        Language::German => "%d.%m.%Y %H:%M:%S %Z",
    };
    now.strftime(form).to_string()
}

pub(super) fn pdf_error_text(error: &PdfError) -> Text {
    match error {
        PdfError::Logo => Text::new("report.logo"),
        PdfError::Font => Text::new("report.font"),
        PdfError::Document(why) => Text::new("report.document").with("why", why),
    }
}
