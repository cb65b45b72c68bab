//! Tests of timing diagrams: the times of the reference, and an axis that shows every event.

use std::time::Duration;

use proptest::prelude::*;

use super::*;
use crate::app::Language;
use crate::devices::ssi::protocol::{Families, Settings};
use crate::devices::ssi::state::strip::Kind;

fn diagram(family: &str, clock_hz: f64, pause_us: f64, synchronous: bool) -> BurstDiagram {
    let families = Families::built_in();
    let family = families.find_by_key(family).unwrap();
    let layout = Settings::default().resolve(family).unwrap().layout;
    let pause = Duration::from_secs_f64(pause_us * 1e-6);
    let reads = ReadConditions {
        clocks: layout.clock_count(),
        clock_hz,
        pause,
        cable_metres: None,
        synchronous,
        any_steps: false,
    };
    BurstDiagram::new(&layout, &family.times, &reads)
}

fn micros(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e3
}

fn span_labels(diagram: &BurstDiagram) -> Vec<String> {
    diagram.spans().iter().map(|span| diagram.span_text(span).to_string_in(Language::English)).collect()
}

/// 33 bits at 400 kHz take 82.5 µs, and tm is 15 to 25 µs (reference section 1).
#[test]
fn draws_short_pause_without_break() {
    let diagram = diagram("afm60", 400e3, 40.0, false);
    let times =
        ["T = 2.5 µs", "Burst of 33 clocks: 82.5 µs", "Pause: 40 µs", "tm = 15 µs … 25 µs", "Minimum pause: 25 µs"];
    assert_eq!(span_labels(&diagram), times);
    // The interval between bursts is 122.5 µs. Two and a half clocks of the next burst are also drawn.
    assert_eq!(diagram.sections().len(), 1);
    assert_eq!(micros(diagram.end_time()), 128.75);
    let edges: Vec<f64> = diagram.clock_edges().into_iter().map(micros).collect();
    assert_eq!(edges[..3], [0.0, 1.25, 2.5]);
    assert_eq!(edges[65..], [81.25, 122.5, 123.75, 125.0, 126.25, 127.5]);
    let bits = diagram.bits();
    assert_eq!((micros(bits[0].from), micros(bits[0].to), bits.len()), (1.25, 3.75, 33));
    assert_eq!((micros(bits[32].from), micros(bits[32].to)), (81.25, 82.5), "then the line is low");
    let (from, least, most) = diagram.low_level_times();
    assert_eq!([from, least, most].map(micros), [82.5, 97.5, 107.5]);
    let steps = diagram.strip().fields().iter().find(|field| field.kind == Kind::Steps).unwrap();
    let (from, to) = diagram.field(steps);
    assert_eq!([from, to].map(micros), [31.25, 76.25], "clocks 13 to 30");
}

/// An AHM36 in synchronous mode starts to sample a position 20 µs after the last clock. The position is ready 125 µs
/// later.
#[test]
fn shows_sampling_moment() {
    let synchronous = diagram("ahm36", 400e3, 200.0, true);
    let marks: Vec<_> = synchronous.marks().iter().map(|mark| (mark.event, micros(mark.at))).collect();
    // 27 clocks take 67.5 µs.
    let expected = [
        (TimingEvent::Latched, 0.0),
        (TimingEvent::Started, 87.5),
        (TimingEvent::Ready, 212.5),
        (TimingEvent::Next, 267.5),
    ];
    assert_eq!(marks, expected);
    assert_eq!(span_labels(&synchronous)[4..], ["Minimum pause: 150 µs", "Preparation of the next position: 125 µs"]);
    let first_edge = diagram("atm60", 500e3, 300.0, true);
    assert_eq!(first_edge.marks()[0], TimingMark { event: TimingEvent::Taken, at: 0.0 });
    assert_eq!(span_labels(&first_edge)[3], "tm = 150 µs");
    assert_eq!(diagram("ahm36", 400e3, 200.0, false).marks().len(), 2);
}

