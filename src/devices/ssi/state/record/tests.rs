//! Tests with words of an AFS60: 18 bits of position, then ERRDIG, ERRSI and ERRSYNC (reference section 8).

use super::*;
use crate::devices::ssi::protocol::{Families, FrameFinding, Settings};

const GOOD: u64 = 0x15_5E68;

fn layout(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
}

/// Returns consecutive words of a stream at intervals of one millisecond.
fn run(first: u64, words: &[u64]) -> Words {
    Words {
        first,
        at: Moment::from_elapsed(Duration::from_millis(10 + first)),
        period_ns: 1_000_000,
        lost: 0,
        clocks: 21,
        words: words.to_vec(),
        clock_hz: 400_000,
        is_limited: false,
    }
}

fn names(record: &Record) -> Vec<(String, u64)> {
    let name = |finding: &FrameFinding| match finding {
        FrameFinding::Error { name, .. } => name.clone(),
        other => format!("{other:?}"),
    };
    record.finding_counts().finding_counts().iter().map(|noted| (name(&noted.finding), noted.count)).collect()
}

#[test]
fn words_around_gap_are_not_consecutive() {
    let mut record = Record::new(layout("afs60"));
    record.add_words(vec![run(0, &[1, 2, 3]), run(3, &[4, 5])], 0);
    assert_eq!((record.latest_words(21), record.count(21)), (vec![1, 2, 3, 4, 5], 5));
    // Two runs of three words each were dropped, because they were not fetched in time.
    record.add_words(vec![run(11, &[6, 7]), run(13, &[8])], 2);
    assert_eq!((record.latest_words(21), record.count(21)), (vec![6, 7, 8], 3));
    assert_eq!((record.dropped_count(), record.count(20)), (6, 0));
}

#[test]
fn renamed_error_bit_keeps_count() {
    let mut record = Record::new(layout("afs60"));
    record.add_words(vec![run(0, &[GOOD, GOOD | 1, GOOD])], 0);
    // The words themselves are no longer stored, but their positions remain recorded.
    record.kept.clear();
    let mut descriptor = record.layout.descriptor().clone();
    descriptor.errors[2].name = "LIGHT".to_owned();
    record.reinterpret(&Layout::new(descriptor).unwrap());
    record.add_words(vec![run(3, &[GOOD | 1])], 0);
    assert_eq!(record.position_count(), 4);
    assert_eq!(names(&record), [("ERRSYNC".to_owned(), 1), ("LIGHT".to_owned(), 1)]);
    record.reinterpret(&layout("afs60,code=gray"));
    assert_eq!(record.position_count(), 1, "only the last word is kept");
}

#[test]
fn cleared_count_survives_layout_change() {
    let mut record = Record::new(layout("afs60"));
    record.add_words(vec![run(0, &[GOOD, GOOD | 1, GOOD])], 0);
    record.reset_tally();
    record.add_words(vec![run(3, &[GOOD | 2])], 0);
    record.reinterpret(&layout("afs60,code=gray"));
    assert_eq!((names(&record), record.position_count()), (vec![("ERRSI".to_owned(), 1)], 4));
}

#[test]
fn new_session_has_no_last_word() {
    let mut record = Record::new(layout("afs60"));
    record.add_words(vec![run(0, &[GOOD])], 0);
    assert!(record.last().is_some());
    record.begin_session(&Zoned::now());
    assert_eq!(record.last(), None);
}
