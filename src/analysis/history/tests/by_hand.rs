//! Tests of cases small enough to be worked out by hand.

use super::super::{BLOCK, BatchError, ColumnPart, Flags, Grid, History, Kind, RenderedHistory, Value};
use crate::analysis::SampleTime;

fn time(nanoseconds: i64) -> SampleTime {
    SampleTime::from_nanoseconds(nanoseconds)
}

fn times(nanoseconds: impl IntoIterator<Item = i64>) -> Vec<SampleTime> {
    nanoseconds.into_iter().map(time).collect()
}

fn picture(history: &History, from: i64, to: i64, pixels: usize) -> RenderedHistory {
    let mut picture = RenderedHistory::default();
    history.render_column(0, &history.divide_into_pixels(&Grid::new(time(from), time(to), pixels)), &mut picture);
    picture
}

/// Returns a history with one sample every 10 ns.
fn history(values: &[f64], flags: &[Flags]) -> History {
    let mut history = History::new(&[Kind::Real], values.len());
    let times = times((0..values.len() as i64).map(|k| 10 * k));
    history.append(&times, &[ColumnPart::from_reals(values).with_flags(flags)]).unwrap();
    history
}

#[test]
fn pixel_column_keeps_extremes_and_ends() {
    let values: Vec<f64> = (0..20).map(|k| if k % 10 == 3 { -7.0 } else { f64::from(k) }).collect();
    let picture = picture(&history(&values, &[]), 0, 200, 2);
    assert!(!picture.raw);
    let found: Vec<_> = picture.pixels.iter().map(|pixel| (pixel.values.unwrap(), pixel.joined)).collect();
    assert_eq!((found[0].0.first, found[0].0.min, found[0].0.max, found[0].0.last), (0.0, -7.0, 9.0, 9.0));
    assert_eq!((found[1].0.first, found[1].0.min, found[1].0.max, found[1].0.last), (10.0, -7.0, 19.0, 19.0));
    assert_eq!((found[0].1, found[1].1), (false, true));
    assert_eq!((picture.pixels[1].from, picture.pixels[1].to), (time(100), time(190)));
}

#[test]
fn returns_few_samples_raw() {
    let values: Vec<f64> = (0..20).map(f64::from).collect();
    let picture = picture(&history(&values, &[]), 50, 80, 30);
    assert!(picture.raw);
    let found: Vec<_> =
        picture.pixels.iter().map(|pixel| (pixel.from.as_nanoseconds(), pixel.values.unwrap().last)).collect();
    assert_eq!(found, [(40, 4.0), (50, 5.0), (60, 6.0), (70, 7.0), (80, 8.0)]);
    assert!(picture.pixels[1..].iter().all(|pixel| pixel.joined));
}

#[test]
fn single_bad_sample_stays_visible() {
    let mut values = vec![1.0; 100_000];
    values[54_321] = 1e9;
    let mut flags = vec![Flags::NONE; values.len()];
    flags[54_321] = Flags::BAD;
    flags[77_777] = Flags::WARNING;
    let picture = picture(&history(&values, &flags), 0, 1_000_000, 10);
    for (number, pixel) in picture.pixels.iter().enumerate() {
        let wanted = match number {
            5 => Flags::BAD | Flags::BREAK,
            7 => Flags::WARNING,
            _ => Flags::NONE,
        };
        assert_eq!(pixel.flags, wanted, "{number}");
        assert_eq!(pixel.values.unwrap().max, 1.0, "a bad value counts nowhere");
    }
}

#[test]
fn nan_sample_breaks_line() {
    let picture = picture(&history(&[1.0, 2.0, f64::NAN, f64::INFINITY, 5.0, 6.0], &[]), 0, 60, 6);
    let found: Vec<_> =
        picture.pixels.iter().map(|pixel| (pixel.values.map(|values| values.first), pixel.joined)).collect();
    let nothing = (None, false);
    assert_eq!(found, [(Some(1.0), false), (Some(2.0), true), nothing, nothing, (Some(5.0), false), (Some(6.0), true)]);
    assert!(picture.pixels[2].flags.contains(Flags::BAD | Flags::BREAK));
}

