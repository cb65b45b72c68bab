//! Tests of sine and cosine from the virtual adapter and from one on a network: the displayed values, and the message
//! if there is no adapter.

use crate::tabs::Tabs as _;
use std::time::Instant;

use encoder_studio::analysis::history::Flags;
use encoder_studio::analysis::quality::Family;
use encoder_studio::app::{Action, RecorderOwner as Of, Severity, Studio};
use encoder_studio::buses::bridge::protocol::Request;
use encoder_studio::signals::state::{Origin, SignalsAction as Signals, SourceAction, SourceKind};

use crate::screen::Screen;
use crate::served::ServedDevice;
use crate::support::{Desk, HANGING_LINK, LONG, Outside};

fn begin(desk: &mut Desk, link: &str, sample_hz: u32) {
    desk.signals(Signals::Source(SourceAction::SetLink(link.to_owned())));
    desk.signals(Signals::Source(SourceAction::SetSampleRate(sample_hz)));
    desk.signals(Signals::Source(SourceAction::StartAdapter));
}

/// Returns the number of samples in the scope and the number of gaps, where the first sample counts as one.
fn recorded(studio: &Studio) -> (u64, usize) {
    let recorder = studio.recorder_for(Of::Tool(crate::tabs::SIGNALS)).unwrap();
    let history = recorder.history(&recorder.series()[0]).unwrap();
    let is_break = |at: &u64| history.sample(0, *at).is_some_and(|own| own.flags.contains(Flags::BREAK));
    (history.indices().end, history.indices().filter(is_break).count())
}

/// The adapter samples an encoder with 0.5 V and 1024 periods that makes one turn in ten seconds.
#[test]
fn measures_virtual_adapter_like_capture() {
    let mut desk = Desk::fresh("");
    begin(&mut desk, "sim:?bridge=on&rpm=6", 50_000);
    let measured = |studio: &Studio| studio.signals().measurement().is_some_and(|own| own.analysis.is_ok());
    desk.until("it is measured", measured);
    let signals = &desk.studio.signals();
    let measurement = signals.measurement().unwrap();
    let name = "virtual adapter".to_owned();
    assert_eq!(measurement.origin, Origin::Adapter { name, is_virtual: true });
    let ellipse = measurement.analysis.as_ref().unwrap().ellipse;
    assert!((ellipse.amplitude_v - 0.5).abs() < 0.01, "{ellipse:?}");
    assert!(
        measurement.levels_v.is_none() && measurement.capture.wires.is_none(),
        "there are two signals, not four wires"
    );
    assert_eq!(desk.studio.recorder_for(Of::Tool(crate::tabs::SIGNALS)).unwrap().series().len(), 3);
    let streaming = signals.source().streaming_adapter().unwrap();
    assert_eq!((streaming.period_ns, streaming.full_scale_microvolt), (20_000, 1_250_000));
    assert_eq!((signals.source().lost_samples(), signals.source().kind()), (0, SourceKind::Adapter));
    desk.signals(Signals::Source(SourceAction::Stop));
    assert!(!desk.studio.signals().source().is_running());
    assert!(desk.studio.signals().measurement().is_some(), "what was measured last stays");
    assert!(desk.notice_ids(Severity::Warning).is_empty());
}

#[test]
fn network_adapter_streams_without_gaps() {
    let served = ServedDevice::new("rpm=60");
    let mut desk = Desk::fresh("");
    for round in 1..=3 {
        begin(&mut desk, &served.link(), 20_000);
        desk.until("a second of it is there", |studio| recorded(studio).0 > 20_000);
        assert_eq!((recorded(&desk.studio).1, desk.studio.signals().source().lost_samples()), (0, 0), "{round}");
        desk.signals(Signals::Source(SourceAction::Stop));
        // The next start waits until this source has released the connection.
    }
    desk.until("it was told to stop", |_| served.requested_frame(&Request::AnalogStream { on: false }) == 3);
    assert_eq!(served.requested_frame(&Request::AnalogStream { on: true }), 3);
    assert!(desk.notice_ids(Severity::Warning).is_empty(), "{:?}", desk.notice_ids(Severity::Warning));
}

