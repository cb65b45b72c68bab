//! The header: the selected session, its status, the actions that are always available, and STOP.

use egui::{RichText, Stroke, Ui};

use super::controls::{badge, connection_dot, enabled_button, icon_button, labelled_button, name, stop_button};
use super::page::with_stable_ids;
use super::stop_debounce::{press_began, press_time, register_stop_press};
use super::{Theme, Views, icons};
use crate::app::session::{Phase, Source};
use crate::app::{
    Action, AnyDevice, ColorScheme, CompanyAction, ComparisonAction, DeviceCommand, Language, LibraryAction, Studio,
    Text, connect,
};

/// Width of the STOP button in points while no motion is in progress.
const STOP_BUTTON_WIDTH: f32 = 72.0;

pub(super) fn header_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    ui.horizontal_centered(|ui| {
        sessions_ui(ui, theme, studio, actions);
        if let Some(device) = studio.selected_device() {
            let motion = views.tabs.device(device.tab()).and_then(|view| view.motion(device));
            status_ui(ui, theme, device, motion);
        }
        // The tools are drawn from left to right, which is also their Tab order. Their width is known from the previous
        // frame.
        let width_id = ui.scope_id().with("tools");
        let width = ui.data(|data| data.get_temp::<f32>(width_id)).unwrap_or(0.0);
        let room = (ui.available_width() - width - ui.spacing().item_spacing.x).max(0.0);
        ui.allocate_ui_with_layout(
            egui::vec2(room, ui.available_height()),
            egui::Layout::right_to_left(egui::Align::Center),
            |ui| {
                ui.set_min_width((room - ui.spacing().item_spacing.x).max(0.0));
                if room > 80.0 {
                    link_ui(ui, theme, studio);
                }
            },
        );
        let tools = with_stable_ids(ui, "tools", |ui| {
            tools_ui(ui, theme, studio, views, actions);
            ui.min_rect().width()
        });
        if (tools - width).abs() > 0.5 {
            ui.data_mut(|data| data.insert_temp(width_id, tools));
            ui.ctx().request_repaint();
        }
    });
}

fn tools_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    // In a narrow window, only icons are drawn, with their texts as tooltips. The STOP button of double width takes
    // more space.
    let narrow = ui.ctx().content_rect().width() < if shows_stop_overlay(studio) { 1240.0 } else { 1100.0 };
    let tool = |ui: &mut Ui, enabled: bool, icon: &str, id: &'static str| {
        let word = theme.translate(id);
        if narrow { icon_button(ui, enabled, icon, &word) } else { enabled_button(ui, enabled, icon, &word) }
    };
    if tool(ui, true, icons::FOLDER_OPEN, "shell.open").clicked() {
        actions.push(Action::AskOpen);
    }
    if icon_button(ui, true, icons::FILE_TEXT, &theme.translate("shell.profiles")).clicked() {
        actions.push(Action::Library(LibraryAction::Open));
    }
    let savable = studio.selected_device().is_some_and(AnyDevice::is_savable);
    if tool(ui, savable, icons::FLOPPY_DISK, "shell.save").on_hover_text(theme.translate("shell.save_hint")).clicked() {
        actions.extend(studio.selected_device().map(|own| Action::Save(own.id())));
    }
    let shown = studio.selected_device();
    let restorable = shown.is_some_and(|own| own.is_ready() && own.has_memory());
    if icon_button(ui, restorable, icons::CLOCK_COUNTER_CLOCKWISE, &theme.translate("shell.restore")).clicked() {
        actions.extend(shown.map(|own| own.command(DeviceCommand::AskRestore)));
    }
    let comparable = shown.is_none_or(AnyDevice::is_comparable);
    if icon_button(ui, comparable, icons::ARROWS_OUT_LINE_HORIZONTAL, &theme.translate("shell.compare")).clicked() {
        let open = Action::Comparison(ComparisonAction::Open { left: None, right: None });
        actions.push(shown.map_or(open, |own| own.command(DeviceCommand::AskCompare)));
    }
    if tool(ui, true, icons::PLUGS_CONNECTED, "shell.connect").clicked() {
        actions.push(Action::Connect(connect::ConnectAction::Open));
    }
    stop_button_ui(ui, theme, studio, actions);
    let settings = &studio.settings;
    let (other, other_code) = match settings.language {
        Language::English => (Language::German, "DE"),
        Language::German => (Language::English, "EN"),
    };
    let response = ui.button(other_code).on_hover_text(theme.translate("shell.language"));
    if name(response, true, &theme.translate("shell.language")).clicked() {
        actions.push(Action::SetLanguage(other));
    }
    let (theme_icon, other) = match settings.theme {
        ColorScheme::Dark => (icons::SUN, ColorScheme::Light),
        ColorScheme::Light => (icons::MOON, ColorScheme::Dark),
    };
    let theme_word = match other {
        ColorScheme::Light => "shell.light",
        ColorScheme::Dark => "shell.dark",
    };
    if icon_button(ui, true, theme_icon, &theme.translate(theme_word)).clicked() {
        actions.push(Action::SetTheme(other));
    }
    if icon_button(ui, true, icons::QUESTION, &theme.translate("shell.help")).clicked() {
        views.help = !views.help;
    }
    if icon_button(ui, true, icons::INFO, &theme.translate("shell.about")).clicked() {
        views.about = true;
    }
}

