//! The drive's states, and what moves it: by hand, to a position, at a speed.

use egui::{Id, RichText, Ui, UiBuilder, vec2};

use super::state_machine::{StateMachine, state_machine};
use super::{figures, jog, outside};
use crate::app::{Action, SessionId, Text};
use crate::devices::hiperdrive::procedures::dead_man::{Effort, Lock, Motive, Phase};
use crate::devices::hiperdrive::protocol::{Direction, ErrorCode, RunEnd, State};
use crate::devices::hiperdrive::state::{Action as Hiperdrive, Motor, TEXTS, Unit, explain, forms};
use crate::devices::hiperdrive::views::say;
use crate::ui::controls::{
    allowed_button, card, card_with, choice, empty, enabled_button, entry, paragraph, problem, row, text_entry,
    two_columns,
};
use crate::ui::stopping::{goes_down, means_motion, pressed_at};

use crate::ui::{Skin, icons};

/// A percentage as it is typed.
type Draft = Option<String>;

/// What is typed.
#[derive(Default)]
pub(super) struct View {
    pub(super) jog_effort: [Draft; 2],
    pub(super) step: String,
    pub(super) step_problem: Option<Text>,
    pub(super) outside: outside::Draft,
    move_effort: [Draft; 2],
    target: String,
    target_problem: Option<Text>,
}

/// Width of the entry of a position, and of a percentage.
const NUMBER: f32 = 88.0;
const PERCENT: f32 = 56.0;
const MEASURE: f32 = 64.0;
/// Height of what says what is done with the drive, and the width from which that stands beside a heading.
const SAID: f32 = 32.0;
const BESIDE: f32 = 560.0;
/// Height of a window below which the states stand behind what moves the drive.
const LOW: f32 = 760.0;

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) {
    if unit.profile().is_some() {
        empty(ui, skin, &say(skin, "hd_motion.offline"), None);
        return;
    }
    // In a low window what moves the drive comes before the picture of its states, but not where that says what has failed.
    // The window counts, not what is left of it: nothing changes its place because a notice comes.
    let has_failed = matches!(unit.state(unit.drive()), Some(State::Fault | State::Locked));
    let low = ui.ctx().content_rect().height() < LOW && !has_failed;
    locks(ui, skin, unit, actions);
    if !low {
        states(ui, skin, unit, actions);
        ui.add_space(skin.space.groups);
    }
    // By a name of its own: what comes and goes above takes the keyboard from no entry.
    let id = Id::unique("motion").with((unit.session.id, unit.drive()));
    ui.scope_builder(UiBuilder::new().scope_id(id), |ui| {
        two_columns(
            ui,
            skin,
            (view, &mut *actions),
            |ui, (view, actions)| jog::card_ui(ui, skin, unit, view, actions),
            |ui, (view, actions)| moves(ui, skin, unit, view, actions),
        );
    });
    ui.add_space(skin.space.groups);
    if low {
        states(ui, skin, unit, actions);
        ui.add_space(skin.space.groups);
    }
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
            if lock == Lock::LimitsUnconfirmed
                && let Some((low, high)) = unit.limits_to_confirm(drive)
            {
                let [low, high] = [low, high].map(|steps| {
                    let places = unit.in_all_units(drive, steps);
                    places.iter().map(|place| skin.words(place)).collect::<Vec<_>>().join("   ")
                });
                row(ui, skin, &say(skin, "hd_limits.lower"), skin.mono(low));
                row(ui, skin, &say(skin, "hd_limits.upper"), skin.mono(high));
                if allowed_button(ui, skin, &unit.may_confirm(drive), icons::CHECK, &say(skin, "hd_limits.confirm"))
                    .clicked()
                {
                    let confirm = Hiperdrive::Drive(Motor::ConfirmLimits(drive));
                    actions.push(Action::device(unit.session.id, confirm));
                }
            }
        });
        ui.add_space(skin.space.between);
    }
}

/// The diagram, and what the drive does just now: beside the heading, or below where that is narrow. Always as high, since
/// nothing may move away under the finger that holds a drive.
fn states(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    let beside = ui.available_width() >= BESIDE;
    let mut acts = Vec::new();
    let aside = |ui: &mut Ui| {
        ui.allocate_space(vec2(0.0, ui.spacing().interact_size.y));
        if beside {
            news(ui, skin, unit, &mut acts);
        }
    };
    card_with(ui, skin, TEXTS.text("hd_states.title"), aside, |ui| {
        let drive = unit.drive();
        let actual = unit.actual(drive);
        let present = actual.map(|actual| actual.status.state());
        let names = State::ALL.map(|state| skin.words(&explain::state(state)));
        let open = unit.moves.is_open();
        let reachable: Vec<State> = if open { unit.reachable(drive) } else { Vec::new() };
        let hints = State::ALL.map(|state| unit.hint(drive, state).map(|hint| skin.words(&hint)));
        let machine = StateMachine { present, reachable: &reachable, names: &names, hints: &hints };
        if let Some(act) = state_machine(ui, skin, &machine).and_then(Unit::leads_to) {
            motor(actions, unit.session.id, act);
        }
        if !beside {
            let top = ui.cursor().top();
            ui.horizontal_wrapped(|ui| news(ui, skin, unit, actions));
            ui.add_space((top + SAID - ui.cursor().top()).max(0.0));
        }
    });
    actions.append(&mut acts);
}

