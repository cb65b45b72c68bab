//! Tests of the lanes and the ring with keys, pointer and screen reader.

use egui::accesskit::{Action, ActionData, ActionRequest};
use egui::{Event, Key, Modifiers, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::devices::interbus::profile::{CamNames, Direction, Image, Parameters, Scale};
use crate::devices::interbus::protocol::{Cam, CamNumber, ProgramNumber, Value};
use crate::devices::interbus::state::cams::{Chart, VisibleRange};
use crate::devices::interbus::state::staged::{Edit, StagedEdits};
use crate::devices::interbus::views::widgets::{CamChart, CamEvent, cam_lanes, cam_ring};
use crate::ui::widgets::tests::{NONE, SHIFT, focus, press, theme, window};

struct Page {
    staged: StagedEdits,
    scale: Scale,
    view: VisibleRange,
    selected: Option<CamNumber>,
    position: Option<u32>,
    own: Option<u8>,
    events: Vec<CamEvent>,
}

fn program() -> ProgramNumber {
    ProgramNumber::new(1).unwrap()
}

fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

fn edges(start: u32, stop: u32) -> Cam {
    Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() }
}

/// Returns a page with 1000 steps, on which cam 0 is on from 100 to 299 and cam 3 from 900 across the end to 49. Cam 4
/// is off.
fn page() -> Page {
    let parameters =
        Parameters { steps: 1000, revolutions: 1, direction: Direction::Clockwise, preset: 0, zero_shift: 0 };
    let mut staged = StagedEdits::for_profile(Image::from_parameters(parameters), CamNames::default());
    for (number, start, stop, on) in [(0, 100, 299, true), (3, 900, 49, true), (4, 600, 700, false)] {
        staged.apply_edit(&Edit::Cam { program: program(), cam: cam(number), start, stop, on }).unwrap();
    }
    let named = Edit::Name { program: program(), cam: cam(0), name: "feed".to_owned() };
    staged.apply_edit(&named).unwrap();
    let view = VisibleRange::full(1000);
    Page { staged, scale: Scale::default(), view, selected: None, position: None, own: None, events: Vec::new() }
}

fn draw(page: Page, ring: bool) -> Harness<'static, Page> {
    draw_with_options(page, ring, false)
}

fn draw_with_options(page: Page, ring: bool, snaps: bool) -> Harness<'static, Page> {
    window(page, move |ui, page: &mut Page| {
        let chart = Chart::from_edits(&page.staged, program()).unwrap();
        let model = CamChart {
            label: "Program 1",
            chart: &chart,
            compared: None,
            scale: &page.scale,
            position: page.position,
            own: page.own,
            selected: page.selected,
            movable: true,
            snaps,
        };
        let event =
            if ring { cam_ring(ui, &theme(), &model, 400.0) } else { cam_lanes(ui, &theme(), &model, page.view) };
        let edit = match event {
            Some(CamEvent::Moved { cam, to, drawn }) => {
                let (start, stop) = (to.start.get(), to.stop.get());
                Some(Edit::Cam { program: program(), cam, start, stop, on: drawn })
            }
            Some(CamEvent::Switched(cam, on)) => Some(Edit::Switch { program: program(), cam, on }),
            _ => None,
        };
        if let Some(edit) = edit {
            page.staged.apply_edit(&edit).unwrap();
        }
        match event {
            Some(CamEvent::Selected(cam)) => page.selected = Some(cam),
            Some(CamEvent::Viewed(view)) => page.view = view,
            _ => {}
        }
        page.events.extend(event);
    })
}

fn lanes() -> Harness<'static, Page> {
    draw(page(), false)
}

/// Returns all changes to cams in order.
fn changes(harness: &Harness<'_, Page>) -> Vec<CamEvent> {
    let events = harness.state().events.iter().copied();
    events.filter(|event| matches!(event, CamEvent::Moved { .. } | CamEvent::Switched(..))).collect()
}

