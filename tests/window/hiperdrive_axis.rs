//! The set-up of an axis as one run, by actions against a virtual drive: from a drive that nobody has asked for to limits in
//! millimetres that have survived the supply; what is locked on the way; what is left when it is cancelled.

use encoder_studio::app::hiperdrive::axis::{Action as Run, Axis, Button, End, Entries, Place, Reached, Step};
use encoder_studio::app::hiperdrive::{Action as Hiperdrive, Motor, Unit};
use encoder_studio::app::review::Stage;
use encoder_studio::app::{Action, ReviewAction, Tab};
use encoder_studio::protocol::hiperdrive::{Direction, DriveNumber, ParameterNumber, Value};
use encoder_studio::units::Moment;

use crate::support::Desk;

/// An adapter whose drive nobody has asked for.
const FRESH: &str = "sim:?requested=0";

fn unit(desk: &Desk) -> &Unit {
    desk.studio.hiperdrive().unwrap()
}

fn axis(desk: &Desk) -> &Axis {
    unit(desk).axis().unwrap()
}

fn act(desk: &mut Desk, action: Hiperdrive) {
    let id = unit(desk).session.id;
    desk.act(Action::Hiperdrive(id, action));
}

fn run(desk: &mut Desk, action: Run) {
    act(desk, Hiperdrive::Axis(action));
}

#[track_caller]
fn until_ready(desk: &mut Desk) {
    desk.until("it is ready", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready())
    });
}

fn begun(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(Tab::Hiperdrive));
    desk.open(link);
    until_ready(&mut desk);
    desk.settle();
    run(&mut desk, Run::Begin);
    assert_eq!(axis(&desk).step(), Step::Request);
    desk
}

/// Consents to the plan that the step has made, and closes its review.
#[track_caller]
fn write(desk: &mut Desk) {
    desk.until("the plan is there", |studio| {
        studio.shown().unwrap().sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    until_ready(desk);
    let Stage::Ready(plan) = desk.studio.shown().unwrap().sheet().unwrap().stage else { panic!("no plan") };
    let id = unit(desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Write(plan)));
    desk.until("it is written", |studio| {
        studio.shown().unwrap().sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Done { .. }))
    });
    desk.act(Action::Review(id, ReviewAction::Close));
    desk.settle();
    until_ready(desk);
}

#[track_caller]
fn step_with_write(desk: &mut Desk) {
    run(desk, Run::Press(Button::Do));
    write(desk);
}

/// The step is done, and the next one comes.
#[track_caller]
fn next(desk: &mut Desk, step: Step) {
    let (axis, seen) = (axis(desk), unit(desk).seen(DriveNumber::FIRST));
    assert_eq!(axis.may_go_on(&seen), Ok(()), "{:?}", axis.step());
    run(desk, Run::Next);
    assert_eq!(self::axis(desk).step(), step);
}

fn edit(desk: &mut Desk, change: impl FnOnce(&mut Entries)) {
    let mut entries = axis(desk).entries().clone();
    change(&mut entries);
    run(desk, Run::Edit(Box::new(entries)));
}

fn position(desk: &Desk) -> i32 {
    unit(desk).actual(DriveNumber::FIRST).unwrap().position
}

fn number(desk: &Desk, number: u16) -> i64 {
    unit(desk).number(DriveNumber::FIRST, number).unwrap()
}

