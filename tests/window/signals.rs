//! Tests of the Signals tab without drawing: captures that are read, corrected, rejected and cancelled.

use crate::tabs::Tabs as _;
use std::fmt::Write as _;
use std::path::PathBuf;

use encoder_studio::analysis::capture::{Delimiter, TimeUnit};
use encoder_studio::analysis::diagnosis::{DiagnosisFinding, FindingKind};
use encoder_studio::analysis::quality::{Family, QualityFinding as Parameter};
use encoder_studio::analysis::wiring::Wire;
use encoder_studio::app::{Action, FileQuestion, Language, Severity, Studio};
use encoder_studio::signals::state::{
    Column, ExampleCapture, Origin, SignalsAction as Signals, SourceAction, TableSource,
};
use encoder_studio::sim::sine_cosine::Quantity;

use crate::support::{Desk, Outside};

impl Desk {
    pub(crate) fn signals(&mut self, action: Signals) {
        self.act(Action::tool(action));
    }

    /// Polls until no file is being read.
    #[track_caller]
    pub(crate) fn wait_for_measurement(&mut self) {
        self.until("the capture is read", |studio| studio.signals().capture_reading().is_none());
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.outside.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// Opens a capture as the window does and waits until it has been read.
    #[track_caller]
    fn open_capture(&mut self, path: &std::path::Path) {
        self.act(Action::Open(path.to_owned()));
        self.wait_for_measurement();
    }

    #[track_caller]
    fn problem(&self) -> &'static str {
        self.studio.signals().problem().expect("there is a problem").id()
    }
}

/// Returns a capture of a circle with an amplitude of 0.5 V: `periods` periods of 100 samples each, 10 µs apart.
pub(crate) fn circle(periods: usize) -> String {
    let mut text = "time [ms];SIN;COS\n".to_owned();
    for at in 0..=100 * periods {
        let angle = at as f64 / 100.0 * std::f64::consts::TAU;
        writeln!(text, "{};{};{}", 0.01 * at as f64, 0.5 * angle.sin(), 0.5 * angle.cos()).unwrap();
    }
    text
}

fn shown(studio: &Studio) -> Option<&Origin> {
    studio.signals().measurement().map(|own| &own.origin)
}

#[test]
fn opens_capture_without_session() {
    let mut desk = Desk::fresh("");
    assert!(desk.studio.hiperface().is_none());
    let path = desk.file("circle.CSV", &circle(4));
    desk.open_capture(&path);
    assert_eq!(
        (desk.studio.settings.tab, shown(&desk.studio)),
        (crate::tabs::SIGNALS, Some(&Origin::Table(TableSource::File(path.clone()))))
    );
    let measurement = desk.studio.signals().measurement().unwrap().clone();
    let analysis = measurement.analysis.as_ref().unwrap();
    assert!((analysis.ellipse.amplitude_v - 0.5).abs() < 1e-9);
    // 100 steps of 10 µs are one period.
    assert!((analysis.frequency_hz().unwrap() - 1000.0).abs() < 1e-6);
    assert_eq!(desk.studio.signals().findings(), []);
    desk.act(Action::AskOpen);
    assert_eq!(desk.studio.take_file_question(), Some(FileQuestion::OpenCapture));
    let other = desk.file("table.txt", &circle(2));
    desk.act(Action::Typed(FileQuestion::OpenCapture, other.clone()));
    desk.wait_for_measurement();
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::File(other))));
    desk.act(Action::ShowTab(crate::tabs::HIPERFACE));
    desk.act(Action::AskOpen);
    assert_eq!(desk.studio.take_file_question(), Some(FileQuestion::Open));
}

#[test]
fn examples_match_their_names() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    assert_eq!(desk.studio.signals().findings(), []);
    desk.signals(Signals::Example(ExampleCapture::WithErrors));
    desk.wait_for_measurement();
    let found = desk.studio.signals().findings();
    for (label, wanted) in [
        ("offset", (|own| matches!(own, FindingKind::Limit(Parameter::OffsetCosine(_)))) as fn(&FindingKind) -> bool),
        ("gain", |own| matches!(own, FindingKind::Limit(Parameter::GainRatio(_)))),
        ("phase", |own| matches!(own, FindingKind::Limit(Parameter::PhaseError(_)))),
        ("amplitude", is_amplitude),
    ] {
        assert!(found.iter().any(|own| wanted(&own.kind)), "{label}: {found:?}");
    }
    // 0.8928 V is within 0.8 … 1.2 V.
    desk.signals(Signals::SetFamily(Family::AfsAfm60));
    desk.until("it is judged again", |studio| {
        let found = studio.signals().findings();
        !found.is_empty() && !found.iter().any(|own| is_amplitude(&own.kind))
    });
}

