//! Reading words repeatedly: each word is requested if there is enough time, otherwise the adapter streams them. The
//! stream is stopped before any other request.

use std::time::Duration;

use encoder_studio::buses::bridge::procedures::AdapterError;
use encoder_studio::buses::bridge::protocol::Operation;
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::ssi::jobs::SsiJob;
use encoder_studio::devices::ssi::procedures::{ClockSettings, Error, Words};
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::Clock;

use super::support::{QUICK, Stand};
use crate::biss::support::pairs;

const FAST: Duration = Duration::from_micros(50);
/// Settings of an ATM60 at 50 revolutions per second. With 8192 steps per turn and 50 µs per word, the shaft moves
/// 20.48 steps per word.
const TURNING: &str = "ssi=atm60,code=binary&rpm=3000&position=0";

/// Checks that numbers and times have no gaps, and that the position follows the shaft.
fn check(runs: &[Words]) {
    let (mut next, mut before) = (runs[0].first, None);
    for run in runs {
        assert_eq!((run.first, run.lost, run.period_ns, run.clocks), (next, 0, 50_000, 25));
        next = run.first + run.words.len() as u64;
        for (moment, word) in run.iter_with_times() {
            if let Some((earlier, from)) = before {
                assert_eq!(moment.duration_since(earlier), FAST);
                assert!((20..=21).contains(&(word - from)), "{from} to {word}");
            }
            before = Some((moment, word));
        }
    }
}

#[test]
fn slow_polling_reads_word_by_word() {
    let mut stand = Stand::quick(TURNING);
    stand.session.set_sample_interval(Some(Duration::from_millis(5)));
    let mut samples: Vec<Words> = (0..4).map(|_| stand.sample()).collect();
    assert!(stand.read().is_stream_start(), "a word by itself is none of them");
    samples.push(stand.sample());
    let firsts: Vec<u64> = samples.iter().map(|words| words.first).collect();
    assert_eq!(firsts, [0, 1, 2, 3, 4]);
    assert!(samples.iter().all(|words| words.words.len() == 1 && !words.is_streamed() && words.lost == 0));
    assert!(samples.iter().zip(&samples[1..]).all(|(one, next)| next.at > one.at));
    assert_eq!((stand.count(Operation::SsiRead), stand.count(Operation::SsiStream)), (6, 0));
    stand.session.set_sample_interval(None);
    stand.session.set_sample_interval(Some(Duration::from_millis(5)));
    assert!(stand.sample().is_stream_start());
}

#[test]
fn streams_short_polling_intervals() {
    let mut stand = Stand::quick(TURNING);
    stand.session.set_sample_interval(Some(FAST));
    let runs = stand.samples(Duration::from_secs(3));
    check(&runs);
    assert!(runs[0].is_stream_start() && runs[1..].iter().all(|run| !run.is_stream_start() && run.is_streamed()));
    // The last words may still be in transit.
    let words: usize = runs.iter().map(|run| run.words.len()).sum();
    let streamed = stand.clock.now().duration_since(runs[0].at).as_micros() as usize / 50;
    assert!(words > 50_000 && (streamed - 200..=streamed + 1).contains(&words), "{words} of {streamed}");
    assert_eq!((stand.count(Operation::SsiStream), stand.count(Operation::SsiRead)), (1, 0));
    stand.session.set_sample_interval(None);
    assert_eq!(stand.unsolicited_byte_count(), 0);
}

#[test]
fn job_interrupts_stream() {
    let mut stand = Stand::quick(TURNING);
    stand.session.set_sample_interval(Some(FAST));
    let mut last = None;
    for round in 0..3 {
        let runs = stand.samples(Duration::from_millis(200));
        check(&runs);
        let begin = runs[0].at;
        assert!(runs[0].is_stream_start() && last.is_none_or(|last| begin > last), "{round}: {begin:?}, {last:?}");
        let read = stand.read();
        last = Some(read.at);
        assert!(read.is_stream_start());
    }
    stand.session.set_sample_interval(Some(Duration::from_millis(5)));
    assert!(!stand.sample().is_streamed(), "slow enough to be asked");
    assert_eq!(stand.unsolicited_byte_count(), 0);
    stand.session.set_sample_interval(Some(FAST));
    stand.sample();
    stand.session.set_sample_interval(Some(FAST * 2));
    assert_eq!(stand.sample().period_ns, 100_000, "another pace is another stream");
}

