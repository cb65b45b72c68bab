//! Tests of a register table as large as the kit encoder's, with keys, the pointer and accessible labels.

use std::cell::RefCell;
use std::collections::BTreeMap;

use egui::{Event, Key, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use super::{CTRL, NONE, focus, press, theme, window};
use crate::app::Text;
use crate::ui::widgets::{
    RegisterBits, RegisterEvent, RegisterGroup, RegisterKind, RegisterLocation, RegisterRow, RegisterTable,
    RegisterTableOutput, RegisterView, register_table,
};

#[derive(Default)]
struct Registers {
    edits: BTreeMap<RegisterLocation, u8>,
    view: RegisterView,
    events: Vec<RegisterEvent>,
    output: RegisterTableOutput,
    /// Number of registers requested in the last frame.
    asked: usize,
}

const TABLE: &str = "Registers";
const BANKS: usize = 68;

fn register(place: RegisterLocation, edited: Option<u8>) -> RegisterRow {
    let value = edited.unwrap_or((place.row & 0xFF) as u8);
    let bits = |at: usize| RegisterBits { bits: format!("b{at}"), name: format!("flag {at}"), ..Default::default() };
    RegisterRow {
        address: format!("{:02X}:{:02X}", place.group, place.row),
        name: format!("register {}", place.row),
        value: format!("{value:02X}"),
        decimal: value.to_string(),
        meaning: if place.row == 3 { "idle".to_owned() } else { String::new() },
        edited: edited.is_some(),
        changed: place.row == 4,
        read_only: (place.row == 1).then(|| "The encoder measures it.".to_owned()),
        fields: if place.row == 2 { (0..3).map(bits).collect() } else { Vec::new() },
        ..RegisterRow::default()
    }
}

fn table() -> Harness<'static, Registers> {
    table_harness(RegisterKind::Bytes { widest: 1 })
}

fn table_harness(kind: RegisterKind) -> Harness<'static, Registers> {
    let groups: Vec<RegisterGroup> = (0..BANKS)
        .map(|bank| RegisterGroup { title: format!("Bank {bank:02X}"), note: String::new(), rows: 64 })
        .collect();
    window(Registers::default(), move |ui, state: &mut Registers| {
        let (asked, edits) = (RefCell::new(0), &state.edits);
        let row = |place: RegisterLocation| {
            *asked.borrow_mut() += 1;
            register(place, edits.get(&place).copied())
        };
        let model = RegisterTable { label: TABLE, groups: &groups, row: &row, kind };
        let mut put = None;
        let mut take = |place, text: &str| {
            let value = u8::from_str_radix(text, 16).map_err(|_| Text::new("widget.hex_nothing"))?;
            put = Some((place, value));
            Ok(())
        };
        let output = register_table(ui, &theme(), &model, 400.0, &mut state.view, &mut take);
        state.asked = asked.into_inner();
        state.edits.extend(put);
        if let Some(RegisterEvent::Revert(place)) = output.event {
            state.edits.remove(&place);
        }
        state.events.extend(output.event);
        state.output = output;
    })
}

fn selected(harness: &Harness<'_, Registers>) -> String {
    harness.get_by_label(TABLE).value().unwrap()
}

fn problem(harness: &Harness<'_, Registers>) -> Option<String> {
    harness.state().view.problem(&theme())
}

fn place(group: usize, row: usize) -> RegisterLocation {
    RegisterLocation { group, row }
}

/// Clicks a row at the given distance from its left edge, in points.
fn click(harness: &mut Harness<'_, Registers>, label: &str, from_left: f32, times: usize) {
    let rect = harness.get_by_label(label).rect();
    let pos = Pos2::new(rect.left() + from_left, rect.center().y);
    // This is not a double click together with the previous one.
    harness.run_steps(20);
    for _ in 0..times {
        harness.event(Event::PointerMoved(pos));
        for pressed in [true, false] {
            harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: NONE });
        }
    }
    harness.run();
}

#[test]
fn requests_only_visible_groups() {
    let mut harness = table();
    assert_eq!(harness.state().output.groups, 0..1);
    focus(&mut harness, TABLE);
    for (key, groups, label) in [(Key::End, 67..68, "43:3F register 63"), (Key::Home, 0..1, "00:00 register 0")] {
        press(&mut harness, &[(NONE, key)]);
        assert_eq!(harness.state().output.groups, groups);
        harness.get_by_label(label);
        // 400 points hold 23 lines. Some registers are requested again for the selection.
        assert!(harness.state().asked < 30, "{}", harness.state().asked);
    }
}

