//! Rendering of a report as a self-contained HTML page for A4 paper. The page has embedded fonts, no scripts and no
//! external resources.

use askama::Template;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::{Block, CellStyle, ContentHash, Mark, Report};
use crate::fonts;

/// Length in bytes above which the text of a cell may be broken anywhere. Shorter texts are broken only between words.
const LONG_CELL: usize = 24;

#[derive(Template)]
#[template(path = "report.html", config = "assets/report/askama.toml")]
struct Page<'a> {
    report: &'a Report,
    hash: &'a ContentHash,
    /// Print time, shown in the element with the class `printed`.
    printed: &'a str,
    fonts: [(&'static str, u16, &'static str, String); 3],
    logo: Option<String>,
}

/// Returns the report as an HTML page. `printed` is the print time. Everything else depends only on the content.
pub fn render(report: &Report, printed: &str) -> String {
    let font = |name, weight, format, bytes| (name, weight, format, STANDARD.encode(bytes));
    let page = Page {
        report,
        hash: &report.content_hash(),
        printed,
        fonts: [
            font("Inter", 400, "font/otf", fonts::TEXT),
            font("Inter", 600, "font/otf", fonts::STRONG),
            font("JetBrains Mono", 400, "font/ttf", fonts::MONOSPACE),
        ],
        logo: report.company.as_ref().and_then(|company| company.logo.as_ref()).map(|logo| STANDARD.encode(logo)),
    };
    // The template writes to a `String`, which cannot fail.
    page.render().unwrap_or_default()
}

impl CellStyle {
    /// Returns the CSS class of cells with this style.
    const fn class(self) -> &'static str {
        match self {
            CellStyle::Text => "text",
            CellStyle::Short => "short",
            CellStyle::Code => "code",
            CellStyle::Number => "number",
        }
    }
}

impl Mark {
    /// Returns the CSS class of rows with this verdict.
    const fn class(self) -> &'static str {
        match self {
            Mark::None => "none",
            Mark::Good => "good",
            Mark::Warning => "warning",
            Mark::Bad => "bad",
        }
    }
}
