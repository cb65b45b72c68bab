//! Conversion between times and coordinates. Each section of the axis is to scale, and there is a gap at each break.

use egui::Rangef;

use crate::devices::ssi::state::timing::AxisSection;

pub(super) const BREAK_WIDTH: f32 = 24.0;

#[derive(Clone, Debug)]
pub(super) struct Axis {
    pieces: Vec<AxisSection>,
    left: f32,
    /// Scale in points per second.
    scale: f64,
}

impl Axis {
    pub(super) fn new(pieces: &[AxisSection], room: Rangef) -> Self {
        let breaks = pieces.len().saturating_sub(1) as f32 * BREAK_WIDTH;
        let drawn: f64 = pieces.iter().map(|piece| piece.to - piece.from).sum();
        let scale = f64::from((room.span() - breaks).max(1.0)) / drawn.max(1e-12);
        Axis { pieces: pieces.to_vec(), left: room.min, scale }
    }

    /// Returns the x coordinate of a time. An omitted time is in the middle of its break, and a time outside the axis
    /// is at the nearest end.
    pub(super) fn x(&self, at: f64) -> f32 {
        let mut left = self.left;
        for (number, piece) in self.pieces.iter().enumerate() {
            if number > 0 {
                if at < piece.from {
                    return left - BREAK_WIDTH / 2.0;
                }
            } else if at < piece.from {
                return left;
            }
            if at <= piece.to {
                return left + ((at - piece.from) * self.scale) as f32;
            }
            left += ((piece.to - piece.from) * self.scale) as f32 + BREAK_WIDTH;
        }
        left - BREAK_WIDTH
    }

    /// Returns the time at an x coordinate, or `None` within a break or beyond the ends.
    pub(super) fn time_at(&self, x: f32) -> Option<f64> {
        let mut left = self.left;
        for piece in &self.pieces {
            let right = left + ((piece.to - piece.from) * self.scale) as f32;
            if (left..=right).contains(&x) {
                return Some(piece.from + f64::from(x - left) / self.scale);
            }
            left = right + BREAK_WIDTH;
        }
        None
    }

    /// Returns the x ranges of the breaks from left to right.
    pub(super) fn break_ranges(&self) -> Vec<Rangef> {
        let ends = self.pieces.iter().map(|piece| self.x(piece.to));
        let ends: Vec<f32> = ends.collect();
        let (_, inner) = ends.split_last().unwrap_or((&0.0, &[]));
        inner.iter().map(|end| Rangef::new(*end, end + BREAK_WIDTH)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_positions_convert_both_ways() {
        let pieces = [AxisSection { from: 0.0, to: 60.0 }, AxisSection { from: 1000.0, to: 1040.0 }];
        // Without the break of 24 points, 200 of 224 points remain, which are two points per second.
        let axis = Axis::new(&pieces, Rangef::new(10.0, 234.0));
        for (at, x) in [(0.0, 10.0), (60.0, 130.0), (1000.0, 154.0), (1040.0, 234.0), (500.0, 142.0), (9999.0, 234.0)] {
            assert!((axis.x(at) - x).abs() < 1e-3, "{at}: {}", axis.x(at));
        }
        assert_eq!(axis.break_ranges(), [Rangef::new(130.0, 154.0)]);
        for (x, at) in [(10.0, Some(0.0)), (130.0, Some(60.0)), (142.0, None), (164.0, Some(1005.0)), (240.0, None)] {
            assert_eq!(axis.time_at(x), at, "{x}");
        }
        let nothing = Axis::new(&[AxisSection { from: 0.0, to: 0.0 }], Rangef::new(0.0, 100.0));
        assert!(nothing.x(0.0).is_finite() && nothing.time_at(0.0).is_some());
    }
}
