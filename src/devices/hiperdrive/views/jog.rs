//! Jogging: buttons that move a drive while held, and steps that run to completion.

use egui::{FontId, RichText, Ui, Vec2, vec2};

use super::motion::{MotionUiState, move_speed_torque_text, position_entry_ui, speed_torque_ui};
use super::travel::travel_ui;
use crate::app::{Action, HoldEvent, SessionId, Text};
use crate::devices::hiperdrive::procedures::dead_man::LimitViolation;
use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, Percent};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand, TEXTS, forms};
use crate::devices::hiperdrive::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{button_with_reason, card, folding_card, paragraph, show_error_below};
use crate::ui::widgets::{HoldButton, hold_button};

const JOG_BUTTON_HEIGHT: f32 = 56.0;

/// Speeds offered by the preset buttons, in percent.
const PRESETS: [u8; 4] = [1, 10, 50, 100];

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut MotionUiState,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("hd_jog.title"), |ui| {
        travel_ui(ui, theme, unit, &view.target);
        ui.add_space(theme.space.inside);
        let drafts = &mut view.jog_effort;
        let drive = unit.drive();
        let own = (unit.moves.jog_speed_torque(drive), unit.moves.running_jog_speed_torque(drive), drafts);
        let presets: Vec<Percent> = PRESETS.into_iter().filter_map(Percent::new).collect();
        let effort = speed_torque_ui(ui, theme, unit, own, &presets, MotorCommand::JogEffort, actions);
        let allowed = effort.and(unit.check_can_move_until_stopped(drive));
        jog_buttons_ui(ui, theme, unit, allowed.is_ok(), actions);
        jog_buttons_note_ui(ui, theme, unit, allowed.as_ref().err());
    });
}

pub(super) fn step_card_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    allowed: &Result<(), Text>,
    view: &mut MotionUiState,
    actions: &mut Vec<Action>,
) {
    folding_card(ui, theme, TEXTS.text("hd_step.title"), |ui| {
        let parse = |text: &str, sign| forms::parse_distance(unit, text, unit.measure, sign);
        position_entry_ui(ui, theme, unit, ("hd_step.by", &mut view.step), |text| parse(text, 1).err(), actions);
        ui.horizontal_wrapped(|ui| {
            for (sign, id) in [(-1, "hd_step.back"), (1, "hd_step.forth")] {
                let step = parse(&view.step, sign);
                let can_go = allowed.clone().and(step.clone().map(drop));
                if button_with_reason(ui, theme, &can_go, "", &translate(theme, id)).clicked() {
                    let act = |by| Action::device(unit.session.id, Hiperdrive::Drive(MotorCommand::Step { by }));
                    actions.extend(step.ok().map(act));
                }
            }
        });
        let problem = parse(&view.step, 1).err().filter(|_| !view.step.trim().is_empty());
        show_error_below(ui, theme, problem.as_ref());
        paragraph(ui, theme.caption(move_speed_torque_text(theme, unit, "hd_step.words")));
    });
}

/// Draws a note that explains what the buttons do or why they are disabled. Its height is constant, so that nothing
/// below it moves.
fn jog_buttons_note_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, why_not: Option<&Text>) {
    let drive = unit.drive();
    let outside = unit.out_of_range_position(drive).filter(|own| {
        let ways = [Direction::Counterclockwise, Direction::Clockwise];
        own.is_far && ways.into_iter().any(|way| unit.is_blocked(drive, way))
    });
    let (id, colour) = match outside.map(|own| own.outside) {
        None => ("hd_jog.words", theme.palette.muted),
        Some(LimitViolation::At(_)) => ("hd_jog.outside", theme.palette.bad),
        Some(LimitViolation::Unclear) => ("hd_jog.unclear", theme.palette.bad),
    };
    let width = ui.available_width();
    let font = FontId::proportional(theme.sizes.body);
    let height = |words| ui.painter().layout(words, font.clone(), colour.into(), width).size().y;
    let fixed = ["hd_jog.words", "hd_jog.outside", "hd_jog.unclear", "hd_refused.not_taken", "hd_refused.remote"];
    let room = fixed.into_iter().map(|id| height(translate(theme, id))).fold(0.0, f32::max);
    let words = match why_not {
        Some(why) => RichText::new(theme.format_text(why)).color(theme.palette.warn),
        None => RichText::new(translate(theme, id)).color(colour),
    };
    ui.allocate_ui(vec2(width, room), |ui| {
        ui.set_min_height(room);
        paragraph(ui, words);
    });
}

pub(super) fn jog_buttons_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    enabled: bool,
    actions: &mut Vec<Action>,
) {
    let width = ((ui.available_width() - theme.space.between) / 2.0).max(0.0);
    ui.horizontal(|ui| {
        for (direction, word, label) in
            [(Direction::Counterclockwise, "−", "hd_jog.down"), (Direction::Clockwise, "+", "hd_jog.up")]
        {
            let blocked = unit.is_blocked(unit.drive(), direction);
            let caption = translate(
                theme,
                match unit.out_of_range_position(unit.drive()).map(|own| own.outside) {
                    Some(LimitViolation::Unclear) if blocked => "hd_outside.pad_unclear",
                    _ if blocked => "hd_outside.pad",
                    _ => "hd_jog.hold",
                },
            );
            let (enabled, label) = (enabled && !blocked, translate(theme, label));
            let has_ended = unit.moves.has_held_jog_ended();
            let button = HoldButton { word, caption: &caption, label: &label, enabled, has_ended };
            let press = MotorCommand::JogPress { direction, repeated: false };
            jog_button_ui(
                ui,
                theme,
                (unit.session.id, unit.drive()),
                press,
                (&button, vec2(width, JOG_BUTTON_HEIGHT)),
                actions,
            );
        }
    });
}

/// Draws a button that moves a drive while held. `press` is the command that starts the motion.
pub(super) fn jog_button_ui(
    ui: &mut Ui,
    theme: &Theme,
    (session, drive): (SessionId, DriveNumber),
    press: MotorCommand,
    (button, size): (&HoldButton<'_>, Vec2),
    actions: &mut Vec<Action>,
) {
    // Each drive has its own button, so a press or the keyboard focus does not carry over to another drive.
    let event = ui.push_id((session, drive), |ui| hold_button(ui, theme, button, size)).inner;
    let motor = match event {
        Some(HoldEvent::Press) => press,
        Some(HoldEvent::Hold) => MotorCommand::JogHold,
        Some(HoldEvent::Release) => MotorCommand::JogRelease,
        Some(HoldEvent::Stop) => return actions.push(Action::StopMotion),
        None => return,
    };
    actions.push(Action::device(session, Hiperdrive::Drive(motor)));
}
