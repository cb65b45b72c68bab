//! Property tests that compare every result with a full scan.

use proptest::prelude::*;

use super::super::{BLOCK, ColumnPart, Flags, Grid, History, Kind, Pixel, RenderedHistory, Value};
use super::model::Model;
use crate::analysis::SampleTime;

/// Pattern of the generated sample values in a run.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Noise,
    Ramp,
    Constant,
    Glitches,
    Huge,
    Bad,
}

/// Samples that are appended together.
#[derive(Clone, Debug)]
struct Run {
    seed: u64,
    count: usize,
    shape: Shape,
    offset: i64,
    /// Mean distance between flagged samples, or 0 for no flags.
    flagged: usize,
    broken: bool,
    batch: usize,
}

const PAUSE: i64 = 50_000;

fn runs() -> impl Strategy<Value = Vec<Run>> {
    let shape = prop_oneof![
        4 => Just(Shape::Noise),
        4 => Just(Shape::Ramp),
        1 => Just(Shape::Constant),
        2 => Just(Shape::Glitches),
        1 => Just(Shape::Huge),
        1 => Just(Shape::Bad),
    ];
    let offset = prop_oneof![Just(0), -1000_i64..1000, Just(1 << 40), Just(-(1 << 60))];
    let flagged = prop_oneof![3 => Just(0), 1 => 1_usize..4, 2 => 50_usize..5000];
    let run = (any::<u64>(), 1_usize..6000, shape, offset, flagged, any::<bool>(), 1_usize..9000);
    let run = run.prop_map(|(seed, count, shape, offset, flagged, broken, batch)| Run {
        seed,
        count,
        shape,
        offset,
        flagged,
        broken,
        batch,
    });
    proptest::collection::vec(run, 1..8)
}

fn value(kind: Kind, shape: Shape, offset: i64, at: usize, random: &mut fastrand::Rng) -> Value {
    let step = at as i64;
    let whole = match shape {
        Shape::Noise | Shape::Bad => random.i64(-100_000..100_000),
        Shape::Ramp => step * 37,
        Shape::Constant => 5,
        Shape::Glitches if random.usize(0..500) == 0 => random.i64(..) >> random.u32(1..60),
        Shape::Glitches => random.i64(-10..10),
        Shape::Huge => random.i64(..),
    };
    if kind == Kind::Whole {
        return Value::Whole(offset.saturating_add(whole));
    }
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 1e-300, -0.0];
    Value::Real(match shape {
        Shape::Bad => odd[random.usize(..3)],
        Shape::Glitches if random.usize(0..700) == 0 => odd[random.usize(..odd.len())],
        Shape::Huge => (random.f64() - 0.5) * 10_f64.powi(random.i32(-300..300)),
        _ => offset as f64 + whole as f64 / 1000.0,
    })
}

/// Returns a history and its model with the same samples.
fn build(kind: Kind, runs: &[Run], capacity: usize) -> (History, Model) {
    let mut history = History::new(&[Kind::Real, kind], capacity).with_longest_pause(PAUSE);
    let mut model = Model::default();
    let mut now = 0;
    for run in runs {
        let mut random = fastrand::Rng::with_seed(run.seed);
        let start = model.times.len();
        for at in 0..run.count {
            now += match random.usize(0..400) {
                0 => random.i64(0..4 * PAUSE),
                1..20 => 0,
                _ => 1000 + random.i64(0..30),
            };
            let remarkable = run.flagged != 0 && random.usize(0..run.flagged) == 0;
            let flags =
                if remarkable { [Flags::BAD, Flags::WARNING, Flags::BREAK][random.usize(0..3)] } else { Flags::NONE };
            let value = value(kind, run.shape, run.offset, at, &mut random);
            // The history must set the implied breaks itself.
            model.times.push(now);
            model.values.push(value);
            model.flags.push(flags);
        }
        let given = Model {
            times: model.times.split_off(start),
            values: model.values.split_off(start),
            flags: model.flags.split_off(start),
        };
        if run.broken {
            history.break_before_next();
        }
        for at in 0..run.count {
            model.push(given.times[at], given.values[at], given.flags[at], run.broken && at == 0, PAUSE);
        }
        append(&mut history, kind, &given, run);
    }
    (history, model)
}