#[test]
fn closing_window_stops_adapter_first() {
    let served = ServedDevice::new("rpm=60");
    let mut desk = Desk::fresh("");
    begin(&mut desk, &served.link(), 20_000);
    desk.until("samples come", |studio| recorded(studio).0 > 100);
    desk.act(Action::Close);
    desk.until("the window may close", Studio::can_close);
    assert_eq!(served.requested_frame(&Request::AnalogStream { on: false }), 1);
}

#[test]
fn can_restart_lost_connection() {
    let served = ServedDevice::new("rpm=60");
    let mut desk = Desk::fresh("");
    begin(&mut desk, &served.link(), 20_000);
    desk.until("samples come", |studio| recorded(studio).0 > 100);
    served.cut();
    desk.until("it is told", |studio| !studio.signals().source().is_running());
    assert_eq!(desk.notice_ids(Severity::Error), ["link.lost"]);
    assert_eq!(desk.studio.signals().source().adapter_problem().map(|text| text.id()), Some("link.lost"));
    desk.signals(Signals::Source(SourceAction::StartAdapter));
    assert!(desk.studio.signals().source().adapter_problem().is_none());
    desk.until("samples come again", |studio| recorded(studio).0 > 100);
}

#[test]
fn shows_link_errors_at_link_entry() {
    for (link, problem, asked) in [
        ("", "adapter.link", false),
        ("sim:?bridge=off", "adapter.link", false),
        ("sim:?rpm=fast", "adapter.link", false),
        ("serial:/dev/ttyUSB0", "adapter.link", false),
        ("bridge:", "adapter.link", false),
        ("bridge:/dev/ttyACM0?rpm=1", "adapter.link", false),
        ("bridge:/dev/there-is-none", "link.not_found", true),
        ("sim:?bridge=on&version=2", "adapter.version", true),
        ("sim:?bridge=on&fault=silent-after:0", "adapter.silent", true),
    ] {
        let mut desk = Desk::fresh("");
        begin(&mut desk, link, 10_000);
        desk.until("it is told", |studio| studio.signals().source().adapter_problem().is_some());
        let source = desk.studio.signals().source();
        assert_eq!(source.adapter_problem().map(|text| text.id()), Some(problem), "{link}");
        assert!(!source.is_running(), "{link}");
        assert_eq!(desk.notice_ids(Severity::Error), if asked { vec![problem] } else { vec![] }, "{link}");
        desk.signals(Signals::Source(SourceAction::SetLink("sim:".to_owned())));
        assert!(desk.studio.signals().source().adapter_problem().is_none(), "another link is another try");
    }
}

#[test]
fn remembers_only_valid_adapter_links() {
    let mut desk = Desk::fresh("");
    begin(&mut desk, "sim:?rpm=60", 10_000);
    begin(&mut desk, "serial:/dev/ttyUSB0", 10_000);
    desk.act(Action::Close);
    desk.until("the window may close", Studio::can_close);
    let desk = desk.crash();
    assert_eq!(desk.studio.signals().source().link(), "sim:?rpm=60");
    assert!(!desk.studio.signals().source().is_running());
}