/// Held until it has gone so far, then let go.
#[track_caller]
fn jog(desk: &mut Desk, direction: Direction, steps: i32) {
    let from = position(desk);
    act(desk, Hiperdrive::Drive(Motor::JogPress { direction, repeated: false }));
    let began = std::time::Instant::now();
    while (position(desk) - from).abs() < steps {
        act(desk, Hiperdrive::Drive(Motor::JogHold));
        desk.studio.poll();
        assert!(began.elapsed() < crate::support::LONG, "it does not move: {:?}", unit(desk).said(DriveNumber::FIRST));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    act(desk, Hiperdrive::Drive(Motor::JogRelease));
    stands(desk);
}

#[track_caller]
fn stands(desk: &mut Desk) {
    desk.until("it stands", |studio| {
        studio.hiperdrive().is_some_and(|own| !own.is_moving() && !own.seen(own.drive()).moves)
    });
}

/// A drive with 400 steps a turn of 4 mm, with control, in the step with the slow jog.
fn until_jog() -> Desk {
    let mut desk = begun(FRESH);
    step_with_write(&mut desk);
    desk.until("the drive is there", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.axis().unwrap().may_go_on(&own.seen(DriveNumber::FIRST)).is_ok()
    });
    next(&mut desk, Step::Scale);
    edit(&mut desk, |own| (own.pitch, own.resolution) = ("4".to_owned(), "0,01".to_owned()));
    step_with_write(&mut desk);
    // Reference 5: 400/256; 511 turns of 400 steps.
    assert_eq!([154, 156, 158, 160].map(|own| number(&desk, own)), [400, 256, -204_400, 204_400]);
    next(&mut desk, Step::Confirm);
    desk
}

fn confirmed() -> Desk {
    let mut desk = until_jog();
    run(&mut desk, Run::Press(Button::Confirm));
    next(&mut desk, Step::Jog);
    run(&mut desk, Run::Press(Button::Take));
    desk.until("control", |studio| {
        studio.hiperdrive().is_some_and(|own| own.moves.is_open() && own.session.is_ready())
    });
    desk
}

#[test]
fn a_new_drive_becomes_an_axis_in_millimetres_that_survives_the_supply() {
    let mut desk = confirmed();
    jog(&mut desk, Direction::Clockwise, 20);
    jog(&mut desk, Direction::Counterclockwise, 10);
    next(&mut desk, Step::Reference);
    edit(&mut desk, |own| own.reference = "1".to_owned());
    step_with_write(&mut desk);
    // 100 steps are rounded to 128: the nearest multiple of 64.
    desk.until("the position is set", |studio| {
        studio.hiperdrive().unwrap().actual(DriveNumber::FIRST).is_some_and(|own| (own.position - 128).abs() <= 1)
    });
    next(&mut desk, Step::Lower);
    jog(&mut desk, Direction::Counterclockwise, 10);
    run(&mut desk, Run::TakePlace);
    let lower = position(&desk);
    next(&mut desk, Step::Upper);
    jog(&mut desk, Direction::Clockwise, 40);
    run(&mut desk, Run::TakePlace);
    let upper = position(&desk);
    step_with_write(&mut desk);
    assert_eq!([158, 160].map(|own| number(&desk, own)), [i64::from(lower), i64::from(upper)]);
    next(&mut desk, Step::Test);
    for place in Place::ALL {
        run(&mut desk, Run::Press(Button::Go(place)));
        desk.until("it has gone there", |studio| studio.hiperdrive().unwrap().axis().unwrap().outcome(place).is_some());
        let outcome = axis(&desk).outcome(place).unwrap();
        assert!(outcome.is_good(), "{place:?}: {outcome:?}");
        stands(&mut desk);
    }
    next(&mut desk, Step::Save);
    assert_eq!(unit(&desk).session.cycles, Some(0), "nothing was saved on the way");
    step_with_write(&mut desk);
    assert_eq!(unit(&desk).session.cycles, Some(1));
    next(&mut desk, Step::PowerCycle);
    run(&mut desk, Run::Press(Button::Give));
    desk.until("without control", |studio| {
        studio.hiperdrive().is_some_and(|own| !own.moves.is_open() && own.session.is_ready())
    });
    run(&mut desk, Run::Press(Button::PowerCycle));
    desk.until("it is back", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.axis().unwrap().survived() && own.session.is_ready()
    });
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).end(), Some(End::Done));
    assert!(Step::ALL.into_iter().all(|step| axis(&desk).reached(step) == Reached::Done));
    assert_eq!([152, 154, 156, 158, 160].map(|own| number(&desk, own)), [1, 400, 256, lower.into(), upper.into()]);
}

