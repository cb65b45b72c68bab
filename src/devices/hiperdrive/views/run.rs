//! Runs at a constant speed, either to the end of the range or, for experts, endless.

use egui::{RichText, Ui};

use super::motion::{Draft, speed_torque_ui};
use crate::app::Action;
use crate::devices::hiperdrive::protocol::{Direction, RunEnd};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{button_with_reason, paragraph};
use crate::ui::{Theme, icons};

pub(super) fn run_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    drafts: &mut [Draft; 2],
    actions: &mut Vec<Action>,
) {
    let (drive, id) = (unit.drive(), unit.session.id);
    let own = (unit.moves.run_speed_torque(drive), unit.moves.running_run_speed_torque(drive), drafts);
    let effort = speed_torque_ui(ui, theme, unit, own, &[], MotorCommand::RunEffort, actions);
    let allowed = effort.and(unit.check_can_move_until_stopped(drive));
    let mut expert = unit.moves.allows_endless_run(drive);
    let end = if expert { RunEnd::Endless } else { RunEnd::RangeEnd };
    ui.horizontal_wrapped(|ui| {
        let ways = [(Direction::Counterclockwise, "hd_run.back"), (Direction::Clockwise, "hd_run.forth")];
        for (direction, word) in ways {
            if button_with_reason(ui, theme, &allowed, "", &translate(theme, word)).clicked() {
                actions.push(Action::device(id, Hiperdrive::Drive(MotorCommand::Run { direction, end })));
            }
        }
    });
    let words = if expert { "hd_run.endless_words" } else { "hd_run.words" };
    paragraph(ui, theme.caption(translate(theme, words)));
    let is_possible = unit.check_can_allow_endless_run(drive).is_ok();
    // The option can always be disabled.
    ui.add_enabled_ui(is_possible || expert, |ui| {
        if ui.checkbox(&mut expert, translate(theme, "hd_run.expert")).changed() {
            actions.push(Action::device(id, Hiperdrive::Drive(MotorCommand::Expert(expert))));
        }
    });
    condition_ui(ui, theme, unit, is_possible);
    paragraph(ui, theme.caption(translate(theme, "hd_run.expert_words")));
}

/// Draws the condition for an endless run, whether it is met, and which parameters prevent it.
fn condition_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, is_met: bool) {
    let (icon, ink) =
        if is_met { (icons::CHECK_CIRCLE, theme.palette.good) } else { (icons::X_CIRCLE, theme.palette.warn) };
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(ink));
        ui.vertical(|ui| {
            paragraph(ui, theme.caption(translate(theme, "hd_run.condition")));
            for obstacle in unit.endless_run_obstacles(unit.drive()) {
                paragraph(ui, theme.caption(theme.format_text(&obstacle)).color(theme.palette.warn));
            }
        });
    });
}
