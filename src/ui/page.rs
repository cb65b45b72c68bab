//! The margins of a page, scrolling of a whole page, and widgets with stable ids.

use egui::{AsIdSalt, Frame, Margin, ScrollArea, Ui, UiBuilder};

use super::Theme;

const NARROW_WIDTH: f32 = 720.0;
/// Space above a page, and maximum space below it.
const PAGE_TOP_MARGIN: i8 = 16;

pub(crate) fn side_margin(ui: &Ui, theme: &Theme) -> i8 {
    let narrow = ui.available_width() < NARROW_WIDTH;
    (if narrow { theme.space.groups } else { theme.space.around }) as i8
}

pub(crate) fn page_margin(ui: &Ui, theme: &Theme) -> Margin {
    let sides = side_margin(ui, theme);
    Margin { left: sides, right: sides, top: PAGE_TOP_MARGIN, bottom: sides.min(PAGE_TOP_MARGIN) }
}

/// Draws a page that scrolls as a whole. `id` must differ from the ids of other pages. The scroll bar is in the margin,
/// so nothing moves when it appears.
pub fn scrollable_page(ui: &mut Ui, theme: &Theme, id: impl AsIdSalt, content: impl FnOnce(&mut Ui)) {
    let frame = Frame::NONE.inner_margin(page_margin(ui, theme));
    ui.scope(|ui| {
        let inside = std::mem::take(&mut ui.spacing_mut().scroll.floating_allocated_width);
        ScrollArea::vertical().id_salt(id).auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().scroll.floating_allocated_width = inside;
            frame.show(ui, content)
        });
    });
}

/// Draws widgets whose ids do not depend on the widgets drawn before them. `name` must be unique in `ui`. Otherwise, a
/// widget that appears or disappears above would change their ids, which would lose the keyboard focus and clicks in
/// progress.
pub(super) fn with_stable_ids<R>(ui: &mut Ui, name: impl AsIdSalt, content: impl FnOnce(&mut Ui) -> R) -> R {
    let id = ui.scope_id().with(name);
    ui.scope_builder(UiBuilder::new().scope_id(id), content).inner
}