#[test]
fn shows_history_without_good_samples() {
    let values = vec![f64::NAN; 3 * BLOCK];
    let history = history(&values, &[]);
    let picture = picture(&history, 0, 10 * values.len() as i64, 10);
    assert!(picture.pixels.len() >= 10);
    assert!(picture.pixels.iter().all(|pixel| pixel.values.is_none() && pixel.flags.contains(Flags::BAD)));
    assert_eq!(history.statistics(0, history.indices()), None);
}

#[test]
fn pauses_and_gaps_break_columns() {
    let mut history = History::new(&[Kind::Whole, Kind::Real], 100).with_longest_pause(10);
    history
        .append(&times([0, 10, 21]), &[ColumnPart::from_integers(&[1, 2, 3]), ColumnPart::from_reals(&[1.0, 2.0, 3.0])])
        .unwrap();
    history.break_before_next();
    history.append(&[], &[ColumnPart::from_integers(&[]), ColumnPart::from_reals(&[])]).unwrap();
    history
        .append(&times([25, 36]), &[ColumnPart::from_integers(&[4, 5]), ColumnPart::from_reals(&[4.0, 5.0])])
        .unwrap();
    for column in 0..2 {
        let breaks: Vec<bool> =
            history.indices().map(|index| history.sample(column, index).unwrap().flags == Flags::BREAK).collect();
        assert_eq!(breaks, [false, false, true, true, true], "{column}");
    }
}

