//! A vector drawing. The window, the SVG export and reports all draw it from the same shapes.

pub mod plot;
pub mod ticks;

use std::fmt::{self, Write};

use serde::Serialize;

/// A drawing on a white background.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawing {
    /// Title, which describes the drawing to a screen reader.
    pub title: String,
    /// Width in drawing units.
    pub width: u32,
    /// Height in drawing units.
    pub height: u32,
    /// Shapes in drawing order.
    pub shapes: Vec<DrawingShape>,
}

/// A coordinate or a length.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum DrawingLength {
    /// Length in whole grid units.
    Whole(u32),
    /// Length drawn to scale. The SVG output rounds the length to hundredths.
    Scaled(f64),
}

/// A shape. Colours are `#rrggbb` or `#rgb`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum DrawingShape {
    /// A rectangle with a thin border.
    Box {
        /// Left edge.
        x: DrawingLength,
        /// Top edge.
        y: DrawingLength,
        /// Horizontal size.
        width: DrawingLength,
        /// Vertical size.
        height: DrawingLength,
        /// Fill colour.
        fill: &'static str,
        /// Border colour.
        line: &'static str,
    },
    /// A thin polyline.
    Line {
        /// Path, which begins with a [`PathSegment::Move`].
        path: Vec<PathSegment>,
        /// Line colour.
        colour: &'static str,
    },
    /// A label.
    Text(DrawingLabel),
}

/// A segment of a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum PathSegment {
    /// Moves to a point without drawing.
    Move(DrawingLength, DrawingLength),
    /// Draws a horizontal segment to this x coordinate.
    Across(DrawingLength),
    /// Draws a vertical segment to this y coordinate.
    Down(DrawingLength),
    /// Draws a straight segment to a point.
    To(DrawingLength, DrawingLength),
}

/// A single line of text, placed by its baseline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DrawingLabel {
    /// Horizontal position of the label, to which `align` refers.
    pub x: DrawingLength,
    /// Vertical position of the baseline.
    pub y: DrawingLength,
    /// Font size.
    pub size: u32,
    /// Whether the label is bold.
    pub is_bold: bool,
    /// Text colour, or `None` for black.
    pub colour: Option<&'static str>,
    /// Point of the label to which `x` refers.
    pub align: LabelAlign,
    /// Label text.
    pub text: String,
}

/// The point of a label to which its horizontal position refers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum LabelAlign {
    /// The left end.
    #[default]
    Left,
    /// The middle.
    Centre,
    /// The right end.
    Right,
}

/// Grey for secondary lines and labels.
pub const FAINT_COLOUR: &str = "#555";

const FONT: &str = "font-family=\"Inter, Arial, sans-serif\"";

impl Drawing {
    /// Creates a drawing without shapes.
    pub fn new(width: u32, height: u32, title: impl Into<String>) -> Self {
        Drawing { title: title.into(), width, height, shapes: Vec::new() }
    }

    /// Returns the drawing as SVG.
    pub fn to_svg(&self) -> String {
        let Drawing { width, height, .. } = self;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\" aria-label=\"{}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            escape_text(&self.title)
        );
        for shape in &self.shapes {
            // Writing into a String does not fail.
            let _ = match shape {
                DrawingShape::Box { x, y, width, height, fill, line } => writeln!(
                    svg,
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\" stroke=\"{line}\"/>"
                ),
                DrawingShape::Line { path, colour } => {
                    let steps: Vec<String> = path.iter().map(PathSegment::to_string).collect();
                    writeln!(svg, "<path d=\"{}\" stroke=\"{colour}\" fill=\"none\"/>", steps.join(" "))
                }
                DrawingShape::Text(label) => label.write(&mut svg),
            };
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl DrawingLabel {
    /// Creates a black label that begins at `x`.
    pub fn new(x: impl Into<DrawingLength>, y: impl Into<DrawingLength>, size: u32, text: impl Into<String>) -> Self {
        let (x, y, text) = (x.into(), y.into(), text.into());
        DrawingLabel { x, y, size, is_bold: false, colour: None, align: LabelAlign::Left, text }
    }

    fn write(&self, svg: &mut String) -> fmt::Result {
        let DrawingLabel { x, y, size, .. } = self;
        write!(svg, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"")?;
        if self.is_bold {
            svg.write_str(" font-weight=\"bold\"")?;
        }
        if let Some(colour) = self.colour {
            write!(svg, " fill=\"{colour}\"")?;
        }
        match self.align {
            LabelAlign::Left => {}
            LabelAlign::Centre => svg.write_str(" text-anchor=\"middle\"")?,
            LabelAlign::Right => svg.write_str(" text-anchor=\"end\"")?,
        }
        writeln!(svg, " {FONT}>{}</text>", escape_text(&self.text))
    }
}

impl DrawingLength {
    /// Returns the length in drawing units.
    pub fn units(self) -> f64 {
        match self {
            DrawingLength::Whole(units) => units.into(),
            DrawingLength::Scaled(units) => units,
        }
    }
}

impl From<u32> for DrawingLength {
    fn from(units: u32) -> Self {
        DrawingLength::Whole(units)
    }
}

impl From<f64> for DrawingLength {
    fn from(units: f64) -> Self {
        DrawingLength::Scaled(units)
    }
}

impl fmt::Display for DrawingLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DrawingLength::Whole(units) => write!(f, "{units}"),
            DrawingLength::Scaled(units) => write!(f, "{units:.2}"),
        }
    }
}

impl fmt::Display for PathSegment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PathSegment::Move(x, y) => write!(f, "M{x} {y}"),
            PathSegment::Across(x) => write!(f, "H{x}"),
            PathSegment::Down(y) => write!(f, "V{y}"),
            PathSegment::To(x, y) => write!(f, "L{x} {y}"),
        }
    }
}

fn escape_text(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
