//! Tests of the hex editor with keys, the pointer and the clipboard.

use egui::{Event, Key, Modifiers, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::{CTRL, NONE, SHIFT, focus, press, theme, window};
use crate::app::Text;
use crate::ui::widgets::{HexAnnotation, HexEdit, HexModel, HexView, hex_editor};

#[derive(Default)]
struct Bytes {
    device: Vec<u8>,
    wanted: Vec<u8>,
    view: HexView,
    read_only: Option<Text>,
    edits: Vec<HexEdit>,
}

const BYTES: &str = "Data field 3";

fn editor(count: u8, read_only: Option<Text>) -> Harness<'static, Bytes> {
    let device: Vec<u8> = (0..count).collect();
    let state = Bytes { wanted: device.clone(), device, read_only, ..Bytes::default() };
    let mut harness = window(state, |ui, state: &mut Bytes| {
        let marks = [HexAnnotation { range: 4..8, words: "belongs to the mounting" }];
        let model = HexModel { marks: &marks, lines: 8, ..HexModel::new(&state.device, &state.wanted) };
        let model = HexModel { read_only: state.read_only.as_ref(), ..model };
        let edits = hex_editor(ui, &theme(), BYTES, &model, &mut state.view);
        for edit in &edits {
            match edit {
                HexEdit::Put { address, bytes } => {
                    state.wanted[*address..*address + bytes.len()].copy_from_slice(bytes);
                }
                HexEdit::Revert { range } => {
                    state.wanted[range.clone()].copy_from_slice(&state.device[range.clone()]);
                }
                HexEdit::Undo => state.wanted.clone_from(&state.device),
                HexEdit::Redo => {}
            }
        }
        state.edits.extend(edits);
    });
    if count > 0 {
        focus(&mut harness, BYTES);
    }
    harness
}

fn put(address: usize, bytes: &[u8]) -> HexEdit {
    HexEdit::Put { address, bytes: bytes.to_vec() }
}

fn type_in(harness: &mut Harness<'_, Bytes>, text: &str) {
    harness.get_by_label(BYTES).type_text(text);
    harness.run();
}

fn value(harness: &Harness<'_, Bytes>) -> String {
    harness.get_by_label(BYTES).value().unwrap()
}

#[test]
fn digits_overwrite_nibble_by_nibble() {
    let mut harness = editor(64, None);
    assert_eq!(value(&harness), "0x00: 00");
    type_in(&mut harness, "3");
    assert!(harness.state().edits.is_empty(), "half a byte is none");
    type_in(&mut harness, "f");
    assert_eq!(harness.state().edits, [put(0, &[0x3F])]);
    assert_eq!(value(&harness), "0x01: 01");
    type_in(&mut harness, "7");
    press(&mut harness, &[(NONE, Key::Escape)]);
    assert!(harness.get_by_label(BYTES).is_focused(), "Escape drops the digit first");
    type_in(&mut harness, "a5");
    assert_eq!(harness.state().wanted[..3], [0x3F, 0xA5, 2]);
    harness.get_by_label("0x02 (2)");
    harness.get_by_label_contains("2 changed");
}

#[test]
fn reports_invalid_digit_until_next_key() {
    let mut harness = editor(64, None);
    type_in(&mut harness, "g");
    harness.get_by_label_contains("\"g\" is not a hexadecimal digit");
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    assert!(harness.query_by_label_contains("not a hexadecimal digit").is_none());
    assert!(harness.state().edits.is_empty());
}

#[test]
fn moves_and_selects_by_cursor() {
    let mut harness = editor(40, None);
    press(&mut harness, &[(NONE, Key::ArrowDown), (NONE, Key::ArrowRight)]);
    assert_eq!(value(&harness), "0x11: 11");
    press(&mut harness, &[(NONE, Key::End), (SHIFT, Key::ArrowRight), (SHIFT, Key::ArrowRight)]);
    assert_eq!(value(&harness), "0x1F: 1F 20 21");
    press(&mut harness, &[(NONE, Key::ArrowDown)]);
    assert_eq!(harness.state().view.cursor(), 33, "there is no line below");
    press(&mut harness, &[(NONE, Key::Home), (CTRL, Key::End)]);
    assert_eq!(value(&harness), "0x27: 27");
    press(&mut harness, &[(CTRL, Key::Home)]);
    press(&mut harness, &[(NONE, Key::PageDown)]);
    assert_eq!(harness.state().view.cursor(), 32);
    press(&mut harness, &[(NONE, Key::PageUp)]);
    assert_eq!(harness.state().view.cursor(), 0);
    press(&mut harness, &[(CTRL, Key::A)]);
    assert_eq!(harness.state().view.selection(), 0..40);
    assert!(harness.get_by_label(BYTES).is_focused());
}

