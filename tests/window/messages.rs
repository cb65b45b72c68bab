//! Tests that messages appear and disappear on a page without moving anything clickable.

use egui::Rect;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, Language};
use encoder_studio::devices::interbus::state::{Edit, InterbusAction as Interbus};

use crate::hiperdrive_jog::screen_in_control;
use crate::screen::Screen;
use crate::tabs::Tabs as _;

const SIZES: [[f32; 2]; 2] = [[1280.0, 800.0], [1024.0, 640.0]];

/// Returns the buttons and entries with their labels and rectangles.
fn places(screen: &Screen) -> Vec<(Role, String, Rect)> {
    let nodes = screen.harness.query_all_by(|node| {
        matches!(node.role(), Role::Button | Role::TextInput | Role::CheckBox | Role::ComboBox | Role::Slider)
    });
    let mut places: Vec<_> = nodes
        .map(|node| {
            let own = node.accesskit_node();
            (own.role(), own.label().unwrap_or_default(), node.rect())
        })
        .collect();
    places.sort_by(|one, other| one.1.cmp(&other.1).then(one.2.top().total_cmp(&other.2.top())));
    places
}

#[track_caller]
fn assert_nothing_moved(before: &[(Role, String, Rect)], after: &[(Role, String, Rect)]) {
    for (role, label, place) in before {
        let now: Vec<_> = after.iter().filter(|own| own.0 == *role && own.1 == *label).collect();
        // The button of a job that has ended in the meantime may be missing.
        let stays = now.is_empty() || now.iter().any(|own| own.2 == *place);
        assert!(stays, "{role:?} {label:?} was at {place:?}: {now:?}");
    }
}

#[test]
fn rejected_target_does_not_shift_layout() {
    // The window is so high that the button can be reached without scrolling.
    for size in SIZES.map(|[width, height]| [width, height * 2.0]) {
        let mut screen = screen_in_control("sim:", size);
        let label = screen.say("hd_move.target");
        screen.harness.get_by_role_and_label(Role::TextInput, &label).focus();
        screen.steps();
        screen.harness.get_by_role_and_label(Role::TextInput, &label).type_text("far away");
        screen.steps();
        let before = places(&screen);
        assert!(!screen.is_enabled("hd_move.go"));
        assert!(screen.shows("far away"), "the reason is shown");
        screen.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        screen.harness.get_by_role_and_label(Role::TextInput, &label).type_text("100");
        screen.steps();
        assert!(screen.is_enabled("hd_move.go") && !screen.shows("far away"));
        assert_nothing_moved(&before, &places(&screen));
    }
}

#[test]
fn out_of_range_cams_do_not_shift_layout() {
    for size in SIZES {
        let link = "sim:?steps=3600&revolutions=1&cams=demo";
        let mut screen = Screen::open_in_tab(crate::tabs::INTERBUS, link, size);
        screen.until("it is read", |studio| {
            studio.interbus().is_some_and(|own| own.known_program_count() == 8 && own.session.is_ready())
        });
        screen.click("page.parameters");
        let id = screen.studio().interbus().unwrap().session.id;
        let edit = |steps| Action::device(id, Interbus::Edit(Box::new(Edit::Steps(steps))));
        // The first edit causes no message, but enables the buttons of the edit bar.
        screen.act(edit(3601));
        let before = places(&screen);
        screen.act(edit(3000));
        assert!(screen.shows("are outside the measuring range, which ends at 2999."));
        assert_nothing_moved(&before, &places(&screen));
        screen.act(Action::SetLanguage(Language::German));
        screen.check_language();
    }
}
