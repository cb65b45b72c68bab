//! Tests of a guided procedure with its buttons and accessible values.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use super::{theme, window};
use crate::ui::widgets::{Gauge, StepRow, StepState, Steps, StepsEvent, steps};

#[derive(Default)]
struct Run {
    speed: Option<f64>,
    refused: Option<&'static str>,
    events: Vec<StepsEvent>,
}

fn step(title: &str, state: StepState, note: &str) -> StepRow {
    StepRow { title: title.to_owned(), state, word: format!("{state:?}"), note: note.to_owned(), ..StepRow::default() }
}

fn procedure(run: Run) -> Harness<'static, Run> {
    window(run, |ui, run: &mut Run| {
        let speed = Gauge {
            name: "Speed".to_owned(),
            value: run.speed,
            shown: run.speed.map_or("–".to_owned(), |speed| format!("{speed} rpm")),
            allowed: 498.0..=502.0,
            best: None,
            limits: "498…502 rpm".to_owned(),
            scale: 450.0..=550.0,
        };
        let turn = StepRow { gauges: vec![speed], ..step("Turn", StepState::Waiting, "Run the motor at 500 rpm.") };
        let list = [step("Ask", StepState::Done, "Another drive"), turn, step("Check", StepState::ToCome, "")];
        let start = Some(("Start", run.refused.map_or(Ok(()), Err)));
        let model = Steps { steps: &list, start, skip: Some("Leave out") };
        run.events.extend(steps(ui, &theme(), &model));
    })
}

#[test]
fn reports_button_presses() {
    let mut harness = procedure(Run { speed: Some(500.5), ..Run::default() });
    for (label, event) in [("Start", StepsEvent::Start), ("Leave out", StepsEvent::Skip)] {
        harness.get_by_label(label).click();
        harness.run();
        assert_eq!(harness.state_mut().events.pop(), Some(event));
    }
    let speed = harness.get_by_role(egui::accesskit::Role::Meter);
    assert_eq!(speed.accesskit_node().label().as_deref(), Some("Speed"));
    assert_eq!(speed.value().as_deref(), Some("500.5 rpm (498…502 rpm)"));
    for words in ["Ask: Done", "Turn: Waiting", "Check: ToCome", "Run the motor at 500 rpm."] {
        harness.get_by_label(words);
    }
}

#[test]
fn blocked_start_shows_reason() {
    let refused = Some("It turns too slowly.");
    for speed in [None, Some(480.0), Some(f64::NAN), Some(f64::INFINITY), Some(-1e300)] {
        let mut harness = procedure(Run { speed, refused, ..Run::default() });
        assert!(harness.get_by_label("Start").accesskit_node().is_disabled());
        harness.get_by_label("Start").click();
        harness.run();
        assert!(harness.state().events.is_empty());
        harness.get_by_label("It turns too slowly.");
    }
}

#[test]
fn gauge_limits_are_inclusive() {
    let gauge = |value| Gauge {
        name: String::new(),
        value,
        shown: String::new(),
        allowed: 25.0..=40.0,
        best: Some(30.0..=35.0),
        limits: String::new(),
        scale: 0.0..=60.0,
    };
    for (value, fits) in
        [(Some(25.0), true), (Some(40.0), true), (Some(40.1), false), (Some(f64::NAN), false), (None, false)]
    {
        assert_eq!(gauge(value).is_in_range(), fits, "{value:?}");
    }
    let best = [25.0, 30.0, 35.0, 36.0].map(|value| gauge(Some(value)).is_in_best_range());
    assert_eq!(best, [false, true, true, false]);
}
