//! The bar above every page: the drives of a hub, the control, STOP and the note that it is no emergency stop.

use egui::{RichText, Stroke, Ui, vec2};

use super::outside;
use crate::app::{Action, Studio};
use crate::devices::hiperdrive::protocol::{DriveNumber, State};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, TEXTS, Unit, explain};
use crate::devices::hiperdrive::views::say;
use crate::ui::controls::{allowed_button, name, paragraph};
use crate::ui::stop_debounce::{goes_down, means_motion, pressed_at};
use crate::ui::{Theme, icons};

/// Size of STOP: wide enough for a flat hand.
const STOP: egui::Vec2 = vec2(112.0, 44.0);

pub(super) fn bar_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, unit: &Unit, actions: &mut Vec<Action>) {
    let id = unit.session.id;
    ui.horizontal_top(|ui| {
        stop(ui, theme, (unit.moves.is_open(), studio.moves_by_hand()), actions);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = theme.space.inside;
            ui.horizontal_wrapped(|ui| {
                drives(ui, theme, unit, actions);
                if unit.moves.is_open() {
                    let word = say(theme, "hd_bar.give");
                    if allowed_button(ui, theme, &unit.can_give(), icons::PLUGS, &word).clicked() {
                        actions.push(Action::device(id, Hiperdrive::Give));
                    }
                    let well = || RichText::new(say(theme, "hd_bar.in_control")).color(theme.palette.good);
                    ui.label(outside::badge(theme, unit).unwrap_or_else(well));
                } else {
                    let word = say(theme, "hd_bar.take");
                    if allowed_button(ui, theme, &unit.can_take(), icons::PLUGS_CONNECTED, &word).clicked() {
                        actions.push(Action::device(id, Hiperdrive::Take));
                    }
                    let watching = || theme.label(say(theme, "hd_bar.watching"));
                    ui.label(outside::badge(theme, unit).unwrap_or_else(watching));
                }
            });
            if let Some(why) = unit.why_lost() {
                let words = format!("{}  {}", icons::WARNING_CIRCLE, theme.words(&why));
                paragraph(ui, RichText::new(words).color(theme.palette.bad));
            }
            paragraph(ui, theme.caption(format!("{}  {}", icons::WARNING, say(theme, "hd_bar.stop_is_not"))));
        });
    });
}

/// Draws STOP for all drives; also while none is known to move.
fn stop(ui: &mut Ui, theme: &Theme, (open, moves): (bool, bool), actions: &mut Vec<Action>) {
    let palette = theme.palette;
    let word = theme.say("hd_bar.stop");
    let (ink, fill) = if open { (palette.on_bad, palette.bad) } else { (palette.muted, palette.raised) };
    let text = RichText::new(format!("{}  {word}", icons::STOP)).font(theme.strong(theme.sizes.section)).color(ink);
    let edge = if open { Stroke::NONE } else { Stroke::new(1.0, palette.bad) };
    let button = egui::Button::new(text).fill(fill).stroke(edge);
    // Pressing down counts: a stop does not wait for the release.
    let response = ui.add_sized(STOP, button).on_hover_text(theme.say("hd_bar.stop_hint"));
    let pressed = goes_down(ui, &response);
    if name(response, true, &word).clicked() || pressed {
        // A second press shortly after the first has the same meaning.
        means_motion(ui.ctx(), moves, pressed_at(ui, pressed));
        actions.push(Action::StopMotion);
    }
}

/// Draws the drives of a hub; nothing for an adapter, which has only one.
fn drives(ui: &mut Ui, theme: &Theme, unit: &Unit, actions: &mut Vec<Action>) {
    let drives = unit.drives();
    if drives.len() < 2 {
        return;
    }
    ui.label(theme.label(say(theme, "hd_bar.drive")));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        ui.spacing_mut().button_padding.x = 6.0;
        let moving = unit.moving_drives();
        for drive in drives {
            if drive_button(ui, theme, unit, (drive, moving.contains(&drive))) {
                actions.push(Action::device(unit.session.id, Hiperdrive::SelectDrive(drive)));
            }
        }
    });
}

/// Draws a drive with its state, as a sign and as text.
fn drive_button(ui: &mut Ui, theme: &Theme, unit: &Unit, (drive, moves): (DriveNumber, bool)) -> bool {
    let palette = theme.palette;
    let state = if moves { Some(State::Moving) } else { unit.state_now(drive) };
    // All signs have the same width: no button moves when a drive changes its state.
    let (sign, colour) = match state {
        Some(State::Moving) => (icons::PLAY, palette.accent),
        Some(State::Fault) => (icons::WARNING_CIRCLE, palette.bad),
        Some(State::Locked) => (icons::LOCK_SIMPLE, palette.bad),
        Some(State::Enabled) => (icons::LIGHTNING, palette.good),
        Some(State::Operational | State::Ready) => (icons::PLUGS_CONNECTED, palette.muted),
        Some(State::NotReady) => (icons::PLUGS, palette.muted),
        None => (icons::QUESTION, palette.muted),
    };
    let words = state.map_or_else(|| say(theme, "hd_bar.unknown"), |state| theme.words(&explain::state(state)));
    let name = TEXTS.text("hd_bar.named").with("drive", drive.get());
    let name = theme.words(&TEXTS.text("hd_bar.state").with_text("drive", name).with("state", words));
    let is_shown = drive == unit.drive();
    let ink = if is_shown { palette.text } else { palette.muted };
    let font = theme.strong(theme.sizes.body);
    let mut label = egui::text::LayoutJob::default();
    label.append(&drive.get().to_string(), 0.0, egui::TextFormat::simple(font.clone(), ink.into()));
    label.append(sign, 6.0, egui::TextFormat::simple(font, colour.into()));
    let response = ui.add(egui::Button::selectable(is_shown, label).frame_when_inactive(true)).on_hover_text(&name);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_shown, &name));
    response.clicked()
}
