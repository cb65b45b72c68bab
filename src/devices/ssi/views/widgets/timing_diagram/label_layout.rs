//! Placement of labels without overlaps. Labels of events are above their lines, and labels of durations are next to
//! their bars.

#[derive(Clone, Copy, Debug)]
pub(super) struct LabelExtent {
    pub(super) x: f32,
    pub(super) width: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LabelPlacement {
    pub(super) level: usize,
    pub(super) left: f32,
}

/// Minimum distance between labels, and between a label and a line.
const LABEL_SPACING: f32 = 6.0;

/// Places the labels of events on as few rows as possible. No label overlaps another one or crosses the line of a
/// higher label. If this is impossible, each label has a separate row.
pub(super) fn place_labels(flags: &[LabelExtent], (from, to): (f32, f32)) -> Vec<LabelPlacement> {
    for levels in 1..=flags.len() {
        let mut put = Vec::new();
        if fill_rows(flags, (from, to), levels, &mut put) {
            return put;
        }
    }
    let left = |flag: &LabelExtent| (flag.x + LABEL_SPACING).min(to - flag.width).max(from);
    flags.iter().enumerate().map(|(level, flag)| LabelPlacement { level, left: left(flag) }).collect()
}

/// Places the remaining labels, and returns whether all of them fit.
fn fill_rows(flags: &[LabelExtent], (from, to): (f32, f32), levels: usize, put: &mut Vec<LabelPlacement>) -> bool {
    let Some(flag) = flags.get(put.len()) else { return true };
    let right = flag.x + LABEL_SPACING;
    let before = flag.x - LABEL_SPACING - flag.width;
    let clamped = (to - flag.width).max(from);
    for level in 0..levels {
        for left in [right, before, clamped] {
            let is_in = left >= from && left + flag.width <= to.max(from + flag.width);
            let own = LabelPlacement { level, left };
            let agrees = flags.iter().zip(&*put).all(|(other, at)| can_share_row((flag, &own), (other, at)));
            if is_in && agrees {
                put.push(own);
                if fill_rows(flags, (from, to), levels, put) {
                    return true;
                }
                put.pop();
            }
        }
    }
    false
}

fn can_share_row((a, at): (&LabelExtent, &LabelPlacement), (b, bt): (&LabelExtent, &LabelPlacement)) -> bool {
    let over = at.left < bt.left + b.width + LABEL_SPACING && bt.left < at.left + a.width + LABEL_SPACING;
    let crosses = |higher: &LabelExtent, lower: &LabelExtent, put: &LabelPlacement| {
        put.left - LABEL_SPACING / 2.0 < higher.x && higher.x < put.left + lower.width + LABEL_SPACING / 2.0
    };
    match at.level.cmp(&bt.level) {
        std::cmp::Ordering::Equal => !over && !crosses(a, b, bt) && !crosses(b, a, at),
        std::cmp::Ordering::Greater => !crosses(a, b, bt),
        std::cmp::Ordering::Less => !crosses(b, a, at),
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    pub(super) ends: (f32, f32),
    pub(super) width: f32,
}

/// Places the bars of durations in lanes. A label starts within its bar if it fits, and is placed beside it otherwise.
pub(super) fn place_bars(bars: &[Bar], (from, to): (f32, f32)) -> Vec<LabelPlacement> {
    let mut taken: Vec<(usize, f32, f32)> = Vec::new();
    let mut put = Vec::new();
    for bar in bars {
        let (begin, end) = bar.ends;
        let within = f32::midpoint(begin, end) - bar.width / 2.0;
        let places = [
            (bar.width + 2.0 * LABEL_SPACING <= end - begin, within),
            (end + LABEL_SPACING + bar.width <= to, end + LABEL_SPACING),
            (begin - LABEL_SPACING - bar.width >= from, begin - LABEL_SPACING - bar.width),
            (true, (to - bar.width).max(from)),
        ];
        let lanes = (0..=bars.len()).flat_map(|lane| places.map(|(fits, left)| (lane, fits, left)));
        let mut free = lanes.filter(|(_, fits, _)| *fits).filter(|(lane, _, left)| {
            let (first, last) = (begin.min(*left), end.max(left + bar.width));
            taken.iter().all(|(other, from, to)| other != lane || last <= *from || *to <= first)
        });
        let (level, _, left) = free.next().unwrap_or((bars.len(), true, from));
        taken.push((level, begin.min(left), end.max(left + bar.width)));
        put.push(LabelPlacement { level, left });
    }
    put
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn flag((x, width): (f32, f32)) -> LabelExtent {
        LabelExtent { x, width }
    }

    #[test]
    fn moment_labels_are_next_to_lines() {
        let two = [flag((10.0, 80.0)), flag((300.0, 60.0))];
        assert_eq!(
            place_labels(&two, (0.0, 400.0)),
            [LabelPlacement { level: 0, left: 16.0 }, LabelPlacement { level: 0, left: 306.0 }]
        );
        // At the right end, there is only space before the line.
        assert_eq!(place_labels(&two[1..], (0.0, 350.0)), [LabelPlacement { level: 0, left: 234.0 }]);
    }

    #[test]
    fn places_durations_in_lanes() {
        let bar = |begin, end, width| Bar { ends: (begin, end), width };
        let put = place_bars(&[bar(0.0, 200.0, 100.0), bar(200.0, 210.0, 50.0), bar(0.0, 5.0, 40.0)], (0.0, 300.0));
        let expected = [(0, 50.0), (0, 216.0), (1, 11.0)].map(|(level, left)| LabelPlacement { level, left });
        assert_eq!(put, expected);
    }

    proptest! {
        #[test]
        fn moment_labels_never_overlap(places in prop::collection::vec((0.0..500_f32, 20.0..150_f32), 1..5)) {
            let all: Vec<LabelExtent> = places.into_iter().map(flag).collect();
            let put = place_labels(&all, (0.0, 520.0));
            for (one, (a, at)) in all.iter().zip(&put).enumerate() {
                prop_assert!(at.left >= 0.0 && at.left + a.width <= 520.0);
                for (b, bt) in all.iter().zip(&put).skip(one + 1) {
                    let over = at.left < bt.left + b.width && bt.left < at.left + a.width;
                    prop_assert!(at.level != bt.level || !over);
                }
            }
        }

        #[test]
        fn duration_labels_never_cover_lines(ends in prop::collection::vec((0.0..500_f32, 0.0..500_f32, 20.0..150_f32), 1..7)) {
            let bar = |(a, b, width): &(f32, f32, f32)| Bar { ends: (a.min(*b), a.max(*b)), width: *width };
            let all: Vec<Bar> = ends.iter().map(bar).collect();
            let put = place_bars(&all, (0.0, 500.0));
            let span = |bar: &Bar, put: &LabelPlacement| (bar.ends.0.min(put.left), bar.ends.1.max(put.left + bar.width));
            for (one, (a, at)) in all.iter().zip(&put).enumerate() {
                let (from, to) = span(a, at);
                for (b, bt) in all.iter().zip(&put).skip(one + 1) {
                    let (other_from, other_to) = span(b, bt);
                    prop_assert!(at.level != bt.level || to <= other_from || other_to <= from);
                }
            }
        }
    }
}
