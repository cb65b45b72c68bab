//! Tests that operate the widgets as a user does: through accessible labels, keys and the pointer.

use egui::{Key, Modifiers, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::app::{ColorScheme, Language, ThemeData};
use crate::ui::{Theme, install_fonts};

mod field_map;
mod frame_strip;
mod hex_editor;
mod hold_button;
mod register_table;
mod steps;
mod typed_view;

pub(crate) fn theme() -> Theme {
    Theme::new(ThemeData::built_in().unwrap(), ColorScheme::Dark, Language::English)
}

/// Creates a window with a widget between two buttons.
pub(crate) fn window<State>(
    state: State,
    draw: impl Fn(&mut egui::Ui, &mut State) + 'static,
) -> Harness<'static, State> {
    let mut harness = Harness::builder()
        .with_size(Vec2::new(900.0, 500.0))
        .with_context_setup(|ctx| {
            install_fonts(ctx);
            theme().apply_to(ctx);
        })
        // A double click consists of two clicks within a third of a second.
        .with_step_dt(0.02)
        .build_ui_state(
            move |ui, state| {
                let _ = ui.button("before");
                draw(ui, state);
                let _ = ui.button("behind");
            },
            state,
        );
    harness.run();
    harness
}

/// Presses keys one after the other.
pub(crate) fn press<State>(harness: &mut Harness<'_, State>, keys: &[(Modifiers, Key)]) {
    for (modifiers, key) in keys {
        harness.key_press_modifiers(*modifiers, *key);
        harness.run();
    }
}

/// Moves the keyboard focus to a widget.
pub(crate) fn focus<State>(harness: &mut Harness<'_, State>, label: &str) {
    harness.get_by_label(label).focus();
    harness.run();
}

pub(crate) const NONE: Modifiers = Modifiers::NONE;
pub(crate) const SHIFT: Modifiers = Modifiers::SHIFT;
pub(crate) const CTRL: Modifiers = Modifiers::COMMAND;
