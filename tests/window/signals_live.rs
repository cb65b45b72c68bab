//! Tests of the virtual encoder without drawing: it is held, stopped, changed and started during other work.

use crate::tabs::Tabs as _;
use encoder_studio::analysis::history::Flags;
use encoder_studio::analysis::quality::Family;
use encoder_studio::app::{Action, RecorderOwner as Of, Studio};
use encoder_studio::signals::state::{ExampleCapture, Origin, SignalsAction as Signals, SourceAction};
use encoder_studio::sim::sine_cosine::Quantity;

use crate::signals::circle;
use crate::support::Desk;

/// Returns the number of samples in the scope, and the indices of the gaps.
fn recorded(studio: &Studio) -> (u64, Vec<u64>) {
    let recorder = studio.recorder_for(Of::Tool(crate::tabs::SIGNALS)).unwrap();
    let history = recorder.history(&recorder.series()[0]).unwrap();
    let is_break = |at: &u64| history.sample(0, *at).is_some_and(|own| own.flags.contains(Flags::BREAK));
    (history.indices().end, history.indices().filter(is_break).collect())
}

#[test]
fn hold_leaves_gap_in_scope() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Source(SourceAction::Start));
    desk.until("samples come", |studio| recorded(studio).0 > 1_000);
    desk.signals(Signals::Source(SourceAction::Freeze(true)));
    let (count, breaks) = recorded(&desk.studio);
    let began = std::time::Instant::now();
    desk.until("some time passes", |_| began.elapsed().as_millis() > 200);
    assert_eq!(recorded(&desk.studio).0, count);
    desk.signals(Signals::Source(SourceAction::Freeze(false)));
    desk.until("it goes on", |studio| recorded(studio).0 > count);
    let after = recorded(&desk.studio).1;
    assert!(after.contains(&count) && !breaks.contains(&count), "{count}: {after:?}");
}

/// Until the user enters the periods per turn, there is no speed and no error in seconds of arc. The periods of the
/// virtual encoder do not apply to a capture (issue 22.13).
#[test]
fn periods_have_no_default() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.until("it is measured", |studio| {
        studio.signals().capture_reading().is_none() && studio.signals().measurement().is_some()
    });
    let judged = |studio: &Studio| studio.signals().measurement().and_then(|own| own.diagnosis_settings.periods);
    assert_eq!((desk.studio.signals().signal_periods(), judged(&desk.studio)), (None, None));
    desk.signals(Signals::SetPeriods(512));
    desk.signals(Signals::Example(ExampleCapture::WithErrors));
    desk.until("it is measured", |studio| {
        studio.signals().capture_reading().is_none() && studio.signals().measurement().is_some()
    });
    assert_eq!(desk.studio.signals().signal_periods(), Some(512), "what was typed stays");
    desk.signals(Signals::Source(SourceAction::Start));
    assert!(desk.studio.signals().signal_periods().is_some());
    desk.signals(Signals::Source(SourceAction::Stop));
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.until("it is measured", |studio| {
        studio.signals().capture_reading().is_none() && studio.signals().measurement().is_some()
    });
    assert_eq!(desk.studio.signals().signal_periods(), None);
}

#[test]
fn stopped_source_accepts_periods() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Source(SourceAction::Start));
    desk.until("it is measured", |studio| studio.signals().measurement().is_some());
    desk.signals(Signals::Source(SourceAction::Stop));
    let judged = |studio: &Studio| studio.signals().measurement().and_then(|own| own.diagnosis_settings.periods);
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Periods, 512.0)));
    desk.until("it is judged again", |studio| judged(studio) == Some(512));
    desk.signals(Signals::SetPeriods(16));
    desk.until("it is judged again", |studio| judged(studio) == Some(16));
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Periods, -1.0)));
    assert_eq!(desk.studio.signals().signal_periods(), Some(16), "what is refused changes nothing");
    desk.signals(Signals::Source(SourceAction::Reset));
    assert_eq!(desk.studio.signals().source().settings().periods, 1024.0);
    assert_eq!(desk.studio.signals().signal_periods(), Some(1024));
    desk.until("it is judged again", |studio| judged(studio) == Some(1024));
}

#[test]
fn shows_lost_samples_until_next_start() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Rate, 1_000_000.0)));
    desk.signals(Signals::Source(SourceAction::Start));
    let began = std::time::Instant::now();
    while desk.studio.signals().source().lost_samples() == 0 && began.elapsed() < crate::support::LONG {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    desk.signals(Signals::Source(SourceAction::Stop));
    assert!(desk.studio.signals().source().lost_samples() > 0);
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Rate, 1_000.0)));
    desk.signals(Signals::Source(SourceAction::Start));
    assert_eq!(desk.studio.signals().source().lost_samples(), 0);
}

#[test]
fn late_file_does_not_replace_newer_source() {
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("large.csv");
    std::fs::write(&path, circle(2_000)).unwrap();
    desk.act(Action::Open(path));
    assert!(desk.studio.signals().capture_reading().is_some());
    desk.signals(Signals::Source(SourceAction::Start));
    assert!(desk.studio.signals().capture_reading().is_none());
    let began = std::time::Instant::now();
    desk.until("a file would have been read", |studio| {
        assert!(studio.signals().source().is_running());
        began.elapsed().as_secs() >= 2 && studio.signals().measurement().is_some()
    });
    assert_eq!(desk.studio.signals().measurement().unwrap().origin, Origin::Virtual);
}

#[test]
fn kept_capture_keeps_no_samples() {
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("large.csv");
    std::fs::write(&path, circle(1_500)).unwrap();
    desk.act(Action::Open(path));
    desk.wait_for_measurement();
    let samples = std::sync::Arc::downgrade(&desk.studio.signals().measurement().unwrap().capture);
    desk.signals(Signals::Keep);
    desk.signals(Signals::Example(encoder_studio::signals::state::ExampleCapture::Healthy));
    desk.wait_for_measurement();
    desk.until("the samples are gone", |_| samples.strong_count() == 0);
    // The circle has 100 samples per period.
    assert_eq!(desk.studio.signals().comparison_result().unwrap().analysis.as_ref().unwrap().samples, 150_001);
}

#[test]
fn selected_limits_judge_kept_capture() {
    let mut desk = Desk::fresh("");
    // 0.84 V is too low for HIPERFACE, but good for AFS/AFM60.
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Amplitude, 0.42)));
    desk.signals(Signals::SetFamily(Family::AfsAfm60));
    desk.signals(Signals::Source(SourceAction::Start));
    desk.until("it is measured", |studio| studio.signals().measurement().is_some());
    desk.signals(Signals::Keep);
    desk.signals(Signals::Source(SourceAction::Stop));
    desk.signals(Signals::SetFamily(Family::Hiperface));
    desk.until("it is judged again", |studio| !studio.signals().findings().is_empty());
    let changes = desk.studio.signals().changes().unwrap();
    assert!(changes.worse.is_empty(), "it is the same capture: {changes:?}");
}
