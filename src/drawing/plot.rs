//! A printable plot of curves with two axes.

use super::ticks::{decimal_places, step_1_2_5, tick_values};
use super::{Drawing, DrawingLabel, DrawingShape, FAINT_COLOUR, LabelAlign, PathSegment};

/// A plot of one or more curves.
pub struct Plot<'a> {
    /// Title, which describes the plot to a screen reader.
    pub title: String,
    /// Size of the drawing in drawing units.
    pub size: (u32, u32),
    /// Range of the horizontal axis.
    pub x: (f64, f64),
    /// Range of the vertical axis.
    pub y: (f64, f64),
    /// Labels of the horizontal and the vertical axis.
    pub labels: (String, String),
    /// Curves in drawing order.
    pub curves: Vec<Curve>,
    /// Formats a tick value with the given number of decimals.
    pub format: &'a dyn Fn(f64, usize) -> String,
}

/// A curve of a plot.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Points from left to right or along the curve, in axis units.
    pub points: Vec<(f64, f64)>,
    /// Colour of the curve.
    pub colour: &'static str,
    /// Name in the legend, or `None` to omit the curve from it.
    pub name: Option<String>,
}

const LEFT: f64 = 52.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 34.0;
/// Minimum distance between two axis labels.
const MIN_LABEL_DISTANCE: (f64, f64) = (70.0, 30.0);
const GRID: &str = "#d5dadf";

impl Plot<'_> {
    /// Returns the plot as a drawing.
    pub fn to_drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(self.size.0, self.size.1, self.title.as_str());
        self.draw_axes(&mut drawing);
        for curve in &self.curves {
            for run in self.visible_runs(&curve.points) {
                let path = run.into_iter().enumerate().map(|(index, (x, y))| match index {
                    0 => PathSegment::Move(x.into(), y.into()),
                    _ => PathSegment::To(x.into(), y.into()),
                });
                drawing.shapes.push(DrawingShape::Line { path: path.collect(), colour: curve.colour });
            }
        }
        self.draw_legend(&mut drawing);
        drawing
    }

    fn right(&self) -> f64 {
        f64::from(self.size.0) - RIGHT
    }

    fn bottom(&self) -> f64 {
        f64::from(self.size.1) - BOTTOM
    }

    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let part = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low).max(f64::MIN_POSITIVE);
        (LEFT + part(x, self.x) * (self.right() - LEFT), self.bottom() - part(y, self.y) * (self.bottom() - TOP))
    }

    /// Returns the visible parts of a curve in drawing units.
    fn visible_runs(&self, points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
        let within = |(x, y): (f64, f64)| (self.x.0..=self.x.1).contains(&x) && (self.y.0..=self.y.1).contains(&y);
        let mut runs: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
        for point in points {
            match (within(*point), runs.last_mut()) {
                (true, Some(run)) => run.push(self.place(*point)),
                (false, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
                _ => {}
            }
        }
        runs.retain(|run| run.len() > 1);
        runs
    }

    fn draw_axes(&self, drawing: &mut Drawing) {
        let (right, bottom) = (self.right(), self.bottom());
        let most = ((right - LEFT) / MIN_LABEL_DISTANCE.0, (bottom - TOP) / MIN_LABEL_DISTANCE.1);
        let steps = (step_1_2_5(self.x.1 - self.x.0, most.0), step_1_2_5(self.y.1 - self.y.0, most.1));
        for value in tick_values(self.x.0, self.x.1, steps.0) {
            let (x, _) = self.place((value, self.y.0));
            let path = vec![PathSegment::Move(x.into(), TOP.into()), PathSegment::Down(bottom.into())];
            let label = DrawingLabel::new(x, bottom + 13.0, 9, (self.format)(value, decimal_places(steps.0)));
            drawing.shapes.extend([
                DrawingShape::Line { path, colour: GRID },
                DrawingShape::Text(faint(DrawingLabel { align: LabelAlign::Centre, ..label })),
            ]);
        }
        for value in tick_values(self.y.0, self.y.1, steps.1) {
            let (_, y) = self.place((self.x.0, value));
            let path = vec![PathSegment::Move(LEFT.into(), y.into()), PathSegment::Across(right.into())];
            let label = DrawingLabel::new(LEFT - 6.0, y + 3.0, 9, (self.format)(value, decimal_places(steps.1)));
            drawing.shapes.extend([
                DrawingShape::Line { path, colour: GRID },
                DrawingShape::Text(faint(DrawingLabel { align: LabelAlign::Right, ..label })),
            ]);
        }
        let path = vec![
            PathSegment::Move(LEFT.into(), TOP.into()),
            PathSegment::Down(bottom.into()),
            PathSegment::Across(right.into()),
        ];
        let below = DrawingLabel::new(right, bottom + 28.0, 9, self.labels.0.as_str());
        let above = DrawingLabel::new(LEFT, TOP - 8.0, 9, self.labels.1.as_str());
        drawing.shapes.extend([
            DrawingShape::Line { path, colour: FAINT_COLOUR },
            DrawingShape::Text(faint(DrawingLabel { align: LabelAlign::Right, ..below })),
            DrawingShape::Text(faint(DrawingLabel { align: LabelAlign::Centre, ..above })),
        ]);
    }

    /// Draws the names of the curves below the plot, in the colours of their lines.
    fn draw_legend(&self, drawing: &mut Drawing) {
        /// Assumed average width of a character in the legend.
        const CHARACTER: f64 = 5.6;
        let y = self.bottom() + 28.0;
        let mut x = LEFT;
        for curve in &self.curves {
            let Some(name) = &curve.name else { continue };
            let path = vec![PathSegment::Move(x.into(), (y - 3.0).into()), PathSegment::Across((x + 16.0).into())];
            drawing.shapes.extend([
                DrawingShape::Line { path, colour: curve.colour },
                DrawingShape::Text(DrawingLabel::new(x + 21.0, y, 9, name.as_str())),
            ]);
            x += 36.0 + name.chars().count() as f64 * CHARACTER;
        }
    }
}

fn faint(label: DrawingLabel) -> DrawingLabel {
    DrawingLabel { colour: Some(FAINT_COLOUR), ..label }
}
