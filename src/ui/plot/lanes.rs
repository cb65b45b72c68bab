//! Where everything of a plot lies: lanes one below the other, or one for all; the values that each shows; and the reduced
//! samples, which are made anew only when samples or view have changed.

use std::ops::Range;

use egui::{Rect, pos2};

use super::axes;
use super::trace::{TimeAxis, ValueAxis};
use crate::app::recorder::{Line, LineId, Recorder};
use crate::signal::history::{Cut, Grid, Picture};

/// Between two lanes, in points.
const BETWEEN: f32 = 6.0;
/// A character of an axis label, in points: the labels' font has one width.
const LETTER: f32 = 6.7;

/// A part of the plot with an axis of values.
pub(super) struct Lane {
    pub(super) rect: Rect,
    pub(super) lines: Vec<LineId>,
    pub(super) range: (f64, f64),
    /// Between two ticks.
    pub(super) step: f64,
    /// There is nothing to be seen in it.
    pub(super) empty: bool,
}

impl Lane {
    pub(super) fn axis(&self) -> ValueAxis {
        ValueAxis::new(self.rect, self.range)
    }
}

/// The plot's parts.
pub(super) struct Layout {
    pub(super) lanes: Vec<Lane>,
    pub(super) time: TimeAxis,
    /// The lanes together.
    pub(super) chart: Rect,
}

/// Reduced samples, kept from picture to picture.
#[derive(Default)]
pub(super) struct Reduced {
    cuts: Vec<(Grid, Range<u64>, Cut)>,
    pub(super) pictures: Vec<(LineId, Picture)>,
    state: Vec<(LineId, Grid, Range<u64>)>,
}

impl Reduced {
    pub(super) fn picture(&self, line: LineId) -> Option<&Picture> {
        self.pictures.iter().find(|(own, _)| *own == line).map(|(_, picture)| picture)
    }

    /// Makes the pictures of what is shown, as far as something has changed.
    pub(super) fn update(&mut self, recorder: &Recorder, grid: &Grid) {
        self.cuts.clear();
        let shown = |id: &LineId| recorder.shown().any(|line| line.id == *id);
        self.pictures.retain(|(id, _)| shown(id));
        self.state.retain(|(id, ..)| shown(id));
        for line in recorder.shown() {
            let Some(history) = recorder.history(line) else { continue };
            let wanted = (line.id, *grid, history.all());
            if self.state.contains(&wanted) && self.picture(line.id).is_some() {
                continue;
            }
            let cut = match self.cuts.iter().position(|(own, all, _)| own == grid && *all == wanted.2) {
                Some(at) => at,
                None => {
                    self.cuts.push((*grid, history.all(), history.cut(grid)));
                    self.cuts.len() - 1
                }
            };
            let at = match self.pictures.iter().position(|(own, _)| *own == line.id) {
                Some(at) => at,
                None => {
                    self.pictures.push((line.id, Picture::default()));
                    self.pictures.len() - 1
                }
            };
            if let (Some((_, _, cut)), Some((_, picture))) = (self.cuts.get(cut), self.pictures.get_mut(at)) {
                history.picture(line.column(), cut, picture);
            }
            self.state.retain(|(id, ..)| *id != line.id);
            self.state.push(wanted);
        }
    }

    /// The least and the greatest value of what is visible, in the line's unit.
    fn extent(&self, line: &Line, time: &TimeAxis, chart: Rect) -> Option<(f64, f64)> {
        let picture = self.picture(line.id)?;
        // The neighbours beyond the edges are there for the line to lead to them, not to be fitted.
        let visible = |pixel: &&crate::signal::history::Pixel| {
            time.x(pixel.to) >= chart.left() && time.x(pixel.from) <= chart.right()
        };
        let factor = line.factor();
        let values = picture.pixels.iter().filter(visible).filter_map(|pixel| pixel.values);
        values
            .map(|values| (values.min * factor, values.max * factor))
            .map(|(one, other)| (one.min(other), one.max(other)))
            .reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }
}

/// Lays out what is shown in `rect`.
pub(super) fn layout(recorder: &Recorder, rect: Rect, pixels_per_point: f32, reduced: &mut Reduced) -> Layout {
    // How wide the labels are shows only when the values are known, which depends on the width: the widest of the picture
    // before would make it jump, so that they get the room of what is common.
    let (from, to) = recorder.window();
    let foot = 18.0;
    let groups = groups(recorder);
    let mut gutter = 44.0;
    loop {
        let chart =
            Rect::from_min_max(pos2(rect.left() + gutter, rect.top()), pos2(rect.right(), rect.bottom() - foot));
        let chart = chart.intersect(rect);
        let pixels = (chart.width() * pixels_per_point).floor().max(1.0);
        let grid = Grid::new(from, to, pixels as usize);
        let scale = f64::from(1.0 / pixels_per_point) / grid.width() as f64;
        let time = TimeAxis { from: grid.edge(0), left: chart.left(), scale, pixel: 1.0 / pixels_per_point };
        reduced.update(recorder, &grid);
        let lanes = lanes(chart, &groups, &time, reduced);
        let wide = |lane: &&Lane| {
            let label = |value| axes::value_label(value, lane.step, crate::app::Language::English).len();
            axes::ticks(lane.range.0, lane.range.1, lane.step).map(label).max().unwrap_or(0)
        };
        let needed =
            lanes.iter().filter(|lane| !lane.empty).map(|lane| wide(&lane)).max().unwrap_or(0) as f32 * LETTER + 10.0;
        if needed <= gutter || gutter >= 110.0 || rect.width() < gutter * 3.0 {
            return Layout { lanes, time, chart };
        }
        gutter = needed.min(110.0);
    }
}

/// The lines of each lane.
fn groups(recorder: &Recorder) -> Vec<Vec<&Line>> {
    let shown: Vec<&Line> = recorder.shown().collect();
    if recorder.has_one_axis() { vec![shown] } else { shown.into_iter().map(|line| vec![line]).collect() }
}

fn lanes(chart: Rect, groups: &[Vec<&Line>], time: &TimeAxis, reduced: &Reduced) -> Vec<Lane> {
    let count = groups.len().max(1) as f32;
    let height = ((chart.height() - BETWEEN * (count - 1.0)) / count).max(1.0);
    let lane = |(at, lines): (usize, &Vec<&Line>)| {
        let top = chart.top() + at as f32 * (height + BETWEEN);
        let rect = Rect::from_min_max(pos2(chart.left(), top), pos2(chart.right(), top + height));
        let shown = range(lines, time, chart, reduced);
        let range = shown.unwrap_or((0.0, 1.0));
        let step = axes::step(range.1 - range.0, f64::from((height / 28.0).max(1.0)));
        Lane { rect, lines: lines.iter().map(|line| line.id).collect(), range, step, empty: shown.is_none() }
    };
    groups.iter().enumerate().map(lane).collect()
}

/// The values that a lane shows: what the user chose, or what fits; `None` where there are none.
fn range(lines: &[&Line], time: &TimeAxis, chart: Rect, reduced: &Reduced) -> Option<(f64, f64)> {
    if let Some(range) = lines.iter().find_map(|line| line.range) {
        return Some(range);
    }
    let all = lines.iter().filter_map(|line| reduced.extent(line, time, chart));
    let least = lines.iter().map(|line| 10_f64.powi(-(line.decimals() as i32)) * 8.0).fold(f64::INFINITY, f64::min);
    let (low, high) = all.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))?;
    Some(axes::round_range(low, high, least))
}