#[test]
fn draws_long_pause_with_break() {
    let diagram = diagram("afm60", 400e3, 82_500.0, false);
    // The first section contains the burst, the events up to 25 µs after it, and a margin of two fifths of a burst. The
    // second one begins with the same margin before the next burst.
    let pieces: Vec<_> = diagram.sections().iter().map(|piece| (micros(piece.from), micros(piece.to))).collect();
    assert_eq!(pieces, [(0.0, 140.5), (82_549.5, 82_588.75)]);
    assert_eq!(skipped_operations(diagram.gap_after_piece(0)).to_string_in(Language::German), "82,41 ms ausgelassen");
    assert_eq!(diagram.gap_after_piece(1), 0.0);
}

#[test]
fn describes_point_in_time() {
    let diagram = diagram("afm60", 400e3, 40.0, false);
    let told = |at: f64| {
        diagram.describe_moment(at * 1e-6).iter().map(|text| text.to_string_in(Language::English)).collect::<Vec<_>>()
    };
    assert_eq!(told(3.0), ["3 µs after the first edge", "Clock 1: turn bit MT11 (number of turn bits: 12)"]);
    assert_eq!(told(90.0), ["90 µs after the first edge", "Pause: 40 µs", "tm = 15 µs … 25 µs"]);
    assert_eq!(told(0.5), ["500 ns after the first edge"]);
}

#[test]
fn times_have_four_significant_figures() {
    for (seconds, words) in [
        (0.0, "0 µs"),
        (62.5e-6, "62.5 µs"),
        (16.666_67e-6, "16.67 µs"),
        (1e-6, "1 µs"),
        (0.999_99e-6, "1 µs"),
        (250e-9, "250 ns"),
        (0.001, "1 ms"),
        (0.999e-3, "999 µs"),
        (0.1234, "123.4 ms"),
        (2.0, "2 s"),
        (1234.5, "1234 s"),
    ] {
        assert_eq!(time(seconds).to_string_in(Language::English), words);
    }
}

#[test]
fn formats_and_parses_frequency_units() {
    for (hertz, english, german) in [
        (0.0, "0 Hz", "0 Hz"),
        (999.0, "999 Hz", "999 Hz"),
        (10_811.0, "10.811 kHz", "10,811 kHz"),
        (400e3, "400 kHz", "400 kHz"),
        (999_999.9, "1 MHz", "1 MHz"),
        (1.5e6, "1.5 MHz", "1,5 MHz"),
        (2e6, "2 MHz", "2 MHz"),
    ] {
        assert_eq!(frequency(hertz).to_string_in(Language::English), english);
        assert_eq!(frequency(hertz).to_string_in(Language::German), german);
    }
    for (text, hertz) in [
        ("400000", 400_000),
        ("400 000", 400_000),
        ("400 kHz", 400_000),
        ("400k", 400_000),
        (" 1,5 MHz ", 1_500_000),
        ("1.5mhz", 1_500_000),
        ("812.5 khz", 812_500),
        ("1000 Hz", 1000),
    ] {
        assert_eq!(read_frequency(text), Ok(hertz), "{text}");
    }
    for text in ["", "kHz", "fast", "-1 kHz", "1e6", "1 GHz", "9999 MHz", "1.2.3"] {
        assert_eq!(read_frequency(text).unwrap_err().id(), "ssi_form.frequency", "{text}");
    }
}

proptest! {
    /// The sections of the axis are in order and together not much longer than a burst.
    #[test]
    fn every_event_is_on_axis(hz in 1e3..2e6_f64, pause in 0.0..1e6_f64, synchronous: bool, key in 0..3_usize) {
        let diagram = diagram(["ahm36", "atm60", "ttk70"][key], hz, pause, synchronous);
        let pieces = diagram.sections();
        prop_assert!(pieces.iter().all(|piece| piece.from < piece.to));
        prop_assert!(pieces.windows(2).all(|two| two[0].to < two[1].from));
        let ends = diagram.spans().iter().flat_map(|span| [span.from, span.least, span.to]);
        for at in ends.chain(diagram.marks().iter().map(|mark| mark.at)).chain(diagram.clock_edges()) {
            prop_assert!(pieces.iter().any(|piece| (piece.from..=piece.to).contains(&at)), "{at}: {pieces:?}");
        }
        // A long pause does not make the burst too small to read.
        let burst = diagram.timing.burst.as_secs_f64();
        let drawn: f64 = pieces.iter().map(|piece| piece.to - piece.from).sum();
        prop_assert!(drawn < 14.0 * burst, "{drawn} of {burst}");
    }
}
