//! Tests of charts: where cams are on, snap targets, and the results of drags.

mod session;

use super::{
    Chart, DragTarget, OutputState, PositionRange, SnapSettings, VisibleRange, apply_drag, cam_between, grid_ticks,
    labels, move_cam, next_grid_line, on_ranges, round_up_1_2_5, snap_distance,
};
use crate::app::Language;
use crate::devices::interbus::profile::{CamNames, Direction, Edge, Image, Parameters, Scale};
use crate::devices::interbus::protocol::{Cam, CamNumber, ProgramNumber, Value};
use crate::devices::interbus::state::staged::{Edit, StagedEdits};

fn edges(start: u32, stop: u32) -> Cam {
    Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() }
}

fn pair(cam: Cam) -> (u32, u32) {
    (cam.start.get(), cam.stop.get())
}

fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

fn program() -> ProgramNumber {
    ProgramNumber::new(1).unwrap()
}

/// Returns the edits of a profile with 1000 steps and the given cams in program 1.
fn staged(cams: &[(u8, u32, u32)]) -> StagedEdits {
    let parameters =
        Parameters { steps: 1000, revolutions: 1, direction: Direction::Clockwise, preset: 0, zero_shift: 0 };
    let mut staged = StagedEdits::for_profile(Image::from_parameters(parameters), CamNames::default());
    for (number, start, stop) in cams {
        let edit = Edit::Cam { program: program(), cam: cam(*number), start: *start, stop: *stop, on: true };
        staged.apply_edit(&edit).unwrap();
    }
    staged
}

fn chart(cams: &[(u8, u32, u32)]) -> Chart {
    Chart::from_edits(&staged(cams), program()).unwrap()
}

#[test]
fn wrapping_cam_has_two_segments() {
    let whole = |start, stop| on_ranges(edges(start, stop), 1000);
    assert_eq!(whole(15, 213), [PositionRange { first: 15, last: 213 }]);
    assert_eq!(whole(900, 20), [PositionRange { first: 0, last: 20 }, PositionRange { first: 900, last: 999 }]);
    assert_eq!(whole(7, 7), [PositionRange { first: 7, last: 7 }]);
    assert_eq!(whole(900, 1200), [PositionRange { first: 900, last: 999 }], "as far as the range goes");
    assert_eq!(whole(1100, 1200), []);
    assert_eq!(whole(1100, 20), [PositionRange { first: 0, last: 20 }]);
    assert_eq!(on_ranges(edges(0, 5), 0), []);
}

#[test]
fn compares_simulated_and_actual_outputs() {
    // Example of the manual and reference 7: the cam from 15 to 213 is on at 15 and 213 but not at 214. The cam from
    // 100 to 20 is on at 5 but not at 50.
    let chart = chart(&[(3, 15, 213), (5, 100, 20)]);
    for (position, outputs) in [(15, 0b10_1000), (213, 0b10_1000), (214, 0b10_0000), (5, 0b10_0000), (50, 0b00_1000)] {
        assert_eq!(chart.outputs(position), outputs, "{position}");
    }
    let lamps = chart.output_states(Some(50), Some(0b10_1000));
    assert_eq!(lamps[3], OutputState { simulated: Some(true), own: Some(true) });
    assert!(!lamps[3].is_mismatch() && lamps[5].is_mismatch() && lamps[5].effective_state() == Some(true));
    assert_eq!(chart.output_states(None, None)[0], OutputState { simulated: None, own: None });
    assert_eq!(chart.output_states(Some(1000), None)[0].simulated, None, "beyond the range nothing is known");
    let says = |lamp| labels::output_text(lamp).to_string_in(Language::English);
    assert_eq!(says(lamps[5]), "Encoder: on, simulation: off");
    assert_eq!(says(chart.output_states(None, None)[0]), "unknown");
}

#[test]
fn drags_edges_across_range_end() {
    for (cam, edge, by, expected) in [
        ((100, 199), Edge::Start, 10, (110, 199)),
        ((100, 199), Edge::Start, 150, (199, 199)),
        ((100, 199), Edge::Start, -150, (950, 199)),
        ((100, 199), Edge::Start, -5000, (200, 199)),
        ((100, 199), Edge::Stop, -500, (100, 100)),
        ((100, 199), Edge::Stop, 850, (100, 49)),
        ((100, 199), Edge::Stop, 5000, (100, 99)),
        ((950, 49), Edge::Stop, -60, (950, 989)),
        ((950, 49), Edge::Start, 60, (10, 49)),
        ((1200, 49), Edge::Start, -300, (900, 49)),
        ((1200, 49), Edge::Start, 5, (999, 49)),
        ((10, 1500), Edge::Stop, -1, (10, 999)),
    ] {
        assert_eq!(pair(apply_drag(edges(cam.0, cam.1), edge, by, 1000)), expected, "{cam:?} {edge:?} {by}");
    }
}

