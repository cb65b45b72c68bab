//! The motion page: states of the drive, jogging, moves to a position, and runs at a constant speed.

use egui::{Id, RichText, Ui, UiBuilder, vec2};

use super::state_machine::{StateMachine, state_machine};
use super::{figures, jog, outside, run};
use crate::app::{Action, SessionId, Text};
use crate::devices::hiperdrive::procedures::dead_man::{MotionKind, MotionLock, Phase, SpeedTorque};
use crate::devices::hiperdrive::protocol::{ErrorCode, Percent, State};
use crate::devices::hiperdrive::state::{
    HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand, TEXTS, explain, forms,
};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{
    button_with_reason, card, card_with_trailing, dropdown, empty_placeholder, enabled_button, entry, folding_card,
    message_label, options, paragraph, row, show_error_below, show_error_beside, text_entry, two_columns,
};
use crate::ui::stop_debounce::{press_began, press_time, register_stop_press};

use crate::ui::{Theme, icons};

/// A percentage as typed, with the value that was set when it was last drawn.
pub(super) type Draft = Option<(String, Percent)>;

#[derive(Default)]
pub(super) struct MotionUiState {
    pub(super) jog_effort: [Draft; 2],
    pub(super) step: String,
    pub(super) outside: outside::Draft,
    move_effort: [Draft; 2],
    run_effort: [Draft; 2],
    pub(super) target: String,
}

const ENTRY_WIDTH: f32 = 88.0;
const PERCENT_WIDTH: f32 = 56.0;
const UNIT_SELECTOR_WIDTH: f32 = 64.0;
/// Minimum width for speed and torque to share a row. The next constant is the width of the note between them.
const ONE_ROW: f32 = 660.0;
const NOTE_WIDTH: f32 = 112.0;
const MESSAGE_HEIGHT: f32 = 32.0;
const MIN_TWO_COLUMN_WIDTH: f32 = 560.0;
/// Window height below which the jog buttons are placed above the state diagram.
const LOW_WINDOW_HEIGHT: f32 = 760.0;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut MotionUiState,
    actions: &mut Vec<Action>,
) {
    if unit.profile().is_some() {
        empty_placeholder(ui, theme, &translate(theme, "hd_motion.offline"), None);
        return;
    }
    // In a low window, the buttons are above the state diagram, unless the diagram shows a failure. The layout depends
    // on the height of the window and not on the remaining height, so that nothing moves when a notice appears.
    let has_failed = matches!(unit.state(unit.drive()), Some(State::Fault | State::Locked));
    let low = ui.ctx().content_rect().height() < LOW_WINDOW_HEIGHT && !has_failed;
    locks_ui(ui, theme, unit, actions);
    if !low {
        states_ui(ui, theme, unit, actions);
        theme.add_gap(ui);
    }
    // With a unique ID, widgets that appear above do not take the keyboard focus from an entry.
    let id = Id::unique("motion").with((unit.session.id, unit.drive()));
    ui.scope_builder(UiBuilder::new().scope_id(id), |ui| {
        jog::card_ui(ui, theme, unit, view, actions);
        theme.add_gap(ui);
        if low {
            states_ui(ui, theme, unit, actions);
            theme.add_gap(ui);
        }
        two_columns(
            ui,
            theme,
            (Ok(()), &mut *view, &mut *actions),
            |ui, (allowed, view, actions)| {
                *allowed = card(ui, theme, TEXTS.text("hd_move.title"), |ui| {
                    move_to_position_ui(ui, theme, unit, view, actions)
                });
            },
            |ui, (allowed, view, actions)| {
                jog::step_card_ui(ui, theme, unit, allowed, view, actions);
                theme.add_gap(ui);
                folding_card(ui, theme, TEXTS.text("hd_run.title"), |ui| {
                    run::run_ui(ui, theme, unit, &mut view.run_effort, actions)
                });
            },
        );
        // The card is below the buttons, so that nothing clickable moves when it appears.
        outside::card_ui(ui, theme, unit, &mut view.outside, actions);
    });
    theme.add_gap(ui);
    figures::control_status_words_ui(ui, theme, unit, unit.drive());
}