fn is_amplitude(what: &FindingKind) -> bool {
    matches!(what, FindingKind::Limit(Parameter::Amplitude { .. }))
}

#[test]
fn unreadable_table_names_row() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    let broken = circle(2).replacen("0.05;", "0.05;x", 1);
    for (name, text, told) in [
        ("empty.csv", "", "signal.empty"),
        ("words.csv", "no table at all", "signal.no_numbers"),
        ("one.csv", "1\n2\n3\n", "signal.one_column"),
        ("broken.csv", broken.as_str(), "signal.not_a_number"),
        ("nan.csv", "0,1,2\n1,NaN,3\n", "signal.not_finite"),
        ("short.csv", "0,1,2\n1,2\n", "signal.short_row"),
    ] {
        let path = desk.file(name, text);
        desk.open_capture(&path);
        assert_eq!(desk.problem(), told, "{name}");
        assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::Example(ExampleCapture::Healthy))), "{name}");
        let lines = text.lines().next().map(str::to_owned).into_iter().collect::<Vec<_>>();
        assert_eq!(desk.studio.signals().table().unwrap().head.first().cloned().unwrap_or_default(), lines.concat());
    }
    let problem = {
        let path = desk.outside.path("broken.csv");
        desk.open_capture(&path);
        desk.studio.signals().problem().unwrap().terminal_text()
    };
    // The header is row 1, and 0.05 ms is the sixth sample.
    assert!(problem.contains("row 7, column 2"), "{problem}");
    desk.open_capture(&PathBuf::from("/nowhere/at.all.csv"));
    assert_eq!(desk.problem(), "file.not_found");
    assert!(desk.notice_ids(Severity::Error).contains(&"signal.empty"), "the log keeps it");
    assert!(desk.studio.services.log.current().is_none(), "it stands beside its cause");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    assert!(desk.studio.signals().problem().is_none());
}

#[test]
fn overrides_detected_columns() {
    let mut desk = Desk::fresh("");
    let path = desk.file("columns.csv", "a;b;c;d;e\n0;1;2,5;3;2,5\n1;2;2,5;4;2,5\n2;1;2,5;5;2,5\n");
    desk.open_capture(&path);
    let capture = |desk: &Desk| desk.studio.signals().measurement().unwrap().capture.clone();
    assert_eq!(capture(&desk).cosine_v, [2.5, 2.5, 2.5]);
    let table = desk.studio.signals().table().unwrap();
    assert_eq!((table.delimiter(), table.width()), (Some(Delimiter::Semicolon), 5));
    for (action, cosine) in [
        (Signals::SetColumn(Column::Cosine, Some(4)), [3.0, 4.0, 5.0]),
        (Signals::SetVolts(0.1), [0.3, 0.4, 0.5]),
        (Signals::SetColumn(Column::RefSine, Some(3)), [0.3, 0.4, 0.5]),
        (Signals::SetColumn(Column::RefCosine, Some(5)), [0.05, 0.15, 0.25]),
        (Signals::SetVolts(f64::NAN), [0.05, 0.15, 0.25]),
        (Signals::SetVolts(0.0), [0.05, 0.15, 0.25]),
        (Signals::Detect, [2.5, 2.5, 2.5]),
    ] {
        desk.signals(action.clone());
        desk.wait_for_measurement();
        let found = capture(&desk).cosine_v.clone();
        let near = found.iter().zip(cosine).all(|(found, wanted)| (found - wanted).abs() < 1e-12);
        assert!(near && found.len() == 3, "{action:?}: {found:?}");
    }
    desk.signals(Signals::SetTimeUnit(TimeUnit::Microseconds));
    desk.wait_for_measurement();
    assert!((capture(&desk).time_s[2] - 2e-6).abs() < 1e-18);
    desk.signals(Signals::SetDecimalComma(false));
    desk.wait_for_measurement();
    assert_eq!(desk.problem(), "signal.not_a_number");
    desk.signals(Signals::SetDelimiter(Delimiter::Tab));
    desk.wait_for_measurement();
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::File(path))), "what was read last is still shown");
    desk.signals(Signals::Detect);
    desk.wait_for_measurement();
    assert!(desk.studio.signals().problem().is_none());
}