/// Draws the menu of sessions, which opens from the name of the selected session.
fn sessions_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let shown = studio.selected_device().map_or_else(|| theme.translate("shell.no_session"), AnyDevice::name);
    let most = if ui.ctx().content_rect().width() < 1200.0 { 21 } else { 28 };
    let text = RichText::new(format!("{}  {}", shortened_text(&shown, most), icons::CARET_DOWN))
        .font(theme.bold_font(theme.sizes.section));
    let menu = ui.menu_button(text, |ui| {
        ui.set_width(320.0);
        ui.label(theme.caption(theme.translate("shell.sessions")));
        for device in studio.devices() {
            ui.horizontal(|ui| {
                phase_dot_ui(ui, theme, device.as_ref());
                let is_shown = studio.selected_device().is_some_and(|own| own.id() == device.id());
                if ui.selectable_label(is_shown, device.name()).clicked() {
                    actions.push(Action::Select(device.id()));
                    ui.close();
                }
                if device.is_dirty() {
                    ui.label(RichText::new(icons::PENCIL_SIMPLE).color(theme.palette.staged));
                }
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if icon_button(ui, true, icons::X, &theme.translate("shell.close_session")).clicked() {
                        actions.push(Action::CloseSession(device.id()));
                        ui.close();
                    }
                });
            });
        }
        ui.separator();
        if let Some(device) = studio.selected_device() {
            let restorable = device.is_ready() && device.has_memory();
            let entries = [
                (device.is_readable(), icons::ARROW_CLOCKWISE, "palette.read_again", DeviceCommand::Read),
                (device.is_savable(), icons::FLOPPY_DISK, "profile_card.save_as", DeviceCommand::AskSave),
                (restorable, icons::CLOCK_COUNTER_CLOCKWISE, "shell.restore", DeviceCommand::AskRestore),
                (device.is_comparable(), icons::ARROWS_OUT_LINE_HORIZONTAL, "shell.compare", DeviceCommand::AskCompare),
                (device.is_comparable(), icons::FILE_TEXT, "shell.report", DeviceCommand::AskReport),
            ];
            for (enabled, icon, word, command) in entries {
                if enabled_button(ui, enabled, icon, &theme.translate(word)).clicked() {
                    actions.push(device.command(command));
                    ui.close();
                }
            }
            ui.separator();
        }
        if labelled_button(ui, icons::PENCIL_SIMPLE, &theme.translate("shell.company")).clicked() {
            actions.push(Action::Company(CompanyAction::Open));
            ui.close();
        }
        if labelled_button(ui, icons::PLUGS_CONNECTED, &theme.translate("shell.connect")).clicked() {
            actions.push(Action::Connect(connect::ConnectAction::Open));
            ui.close();
        }
    });
    name(menu.response, true, &theme.translate("shell.sessions"));
}

/// Shortens a name for the header. The serial number is kept, because it distinguishes devices of the same kind.
fn shortened_text(name: &str, most: usize) -> String {
    let cut = |text: &str, most: usize| match text.chars().count() {
        count if count <= most => text.to_owned(),
        _ => text.chars().take(most.saturating_sub(1)).chain(['…']).collect(),
    };
    match name.rsplit_once(" · ") {
        Some((kind, serial)) if serial.chars().count() + 8 < most => {
            format!("{} · {serial}", cut(kind, most - 3 - serial.chars().count()))
        }
        _ => cut(name, most),
    }
}

fn phase_dot_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice) {
    let palette = theme.palette;
    let (filled, colour) = match device.phase() {
        Phase::Connected => (true, palette.good),
        Phase::Opening => (false, palette.accent),
        Phase::Lost(_) | Phase::Silent(_) => (false, palette.bad),
        Phase::Offline => (false, palette.muted),
    };
    connection_dot(ui, filled, colour);
}

