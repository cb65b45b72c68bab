//! Tests of the bit strip with the keyboard and the pointer.

use egui::{Key, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use crate::devices::ssi::protocol::{BitMeaning, ErrorBit, Families, Layout, Settings};
use crate::devices::ssi::state::strip::{Handle, Strip};
use crate::devices::ssi::views::widgets::{BitStrip, StripEvent, bit_strip};
use crate::ui::widgets::tests::{NONE, focus, press, theme, window};

struct Design {
    strip: Strip,
    frame: Option<u64>,
    selected: Option<u8>,
    events: Vec<StripEvent>,
}

fn layout(family: &str, settings: &Settings) -> Layout {
    settings.resolve(Families::built_in().find_by_key(family).unwrap()).unwrap().layout
}

/// Draws a frame that accepts the user's changes.
fn strip(layout: &Layout, width: f32) -> Harness<'static, Design> {
    let state = Design { strip: Strip::from_layout(layout), frame: Some(0), selected: None, events: Vec::new() };
    window(state, move |ui, state: &mut Design| {
        ui.set_max_width(width);
        let model = BitStrip {
            label: "Frame",
            strip: &state.strip,
            frame: state.frame,
            selected: state.selected,
            toggles: true,
            movable: true,
            following: true,
        };
        let event = bit_strip(ui, &theme(), &model);
        match event {
            Some(StripEvent::Moved(handle, clock)) => state.strip = state.strip.with_moved_part(handle, clock, true),
            Some(StripEvent::Selected(clock)) => state.selected = Some(clock),
            Some(StripEvent::Toggled(clock)) => {
                let behind = state.strip.layout().clock_count() - clock;
                state.frame = state.frame.map(|frame| frame ^ 1 << behind);
            }
            Some(StripEvent::Preview(..)) | None => {}
        }
        state.events.extend(event);
    })
}

fn tree() -> Harness<'static, Design> {
    strip(&layout("atm60", &Settings { multiturn: Some(8), singleturn: Some(8), ..Settings::default() }), 860.0)
}

fn moves(harness: &Harness<'_, Design>) -> Vec<StripEvent> {
    harness.state().events.iter().copied().filter(|event| matches!(event, StripEvent::Moved(..))).collect()
}

fn value(harness: &Harness<'_, Design>, label: &str) -> String {
    harness.get_by_label(label).value().unwrap()
}

#[test]
fn keys_move_boundaries() {
    let mut harness = tree();
    let split = "Boundary between the turn bits and the step bits";
    assert_eq!(value(&harness, split), "after clock 12");
    focus(&mut harness, split);
    press(&mut harness, &[(NONE, Key::ArrowRight), (NONE, Key::ArrowRight), (NONE, Key::ArrowLeft)]);
    assert_eq!(moves(&harness), [13, 14, 13].map(|clock| StripEvent::Moved(Handle::Split, clock)));
    assert!(harness.get_by_label(split).is_focused());
    harness.get_by_label("Turn bits: 9, clocks 5 to 13");
    harness.get_by_label("Step bits: 7, clocks 14 to 20");
    press(&mut harness, &[(NONE, Key::Home), (NONE, Key::Home), (NONE, Key::End)]);
    assert_eq!(moves(&harness)[3..], [5, 19].map(|clock| StripEvent::Moved(Handle::Split, clock)));

    focus(&mut harness, "End of the frame");
    press(&mut harness, &[(NONE, Key::Home), (NONE, Key::ArrowLeft), (NONE, Key::ArrowRight)]);
    assert_eq!(moves(&harness)[5..], [20, 21].map(|clock| StripEvent::Moved(Handle::FrameEnd, clock)));
}

#[test]
fn focus_follows_split_and_merged_boundaries() {
    let mut harness = tree();
    focus(&mut harness, "Start of the step bits");
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    harness.get_by_label("Zeros between turns and steps: 1, on clock 13");
    focus(&mut harness, "End of the turn bits");
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    assert!(harness.get_by_label("Boundary between the turn bits and the step bits").is_focused());
    assert_eq!(value(&harness, "Start of the step bits"), "after clock 13");
}