fn append(history: &mut History, kind: Kind, given: &Model, run: &Run) {
    let times: Vec<SampleTime> = given.times.iter().map(|time| SampleTime::from_nanoseconds(*time)).collect();
    let reals: Vec<f64> = given.values.iter().map(|value| value.to_f64()).collect();
    let wholes: Vec<i64> = given
        .values
        .iter()
        .map(|value| match value {
            Value::Whole(whole) => *whole,
            Value::Real(_) => 0,
        })
        .collect();
    for from in (0..run.count).step_by(run.batch) {
        let range = from..(from + run.batch).min(run.count);
        let part = match kind {
            Kind::Real => ColumnPart::from_reals(&reals[range.clone()]),
            Kind::Whole => ColumnPart::from_integers(&wholes[range.clone()]),
        };
        let part = if run.flagged == 0 { part } else { part.with_flags(&given.flags[range.clone()]) };
        let zeros = vec![0.0; range.len()];
        history.append(&times[range], &[ColumnPart::from_reals(&zeros), part]).unwrap();
    }
}

/// Checks that the extremes of a picture closely enclose the true extremes, and that everything else is equal.
fn check(found: &[Pixel], wanted: &[Pixel], around: impl Fn(&Pixel) -> f64) -> Result<(), TestCaseError> {
    prop_assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        let mut exact = *found;
        if let (Some(values), Some(true_values)) = (&mut exact.values, wanted.values) {
            let largest = true_values.min.abs().max(true_values.max.abs());
            let loss = around(wanted) / f64::from(1 << 22) + largest * 4.0 * f64::EPSILON + 1e-44;
            prop_assert!(values.min <= true_values.min && true_values.max <= values.max, "{:?} {:?}", found, wanted);
            prop_assert!(true_values.min - values.min <= loss, "{:?} {:?} {}", found, wanted, loss);
            prop_assert!(values.max - true_values.max <= loss, "{:?} {:?} {}", found, wanted, loss);
            (values.min, values.max) = (true_values.min, true_values.max);
        }
        prop_assert_eq!(&exact, wanted);
    }
    Ok(())
}