/// What has failed and the way out of it; or how the last act goes on or ended.
fn news(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    let drive = unit.drive();
    if matches!(unit.state(drive), Some(State::Fault | State::Locked)) {
        let open = unit.moves.is_open();
        if enabled_button(ui, open, icons::CHECK, &say(skin, "hd_states.acknowledge")).clicked() {
            motor(actions, unit.session.id, Motor::Acknowledge);
        }
        let newest = unit.drive_status(drive).and_then(|own| own.buffer.first().copied());
        if let Some(code) = newest.filter(|code| *code != ErrorCode::NONE) {
            let words = explain::error(code);
            let text = format!("{:04X}  {}", code.code(), skin.words(&words.name));
            let label = egui::Label::new(RichText::new(text).color(skin.palette.bad)).truncate();
            ui.add(label).on_hover_text(skin.words(&words.remedy));
            return;
        }
    }
    if let Some(said) = unit.said(drive) {
        let ink = if said.is_well { skin.palette.good } else { skin.palette.warn };
        ui.add(egui::Label::new(RichText::new(skin.words(&said.words)).color(ink)).truncate());
    }
}

fn motor(actions: &mut Vec<Action>, id: SessionId, motor: Motor) {
    actions.push(Action::device(id, Hiperdrive::Drive(motor)));
}

/// To a position, and at a speed: with the same effort.
fn moves(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) {
    let allowed = card(ui, skin, TEXTS.text("hd_move.title"), |ui| to_position(ui, skin, unit, view, actions));
    ui.add_space(skin.space.groups);
    card(ui, skin, TEXTS.text("hd_run.title"), |ui| at_speed(ui, skin, unit, &allowed, actions));
}

/// To a position; whether the drive may be moved with the effort that is typed.
fn to_position(ui: &mut Ui, skin: &Skin, unit: &Unit, view: &mut View, actions: &mut Vec<Action>) -> Result<(), Text> {
    let (drive, id) = (unit.drive(), unit.session.id);
    // Both rows stay where nothing is known for a moment: nothing below them moves, and no entry loses the keyboard.
    let unknown = || "–".to_owned();
    let now = unit.actual(drive).map(|actual| skin.words(&unit.place(drive, actual.position)));
    row(ui, skin, &say(skin, "hd_move.now"), skin.mono(now.unwrap_or_else(unknown)));
    let range = unit.limits(drive).map(|limits| skin.words(&unit.places(drive, limits)));
    row(ui, skin, &say(skin, "hd_move.range"), skin.mono(range.unwrap_or_else(unknown)));
    length_ui(ui, skin, unit, "hd_move.target", &mut view.target, actions);
    let drafts = &mut view.move_effort;
    let effort = effort_ui(
        ui,
        skin,
        unit,
        (unit.moves.move_effort(drive), unit.moves.moves_with(drive), drafts),
        Motor::MoveEffort,
        actions,
    );
    let allowed = effort.and(unit.may_move(drive));
    ui.horizontal_wrapped(|ui| {
        if allowed_button(ui, skin, &allowed, icons::PLAY, &say(skin, "hd_move.go")).clicked() {
            view.target_problem = forms::target(unit, &view.target, unit.measure)
                .map(|target| motor(actions, id, Motor::Move { target }))
                .err();
        }
        match unit.moves.phase(drive) {
            Some(Phase::Paused { .. }) => {
                let response = allowed_button(ui, skin, &allowed, icons::FAST_FORWARD, &say(skin, "hd_move.resume"));
                let pressed = goes_down(ui, &response);
                // It stands where the pause was: a second click in a fright is meant for that.
                if response.clicked() && !means_motion(ui.ctx(), false, pressed_at(ui, pressed)) {
                    motor(actions, id, Motor::Resume);
                }
            }
            phase => {
                let on_its_way = matches!(phase, Some(Phase::Moving(Motive::Job { .. })));
                if enabled_button(ui, on_its_way, icons::PAUSE, &say(skin, "hd_move.pause")).clicked() {
                    means_motion(ui.ctx(), true, ui.input(|input| input.time));
                    motor(actions, id, Motor::Pause);
                }
            }
        }
    });
    problem(ui, skin, view.target_problem.as_ref());
    why_not(ui, skin, &allowed);
    allowed
}