/// Drags a handle by a number of cells, each 28 points wide.
fn drag(harness: &mut Harness<'_, Design>, label: &str, cells: f32) {
    let from = harness.get_by_label(label).rect().center();
    harness.drag_at(from);
    harness.step();
    for part in [0.5, 1.0] {
        harness.hover_at(from + Vec2::new(28.0 * cells * part, 0.0));
        harness.step();
    }
    harness.drop_at(from + Vec2::new(28.0 * cells, 0.0));
    harness.run();
}

#[test]
fn drags_boundaries() {
    let mut harness = tree();
    drag(&mut harness, "Boundary between the turn bits and the step bits", 3.1);
    assert_eq!(moves(&harness), [StripEvent::Moved(Handle::Split, 15)]);
    let previews = harness.state().events.iter().filter(|event| matches!(event, StripEvent::Preview(Handle::Split, _)));
    assert!(previews.count() >= 2);
    drag(&mut harness, "End of the position bits", 20.0);
    assert_eq!(moves(&harness)[1..], [StripEvent::Moved(Handle::StepsEnd, 25)], "the frame has no more clocks");
    drag(&mut harness, "Entire position", 4.0);
    assert_eq!(moves(&harness).len(), 2, "there is no zero behind it");
    drag(&mut harness, "Entire position", -2.0);
    assert_eq!(moves(&harness)[2..], [StripEvent::Moved(Handle::Position, 3)]);
    drag(&mut harness, "End of the frame", 2.0);
    assert_eq!(moves(&harness)[3..], [StripEvent::Moved(Handle::FrameEnd, 27)]);
    drag(&mut harness, "Start of the position bits", 0.2);
    assert_eq!(moves(&harness).len(), 4, "where it is, is no other place");
}

#[test]
fn cancelled_drag_emits_only_previews() {
    let mut harness = tree();
    let from = harness.get_by_label("End of the position bits").rect().center();
    harness.drag_at(from);
    harness.step();
    harness.hover_at(from - Vec2::new(28.0 * 3.0, 0.0));
    harness.run_steps(3);
    harness.get_by_label("Step bits: 5, clocks 13 to 17");
    assert_eq!(harness.state().events.last(), Some(&StripEvent::Preview(Handle::StepsEnd, 17)));
    press(&mut harness, &[(NONE, Key::Escape)]);
    harness.hover_at(from - Vec2::new(28.0 * 4.0, 0.0));
    harness.run_steps(3);
    harness.get_by_label("Step bits: 8, clocks 13 to 20");
    harness.drop_at(from - Vec2::new(28.0 * 4.0, 0.0));
    harness.run();
    assert!(moves(&harness).is_empty());
}

#[test]
fn drags_error_bits_to_other_clock() {
    let mut harness = strip(&layout("afs60", &Settings { clocks: Some(24), ..Settings::default() }), 860.0);
    assert_eq!(
        value(&harness, "Error bit ERRSYNC"),
        "clock 21, position was invalid at least once since the last transfer"
    );
    drag(&mut harness, "Error bit ERRSYNC", 2.0);
    assert_eq!(moves(&harness), [StripEvent::Moved(Handle::Error(2), 23)]);
    focus(&mut harness, "Error bit ERRDIG");
    press(&mut harness, &[(NONE, Key::ArrowRight), (NONE, Key::Home)]);
    assert_eq!(moves(&harness)[1..], [20, 19].map(|clock| StripEvent::Moved(Handle::Error(0), clock)));
    assert_eq!(value(&harness, "Error bit ERRSI"), "clock 20, position invalid");
}