/// When the settings change, the stream continues and has the new width from its first word on.
#[test]
fn changed_settings_apply_to_running_stream() {
    let mut stand = Stand::quick(TURNING);
    stand.session.set_sample_interval(Some(FAST));
    check(&stand.samples(Duration::from_millis(100)));
    for clocks in [13, 25, 40] {
        let clock_settings = ClockSettings { clocks, ..QUICK };
        stand.session.run_inline(SsiJob::Set(clock_settings)).unwrap();
        let runs = stand.samples(Duration::from_millis(100));
        assert!(runs[0].is_stream_start() && runs.iter().all(|run| run.clocks == clocks && run.lost == 0));
        let widest = runs.iter().flat_map(|run| &run.words).max().unwrap();
        assert!(*widest > 0 && widest >> clocks == 0, "{widest:X}");
    }
    assert_eq!(stand.count(Operation::Hello), 1);
}

/// 25 clocks at 500 kHz take 50 µs, and the pause takes 200 µs.
#[test]
fn reports_clock_or_pause_too_slow() {
    let mut slow = Stand::new("clock=500000&pause=200", TURNING);
    slow.session.set_sample_interval(Some(FAST));
    let run = slow.sample();
    assert_eq!((run.period_ns, run.clock_hz, run.is_limited), (250_000, 500_000, true));
    let mut quick = Stand::quick(TURNING);
    quick.session.set_sample_interval(Some(FAST));
    assert!(!quick.sample().is_limited);
}

#[test]
fn restored_wire_starts_new_stream() {
    let mut stand = Stand::quick(TURNING);
    stand.session.set_sample_interval(Some(FAST));
    stand.sample();
    stand.tap.lock().unwrap().mute_from = Some(0);
    let error = stand.session.take_sample().unwrap_err();
    assert_eq!(error, Error::Adapter(AdapterError::StreamSilent));
    stand.tap.lock().unwrap().mute_from = None;
    // HELLO ends the stream.
    assert!(stand.sample().is_stream_start());
    assert_eq!(stand.count(Operation::Hello), 2);
    stand.tap.lock().unwrap().unplugged = true;
    assert!(matches!(stand.session.take_sample(), Err(Error::Link(error)) if error.is_lost()));
}

/// A reset stops the stream and clears supply and clock. The next job or sample detects this and continues.
#[test]
fn reconfigures_adapter_reset_while_streaming() {
    let query = "supply=switched&rpm=60";
    for by_job in [true, false] {
        let mut stand = Stand::new("clock=1500000&pause=30&voltage=5", query);
        stand.session.set_sample_interval(Some(FAST));
        stand.samples(Duration::from_millis(100));
        *stand.adapter.lock().unwrap() = Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap();
        if by_job {
            stand.read();
        } else {
            // Data that were sent before still arrive.
            let error = (0..100).find_map(|_| stand.session.take_sample().err()).unwrap();
            assert_eq!(error, Error::Adapter(AdapterError::StreamSilent));
        }
        assert!(stand.sample().is_stream_start());
        assert_eq!((stand.count(Operation::Supply), stand.count(Operation::SsiConfig)), (2, 2), "{by_job}");
    }
}

/// Without a stream, the next request detects the reset.
#[test]
fn reconfigures_adapter_reset_between_words() {
    let query = "supply=switched&rpm=60";
    let mut stand = Stand::new("voltage=5", query);
    stand.session.set_sample_interval(Some(Duration::from_millis(100)));
    assert_eq!((stand.sample().first, stand.sample().first), (0, 1));
    *stand.adapter.lock().unwrap() = Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap();
    let words = stand.sample();
    assert!(words.first == 2 && words.words[0] != (1 << 25) - 1, "the encoder has its supply again: {words:?}");
    assert_eq!((stand.count(Operation::Supply), stand.count(Operation::SsiConfig)), (2, 2));
}

/// Damaged packets are counted as missing before the next word, and no word is wrong.
#[test]
fn reports_lost_packets() {
    let mut stand = Stand::quick(&format!("{TURNING}&seed=3&fault=drop:0.001"));
    stand.session.set_sample_interval(Some(FAST));
    let runs = stand.samples(Duration::from_secs(2));
    let lost: u64 = runs.iter().map(|run| run.lost).sum();
    let came: usize = runs.iter().map(|run| run.words.len()).sum();
    assert!(lost > 0 && came > 10_000, "{lost} of {came}");
    let mut next = 0;
    for run in &runs {
        assert_eq!(run.first, next + run.lost);
        next = run.first + run.words.len() as u64;
    }
}
