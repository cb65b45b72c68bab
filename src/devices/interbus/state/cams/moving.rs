//! Changes to a cam while an edge is dragged, or while the cam is moved or drawn. The measuring range wraps: a part
//! dragged over one end reappears at the other.

use super::of_edge;
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{Cam, CamNumber, Value};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DragTarget {
    Edge(CamNumber, Edge),
    Whole(CamNumber),
    /// An empty lane, in which a new cam can be drawn.
    New(CamNumber),
}

impl DragTarget {
    pub const fn cam(self) -> CamNumber {
        match self {
            DragTarget::Edge(cam, _) | DragTarget::Whole(cam) | DragTarget::New(cam) => cam,
        }
    }
}

/// Returns the cam with one edge moved by `by` steps, backwards if negative. A cam always keeps at least one position
/// and covers at most all of them; edges beyond the range are brought within it.
pub fn apply_drag(cam: Cam, edge: Edge, by: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    let (start, stop) = (i64::from(cam.start.get()), i64::from(cam.stop.get()));
    if start >= whole || stop >= whole {
        let to = (i64::from(of_edge(cam, edge).get()) + by).clamp(0, whole - 1);
        return with(cam, edge, to, whole);
    }
    let length = (stop - start).rem_euclid(whole) + 1;
    let by = match edge {
        Edge::Start => by.clamp(length - whole, length - 1),
        Edge::Stop => by.clamp(1 - length, whole - length),
    };
    with(cam, edge, i64::from(of_edge(cam, edge).get()) + by, whole)
}

/// Returns the cam moved by `by` steps as a whole. Parts beyond the range stay there.
pub fn moved(cam: Cam, by: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    if i64::from(cam.start.get()) >= whole || i64::from(cam.stop.get()) >= whole {
        return cam;
    }
    let by = by.rem_euclid(whole);
    let start = with(cam, Edge::Start, i64::from(cam.start.get()) + by, whole);
    with(start, Edge::Stop, i64::from(cam.stop.get()) + by, whole)
}

/// Returns the cam drawn between two pointer positions, in either order. The positions may lie beyond the range.
pub fn drawn(from: i64, to: i64, range: u32) -> Cam {
    let whole = i64::from(range.max(1));
    let (first, last) = (from.min(to), from.max(to));
    let last = last.min(first + whole - 1);
    let none = Cam { start: Value::default(), stop: Value::default() };
    with(with(none, Edge::Start, first, whole), Edge::Stop, last, whole)
}

fn with(cam: Cam, edge: Edge, to: i64, whole: i64) -> Cam {
    // Below the range, which has 25 bits.
    let to = Value::of_word(to.rem_euclid(whole) as u32);
    match edge {
        Edge::Start => Cam { start: to, ..cam },
        Edge::Stop => Cam { stop: to, ..cam },
    }
}