fn locks_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let drive = unit.drive();
    for lock in unit.moves.motion_locks(drive) {
        theme.sunken_frame().show(ui, |ui| {
            ui.set_width(ui.available_width().max(0.0));
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::LOCK_SIMPLE).color(theme.palette.warn));
                paragraph(ui, theme.format_text(&explain::lock_text(lock)));
            });
            if lock == MotionLock::LimitsUnconfirmed
                && let Some((low, high)) = unit.limits_to_confirm(drive)
            {
                let [low, high] = [low, high].map(|steps| {
                    let places = unit.position_texts(drive, steps);
                    places.iter().map(|place| theme.format_text(place)).collect::<Vec<_>>().join("   ")
                });
                row(ui, theme, &translate(theme, "hd_limits.lower"), theme.monospace(low));
                row(ui, theme, &translate(theme, "hd_limits.upper"), theme.monospace(high));
                if button_with_reason(
                    ui,
                    theme,
                    &unit.check_can_confirm(drive),
                    icons::CHECK,
                    &translate(theme, "hd_limits.confirm"),
                )
                .clicked()
                {
                    let confirm = Hiperdrive::Drive(MotorCommand::ConfirmLimits(drive));
                    actions.push(Action::device(unit.session.id, confirm));
                }
            }
        });
        ui.add_space(theme.space.between);
    }
}

/// Draws the state diagram, and what the drive is doing beside its heading or, in a narrow window, below it. The height
/// is constant, so that a jog button never moves away from the pointer that holds it.
fn states_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let beside = ui.available_width() >= MIN_TWO_COLUMN_WIDTH;
    let mut acts = Vec::new();
    let aside = |ui: &mut Ui| {
        ui.allocate_space(vec2(0.0, ui.spacing().interact_size.y));
        if beside {
            status_ui(ui, theme, unit, &mut acts);
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("hd_states.title"), aside, |ui| {
        let drive = unit.drive();
        let actual = unit.actual_values(drive);
        let present = actual.map(|actual| actual.status.state());
        let names = State::ALL.map(|state| theme.format_text(&explain::state_text(state)));
        let open = unit.moves.is_open();
        let reachable: Vec<State> = if open { unit.reachable_states(drive) } else { Vec::new() };
        let hints = State::ALL.map(|state| unit.transition_hint(drive, state).map(|hint| theme.format_text(&hint)));
        let machine = StateMachine { present, reachable: &reachable, names: &names, hints: &hints };
        if let Some(act) = state_machine(ui, theme, &machine).and_then(HiperdriveDevice::command_for_state) {
            motor(actions, unit.session.id, act);
        }
        if !beside {
            let top = ui.cursor().top();
            ui.horizontal_wrapped(|ui| status_ui(ui, theme, unit, actions));
            ui.add_space((top + MESSAGE_HEIGHT - ui.cursor().top()).max(0.0));
        }
    });
    actions.append(&mut acts);
}

/// Draws a fault with the button that acknowledges it, or else the outcome of the last action.
fn status_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let drive = unit.drive();
    if matches!(unit.state(drive), Some(State::Fault | State::Locked)) {
        let open = unit.moves.is_open();
        if enabled_button(ui, open, icons::CHECK, &translate(theme, "hd_states.acknowledge")).clicked() {
            motor(actions, unit.session.id, MotorCommand::Acknowledge);
        }
        let newest = unit.drive_status(drive).and_then(|own| own.buffer.first().copied());
        if let Some(code) = newest.filter(|code| *code != ErrorCode::NONE) {
            let words = explain::error_code_explanation(code);
            let text = format!("{:04X}  {}", code.code(), theme.format_text(&words.name));
            message_label(ui, theme, text, theme.palette.bad.into()).on_hover_text(theme.format_text(&words.remedy));
            return;
        }
    }
    if let Some(status) = unit.current_or_last_request(drive) {
        let ink = if status.is_well { theme.palette.good } else { theme.palette.warn };
        message_label(ui, theme, theme.format_text(&status.words), ink.into());
    }
}

fn motor(actions: &mut Vec<Action>, id: SessionId, motor: MotorCommand) {
    actions.push(Action::device(id, Hiperdrive::Drive(motor)));
}

