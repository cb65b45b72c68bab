//! The room around a page of a tab, and a page that scrolls as a whole.

use egui::{AsIdSalt, Frame, Margin, ScrollArea, Ui};

use super::Skin;

/// Width below which a page keeps less room at its sides.
const NARROW: f32 = 720.0;
/// Room above a page, and below it at most.
const ABOVE: i8 = 16;

/// The room at the sides of a page.
pub(super) fn sides(ui: &Ui, skin: &Skin) -> i8 {
    let narrow = ui.available_width() < NARROW;
    (if narrow { skin.space.groups } else { skin.space.around }) as i8
}

/// The room around a page.
pub(super) fn around(ui: &Ui, skin: &Skin) -> Margin {
    let sides = sides(ui, skin);
    Margin { left: sides, right: sides, top: ABOVE, bottom: sides.min(ABOVE) }
}

/// A page that scrolls as a whole; `id` tells it from the others.
pub(super) fn scrolling(ui: &mut Ui, skin: &Skin, id: impl AsIdSalt, content: impl FnOnce(&mut Ui)) {
    let frame = Frame::NONE.inner_margin(around(ui, skin));
    ScrollArea::vertical().id_salt(id).auto_shrink(false).show(ui, |ui| frame.show(ui, content));
}
