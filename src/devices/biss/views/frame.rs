//! The latest single-cycle frame: one cell per bit, and the meaning of its fields.

use egui::Ui;

use crate::analysis::quality::Verdict;
use crate::app::{Action, DeviceCommand};
use crate::devices::biss::procedures::PositionReading;
use crate::devices::biss::protocol::{Layout, PositionData};
use crate::devices::biss::state::{Encoder, TEXTS};
use crate::devices::biss::views::translate;
use crate::ui::controls::{enabled_button, folding_card_with_trailing, paragraph, row};
use crate::ui::widgets::{FrameStrip, StripField, frame_strip};
use crate::ui::{Theme, icons};

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(identity) = encoder.identity() else { return };
    let read = |ui: &mut Ui| {
        let ready = encoder.session.is_ready();
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "frame_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::ReadPosition));
        }
    };
    folding_card_with_trailing(ui, theme, TEXTS.text("frame_card.title"), read, |ui| {
        let reading = encoder.record.last();
        let (fields, bits) = frame_fields(theme, &identity.layout, reading);
        let label = translate(theme, "frame_card.title");
        frame_strip(ui, theme, &FrameStrip { label: &label, fields: &fields, bits: &bits });
        if let Some(reading) = reading {
            row(ui, theme, &theme.translate("live.raw"), theme.monospace(theme.format_word(reading.position_word())));
            if let Some(frame) = reading.frame {
                row(ui, theme, &translate(theme, "frame_card.frame"), theme.monospace(theme.format_word(frame)));
            }
        }
        if reading.is_some_and(|reading| reading.frame.is_none()) {
            paragraph(ui, theme.caption(translate(theme, "frame_card.pin")));
        }
        let errors = encoder.record.crc_errors();
        if errors > 0 {
            let text = TEXTS.text("frame_card.crc_errors").with("count", errors);
            paragraph(ui, egui::RichText::new(theme.format_text(&text)).color(theme.palette.warn));
        }
    });
}

fn transmitted_data(reading: &PositionReading) -> PositionData {
    PositionData {
        multiturn: reading.turns,
        singleturn: reading.steps,
        error: reading.error == Some(true),
        warning: reading.warning == Some(true),
    }
}

/// Returns the fields of a frame with their bits. The configuration pin provides only the position.
fn frame_fields(
    theme: &Theme,
    layout: &Layout,
    reading: Option<&PositionReading>,
) -> (Vec<StripField>, Vec<Option<bool>>) {
    let mut fields = Vec::new();
    let mut bits = Vec::new();
    let mut add = |field: StripField, value: Option<u64>| {
        bits.extend((0..field.bits).rev().map(|bit| value.map(|value| value >> bit & 1 == 1)));
        fields.push(field);
    };
    let number = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
    let field = |name: &str, bits: u8, colour| StripField {
        name: name.to_owned(),
        bits: usize::from(bits),
        colour: Some(colour),
        ..StripField::default()
    };
    let turns = reading.map(|own| u64::from(own.turns));
    let is_split_known = reading.is_none_or(|own| own.is_split_known);
    if !is_split_known {
        let position = reading.map(|own| own.position());
        let value = number(position);
        let bits = layout.multiturn_bits() + layout.singleturn_bits();
        add(StripField { value, ..field("MT + ST", bits, 0) }, position);
    }
    if is_split_known && layout.multiturn_bits() > 0 {
        let value = format!("{} {}", theme.translate("live.turns"), number(turns));
        add(StripField { value, ..field("MT", layout.multiturn_bits(), 0) }, turns);
    }
    if is_split_known && layout.singleturn_bits() > 0 {
        let steps = reading.map(|own| u64::from(own.steps));
        let value =
            reading.map(|own| format!("{} °", theme.format_number(own.degrees_in_turn(), 3))).unwrap_or_default();
        add(StripField { value, ..field("ST", layout.singleturn_bits(), 1) }, steps);
    }
    if reading.is_some_and(|own| own.frame.is_none()) {
        return (fields, bits);
    }
    for (is_there, name, is_set, verdict) in [
        (layout.has_error_bit(), "nERR", reading.and_then(|own| own.error), Verdict::Fault),
        (layout.has_warning_bit(), "nWARN", reading.and_then(|own| own.warning), Verdict::Warn),
    ] {
        if is_there {
            let lit = is_set.map(|set| if set { verdict } else { Verdict::Ok });
            add(StripField { lit, ..field(name, 1, 2) }, is_set.map(|set| u64::from(!set)));
        }
    }
    if layout.crc_bits() > 0 {
        // Only frames with a matching checksum are shown, so the checksum can be calculated from the other bits.
        let crc = reading.map(|own| layout.emit(&transmitted_data(own)) & ((1 << layout.crc_bits().min(63)) - 1));
        let value = crc.map(|crc| format!("0x{crc:02X}")).unwrap_or_default();
        add(StripField { value, ..field("CRC", layout.crc_bits(), 3) }, crc);
    }
    (fields, bits)
}
