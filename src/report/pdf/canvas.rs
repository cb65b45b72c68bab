//! Pages as lists of graphic elements, and their conversion to a PDF document. Lengths are in points from the top left
//! corner.

use krilla::color::rgb;
use krilla::geom::{PathBuilder, Point, Rect, Size, Transform};
use krilla::image::Image;
use krilla::paint::{Fill, Stroke};
use krilla::surface::Surface;

use super::typeface::{Face, Typefaces};
use crate::drawing::{Drawing, DrawingLength, DrawingShape, LabelAlign, PathSegment};

/// An RGB colour.
pub(super) type Colour = [u8; 3];

pub(super) const TEXT: Colour = [0x1a, 0x1e, 0x22];
pub(super) const MUTED_COLOUR: Colour = [0x5c, 0x67, 0x70];
pub(super) const LINE: Colour = [0xd5, 0xda, 0xdf];

/// A graphic element of a page.
#[derive(Clone, Debug)]
pub(super) enum PageMark {
    /// A text. The coordinates are those of the left end of its baseline.
    Text { x: f32, y: f32, size: f32, face: Face, colour: Colour, text: String },
    /// A horizontal line.
    Rule { x: f32, y: f32, width: f32, thickness: f32, colour: Colour },
    /// A drawing at the given scale.
    Drawing { x: f32, y: f32, scale: f32, drawing: Drawing },
    /// A raster image.
    Image { x: f32, y: f32, width: f32, height: f32, image: Image },
}

pub(super) struct Painter<'a, 'b> {
    pub(super) surface: &'a mut Surface<'b>,
    pub(super) faces: &'a Typefaces,
}

impl Painter<'_, '_> {
    pub(super) fn paint(&mut self, mark: &PageMark) {
        match mark {
            PageMark::Text { x, y, size, face, colour, text } => self.text(*x, *y, *size, *face, *colour, text),
            PageMark::Rule { x, y, width, thickness, colour } => {
                self.line([(*x, *y), (x + width, *y)], *thickness, *colour);
            }
            PageMark::Drawing { x, y, scale, drawing } => {
                self.surface.push_transform(&Transform::from_row(*scale, 0.0, 0.0, *scale, *x, *y));
                drawing.shapes.iter().for_each(|shape| self.shape(shape));
                self.surface.pop();
            }
            PageMark::Image { x, y, width, height, image } => {
                let Some(size) = Size::from_wh(*width, *height) else { return };
                self.surface.push_transform(&Transform::from_translate(*x, *y));
                self.surface.draw_image(image.clone(), size);
                self.surface.pop();
            }
        }
    }

    fn text(&mut self, x: f32, y: f32, size: f32, face: Face, colour: Colour, text: &str) {
        self.surface.set_fill(Some(fill(colour)));
        self.surface.set_stroke(None);
        let mut at = x;
        for run in self.faces.runs(face, size, text) {
            self.surface.draw_glyphs(Point::from_xy(at, y), &run.glyphs, run.font, &run.text, size, false);
            at += run.width;
        }
    }

    fn line(&mut self, points: impl IntoIterator<Item = (f32, f32)>, thickness: f32, colour: Colour) {
        let mut path = PathBuilder::new();
        for (index, (x, y)) in points.into_iter().enumerate() {
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        let Some(path) = path.finish() else { return };
        self.surface.set_fill(None);
        self.surface.set_stroke(Some(stroke(thickness, colour)));
        self.surface.draw_path(&path);
    }

    fn shape(&mut self, shape: &DrawingShape) {
        match shape {
            DrawingShape::Box { x, y, width, height, fill: colour, line } => {
                let [x, y, width, height] = [x, y, width, height].map(units);
                let Some(rect) = Rect::from_xywh(x, y, width, height) else { return };
                let mut path = PathBuilder::new();
                path.push_rect(rect);
                let Some(path) = path.finish() else { return };
                self.surface.set_fill(Some(fill(parse_colour(colour))));
                self.surface.set_stroke(Some(stroke(1.0, parse_colour(line))));
                self.surface.draw_path(&path);
            }
            DrawingShape::Line { path, colour } => {
                for run in polylines(path) {
                    self.line(run, 1.0, parse_colour(colour));
                }
            }
            DrawingShape::Text(label) => {
                let face = if label.is_bold { Face::Strong } else { Face::Text };
                let size = label.size as f32;
                let width = self.faces.width(face, size, &label.text);
                let before = match label.align {
                    LabelAlign::Left => 0.0,
                    LabelAlign::Centre => width / 2.0,
                    LabelAlign::Right => width,
                };
                let colour = label.colour.map_or([0, 0, 0], parse_colour);
                self.text(units(&label.x) - before, units(&label.y), size, face, colour, &label.text);
            }
        }
    }
}

/// Returns the points of each polyline of a path.
fn polylines(path: &[PathSegment]) -> Vec<Vec<(f32, f32)>> {
    let mut runs: Vec<Vec<(f32, f32)>> = Vec::new();
    for segment in path {
        let last = runs.last().and_then(|run| run.last()).copied().unwrap_or_default();
        let next = match segment {
            PathSegment::Move(x, y) => {
                runs.push(vec![(units(x), units(y))]);
                continue;
            }
            PathSegment::Across(x) => (units(x), last.1),
            PathSegment::Down(y) => (last.0, units(y)),
            PathSegment::To(x, y) => (units(x), units(y)),
        };
        if let Some(run) = runs.last_mut() {
            run.push(next);
        }
    }
    runs
}

fn units(length: &DrawingLength) -> f32 {
    length.units() as f32
}

fn fill([red, green, blue]: Colour) -> Fill {
    Fill { paint: rgb::Color::new(red, green, blue).into(), ..Fill::default() }
}

fn stroke(width: f32, [red, green, blue]: Colour) -> Stroke {
    Stroke { paint: rgb::Color::new(red, green, blue).into(), width, ..Stroke::default() }
}

/// Parses the colour of a drawing. An invalid colour becomes black.
fn parse_colour(text: &str) -> Colour {
    let digits: Vec<u8> = text
        .chars()
        .skip(1)
        .filter_map(|digit| digit.to_digit(16))
        .filter_map(|digit| u8::try_from(digit).ok())
        .collect();
    match *digits.as_slice() {
        [red, green, blue] => [red * 17, green * 17, blue * 17],
        [r, red, g, green, b, blue] => [r * 16 + red, g * 16 + green, b * 16 + blue],
        _ => [0, 0, 0],
    }
}