#[test]
fn rejects_data_without_ellipse() {
    let mut desk = Desk::fresh("");
    let quarter: String = circle(1).lines().take(20).fold(String::new(), |text, line| text + line + "\n");
    for (name, text, told) in [
        ("constant.csv", "0,1,2\n1,1,2\n2,1,2\n3,1,2\n4,1,2\n5,1,2\n6,1,2\n".to_owned(), "signal.constant"),
        ("few.csv", "0,1,2\n1,2,1\n".to_owned(), "signal.few_points"),
        ("line.csv", (0..50).map(|at| format!("{at},{at},{at}\n")).collect(), "signal.line"),
        ("quarter.csv", quarter, "signal.coverage"),
        ("huge.csv", (0..50).map(|at| format!("{at},{}e300,{}e300\n", at % 7, at % 5)).collect(), "signal.no_signal"),
    ] {
        let path = desk.file(name, &text);
        desk.open_capture(&path);
        let measurement = desk.studio.signals().measurement().unwrap();
        assert!(measurement.raw.is_some() && measurement.corrected.is_none(), "{name}");
        assert_eq!(measurement.failure_text(Language::English).map(|why| why.id()), Some(told), "{name}");
    }
}

#[test]
fn drops_stale_capture() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    let large = desk.file("large.csv", &circle(20_000));
    desk.act(Action::Open(large.clone()));
    assert!(desk.studio.can_stop());
    desk.act(Action::Escape);
    assert!(
        desk.studio
            .signals()
            .capture_reading()
            .is_some_and(encoder_studio::signals::state::CaptureReading::is_cancelled)
    );
    desk.wait_for_measurement();
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::Example(ExampleCapture::Healthy))));
    assert_eq!(desk.studio.signals().table().unwrap().place, TableSource::Example(ExampleCapture::Healthy));
    assert_eq!(desk.notice_ids(Severity::Note), ["signal.cancelled"]);
    assert!(!desk.studio.can_stop());
    // The capture that was opened later is shown, whichever is read first.
    desk.act(Action::Open(large));
    desk.signals(Signals::Example(ExampleCapture::WithErrors));
    desk.wait_for_measurement();
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::Example(ExampleCapture::WithErrors))));
    for _ in 0..50 {
        desk.studio.poll();
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::Example(ExampleCapture::WithErrors))));
}

#[test]
fn clamps_periods_to_range() {
    let mut desk = Desk { studio: Outside::new("").studio(), outside: Outside::new("") };
    for (wanted, taken) in [(0, 1), (512, 512), (u32::MAX, 65_536)] {
        desk.signals(Signals::SetPeriods(wanted));
        assert_eq!(desk.studio.signals().signal_periods(), Some(taken));
    }
}

#[test]
fn kept_capture_survives_new_capture() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Keep);
    assert!(desk.studio.signals().comparison_result().is_none(), "there is nothing to keep");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    desk.signals(Signals::Keep);
    desk.signals(Signals::Example(ExampleCapture::WithErrors));
    desk.wait_for_measurement();
    let kept = |studio: &Studio| studio.signals().comparison_result().map(|own| own.origin.clone());
    assert_eq!(kept(&desk.studio), Some(Origin::Table(TableSource::Example(ExampleCapture::Healthy))));
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::Example(ExampleCapture::WithErrors))));
    desk.signals(Signals::DropComparison);
    assert_eq!(kept(&desk.studio), None);
}

impl Desk {
    fn source(&mut self, action: SourceAction) {
        self.signals(Signals::Source(action));
    }

    /// Polls until the virtual signal is displayed and meets the condition.
    #[track_caller]
    fn wait_for_live_measurement(
        &mut self,
        what: &str,
        wanted: impl Fn(&encoder_studio::analysis::signal_analysis::Analysis) -> bool,
    ) {
        self.until(what, |studio| {
            let shown = studio.signals().measurement().filter(|own| own.origin == Origin::Virtual);
            shown.and_then(|own| own.analysis.as_ref().ok()).is_some_and(&wanted)
        });
    }
}

