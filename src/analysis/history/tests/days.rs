//! Tests of long runs in virtual time and of their memory use. The runs are shorter than a day to keep unoptimised
//! builds fast; `benches/history.rs` runs a whole day.

use super::super::{BLOCK, ColumnPart, Flags, Grid, History, Kind, RenderedHistory};
use crate::analysis::{Motion, PositionUnwrapper, SampleTime};

const MILLISECOND: i64 = 1_000_000;

#[test]
fn memory_stays_near_raw_size() {
    let cases: [(&str, &[Kind], bool); 4] = [
        ("one column", &[Kind::Real], false),
        ("one column with flags everywhere", &[Kind::Whole], true),
        ("four columns", &[Kind::Real, Kind::Real, Kind::Whole, Kind::Whole], false),
        ("sixteen columns with flags everywhere", &[Kind::Real; 16], true),
    ];
    for (label, kinds, flagged) in cases {
        let capacity = 60 * BLOCK;
        let mut history = History::new(kinds, capacity);
        let reals = vec![1.5; BLOCK];
        let wholes = vec![15; BLOCK];
        let flags = vec![Flags::WARNING; if flagged { BLOCK } else { 0 }];
        let part = |kind: &Kind| match kind {
            Kind::Real => ColumnPart::from_reals(&reals).with_flags(&flags),
            Kind::Whole => ColumnPart::from_integers(&wholes).with_flags(&flags),
        };
        let parts: Vec<ColumnPart<'_>> = kinds.iter().map(part).collect();
        let mut most = 0;
        for block in 0..200_i64 {
            let times: Vec<SampleTime> = (0..BLOCK as i64)
                .map(|at| SampleTime::from_nanoseconds((block * BLOCK as i64 + at) * MILLISECOND))
                .collect();
            history.append(&times, &parts).unwrap();
            most = most.max(history.memory());
        }
        let samples = (history.indices().end - history.indices().start) as usize;
        assert_eq!(samples, capacity + BLOCK, "{label}");
        let raw = samples * 8 * (kinds.len() + 1);
        let ratio = most as f64 / raw as f64;
        assert!(ratio < 1.35, "{label}: {ratio}");
    }
}

#[test]
fn times_stay_exact_over_ten_days() {
    let mut history = History::new(&[Kind::Whole], 10_000);
    let ten_days = 10 * 86_400_000;
    // Each batch covers an hour, and the history keeps the last seconds. The rate is 1 kHz with a jitter of a few
    // nanoseconds.
    let at = |k: i64| SampleTime::from_nanoseconds(k * MILLISECOND + k % 7);
    for start in (0..ten_days).step_by(3_600_000) {
        let numbers: Vec<i64> = (start..start + 5_000).collect();
        let times: Vec<SampleTime> = numbers.iter().map(|k| at(*k)).collect();
        history.append(&times, &[ColumnPart::from_integers(&numbers)]).unwrap();
        for k in (start..start + 5_000).step_by(499) {
            let index = history.nearest_index(at(k)).unwrap();
            assert_eq!(history.time(index), Some(at(k)));
            let before = history.time(index - u64::from(k != start)).unwrap();
            assert_eq!(
                at(k).nanoseconds_since(before),
                at(k).as_nanoseconds() - at((k - 1).max(start)).as_nanoseconds()
            );
            assert_eq!(history.indices_between(at(k), at(k).saturating_add_ns(1)), index..index + 1);
        }
    }
}

#[test]
fn long_rotation_keeps_breaks_and_hides_wraps() {
    const BATCH: i64 = 5_000;
    const RANGE: i64 = 4096 * 4096;
    // Speed in steps per millisecond. This is about 6000 rpm, so the position wraps every 41 s.
    const SPEED: i64 = 409;
    let mut history = History::new(&[Kind::Whole, Kind::Real], 200_000).with_longest_pause(10 * MILLISECOND);
    let mut unwrap = PositionUnwrapper::rotary(RANGE).unwrap();
    let mut motion = Motion::with_window(20 * MILLISECOND);
    let mut most = 0;
    let mut start = 0;
    let mut gaps = 0;
    for batch in 0..360 {
        let mut positions = Vec::new();
        let mut speeds = Vec::new();
        let mut times = Vec::new();
        if batch % 7 == 3 {
            // The cable was unplugged for 100 ms.
            start += 100;
            gaps += 1;
            unwrap.mark_gap();
        }
        for k in start..start + BATCH {
            let time = SampleTime::from_nanoseconds(k * MILLISECOND);
            let next = unwrap.next((k * SPEED).rem_euclid(RANGE)).unwrap();
            assert_eq!((next.steps, next.broken), (k * SPEED, batch % 7 == 3 && k == start));
            if next.broken {
                motion.reset();
            }
            let speed = motion.next(time, next.steps).speed;
            assert!(speed.is_none_or(|speed| (speed - SPEED as f64 * 1000.0).abs() < 1e-6), "{speed:?}");
            positions.push(next.steps);
            speeds.push(speed.unwrap_or(f64::NAN));
            times.push(time);
        }
        history.append(&times, &[ColumnPart::from_integers(&positions), ColumnPart::from_reals(&speeds)]).unwrap();
        start += BATCH;
        most = most.max(history.memory());
    }
    assert!(most < 200_000 * 24 * 135 / 100, "{most}");
    // In pictures of the remaining samples at three zooms, every gap is a break, and no column exceeds the travel of
    // the encoder.
    let all = history.indices();
    let (from, to) = (history.time(all.start).unwrap(), history.time(all.end - 1).unwrap().saturating_add_ns(1));
    let kept = all.clone().filter(|index| history.sample(0, *index).unwrap().flags == Flags::BREAK).count();
    assert!(kept > 3 && kept <= gaps);
    for pixels in [20, 400, 3_000] {
        let grid = Grid::new(from, to, pixels);
        let mut picture = RenderedHistory::default();
        history.render_column(0, &history.divide_into_pixels(&grid), &mut picture);
        let broken = picture.pixels.iter().filter(|pixel| pixel.flags.contains(Flags::BREAK)).count();
        assert!(broken == kept || pixels == 20 && broken > 3, "{pixels}: {broken} of {kept}");
        for pixel in &picture.pixels {
            let values = pixel.values.unwrap();
            let turned = pixel.to.nanoseconds_since(pixel.from) / MILLISECOND * SPEED;
            assert_eq!((values.min, values.max), (values.first, values.last));
            assert_eq!(values.last - values.first, turned as f64);
        }
    }
}