fn moved(number: u8, start: u32, stop: u32) -> CamEvent {
    CamEvent::Moved { cam: cam(number), to: edges(start, stop), drawn: false }
}

fn value(harness: &Harness<'_, Page>, label: &str) -> String {
    harness.get_by_label(label).value().unwrap()
}

/// Returns the distance on the screen for a number of steps, measured from the edges of a cam of 200 steps.
fn steps(harness: &Harness<'_, Page>, count: f32) -> Vec2 {
    let x = |label| harness.get_by_label(label).rect().center().x;
    // The two handles are inside their cam, four and a half points from the middle of their grab areas.
    let width = x("Cam 0: stop") - x("Cam 0: start") + 2.0 * 2.5;
    Vec2::new(width / 200.0 * count, 0.0)
}

fn drag(harness: &mut Harness<'_, Page>, from: egui::Pos2, by: Vec2) {
    harness.drag_at(from);
    harness.step();
    for part in [0.5, 1.0] {
        harness.hover_at(from + by * part);
        harness.step();
    }
    harness.drop_at(from + by);
    harness.run();
}

#[test]
fn keys_move_edges() {
    let mut harness = lanes();
    assert_eq!(value(&harness, "Cam 0: start"), "100");
    focus(&mut harness, "Cam 0: start");
    press(&mut harness, &[(NONE, Key::ArrowRight), (NONE, Key::ArrowLeft), (NONE, Key::ArrowLeft)]);
    assert_eq!(changes(&harness), [moved(0, 101, 299), moved(0, 100, 299), moved(0, 99, 299)]);
    assert_eq!(harness.state().selected, Some(cam(0)));
    // The grid lines are 20 steps apart here, because ten points are between fourteen and twenty steps.
    press(&mut harness, &[(SHIFT, Key::ArrowRight), (SHIFT, Key::ArrowRight), (SHIFT, Key::ArrowLeft)]);
    assert_eq!(changes(&harness)[3..], [moved(0, 100, 299), moved(0, 120, 299), moved(0, 100, 299)]);
    press(&mut harness, &[(NONE, Key::Tab)]);
    assert!(harness.get_by_label("Cam 0: stop").is_focused());
    press(&mut harness, &[(NONE, Key::Delete), (NONE, Key::Delete), (NONE, Key::Space)]);
    assert_eq!(changes(&harness)[6..], [CamEvent::Switched(cam(0), false), CamEvent::Switched(cam(0), true)]);
    focus(&mut harness, "Cam 3: stop");
    press(&mut harness, &[(NONE, Key::ArrowLeft)]);
    assert_eq!(changes(&harness)[8..], [moved(3, 900, 48)]);
    focus(&mut harness, "Cam 3");
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    assert_eq!(changes(&harness)[9..], [moved(3, 901, 49)]);
}

#[test]
fn drags_edges_and_cams() {
    let mut harness = lanes();
    let by = steps(&harness, 100.0);
    let from = harness.get_by_label("Cam 0: stop").rect().center();
    drag(&mut harness, from, by);
    let previews = harness.state().events.iter().filter(|event| matches!(event, CamEvent::Preview(..))).count();
    assert!(previews >= 2);
    let now = harness.state().staged.edited_values().unwrap().cam(program(), cam(0)).unwrap();
    assert_eq!(now.start.get(), 100);
    assert!(now.stop.get().abs_diff(399) <= 2, "{now:?}");
    assert_eq!(changes(&harness).len(), 1, "a drag is one step");
    let middle = harness.get_by_label("Cam 0 · feed").rect().center();
    drag(&mut harness, middle, by * 7.5);
    let now = harness.state().staged.edited_values().unwrap().cam(program(), cam(0)).unwrap();
    assert!(now.wraps_around() && now.start.get().abs_diff(850) <= 4, "over the end: {now:?}");
}