#[test]
fn measures_virtual_encoder_repeatedly() {
    let mut desk = Desk::fresh("");
    desk.source(SourceAction::Set(Quantity::Periods, 512.0));
    desk.source(SourceAction::Start);
    assert_eq!(desk.studio.signals().signal_periods(), Some(512));
    assert!(desk.studio.can_stop());
    // 512 periods per revolution at one revolution per second, during 0.2 s at 100 kHz.
    desk.wait_for_live_measurement("it is measured", |own| {
        own.samples == 20_000 && (own.frequency_hz().unwrap() - 512.0).abs() < 0.1
    });
    assert!(is_good(desk.studio.signals().findings()), "{:?}", desk.studio.signals().findings());
    desk.source(SourceAction::Set(Quantity::OffsetSine, 0.05));
    desk.source(SourceAction::Set(Quantity::PhaseError, -7.0));
    desk.wait_for_live_measurement("the errors are seen", |own| {
        (own.ellipse.offset_sine_v - 0.05).abs() < 1e-3 && (own.ellipse.phase_error_deg() + 7.0).abs() < 0.05
    });
    desk.source(SourceAction::SetWindow(50));
    desk.wait_for_live_measurement("less is measured", |own| own.samples == 5_000);
    // With an open wire, the receiver gets no valid signal in that channel.
    desk.source(SourceAction::SetOpenWire(Some(Wire::Sin)));
    desk.until("the open wire is refused", |studio| {
        studio.signals().measurement().is_some_and(|own| own.analysis.is_err())
    });
    desk.source(SourceAction::Reset);
    desk.wait_for_live_measurement("it is as new", |own| own.ellipse.offset_sine_v.abs() < 1e-3);
}

/// Returns whether no finding is worse than a notice.
fn is_good(findings: &[DiagnosisFinding]) -> bool {
    findings.iter().all(|own| own.severity == encoder_studio::analysis::diagnosis::Severity::Notice)
}

#[test]
fn hold_freezes_measurement() {
    let mut desk = Desk::fresh("");
    desk.source(SourceAction::Start);
    desk.wait_for_live_measurement("it is measured", |own| own.ellipse.offset_cosine_v.abs() < 1e-3);
    desk.source(SourceAction::Freeze(true));
    let held = desk.studio.signals().measurement().unwrap().clone();
    desk.source(SourceAction::Set(Quantity::OffsetCosine, 0.1));
    let began = std::time::Instant::now();
    desk.until("a second has passed", |_| began.elapsed().as_millis() > 1_000);
    assert!(std::sync::Arc::ptr_eq(&held, desk.studio.signals().measurement().unwrap()));
    desk.source(SourceAction::Freeze(false));
    desk.wait_for_live_measurement("it goes on", |own| (own.ellipse.offset_cosine_v - 0.1).abs() < 1e-3);
    assert_eq!(desk.studio.signals().source().lost_samples(), 0);
    desk.act(Action::Escape);
    assert!(!desk.studio.signals().source().is_running() && !desk.studio.can_stop());
    let last = desk.studio.signals().measurement().unwrap().clone();
    let wakes = || desk.outside.wakes.load(std::sync::atomic::Ordering::SeqCst);
    // A task that is still running may return.
    let began = std::time::Instant::now();
    let is_quiet = || {
        let before = wakes();
        std::thread::sleep(std::time::Duration::from_millis(500));
        wakes() == before
    };
    while !is_quiet() {
        assert!(began.elapsed() < crate::support::LONG, "something wakes the window although nothing runs");
    }
    desk.studio.poll();
    assert!(std::sync::Arc::ptr_eq(&last, desk.studio.signals().measurement().unwrap()));
}

#[test]
fn out_of_range_setting_changes_nothing() {
    let mut desk = Desk::fresh("");
    for value in [3.0, -1.0, f64::NAN, f64::INFINITY] {
        desk.source(SourceAction::Set(Quantity::Amplitude, value));
        assert_eq!(desk.studio.signals().source().problem().unwrap().id(), "source.out_of_range", "{value}");
        assert_eq!(desk.studio.signals().source().settings().amplitude_v, 0.5);
    }
    desk.source(SourceAction::Set(Quantity::Amplitude, 0.4));
    assert!(desk.studio.signals().source().problem().is_none());
    for (wanted, taken) in [(0, 10), (u32::MAX, 10_000)] {
        desk.source(SourceAction::SetWindow(wanted));
        assert_eq!(desk.studio.signals().source().window_ms(), taken);
    }
}

