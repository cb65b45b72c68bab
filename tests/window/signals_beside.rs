//! Tests of a capture with a reference encoder and an absolute position: DNL, INL and the offset, as numbers and in
//! charts.

use crate::tabs::Tabs as _;
use std::fmt::Write as _;

use encoder_studio::analysis::revolution::RevolutionError;
use encoder_studio::app::Action;
use encoder_studio::signals::state::{Column, SignalsAction as Signals, SourceAction};
use encoder_studio::sim::sine_cosine::Quantity;

use crate::screen::Screen;
use crate::support::{Desk, HANGING_LINK, Outside};

/// Returns a capture as text. It covers 1.25 revolutions of 64 periods each, with an eccentricity of 0.01°, an offset
/// of 1 % and an absolute position that leads by 3 steps.
fn table() -> String {
    let mut text = "time,sin,cos,angle,absolute\n".to_owned();
    let tau = std::f64::consts::TAU;
    for at in 0..4_000 {
        let turn = 1.25 * f64::from(at) / 4_000.0;
        let periods = 64.0 * (turn + 0.01 / 360.0 * (tau * turn).sin());
        let (sine, cosine) = (tau * periods).sin_cos();
        let (sine, cosine) = (0.5 * sine + 0.005, 0.5 * cosine);
        let (time, angle) = (1e-5 * f64::from(at), (360.0 * turn) % 360.0);
        writeln!(text, "{time},{sine},{cosine},{angle},{}", (32.0 * periods + 3.0).floor()).unwrap();
    }
    text
}

#[test]
fn reference_and_periods_yield_dnl_and_inl() {
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("reference.csv");
    std::fs::write(&path, table()).unwrap();
    desk.signals(Signals::SetPeriods(100));
    desk.act(Action::Open(path));
    desk.wait_for_measurement();
    let told = |desk: &Desk| desk.studio.signals().measurement().unwrap().nonlinearities.clone();
    assert!(matches!(told(&desk), Some(Err(RevolutionError::Periods { given: 100, .. }))));
    desk.signals(Signals::SetPeriods(64));
    desk.until("it is told", |studio| {
        let told = studio.signals().measurement().and_then(|own| own.nonlinearities.as_ref());
        told.is_some_and(|told| told.as_ref().is_ok_and(|told| (told.raw.integral_deg - 0.01).abs() < 1e-4))
    });
    desk.signals(Signals::SetColumn(Column::ReferenceAngle, None));
    desk.wait_for_measurement();
    assert_eq!(told(&desk), None);
    desk.signals(Signals::SetColumn(Column::Absolute, Some(4)));
    desk.wait_for_measurement();
    assert_eq!(desk.studio.signals().problem().unwrap().id(), "signal.not_whole");
}

#[test]
fn virtual_encoder_has_reference() {
    let mut desk = Desk::fresh("");
    // 0.2 s at 600 rpm are two revolutions.
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Periods, 64.0)));
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Speed, 600.0)));
    desk.signals(Signals::Source(SourceAction::Set(Quantity::Eccentricity, 72.0)));
    desk.signals(Signals::Source(SourceAction::Start));
    desk.until("INL is told", |studio| {
        let told = studio.signals().measurement().and_then(|own| own.nonlinearities.as_ref());
        // 72 seconds of arc are 0.02°.
        told.is_some_and(|told| told.as_ref().is_ok_and(|told| (told.corrected.integral_deg - 0.02).abs() < 1e-3))
    });
}

#[test]
fn shows_positions_and_adopts_offset() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), [1280.0, 1400.0]);
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    let path = screen.outside.path("reference.csv");
    std::fs::write(&path, table()).unwrap();
    screen.act(Action::tool(Signals::SetPeriods(64)));
    screen.act(Action::Open(path));
    screen.until("it is read", |studio| studio.signals().measurement().is_some());
    screen.check_signals_pages();
    screen.click("page.error");
    // An offset of 1 % is an error of ±0.573° / 64 = 0.00895°, and an eccentricity of 0.01° is one of 36″. The sampling
    // at 50 samples per period changes both slightly.
    assert!(screen.shows(&screen.say("nonlinearity.inl_raw")));
    assert!(screen.shows("0.00896°") && screen.shows("32.24″") && screen.shows("35.99″"));
    screen.click("page.synchronise");
    assert!(screen.shows("All samples from reference.csv"));
    screen.click("synchronise.use_captured");
    assert_eq!(screen.studio().signals().synchronise().form.offset, "2.50");
    screen.act(Action::tool(Signals::Example(encoder_studio::signals::state::ExampleCapture::Healthy)));
    screen.until("it is read", |studio| studio.signals().measurement().is_some_and(|own| own.nonlinearities.is_none()));
    assert!(screen.shows(&screen.say("synchronise.not_captured")));
    screen.click("page.error");
    assert!(screen.shows(&screen.say("nonlinearity.no_reference")));
}
