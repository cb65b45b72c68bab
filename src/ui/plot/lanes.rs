//! The layout of a plot and the values in each lane. Each line has its own lane, or all lines share one. Samples are
//! reduced again only if the samples or the view have changed.

use std::ops::Range;

use egui::{Rect, pos2};

use super::axes;
use super::trace::{TimeAxis, ValueAxis};
use crate::analysis::history::{Grid, GridColumns, RenderedHistory};
use crate::app::recorder::{Recorder, SampleGroupStamp, Series, SeriesId};

/// Gap between two lanes, in points.
const LANE_GAP: f32 = 6.0;
/// Minimum width of the value labels on the left, in points.
const MIN_LABEL_WIDTH: f32 = 44.0;
/// Maximum width of the value labels on the left, in points.
const MAX_LABEL_WIDTH: f32 = 110.0;
/// Height of the time labels at the bottom, in points.
const TIME_LABEL_HEIGHT: f32 = 18.0;
/// Minimum distance between two ticks of a normal lane, in points.
const TICK_SPACING: f32 = 28.0;
/// Minimum distance between two ticks of a low lane, in points.
const LOW_LANE_TICK_SPACING: f32 = 13.0;
/// Width in points of a character of an axis label, whose font is monospaced.
const CHARACTER_WIDTH: f32 = 6.7;

pub(super) struct Lane {
    pub(super) rect: Rect,
    pub(super) lines: Vec<SeriesId>,
    pub(super) range: (f64, f64),
    pub(super) step: f64,
    pub(super) empty: bool,
}

impl Lane {
    pub(super) fn value_axis(&self) -> ValueAxis {
        ValueAxis::new(self.rect, self.range)
    }
}

pub(super) struct Layout {
    pub(super) lanes: Vec<Lane>,
    pub(super) time: TimeAxis,
    pub(super) chart: Rect,
}

/// Samples reduced to the pixel columns of a lane, cached between redraws.
#[derive(Default)]
pub(super) struct ReducedLane {
    pictures: Vec<(SeriesId, RenderedHistory)>,
    made: Vec<(SeriesId, RenderInputs, Option<i64>)>,
    gutter: f32,
}

/// The inputs from which a lane's samples are reduced. The result is recalculated only if they change.
#[derive(Clone, PartialEq)]
struct RenderInputs {
    samples: Option<SampleGroupStamp>,
    all: Range<u64>,
    grid: Grid,
}

impl ReducedLane {
    pub(super) fn rendered_line(&self, line: SeriesId) -> Option<&RenderedHistory> {
        self.pictures.iter().find(|(own, _)| *own == line).map(|(_, picture)| picture)
    }

    /// Updates the reduced samples of the visible lines if any input has changed.
    fn update(&mut self, recorder: &Recorder, grid: &Grid) {
        let shown = |id: &SeriesId| recorder.visible_series().any(|line| line.id == *id);
        self.pictures.retain(|(id, _)| shown(id));
        self.made.retain(|(id, ..)| shown(id));
        let mut cuts: Vec<(RenderInputs, GridColumns)> = Vec::new();
        for line in recorder.visible_series() {
            let Some(history) = recorder.history(line) else { continue };
            let wanted = RenderInputs { samples: recorder.group_stamp(line), all: history.indices(), grid: *grid };
            let range = line.sample_wrap_range();
            if self.made.iter().any(|(id, made, own)| *id == line.id && *made == wanted && *own == range) {
                continue;
            }
            // Lines share a cut if their samples were taken together.
            if !cuts.iter().any(|(made, _)| *made == wanted) {
                cuts.push((wanted.clone(), history.divide_into_pixels(grid)));
            }
            if self.rendered_line(line.id).is_none() {
                self.pictures.push((line.id, RenderedHistory::default()));
            }
            let cut = cuts.iter().find(|(made, _)| *made == wanted);
            let picture = self.pictures.iter_mut().find(|(id, _)| *id == line.id);
            if let (Some((_, cut)), Some((_, picture))) = (cut, picture) {
                history.render_column(line.column(), cut, picture);
                if let Some(range) = range {
                    picture.wrap(range);
                }
            }
            self.made.retain(|(id, ..)| *id != line.id);
            self.made.push((line.id, wanted, range));
        }
    }

