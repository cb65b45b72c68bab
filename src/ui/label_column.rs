//! Rows that consist of a label and a value or an entry. The label column of a card is as wide as its longest label.

use egui::{Id, RichText, Ui, vec2};

use super::Theme;

/// Default width of the label column. A longer label widens it.
const DEFAULT_LABEL_WIDTH: f32 = 132.0;
/// Maximum width of the label column as a fraction of the card width. The first value is the default, and the second is
/// for long labels.
const MAX_LABEL_WIDTH_FRACTIONS: (f32, f32) = (0.4, 0.55);

#[derive(Clone, Copy, Default)]
struct LabelColumn {
    /// Width of the longest label drawn in previous frames.
    longest: f32,
    /// Width of the longest label drawn so far in the current frame.
    drawn: f32,
}

impl LabelColumn {
    fn id() -> Id {
        Id::unique("column of labels")
    }

    fn load(ui: &Ui) -> Self {
        ui.data(|data| data.get_temp(Self::id())).unwrap_or_default()
    }

    fn store(self, ui: &Ui) {
        ui.data_mut(|data| data.insert_temp(Self::id(), self));
    }
}

/// Draws the content of the card with the given heading. The label column is wide enough for the longest label.
pub(crate) fn with_label_column<R>(ui: &mut Ui, heading: &str, content: impl FnOnce(&mut Ui) -> R) -> R {
    let (outer, id) = (LabelColumn::load(ui), ui.scope_id().with((LabelColumn::id(), heading)));
    let longest = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    LabelColumn { longest, drawn: 0.0 }.store(ui);
    let result = content(ui);
    let LabelColumn { drawn, .. } = LabelColumn::load(ui);
    // The column never becomes narrower. Cards with the same heading may alternate, and a row that appears and
    // disappears must not move the others.
    if drawn > longest {
        ui.data_mut(|data| data.insert_temp(id, drawn));
        // The content is drawn again in the next frame, because input would count twice in this one.
        ui.ctx().request_repaint();
    }
    outer.store(ui);
    result
}

pub(crate) fn label_width(ui: &Ui) -> f32 {
    let (usual, most) = MAX_LABEL_WIDTH_FRACTIONS;
    let room = ui.available_width().max(0.0);
    DEFAULT_LABEL_WIDTH.min(room * usual).max(LabelColumn::load(ui).longest.min(room * most))
}

pub fn row(ui: &mut Ui, theme: &Theme, label: &str, value: impl Into<RichText>) {
    ui.scope(|ui| {
        // Read-only rows can be closer together than controls.
        ui.spacing_mut().interact_size.y = 20.0;
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        ui.horizontal_top(|ui| {
            label_ui(ui, theme, label);
            ui.add(egui::Label::new(value.into()).selectable(true).wrap());
        });
    });
}

pub fn entry<R>(ui: &mut Ui, theme: &Theme, label: &str, content: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        label_ui(ui, theme, label);
        content(ui)
    })
    .inner
}

fn label_ui(ui: &mut Ui, theme: &Theme, label: &str) {
    let width = label_width(ui);
    let text = egui::WidgetText::from(theme.label(label));
    let galley = text.clone().into_galley(ui, Some(egui::TextWrapMode::Extend), f32::INFINITY, egui::TextStyle::Body);
    let column = LabelColumn::load(ui);
    LabelColumn { drawn: column.drawn.max(galley.size().x.ceil()), ..column }.store(ui);
    ui.allocate_ui_with_layout(vec2(width, 18.0), egui::Layout::left_to_right(egui::Align::Min), |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(text).truncate());
    });
}
