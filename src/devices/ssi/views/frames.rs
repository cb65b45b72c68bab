//! The list of recorded frames in a search, decoded with the current layout.

use egui::{RichText, ScrollArea, Ui};

use crate::app::{Action, Rgb};
use crate::devices::ssi::protocol::Location;
use crate::devices::ssi::state::{Decoded, Encoder, SsiAction as Ssi, TEXTS, TrialInput};
use crate::devices::ssi::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{card, paragraph};

const VISIBLE_ROWS: f32 = 12.0;

/// Draws the list of frames. A click on a frame decodes it with the layout.
pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    (clocks, frames): (u8, &[u64]),
    actions: &mut Vec<Action>,
) {
    let layout = encoder.designer.layout();
    card(ui, theme, TEXTS.text("ssi_frames.title"), |ui| {
        if layout.clock_count() != clocks {
            let text = TEXTS.text("ssi_frames.other_clocks").with("bits", clocks).with("clocks", layout.clock_count());
            paragraph(ui, theme.caption(theme.format_text(&text)));
            return;
        }
        paragraph(ui, theme.caption(translate(theme, "ssi_frames.try")));
        let digits = usize::from(clocks).div_ceil(4);
        let names = ["ssi_frames.number", "ssi_frames.frame", "ssi_trial.position", "live.turns", "live.step"];
        let [number, frame, position, turns, steps] = names.map(|id| translate(theme, id));
        let heading = row(&[&number, &frame, &position, &turns, &steps], digits);
        ui.label(theme.monospace(heading).color(theme.palette.muted));
        let height = ui.text_style_height(&egui::TextStyle::Monospace) + 4.0;
        // The rows of the table provide no space around their buttons.
        let spacing = ui.spacing_mut();
        (spacing.item_spacing.y, spacing.interact_size.y, spacing.button_padding.y) = (0.0, height, 0.0);
        let seen = VISIBLE_ROWS * height;
        let area = ScrollArea::vertical().id_salt("frames").max_height(seen).min_scrolled_height(seen);
        area.auto_shrink([false, true]).show_rows(ui, height, frames.len(), |ui, rows| {
            for (index, frame) in frames.iter().enumerate().skip(rows.start).take(rows.len()) {
                let decoded = Decoded::decode(layout, *frame);
                let (words, colour) = decoded_summary(theme, index + 1, &decoded, digits);
                let text = RichText::new(words).monospace().color(colour);
                if ui.add(egui::Button::new(text).frame(false)).clicked() {
                    let bits = format!("0x{frame:X}");
                    actions.push(Action::device(encoder.session.id, Ssi::Try(TrialInput::Bits(bits))));
                }
            }
        });
    });
}

fn decoded_summary(theme: &Theme, number: usize, decoded: &Decoded, digits: usize) -> (String, Rgb) {
    let frame = format!("0x{:0digits$X}", decoded.frame);
    let (position, turns, steps) = match decoded.place {
        Some((position, Location::Shaft { turns, steps, .. })) => {
            (position.to_string(), turns.to_string(), steps.to_string())
        }
        Some((position, Location::Length { millimetres })) => {
            (position.to_string(), String::new(), format!("{} mm", theme.format_number(millimetres, 3)))
        }
        None => ("–".to_owned(), String::new(), String::new()),
    };
    let own = row(&[&number.to_string(), &frame, &position, &turns, &steps], digits);
    if decoded.is_valid {
        (own, theme.palette.text)
    } else {
        (format!("{own}  {}", theme.translate("live.invalid")), theme.palette.bad)
    }
}

/// Formats a row of the list, with right-aligned numbers in columns of fixed width.
fn row([number, frame, position, turns, steps]: &[&str; 5], digits: usize) -> String {
    let width = (digits + 2).max(8);
    format!("{number:>5}  {frame:<width$} {position:>10} {turns:>11} {steps:>9}")
}