#[test]
fn arrow_keys_skip_bit_fields() {
    let mut harness = table();
    focus(&mut harness, TABLE);
    press(&mut harness, &[(NONE, Key::ArrowDown)]);
    assert_eq!(selected(&harness), "Bank 00");
    press(&mut harness, &[(NONE, Key::ArrowDown), (NONE, Key::ArrowDown), (NONE, Key::ArrowDown)]);
    assert_eq!(selected(&harness), "00:02 register 2: 02, 2");
    press(&mut harness, &[(NONE, Key::ArrowRight)]);
    harness.get_by_label("b1 flag 1");
    press(&mut harness, &[(NONE, Key::ArrowDown)]);
    assert_eq!(selected(&harness), "00:03 register 3: 03, 3, idle");
    press(&mut harness, &[(NONE, Key::ArrowDown)]);
    assert_eq!(selected(&harness), "00:04 register 4: 04, 4, changed since the previous reading");
    press(&mut harness, &[(NONE, Key::ArrowUp), (NONE, Key::ArrowUp), (NONE, Key::ArrowLeft)]);
    assert!(harness.query_by_label("b1 flag 1").is_none(), "left folds what is unfolded");
    press(&mut harness, &[(NONE, Key::ArrowLeft)]);
    assert_eq!(selected(&harness), "Bank 00");
    press(&mut harness, &[(NONE, Key::ArrowLeft), (NONE, Key::ArrowDown)]);
    assert_eq!(selected(&harness), "Bank 01", "a folded group is one line");
    assert!(harness.get_by_label(TABLE).is_focused());
    press(&mut harness, &[(NONE, Key::PageDown)]);
    assert_eq!(harness.state().view.selected(), Some(place(1, 21)), "23 lines are a page, one of them is seen again");
}

#[test]
fn accepts_or_rejects_typed_value() {
    let mut harness = table();
    harness.state_mut().view.select(place(5, 7));
    focus(&mut harness, TABLE);
    press(&mut harness, &[(NONE, Key::Enter)]);
    let entry = |harness: &Harness<'_, Registers>| harness.get_by_role(egui::accesskit::Role::TextInput).value();
    assert_eq!(entry(&harness), Some("07".to_owned()));
    harness.event(Event::Text("zz".to_owned()));
    press(&mut harness, &[(NONE, Key::Enter)]);
    assert_eq!(problem(&harness).as_deref(), Some("The clipboard contains no bytes."));
    assert_eq!(entry(&harness), Some("zz".to_owned()), "what was typed stays");
    press(&mut harness, &[(CTRL, Key::A)]);
    harness.event(Event::Text("2a".to_owned()));
    press(&mut harness, &[(NONE, Key::Enter)]);
    assert_eq!(harness.state().edits, BTreeMap::from([(place(5, 7), 0x2A)]));
    assert!(harness.get_by_label(TABLE).is_focused());
    assert_eq!(selected(&harness), "05:07 register 7: 2A, 42, edited, not written");
    // A typed character begins the edit, and Escape cancels it.
    harness.event(Event::Text("f".to_owned()));
    harness.run();
    assert_eq!(entry(&harness), Some("f".to_owned()));
    press(&mut harness, &[(NONE, Key::Escape)]);
    assert!(harness.query_by_role(egui::accesskit::Role::TextInput).is_none());
    assert_eq!(harness.state().edits.len(), 1);
    press(&mut harness, &[(NONE, Key::Backspace), (NONE, Key::Backspace)]);
    assert_eq!(harness.state().events, [RegisterEvent::Revert(place(5, 7))], "what is as read is not reverted again");
}

#[test]
fn read_only_registers_show_reason() {
    let mut harness = table();
    harness.state_mut().view.select(place(0, 1));
    focus(&mut harness, TABLE);
    let why = "The encoder measures it.";
    press(&mut harness, &[(NONE, Key::F2)]);
    assert_eq!(problem(&harness).as_deref(), Some(why));
    press(&mut harness, &[(NONE, Key::ArrowDown)]);
    assert_eq!(problem(&harness), None);
    click(&mut harness, "00:01 register 1", 200.0, 2);
    assert_eq!(problem(&harness).as_deref(), Some(why));
    assert!(harness.query_by_role(egui::accesskit::Role::TextInput).is_none());
}

#[test]
fn pointer_selects_folds_and_edits() {
    let mut harness = table();
    click(&mut harness, "00:03 register 3", 200.0, 1);
    assert_eq!(harness.state().view.selected(), Some(place(0, 3)));
    assert_eq!(harness.get_by_label("00:03 register 3").accesskit_node().is_selected(), Some(true));
    click(&mut harness, "00:02 register 2", 6.0, 1);
    harness.get_by_label("b2 flag 2");
    click(&mut harness, "00:02 register 2", 200.0, 2);
    harness.get_by_role(egui::accesskit::Role::TextInput);
    // A value that was not changed is accepted.
    click(&mut harness, "Bank 00", 100.0, 1);
    assert_eq!(harness.state().edits.get(&place(0, 2)), Some(&2));
    assert!(harness.state().view.is_folded(0) && harness.query_by_label("00:03 register 3").is_none());
    harness.get_by_label("Bank 01");
}

#[test]
fn scrolls_to_selected_register() {
    let mut harness = table();
    harness.state_mut().view.set_folded(0x23, true);
    harness.run();
    harness.state_mut().view.select(place(0x23, 0x3F));
    harness.run();
    harness.get_by_label("23:3F register 63");
}

