//! A picture made of shapes. The window and the SVG export draw the same shapes.

use std::fmt::{self, Write};

/// A picture on a white background.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Title, which is also drawn as the first label.
    pub title: String,
    /// Width in picture units.
    pub width: u32,
    /// Height in picture units.
    pub height: u32,
    /// Shapes in drawing order.
    pub shapes: Vec<PictureShape>,
}

/// A horizontal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureLength {
    /// Length in whole grid units.
    Whole(u32),
    /// Length drawn to scale. The SVG output rounds the length to hundredths.
    Scaled(f64),
}

/// A shape. Colours are `#rrggbb` or `#rgb`.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureShape {
    /// A rectangle with a thin border.
    Box {
        /// Left edge.
        x: PictureLength,
        /// Top edge.
        y: u32,
        /// Horizontal size.
        width: PictureLength,
        /// Vertical size.
        height: u32,
        /// Fill colour.
        fill: &'static str,
        /// Border colour.
        line: &'static str,
    },
    /// A thin polyline of horizontal and vertical segments.
    Line {
        /// Path, which begins with a [`PolylineSegment::Move`].
        path: Vec<PolylineSegment>,
        /// Line colour.
        colour: &'static str,
    },
    /// A label.
    Text(PictureLabel),
}

/// A segment of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PolylineSegment {
    /// Moves to a point without drawing.
    Move(PictureLength, u32),
    /// Draws a horizontal segment to this x coordinate.
    Across(PictureLength),
    /// Draws a vertical segment to this y coordinate.
    Down(u32),
}

/// A single line of text, placed by its baseline.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLabel {
    /// Horizontal position of the label. See [`is_centred`](Self::is_centred).
    pub x: PictureLength,
    /// Baseline.
    pub y: u32,
    /// Font size.
    pub size: u32,
    /// Whether the label is bold.
    pub is_bold: bool,
    /// Text colour, or `None` for black.
    pub colour: Option<&'static str>,
    /// Whether `x` is the middle of the label. Otherwise, `x` is the left end.
    pub is_centred: bool,
    /// Label text.
    pub text: String,
}

/// Minimum distance between the picture's content and its edges.
pub(super) const MARGIN: u32 = 16;
pub(super) const FAINT_COLOUR: &str = "#555";

const FONT: &str = "font-family=\"Inter, Arial, sans-serif\"";

impl Picture {
    pub(super) fn with_title(width: u32, height: u32, title: &str) -> Self {
        let heading = PictureLabel { is_bold: true, ..PictureLabel::new(PictureLength::Whole(MARGIN), 20, 12, title) };
        Picture { title: title.to_owned(), width, height, shapes: vec![PictureShape::Text(heading)] }
    }

    /// Returns the picture as SVG.
    pub fn to_svg(&self) -> String {
        let Picture { width, height, .. } = self;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\" aria-label=\"{}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            escape_text(&self.title)
        );
        for shape in &self.shapes {
            // Writing into a String does not fail.
            let _ = match shape {
                PictureShape::Box { x, y, width, height, fill, line } => writeln!(
                    svg,
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\" stroke=\"{line}\"/>"
                ),
                PictureShape::Line { path, colour } => {
                    let steps: Vec<String> = path.iter().map(PolylineSegment::to_string).collect();
                    writeln!(svg, "<path d=\"{}\" stroke=\"{colour}\" fill=\"none\"/>", steps.join(" "))
                }
                PictureShape::Text(label) => label.write(&mut svg),
            };
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl PictureLabel {
    pub(super) fn new(x: PictureLength, y: u32, size: u32, text: impl Into<String>) -> Self {
        PictureLabel { x, y, size, is_bold: false, colour: None, is_centred: false, text: text.into() }
    }

    fn write(&self, svg: &mut String) -> fmt::Result {
        let PictureLabel { x, y, size, .. } = self;
        write!(svg, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"")?;
        if self.is_bold {
            svg.write_str(" font-weight=\"bold\"")?;
        }
        if let Some(colour) = self.colour {
            write!(svg, " fill=\"{colour}\"")?;
        }
        if self.is_centred {
            svg.write_str(" text-anchor=\"middle\"")?;
        }
        writeln!(svg, " {FONT}>{}</text>", escape_text(&self.text))
    }
}

impl PictureLength {
    /// Returns the length in picture units.
    pub fn units(self) -> f64 {
        match self {
            PictureLength::Whole(units) => units.into(),
            PictureLength::Scaled(units) => units,
        }
    }
}

impl fmt::Display for PictureLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PictureLength::Whole(units) => write!(f, "{units}"),
            PictureLength::Scaled(units) => write!(f, "{units:.2}"),
        }
    }
}

impl fmt::Display for PolylineSegment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PolylineSegment::Move(x, y) => write!(f, "M{x} {y}"),
            PolylineSegment::Across(x) => write!(f, "H{x}"),
            PolylineSegment::Down(y) => write!(f, "V{y}"),
        }
    }
}

fn escape_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
