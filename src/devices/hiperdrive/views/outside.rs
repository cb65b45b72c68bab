//! Warnings about a drive outside its limits: which directions are blocked, how to get back in, and what to do if the
//! reference is wrong.

use egui::{RichText, Ui};

use super::motion::position_entry_ui;
use crate::app::{Action, Text};
use crate::devices::hiperdrive::procedures::dead_man::{LimitSide, LimitViolation};
use crate::devices::hiperdrive::protocol::Direction;
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand, TEXTS, forms};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{button_with_reason, card, paragraph, show_error_below};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct Draft {
    /// Position to assign to the current location of the drive, as typed.
    place: String,
    problem: Option<Text>,
}

/// Returns a one-line warning if the drive is outside its limits.
pub(crate) fn warning_badge(theme: &Theme, unit: &HiperdriveDevice) -> Option<RichText> {
    unit.outside_limits_text(unit.drive())?;
    let words = format!("{}  {}", icons::WARNING, translate(theme, "hd_outside.short"));
    Some(RichText::new(words).font(theme.bold_font(theme.sizes.body)).color(theme.palette.bad))
}

/// Draws a card that shows which limit the drive has passed, which motion is blocked, and what to do. Draws nothing if
/// the drive is inside its limits or at the end of its range.
pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    draft: &mut Draft,
    actions: &mut Vec<Action>,
) {
    let (drive, id) = (unit.drive(), unit.session.id);
    let (Some(words), Some(outside)) = (unit.outside_limits_text(drive), unit.out_of_range_position(drive)) else {
        *draft = Draft::default();
        return;
    };
    theme.add_gap(ui);
    card(ui, theme, TEXTS.text("hd_outside.short"), |ui| {
        let strong =
            RichText::new(theme.format_text(&words)).font(theme.bold_font(theme.sizes.body)).color(theme.palette.bad);
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::WARNING).color(theme.palette.bad));
            paragraph(ui, strong);
        });
        let ways = [Direction::Counterclockwise, Direction::Clockwise].into_iter();
        let ways: Vec<Direction> = ways.filter(|way| outside.outside.is_outward(*way)).collect();
        let freed = ways.iter().copied().find(|way| unit.moves.is_outward_jog_enabled(drive, *way));
        let words = match (freed, outside.outside) {
            (Some(Direction::Clockwise), _) => "hd_outside.freed_up",
            (Some(Direction::Counterclockwise), _) => "hd_outside.freed_down",
            (None, LimitViolation::Unclear) => "hd_outside.blocked_both",
            (None, LimitViolation::At(LimitSide::Above)) => "hd_outside.blocked_up",
            (None, LimitViolation::At(LimitSide::Below)) => "hd_outside.blocked_down",
        };
        paragraph(ui, theme.caption(translate(theme, words)));
        // The buttons remain after a press, so that the widgets below them do not move under the pointer.
        let allowed = if freed.is_some() { Err(TEXTS.text(words)) } else { unit.check_can_move_until_stopped(drive) };
        ui.horizontal_wrapped(|ui| {
            for way in ways {
                let free = match way {
                    Direction::Clockwise => "hd_outside.free_up",
                    Direction::Counterclockwise => "hd_outside.free_down",
                };
                if button_with_reason(ui, theme, &allowed, icons::LOCK_SIMPLE_OPEN, &translate(theme, free)).clicked() {
                    actions.push(Action::device(id, Hiperdrive::Drive(MotorCommand::AllowOutward(way))));
                }
            }
        });
        position_entry_ui(ui, theme, unit, ("hd_outside.place", &mut draft.place), |_| None, actions);
        if button_with_reason(ui, theme, &unit.check_can_plan(), "", &translate(theme, "hd_outside.set")).clicked() {
            let change = forms::parse_position(unit, &draft.place, unit.measure)
                .and_then(|position| unit.reference_change(drive, position));
            draft.problem =
                change.map(|change| actions.push(Action::device(id, Hiperdrive::Plan(Box::new(change))))).err();
        }
        show_error_below(ui, theme, draft.problem.as_ref());
    });
}
