//! Tests of the position stream from a BiSS adapter: 20 000 frames per second are shown without loss.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::time::{Duration, Instant};

use encoder_studio::analysis::history::Flags;
use encoder_studio::app::{Action, Recording, Severity, Studio};
use encoder_studio::devices::biss::state::{BissAction as Biss, Encoder};

use crate::biss_support::is_read;
use crate::screen::Screen;
use crate::support::{Desk, Outside};

/// A link to a virtual adapter that reads a frame about every 50 µs: 43 clocks at 2 MHz take 21.5 µs, followed by a
/// pause of 27 µs. The shaft turns five times per second.
const LINK: &str = "sim:?bridge=on&clock=2000000&rpm=300";
const FAST: Duration = Duration::from_micros(50);

fn poll(studio: &Studio, interval: Option<Duration>) -> Action {
    Action::Command(studio.biss().unwrap().session.id, DeviceCommand::Poll(interval))
}

/// Returns the recorded positions with their times in nanoseconds, and the number of gaps in the recording.
fn recorded(encoder: &Encoder) -> (Vec<(i64, i64)>, usize) {
    let recorder = encoder.record.recorder();
    let line = &recorder.series()[0];
    let history = recorder.history(line).unwrap();
    let samples: Vec<_> = history.indices().filter_map(|at| history.sample(line.column(), at)).collect();
    let breaks = samples.iter().filter(|own| own.flags != Flags::NONE).count();
    (samples.iter().map(|own| (own.time.as_nanoseconds(), own.value.to_f64() as i64)).collect(), breaks)
}

/// Checks that the streamed positions are 50 µs apart and follow the shaft: 655 360 steps per second are 32.768 steps
/// per frame. The times have a tolerance, because between two packets they drift with this computer's clock.
#[track_caller]
fn check(encoder: &Encoder, seconds: f64) {
    let (samples, breaks) = recorded(encoder);
    // A single reading before the stream is not part of it.
    let streamed = &samples[samples.len() - (encoder.record.position_count() as usize - 2)..];
    assert!(streamed.windows(2).all(|pair| (pair[1].0 - pair[0].0 - 50_000).abs() <= 5_000));
    assert!(streamed.windows(2).all(|pair| (32..=33).contains(&(pair[1].1 - pair[0].1))));
    assert!(breaks <= 2, "{breaks}");
    assert_eq!((encoder.record.dropped_count(), encoder.record.crc_errors()), (0, 0));
    let expected = seconds * 20_000.0;
    assert!((streamed.len() as f64 - expected).abs() < 0.2 * expected, "{} frames in {seconds} s", streamed.len());
}

#[test]
fn records_stream_without_loss() {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::BISS));
    desk.studio.start_with(Some(LINK.parse().unwrap()), None);
    desk.until("the encoder is read", is_read);
    desk.act(poll(&desk.studio, Some(FAST)));
    desk.until("frames come", |studio| studio.biss().is_some_and(|own| own.active_stream().is_some()));
    let began = Instant::now();
    desk.until("two seconds pass", |_| began.elapsed() > Duration::from_secs(2));
    desk.act(poll(&desk.studio, None));
    let seconds = began.elapsed().as_secs_f64();
    desk.settle();
    let encoder = desk.studio.biss().unwrap();
    check(encoder, seconds);
    assert_eq!(encoder.active_stream(), None);
    assert!(desk.notice_ids(Severity::Warning).is_empty());
    // A job during the stream causes a gap but no dropped frames.
    desk.act(poll(&desk.studio, Some(FAST)));
    desk.until("frames come", |studio| studio.biss().is_some_and(|own| own.active_stream().is_some()));
    let before = desk.studio.biss().unwrap().record.position_count();
    let id = desk.studio.biss().unwrap().session.id;
    desk.act(Action::device(id, Biss::ReadStatus));
    desk.until("it goes on", |studio| {
        studio.biss().is_some_and(|own| own.session.is_ready() && own.record.position_count() > before + 2_000)
    });
    assert_eq!(desk.studio.biss().unwrap().record.dropped_count(), 0);
    assert!(desk.notice_ids(Severity::Warning).is_empty());
}

#[test]
fn window_shows_stream_without_loss() {
    let outside = Outside::new("");
    let mut studio = outside.studio();
    studio.handle_action(Action::ShowTab(crate::tabs::BISS));
    studio.start_with(Some(LINK.parse().unwrap()), None);
    let mut screen = Screen::of(outside, studio, [1280.0, 800.0]);
    screen.until("the encoder is read", is_read);
    let action = poll(screen.studio(), Some(FAST));
    screen.act(action);
    screen.until("frames come", |studio| studio.biss().is_some_and(|own| own.active_stream().is_some()));
    let began = Instant::now();
    for page in encoder_studio::kinds::program().tabs.page_text_ids(crate::tabs::BISS) {
        screen.click(page);
    }
    screen.until("three seconds pass", |_| began.elapsed() > Duration::from_secs(3));
    assert!(screen.shows("Stream: 20000 frames/s at 2.0 MHz"));
    assert_eq!(screen.studio().biss().unwrap().record.dropped_count(), 0);
    let action = poll(screen.studio(), None);
    screen.act(action);
    check(screen.studio().biss().unwrap(), began.elapsed().as_secs_f64());
}