#[test]
fn moves_and_draws_cams() {
    for (cam, by, expected) in [
        ((100, 199), 50, (150, 249)),
        ((100, 199), -150, (950, 49)),
        ((950, 49), 2050, (0, 99)),
        ((1200, 49), 5, (1200, 49)),
    ] {
        assert_eq!(pair(move_cam(edges(cam.0, cam.1), by, 1000)), expected, "{cam:?} {by}");
    }
    for (from, to, expected) in
        [(100, 199, (100, 199)), (199, 100, (100, 199)), (990, 1010, (990, 10)), (-5, 5, (995, 5)), (0, 5000, (0, 999))]
    {
        assert_eq!(pair(cam_between(from, to, 1000)), expected, "{from} {to}");
    }
}

#[test]
fn keys_move_to_next_grid_line() {
    let steps = Scale::default();
    for (position, forward, expected) in [(100, true, 150), (101, true, 150), (100, false, 50), (101, false, 100)] {
        assert_eq!(next_grid_line(&steps, 40.0, position, forward), expected, "{position}");
    }
    assert_eq!(next_grid_line(&steps, 40.0, 0, false), -50, "over the end of the range");
    assert_eq!(next_grid_line(&steps, 0.01, 7, true), 8);
    // With 1000 steps per turn, the grid lines of 10° are at 27.8, 55.6 and 83.3.
    let degrees = Scale::in_degrees(1000.0, 0).unwrap();
    for (position, forward, expected) in [(28, true, 56), (56, true, 83), (83, false, 56), (0, false, -28)] {
        assert_eq!(next_grid_line(&degrees, 20.0, position, forward), expected, "{position}");
    }
}

#[test]
fn grid_lines_have_round_values() {
    for (at_least, expected) in [(0.3, 0.5), (1.0, 1.0), (1.1, 2.0), (2.0, 2.0), (3.0, 5.0), (5.5, 10.0), (73.0, 100.0)]
    {
        assert!((round_up_1_2_5(at_least) - expected).abs() < 1e-12, "{at_least}");
    }
    let seen = |scale: &Scale, view: &VisibleRange, apart| {
        grid_ticks(scale, view, 8192, apart)
            .iter()
            .map(|tick| (tick.position.round() as u32, tick.value))
            .collect::<Vec<_>>()
    };
    let whole = VisibleRange::full(8192);
    let expected = [(0, 0.0), (2000, 2000.0), (4000, 4000.0), (6000, 6000.0), (8000, 8000.0)];
    assert_eq!(seen(&Scale::default(), &whole, 1500.0), expected);
    let degrees = Scale::in_degrees(8192.0, 0).unwrap();
    assert_eq!(seen(&degrees, &whole, 1500.0), [(0, 0.0), (2048, 90.0), (4096, 180.0), (6144, 270.0), (8192, 0.0)]);
    // The zero of the machine is at 1024, so the range begins at 315°.
    let turned = Scale::in_degrees(8192.0, 1024).unwrap();
    assert_eq!(seen(&turned, &whole, 1500.0), [(1024, 0.0), (3072, 90.0), (5120, 180.0), (7168, 270.0)]);
    let near = whole.zoomed(8192.0 / 100.0, 0.0, 8192);
    assert_eq!(seen(&degrees, &near, 20.0), [(0, 0.0), (23, 1.0), (46, 2.0), (68, 3.0), (91, 4.0)]);
    let millimetres = Scale::in_millimetres(100.0, 4000).unwrap();
    assert_eq!(
        seen(&millimetres, &whole, 1500.0),
        [(0, -40.0), (2000, -20.0), (4000, 0.0), (6000, 20.0), (8000, 40.0)]
    );
}

#[test]
fn view_stays_in_range() {
    let whole = VisibleRange::full(1000);
    assert!(whole.is_whole(1000));
    let near = whole.zoomed(10.0, 900.0, 1000);
    assert_eq!((near.first(), near.length()), (810.0, 100.0));
    assert!((near.fraction_at(900.0) - 0.9).abs() < 1e-12 && near.position(0.5) == 860.0);
    assert_eq!(near.panned(500.0, 1000).first(), 900.0);
    assert_eq!(near.panned(-5000.0, 1000).first(), 0.0);
    assert_eq!(near.clamped_to(50), VisibleRange::full(50));
    assert_eq!(near.zoomed(1e9, 850.0, 1000).length(), 8.0);
    assert_eq!(near.zoomed(f64::NAN, 850.0, 1000), near);
    assert_eq!(near.zoomed(0.001, 850.0, 1000), whole);
}

