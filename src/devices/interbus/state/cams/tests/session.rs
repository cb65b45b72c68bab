//! Applies a long series of edits, after each of which chart and table must agree with an independent model. The model
//! stores a cam as its first position and its length, and undoes by keeping a list of all earlier states.

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

use crate::app::PendingEdits;
use crate::devices::interbus::profile::{CamNames, Direction, Edge, Image, ImportedProgram, Parameters};
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, Value};
use crate::devices::interbus::state::cams::{Chart, apply_drag};
use crate::devices::interbus::state::staged::{Edit, StagedEdits};

/// Number of edits in the test.
const STEPS: usize = 10_000;

/// First position and length of a cam, and whether it is active.
type Own = (u32, u32, bool);
/// Eight programs of eight cams each.
type Cams = [[Own; 8]; 8];

struct Model {
    range: u32,
    /// All states of the undo history. The current one is at index `at`.
    past: Vec<Cams>,
    at: usize,
}

#[derive(Clone, Debug)]
enum Step {
    /// Moves an edge of a cam: program, cam, whether the edge is the stop, and number of steps.
    Drag(usize, usize, bool, i64),
    /// Enters a new position for an edge: program, cam, whether the edge is the stop, and new position.
    Type(usize, usize, bool, u32),
    /// Draws a cam: program, cam, start and length.
    Draw(usize, usize, u32, u32),
    Switch(usize, usize, bool),
    Copy(usize, usize),
    Mirror(usize),
    Rotate(usize, i64),
    /// Imports a table with a single cam: program, cam, start and length.
    Table(usize, usize, u32, u32),
    Undo,
    Redo,
}

fn step() -> impl Strategy<Value = Step> {
    let (program, cam) = (0..8_usize, 0..8_usize);
    let place = 0..200_u32;
    prop_oneof![
        4 => (program.clone(), cam.clone(), any::<bool>(), -300..300_i64).prop_map(|(p, c, e, by)| Step::Drag(p, c, e, by)),
        4 => (program.clone(), cam.clone(), any::<bool>(), place.clone()).prop_map(|(p, c, e, to)| Step::Type(p, c, e, to)),
        2 => (program.clone(), cam.clone(), place.clone(), 1..200_u32).prop_map(|(p, c, at, len)| Step::Draw(p, c, at, len)),
        2 => (program.clone(), cam.clone(), any::<bool>()).prop_map(|(p, c, on)| Step::Switch(p, c, on)),
        1 => (program.clone(), program.clone()).prop_map(|(from, to)| Step::Copy(from, to)),
        1 => program.clone().prop_map(Step::Mirror),
        1 => (program.clone(), -500..500_i64).prop_map(|(p, by)| Step::Rotate(p, by)),
        1 => (program, cam, place, 1..200_u32).prop_map(|(p, c, at, len)| Step::Table(p, c, at, len)),
        4 => Just(Step::Undo),
        2 => Just(Step::Redo),
    ]
}

impl Model {
    fn now(&self) -> &Cams {
        &self.past[self.at]
    }

    /// Applies a step, unless it would be rejected or change nothing.
    fn play_event(&mut self, step: &Step) {
        let range = self.range;
        let wrap = |at: i64| at.rem_euclid(i64::from(range)) as u32;
        let mut next = *self.now();
        match *step {
            Step::Undo => {
                self.at = self.at.saturating_sub(1);
                return;
            }
            Step::Redo => {
                self.at = (self.at + 1).min(self.past.len() - 1);
                return;
            }
            Step::Drag(program, cam, is_stop, by) => {
                let (start, length, _) = &mut next[program][cam];
                if is_stop {
                    *length = (i64::from(*length) + by).clamp(1, i64::from(range)) as u32;
                } else {
                    let after = (i64::from(*length) - by).clamp(1, i64::from(range)) as u32;
                    *start = wrap(i64::from(*start) + i64::from(*length) - i64::from(after));
                    *length = after;
                }
            }
            Step::Type(_, _, _, to) if to >= range => return,
            Step::Type(program, cam, is_stop, to) => {
                let (start, length, _) = &mut next[program][cam];
                let end = *start + *length - 1;
                let (from, last) = if is_stop { (*start, to) } else { (to, end % range) };
                *start = from;
                *length = wrap(i64::from(last) - i64::from(from)) + 1;
            }
            Step::Draw(_, _, start, _) | Step::Table(_, _, start, _) if start >= range => return,
            Step::Draw(program, cam, start, length) => next[program][cam] = (start, length.min(range), true),
            Step::Switch(program, cam, on) => next[program][cam].2 = on,
            Step::Copy(from, to) => next[to] = next[from],
            Step::Mirror(program) => {
                for (start, length, _) in &mut next[program] {
                    *start = wrap(-i64::from(*start) - i64::from(*length));
                }
            }
            Step::Rotate(program, by) => {
                for (start, ..) in &mut next[program] {
                    *start = wrap(i64::from(*start) + by);
                }
            }
            Step::Table(program, cam, start, length) => {
                next[program].iter_mut().for_each(|own| own.2 = false);
                next[program][cam] = (start, length.min(range), true);
            }
        }
        if next != *self.now() {
            self.past.truncate(self.at + 1);
            self.past.push(next);
            self.at += 1;
            // At most two hundred steps can be undone.
            if self.past.len() > 201 {
                self.past.remove(0);
                self.at -= 1;
            }
        }
    }
}