#[test]
fn escape_cancels_drag() {
    let mut harness = lanes();
    let from = harness.get_by_label("Cam 0: stop").rect().center();
    harness.drag_at(from);
    harness.step();
    harness.hover_at(from + steps(&harness, 100.0));
    harness.run_steps(3);
    assert!(matches!(harness.state().events.last(), Some(CamEvent::Preview(..))));
    press(&mut harness, &[(NONE, Key::Escape)]);
    harness.hover_at(from + steps(&harness, 120.0));
    harness.run_steps(3);
    harness.drop_at(from + steps(&harness, 120.0));
    harness.run();
    assert!(changes(&harness).is_empty());
}

#[test]
fn draws_cam_in_disabled_lane() {
    let mut harness = lanes();
    let lane = harness.get_by_label("Cam 4").rect();
    let first = harness.get_by_label("Cam 0: start").rect().center().x;
    let from = egui::pos2(first, lane.center().y);
    let by = steps(&harness, 200.0);
    drag(&mut harness, from, by);
    let CamEvent::Moved { cam: own, to, drawn: true } = changes(&harness)[0] else { panic!("{:?}", changes(&harness)) };
    assert_eq!(own, cam(4));
    assert!(to.start.get().abs_diff(100) <= 8 && to.stop.get().abs_diff(300) <= 8, "{to:?}");
    assert!(harness.state().staged.edited_values().unwrap().is_on(program(), cam(4)));
    // In the lane of an active cam, no new cam can be drawn.
    let lane = harness.get_by_label("Cam 0 · feed").rect();
    drag(&mut harness, egui::pos2(lane.right() + 100.0, lane.center().y), by);
    assert_eq!(changes(&harness).len(), 1);
}

fn ask(harness: &mut Harness<'_, Page>, label: &str, action: Action, data: Option<ActionData>) {
    let (target_node, target_tree) = harness.get_by_label(label).accesskit_node().locate();
    let request = ActionRequest { action, target_tree, target_node, data };
    harness.event(Event::AccessKitActionRequest(request));
    harness.run();
}

#[test]
fn screen_reader_sets_edges() {
    for ring in [false, true] {
        let mut harness = draw(page(), ring);
        let label = if ring { "Cam 0: start, on the ring" } else { "Cam 0: start" };
        ask(&mut harness, label, Action::SetValue, Some(ActionData::NumericValue(250.0)));
        ask(&mut harness, label, Action::Increment, None);
        ask(&mut harness, label, Action::Decrement, None);
        ask(&mut harness, label, Action::SetValue, Some(ActionData::NumericValue(5000.0)));
        let expected = [moved(0, 250, 299), moved(0, 251, 299), moved(0, 250, 299), moved(0, 999, 299)];
        assert_eq!(changes(&harness), expected);
        assert_eq!(value(&harness, label), "999");
    }
}

#[test]
fn lanes_describe_cams_and_outputs() {
    let mut own = page();
    own.scale = Scale::in_degrees(1000.0, 0).unwrap();
    (own.position, own.own) = (Some(150), Some(0b1000));
    let mut harness = draw(own, false);
    assert_eq!(value(&harness, "Cam 0 · feed"), "On from 100 (36.0°) to 299 (107.6°), 200 steps");
    assert_eq!(value(&harness, "Cam 4"), "Switched off: 600 (216.0°) to 700 (252.0°), 101 steps");
    assert_eq!(value(&harness, "Output 0"), "Encoder: off, simulation: on");
    assert_eq!(value(&harness, "Output 1"), "Encoder: off");
    let is_on = |harness: &Harness<'_, Page>, label| {
        harness.get_by_label(label).accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    assert!(is_on(&harness, "Cam 0 active") && !is_on(&harness, "Cam 4 active"));
    harness.get_by_label("Cam 4 active").click();
    harness.run();
    assert_eq!(changes(&harness), [CamEvent::Switched(cam(4), true)]);
    harness.get_by_label("Cam 1 active").click();
    harness.run();
    assert_eq!(changes(&harness).len(), 1, "the profile does not say where it is");
}

