//! Arrangement of the cells in a bit strip. They are on one line if there is enough room, or else on several lines of
//! whole bytes.

use egui::{Pos2, Rect, Vec2, pos2};

/// Minimum width of a cell, below which the strip wraps.
const MIN_CELL_WIDTH: f32 = 17.0;
const MAX_CELL_WIDTH: f32 = 28.0;
/// Height of the row of clock numbers.
const NUMBER_HEIGHT: f32 = 15.0;
const CELL_HEIGHT: f32 = 26.0;
const LANE_HEIGHT: f32 = 16.0;
pub(super) const NAME_HEIGHT: f32 = 15.0;
/// Space on either side of the cells for the first and the last handle.
const SIDE_MARGIN: f32 = 10.0;
const LINE_GAP: f32 = 10.0;

/// The cells of a bit strip, arranged on one or more lines.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    origin: Pos2,
    /// Width of a cell with the gap after it.
    pub(super) cell: f32,
    columns: u8,
    /// Top edge of each line, and the bottom edge of the last line.
    tops: Vec<f32>,
}

impl Rows {
    pub(super) fn new(room: f32, clocks: u8) -> Self {
        let room = (room - 2.0 * SIDE_MARGIN).max(0.0);
        let count = f32::from(clocks.max(1));
        if count * MIN_CELL_WIDTH <= room {
            let cell = (room / count).floor().min(MAX_CELL_WIDTH);
            // The line has room for more clocks, which appear when the end of the frame is dragged.
            let columns = (room / cell).floor().min(64.0) as u8;
            return Rows { origin: Pos2::ZERO, cell, columns, tops: Vec::new() };
        }
        // The strip has as few lines as possible, each of whole bytes.
        let columns = |lines: u8| clocks.div_ceil(lines).next_multiple_of(8);
        let columns = (2..=8).map(columns).find(|columns| f32::from(*columns) * MIN_CELL_WIDTH <= room).unwrap_or(8);
        let cell = (room / f32::from(columns)).floor().clamp(MIN_CELL_WIDTH, MAX_CELL_WIDTH);
        Rows { origin: Pos2::ZERO, cell, columns, tops: Vec::new() }
    }

    pub(super) fn left_edge(&self) -> f32 {
        self.origin.x
    }

    pub(super) fn count(&self, clocks: u8) -> usize {
        usize::from(clocks.max(1).div_ceil(self.columns))
    }

    /// Places the rows with their top left corner at a point. There is space for `names[line]` rows of names below each
    /// line.
    pub(super) fn at_origin(mut self, origin: Pos2, names: &[usize]) -> Self {
        self.origin = origin + Vec2::new(SIDE_MARGIN, 0.0);
        let mut top = 0.0;
        self.tops = vec![top];
        for names in names {
            top += NUMBER_HEIGHT + CELL_HEIGHT + LANE_HEIGHT + *names as f32 * NAME_HEIGHT + LINE_GAP;
            self.tops.push(top);
        }
        self
    }

    pub(super) fn width(&self, clocks: u8) -> f32 {
        f32::from(clocks.min(self.columns)) * self.cell
    }

    pub(super) fn size(&self, clocks: u8) -> Vec2 {
        Vec2::new(self.width(clocks) + 2.0 * SIDE_MARGIN, self.tops.last().copied().unwrap_or(LINE_GAP) - LINE_GAP)
    }

    pub(super) fn line_for_clock(&self, clock: u8) -> usize {
        usize::from(clock.saturating_sub(1) / self.columns)
    }

    fn line_top(&self, line: usize) -> f32 {
        self.origin.y + self.tops.get(line).or(self.tops.last()).copied().unwrap_or(0.0)
    }

    pub(super) fn cell_rect(&self, clock: u8) -> Rect {
        let column = f32::from(clock.saturating_sub(1) % self.columns);
        let at = pos2(self.origin.x + column * self.cell, self.line_top(self.line_for_clock(clock)) + NUMBER_HEIGHT);
        Rect::from_min_size(at, Vec2::new(self.cell - 1.0, CELL_HEIGHT))
    }

    pub(super) fn number_position(&self, clock: u8) -> Pos2 {
        let cell = self.cell_rect(clock);
        pos2(cell.center().x, cell.top() - NUMBER_HEIGHT / 2.0)
    }

