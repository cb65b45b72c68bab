//! A report as a PDF document for A4 paper with embedded fonts. It has the same content as the HTML page.

mod canvas;
mod content;
mod flow;
mod table;
mod typeface;

use krilla::Document;
use krilla::image::Image;
use krilla::metadata::Metadata;
use krilla::page::PageSettings;

use self::canvas::Painter;
use self::flow::{Flow, PAGE};
use self::typeface::Typefaces;
use super::Report;

/// The reason why a report could not be converted to a PDF document.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PdfError {
    /// A built-in font cannot be read.
    #[error("a built-in font cannot be read")]
    Font,
    /// The logo is not a PNG file.
    #[error("the logo is not a PNG file")]
    Logo,
    /// The document could not be completed.
    #[error("the document could not be completed: {0}")]
    Document(String),
}

/// Checks that a logo can be used in a PDF document.
///
/// # Errors
/// Returns [`PdfError::Logo`] if the logo is not a PNG file.
pub fn check_logo(bytes: Vec<u8>) -> Result<(), PdfError> {
    decode_logo(bytes).map(drop)
}

fn decode_logo(bytes: Vec<u8>) -> Result<Image, PdfError> {
    Image::from_png(bytes.into(), true).map_err(|_| PdfError::Logo)
}

/// Renders a report as a PDF document. `printed` is the print time. The rest of the document depends only on the
/// report.
///
/// # Errors
/// Returns an error if the logo or the document is invalid.
pub fn render(report: &Report, printed: &str) -> Result<Vec<u8>, PdfError> {
    let faces = Typefaces::load()?;
    let logo = report.company.as_ref().and_then(|company| company.logo.clone());
    let logo = logo.map(decode_logo).transpose()?;
    let mut flow = Flow::new(&faces);
    flow.place_report(report, logo, printed);
    flow.place_page_numbers(report);
    let mut document = Document::new();
    document.set_metadata(
        Metadata::new()
            .title(format!("{}: {}", report.subject, report.title))
            .language(report.language.to_owned())
            .creator(format!("encoder-studio {}", env!("CARGO_PKG_VERSION"))),
    );
    for marks in &flow.pages {
        let Some(size) = PageSettings::from_wh(PAGE.0, PAGE.1) else { continue };
        let mut page = document.start_page_with(size);
        let mut surface = page.surface();
        let mut painter = Painter { surface: &mut surface, faces: &faces };
        marks.iter().for_each(|mark| painter.paint(mark));
        surface.finish();
        page.finish();
    }
    document.finish().map_err(|error| PdfError::Document(format!("{error:?}")))
}
