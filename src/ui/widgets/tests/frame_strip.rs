//! Tests of the frame strip with accessible values.

use egui_kittest::kittest::Queryable;

use super::{theme, window};
use crate::analysis::quality::Verdict;
use crate::ui::widgets::{FrameStrip, StripField, frame_strip};

fn field(name: &str, value: &str, bits: usize, lit: Option<Verdict>) -> StripField {
    StripField {
        name: name.to_owned(),
        value: value.to_owned(),
        bits,
        lit,
        colour: Some(bits),
        tooltip: format!("{name} of {bits} bits"),
    }
}

#[test]
fn frame_describes_fields() {
    let fields = vec![
        field("Start", "", 1, None),
        field("MT", "4660", 16, None),
        field("ST", "98304", 17, None),
        field("nERR", "error", 1, Some(Verdict::Fault)),
        field("CRC", "0E ≠ 0F", 6, Some(Verdict::Fault)),
    ];
    for width in [120.0_f32, 400.0, 850.0] {
        let fields = fields.clone();
        let mut harness = window((), move |ui, ()| {
            ui.set_max_width(width);
            // If there are fewer bits than the fields have, the rest is unknown.
            let bits: Vec<Option<bool>> = (0..20).map(|at| Some(at % 3 == 0)).collect();
            frame_strip(ui, &theme(), &FrameStrip { label: "Frame", fields: &fields, bits: &bits });
        });
        let value = harness.get_by_label("Frame").value().unwrap();
        assert_eq!(value, "Start, MT: 4660, ST: 98304, nERR: error, CRC: 0E ≠ 0F");
        for words in ["Start", "MT: 4660", "ST: 98304", "nERR: error", "CRC: 0E ≠ 0F"] {
            let rect = harness.get_by_label(words).rect();
            assert!(rect.width() <= width.max(8.0 * 11.0 + 3.0), "{words} at {width}: {rect}");
        }
        harness.hover_at(harness.get_by_label("ST: 98304").rect().left_top() + egui::vec2(4.0, 8.0));
        harness.run_steps(60);
        harness.get_by_label("ST of 17 bits");
    }
}
