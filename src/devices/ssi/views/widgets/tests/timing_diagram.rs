//! Tests of the timing diagram through its accessible values and the pointer.

use std::time::Duration;

use egui_kittest::kittest::Queryable;

use crate::devices::ssi::protocol::{Families, ReadConditions, Settings};
use crate::devices::ssi::state::timing::BurstDiagram;
use crate::devices::ssi::views::widgets::{TimingDiagram, timing_diagram};
use crate::ui::widgets::tests::{theme, window};

fn diagram(clock_hz: f64, pause_us: u64) -> BurstDiagram {
    let families = Families::built_in();
    let family = families.find_by_key("ahm36").unwrap();
    let layout = Settings::default().resolve(family).unwrap().layout;
    let reads = ReadConditions {
        clocks: layout.clock_count(),
        clock_hz,
        pause: Duration::from_micros(pause_us),
        cable_metres: None,
        synchronous: true,
        any_steps: false,
    };
    BurstDiagram::new(&layout, &family.times, &reads)
}

#[test]
fn accessible_value_lists_times() {
    for (clock_hz, pause_us) in [(400e3, 200), (2e6, 600_000), (1e3, 1), (80e3, 0)] {
        for width in [300.0_f32, 880.0] {
            let diagram = diagram(clock_hz, pause_us);
            let harness = window(diagram.clone(), move |ui, own: &mut BurstDiagram| {
                ui.set_max_width(width);
                let frame = Some(0x091_D4B6);
                timing_diagram(ui, &theme(), &TimingDiagram { label: "Burst", diagram: own, frame });
            });
            let picture = harness.get_by_label("Burst");
            let value = picture.value().unwrap();
            let words: Vec<String> =
                diagram.spans().iter().map(|span| theme().format_text(&diagram.span_text(span))).collect();
            assert_eq!(value, words.join(", "));
            assert!(picture.rect().width() <= width, "{}", picture.rect());
        }
    }
}

#[test]
fn hovering_shows_clock() {
    let mut harness = window(diagram(400e3, 200), |ui, own: &mut BurstDiagram| {
        timing_diagram(ui, &theme(), &TimingDiagram { label: "Burst", diagram: own, frame: None });
    });
    let rect = harness.get_by_label("Burst").rect();
    // The burst takes up at least a quarter of the axis before the first break, so moving the pointer visits clock
    // after clock.
    let mut seen: Vec<u8> = Vec::new();
    for step in 0..16 {
        let x = rect.left() + rect.width() * (0.06 + 0.02 * step as f32);
        harness.hover_at(egui::pos2(x, rect.center().y));
        harness.run_steps(60);
        let is_told = |clock: &u8| harness.query_by_label_contains(&format!("Clock {clock}: ")).is_some();
        seen.extend((1..=27).find(is_told));
    }
    assert!(seen.len() >= 8 && seen.is_sorted(), "{seen:?}");
    assert!(seen.first().is_some_and(|first| *first <= 3), "{seen:?}");
}