#[test]
fn rejects_mismatched_batch() {
    let mut history = History::new(&[Kind::Real], 100);
    history.append(&times([5, 5]), &[ColumnPart::from_reals(&[1.0, 2.0])]).unwrap();
    let cases: [(&str, &[i64], &[ColumnPart<'_>], BatchError); 6] = [
        ("too few columns", &[6], &[], BatchError::Shape),
        ("too few values", &[6, 7], &[ColumnPart::from_reals(&[1.0])], BatchError::Shape),
        (
            "too few flags",
            &[6, 7],
            &[ColumnPart::from_reals(&[1.0, 2.0]).with_flags(&[Flags::NONE])],
            BatchError::Shape,
        ),
        ("another kind", &[6], &[ColumnPart::from_integers(&[1])], BatchError::Shape),
        ("back to before", &[4], &[ColumnPart::from_reals(&[1.0])], BatchError::TimeGoesBack { at: 0 }),
        ("back inside", &[6, 8, 7], &[ColumnPart::from_reals(&[1.0, 2.0, 3.0])], BatchError::TimeGoesBack { at: 2 }),
    ];
    for (label, nanoseconds, parts, wanted) in cases {
        assert_eq!(history.append(&times(nanoseconds.iter().copied()), parts), Err(wanted), "{label}");
        assert_eq!(history.indices(), 0..2, "{label}");
    }
}

#[test]
fn nearest_sample_is_exact() {
    let mut history = History::new(&[Kind::Whole], 100);
    assert_eq!(history.nearest_index(time(0)), None);
    let positions = [1 << 60, (1 << 60) + 1, i64::MIN];
    history.append(&times([0, 10, 20]), &[ColumnPart::from_integers(&positions)]).unwrap();
    for (probe, wanted) in [(-99, 0), (4, 0), (5, 0), (6, 1), (15, 1), (16, 2), (i64::MAX, 2)] {
        assert_eq!(history.nearest_index(time(probe)), Some(wanted), "{probe}");
    }
    assert_eq!(history.sample(0, 1).unwrap().value, Value::Whole((1 << 60) + 1));
    assert_eq!((history.sample(0, 3), history.sample(1, 0)), (None, None));
}

#[test]
fn finds_simultaneous_samples_together() {
    let count = 2 * BLOCK + 5;
    let mut history = History::new(&[Kind::Real], count);
    history.append(&times((0..count).map(|_| 7)), &[ColumnPart::from_reals(&vec![1.0; count])]).unwrap();
    assert_eq!(history.indices_between(time(7), time(8)), 0..count as u64);
    assert_eq!(history.indices_between(time(8), time(7)), count as u64..count as u64);
    assert_eq!(history.indices_between(time(6), time(7)), 0..0);
}

#[test]
fn large_position_keeps_noise_deviation() {
    let mut history = History::new(&[Kind::Whole], 10_000);
    let positions: Vec<i64> = (0..10_000).map(|k| (1 << 50) + k % 2).collect();
    history.append(&times(0..10_000), &[ColumnPart::from_integers(&positions)]).unwrap();
    let found = history.statistics(0, 0..10_000).unwrap();
    assert_eq!((found.count, found.mean - (1_i64 << 50) as f64), (10_000, 0.5));
    assert!((found.deviation - 0.500_025).abs() < 1e-6, "{found:?}");
    let one = history.statistics(0, 3..4).unwrap();
    assert_eq!((one.min, one.max, one.deviation), (Value::Whole((1 << 50) + 1), Value::Whole((1 << 50) + 1), 0.0));
    assert_eq!(history.statistics(0, 5..5), None);
}

#[test]
fn resolves_single_steps_at_large_position() {
    let mut history = History::new(&[Kind::Whole], 10 * BLOCK);
    let positions: Vec<i64> = (0..10 * BLOCK as i64).map(|k| (1 << 50) + k % 3).collect();
    history.append(&times(0..10 * BLOCK as i64), &[ColumnPart::from_integers(&positions)]).unwrap();
    for pixel in picture(&history, 0, 10 * BLOCK as i64, 5).pixels.iter().filter(|pixel| pixel.from != pixel.to) {
        let values = pixel.values.unwrap();
        assert_eq!((values.min, values.max), ((1_i64 << 50) as f64, ((1_i64 << 50) + 2) as f64));
    }
}

#[test]
fn grid_aligns_to_pixel_width() {
    let grid = Grid::new(time(105), time(205), 10);
    assert_eq!(
        (grid.width(), grid.pixel_count(), grid.pixel_start(0), grid.pixel_start(11)),
        (10, 11, time(100), time(210))
    );
    let before = Grid::new(time(-5), time(5), 10);
    assert_eq!((before.width(), before.pixel_start(0), before.pixel_count()), (1, time(-5), 10));
    for (label, grid) in [
        ("no pixels", Grid::new(time(0), time(9), 0)),
        ("no time", Grid::new(time(9), time(9), 5)),
        ("backwards", Grid::new(time(9), time(0), 5)),
    ] {
        assert_eq!(grid.pixel_count(), 0, "{label}");
    }
    let all = Grid::new(time(i64::MIN), time(i64::MAX), 3);
    assert!(all.pixel_count() <= 4 && all.pixel_start(all.pixel_count()) == time(i64::MAX), "{all:?}");
    let history = history(&[1.0, 2.0], &[]);
    assert_eq!(picture(&history, 9, 0, 5).pixels.len(), 2, "the samples on both sides");
}

/// Blocks have 4096 samples. For a capacity of 5000, two blocks are kept in addition to the block being filled.
#[test]
fn predicts_oldest_sample() {
    let mut history = History::new(&[Kind::Whole], 5_000);
    assert_eq!(history.oldest_remaining_time(1), None);
    let mut next = 0;
    for portion in [1, 4_095, 8_191, 1, 1, 4_095, 10_000] {
        let expected = history.oldest_remaining_time(portion);
        let times: Vec<SampleTime> = (next..next + portion as i64).map(SampleTime::from_nanoseconds).collect();
        history.append(&times, &[ColumnPart::from_integers(&vec![0; portion])]).unwrap();
        let oldest = history.time(history.indices().start).filter(|oldest| oldest.as_nanoseconds() < next);
        assert_eq!(expected, oldest, "{next} and {portion}");
        next += portion as i64;
    }
}
