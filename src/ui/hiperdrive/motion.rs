//! The drive's states, and what moves it: by hand, to a position, at a speed.

use egui::{RichText, Ui};

use super::{figures, jog};
use crate::app::explain::hiperdrive as explain;
use crate::app::hiperdrive::{Action as Hiperdrive, Motor, Unit, forms};
use crate::app::{Action, SessionId, Text};
use crate::device::hiperdrive::dead_man::{Effort, Goal, Phase};
use crate::protocol::hiperdrive::{Direction, RunEnd, State};
use crate::ui::controls::{
    allowed_button, card, choice, entry, paragraph, problem, row, settled_entry, text_entry, two_columns,
};
use crate::ui::widgets::{StateMachine, state_machine};
use crate::ui::{Skin, icons};

/// What is typed and does not count yet.
type Draft = Option<(String, Option<Text>)>;

/// What is typed.
#[derive(Default)]
pub(super) struct View {
    pub(super) jog_effort: [Draft; 2],
    pub(super) step: String,
    pub(super) step_problem: Option<Text>,
    move_effort: [Draft; 2],
    target: String,
    target_problem: Option<Text>,
}

/// Width of the entry of a position, and of a percentage.
const NUMBER: f32 = 88.0;
const PERCENT: f32 = 56.0;
const MEASURE: f32 = 64.0;
/// Height of the line that says what is done with the drive.
const SAID: f32 = 24.0;

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) {
    locks(ui, skin, unit, actions);
    states(ui, skin, unit, actions);
    ui.add_space(skin.space.groups);
    two_columns(
        ui,
        skin,
        (view, &mut *actions),
        |ui, (view, actions)| jog::card_ui(ui, skin, unit, view, actions),
        |ui, (view, actions)| {
            to_position(ui, skin, unit, view, actions);
            ui.add_space(skin.space.groups);
            at_speed(ui, skin, unit, actions);
        },
    );
    ui.add_space(skin.space.groups);
    figures::words_card_ui(ui, skin, unit, unit.drive());
}

/// Why nothing moves, and what to do.
fn locks(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    let drive = unit.drive();
    for lock in unit.moves.locks(drive) {
        skin.sunken().show(ui, |ui| {
            ui.set_width(ui.available_width().max(0.0));
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::LOCK_SIMPLE).color(skin.palette.warn));
                paragraph(ui, skin.words(&explain::lock(lock)));
            });
            if let Some((low, high)) = unit.limits_to_confirm(drive) {
                let [low, high] = [low, high].map(|steps| skin.words(&unit.place(drive, steps)));
                row(ui, skin, &skin.say("hd_limits.lower"), skin.mono(low));
                row(ui, skin, &skin.say("hd_limits.upper"), skin.mono(high));
                if allowed_button(ui, skin, &Ok(()), icons::CHECK, &skin.say("hd_limits.confirm")).clicked() {
                    let confirm = Hiperdrive::Drive(Motor::ConfirmLimits(drive));
                    actions.push(Action::Hiperdrive(unit.session.id, confirm));
                }
            }
        });
        ui.add_space(skin.space.between);
    }
}

/// The diagram, the words, and what the drive does just now.
fn states(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    card(ui, skin, "hd_states.title", |ui| {
        let drive = unit.drive();
        let actual = unit.actual(drive);
        let present = actual.map(|actual| actual.status.state());
        let names = State::ALL.map(|state| skin.words(&explain::state(state)));
        let open = unit.moves.is_open();
        let reachable: Vec<State> = if open { unit.reachable(drive) } else { Vec::new() };
        let hints = State::ALL.map(|state| unit.hint(drive, state).map(|hint| skin.words(&hint)));
        let machine = StateMachine { present, reachable: &reachable, names: &names, hints: &hints };
        if let Some(state) = state_machine(ui, skin, &machine) {
            let motor = match state {
                State::NotReady => Motor::Lead(Goal::Off),
                State::Ready => Motor::Lead(Goal::Ready),
                State::Operational => Motor::Lead(Goal::Operational),
                State::Locked => Motor::Acknowledge,
                State::Enabled | State::Moving | State::Fault => Motor::Lead(Goal::Enabled),
            };
            actions.push(Action::Hiperdrive(unit.session.id, Hiperdrive::Drive(motor)));
        }
        // Always as high: nothing may move away under the finger that holds a drive.
        let top = ui.cursor().top();
        if let Some(said) = unit.said(drive) {
            let ink = if said.is_well { skin.palette.good } else { skin.palette.warn };
            let words = skin.words(&said.words);
            ui.add(egui::Label::new(RichText::new(&words).color(ink)).truncate()).on_hover_text(words);
        }
        ui.add_space((top + SAID - ui.cursor().top()).max(0.0));
    });
}

fn motor(actions: &mut Vec<Action>, id: SessionId, motor: Motor) {
    actions.push(Action::Hiperdrive(id, Hiperdrive::Drive(motor)));
}