    /// Returns the minimum and maximum of the visible values, in the line's unit.
    fn value_extent(&self, line: &Series, time: &TimeAxis, chart: Rect) -> Option<(f64, f64)> {
        let picture = self.rendered_line(line.id)?;
        // The samples beyond the edges only continue the line. They do not affect the range.
        let visible = |pixel: &&crate::analysis::history::Pixel| {
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

pub(super) fn compute_layout(
    recorder: &Recorder,
    rect: Rect,
    pixels_per_point: f32,
    reduced: &mut ReducedLane,
) -> Layout {
    // The width of the labels depends on the values, and the values depend on the width. The width of the previous
    // frame is tried first, so a picture that changes little is calculated only once.
    let (from, to) = recorder.window_bounds();
    let groups = lane_groups(recorder);
    let mut gutter = reduced.gutter.clamp(MIN_LABEL_WIDTH, MAX_LABEL_WIDTH);
    loop {
        let corner = pos2(rect.left() + gutter, rect.top());
        let chart = Rect::from_min_max(corner, pos2(rect.right(), rect.bottom() - TIME_LABEL_HEIGHT)).intersect(rect);
        let pixels = (chart.width() * pixels_per_point).floor().max(1.0);
        let grid = Grid::new(from, to, pixels as usize);
        let scale = f64::from(1.0 / pixels_per_point) / grid.width() as f64;
        let time = TimeAxis { from: grid.pixel_start(0), left: chart.left(), scale, pixel: 1.0 / pixels_per_point };
        reduced.update(recorder, &grid);
        let lanes = lay_out_lanes(chart, &groups, &time, reduced);
        let needed = (max_label_len(&lanes) as f32 * CHARACTER_WIDTH + 10.0).clamp(MIN_LABEL_WIDTH, MAX_LABEL_WIDTH);
        if needed <= gutter || rect.width() < gutter * 3.0 {
            // Space is released in the next frame only if it exceeds a character or two, so the width does not change
            // with every sample.
            reduced.gutter = if gutter - needed > 2.0 * CHARACTER_WIDTH { needed } else { gutter };
            return Layout { lanes, time, chart };
        }
        gutter = needed;
    }
}

fn max_label_len(lanes: &[Lane]) -> usize {
    let longest = |lane: &Lane| {
        let label = |value| axes::value_label(value, lane.step, crate::app::Language::English).len();
        axes::tick_values(lane.range.0, lane.range.1, lane.step).map(label).max().unwrap_or(0)
    };
    lanes.iter().filter(|lane| !lane.empty).map(longest).max().unwrap_or(0)
}

fn lane_groups(recorder: &Recorder) -> Vec<Vec<&Series>> {
    let shown: Vec<&Series> = recorder.visible_series().collect();
    if recorder.has_one_axis() { vec![shown] } else { shown.into_iter().map(|line| vec![line]).collect() }
}

fn lay_out_lanes(chart: Rect, groups: &[Vec<&Series>], time: &TimeAxis, reduced: &ReducedLane) -> Vec<Lane> {
    let count = groups.len().max(1) as f32;
    let height = ((chart.height() - LANE_GAP * (count - 1.0)) / count).max(1.0);
    let lane = |(at, lines): (usize, &Vec<&Series>)| {
        let top = chart.top() + at as f32 * (height + LANE_GAP);
        let rect = Rect::from_min_max(pos2(chart.left(), top), pos2(chart.right(), top + height));
        let shown = lane_range(lines, time, chart, reduced);
        let range = shown.unwrap_or((0.0, 1.0));
        let step = value_step(range, height);
        Lane { rect, lines: lines.iter().map(|line| line.id).collect(), range, step, empty: shown.is_none() }
    };
    groups.iter().enumerate().map(lane).collect()
}

/// Returns the step between two ticks of a lane. Ticks are closer in a small lane, where at least two must be visible.
fn value_step((low, high): (f64, f64), height: f32) -> f64 {
    let of_distance = |distance: f32| axes::step_1_2_5(high - low, f64::from((height / distance).max(2.0)));
    let step = of_distance(TICK_SPACING);
    if axes::tick_values(low, high, step).count() < 2 { of_distance(LOW_LANE_TICK_SPACING) } else { step }
}

/// Returns the value range of a lane, either chosen by the user or fitted to the values. Returns `None` if the lane has
/// no values.
fn lane_range(lines: &[&Series], time: &TimeAxis, chart: Rect, reduced: &ReducedLane) -> Option<(f64, f64)> {
    if let Some(range) = lines.iter().find_map(|line| line.range) {
        return Some(range);
    }
    let all = lines.iter().filter_map(|line| reduced.value_extent(line, time, chart));
    let least =
        lines.iter().map(|line| 10_f64.powi(-(line.decimal_places() as i32)) * 8.0).fold(f64::INFINITY, f64::min);
    let (low, high) = all.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))?;
    Some(axes::round_range(low, high, least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::SampleTime;
    use crate::analysis::history::{ColumnPart, Kind};
    use crate::app::Text;
    use crate::app::recorder::{RecorderAction, Scale};

    /// Returns a recorder with 1000 samples of the same value, one microsecond apart.
    fn recorder(value: f64) -> Recorder {
        let mut recorder = Recorder::new(1_000_000);
        let group = recorder.add_group(&[Kind::Real], 10_000, None);
        let scales = vec![Scale::new("unit.degrees", 1.0, 4)];
        recorder.add_line(Series::new(group, 0, Text::new("recorder.position"), "value", scales));
        let times: Vec<SampleTime> = (0..1000).map(|at| SampleTime::from_nanoseconds(at * 1000)).collect();
        recorder.append(group, &times, &[ColumnPart::from_reals(&[value; 1000])]).unwrap();
        recorder
    }

    fn shown(reduced: &ReducedLane, recorder: &Recorder) -> f64 {
        let picture = reduced.rendered_line(recorder.series()[0].id).unwrap();
        picture.pixels[0].values.unwrap().first
    }

    const RECT: Rect = Rect { min: egui::Pos2::ZERO, max: pos2(400.0, 200.0) };

    #[test]
    fn lane_ticks_do_not_overlap() {
        for value in [0.0, 4660.75, -33_488_896.0, 0.58472] {
            for height in [27.0, 40.0, 60.0, 90.0, 200.0] {
                let (low, high) = axes::round_range(value, value, 8e-5);
                let step = value_step((low, high), height);
                let count = axes::tick_values(low, high, step).count();
                assert!(count >= 2, "{count} for {value} at a height of {height}");
                let distance = step / (high - low) * f64::from(height);
                assert!(distance >= 11.0, "{distance} for {value} at a height of {height}");
            }
        }
    }

    #[test]
    fn distinguishes_recorders() {
        let mut reduced = ReducedLane::default();
        let (one, mut other) = (recorder(1.0), recorder(2.0));
        compute_layout(&one, RECT, 1.0, &mut reduced);
        assert_eq!(shown(&reduced, &one), 1.0);
        compute_layout(&other, RECT, 1.0, &mut reduced);
        assert_eq!(shown(&reduced, &other), 2.0, "the same times, other values");
        other.handle_action(RecorderAction::Clear);
        compute_layout(&other, RECT, 1.0, &mut reduced);
        let line = other.series()[0].id;
        assert!(reduced.rendered_line(line).unwrap().pixels.is_empty());
    }

    #[test]
    fn computes_plot_with_long_labels_once() {
        let mut reduced = ReducedLane::default();
        let recorder = recorder(123_456.789_1);
        compute_layout(&recorder, RECT, 1.0, &mut reduced);
        let (made, gutter) = (reduced.made.clone(), reduced.gutter);
        assert!(gutter > MIN_LABEL_WIDTH);
        let chart = compute_layout(&recorder, RECT, 1.0, &mut reduced).chart;
        assert!(reduced.made == made, "nothing has changed");
        assert_eq!(chart.left(), RECT.left() + gutter);
        // Wide labels of an earlier picture must not reserve space forever.
        let short = self::recorder(1.0);
        compute_layout(&short, RECT, 1.0, &mut reduced);
        assert!(compute_layout(&short, RECT, 1.0, &mut reduced).chart.left() < chart.left());
    }
}