#[test]
fn hidden_window_counts_lost_samples() {
    let mut desk = Desk::fresh("");
    desk.source(SourceAction::Set(Quantity::Rate, 1_000_000.0));
    // A test build needs too long to measure 200 ms at the full rate.
    desk.source(SourceAction::SetWindow(10));
    desk.source(SourceAction::Start);
    // At most 200 000 samples can wait, which is a fifth of a second at 1 MHz.
    let began = std::time::Instant::now();
    while desk.studio.signals().source().lost_samples() == 0 && began.elapsed() < crate::support::LONG {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(desk.studio.signals().source().lost_samples() > 0);
    desk.source(SourceAction::Set(Quantity::Rate, 50_000.0));
    desk.wait_for_live_measurement("the source is measured at the lower rate", |own| own.samples == 500);
}

#[test]
fn file_replaces_virtual_encoder() {
    let mut desk = Desk::fresh("");
    desk.source(SourceAction::Start);
    desk.wait_for_live_measurement("it is measured", |_| true);
    let path = desk.file("circle.csv", &circle(4));
    desk.act(Action::Open(path.clone()));
    desk.wait_for_measurement();
    assert!(!desk.studio.signals().source().is_running());
    assert_eq!(shown(&desk.studio), Some(&Origin::Table(TableSource::File(path))));
    desk.source(SourceAction::Start);
    desk.wait_for_live_measurement("it is measured again", |_| true);
    assert!(desk.studio.signals().table().is_none());
}

#[test]
fn scope_shows_and_exports_signals() {
    let mut desk = Desk::fresh("");
    desk.signals(Signals::Example(ExampleCapture::Healthy));
    desk.wait_for_measurement();
    let recorder = |studio: &Studio| {
        studio.recorder_for(encoder_studio::app::RecorderOwner::Tool(crate::tabs::SIGNALS)).unwrap().recorded_span()
    };
    let (from, to) = recorder(&desk.studio).unwrap();
    // 401 rows including the header are 400 samples, 5 µs apart.
    assert_eq!(to.nanoseconds_since(from), 399 * 5_000);
    let path = desk.outside.path("scope.csv");
    let question = FileQuestion::Table {
        owner: encoder_studio::app::RecorderOwner::Tool(crate::tabs::SIGNALS),
        visible: false,
        suggested: path.clone(),
    };
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is written", |studio| {
        studio.services.log.notices().any(|notice| notice.texts.iter().any(|text| text.id() == "recorder.written"))
    });
    desk.source(SourceAction::Start);
    desk.until("samples come", |studio| {
        recorder(studio).is_some_and(|(from, to)| to.nanoseconds_since(from) > 300_000_000)
    });
    desk.act(Action::Stop);
    desk.open_capture(&path);
    assert!(desk.studio.signals().problem().is_none(), "{:?}", desk.studio.signals().problem());
    let measurement = desk.studio.signals().measurement().unwrap();
    assert_eq!(measurement.capture.sine_v.len(), 400);
    // The signals in healthy.csv have 2 kHz.
    assert!((measurement.analysis.as_ref().unwrap().frequency_hz().unwrap() - 2_000.0).abs() < 1.0);
}

#[test]
fn reports_findings_worse_than_kept_capture() {
    let mut desk = Desk::fresh("");
    desk.source(SourceAction::Start);
    desk.wait_for_live_measurement("it is measured", |_| true);
    desk.signals(Signals::Keep);
    desk.source(SourceAction::Set(Quantity::Interference, 0.02));
    desk.until("the drive is seen", |studio| {
        let rose = |own: &DiagnosisFinding| match own.kind {
            FindingKind::InterferenceIncreased { frequency_hz, .. } => (frequency_hz - 8_000.0).abs() < 5.0,
            _ => false,
        };
        studio.signals().changes().is_some_and(|own| own.worse.iter().any(rose))
    });
    let measurement = desk.studio.signals().measurement().unwrap();
    let peak = measurement.spectra.as_ref().unwrap().sine.peaks[1];
    assert!((peak.frequency_hz - 8_000.0).abs() < 2.0 && (peak.amplitude_v - 0.02).abs() < 1e-3, "{peak:?}");
}