/// Draws the controls for a move to a position. Returns whether the drive may be moved with the entered speed and
/// torque.
fn move_to_position_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut MotionUiState,
    actions: &mut Vec<Action>,
) -> Result<(), Text> {
    let (drive, id) = (unit.drive(), unit.session.id);
    let parse = |text: &str| forms::target(unit, text, unit.measure);
    position_entry_ui(ui, theme, unit, ("hd_move.target", &mut view.target), |text| parse(text).err(), actions);
    let target = parse(&view.target);
    let drafts = &mut view.move_effort;
    let effort = speed_torque_ui(
        ui,
        theme,
        unit,
        (unit.moves.move_speed_torque(drive), unit.moves.running_move_speed_torque(drive), drafts),
        &[],
        MotorCommand::MoveEffort,
        actions,
    );
    let entered = effort.clone();
    let allowed = effort.and(unit.may_move(drive));
    let can_go = allowed.clone().and(target.clone().map(drop));
    ui.horizontal(|ui| {
        if button_with_reason(ui, theme, &can_go, icons::PLAY, &translate(theme, "hd_move.go")).clicked() {
            target.iter().for_each(|target| motor(actions, id, MotorCommand::Move { target: *target }));
        }
        match unit.moves.phase(drive) {
            Some(Phase::Paused { .. }) => {
                let response =
                    button_with_reason(ui, theme, &allowed, icons::FAST_FORWARD, &translate(theme, "hd_move.resume"));
                let pressed = press_began(ui, &response);
                // This button replaces the pause button, so a quick second click was meant for the latter.
                if response.clicked() && !register_stop_press(ui.ctx(), false, press_time(ui, pressed)) {
                    motor(actions, id, MotorCommand::Resume);
                }
            }
            phase => {
                let on_its_way = matches!(phase, Some(Phase::Moving(MotionKind::Job { .. })));
                if enabled_button(ui, on_its_way, icons::PAUSE, &translate(theme, "hd_move.pause")).clicked() {
                    register_stop_press(ui.ctx(), true, ui.input(|input| input.time));
                    motor(actions, id, MotorCommand::Pause);
                }
            }
        }
        let estimate = target.as_ref().ok().and_then(|target| unit.move_estimate(*target));
        if let Some(estimate) = estimate {
            ui.add(egui::Label::new(theme.caption(theme.format_text(&estimate))).truncate());
        }
    });
    // A reason that blocks all motion is shown only once, below the jog buttons.
    let target = target.err().filter(|_| !view.target.trim().is_empty());
    show_error_below(ui, theme, target.as_ref().or(entered.as_ref().err()));
    allowed
}

/// Draws speed and torque in percent, in one row if there is enough space. The buttons for the speeds in `presets` do
/// not start a motion. An entry applies to the next motion immediately. The values of a running motion stay as they are
/// and are shown separately.
///
/// # Errors
/// Returns an error with the reason if an entry is not a percentage. No motion can be started with such an entry.
pub(super) fn speed_torque_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    (effort, under_way, [speed, torque]): (SpeedTorque, Option<SpeedTorque>, &mut [Draft; 2]),
    presets: &[Percent],
    set: impl Fn(SpeedTorque) -> MotorCommand,
    actions: &mut Vec<Action>,
) -> Result<(), Text> {
    let words = ["hd_effort.speed", "hd_effort.torque"].map(|word| translate(theme, word));
    let [speed_word, torque_word] = &words;
    let mut chosen = effort;
    let mut speed_ui = |ui: &mut Ui| {
        let sent = under_way.map(|own| own.speed);
        let typed = percent_ui(ui, theme, (speed_word, effort.speed), speed, presets, &mut chosen.speed);
        (typed, sent, unit.speed_text(effort.speed))
    };
    let mut torque_to = effort.torque;
    let mut torque_ui = |ui: &mut Ui| {
        let sent = under_way.map(|own| own.torque);
        let typed = percent_ui(ui, theme, (torque_word, effort.torque), torque, &[], &mut torque_to);
        (typed, sent, unit.torque_text(effort.torque))
    };
    let note = |ui: &mut Ui, own: Percent, (typed, sent, beside): (Result<(), Text>, Option<Percent>, Option<Text>)| {
        percent_note_ui(ui, theme, &typed, sent.filter(|sent| *sent != own), beside);
        typed
    };
    let taken = if !presets.is_empty() && ui.available_width() >= ONE_ROW {
        let row = ui.horizontal(|ui| {
            ui.label(theme.label(speed_word));
            let drawn = speed_ui(ui);
            // The width is constant, so that the torque entry does not move when the note changes.
            let height = ui.spacing().interact_size.y;
            let place = egui::Layout::left_to_right(egui::Align::Center);
            let speed = ui.allocate_ui_with_layout(vec2(NOTE_WIDTH, height), place, |ui| {
                ui.set_min_width(NOTE_WIDTH);
                note(ui, effort.speed, drawn)
            });
            ui.label(theme.label(torque_word));
            let drawn = torque_ui(ui);
            speed.inner.and(note(ui, effort.torque, drawn))
        });
        row.inner
    } else {
        let [mut speed, mut torque] = [Ok(()), Ok(())];
        entry(ui, theme, speed_word, |ui| {
            let drawn = speed_ui(ui);
            speed = note(ui, effort.speed, drawn);
        });
        entry(ui, theme, torque_word, |ui| {
            let drawn = torque_ui(ui);
            torque = note(ui, effort.torque, drawn);
        });
        speed.and(torque)
    };
    chosen.torque = torque_to;
    if chosen != effort {
        motor(actions, unit.session.id, set(chosen));
    }
    taken
}