fn number(program: usize) -> ProgramNumber {
    ProgramNumber::new(program as u8 + 1).unwrap()
}

fn cam(cam: usize) -> CamNumber {
    CamNumber::new(cam as u8).unwrap()
}

/// Returns the stop of a cam with the given start and length.
fn stop(start: u32, length: u32, range: u32) -> u32 {
    (start + length.min(range) - 1) % range
}

/// Applies the same step to the code under test.
fn play_event(staged: &mut StagedEdits, step: &Step, range: u32) {
    let edit = match *step {
        Step::Undo => {
            staged.undo();
            return;
        }
        Step::Redo => {
            staged.redo();
            return;
        }
        Step::Drag(program, own, is_stop, by) => {
            let chart = Chart::from_edits(staged, number(program)).unwrap();
            let edge = if is_stop { Edge::Stop } else { Edge::Start };
            let to = apply_drag(chart.lanes[own].edges.unwrap(), edge, by, range);
            let (start, stop) = (to.start.get(), to.stop.get());
            Edit::Cam { program: number(program), cam: cam(own), start, stop, on: false }
        }
        Step::Type(program, own, is_stop, to) => {
            let edge = if is_stop { Edge::Stop } else { Edge::Start };
            Edit::Edge { program: number(program), cam: cam(own), edge, to }
        }
        Step::Draw(program, own, start, length) => {
            let stop = stop(start, length, range);
            Edit::Cam { program: number(program), cam: cam(own), start, stop, on: true }
        }
        Step::Switch(program, own, on) => Edit::Switch { program: number(program), cam: cam(own), on },
        Step::Copy(from, to) => Edit::Copy { from: number(from), to: number(to) },
        Step::Mirror(program) => Edit::Mirror(number(program)),
        Step::Rotate(program, by) => Edit::Rotate { program: number(program), by },
        Step::Table(program, own, start, length) => {
            let mut cams = [None; 8];
            let value = |at| Value::new(at).unwrap();
            cams[own] = Some(Cam { start: value(start), stop: value(stop(start, length, range)) });
            Edit::Table(vec![ImportedProgram { program: number(program), cams, names: Default::default() }])
        }
    };
    let outside = match *step {
        Step::Type(_, _, _, to) => to >= range,
        Step::Draw(_, _, start, _) | Step::Table(_, _, start, _) => start >= range,
        _ => false,
    };
    assert_eq!(staged.apply_edit(&edit).is_err(), outside, "{step:?}");
}

/// Checks that the chart, the table and the model agree.
fn compare(staged: &StagedEdits, model: &Model, program: usize) {
    let range = model.range;
    let chart = Chart::from_edits(staged, number(program)).unwrap();
    let table = staged.program(number(program)).unwrap();
    for (own, (start, length, on)) in model.now()[program].iter().copied().enumerate() {
        let edges = table.cams[own].unwrap();
        assert_eq!((edges.start.get(), edges.stop.get()), (start, stop(start, length, range)));
        assert_eq!(table.mask >> own & 1 == 1, on);
        let lane = &chart.lanes[own];
        let mut shown = vec![false; range as usize];
        for stretch in lane.on_ranges(range) {
            shown[stretch.first as usize..=stretch.last as usize].iter_mut().for_each(|at| *at = true);
        }
        for at in 0..range {
            let within = (i64::from(at) - i64::from(start)).rem_euclid(i64::from(range)) < i64::from(length);
            assert_eq!(shown[at as usize], within, "cam {own} at {at}");
            assert_eq!(chart.outputs(at) >> own & 1 == 1, within && on);
        }
        assert_eq!((lane.on, lane.edges), (on, Some(edges)));
    }
}

#[test]
fn chart_and_table_stay_in_sync() {
    let mut runner = TestRunner::new(Config { cases: 2, ..Config::default() });
    let sessions = (2..180_u32, proptest::collection::vec(step(), STEPS));
    runner
        .run(&sessions, |(range, steps)| {
            let none = Cam { start: Value::default(), stop: Value::default() };
            let mut image = Image::from_parameters(Parameters {
                steps: range,
                revolutions: 1,
                direction: Direction::Clockwise,
                preset: 0,
                zero_shift: 0,
            });
            image.programs = [Some(Program { cams: [Some(none); 8], mask: 0 }); 8];
            let mut staged = StagedEdits::for_profile(image, CamNames::default());
            let mut model = Model { range, past: vec![[[(0, 1, false); 8]; 8]], at: 0 };
            for (count, step) in steps.iter().enumerate() {
                play_event(&mut staged, step, range);
                model.play_event(step);
                compare(&staged, &model, count % 8);
            }
            (0..8).for_each(|program| compare(&staged, &model, program));
            Ok(())
        })
        .unwrap();
}