#[test]
fn edges_snap_to_nearby_positions() {
    let chart = chart(&[(0, 100, 199), (1, 403, 555)]);
    let (first, steps) = (edges(100, 199), Scale::default());
    let pull =
        |edge, by, with: &SnapSettings| snap_distance(&chart, &steps, DragTarget::Edge(cam(0), edge), first, by, with);
    let on = SnapSettings { reach: 6.0, apart: None, edges: true };
    // The other cam spans 403 to 555. A stop snaps to the step before its start, or to its stop.
    assert_eq!(199 + pull(Edge::Stop, 200.3, &on), 402);
    assert_eq!(199 + pull(Edge::Stop, 351.0, &on), 555);
    assert_eq!(100 + pull(Edge::Start, 453.4, &on), 556);
    assert_eq!(100 + pull(Edge::Start, 299.0, &on), 403);
    assert_eq!(100 + pull(Edge::Start, 280.4, &on), 380);
    assert_eq!(pull(Edge::Stop, 200.3, &SnapSettings::DISABLED), 200);
    let grid = SnapSettings { reach: 6.0, apart: Some(50.0), edges: true };
    assert_eq!(100 + pull(Edge::Start, 353.0, &grid), 450);
    assert_eq!(100 + pull(Edge::Start, -104.0, &grid), 0);
    assert_eq!(100 + pull(Edge::Start, -204.0, &grid), -100, "over the end of the range");
    // If the cam is moved as a whole, either edge can snap: 199 + 203 = 402.
    assert_eq!(snap_distance(&chart, &steps, DragTarget::Whole(cam(0)), first, 199.0, &on), 203);
    // With 1000 steps per turn, 90° is at 250. The grid lines are 30° apart, which is 83.3 steps.
    let degrees = Scale::in_degrees(1000.0, 0).unwrap();
    let units = SnapSettings { reach: 6.0, apart: Some(80.0), edges: false };
    assert_eq!(100 + snap_distance(&chart, &degrees, DragTarget::Edge(cam(0), Edge::Start), first, 146.5, &units), 250);
}

#[test]
fn disabled_cam_counts_as_free() {
    let mut own = staged(&[(0, 1, 2), (1, 1, 2)]);
    assert_eq!(Chart::from_edits(&own, program()).unwrap().unused_cam(), Some(cam(2)));
    own.apply_edit(&Edit::Switch { program: program(), cam: cam(0), on: false }).unwrap();
    assert_eq!(Chart::from_edits(&own, program()).unwrap().unused_cam(), Some(cam(0)));
    let all: Vec<(u8, u32, u32)> = (0..8).map(|number| (number, 1, 2)).collect();
    assert_eq!(chart(&all).unused_cam(), None);
    assert_eq!(Chart::from_edits(&own, ProgramNumber::new(2).unwrap()), None);
}

#[test]
fn lane_describes_cam_and_problems() {
    let mut own = staged(&[(3, 900, 20), (4, 10, 30)]);
    for number in [3, 4] {
        own.apply_edit(&Edit::Name { program: program(), cam: cam(number), name: "glue".to_owned() }).unwrap();
    }
    let chart = Chart::from_edits(&own, program()).unwrap();
    let lane = chart.find_lane(cam(3)).unwrap();
    let degrees = Scale::in_degrees(1000.0, 0).unwrap();
    let says = |text: crate::app::Text| text.to_string_in(Language::English);
    assert_eq!(says(labels::cam(lane)), "Cam 3 · glue");
    assert_eq!(says(labels::edge_name(lane, Edge::Stop)), "Cam 3: stop");
    let expected = "On from 900 (324.0°) to 20 (7.2°) across the end of the range, 121 steps";
    assert_eq!(says(labels::lane_text(lane, &degrees, 1000)), expected);
    let troubles: Vec<String> = labels::lane_problems(&chart, lane).into_iter().map(says).collect();
    assert_eq!(troubles, ["This pulse overlaps another pulse on track glue."]);
    own.apply_edit(&Edit::Steps(850)).unwrap();
    let chart = Chart::from_edits(&own, program()).unwrap();
    let troubles: Vec<String> =
        labels::lane_problems(&chart, chart.find_lane(cam(3)).unwrap()).into_iter().map(says).collect();
    assert_eq!(troubles[0], "The position is outside the measuring range, which ends at 849.");
    assert!(chart.find_lane(cam(3)).unwrap().edited && !chart.find_lane(cam(5)).unwrap().edited);
}
