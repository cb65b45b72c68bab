//! Layout of the cam lanes.

use egui::{Rect, Vec2, pos2};

use crate::devices::interbus::protocol::{CamNumber, Program};
use crate::devices::interbus::state::cams::{PositionRange, VisibleRange};

const RULER_HEIGHT: f32 = 20.0;
const LANE_HEIGHT: f32 = 28.0;
/// Maximum width of the lane headers in points.
const MAX_HEAD_WIDTH: f32 = 208.0;
const HEAD_PART: f32 = 0.34;
/// Space to the right of the lanes for half of a ruler number.
const RIGHT_MARGIN: f32 = 16.0;
/// Width of the area in which an edge can be grabbed.
const GRIP_WIDTH: f32 = 9.0;

/// Areas of the chart: headers on the left, and the visible part of the range on the right.
#[derive(Clone, Debug)]
pub(super) struct PlotArea {
    pub(super) head: Rect,
    pub(super) plot: Rect,
    /// Ruler in steps.
    pub(super) ruler: Rect,
    /// Ruler in machine units. It is empty if the unit is the step.
    pub(super) units: Rect,
    pub(super) view: VisibleRange,
}

impl PlotArea {
    pub(super) fn size(width: f32, units: bool) -> Vec2 {
        let rulers = if units { 2.0 * RULER_HEIGHT } else { RULER_HEIGHT };
        Vec2::new(width, rulers + Program::CAMS as f32 * LANE_HEIGHT)
    }

    pub(super) fn new(outer: Rect, view: VisibleRange, gap: f32) -> Self {
        let top = outer.top() + RULER_HEIGHT;
        let bottom = top + Program::CAMS as f32 * LANE_HEIGHT;
        let left = outer.left() + MAX_HEAD_WIDTH.min(outer.width() * HEAD_PART);
        let right = (outer.right() - RIGHT_MARGIN).max(left + 1.0);
        let plot = Rect::from_min_max(pos2(left, top), pos2(right, bottom));
        PlotArea {
            head: Rect::from_min_max(pos2(outer.left(), top), pos2(left - gap, bottom)),
            plot,
            ruler: Rect::from_min_max(pos2(left, outer.top()), pos2(right, top)),
            units: Rect::from_min_max(pos2(left, bottom), pos2(right, outer.bottom())),
            view,
        }
    }

    pub(super) fn steps_per_point(&self) -> f64 {
        self.view.length() / f64::from(self.plot.width().max(1.0))
    }

    pub(super) fn x(&self, position: f64) -> f32 {
        let part = self.view.fraction_at(position).clamp(-1e4, 1e4);
        self.plot.left() + part as f32 * self.plot.width()
    }

    /// Returns the position at `x`, which may be beyond the lanes.
    pub(super) fn position(&self, x: f32) -> f64 {
        self.view.position(f64::from((x - self.plot.left()) / self.plot.width().max(1.0)))
    }

    pub(super) fn lane_rect(&self, cam: CamNumber) -> Rect {
        let top = self.plot.top() + f32::from(cam.get()) * LANE_HEIGHT;
        Rect::from_min_size(pos2(self.plot.left(), top), Vec2::new(self.plot.width(), LANE_HEIGHT))
    }

    pub(super) fn lane_header_rect(&self, cam: CamNumber) -> Rect {
        let lane = self.lane_rect(cam);
        Rect::from_x_y_ranges(self.head.x_range(), lane.y_range())
    }

    /// Returns the rectangle of a cam section in its lane, or `None` if it is out of view. Narrow sections are widened
    /// to a minimum.
    pub(super) fn bar_rect(&self, cam: CamNumber, stretch: PositionRange) -> Option<Rect> {
        let (left, right) = (self.x(f64::from(stretch.first)), self.x(f64::from(stretch.last) + 1.0));
        if right < self.plot.left() || left > self.plot.right() {
            return None;
        }
        let bar = Rect::from_x_y_ranges(left..=right.max(left + 2.0), self.lane_rect(cam).y_range());
        // The rectangle is limited to the lanes, because nothing must be drawn far beyond them.
        Some(bar.shrink2(Vec2::new(0.0, 5.0)).intersect(self.plot.expand2(Vec2::new(GRIP_WIDTH, 0.0))))
    }

    /// Returns the area in which an edge can be grabbed. If the cam is wide enough, most of the area is inside it, so
    /// that adjoining edges can be told apart.
    pub(super) fn grip_rect(&self, cam: CamNumber, x: f32, is_start: bool, width: f32) -> Rect {
        let inside = (width / 2.0).clamp(1.0, GRIP_WIDTH - 2.0);
        let (left, right) =
            if is_start { (x - GRIP_WIDTH + inside, x + inside) } else { (x - inside, x + GRIP_WIDTH - inside) };
        Rect::from_x_y_ranges(left..=right, self.lane_rect(cam).shrink2(Vec2::new(0.0, 2.0)).y_range())
    }

    pub(super) fn is_visible(&self, x: f32) -> bool {
        x >= self.plot.left() - 1.0 && x <= self.plot.right() + 1.0
    }
}
