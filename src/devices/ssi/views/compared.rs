//! The frames of two layouts as strips, one below the other.

use egui::Ui;

use super::widgets::{BitStrip, bit_strip};
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::Layout;
use crate::devices::ssi::state::strip::Strip;
use crate::ui::Theme;

pub(super) fn frames_ui(ui: &mut Ui, theme: &Theme, left: &SsiProfile, right: &SsiProfile) {
    for (id, profile) in [("comparison.left", left), ("comparison.right", right)] {
        // A profile with an invalid frame cannot be opened.
        let Ok(layout) = Layout::new(profile.descriptor.clone()) else { continue };
        let (label, strip) = (theme.translate(id), Strip::from_layout(&layout));
        ui.label(theme.heading(&label));
        ui.add_space(theme.space.inside);
        let model = BitStrip {
            label: &label,
            strip: &strip,
            frame: None,
            selected: None,
            toggles: false,
            movable: false,
            following: false,
        };
        ui.push_id(id, |ui| bit_strip(ui, theme, &model));
        theme.add_gap(ui);
    }
}
