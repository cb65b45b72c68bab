//! Placement of content on pages. A new page begins whenever the next item does not fit.

use super::canvas::{Colour, PageMark};
use super::typeface::{Face, Typefaces};

/// Size of A4 in points.
pub(super) const PAGE: (f32, f32) = (595.28, 841.89);
/// Left, right and top margin in points (18 mm).
pub(super) const MARGIN: f32 = 51.02;
/// Bottom margin in points (22 mm). It contains the page number.
pub(super) const BOTTOM: f32 = 62.36;
/// Width of the content on a page in points.
pub(super) const WIDTH: f32 = PAGE.0 - 2.0 * MARGIN;
pub(super) const END: f32 = PAGE.1 - BOTTOM;
/// Height of a line relative to the font size.
const LINE_HEIGHT: f32 = 1.4;
/// Distance of the baseline from the top of a line, relative to the font size.
const BASELINE: f32 = 1.05;

/// Font, size and colour of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Style {
    pub(super) face: Face,
    pub(super) size: f32,
    pub(super) colour: Colour,
}

/// The pages of a report while content is being placed on them.
pub(super) struct Flow<'a> {
    pub(super) faces: &'a Typefaces,
    pub(super) pages: Vec<Vec<PageMark>>,
    /// Vertical position of the next item on the last page.
    pub(super) y: f32,
}

impl Style {
    pub(super) const fn line_height(self) -> f32 {
        self.size * LINE_HEIGHT
    }
}

impl<'a> Flow<'a> {
    pub(super) fn new(faces: &'a Typefaces) -> Self {
        Flow { faces, pages: vec![Vec::new()], y: MARGIN }
    }

    /// Returns the remaining height of the page.
    pub(super) fn remaining_height(&self) -> f32 {
        END - self.y
    }

    /// Returns whether nothing has been placed on the page yet.
    pub(super) fn is_page_empty(&self) -> bool {
        self.pages.last().is_none_or(Vec::is_empty)
    }

    pub(super) fn break_page(&mut self) {
        self.pages.push(Vec::new());
        self.y = MARGIN;
    }

    /// Begins a new page unless the current one has enough space.
    pub(super) fn ensure_space(&mut self, height: f32) {
        if height > self.remaining_height() && !self.is_page_empty() {
            self.break_page();
        }
    }

    /// Adds vertical space, except at the top of a page.
    pub(super) fn add_space(&mut self, distance: f32) {
        if !self.is_page_empty() {
            self.y += distance;
        }
    }

    pub(super) fn push(&mut self, mark: PageMark) {
        if let Some(page) = self.pages.last_mut() {
            page.push(mark);
        }
    }

    /// Places a line of text whose top is at `y`.
    pub(super) fn text_at(&mut self, x: f32, y: f32, style: Style, text: impl Into<String>) {
        let Style { face, size, colour } = style;
        self.push(PageMark::Text { x, y: y + size * BASELINE, size, face, colour, text: text.into() });
    }

    pub(super) fn width(&self, style: Style, text: &str) -> f32 {
        self.faces.width(style.face, style.size, text)
    }

    pub(super) fn lines(&self, style: Style, text: &str, width: f32) -> Vec<String> {
        self.faces.lines(style.face, style.size, text, width)
    }

    pub(super) fn rule(&mut self, x: f32, y: f32, width: f32, thickness: f32, colour: Colour) {
        self.push(PageMark::Rule { x, y, width, thickness, colour });
    }
}
