//! Tests of late results, aborted tasks and changed settings, which cannot be provoked in a window.

use std::time::{Duration, Instant};

use super::*;
use crate::analysis::capture::Capture;
use crate::analysis::quality::Family;
use crate::app::services::StudioEnvironment;
use crate::app::{KindRegistry, Tool};
use crate::signals::state::{DiagnosisSettings, SignalsAction};
use crate::store::Store;

fn services() -> (Services, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    (
        Services::new(
            StudioEnvironment::production(Store::at_root(folder.path()), KindRegistry::NONE),
            Arc::new(|| ()),
        ),
        folder,
    )
}

fn started(services: &mut Services) -> Signals {
    let mut signals = Signals::default();
    signals.handle_action(SignalsAction::Source(SourceAction::Start), services);
    assert!(signals.source.is_running());
    signals
}

fn measurement(diagnosis_settings: DiagnosisSettings) -> Measurement {
    let angle = |at: i32| f64::from(at) / 1000.0 * 4.0 * std::f64::consts::TAU;
    let capture = Capture {
        sine_v: (0..1000).map(|at| 0.42 * angle(at).sin()).collect(),
        cosine_v: (0..1000).map(|at| 0.42 * angle(at).cos()).collect(),
        ..Capture::default()
    };
    Measurement::from_capture(Origin::Virtual, Arc::new(capture), diagnosis_settings)
}

/// Processes task results until the condition is true.
#[track_caller]
fn until(signals: &mut Signals, services: &mut Services, condition: impl Fn(&Signals) -> bool) {
    let began = Instant::now();
    while !condition(signals) {
        assert!(began.elapsed() < Duration::from_secs(20), "never");
        while let Some(action) = services.tasks.next() {
            if let crate::app::Action::Done(crate::app::action::TaskResult::Tool(_, done)) = action {
                Tool::handle_result(signals, done, services).unwrap();
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn notice_ids(services: &Services) -> Vec<&'static str> {
    services.log.notices().flat_map(|notice| notice.texts.iter().map(Text::id)).collect()
}

#[test]
fn shortened_window_reports_length() {
    let mut source = Source { window_ms: 5_000, ..Source::default() };
    // 500 000 samples at 100 kHz and at 1 MHz.
    assert_eq!(source.limited_window_ms(), None);
    source.settings.rate_hz = 1e6;
    assert_eq!(source.limited_window_ms(), Some(500.0));
}

#[test]
fn new_limits_update_verdicts() {
    let (mut services, _folder) = services();
    let mut signals = started(&mut services);
    let before = signals.diagnosis_settings();
    signals.handle_action(SignalsAction::SetFamily(Family::AfsAfm60), &mut services);
    // 0.84 V is too low for HIPERFACE only.
    signals.handle_measurement(signals.source.runs, measurement(before), &mut services);
    assert!(!signals.findings().is_empty());
    signals.handle_action(SignalsAction::Source(SourceAction::Stop), &mut services);
    until(&mut signals, &mut services, |signals| signals.findings().is_empty());
}

#[test]
fn stops_ended_source() {
    let (mut services, _folder) = services();
    let mut signals = started(&mut services);
    signals.source.live.as_ref().unwrap().feed.stop();
    let began = Instant::now();
    while signals.source.is_running() {
        assert!(began.elapsed() < Duration::from_secs(20), "it runs for ever");
        signals.process_samples(&mut services);
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(notice_ids(&services), ["virtual.ended"]);
}

#[test]
fn reports_failed_task() {
    let (mut services, _folder) = services();
    let mut signals = started(&mut services);
    signals.source.live.as_mut().unwrap().measuring = true;
    signals.handle_result(TaskResult::Failed(FailedTask::Measure(signals.source.runs + 1)), &mut services);
    assert!(signals.source.is_running(), "of an earlier start");
    signals.handle_result(TaskResult::Failed(FailedTask::Measure(signals.source.runs)), &mut services);
    assert!(!signals.source.is_running());
    signals.handle_action(SignalsAction::Open("/nowhere/at.all.csv".into()), &mut services);
    let number = signals.capture_reading().unwrap().number;
    signals.handle_result(TaskResult::Failed(FailedTask::Read(number + 1)), &mut services);
    assert!(signals.capture_reading().is_some(), "of another attempt");
    signals.handle_result(TaskResult::Failed(FailedTask::Read(number)), &mut services);
    assert!(signals.capture_reading().is_none());
    signals.handle_result(TaskResult::Failed(FailedTask::Judge), &mut services);
    let expected = ["signals.measuring_failed", "signals.reading_failed", "signals.judging_failed"];
    let told = notice_ids(&services);
    assert!(told.len() == 3 && expected.iter().all(|id| told.contains(id)), "{told:?}");
}