#[test]
fn selects_cells_and_toggles_bits() {
    let mut harness = tree();
    let cells = harness.get_by_label("Frame").rect();
    // The middle of clock 7's cell, and the number above it.
    let seventh = cells.left_top() + Vec2::new(6.5 * 28.0, 13.0);
    for at in [seventh, seventh - Vec2::new(0.0, 20.0)] {
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run();
    }
    assert_eq!(harness.state().events, [StripEvent::Toggled(7), StripEvent::Selected(7)]);
    assert_eq!(value(&harness, "Frame"), "Clock 7: turn bit MT5 (number of turn bits: 8) = 1");
    press(&mut harness, &[(NONE, Key::ArrowRight), (NONE, Key::Space), (NONE, Key::End), (NONE, Key::Home)]);
    let keyed = [StripEvent::Selected(8), StripEvent::Toggled(8), StripEvent::Selected(25), StripEvent::Selected(1)];
    assert_eq!(harness.state().events[2..], keyed);
    assert_eq!(value(&harness, "Turn bits: 8, clocks 5 to 12"), "00110000");
}

#[test]
fn frames_stay_within_width() {
    for (bits, width) in [((1, 1), 200.0), ((32, 32), 300.0), ((32, 32), 600.0), ((32, 32), 880.0), ((12, 13), 470.0)] {
        let plain = crate::devices::ssi::protocol::FrameDescriptor::binary(bits.0, bits.1);
        let harness = strip(&Layout::new(plain).unwrap(), width);
        let left = harness.get_by_label("before").rect().left();
        let labels = ["Frame", "End of the frame", "Start of the position bits", "Entire position"];
        for label in labels.into_iter().chain(["Boundary between the turn bits and the step bits"]) {
            let rect = harness.get_by_label(label).rect();
            assert!(rect.left() >= left && rect.right() <= left + width, "{label} at {width}: {rect}");
        }
    }
}

#[test]
fn handle_describes_purpose_and_range() {
    let mut harness = tree();
    // Turns and steps share clocks 5 to 20 and keep at least one bit each. The position has four zeros before it and
    // five after it.
    for (label, reach) in
        [("Boundary between the turn bits and the step bits", "Range: 5 to 19"), ("Entire position", "Range: 1 to 10")]
    {
        let rect = harness.get_by_label(label).rect();
        harness.hover_at(rect.left_center() + Vec2::new(2.0, 0.0));
        harness.run_steps(60);
        harness.get_by_label(reach);
    }
    let mut harness = strip(&layout("kh53", &Settings::default()), 860.0);
    let rect = harness.get_by_label("Entire position").rect();
    harness.hover_at(rect.left_center() + Vec2::new(2.0, 0.0));
    harness.run_steps(60);
    harness.get_by_label("This boundary cannot be moved because the adjacent bits are in use.");
}

/// Eight error bits with long names do not overlap, whether they are at the start or at the end of a line.
#[test]
fn names_do_not_overlap() {
    for (first, width) in [(1_u8, 860.0), (20, 860.0), (40, 600.0), (56, 300.0)] {
        let mut descriptor = crate::devices::ssi::protocol::FrameDescriptor::binary(0, 4);
        descriptor.clocks = 64;
        descriptor.lead = if first == 1 { 10 } else { 0 };
        descriptor.area = 64;
        let error = |index: u8| ErrorBit {
            name: format!("A_LONG_NAME_OF_AN_ERROR_BIT_{index}"),
            clock: first + index,
            meaning: BitMeaning::Warning,
            active_low: false,
            cleared_by_transfer: false,
        };
        descriptor.errors = (0..8).map(error).collect();
        let harness = strip(&Layout::new(descriptor).unwrap(), width);
        // The rectangle of a field includes its bracket and its name, which is wider than the bracket.
        let name = |index: u8| {
            let label = format!("A_LONG_NAME_OF_AN_ERROR_BIT_{index}, on clock {}", first + index);
            harness.get_by_label(&label).rect()
        };
        let mut lines: Vec<f32> = (0..8).map(|index| name(index).bottom()).collect();
        lines.sort_by(f32::total_cmp);
        lines.dedup();
        assert_eq!(lines.len(), 8, "{lines:?}");
        for index in 0..8 {
            assert!(name(index).left() >= 0.0 && name(index).right() <= width + 16.0, "{index}: {}", name(index));
        }
    }
}
