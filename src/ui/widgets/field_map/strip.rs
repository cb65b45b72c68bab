//! The layout of the blocks of a field map.

use egui::{Pos2, Rect, Vec2};

use crate::ui::Theme;

/// The layout of the blocks, from left to right and line by line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Upper left corner of the map.
    pub(super) origin: Pos2,
    pub(super) size: Vec2,
    pub(super) block: Vec2,
    margin: f32,
    gap: f32,
    columns: usize,
}

impl Strip {
    /// Possible block widths in grid steps, largest first.
    const STEPS: [f32; 6] = [12.0, 10.0, 8.0, 6.0, 5.0, 4.0];

    /// Creates a strip with the largest blocks that fit `count` blocks on two lines. If even the smallest blocks do not
    /// fit, the strip has more lines.
    pub(super) fn new(theme: &Theme, room: f32, count: usize) -> Self {
        let (margin, gap) = (theme.space.inside, theme.space.between);
        let columns_of = |width: f32| ((room / width).floor() as usize).max(1);
        let widths = Self::STEPS.map(|step| step * theme.space.inside);
        let fits = widths.into_iter().find(|width| columns_of(*width) * 2 >= count);
        let width = fits.unwrap_or(Self::STEPS.last().copied().unwrap_or(4.0) * theme.space.inside);
        let columns = columns_of(width);
        let block = Vec2::new(width, theme.space.inside * 11.0);
        let lines = count.div_ceil(columns);
        let used = columns.min(count);
        let height = lines as f32 * block.y + lines.saturating_sub(1) as f32 * gap;
        let size = Vec2::new(used as f32 * width, height + margin * 2.0);
        Strip { origin: Pos2::ZERO, size, block, margin, gap, columns }
    }

    /// Returns a copy with its upper left corner at `origin`.
    pub(super) fn at_origin(self, origin: Pos2) -> Self {
        Strip { origin, ..self }
    }

    /// Returns the rectangles, one per line, that cover the blocks from `first` to `end` (exclusive).
    pub(super) fn range_rects(&self, first: usize, end: usize) -> Vec<Rect> {
        let mut runs = Vec::new();
        let mut at = first;
        while at < end {
            let (line, column) = (at / self.columns, at % self.columns);
            let count = (self.columns - column).min(end - at);
            let left = column as f32 * self.block.x;
            let top = self.margin + line as f32 * (self.block.y + self.gap);
            let size = Vec2::new(count as f32 * self.block.x, self.block.y);
            runs.push(Rect::from_min_size(self.origin + Vec2::new(left, top), size));
            at += count;
        }
        runs
    }

    /// Returns the block boundary nearest to the pointer, as a number of blocks from the start.
    pub(super) fn nearest_boundary(&self, pos: Pos2) -> usize {
        let inside = pos - self.origin - Vec2::new(0.0, self.margin);
        // Positions above or left of the strip become zero.
        let line = ((inside.y + self.gap / 2.0) / (self.block.y + self.gap)).floor() as usize;
        let column = ((inside.x / self.block.x).round() as usize).min(self.columns);
        line * self.columns + column
    }
}

/// Returns the index of the widest of a field's rectangles, or of the first one if several are equally wide.
pub(super) fn widest_run(runs: &[Rect]) -> usize {
    let widths = runs.iter().enumerate().rev();
    widths.max_by(|(_, a), (_, b)| a.width().total_cmp(&b.width())).map_or(0, |(number, _)| number)
}