#[test]
fn wheel_zooms_and_keys_scroll() {
    let mut harness = lanes();
    let lane = harness.get_by_label("Cam 0 · feed").rect();
    harness.hover_at(lane.center());
    harness.step();
    for _ in 0..4 {
        harness.event(Event::Zoom(2.0));
        harness.run();
    }
    let view = harness.state().view;
    assert!(view.length() < 80.0 && view.first() > 150.0 && view.first() < 250.0, "{view:?}");
    focus(&mut harness, "Cam 3: start");
    harness.run();
    let view = harness.state().view;
    assert!(view.first() <= 900.0 && 900.0 <= view.first() + view.length(), "{view:?}");
}

/// Cam 4 is drawn from a few steps next to the start of cam 0 (100) to a few next to its stop (299).
#[test]
fn drawn_cam_snaps_both_edges() {
    let mut harness = draw_with_options(page(), false, true);
    let lane = harness.get_by_label("Output 7").rect();
    let start = harness.get_by_label("Cam 0: start").rect().center();
    let from = egui::pos2(start.x + steps(&harness, 3.0).x, lane.center().y);
    let by = steps(&harness, 191.0);
    drag(&mut harness, from, by);
    let drawn = changes(&harness);
    let Some(CamEvent::Moved { to, drawn: true, .. }) = drawn.last() else { panic!("{drawn:?}") };
    assert_eq!((to.start.get(), to.stop.get()), (100, 299));
}

#[test]
fn chart_stays_within_width() {
    for width in [420.0, 600.0, 860.0] {
        let harness = window(page(), move |ui, page: &mut Page| {
            ui.set_max_width(width);
            let chart = Chart::from_edits(&page.staged, program()).unwrap();
            let model = CamChart {
                label: "Program 1",
                chart: &chart,
                compared: None,
                scale: &page.scale,
                position: None,
                own: None,
                selected: None,
                movable: true,
                snaps: true,
            };
            cam_lanes(ui, &theme(), &model, page.view);
        });
        let left = harness.get_by_label("before").rect().left();
        for label in ["Cam 0 · feed", "Cam 0: stop", "Cam 3: start", "Cam 3: stop", "Output 7", "Cam 7 active"] {
            let rect = harness.get_by_label(label).rect();
            assert!(rect.left() >= left - 1.0 && rect.right() <= left + width, "{label} at {width}: {rect}");
        }
    }
}

#[test]
fn keys_and_pointer_turn_ring() {
    let mut harness = draw(page(), true);
    focus(&mut harness, "Cam 3: stop, on the ring");
    press(&mut harness, &[(NONE, Key::ArrowRight), (Modifiers::NONE, Key::Delete)]);
    assert_eq!(changes(&harness), [moved(3, 900, 50), CamEvent::Switched(cam(3), false)]);
    // From a tenth to a quarter of the turn, which is at three o'clock.
    let ring = harness.get_by_label("Program 1").rect();
    let from = harness.get_by_label("Cam 0: start, on the ring").rect().center();
    let radius = from.distance(ring.center());
    let to = ring.center() + Vec2::new(radius, 0.0);
    drag(&mut harness, from, to - from);
    assert_eq!(changes(&harness)[2..], [moved(0, 250, 299)]);
    // Cam 4 is moved as a whole, from position 650 at half past seven to 1000 at the top.
    let lane = |part: f32, radius: f32| {
        let angle = part * std::f32::consts::TAU;
        ring.center() + Vec2::new(angle.sin(), -angle.cos()) * radius
    };
    let circle = harness.get_by_label("Cam 4: start, on the ring").rect().center().distance(ring.center());
    let (from, middle, to) = (lane(0.65, circle), lane(0.85, circle), lane(0.0, circle));
    harness.drag_at(from);
    harness.step();
    for at in [middle, to] {
        harness.hover_at(at);
        harness.step();
    }
    harness.drop_at(to);
    harness.run();
    let now = harness.state().staged.edited_values().unwrap().cam(program(), cam(4)).unwrap();
    assert!(now.start.get().abs_diff(950) <= 1 && now.stop.get().abs_diff(50) <= 1, "{now:?}");
}
