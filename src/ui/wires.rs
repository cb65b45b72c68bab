//! Wires or pins of an encoder, a line each with what is on it.

use egui::Ui;

use super::Skin;
use super::controls::paragraph;

/// Draws them; their names stand in a column of this width.
pub(super) fn wires_ui(ui: &mut Ui, skin: &Skin, width: f32, wires: &[(&str, &'static str)]) {
    for (wire, words) in wires {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            let name = ui.label(skin.mono(*wire));
            ui.add_space((width - name.rect.width()).max(0.0));
            paragraph(ui, skin.label(skin.say(words)));
        });
    }
}