/// The encoder supply is switched only as the user chooses. With `supply=switched`, the virtual adapter switches it on
/// only on command. 0.3 W at 8 V are 37 mA.
#[test]
fn switches_encoder_supply_only_on_request() {
    let mut desk = Desk::fresh("");
    let amplitude = |studio: &Studio| {
        let recorder = studio.recorder_for(Of::Tool(crate::tabs::SIGNALS)).unwrap();
        let vector = recorder.series().iter().find(|line| line.name.id() == "scope.vector").unwrap();
        let last = recorder.history(vector).unwrap().indices().end.checked_sub(1)?;
        Some(recorder.history(vector).unwrap().sample(vector.column(), last)?.value.to_f64())
    };
    for (supply, supplied, volts) in [(None, None, 0.0), (Some(Family::Hiperface), Some((8_000, 37)), 0.5)] {
        desk.signals(Signals::Source(SourceAction::SetSupply(supply)));
        begin(&mut desk, "sim:?supply=switched&rpm=6", 10_000);
        desk.until("samples come", |studio| recorded(studio).0 > 100);
        assert_eq!(desk.studio.signals().source().streaming_adapter().unwrap().supplied, supplied);
        assert!((amplitude(&desk.studio).unwrap() - volts).abs() < 0.01, "{supply:?}");
    }
    begin(&mut desk, "sim:?rpm=6", 10_000);
    desk.until("it is told", |studio| studio.signals().source().adapter_problem().is_some());
    assert_eq!(desk.studio.signals().source().adapter_problem().map(|text| text.id()), Some("adapter.no_supply"));
}

#[test]
fn invalid_link_does_not_stop_source() {
    let mut desk = Desk::fresh("");
    begin(&mut desk, "sim:?rpm=6", 10_000);
    desk.until("samples come", |studio| recorded(studio).0 > 100);
    begin(&mut desk, "tcp:host:1", 10_000);
    let source = desk.studio.signals().source();
    assert!(source.is_running() && source.adapter_problem().is_some());
    desk.signals(Signals::Source(SourceAction::Start));
    let source = desk.studio.signals().source();
    assert_eq!((source.is_running(), source.kind()), (true, SourceKind::Encoder));
    desk.until("it is measured", |studio| {
        studio.signals().measurement().is_some_and(|own| own.origin == Origin::Virtual)
    });
    assert_eq!(
        desk.studio.recorder_for(Of::Tool(crate::tabs::SIGNALS)).unwrap().series().len(),
        7,
        "the wires are back"
    );
}

#[test]
fn starts_holds_and_stops_adapter() {
    for size in [[1280.0, 800.0], [1024.0, 640.0], [960.0, 540.0]] {
        let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), size);
        screen.act(Action::ShowTab(crate::tabs::SIGNALS));
        screen.click("adapter.open");
        screen.check_signals_pages();
        screen.act(Action::tool(Signals::Source(SourceAction::SetLink("bridge:/dev/there-is-none".to_owned()))));
        screen.click("adapter.start");
        screen.until("it is told", |studio| studio.signals().source().adapter_problem().is_some());
        assert!(screen.shows("/dev/there-is-none does not exist."));
        screen.check_signals_pages();
        screen.click("adapter.close");
        assert!(!screen.has_button("adapter.start"), "what was wrong has been read");
        screen.click("adapter.open");
        screen.click("adapter.use_virtual");
        screen.click("adapter.start");
        let began = Instant::now();
        screen.until("it is measured", |studio| {
            assert!(began.elapsed() < LONG);
            studio.signals().measurement().is_some_and(|own| matches!(own.origin, Origin::Adapter { .. }))
        });
        assert!(!screen.has_button("adapter.start"), "the card is closed when the adapter runs");
        assert!(screen.shows(&screen.say("signals.virtual_adapter")) && screen.shows(&screen.say("shell.virtual")));
        assert!(screen.shows(&screen.say("virtual.running")));
        screen.check_signals_pages();
        screen.click("virtual.hold");
        assert!(screen.studio().signals().source().is_frozen());
        screen.click("shell.stop");
        assert!(screen.shows(&screen.say("virtual.stopped")));
        assert!(screen.has_button("virtual.again"));
        screen.act(Action::tool(Signals::Source(SourceAction::StartAdapter)));
        assert_eq!(screen.studio().signals().source().kind(), SourceKind::Adapter);
        assert!(screen.studio().signals().source().is_running());
    }
}