#[test]
fn clears_reverts_and_undoes_selection() {
    let mut harness = editor(32, None);
    harness.state_mut().view.select(4..7);
    press(&mut harness, &[(NONE, Key::Delete)]);
    press(&mut harness, &[(NONE, Key::Backspace), (NONE, Key::Backspace)]);
    press(&mut harness, &[(CTRL, Key::Z), (CTRL | SHIFT, Key::Z), (CTRL, Key::Y)]);
    let expected = [put(4, &[0; 3]), HexEdit::Revert { range: 4..7 }, HexEdit::Undo, HexEdit::Redo, HexEdit::Redo];
    assert_eq!(harness.state().edits, expected, "what is as read is not reverted again");
}

#[test]
fn cursor_moves_to_undone_edit() {
    let mut harness = editor(64, None);
    harness.state_mut().view.select(16..17);
    type_in(&mut harness, "FF");
    assert_eq!((harness.state().wanted[16], harness.state().view.cursor()), (0xFF, 17));
    harness.state_mut().view.select(40..42);
    press(&mut harness, &[(CTRL, Key::Z)]);
    assert_eq!((harness.state().view.cursor(), harness.state().view.selection()), (16, 16..17));
    // There is nothing left to undo, so the cursor stays.
    harness.state_mut().view.select(40..41);
    press(&mut harness, &[(CTRL, Key::Z)]);
    assert_eq!(harness.state().view.cursor(), 40);
}

#[test]
fn pastes_hex_where_it_fits() {
    let mut harness = editor(32, None);
    let cases = [
        ("0x41, 42\n43", "", Some(put(0, b"ABC"))),
        ("4142 4", "", Some(put(0, &[0x41, 0x42, 4]))),
        ("41 4G", "\"G\" is not a hexadecimal digit", None),
        ("414", "\"414\" has an odd number of digits", None),
        ("", "no bytes", None),
    ];
    for (text, problem, edit) in cases {
        press(&mut harness, &[(CTRL, Key::Home)]);
        harness.state_mut().edits.clear();
        harness.event(Event::Paste(text.to_owned()));
        harness.run();
        assert_eq!(harness.state().edits.first(), edit.as_ref(), "{text}");
        assert_eq!(harness.state().view.problem().is_some(), edit.is_none(), "{text}");
        if edit.is_none() {
            harness.get_by_label_contains(problem);
        }
    }
    press(&mut harness, &[(CTRL, Key::End)]);
    harness.event(Event::Paste("01 02".to_owned()));
    harness.run();
    harness.get_by_label_contains("Bytes entered: 2; bytes available from address 0x1F: 1.");
    assert!(harness.state().edits.is_empty());
}

#[test]
fn types_and_copies_text() {
    let mut harness = editor(32, None);
    press(&mut harness, &[(NONE, Key::Tab)]);
    type_in(&mut harness, "Hi");
    assert_eq!(harness.state().edits, [put(0, b"Hi")]);
    type_in(&mut harness, "ä");
    harness.get_by_label_contains("\"ä\" is not an ASCII character");
    harness.state_mut().view.select(0..3);
    for (expected, key) in [("Hi·", SHIFT), ("48 69 02", NONE)] {
        harness.event(Event::Copy);
        harness.step();
        let copied = harness.output().platform_output.commands.clone();
        assert!(copied.contains(&egui::OutputCommand::CopyText(expected.to_owned())), "{copied:?}");
        press(&mut harness, &[(key, Key::Tab)]);
    }
}

