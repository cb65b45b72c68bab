//! The room around a page of a tab, a page that scrolls as a whole, and widgets that stay the same whatever comes before them.

use egui::{AsIdSalt, Frame, Margin, ScrollArea, Ui, UiBuilder};

use super::Theme;

/// Width below which a page keeps less room at its sides.
const NARROW: f32 = 720.0;
/// Room above a page, and below it at most.
const ABOVE: i8 = 16;

/// The room at the sides of a page.
pub(crate) fn sides(ui: &Ui, theme: &Theme) -> i8 {
    let narrow = ui.available_width() < NARROW;
    (if narrow { theme.space.groups } else { theme.space.around }) as i8
}

/// The room around a page.
pub(crate) fn around(ui: &Ui, theme: &Theme) -> Margin {
    let sides = sides(ui, theme);
    Margin { left: sides, right: sides, top: ABOVE, bottom: sides.min(ABOVE) }
}

/// A page that scrolls as a whole; `id` tells it from the others.
pub fn scrolling(ui: &mut Ui, theme: &Theme, id: impl AsIdSalt, content: impl FnOnce(&mut Ui)) {
    let frame = Frame::NONE.inner_margin(around(ui, theme));
    ScrollArea::vertical().id_salt(id).auto_shrink(false).show(ui, |ui| frame.show(ui, content));
}

/// Draws widgets whose ids do not depend on what was drawn before them; `name` is unique in `ui`. Else each of them becomes
/// another one when something appears above or goes: it loses the keyboard, and a click between press and release.
pub(super) fn apart<R>(ui: &mut Ui, name: impl AsIdSalt, content: impl FnOnce(&mut Ui) -> R) -> R {
    let id = ui.scope_id().with(name);
    ui.scope_builder(UiBuilder::new().scope_id(id), content).inner
}
