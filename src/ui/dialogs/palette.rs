//! The command palette, which finds actions and pages by name.

use egui::{Align, Key, Layout, Modifiers, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};

use crate::app::palette::match_score;
use crate::ui::Theme;
use crate::ui::commands::{Command, CommandEffect};
use crate::ui::controls::{modal, paragraph};
use crate::ui::entries::text_entry;

const DIALOG_WIDTH: f32 = 560.0;
const ROW_HEIGHT: f32 = 28.0;
const ROWS: usize = 11;
/// Width of the shortcut column, which fits *Ctrl+Shift+Z*.
const KEYS: f32 = 104.0;

/// State of the palette: the typed text, and the row selected for Enter.
#[derive(Default)]
pub(in crate::ui) struct PaletteUiState {
    typed: String,
    selected: usize,
}

pub(in crate::ui) fn palette_ui(
    ctx: &egui::Context,
    theme: &Theme,
    state: &mut PaletteUiState,
    commands: Vec<Command>,
) -> Option<CommandEffect> {
    let pressed = |key| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let steps =
        [(Key::ArrowDown, 1), (Key::ArrowUp, -1), (Key::PageDown, ROWS as isize), (Key::PageUp, -(ROWS as isize))];
    let step: isize = steps.into_iter().filter(|(key, _)| pressed(*key)).map(|(_, step)| step).sum();
    let enter = pressed(Key::Enter);
    modal(ctx, theme, "palette", DIALOG_WIDTH, |ui| {
        let hint = theme.translate("palette.hint");
        let entry = text_entry(ui, &mut state.typed, DIALOG_WIDTH, &hint, &hint);
        entry.request_focus();
        if entry.changed() {
            state.selected = 0;
        }
        let mut found = matching_commands(&state.typed, commands);
        state.selected = state.selected.saturating_add_signed(step).min(found.len().saturating_sub(1));
        ui.add_space(theme.space.between);
        let clicked = ui
            .allocate_ui(vec2(DIALOG_WIDTH, ROW_HEIGHT * ROWS as f32), |ui| {
                ui.set_min_height(ROW_HEIGHT * ROWS as f32);
                rows_ui(ui, theme, &found, state, step != 0)
            })
            .inner;
        let chosen = clicked.or(enter.then_some(state.selected)).filter(|at| *at < found.len())?;
        let command = found.swap_remove(chosen);
        command.is_enabled.then_some(command.effect)
    })
}

/// Returns the commands that match the typed text. Better matches come first, and unavailable commands come last.
fn matching_commands(typed: &str, commands: Vec<Command>) -> Vec<Command> {
    let fitting = commands.into_iter().filter_map(|command| {
        let fit = match_score(typed, &command.name)
            .or_else(|| Some(10 + match_score(typed, &format!("{} {}", command.about, command.name))?))
            .or_else(|| Some(20 + match_score(typed, &command.other_name)?))
            .or_else(|| Some(30 + match_score(typed, &format!("{} {}", command.about, command.other_name))?))?;
        Some((!command.is_enabled, fit, command))
    });
    let mut fitting: Vec<(bool, usize, Command)> = fitting.collect();
    fitting.sort_by_key(|(disabled, fit, _)| (*disabled, *fit));
    fitting.into_iter().map(|(_, _, command)| command).collect()
}

fn rows_ui(ui: &mut Ui, theme: &Theme, commands: &[Command], state: &PaletteUiState, scroll: bool) -> Option<usize> {
    if commands.is_empty() {
        paragraph(ui, theme.label(theme.translate("palette.none")));
        return None;
    }
    let mut clicked = None;
    ui.spacing_mut().item_spacing.y = 0.0;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        for (at, command) in commands.iter().enumerate() {
            let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
            let is_selected = at == state.selected;
            if is_selected && scroll {
                ui.scroll_to_rect(rect, None);
            }
            row_ui(ui, theme, rect, command, is_selected || response.hovered());
            let name = if command.about.is_empty() {
                command.name.clone()
            } else {
                format!("{}: {}", command.about, command.name)
            };
            response.widget_info(|| WidgetInfo::selected(egui::Role::Button, command.is_enabled, is_selected, &name));
            if response.clicked() {
                clicked = Some(at);
            }
        }
    });
    clicked
}

fn row_ui(ui: &mut Ui, theme: &Theme, rect: Rect, command: &Command, is_lit: bool) {
    let palette = theme.palette;
    if is_lit {
        ui.painter().rect_filled(rect, 4.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let inner = rect.shrink2(vec2(theme.space.between, 0.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner).layout(Layout::right_to_left(Align::Center)), |ui| {
        ui.spacing_mut().item_spacing.x = theme.space.between;
        // The keys have a separate column, so the names of the devices are aligned.
        ui.allocate_ui_with_layout(vec2(KEYS, ROW_HEIGHT), Layout::right_to_left(Align::Center), |ui| {
            ui.set_min_width(KEYS);
            if let Some(keys) = command.shortcut {
                ui.label(theme.monospace(ui.ctx().format_shortcut(&keys)).color(palette.muted));
            }
        });
        ui.label(theme.caption(&command.about));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let ink = if command.is_enabled { palette.text } else { palette.muted };
            ui.add(egui::Label::new(RichText::new(&command.name).color(ink)).truncate().selectable(false));
        });
    });
}
