//! Cards: framed groups with a heading.

use egui::{Button, Id, RichText, Role, Ui, WidgetInfo};

use super::controls::fill_width;
use super::label_column::with_label_column;
use super::{Theme, icons};
use crate::app::Text;

/// Window height in points below which collapsible cards are initially closed.
const LOW_WINDOW_HEIGHT: f32 = 720.0;

pub fn card<R>(ui: &mut Ui, theme: &Theme, title: impl Into<Text>, content: impl FnOnce(&mut Ui) -> R) -> R {
    card_with_trailing(ui, theme, title, |_| {}, content)
}

/// Draws a card with a heading. `aside` is drawn to the right of the heading, or below it if there is not enough room.
pub(crate) fn card_with_trailing<R>(
    ui: &mut Ui,
    theme: &Theme,
    title: impl Into<Text>,
    aside: impl FnOnce(&mut Ui),
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    let heading = theme.format_text(&title.into());
    theme
        .card_frame()
        .show(ui, |ui| {
            fill_width(ui);
            heading_ui(ui, theme, &heading, aside);
            ui.add_space(theme.space.inside);
            with_label_column(ui, &heading, content)
        })
        .inner
}

/// Draws a card's heading with `aside` to the right, or below if both do not fit on one line. The required width is
/// measured in an earlier frame.
fn heading_ui(ui: &mut Ui, theme: &Theme, heading: &str, aside: impl FnOnce(&mut Ui)) {
    let id = ui.scope_id().with("aside_below").with(heading);
    let width = ui.available_width();
    let is_narrow = ui.data(|data| data.get_temp::<f32>(id)).is_some_and(|too_small| width <= too_small);
    let to_the_right = egui::Layout::right_to_left(egui::Align::Center);
    if is_narrow {
        ui.horizontal(|ui| ui.label(theme.heading(heading)));
        ui.horizontal(|ui| ui.with_layout(to_the_right, aside));
        return;
    }
    ui.horizontal(|ui| {
        ui.label(theme.heading(heading));
        let least = ui.cursor().left();
        if ui.with_layout(to_the_right, aside).response.rect.left() < least - 0.5 {
            ui.data_mut(|data| data.insert_temp(id, width));
            ui.ctx().request_repaint();
        }
    });
}

/// Draws a heading that opens or closes its section. Returns whether it was clicked.
pub(crate) fn disclosure(ui: &mut Ui, heading: RichText, is_open: &mut bool) -> bool {
    let icon = if *is_open { icons::CARET_DOWN } else { icons::CARET_RIGHT };
    let word = heading.text().to_owned();
    let response = ui.add(Button::new((icon, heading)).frame(false));
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, *is_open, &word));
    let is_clicked = response.clicked();
    if is_clicked {
        *is_open = !*is_open;
    }
    is_clicked
}

/// Draws a card with reference information. In a low window, the card initially shows only its heading. A click opens
/// the card, which stays open until the program ends.
pub(crate) fn folding_card(ui: &mut Ui, theme: &Theme, title: impl Into<Text>, content: impl FnOnce(&mut Ui)) {
    folding_card_with_trailing(ui, theme, title, |_| {}, content);
}

/// Draws a [`folding_card`]. While the card is open, `aside` is drawn to the right of the heading.
pub(crate) fn folding_card_with_trailing(
    ui: &mut Ui,
    theme: &Theme,
    title: impl Into<Text>,
    aside: impl FnOnce(&mut Ui),
    content: impl FnOnce(&mut Ui),
) {
    let title = title.into();
    if ui.ctx().content_rect().height() >= LOW_WINDOW_HEIGHT {
        return card_with_trailing(ui, theme, title, aside, content);
    }
    let heading = theme.format_text(&title);
    let id = Id::unique("folding_card").with(title.id());
    theme.card_frame().show(ui, |ui| {
        fill_width(ui);
        let mut is_open = ui.data(|data| data.get_temp(id)).unwrap_or(false);
        ui.horizontal(|ui| {
            if disclosure(ui, theme.heading(heading.clone()), &mut is_open) {
                ui.data_mut(|data| data.insert_temp(id, is_open));
            }
            if is_open {
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), aside);
            }
        });
        if is_open {
            ui.add_space(theme.space.inside);
            with_label_column(ui, &heading, content);
        }
    });
}