    /// Returns the rectangles that cover a range of clocks, one for each line.
    pub(super) fn range_rects(&self, first: u8, last: u8) -> Vec<Rect> {
        let mut runs: Vec<Rect> = Vec::new();
        for clock in first..=last {
            let cell = self.cell_rect(clock);
            match runs
                .last_mut()
                .filter(|_| clock > first && self.line_for_clock(clock) == self.line_for_clock(clock - 1))
            {
                Some(run) => *run = run.union(cell),
                None => runs.push(cell),
            }
        }
        runs
    }

    pub(super) fn lane_rect(run: Rect) -> Rect {
        Rect::from_min_max(pos2(run.left(), run.bottom()), pos2(run.right(), run.bottom() + LANE_HEIGHT))
    }

    /// Returns the edge after a clock. If a part begins at this edge, this is the edge of the next clock's cell, which
    /// may be on the next line.
    pub(super) fn edge_rect(&self, clock: u8, begins: bool, clocks: u8) -> Rect {
        let begins = clock == 0 || begins && clock < clocks;
        let cell = self.cell_rect(if begins { clock + 1 } else { clock });
        let x = if begins { cell.left() - 0.5 } else { cell.right() + 0.5 };
        Rect::from_min_max(pos2(x, cell.top()), pos2(x, cell.bottom() + LANE_HEIGHT))
    }

    /// Returns the clock whose edge is nearest to the pointer.
    pub(super) fn nearest_boundary(&self, pos: Pos2, clocks: u8) -> u8 {
        let column = ((pos.x - self.origin.x) / self.cell).round().clamp(0.0, f32::from(self.columns));
        self.line_at(pos, clocks).saturating_mul(self.columns).saturating_add(column as u8)
    }

    /// Returns the clock under the pointer, or the nearest one on the same line.
    pub(super) fn clock(&self, pos: Pos2, clocks: u8) -> u8 {
        let column = ((pos.x - self.origin.x) / self.cell).floor().clamp(0.0, f32::from(self.columns) - 1.0);
        self.line_at(pos, clocks).saturating_mul(self.columns).saturating_add(column as u8 + 1)
    }

    fn line_at(&self, pos: Pos2, clocks: u8) -> u8 {
        let lines = self.count(clocks);
        (1..lines).rev().find(|line| pos.y >= self.line_top(*line) - LINE_GAP / 2.0).map_or(0, |line| line as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_shrink_before_wrapping() {
        // The required widths are 25 · 28 + 20 = 720, 25 · 17 + 20 = 445 and 32 · 17 + 20 = 564.
        for (room, clocks, cell, lines) in [
            (1000.0, 25, 28.0, 1),
            (720.0, 25, 28.0, 1),
            (719.0, 25, 27.0, 1),
            (445.0, 25, 17.0, 1),
            (444.0, 25, 26.0, 2),
        ] {
            let rows = Rows::new(room, clocks);
            assert_eq!((rows.cell, rows.count(clocks)), (cell, lines), "{clocks} clocks in {room}");
        }
        for (room, columns) in
            [(1108.0, 64), (1107.0, 32), (564.0, 32), (563.0, 24), (428.0, 24), (427.0, 16), (292.0, 16), (291.0, 8)]
        {
            let rows = Rows::new(room, 64);
            assert_eq!(rows.columns, columns, "{room}");
            let rows = rows.at_origin(Pos2::ZERO, &vec![1; 64_usize.div_ceil(columns.into())]);
            assert!(rows.size(64).x <= room);
        }
    }

    #[test]
    fn pointer_positions_map_to_cells() {
        let rows = Rows::new(600.0, 64).at_origin(pos2(30.0, 40.0), &[1, 3]);
        for clock in 1..=64 {
            let cell = rows.cell_rect(clock);
            assert_eq!(rows.clock(cell.center(), 64), clock);
            assert_eq!(rows.nearest_boundary(rows.edge_rect(clock, false, 64).center(), 64), clock);
            assert_eq!(rows.nearest_boundary(rows.edge_rect(clock - 1, true, 64).center(), 64), clock - 1);
        }
        assert_eq!(rows.range_rects(30, 35).len(), 2);
        assert_eq!(rows.clock(pos2(-500.0, -500.0), 64), 1);
        assert_eq!(rows.nearest_boundary(pos2(5000.0, 5000.0), 64), 64);
    }
}
