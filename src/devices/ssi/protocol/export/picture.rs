//! A picture as shapes on paper: written as SVG here, drawn by the window from the same shapes.

use std::fmt::{self, Write};

/// A picture. Its paper is white.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// What it shows; its first text, too.
    pub title: String,
    /// In units of the shapes.
    pub width: u32,
    /// In units of the shapes.
    pub height: u32,
    /// From the lowest to the highest.
    pub shapes: Vec<PictureShape>,
}

/// A length along the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PictureLength {
    /// On the grid.
    Whole(u32),
    /// To scale; SVG has hundredths.
    Scaled(f64),
}

/// A shape. Colours are `#rrggbb` or `#rgb`.
#[derive(Clone, Debug, PartialEq)]
pub enum PictureShape {
    /// A box with a thin border.
    Box {
        /// Left end.
        x: PictureLength,
        /// Upper end.
        y: u32,
        /// Along the picture.
        width: PictureLength,
        /// Downwards.
        height: u32,
        /// Colour inside.
        fill: &'static str,
        /// Colour of the border.
        line: &'static str,
    },
    /// A thin line through all points; steps along x and y alone.
    Line {
        /// It begins with a [`PathStep::Move`].
        path: Vec<PathStep>,
        /// Its colour.
        colour: &'static str,
    },
    /// A line of text.
    Text(PictureLabel),
}

/// A step of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathStep {
    /// Without drawing, to a point.
    Move(PictureLength, u32),
    /// Along x.
    Across(PictureLength),
    /// Along y.
    Down(u32),
}

/// A line of text, above its baseline.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLabel {
    /// Its left end or its middle.
    pub x: PictureLength,
    /// Of the baseline.
    pub y: u32,
    /// Height of its letters.
    pub size: u32,
    /// In bold letters.
    pub is_bold: bool,
    /// None: black.
    pub colour: Option<&'static str>,
    /// `x` is its middle, else its left end.
    pub is_centred: bool,
    /// Its words.
    pub text: String,
}

/// Distance of everything from the edges.
pub(super) const MARGIN: u32 = 16;
/// Lines and texts that are not the main thing.
pub(super) const FAINT: &str = "#555";

const FONT: &str = "font-family=\"Inter, Arial, sans-serif\"";

impl Picture {
    pub(super) fn titled(width: u32, height: u32, title: &str) -> Self {
        let heading = PictureLabel { is_bold: true, ..PictureLabel::new(PictureLength::Whole(MARGIN), 20, 12, title) };
        Picture { title: title.to_owned(), width, height, shapes: vec![PictureShape::Text(heading)] }
    }

    /// Writes it as SVG.
    pub fn svg(&self) -> String {
        let Picture { width, height, .. } = self;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\" aria-label=\"{}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            escaped(&self.title)
        );
        for shape in &self.shapes {
            // Writing into a String does not fail.
            let _ = match shape {
                PictureShape::Box { x, y, width, height, fill, line } => writeln!(
                    svg,
                    "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\" stroke=\"{line}\"/>"
                ),
                PictureShape::Line { path, colour } => {
                    let steps: Vec<String> = path.iter().map(PathStep::to_string).collect();
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
        writeln!(svg, " {FONT}>{}</text>", escaped(&self.text))
    }
}

impl PictureLength {
    /// In units of the picture.
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

impl fmt::Display for PathStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PathStep::Move(x, y) => write!(f, "M{x} {y}"),
            PathStep::Across(x) => write!(f, "H{x}"),
            PathStep::Down(y) => write!(f, "V{y}"),
        }
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
