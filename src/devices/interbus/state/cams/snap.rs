//! Snaps a dragged edge to other cams and to grid lines.

use super::{Chart, DragTarget, edge_value, grid};
use crate::devices::interbus::profile::{Edge, Scale};
use crate::devices::interbus::protocol::{Cam, CamNumber};

/// What a dragged edge snaps to, and from how far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapSettings {
    /// Maximum distance to a target in steps.
    pub reach: f64,
    /// Minimum distance between grid lines in steps, or `None` to ignore grid lines.
    pub apart: Option<f64>,
    /// Whether to snap to the edges of other cams.
    pub edges: bool,
}

impl SnapSettings {
    pub const DISABLED: SnapSettings = SnapSettings { reach: 0.0, apart: None, edges: false };

    /// Creates settings in which an edge snaps to everything within six points. Grid lines are at least ten points
    /// apart.
    pub const fn enabled(steps_in_point: f64) -> Self {
        SnapSettings { reach: steps_in_point * SNAP_DISTANCE, apart: Some(steps_in_point * GRID), edges: true }
    }
}

/// Maximum distance to a target in points.
const SNAP_DISTANCE: f64 = 6.0;
/// Minimum distance between grid lines in points.
const GRID: f64 = 10.0;

/// Returns how far to move a cam so that its edge snaps to the nearest target. If no target is near, this is `by`
/// rounded to whole steps.
pub fn snap_distance(chart: &Chart, scale: &Scale, hold: DragTarget, cam: Cam, by: f64, snap: &SnapSettings) -> i64 {
    let whole = by.round() as i64;
    let edges: &[Edge] = match hold {
        DragTarget::Edge(_, Edge::Start) => &[Edge::Start],
        DragTarget::Edge(_, Edge::Stop) => &[Edge::Stop],
        DragTarget::Whole(_) | DragTarget::New(_) => &[Edge::Start, Edge::Stop],
    };
    let mut best: Option<(f64, i64)> = None;
    for edge in edges {
        let from = f64::from(edge_value(cam, *edge).get());
        for target in snap_targets(chart, scale, hold.cam(), *edge, from + by, snap) {
            let distance = (target - from - by).abs();
            if distance <= snap.reach && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, (target - from).round() as i64));
            }
        }
    }
    best.map_or(whole, |(_, by)| by)
}

/// Returns the possible targets for an edge. The first of several equally near ones is used.
fn snap_targets(chart: &Chart, scale: &Scale, own: CamNumber, edge: Edge, at: f64, snap: &SnapSettings) -> Vec<f64> {
    let range = f64::from(chart.range.max(1));
    // The targets are in the turn that the pointer has reached.
    let turn = (at / range).floor() * range;
    let mut targets = Vec::new();
    if snap.edges {
        let others = chart.lanes.iter().filter(|lane| lane.cam != own && lane.on);
        for cam in others.filter_map(|lane| lane.edges) {
            let (start, stop) = (f64::from(cam.start.get()), f64::from(cam.stop.get()));
            // The cam can switch together with the other cam, or directly before or after it.
            let (same, next) = match edge {
                Edge::Start => (start, stop + 1.0),
                Edge::Stop => (stop, start - 1.0),
            };
            targets.extend([same, next].into_iter().flat_map(|at| [turn + at, turn + at + range, turn + at - range]));
        }
    }
    if let Some(apart) = snap.apart {
        targets.extend(grid::grid_lines_around(scale, apart, at - turn, 0).into_iter().map(|line| turn + line));
    }
    targets
}