/// To a position.
fn to_position(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) {
    card(ui, skin, "hd_move.title", |ui| {
        let drive = unit.drive();
        let id = unit.session.id;
        if let Some(actual) = unit.actual(drive) {
            let now = skin.words(&unit.place(drive, actual.position));
            row(ui, skin, &skin.say("hd_move.now"), skin.mono(now));
        }
        if let Some((low, high)) = unit.limits(drive) {
            let [low, high] = [low, high].map(|steps| skin.words(&unit.place(drive, steps)));
            row(ui, skin, &skin.say("hd_move.range"), skin.mono(format!("{low} … {high}")));
        }
        length_ui(ui, skin, unit, "hd_move.target", &mut view.target, actions);
        problem(ui, skin, view.target_problem.as_ref());
        let allowed = unit.may_move(drive);
        ui.horizontal_wrapped(|ui| {
            if allowed_button(ui, skin, &allowed, icons::PLAY, &skin.say("hd_move.go")).clicked() {
                match forms::target(unit, &view.target, unit.measure) {
                    Ok(target) => {
                        view.target_problem = None;
                        motor(actions, id, Motor::Move { target });
                    }
                    Err(why) => view.target_problem = Some(why),
                }
            }
            match unit.moves.phase(drive) {
                Some(Phase::Paused { .. }) => {
                    if allowed_button(ui, skin, &allowed, icons::FAST_FORWARD, &skin.say("hd_move.resume")).clicked() {
                        motor(actions, id, Motor::Resume);
                    }
                }
                phase => {
                    let moving = matches!(phase, Some(Phase::Moving(_)));
                    if ui
                        .add_enabled_ui(moving, |ui| {
                            allowed_button(ui, skin, &Ok(()), icons::PAUSE, &skin.say("hd_move.pause")).clicked()
                        })
                        .inner
                    {
                        motor(actions, id, Motor::Pause);
                    }
                }
            }
        });
        ui.add_space(skin.space.inside);
        effort_ui(ui, skin, unit, (unit.moves.move_effort(), &mut view.move_effort), Motor::MoveEffort, actions);
    });
}

/// At a speed, to the end of the range or, for experts, without one.
fn at_speed(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    card(ui, skin, "hd_run.title", |ui| {
        let id = unit.session.id;
        let allowed = unit.may_move(unit.drive());
        let mut expert = unit.moves.is_expert();
        let end = if expert { RunEnd::Endless } else { RunEnd::RangeEnd };
        ui.horizontal_wrapped(|ui| {
            for (direction, word) in
                [(Direction::Counterclockwise, "hd_run.back"), (Direction::Clockwise, "hd_run.forth")]
            {
                if allowed_button(ui, skin, &allowed, icons::FAST_FORWARD, &skin.say(word)).clicked() {
                    let run = Hiperdrive::Drive(Motor::Run { direction, end });
                    actions.push(Action::Hiperdrive(id, run));
                }
            }
        });
        paragraph(ui, skin.caption(skin.say("hd_run.words")));
        let endless = unit.could_run_endlessly(unit.drive());
        // It can always be switched off.
        ui.add_enabled_ui(endless.is_ok() || expert, |ui| {
            let response = ui.checkbox(&mut expert, skin.say("hd_run.expert"));
            if response.changed() {
                actions.push(Action::Hiperdrive(id, Hiperdrive::Drive(Motor::Expert(expert))));
            }
        });
        match endless {
            Ok(()) => paragraph(ui, skin.caption(skin.say("hd_run.expert_words"))),
            Err(why) => paragraph(ui, skin.caption(skin.words(&why))),
        }
    });
}

/// Speed and torque, in percent.
pub(super) fn effort_ui(
    ui: &mut Ui,
    skin: &Skin,
    unit: &Unit,
    (effort, drafts): (Effort, &mut [Draft; 2]),
    set: impl Fn(Effort) -> Motor,
    actions: &mut Vec<Action>,
) {
    let id = unit.session.id;
    let [speed, torque] = drafts;
    for (word, own, draft, is_speed) in
        [("hd_effort.speed", effort.speed, speed, true), ("hd_effort.torque", effort.torque, torque, false)]
    {
        let word = skin.say(word);
        entry(ui, skin, &word, |ui| {
            settled_entry(ui, draft, &own.get().to_string(), PERCENT, &word, |text| {
                let percent = forms::percent(text)?;
                let effort =
                    if is_speed { Effort { speed: percent, ..effort } } else { Effort { torque: percent, ..effort } };
                actions.push(Action::Hiperdrive(id, Hiperdrive::Drive(set(effort))));
                Ok(())
            });
            ui.label(skin.label("%"));
            let beside = if is_speed { unit.speed_of(own) } else { unit.torque_of(own) };
            if let Some(beside) = beside {
                ui.label(skin.caption(skin.words(&beside)));
            }
        });
        problem(ui, skin, draft.as_ref().and_then(|(_, why)| why.as_ref()));
    }
}

/// A length or a place: a number and its measure.
pub(super) fn length_ui(
    ui: &mut Ui,
    skin: &Skin,
    unit: &Unit,
    id: &'static str,
    text: &mut String,
    actions: &mut Vec<Action>,
) {
    let word = skin.say(id);
    let ruler = unit.ruler(unit.drive());
    let mut measure = unit.measure;
    entry(ui, skin, &word, |ui| {
        text_entry(ui, text, NUMBER, &word, "");
        let measures = ruler.measures().map(|own| (own, skin.say(own.unit())));
        ui.push_id(id, |ui| {
            ui.spacing_mut().combo_width = MEASURE;
            if choice(ui, &skin.say("hd_move.measure"), &mut measure, measures) {
                actions.push(Action::Hiperdrive(unit.session.id, Hiperdrive::SetMeasure(measure)));
            }
        });
    });
}
