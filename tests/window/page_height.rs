//! Tests that each page can be seen completely in a small window after scrolling at most once.

use egui::Role;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::{Action, Language, Studio, Tab};

use crate::screen::Screen;
use crate::tabs::{BISS, HIPERDRIVE, INTERBUS, SSI, Tabs as _};

const SIZE: [f32; 2] = [1024.0, 640.0];
/// Left and right edges of a page between the navigation and the Live panel.
const PAGE: (f32, f32) = (160.0, 764.0);
/// Height of the header, in points.
const HEADER: f32 = 48.0;
/// Height of the status line below the page, in points.
const STATUS: f32 = 36.0;
/// Height of the drive bar above the page, in points.
const BAR: f32 = 88.0;
/// Pages that are not checked, because a table, an editor or text on them scrolls separately.
const SCROLLED: [&str; 5] = ["page.registers", "page.memory", "page.data", "page.export", "page.parameters"];

/// Returns the lower end of the page's content, even if it is not visible.
fn end_of_page(screen: &Screen) -> f32 {
    let counts = |role| {
        matches!(
            role,
            Role::Label | Role::Button | Role::CheckBox | Role::RadioButton | Role::ComboBox | Role::TextInput
        )
    };
    let nodes = screen.harness.query_all_by(|node| counts(node.role()));
    let rects = nodes.map(|node| node.rect()).filter(|rect| rect.left() > PAGE.0 && rect.right() < PAGE.1);
    // The status line and the edit bar are fixed, so they do not count.
    let below = SIZE[1] - STATUS;
    rects.filter(|rect| rect.top() < below - 44.0 || rect.top() > SIZE[1]).map(|rect| rect.bottom()).fold(0.0, f32::max)
}

fn too_high(screen: &mut Screen, bar: f32) -> Vec<String> {
    let mut found = Vec::new();
    for language in [Language::English, Language::German] {
        screen.act(Action::SetLanguage(language));
        let pages = encoder_studio::kinds::program().tabs.page_text_ids(screen.studio().settings.tab);
        for page in pages.into_iter().filter(|page| !SCROLLED.contains(page)) {
            screen.click(page);
            screen.steps();
            let top = HEADER + bar;
            let most = top + 2.0 * (SIZE[1] - STATUS - top);
            let end = end_of_page(screen);
            if end > most {
                found.push(format!("{page} in {language:?}: {end} > {most}"));
            }
        }
    }
    found
}

#[test]
fn pages_need_at_most_one_scroll() {
    let mut found = too_high(&mut Screen::new_form(SIZE), 0.0);
    type Case = (Tab, f32, fn(&Studio) -> bool);
    let cases: [Case; 4] = [
        (BISS, 0.0, |studio| studio.biss().is_some_and(|own| own.session.is_ready() && own.survey.is_some())),
        (SSI, 0.0, |studio| studio.ssi().is_some_and(|own| own.last().is_some())),
        (INTERBUS, 0.0, |studio| {
            studio.interbus().is_some_and(|own| own.identity().is_some() && own.session.is_ready())
        }),
        (HIPERDRIVE, BAR, |studio| {
            studio.hiperdrive().is_some_and(|own| own.session.is_ready() && own.survey.is_some())
        }),
    ];
    for (tab, bar, is_read) in cases {
        let mut screen = Screen::open_in_tab(tab, "sim:", SIZE);
        screen.until("it is read", is_read);
        found.extend(too_high(&mut screen, bar));
    }
    assert!(found.is_empty(), "{found:#?}");
}