/// Draws the status as one word: *virtual*, *offline*, *connected*, *moving* or *lost*.
fn status_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, motion: Option<Text>) {
    let palette = theme.palette;
    if device.is_virtual() {
        badge(ui, theme, &theme.translate("shell.virtual"), palette.warn);
    }
    phase_dot_ui(ui, theme, device);
    let (text, colour) = match (device.phase(), motion) {
        (Phase::Connected, Some(motion)) => (motion, palette.bad),
        (Phase::Connected, None) if device.is_writing() => (Text::new("shell.writing"), palette.accent),
        (Phase::Connected, None) => (Text::new("shell.connected"), palette.good),
        (Phase::Opening, _) => (Text::new("shell.opening"), palette.accent),
        (Phase::Lost(_), _) => (Text::new("shell.lost"), palette.bad),
        (Phase::Silent(_), _) => (Text::new("shell.silent"), palette.bad),
        (Phase::Offline, _) if is_read_only(device) => (Text::new("shell.read_only"), palette.warn),
        (Phase::Offline, _) => (Text::new("shell.offline"), palette.muted),
    };
    ui.label(RichText::new(theme.format_text(&text)).color(colour));
}

/// Returns whether the profile has a newer schema, so it can be neither saved nor written.
fn is_read_only(device: &AnyDevice) -> bool {
    matches!(device.source(), Source::File { document, .. } if document.is_newer())
}

fn link_ui(ui: &mut Ui, theme: &Theme, studio: &Studio) {
    let Some(device) = studio.selected_device() else { return };
    let words = device.data_source();
    let label =
        egui::Label::new(theme.monospace(&words).color(theme.palette.muted)).truncate().sense(egui::Sense::click());
    let hint = format!("{words}\n{}", theme.translate("shell.copy_link"));
    if ui.add(label).on_hover_text(hint).clicked() {
        ui.copy_text(words);
    }
}

/// Draws the STOP button. The button ends every running job and every motion in all sessions. While this window moves a
/// drive, the button is twice as wide, acts on press instead of release, and ends only motion. The tooltip states what
/// a press would stop.
fn stop_button_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let (moves, by_hand) = (shows_stop_overlay(studio), studio.is_requested_motion_running());
    let active = studio.can_stop_motion() || studio.can_stop();
    // Live values alone are no reason for an alarm.
    let is_alarming = moves || studio.is_working() || studio.has_control();
    let (word, hint) = match (studio.has_drives(), by_hand) {
        (true, true) => ("hd_bar.stop", "shell.stop_motion_hint"),
        (true, false) => ("hd_bar.stop", "shell.stop_all_hint"),
        (false, _) => ("shell.stop", "shell.stop_hint"),
    };
    let (word, hint) = (theme.translate(word), theme.translate(hint));
    let text = format!("{}  {word}", icons::STOP);
    let palette = theme.palette;
    let stop = if active && !is_alarming {
        egui::Button::new(text)
    } else if active {
        egui::Button::new(RichText::new(text).color(palette.on_bad))
            .fill(palette.bad)
            .stroke(Stroke::new(1.0, palette.bad))
    } else {
        egui::Button::new(RichText::new(text).color(palette.muted))
    };
    let width = if moves { STOP_BUTTON_WIDTH * 2.0 } else { STOP_BUTTON_WIDTH };
    let response = stop_button(ui, theme, active, stop, egui::vec2(width, 0.0)).on_hover_text(hint);
    ui.data_mut(|data| data.insert_temp(stop_button_id(), response.rect.min));
    let pressed = press_began(ui, &response);
    let clicked = name(response, active, &word).clicked();
    if clicked || pressed && by_hand {
        // The display of a drive continues while the drive is stopped. All other running jobs continue too.
        let motion = register_stop_press(ui.ctx(), by_hand, press_time(ui, pressed));
        actions.push(if motion { Action::StopMotion } else { Action::Stop });
    }
}

/// Returns whether this window can stop a drive that is moving.
fn shows_stop_overlay(studio: &Studio) -> bool {
    studio.is_moving() && studio.can_stop_motion()
}

/// Draws the STOP button in its usual position while a drive moves, on top of anything that covers the window.
pub(super) fn stop_overlay_ui(ctx: &egui::Context, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    if !shows_stop_overlay(studio) || ctx.memory(|memory| memory.top_modal_layer().is_none()) {
        return;
    }
    let Some(place) = ctx.data(|data| data.get_temp::<egui::Pos2>(stop_button_id())) else { return };
    let area = egui::Area::new(egui::Id::unique("stop over dialogs")).order(egui::Order::Tooltip).fixed_pos(place);
    area.constrain(false).show(ctx, |ui| ui.horizontal(|ui| stop_button_ui(ui, theme, studio, actions)));
}

fn stop_button_id() -> egui::Id {
    egui::Id::unique("place of stop")
}