fn kinds() -> impl Strategy<Value = Kind> {
    prop_oneof![Just(Kind::Real), Just(Kind::Whole)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn rendering_matches_full_scan(
        kind in kinds(),
        runs in runs(),
        capacity in 1_usize..30_000,
        views in proptest::collection::vec((0.0..1.0, 0.0..1.0, 1_usize..300), 3),
    ) {
        let (history, model) = build(kind, &runs, capacity);
        let first = model.first(capacity);
        let span = *model.times.last().unwrap() as f64;
        for (from, length, pixels) in views {
            let from = (from * 1.2 - 0.1) * span;
            let to = from + span * length * length * length + 1.0;
            let grid = Grid::new(SampleTime::from_nanoseconds(from as i64), SampleTime::from_nanoseconds(to as i64), pixels);
            let mut picture = RenderedHistory::default();
            history.render_column(1, &history.divide_into_pixels(&grid), &mut picture);
            let (wanted, raw) = model.picture(first, &grid);
            prop_assert_eq!(picture.raw, raw);
            check(&picture.pixels, &wanted, |pixel| model.around(first, pixel.from, pixel.to))?;
        }
    }

    #[test]
    fn statistics_match_full_scan(
        kind in kinds(),
        runs in runs(),
        capacity in 1_usize..30_000,
        ranges in proptest::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 4),
    ) {
        let (history, model) = build(kind, &runs, capacity);
        let first = model.first(capacity);
        let count = model.times.len();
        prop_assert_eq!(history.indices(), first as u64..count as u64);
        prop_assert!(first == 0 || count - first >= capacity && count - first <= capacity + 2 * BLOCK);
        for at in (first..count).step_by(7) {
            let sample = history.sample(1, at as u64).unwrap();
            prop_assert_eq!((sample.time.as_nanoseconds(), sample.flags), (model.times[at], model.flags[at]));
            let same = sample.value == model.values[at] || sample.value.to_f64().is_nan() && model.values[at].to_f64().is_nan();
            prop_assert!(same);
        }
        for (from, to) in ranges {
            let place = |share: f64| first + (share * (count - first) as f64) as usize;
            let (from, to) = (place(from.min(to)), place(from.max(to)));
            let good: Vec<Value> = model.good(from..to).map(|at| model.values[at]).collect();
            let found = history.statistics(1, from as u64..to as u64);
            prop_assert_eq!(found.is_some(), !good.is_empty());
            let Some(found) = found else { continue };
            prop_assert_eq!((found.count as usize, found.bad as usize), (good.len(), to - from - good.len()));
            let least = good.iter().copied().reduce(|one, other| if less(other, one) { other } else { one });
            let most = good.iter().copied().reduce(|one, other| if less(one, other) { other } else { one });
            prop_assert_eq!((Some(found.min), Some(found.max)), (least, most));
            let largest = good.iter().map(|value| value.to_f64().abs()).fold(0.0, f64::max);
            if largest < 1e150 {
                // Two passes relative to the first value, so that an offset does not reduce the precision.
                let n = good.len() as f64;
                let from_first: Vec<f64> = good.iter().map(|value| minus(*value, good[0])).collect();
                let mean = from_first.iter().sum::<f64>() / n;
                let scale = from_first.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                let squares: f64 = from_first.iter().map(|value| (value - mean) * (value - mean)).sum();
                let deviation = (squares / (n - 1.0).max(1.0)).sqrt();
                prop_assert!((found.deviation - deviation).abs() <= scale * 1e-9, "{:?} {}", found, deviation);
                prop_assert!((found.mean - (good[0].to_f64() + mean)).abs() <= scale * 1e-9 + largest * 1e-15);
            }
        }
    }

    #[test]
    fn nearest_sample_matches_full_scan(
        runs in runs(),
        capacity in 1_usize..30_000,
        probes in proptest::collection::vec(-0.1..1.1, 20),
    ) {
        let (history, model) = build(Kind::Whole, &runs, capacity);
        let first = model.first(capacity);
        let span = *model.times.last().unwrap() as f64;
        for probe in probes {
            let probe = (probe * span) as i64;
            let found = history.nearest_index(SampleTime::from_nanoseconds(probe)).unwrap() as usize;
            let nearest = (first..model.times.len()).map(|at| (model.times[at] - probe).abs()).min().unwrap();
            prop_assert_eq!((model.times[found] - probe).abs(), nearest);
        }
    }

    /// An unchanged view yields the same columns while samples are appended and the oldest samples are evicted.
    #[test]
    fn unchanged_view_keeps_columns(kind in kinds(), runs in runs(), more in runs()) {
        let capacity = 60_000;
        let (history, before) = build(kind, &runs, capacity);
        let end = before.times[before.times.len() - 1] + 1;
        let grid = Grid::new(SampleTime::ORIGIN, SampleTime::from_nanoseconds(end), 50);
        let mut picture = RenderedHistory::default();
        history.render_column(1, &history.divide_into_pixels(&grid), &mut picture);
        let (later, _) = build(kind, &[runs, more].concat(), capacity);
        let mut later_picture = RenderedHistory::default();
        later.render_column(1, &later.divide_into_pixels(&grid), &mut later_picture);
        // The results for stored complete blocks are identical to the last bit.
        let settled = history.time(history.indices().end / BLOCK as u64 * BLOCK as u64).map_or(end, SampleTime::as_nanoseconds);
        let oldest = later.time(later.indices().start).unwrap();
        if !picture.raw && !later_picture.raw {
            let is_settled = |pixel: &&Pixel| pixel.from > oldest && pixel.to.as_nanoseconds() < settled;
            let old: Vec<&Pixel> = picture.pixels.iter().filter(is_settled).collect();
            let new: Vec<&Pixel> = later_picture.pixels.iter().filter(is_settled).collect();
            // The column truncated by eviction comes first.
            let cut = usize::from(later.indices().start > history.indices().start) * 2;
            prop_assert_eq!(old.iter().rev().take(old.len().saturating_sub(cut)).collect::<Vec<_>>(),
                new.iter().rev().take(old.len().saturating_sub(cut)).collect::<Vec<_>>());
        }
        // A view that moves by whole columns yields the same columns.
        let width = grid.width();
        let moved = Grid::new(SampleTime::from_nanoseconds(10 * width), SampleTime::from_nanoseconds(60 * width), 50);
        prop_assert_eq!(moved.width(), width);
        let mut moved_picture = RenderedHistory::default();
        history.render_column(1, &history.divide_into_pixels(&moved), &mut moved_picture);
        if !picture.raw && !moved_picture.raw {
            // The ends of a picture are exact. Between them, a column may begin a sixteenth of its width earlier.
            let (from, to) = (moved.pixel_start(1), grid.pixel_start(grid.pixel_count() - 1).saturating_add_ns(-(width / 16)));
            let inside = |pixel: &&Pixel| pixel.from >= from && pixel.from < to;
            let still: Vec<&Pixel> = picture.pixels.iter().filter(inside).collect();
            let again: Vec<&Pixel> = moved_picture.pixels.iter().filter(inside).collect();
            prop_assert_eq!(still, again);
        }
    }
}

fn less(one: Value, other: Value) -> bool {
    match (one, other) {
        (Value::Whole(one), Value::Whole(other)) => one < other,
        _ => one.to_f64() < other.to_f64(),
    }
}

fn minus(one: Value, other: Value) -> f64 {
    match (one, other) {
        (Value::Whole(one), Value::Whole(other)) => (i128::from(one) - i128::from(other)) as f64,
        _ => one.to_f64() - other.to_f64(),
    }
}