/// Why nothing can be moved.
pub(super) fn why_not(ui: &mut Ui, skin: &Skin, allowed: &Result<(), Text>) {
    if let Err(why) = allowed {
        paragraph(ui, RichText::new(skin.words(why)).color(skin.palette.warn));
    }
}

/// At a speed, to the end of the range or, for experts, without one.
fn at_speed(ui: &mut Ui, skin: &Skin, unit: &Unit, allowed: &Result<(), Text>, actions: &mut Vec<Action>) {
    let id = unit.session.id;
    let mut expert = unit.moves.is_expert(unit.drive());
    let end = if expert { RunEnd::Endless } else { RunEnd::RangeEnd };
    ui.horizontal_wrapped(|ui| {
        let ways = [(Direction::Counterclockwise, "hd_run.back"), (Direction::Clockwise, "hd_run.forth")];
        for (direction, word) in ways {
            if allowed_button(ui, skin, allowed, "", &say(skin, word)).clicked() {
                motor(actions, id, Motor::Run { direction, end });
            }
        }
    });
    paragraph(ui, skin.caption(say(skin, "hd_run.words")));
    let endless = unit.could_run_endlessly(unit.drive());
    // It can always be switched off.
    ui.add_enabled_ui(endless.is_ok() || expert, |ui| {
        if ui.checkbox(&mut expert, say(skin, "hd_run.expert")).changed() {
            motor(actions, id, Motor::Expert(expert));
        }
    });
    match endless {
        Ok(()) => paragraph(ui, skin.caption(say(skin, "hd_run.expert_words"))),
        Err(why) => paragraph(ui, skin.caption(skin.words(&why))),
    }
}

/// Speed and torque, in percent. What is typed counts at once, so that nothing begins with what stood there before; what is
/// under way goes on as it began, which is said.
///
/// # Errors
/// What is typed is no percentage: nothing may begin with it.
pub(super) fn effort_ui(
    ui: &mut Ui,
    skin: &Skin,
    unit: &Unit,
    (effort, under_way, drafts): (Effort, Option<Effort>, &mut [Draft; 2]),
    set: impl Fn(Effort) -> Motor,
    actions: &mut Vec<Action>,
) -> Result<(), Text> {
    let [speed, torque] = drafts;
    let mut taken = Ok(());
    let sent = (under_way.map(|own| own.speed), under_way.map(|own| own.torque));
    for (word, own, sent, draft, is_speed) in [
        ("hd_effort.speed", effort.speed, sent.0, speed, true),
        ("hd_effort.torque", effort.torque, sent.1, torque, false),
    ] {
        let word = say(skin, word);
        entry(ui, skin, &word, |ui| {
            let mut text = draft.take().unwrap_or_else(|| own.get().to_string());
            let response = text_entry(ui, &mut text, PERCENT, &word, "");
            let typed = forms::percent(&text);
            if let Ok(percent) = &typed
                && *percent != own
            {
                let percent = *percent;
                let effort =
                    if is_speed { Effort { speed: percent, ..effort } } else { Effort { torque: percent, ..effort } };
                motor(actions, unit.session.id, set(effort));
            }
            if response.has_focus() || typed.is_err() {
                *draft = Some(text);
            }
            ui.label(skin.label("%"));
            let beside = if is_speed { unit.speed_of(own) } else { unit.torque_of(own) };
            let waits = sent.filter(|sent| *sent != own && typed.is_ok());
            if let Some(sent) = waits {
                let words = TEXTS.text("hd_effort.sent").with("sent", sent.get());
                let label = ui.label(RichText::new(skin.words(&words)).color(skin.palette.warn));
                label.on_hover_text(say(skin, "hd_effort.waits"));
            } else if let Some(beside) = beside.filter(|_| typed.is_ok()) {
                ui.label(skin.caption(skin.words(&beside)));
            }
            if let Err(why) = typed {
                ui.label(RichText::new(icons::WARNING_CIRCLE).color(skin.palette.bad)).on_hover_text(skin.words(&why));
                taken = Err(why);
            }
        });
    }
    taken
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
    let word = say(skin, id);
    let ruler = unit.ruler(unit.drive());
    let mut measure = unit.measure;
    entry(ui, skin, &word, |ui| {
        text_entry(ui, text, NUMBER, &word, "");
        let measures = ruler.measures().map(|own| (own, say(skin, own.unit())));
        ui.push_id(id, |ui| {
            ui.spacing_mut().combo_width = MEASURE;
            if choice(ui, &say(skin, "hd_move.measure"), &mut measure, measures) {
                actions.push(Action::device(unit.session.id, Hiperdrive::SetMeasure(measure)));
            }
        });
    });
}
