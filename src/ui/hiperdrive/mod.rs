//! The HIPERDRIVE tab: its parameters as they were read, profiles and backups.

use egui::{ScrollArea, Ui};

use super::controls::row;
use super::{Skin, backups, foot, icons};
use crate::app::hiperdrive::Unit;
use crate::app::{Action, AnyDevice, Studio};

/// A page of the tab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::ui) enum Page {
    /// Every parameter.
    #[default]
    Parameters,
    /// Profiles, backups and what was written.
    Backups,
}

impl Page {
    pub(super) const ALL: [Page; 2] = [Page::Parameters, Page::Backups];

    pub(super) fn icon(self) -> &'static str {
        match self {
            Page::Parameters => icons::SLIDERS,
            Page::Backups => icons::CLOCK_COUNTER_CLOCKWISE,
        }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Page::Parameters => "page.parameters",
            Page::Backups => "page.backups",
        }
    }

    pub(super) fn help(self) -> &'static str {
        "help.backups"
    }
}

/// What the tab remembers of one session while the window is open.
#[derive(Default)]
pub(in crate::ui) struct View {
    /// The open page.
    pub page: Page,
}

impl View {
    /// There is nothing that is about one device alone.
    pub(super) fn follow(&mut self, _unit: &Unit) {}
}

/// Draws the open page.
pub(super) fn page_ui(
    ui: &mut Ui,
    skin: &Skin,
    (studio, device): (&Studio, &AnyDevice),
    unit: &Unit,
    view: &mut View,
    actions: &mut Vec<Action>,
) {
    ScrollArea::vertical().id_salt((unit.session.id, view.page.word())).auto_shrink(false).show(ui, |ui| {
        match view.page {
            Page::Parameters => {
                for own in unit.rows(None).into_iter().chain(unit.rows(Some(unit.drive()))) {
                    row(ui, skin, &skin.words(&own.name), skin.mono(own.shown));
                }
                foot::foot_ui(ui, skin, studio, device, actions);
            }
            Page::Backups => backups::page_ui(ui, skin, device, actions),
        }
    });
}
