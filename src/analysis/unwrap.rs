//! Unwrapping of positions. A rotary encoder wraps from the end of its range to 0, which a plot would show as a jump of
//! thousands of turns. Unwrapped positions are only for display and speed and are never written to a device.

#[derive(Clone, Copy, Debug)]
pub struct PositionUnwrapper {
    range: Option<i64>,
    /// Last position word and its unwrapped value.
    last: Option<(i64, i64)>,
    gap: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnwrappedPosition {
    /// Unwrapped position in steps. It may exceed the range or be negative.
    pub steps: i64,
    /// Whether the path from the previous sample is unknown, because of a gap or an ambiguous step of half the range.
    /// False for the first position.
    pub broken: bool,
}

impl PositionUnwrapper {
    /// Creates an unwrapper for an encoder that wraps from `range` − 1 to 0. Returns `None` for a range below 2.
    pub fn rotary(range: i64) -> Option<Self> {
        (range >= 2).then_some(PositionUnwrapper { range: Some(range), last: None, gap: false })
    }

    /// Creates an unwrapper for an encoder that does not wrap. Positions are returned unchanged.
    pub fn without_wrap() -> Self {
        PositionUnwrapper { range: None, last: None, gap: false }
    }

    /// Marks a gap before the next sample.
    pub fn mark_gap(&mut self) {
        self.gap = true;
    }

    /// Unwraps the next position word along the shortest path from the previous one, so that a wrap becomes an ordinary
    /// step. Returns `None` for a word outside the range, which is treated as a gap.
    pub fn next(&mut self, word: i64) -> Option<UnwrappedPosition> {
        if self.range.is_some_and(|range| !(0..range).contains(&word)) {
            self.mark_gap();
            return None;
        }
        let gap = std::mem::take(&mut self.gap);
        let next = match (self.last, self.range) {
            (None, _) => UnwrappedPosition { steps: word, broken: false },
            (Some(_), None) => UnwrappedPosition { steps: word, broken: gap },
            (Some((before, steps)), Some(range)) => {
                // The forward distance is 0…range − 1, and the shorter direction is used. At exactly half,
                // both directions are equally long.
                let forward = (word - before).rem_euclid(range);
                let backward = range - forward;
                let step = if forward <= backward { forward } else { -backward };
                UnwrappedPosition { steps: steps.saturating_add(step), broken: gap || forward == backward }
            }
        };
        self.last = Some((word, next.steps));
        Some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn follow(mut unwrap: PositionUnwrapper, words: &[i64]) -> Vec<(i64, bool)> {
        words.iter().filter_map(|word| unwrap.next(*word)).map(|next| (next.steps, next.broken)).collect()
    }

    #[test]
    fn follows_wrap_like_any_step() {
        let multiturn = 4096 * 4096;
        let ring = PositionUnwrapper::rotary(multiturn).unwrap();
        let forward = follow(ring, &[multiturn - 2, multiturn - 1, 0, 1, multiturn - 1]);
        assert_eq!(forward.iter().map(|(steps, _)| steps - multiturn).collect::<Vec<_>>(), [-2, -1, 0, 1, -1]);
        assert!(forward.iter().all(|(_, broken)| !broken));
        assert_eq!(follow(ring, &[1, multiturn - 1, 0]), [(1, false), (-1, false), (0, false)]);
    }

    #[test]
    fn half_range_step_is_ambiguous() {
        let ring = PositionUnwrapper::rotary(100).unwrap();
        assert_eq!(follow(ring, &[10, 59, 10]), [(10, false), (59, false), (10, false)]);
        assert_eq!(follow(ring, &[10, 60]), [(10, false), (60, true)]);
        assert_eq!(follow(ring, &[10, 61]), [(10, false), (-39, false)]);
        let odd = PositionUnwrapper::rotary(5).unwrap();
        assert_eq!(follow(odd, &[0, 2, 0, 3]), [(0, false), (2, false), (0, false), (-2, false)]);
    }

    #[test]
    fn gap_makes_distance_unknown() {
        let mut ring = PositionUnwrapper::rotary(100).unwrap();
        ring.mark_gap();
        assert_eq!(ring.next(98), Some(UnwrappedPosition { steps: 98, broken: false }));
        ring.mark_gap();
        assert_eq!(ring.next(2), Some(UnwrappedPosition { steps: 102, broken: true }));
        assert_eq!(ring.next(3), Some(UnwrappedPosition { steps: 103, broken: false }));
        assert_eq!(ring.next(100), None);
        assert_eq!(ring.next(-1), None);
        assert_eq!(ring.next(4), Some(UnwrappedPosition { steps: 104, broken: true }));
    }

    #[test]
    fn linear_encoder_never_wraps() {
        let mut linear = PositionUnwrapper::without_wrap();
        assert_eq!(follow(linear, &[-5, 1 << 40, 0]), [(-5, false), (1 << 40, false), (0, false)]);
        linear.next(1);
        linear.mark_gap();
        assert_eq!(linear.next(9), Some(UnwrappedPosition { steps: 9, broken: true }));
    }

    #[test]
    fn range_needs_two_positions() {
        assert!(PositionUnwrapper::rotary(1).is_none());
        assert!(PositionUnwrapper::rotary(i64::MIN).is_none());
    }

    proptest! {
        /// A random walk whose steps are all below half the range is reproduced.
        #[test]
        fn follows_random_walk(range in 3_i64..1 << 40, start in 0_i64..1 << 40, walk in proptest::collection::vec(-1.0..1.0, 1..200)) {
            let mut truth = start % range;
            let mut unwrap = PositionUnwrapper::rotary(range).unwrap();
            prop_assert_eq!(unwrap.next(truth).unwrap().steps, truth);
            for step in walk {
                truth += (step * ((range - 1) / 2) as f64) as i64;
                let next = unwrap.next(truth.rem_euclid(range)).unwrap();
                prop_assert_eq!(next, UnwrappedPosition { steps: truth, broken: false });
            }
        }
    }
}
