//! The layout of the fields of a frame. All cells have the same width and take as few lines as possible.

#[derive(Clone, Copy, Debug)]
pub(super) struct RequiredSpace {
    pub(super) bits: usize,
    /// Width of the text below the field, in points.
    pub(super) words: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlacedPiece {
    pub(super) field: usize,
    /// Index of the piece's first bit within the field.
    pub(super) first: usize,
    pub(super) bits: usize,
    pub(super) line: usize,
    pub(super) left: f32,
    pub(super) width: f32,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct StripPlacement {
    pub(super) pieces: Vec<PlacedPiece>,
    pub(super) lines: usize,
    pub(super) width: f32,
    /// Cell width in points, including the gap after the cell.
    pub(super) cell: f32,
}

const CELLS: [f32; 10] = [20.0, 19.0, 18.0, 17.0, 16.0, 15.0, 14.0, 13.0, 12.0, 11.0];
/// Gap in points after every four bits.
const GROUP_GAP: f32 = 3.0;

impl PlacedPiece {
    /// Returns the left edge of the cell at index `at` in the piece. Groups of four bits are counted from the end of
    /// the field.
    pub(super) fn offset(&self, at: usize, field_bits: usize, cell: f32) -> f32 {
        at as f32 * cell + groups_between(self.first, self.first + at, field_bits) as f32 * GROUP_GAP
    }
}

/// Returns the number of boundaries between four-bit groups from one bit of a field to another.
fn groups_between(from: usize, to: usize, field_bits: usize) -> usize {
    let behind = |bit: usize| field_bits.saturating_sub(bit).div_ceil(4);
    behind(from).saturating_sub(behind(to))
}

/// Places the fields within a width, separated by `gap`. A field that is longer than a line is split.
pub(super) fn arrange_fields(wants: &[RequiredSpace], width: f32, gap: f32) -> StripPlacement {
    let fewest = CELLS.last().map_or(1, |least| place_with_cell_width(wants, width, gap, *least).lines);
    let fits = CELLS
        .iter()
        .map(|cell| place_with_cell_width(wants, width, gap, *cell))
        .find(|placing| placing.lines <= fewest);
    fits.unwrap_or_default()
}

fn place_with_cell_width(wants: &[RequiredSpace], width: f32, gap: f32, cell: f32) -> StripPlacement {
    let mut placing = StripPlacement { cell, ..StripPlacement::default() };
    let (mut left, mut line) = (0.0, 0);
    for (field, want) in wants.iter().enumerate() {
        let mut first = 0;
        while first < want.bits {
            let rest = want.bits - first;
            let words = if first == 0 { want.words } else { 0.0 };
            let whole = cells_width(first, rest, want.bits, cell).max(words);
            if left > 0.0 && left + whole > width {
                (left, line) = (0.0, line + 1);
            }
            // Take whole bytes, as many as fit but at least one.
            let fit = (1..=rest).rev().find(|bits| cells_width(first, *bits, want.bits, cell) <= width).unwrap_or(1);
            let bits = if fit == rest { rest } else { (fit - fit % 8).clamp(8.min(rest), rest) };
            let own = cells_width(first, bits, want.bits, cell).max(words);
            placing.pieces.push(PlacedPiece { field, first, bits, line, left, width: own });
            placing.width = placing.width.max(left + own);
            left += own + gap;
            first += bits;
        }
    }
    placing.lines = placing.pieces.last().map_or(0, |last| last.line + 1);
    placing
}

/// Returns the width of the cells for `bits` bits of a field, starting at bit `first`.
fn cells_width(first: usize, bits: usize, field_bits: usize, cell: f32) -> f32 {
    bits as f32 * cell + groups_between(first, (first + bits).saturating_sub(1), field_bits) as f32 * GROUP_GAP
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: f32 = 8.0;

    /// Returns the frame of the kit encoder, including its acknowledge, start and control bits.
    fn kit() -> Vec<RequiredSpace> {
        let want = |(bits, words)| RequiredSpace { bits, words };
        [(3, 26.0), (1, 27.0), (1, 26.0), (16, 32.0), (17, 48.0), (1, 30.0), (1, 40.0), (6, 24.0)]
            .map(want)
            .into_iter()
            .collect()
    }

    fn lines(placing: &StripPlacement) -> Vec<Vec<usize>> {
        (0..placing.lines)
            .map(|line| placing.pieces.iter().filter(|own| own.line == line).map(|own| own.field).collect())
            .collect()
    }

    #[test]
    fn short_frame_fits_one_line() {
        // 42 bits in groups of four with 3 + 4 + 1 gaps between them, four single bits as wide as their texts, 123 in
        // total, and seven gaps between fields.
        let placing = arrange_fields(&kit(), 1100.0, GAP);
        assert_eq!((placing.lines, placing.cell), (1, 20.0));
        let expected = 42.0 * 20.0 + 8.0 * 3.0 + 123.0 + 7.0 * 8.0;
        assert!((placing.width - expected).abs() < 0.01, "{}", placing.width);
    }

    #[test]
    fn cells_shrink_before_frame_wraps() {
        // 42 · 13 + 24 + 123 + 56 = 749.
        let placing = arrange_fields(&kit(), 749.0, GAP);
        assert_eq!((placing.lines, placing.cell), (1, 13.0));
        let placing = arrange_fields(&kit(), 748.0, GAP);
        assert_eq!((placing.lines, placing.cell), (1, 12.0));
    }

    #[test]
    fn fields_stay_together_on_their_lines() {
        let placing = arrange_fields(&kit(), 420.0, GAP);
        assert_eq!(lines(&placing), [vec![0, 1, 2, 3], vec![4, 5, 6, 7]]);
        assert!(placing.pieces.iter().all(|own| own.left + own.width <= 420.0));
        // Narrower cells would result in the same number of lines, so the cells are as wide as possible.
        let wider = place_with_cell_width(&kit(), 420.0, GAP, placing.cell + 1.0);
        assert!(wider.lines > placing.lines);
    }

    #[test]
    fn splits_long_field_at_bytes() {
        let wants = [RequiredSpace { bits: 64, words: 50.0 }];
        let placing = arrange_fields(&wants, 400.0, GAP);
        // 32 bits with 7 groups between them take 32 · 11 + 21 = 373 points.
        let parts: Vec<(usize, usize)> = placing.pieces.iter().map(|own| (own.first, own.bits)).collect();
        assert_eq!(parts, [(0, 32), (32, 32)]);
        assert_eq!(arrange_fields(&wants, 10.0, GAP).pieces.len(), 8, "eight bits in any case");
    }

    #[test]
    fn counts_groups_from_last_bit() {
        let piece = PlacedPiece { field: 0, first: 0, bits: 17, line: 0, left: 0.0, width: 0.0 };
        // 17 bits: a single bit followed by four groups of four.
        let offsets: Vec<f32> = [0, 1, 4, 5, 16].map(|at| piece.offset(at, 17, 10.0)).into_iter().collect();
        assert_eq!(offsets, [0.0, 13.0, 43.0, 56.0, 172.0]);
    }

    #[test]
    fn empty_frame_takes_no_space() {
        assert_eq!(arrange_fields(&[], 100.0, GAP).lines, 0);
        let none = [RequiredSpace { bits: 0, words: 10.0 }];
        assert!(arrange_fields(&none, f32::NAN, GAP).pieces.is_empty());
        assert!(!arrange_fields(&kit(), 0.0, GAP).pieces.is_empty());
    }
}
