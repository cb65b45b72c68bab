//! Moves a cam or one of its edges during a drag. What is dragged beyond one end of the measuring range reappears at
//! the other end.

use super::edge_value;
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{Cam, CamNumber, Value};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DragTarget {
    Edge(CamNumber, Edge),
    Whole(CamNumber),
    /// An empty lane in which a cam can be drawn.
    New(CamNumber),
}

impl DragTarget {
    pub const fn cam(self) -> CamNumber {
        match self {
            DragTarget::Edge(cam, _) | DragTarget::Whole(cam) | DragTarget::New(cam) => cam,
        }
    }
}

/// Returns the cam with one edge moved by `by` steps. The cam covers at least one position, and at most all of them. An
/// edge beyond the measuring range is moved into it.
pub fn apply_drag(cam: Cam, edge: Edge, by: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    let (start, stop) = (i64::from(cam.start.get()), i64::from(cam.stop.get()));
    if start >= whole || stop >= whole {
        let to = (i64::from(edge_value(cam, edge).get()) + by).clamp(0, whole - 1);
        return move_edge(cam, edge, to, whole);
    }
    let length = (stop - start).rem_euclid(whole) + 1;
    let by = match edge {
        Edge::Start => by.clamp(length - whole, length - 1),
        Edge::Stop => by.clamp(1 - length, whole - length),
    };
    move_edge(cam, edge, i64::from(edge_value(cam, edge).get()) + by, whole)
}

/// Returns the cam with both edges moved by `by` steps. A cam with an edge beyond the range is left unchanged.
pub fn move_cam(cam: Cam, by: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    if i64::from(cam.start.get()) >= whole || i64::from(cam.stop.get()) >= whole {
        return cam;
    }
    let by = by.rem_euclid(whole);
    let start = move_edge(cam, Edge::Start, i64::from(cam.start.get()) + by, whole);
    move_edge(start, Edge::Stop, i64::from(cam.stop.get()) + by, whole)
}

/// Returns the cam between two pointer positions, in either order. They may be beyond the range.
pub fn cam_between(from: i64, to: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    let (first, last) = (from.min(to), from.max(to));
    let last = last.min(first + whole - 1);
    let none = Cam { start: Value::default(), stop: Value::default() };
    move_edge(move_edge(none, Edge::Start, first, whole), Edge::Stop, last, whole)
}

fn move_edge(cam: Cam, edge: Edge, to: i64, whole: i64) -> Cam {
    // The position is below the range, which has at most 25 bits.
    let to = Value::from_word(to.rem_euclid(whole) as u32);
    match edge {
        Edge::Start => Cam { start: to, ..cam },
        Edge::Stop => Cam { stop: to, ..cam },
    }
}
