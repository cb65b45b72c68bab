//! Positions of a stream: many at once, and nothing of them is joined that does not belong together.

use super::*;

#[derive(Clone, Debug, PartialEq)]
struct Nothing;

impl Watchable for Nothing {
    fn is_whole(&self) -> bool {
        true
    }

    fn line(&self, group: GroupId) -> Line {
        Line::of(group, 0, Text::new("recorder.position"), "nothing", vec![Scale::new("unit.steps", 1.0, 0)])
    }
}

/// A revolution of 1000 steps, 50 steps a sample, 20 000 of them a second: 1000 revolutions.
fn stream(from: u64, count: u64) -> Vec<Sighting> {
    (from..from + count)
        .map(|number| Sighting {
            at: Moment::after_start(Duration::from_micros(50 * number)),
            position: Some((number * 50 % 1000) as i64),
            is_bad: false,
            is_warned: false,
        })
        .collect()
}

fn samples(track: &Track<Nothing>, line: usize) -> Vec<(i64, f64, Flags)> {
    let line = &track.recorder.lines()[line];
    let history = track.recorder.history(line).unwrap();
    let sample = |at| history.sample(line.column(), at).unwrap();
    history.all().map(sample).map(|own| (own.time.nanoseconds(), own.value.to_f64(), own.flags)).collect()
}

#[test]
fn a_stream_is_recorded_as_it_comes() {
    let meaning = Meaning::of_turns(Some(1000), 1000.0);
    let mut track = Track::<Nothing>::default();
    // In portions that are no multiples of anything.
    let all = stream(0, 40_000);
    all.chunks(173).for_each(|portion| track.add(portion, &meaning));
    assert_eq!((track.positions(), track.dropped()), (40_000, 0));
    for (number, (time, steps, flags)) in samples(&track, 0).into_iter().enumerate() {
        assert_eq!((time, steps), (number as i64 * 50_000, number as f64 * 50.0), "the wrap is none");
        assert_eq!(flags, Flags::NONE);
    }
    let speeds = samples(&track, 1);
    // A quarter of a second is averaged.
    assert!(speeds[..5_000].iter().all(|(_, speed, _)| speed.is_nan()));
    assert!(speeds[5_001..].iter().all(|(_, speed, _)| (speed - 1e6).abs() < 1e-3));
}

#[test]
fn what_is_missing_wrong_or_warned_is_marked_and_not_bridged() {
    let meaning = Meaning::of_turns(Some(1000), 1000.0);
    let mut track = Track::<Nothing>::default();
    let mut own = stream(0, 6);
    own[2].position = None;
    own[4].is_bad = true;
    own[5].is_warned = true;
    track.add(&own, &meaning);
    track.lose(3);
    track.add(&stream(9, 2), &meaning);
    track.gap();
    track.add(&stream(11, 1), &meaning);
    // One that was read on its own before is not recorded again.
    track.add(&stream(5, 1), &meaning);
    let (none, bad, broken) = (Flags::NONE, Flags::BAD | Flags::BREAK, Flags::BREAK);
    let expected = [
        (0, 0.0, none),
        (50_000, 50.0, none),
        (100_000, 50.0, bad),
        (150_000, 150.0, broken),
        (200_000, 200.0, bad),
        (250_000, 250.0, broken | Flags::WARNING),
        (450_000, 450.0, broken),
        (500_000, 500.0, none),
        (550_000, 550.0, broken),
    ];
    assert_eq!(samples(&track, 0), expected);
    assert_eq!((track.positions(), track.dropped()), (9, 3));
}