#[test]
fn nothing_moves_before_the_limits_are_confirmed() {
    let mut desk = until_jog();
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).step(), Step::Confirm);
    act(&mut desk, Hiperdrive::Take);
    desk.until("control", |studio| {
        studio.hiperdrive().is_some_and(|own| own.moves.is_open() && own.session.is_ready())
    });
    assert!(axis(&desk).may_move(&unit(&desk).seen(DriveNumber::FIRST)).is_err());
    let before = position(&desk);
    act(&mut desk, Hiperdrive::Drive(Motor::JogPress { direction: Direction::Clockwise, repeated: false }));
    for _ in 0..50 {
        act(&mut desk, Hiperdrive::Drive(Motor::JogHold));
        desk.settle();
    }
    assert_eq!(position(&desk), before);
}

/// What a person saw when they pressed is what counts, also where the window learns with the press that it is old.
#[test]
fn limits_that_are_no_longer_those_that_are_shown_are_not_confirmed() {
    let mut desk = until_jog();
    run(&mut desk, Run::Press(Button::Confirm));
    // Once more from the beginning, so that no lock says it.
    run(&mut desk, Run::Begin);
    next(&mut desk, Step::Scale);
    edit(&mut desk, |own| (own.pitch, own.resolution) = ("4".to_owned(), "0,01".to_owned()));
    next(&mut desk, Step::Confirm);
    run(&mut desk, Run::Press(Button::Take));
    desk.until("control", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open() && own.session.is_ready() && own.may_move(DriveNumber::FIRST).is_ok()
    });
    // Another master, while the window stands still.
    let upper = ParameterNumber::of_drive(160, DriveNumber::FIRST).unwrap();
    let target = unit(&desk).target.clone().unwrap();
    target.with(|station| station.write(Moment::default(), upper, &Value::Number(1000)).unwrap());
    let motion = unit(&desk).moves.motion().unwrap().clone();
    let began = std::time::Instant::now();
    while motion.permitted(DriveNumber::FIRST).limits != Some((-204_400, 1000)) {
        assert!(began.elapsed() < crate::support::LONG, "nobody looks at the limits");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    run(&mut desk, Run::Press(Button::Confirm));
    desk.until("they are read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.limits(DriveNumber::FIRST) == Some((-204_400, 1000))
    });
    let axis = axis(&desk);
    assert_eq!(axis.may_go_on(&unit(&desk).seen(DriveNumber::FIRST)).unwrap_err().id(), "hd_axis.needs_confirm");
    run(&mut desk, Run::Press(Button::Confirm));
    next(&mut desk, Step::Jog);
}

#[test]
fn who_cancels_has_a_drive_that_stands_and_nothing_that_lasts() {
    let mut desk = confirmed();
    act(&mut desk, Hiperdrive::Drive(Motor::JogPress { direction: Direction::Clockwise, repeated: false }));
    desk.until("it moves", |studio| studio.hiperdrive().is_some_and(Unit::is_moving));
    run(&mut desk, Run::Cancel);
    stands(&mut desk);
    let own = axis(&desk);
    assert_eq!((own.end(), own.is_saved(), own.changes().len()), (Some(End::Cancelled), false, 5));
    // Everything is as it was saved last: nobody has asked for the drive.
    run(&mut desk, Run::Press(Button::Recall));
    write(&mut desk);
    assert!(axis(&desk).changes().is_empty());
    assert_eq!([152, 154, 156].map(|own| number(&desk, own)), [0, 256, 1]);
    assert_eq!(unit(&desk).session.cycles, Some(0));
}

#[test]
fn a_write_that_is_not_consented_to_leaves_the_step_as_it_was() {
    let mut desk = begun(FRESH);
    run(&mut desk, Run::Press(Button::Do));
    desk.until("the plan is there", |studio| {
        studio.shown().unwrap().sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    assert!(axis(&desk).is_writing());
    until_ready(&mut desk);
    let id = unit(&desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Close));
    desk.settle();
    let own = axis(&desk);
    assert!(!own.is_writing() && own.changes().is_empty() && own.step() == Step::Request);
    assert_eq!(number(&desk, 152), 0);
    let number = ParameterNumber::of_drive(152, DriveNumber::FIRST).unwrap();
    assert!(unit(&desk).value(number).is_some());
}