#[test]
fn single_click_edits_number_box() {
    let entry = |harness: &Harness<'_, Registers>| {
        harness.query_by_role(egui::accesskit::Role::TextInput).and_then(|node| node.accesskit_node().label())
    };
    for (kind, expected) in
        [(RegisterKind::Numbers, Some("00:00 register 0")), (RegisterKind::Bytes { widest: 1 }, None)]
    {
        let mut harness = table_harness(kind);
        // Twelve characters of 7.8 points and 8 between columns are 101.6. With 42 + 40 + 150 before it and 356 after
        // it, the total is 689.6. The name gets 45 % of the rest.
        let spare = (harness.get_by_label("00:00 register 0").rect().width() - 689.6).max(0.0);
        let value = 232.0 + (spare * 0.45).floor() + 30.0;
        click(&mut harness, "00:00 register 0", value, 1);
        assert_eq!(entry(&harness).as_deref(), expected, "{kind:?}");
        press(&mut harness, &[(NONE, Key::Escape)]);
        click(&mut harness, "00:01 register 1", value, 1);
        assert_eq!(entry(&harness), None, "it has no box");
    }
}

/// A click on another box takes the keyboard focus from the one being edited.
#[test]
fn clicking_another_box_accepts_typed_text() {
    let mut harness = table_harness(RegisterKind::Numbers);
    let entry = |harness: &Harness<'_, Registers>| {
        harness.query_by_role(egui::accesskit::Role::TextInput).and_then(|node| node.accesskit_node().label())
    };
    let spare = (harness.get_by_label("00:00 register 0").rect().width() - 689.6).max(0.0);
    let value = 232.0 + (spare * 0.45).floor() + 30.0;
    click(&mut harness, "00:05 register 5", value, 1);
    harness.event(Event::Text("7A".to_owned()));
    harness.run();
    click(&mut harness, "00:08 register 8", value, 1);
    assert_eq!(harness.state().edits.get(&place(0, 5)), Some(&0x7A));
    assert_eq!(entry(&harness).as_deref(), Some("00:08 register 8"));
    // A rejected value stays visible with its reason and is discarded only by another press.
    harness.event(Event::Text("xy".to_owned()));
    harness.run();
    click(&mut harness, "00:10 register 16", value, 1);
    assert!(problem(&harness).is_some() && !harness.state().edits.contains_key(&place(0, 8)));
    assert_eq!(entry(&harness).as_deref(), Some("00:08 register 8"));
    click(&mut harness, "00:10 register 16", value, 1);
    assert_eq!((entry(&harness).as_deref(), problem(&harness)), (Some("00:10 register 16"), None));
}

#[test]
fn typed_text_stays_with_its_register() {
    let mut harness = table();
    click(&mut harness, "00:05 register 5", 100.0, 2);
    let typed = |harness: &Harness<'_, Registers>| {
        harness.query_by_role(egui::accesskit::Role::TextInput).and_then(|node| node.accesskit_node().label())
    };
    assert_eq!(typed(&harness).as_deref(), Some("00:05 register 5"));
    harness.state_mut().view.follow_registers(|own| Some(RegisterLocation { row: own.row + 1, ..own }));
    harness.run();
    assert_eq!(typed(&harness).as_deref(), Some("00:06 register 6"));
    assert_eq!(harness.state().view.selected(), Some(place(0, 6)));
    harness.state_mut().view.follow_registers(|_| None);
    harness.run();
    assert_eq!((typed(&harness), harness.state().view.selected()), (None, None));
}

/// A slowly drawn window receives several keys in one frame. None may be lost or handled twice, whether the table has
/// the keyboard focus or is about to regain it (issue 26.4).
#[test]
fn text_typed_in_one_frame_is_complete() {
    let mut harness = table();
    click(&mut harness, "00:05 register 5", 200.0, 1);
    let key = |key| {
        let event = move |pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: NONE };
        vec![event(true), event(false)]
    };
    let typed = |text: &str, own: Key| vec![key(own)[0].clone(), Event::Text(text.to_owned()), key(own)[1].clone()];
    let all = [
        typed("2", Key::Num2),
        typed("A", Key::A),
        key(Key::Enter),
        key(Key::ArrowDown),
        typed("7", Key::Num7),
        typed("1", Key::Num1),
        key(Key::Backspace),
        typed("B", Key::B),
        key(Key::Enter),
    ]
    .concat();
    // All events in one frame, or in two frames split at any point.
    for cut in 0..=all.len() {
        harness.state_mut().edits.clear();
        harness.state_mut().view.select(place(0, 5));
        let (first, rest) = all.split_at(cut);
        for events in [first, rest] {
            harness.input_mut().events.extend(events.iter().cloned());
            harness.step();
        }
        harness.run_steps(6);
        let edits = &harness.state().edits;
        let expected = BTreeMap::from([(place(0, 5), 0x2A), (place(0, 6), 0x7B)]);
        assert_eq!(*edits, expected, "cut at {cut}");
        assert!(harness.get_by_label(TABLE).is_focused());
    }
}
