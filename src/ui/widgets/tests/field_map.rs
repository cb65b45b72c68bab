//! Tests of the field map with keys and the pointer.

use egui::{Key, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::{NONE, focus, press, theme, window};
use crate::ui::widgets::{FieldMap, MapEvent, MapField, field_map};

#[derive(Default)]
struct Memory {
    sizes: Vec<usize>,
    free: usize,
    events: Vec<MapEvent>,
}

fn map(sizes: &[usize], free: usize) -> Harness<'static, Memory> {
    let state = Memory { sizes: sizes.to_vec(), free, ..Memory::default() };
    window(state, |ui, state: &mut Memory| {
        let field = |(number, blocks): (u8, &usize)| MapField {
            number,
            blocks: *blocks,
            label: format!("Field {number}"),
            caption: "32 B · code 1".to_owned(),
            colour: usize::from(number),
            locked: number == 1,
            unreadable: number == 2,
            edited: true,
            tooltip: String::new(),
        };
        let fields: Vec<MapField> = (0..).zip(&state.sizes).map(field).collect();
        let map = FieldMap {
            fields: &fields,
            free_blocks: state.free,
            free_label: "Free",
            selected: Some(1),
            block_bytes: 16,
            resize: Some(1..=8),
            ..FieldMap::default()
        };
        state.events.extend(field_map(ui, &theme(), &map));
    })
}

#[test]
fn selects_fields_by_pointer_and_keys() {
    let mut harness = map(&[2, 1, 40, 1], 9);
    harness.get_by_label("Field 2").click();
    harness.run();
    assert!(harness.get_by_label("Field 2").is_focused());
    harness.get_by_label("Free").click();
    harness.run();
    assert_eq!(harness.state().events, [MapEvent::Select(2), MapEvent::SelectFree]);
    focus(&mut harness, "Field 0");
    press(&mut harness, &[(NONE, Key::ArrowRight), (NONE, Key::Enter), (NONE, Key::ArrowLeft), (NONE, Key::Space)]);
    assert_eq!(harness.state().events[2..], [MapEvent::Select(1), MapEvent::Select(0)]);
    press(&mut harness, &[(NONE, Key::End)]);
    assert!(harness.get_by_label("Free").is_focused());
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    assert!(harness.get_by_label("Free").is_focused(), "there is nothing behind it");
}

fn drag_end(harness: &mut Harness<'_, Memory>, blocks: f32) {
    let rect = harness.get_by_label("Field 1").rect();
    let end = rect.right_center();
    harness.drag_at(end);
    harness.step();
    for part in [0.5, 1.0] {
        harness.hover_at(end + Vec2::new(48.0 * blocks * part, 0.0));
        harness.step();
    }
    harness.drop_at(end + Vec2::new(48.0 * blocks, 0.0));
    harness.run();
}

#[test]
fn resizes_last_field_in_whole_blocks() {
    let mut harness = map(&[2, 3], 4);
    drag_end(&mut harness, 2.2);
    assert_eq!(harness.state().events, [MapEvent::ResizeLast { blocks: 5 }]);
    drag_end(&mut harness, 9.0);
    assert_eq!(harness.state().events.last(), Some(&MapEvent::ResizeLast { blocks: 7 }), "no more than are free");
    drag_end(&mut harness, -4.0);
    assert_eq!(harness.state().events.last(), Some(&MapEvent::ResizeLast { blocks: 1 }), "one block at least");
    drag_end(&mut harness, 0.2);
    assert_eq!(harness.state().events.len(), 3, "the present size is no change");
}

#[test]
fn escape_cancels_resize() {
    let mut harness = map(&[2, 3], 4);
    let end = harness.get_by_label("Field 1").rect().right_center();
    harness.drag_at(end);
    harness.step();
    harness.hover_at(end + Vec2::new(96.0, 0.0));
    harness.step();
    press(&mut harness, &[(NONE, Key::Escape)]);
    harness.drop_at(end + Vec2::new(96.0, 0.0));
    harness.run();
    assert!(harness.state().events.is_empty());
}

#[test]
fn memory_without_fields_shows_free_space() {
    let mut harness = map(&[], 8);
    harness.get_by_label("Free").click();
    harness.run();
    assert_eq!(harness.state().events, [MapEvent::SelectFree]);
    let harness = map(&[], 0);
    assert!(harness.query_by_label("Free").is_none());
}
