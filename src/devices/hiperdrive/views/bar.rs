//! The bar above every page: drive selection for a hub, control, the STOP button, and the note that it is not an
//! emergency stop.

use egui::{RichText, Stroke, Ui, vec2};

use super::outside;
use crate::app::{Action, Studio};
use crate::devices::hiperdrive::protocol::{DriveNumber, State};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{button_with_reason, message_label, name, paragraph, stop_button};
use crate::ui::stop_debounce::{press_began, press_time, register_stop_press};
use crate::ui::{Theme, icons};

/// Size of the STOP button. It is large enough to be hit quickly.
const STOP_BUTTON_SIZE: egui::Vec2 = vec2(112.0, 44.0);

pub(super) fn bar_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let id = unit.session.id;
    ui.horizontal_top(|ui| {
        stop_ui(ui, theme, studio, actions);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = theme.space.inside;
            let is_hub = unit.drives().len() > 1;
            ui.horizontal(|ui| {
                drives(ui, theme, unit, actions);
                let (word, allowed, act) = match unit.moves.is_open() {
                    true => ("hd_bar.give", unit.check_can_release_control(), Hiperdrive::Give),
                    false => ("hd_bar.take", unit.check_can_take_control(), Hiperdrive::Take),
                };
                let icon = if unit.moves.is_open() { icons::PLUGS } else { icons::PLUGS_CONNECTED };
                if button_with_reason(ui, theme, &allowed, icon, &translate(theme, word)).clicked() {
                    actions.push(Action::device(id, act));
                }
                if !is_hub {
                    control_ui(ui, theme, unit);
                }
            });
            if is_hub {
                let size = vec2(ui.available_width().max(0.0), ui.spacing().interact_size.y);
                let place = egui::Layout::left_to_right(egui::Align::Center);
                ui.allocate_ui_with_layout(size, place, |ui| control_ui(ui, theme, unit));
            }
            paragraph(ui, theme.caption(format!("{}  {}", icons::WARNING, translate(theme, "hd_bar.stop_is_not"))));
        });
    });
}

/// Draws whether this window has control of the drives, or why it has lost control. Alarms take precedence. The height
/// is constant, so that losing control does not move any button.
fn control_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    let palette = theme.palette;
    let (words, ink) = match (unit.loss_reason(), outside::warning_badge(theme, unit)) {
        (Some(why), _) => (format!("{}  {}", icons::WARNING_CIRCLE, theme.format_text(&why)), palette.bad),
        (None, Some(badge)) => (badge.text().to_owned(), palette.bad),
        (None, None) if unit.moves.is_open() => (translate(theme, "hd_bar.in_control"), palette.good),
        (None, None) => (translate(theme, "hd_bar.watching"), palette.muted),
    };
    message_label(ui, theme, words, ink.into());
}

/// Draws the STOP button, which is disabled if it would have no effect.
fn stop_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let (palette, active) = (theme.palette, studio.can_stop_motion());
    let word = theme.translate("hd_bar.stop");
    let ink = if active { palette.on_bad } else { palette.muted };
    let text = RichText::new(format!("{}  {word}", icons::STOP)).font(theme.bold_font(theme.sizes.section)).color(ink);
    let button = egui::Button::new(text).fill(palette.bad).stroke(Stroke::new(1.0, palette.bad));
    let response = stop_button(ui, theme, active, button, STOP_BUTTON_SIZE)
        .on_hover_text(theme.translate("hd_bar.stop_hint"))
        .on_disabled_hover_text(translate(theme, "hd_bar.stop_without_control"));
    let pressed = press_began(ui, &response);
    if name(response, active, &word).clicked() || pressed {
        // A second press shortly after the first has the same meaning.
        register_stop_press(ui.ctx(), studio.is_requested_motion_running(), press_time(ui, pressed));
        actions.push(Action::StopMotion);
    }
}

fn drives(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let drives = unit.drives();
    if drives.len() < 2 {
        return;
    }
    ui.label(theme.label(translate(theme, "hd_bar.drive")));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        ui.spacing_mut().button_padding.x = 6.0;
        let moving = unit.moving_drives();
        for drive in drives {
            if drive_button_ui(ui, theme, unit, (drive, moving.contains(&drive))) {
                actions.push(Action::device(unit.session.id, Hiperdrive::SelectDrive(drive)));
            }
        }
    });
}

fn drive_button_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, (drive, moves): (DriveNumber, bool)) -> bool {
    let palette = theme.palette;
    let state = if moves { Some(State::Moving) } else { unit.polled_state(drive) };
    // All state symbols have the same width, so that no button moves when a drive changes its state.
    let (sign, colour) = match state {
        Some(State::Moving) => (icons::PLAY, palette.accent),
        Some(State::Fault) => (icons::WARNING_CIRCLE, palette.bad),
        Some(State::Locked) => (icons::LOCK_SIMPLE, palette.bad),
        Some(State::Enabled) => (icons::LIGHTNING, palette.good),
        Some(State::Operational | State::Ready) => (icons::PLUGS_CONNECTED, palette.muted),
        Some(State::NotReady) => (icons::PLUGS, palette.muted),
        None => (icons::QUESTION, palette.muted),
    };
    let words = state
        .map_or_else(|| translate(theme, "hd_bar.unknown"), |state| theme.format_text(&explain::state_text(state)));
    let name = TEXTS.text("hd_bar.named").with("drive", drive.get());
    let name = theme.format_text(&TEXTS.text("hd_bar.state").with_text("drive", name).with("state", words));
    let is_shown = drive == unit.drive();
    let ink = if is_shown { palette.text } else { palette.muted };
    let font = theme.bold_font(theme.sizes.body);
    let mut label = egui::text::LayoutJob::default();
    label.append(&drive.get().to_string(), 0.0, egui::TextFormat::simple(font.clone(), ink.into()));
    label.append(sign, 6.0, egui::TextFormat::simple(font, colour.into()));
    let response = ui.add(egui::Button::selectable(is_shown, label).frame_when_inactive(true)).on_hover_text(&name);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_shown, &name));
    response.clicked()
}
