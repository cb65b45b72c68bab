//! Tests of the table of typed values.

use egui_kittest::kittest::Queryable;

use super::{theme, window};
use crate::ui::widgets::typed_view;

#[test]
fn shows_and_copies_value_by_type() {
    let mut harness = window(vec![0xDB, 0x0F, 0x49], |ui, bytes: &mut Vec<u8>| typed_view(ui, &theme(), bytes));
    let value = |label: &str| harness.get_by_label(label).value();
    assert_eq!(value("i16 Big endian").as_deref(), Some("-9457"));
    assert_eq!(value("Binary").as_deref(), Some("1101 1011"));
    assert!(harness.query_by_label("f32 Little endian").is_none(), "three bytes are too few");
    harness.get_by_label("u16 Little endian").click();
    let mut copied = Vec::new();
    for _ in 0..4 {
        harness.step();
        copied.extend(harness.output().platform_output.commands.clone());
    }
    assert!(copied.contains(&egui::OutputCommand::CopyText("4059".to_owned())), "{copied:?}");
}
