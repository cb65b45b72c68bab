//! Tests of the cam output word and its position bits.

use egui_kittest::kittest::Queryable;

use crate::devices::interbus::protocol::WindowShift;
use crate::devices::interbus::views::widgets::{WordLayout, word_layout};
use crate::ui::widgets::tests::{theme, window};

fn draw(shift: u8, word: Option<u32>, width: f32) -> egui_kittest::Harness<'static, ()> {
    window((), move |ui, ()| {
        ui.set_max_width(width);
        let shift = WindowShift::new(shift).unwrap();
        word_layout(ui, &theme(), &WordLayout { label: "Word", shift, word, range: 8192 });
    })
}

#[test]
fn groups_describe_bits() {
    // The word 00BCDE20h contains position 1ABCDEFh with a shift of 4, and cam 5 is on. The window contains bits 20 to
    // 4 (reference 7).
    let harness = draw(4, Some(0x00BC_DE20), 860.0);
    harness.get_by_label("Invalid, bit 31: 0");
    harness.get_by_label("Always 0, bits 30 to 25: 000000");
    harness.get_by_label("Position, bits 20 to 4, bits 24 to 8: 01011110011011110");
    harness.get_by_label("Cam outputs, bits 7 to 0: 00100000");
    // From a shift of 9, the window is wider than the remaining bits of the position.
    let harness = draw(20, None, 860.0);
    harness.get_by_label("Always 0, bits 30 to 13");
    harness.get_by_label("Position, bits 24 to 20, bits 12 to 8");
    let harness = draw(25, None, 860.0);
    harness.get_by_label("Always 0, bits 30 to 8");
    assert!(harness.query_by_label_contains("Position, bits").is_none());
}

#[test]
fn narrow_layout_wraps_bits() {
    for (width, lines) in [(860.0, 1.0), (544.0, 1.0), (543.0, 2.0), (280.0, 2.0)] {
        let harness = draw(8, None, width);
        let (word, high) = (harness.get_by_label("Word").rect(), harness.get_by_label("Invalid, bit 31").rect());
        let low = harness.get_by_label("Cam outputs, bits 7 to 0").rect();
        assert!(word.width() <= width, "{width}");
        assert_eq!(low.top() > high.top() + 1.0, lines > 1.0, "{width}");
    }
}
