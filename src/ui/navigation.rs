//! The navigation: the tabs, and the pages of the open one.

use egui::Ui;

use super::controls::{icon_button, name};
use super::docks::Docks;
use super::{Skin, Views, icons};
use crate::app::{Action, Studio, Tab};
use crate::devices::biss::views as biss;
use crate::devices::hiperdrive::views as hiperdrive;
use crate::devices::hiperface::views as hiperface;
use crate::devices::interbus::views as interbus;
use crate::devices::ssi::views as ssi;
use crate::signals::views as signals;

/// The tabs, with the pages of the open one.
pub(super) fn navigation_ui(
    ui: &mut Ui,
    skin: &Skin,
    studio: &Studio,
    views: &mut Views,
    docks: &mut Docks,
    actions: &mut Vec<Action>,
) {
    ui.spacing_mut().item_spacing.y = skin.space.inside;
    for tab in Tab::DEVICES.into_iter().chain([Tab::Signals]) {
        let word = tab.bus().map_or_else(|| skin.say("tab.signals"), str::to_owned);
        let text = egui::RichText::new(&word).font(skin.strong(skin.sizes.body));
        if entry(ui, false, text, &word).clicked() {
            views.plot.make_small();
            actions.push(Action::ShowTab(tab));
        }
        if tab == studio.settings.tab {
            open_pages(ui, skin, studio, views);
        }
    }
    // At the foot, so that it is drawn wherever the rest ends.
    let foot = ui.max_rect().with_min_y(ui.max_rect().bottom() - 28.0);
    let mut foot = ui.new_child(egui::UiBuilder::new().max_rect(foot));
    if icon_button(&mut foot, true, icons::ARROWS_CLOCKWISE, &skin.say("shell.reset_layout")).clicked() {
        docks.reset();
    }
}

/// The pages of a tab, as its kind has them.
trait TabPage: Copy + PartialEq {
    /// Its icon and its word.
    fn face(self) -> (&'static str, &'static str);
}

macro_rules! tab_pages {
    ($($page:path),*) => {
        $(impl TabPage for $page {
            fn face(self) -> (&'static str, &'static str) {
                (self.icon(), self.word())
            }
        })*
    };
}

tab_pages!(hiperface::Page, biss::Page, ssi::Page, interbus::Page, hiperdrive::Page, signals::Page);

/// The entries of a tab's pages; the page that was pressed. Edits that are not written mark the page that `edited` names.
fn pages_ui<P: TabPage>(
    ui: &mut Ui,
    skin: &Skin,
    all: impl IntoIterator<Item = P>,
    shown: P,
    edited: impl Fn(P) -> bool,
) -> Option<P> {
    let mut pressed = None;
    for page in all {
        let (icon, id) = page.face();
        let word = skin.say(id);
        let mut text = egui::RichText::new(format!("{icon}  {word}"));
        if edited(page) {
            text = text.color(skin.palette.staged);
        }
        if entry(ui, shown == page, text, &word).clicked() {
            pressed = Some(page);
        }
    }
    pressed
}

/// The pages of the open tab, where it shows something.
fn open_pages(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views) {
    let has_moved = match studio.settings.tab {
        Tab::Hiperface => studio.hiperface().is_some_and(|encoder| {
            let edited = |page| page == hiperface::Page::Memory && encoder.staged.is_dirty();
            let shown = &mut views.hiperface(encoder).page;
            move_to(shown, pages_ui(ui, skin, hiperface::Page::ALL, *shown, edited))
        }),
        Tab::Biss => studio.biss().is_some_and(|encoder| {
            let edited = |page| page == biss::Page::Data && encoder.is_dirty();
            let shown = &mut views.biss(encoder).page;
            move_to(shown, pages_ui(ui, skin, biss::Page::ALL, *shown, edited))
        }),
        Tab::Ssi => studio.ssi().is_some_and(|encoder| {
            let edited = |page| page == ssi::Page::Frame && encoder.is_dirty();
            let shown = &mut views.ssi(encoder).page;
            move_to(shown, pages_ui(ui, skin, ssi::Page::ALL, *shown, edited))
        }),
        Tab::Interbus => studio.interbus().is_some_and(|encoder| {
            let edited = |page| match page {
                interbus::Page::Parameters => encoder.edits_parameters(),
                interbus::Page::Cams => encoder.edits_cams(),
                _ => false,
            };
            let shown = &mut views.interbus(encoder).page;
            move_to(shown, pages_ui(ui, skin, interbus::Page::ALL, *shown, edited))
        }),
        Tab::Hiperdrive => studio.hiperdrive().is_some_and(|unit| {
            let edited = |page| page == hiperdrive::Page::Parameters && unit.is_dirty();
            let shown = &mut views.hiperdrive(unit).page;
            move_to(shown, pages_ui(ui, skin, hiperdrive::Page::ALL, *shown, edited))
        }),
        Tab::Signals => {
            let shown = &mut views.signals.page;
            move_to(shown, pages_ui(ui, skin, signals::Page::ALL, *shown, |_| false))
        }
    };
    if has_moved {
        views.plot.make_small();
    }
}

fn move_to<P>(shown: &mut P, pressed: Option<P>) -> bool {
    let has_moved = pressed.is_some();
    if let Some(pressed) = pressed {
        *shown = pressed;
    }
    has_moved
}

/// An entry of the navigation, as wide as it.
fn entry(ui: &mut Ui, is_shown: bool, text: egui::RichText, word: &str) -> egui::Response {
    let size = egui::vec2(ui.available_width(), 32.0);
    let button = egui::Button::selectable(is_shown, (text, egui::Atom::grow())).frame_when_inactive(false);
    name(ui.add(button.min_size(size)), true, word)
}