/// Draws the input field and the presets for a percentage, and sets `to` to the typed or chosen value.
///
/// # Errors
/// Returns an error with the reason if the entry is not a percentage.
fn percent_ui(
    ui: &mut Ui,
    theme: &Theme,
    (word, own): (&str, Percent),
    draft: &mut Draft,
    presets: &[Percent],
    to: &mut Percent,
) -> Result<(), Text> {
    // Typed text is dropped if a preset or the value of a new session has taken effect in the meantime.
    let typed = draft.take().filter(|(text, counted)| *counted == own || forms::percent(text) == Ok(own));
    let mut text = typed.map_or_else(|| own.get().to_string(), |(text, _)| text);
    let response = text_entry(ui, &mut text, PERCENT_WIDTH, word, "");
    let typed = forms::percent(&text);
    if let Ok(percent) = &typed {
        *to = *percent;
    }
    let keeps = response.has_focus() || typed.is_err();
    *draft = keeps.then_some((text, own));
    ui.label(theme.label("%"));
    if !presets.is_empty() {
        // No preset is shown as selected while the typed text is invalid, because each of them would replace it.
        let mut chosen = if typed.is_ok() { own } else { Percent::NONE };
        let shown = presets.iter().map(|own| (*own, format!("{} %", own.get())));
        if options(ui, &translate(theme, "hd_jog.speed"), &mut chosen, shown) {
            *draft = None;
            *to = chosen;
        }
    }
    typed.map(|_| ())
}

/// Draws the note next to a percentage: why it cannot be used, else the value with which a running motion started, else
/// `beside`.
fn percent_note_ui(ui: &mut Ui, theme: &Theme, typed: &Result<(), Text>, sent: Option<Percent>, beside: Option<Text>) {
    match (typed, sent, beside) {
        (Err(why), ..) => {
            ui.label(RichText::new(icons::WARNING_CIRCLE).color(theme.palette.bad))
                .on_hover_text(theme.format_text(why));
        }
        (Ok(()), Some(sent), _) => {
            let words = theme.format_text(&TEXTS.text("hd_effort.sent").with("sent", sent.get()));
            let label = egui::Label::new(RichText::new(words).color(theme.palette.warn)).truncate();
            ui.add(label).on_hover_text(translate(theme, "hd_effort.waits"));
        }
        (Ok(()), None, Some(beside)) => {
            ui.add(egui::Label::new(theme.caption(theme.format_text(&beside))).truncate());
        }
        (Ok(()), None, None) => {}
    }
}

pub(super) fn move_speed_torque_text(theme: &Theme, unit: &HiperdriveDevice, id: &'static str) -> String {
    let SpeedTorque { speed, torque } = unit.moves.move_speed_torque(unit.drive());
    theme.format_text(&TEXTS.text(id).with("speed", speed.get()).with("torque", torque.get()))
}

/// Draws an input field for a position or distance, with its unit. The field is marked if `problem` returns a message.
pub(super) fn position_entry_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    (id, text): (&'static str, &mut String),
    problem: impl Fn(&str) -> Option<Text>,
    actions: &mut Vec<Action>,
) {
    let word = translate(theme, id);
    let ruler = unit.ruler(unit.drive());
    let mut measure = unit.measure;
    entry(ui, theme, &word, |ui| {
        text_entry(ui, text, ENTRY_WIDTH, &word, "");
        let measures = ruler.available_units().map(|own| (own, translate(theme, own.unit())));
        ui.push_id(id, |ui| {
            ui.spacing_mut().combo_width = UNIT_SELECTOR_WIDTH;
            if dropdown(ui, &translate(theme, "hd_move.measure"), &mut measure, measures) {
                actions.push(Action::device(unit.session.id, Hiperdrive::SetMeasure(measure)));
            }
        });
        if !text.trim().is_empty() {
            show_error_beside(ui, theme, problem(text).as_ref());
        }
    });
}