#[test]
fn tab_moves_through_columns() {
    let mut harness = editor(32, None);
    press(&mut harness, &[(NONE, Key::Tab)]);
    assert!(harness.get_by_label(BYTES).is_focused());
    press(&mut harness, &[(NONE, Key::Tab)]);
    assert!(harness.get_by_label("behind").is_focused());
    press(&mut harness, &[(SHIFT, Key::Tab)]);
    assert!(harness.get_by_label(BYTES).is_focused());
    press(&mut harness, &[(SHIFT, Key::Tab)]);
    press(&mut harness, &[(SHIFT, Key::Tab)]);
    assert!(harness.get_by_label("before").is_focused());
}

#[test]
fn read_only_bytes_show_reason() {
    let mut harness = editor(32, Some(Text::new("widget.hex_nothing")));
    let reason = "The clipboard contains no bytes.";
    for key in [Key::Delete, Key::Backspace] {
        press(&mut harness, &[(NONE, key)]);
        harness.get_by_label_contains(reason);
        press(&mut harness, &[(NONE, Key::ArrowRight)]);
        assert!(harness.query_by_label_contains(reason).is_none());
    }
    type_in(&mut harness, "a5");
    harness.get_by_label_contains(reason);
    press(&mut harness, &[(CTRL, Key::Z)]);
    harness.event(Event::Paste("00".to_owned()));
    harness.run();
    assert!(harness.state().edits.is_empty());
}

fn press_at(harness: &mut Harness<'_, Bytes>, pos: Pos2, modifiers: Modifiers, released: Pos2) {
    harness.event(Event::PointerMoved(pos));
    harness.event(Event::ModifiersChanged(modifiers));
    for (pos, pressed) in [(pos, true), (released, false)] {
        harness.event(Event::PointerMoved(pos));
        harness.event(Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers });
    }
    harness.event(Event::ModifiersChanged(NONE));
    harness.run();
}

#[test]
fn pointer_sets_cursor_and_selects() {
    let mut harness = editor(32, None);
    let rect = harness.get_by_label(BYTES).rect();
    // The middle of the second of two lines. Columns are 24 points wide and follow 28 points of address.
    let at = |place: f32| Pos2::new(rect.left() + 28.0 + 24.0 * (place + 0.5), rect.top() + rect.height() * 0.75);
    press_at(&mut harness, at(2.0), NONE, at(2.0));
    assert_eq!(value(&harness), "0x12: 12");
    press_at(&mut harness, at(5.0), SHIFT, at(5.0));
    assert_eq!(harness.state().view.selection(), 0x12..0x16);
    press_at(&mut harness, at(1.0), NONE, at(3.0));
    assert_eq!(harness.state().view.selection(), 0x11..0x14);
    press_at(&mut harness, at(6.0), NONE, at(6.0));
    press_at(&mut harness, at(6.0), NONE, at(6.0));
    assert_eq!(harness.state().view.selection(), 0x14..0x18, "a double click selects the word");
}

#[test]
fn hovering_describes_byte() {
    let mut harness = editor(16, None);
    press(&mut harness, &[(CTRL, Key::Home), (NONE, Key::ArrowRight)]);
    harness.state_mut().wanted[5] = 0x41;
    let rect = harness.get_by_label(BYTES).rect();
    harness.hover_at(Pos2::new(rect.left() + 28.0 + 24.0 * 5.5, rect.center().y));
    harness.run_steps(60);
    for words in ["0x05 (5)", "41", "65", "0100 0001", "'A'", "As read", "05"] {
        harness.get_by_label(words);
    }
    harness.get_by_label_contains("belongs to the mounting");
}

#[test]
fn cursor_stays_visible_and_in_range() {
    let state = Bytes { device: vec![0; 4096], wanted: vec![0; 4096], ..Bytes::default() };
    let mut harness = editor(0, None);
    assert_eq!(value(&harness), "");
    *harness.state_mut() = state;
    harness.run();
    focus(&mut harness, BYTES);
    press(&mut harness, &[(CTRL, Key::End)]);
    assert_eq!(value(&harness), "0xFFF: 00");
    assert!(harness.get_by_label(BYTES).rect().top() < 0.0, "it has scrolled");
    harness.state_mut().wanted.truncate(20);
    harness.run();
    assert_eq!(value(&harness), "0x13: 00");
}
