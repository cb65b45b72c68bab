//! Where the drive that is shown is, large.

use egui::{RichText, Ui};

use crate::app::Rgb;
use crate::app::hiperdrive::Unit;
use crate::ui::Skin;

pub(super) fn value_ui(ui: &mut Ui, skin: &Skin, unit: &Unit, ink: Rgb) {
    let place = unit.actual(unit.drive()).map(|own| unit.place(unit.drive(), own.position));
    let words = place.map_or_else(|| "–".to_owned(), |place| skin.words(&place));
    ui.label(RichText::new(words).font(egui::FontId::monospace(skin.sizes.live)).color(ink));
}
