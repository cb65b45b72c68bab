//! The HIPERFACE tab: its pages, each about one thing that a person wants of an encoder.

mod commutation;
pub(crate) mod connect_form;
mod encoder;
pub(crate) mod live;
mod memory;
mod setup;
mod values;
mod wiring;

use egui::Ui;

use crate::app::{Action, AnyDevice, Studio};
use crate::devices::hiperface::state::Encoder;
use crate::ui::{Skin, backups, icons, page};

/// A page of the tab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    /// Who it is, how it is, and how it is wired.
    #[default]
    Encoder,
    /// Its memory.
    Memory,
    /// Analogue values and the counter.
    Values,
    /// Position, address, line settings, restart, access codes.
    Setup,
    /// The offset between encoder and motor.
    Commutation,
    /// Profiles, backups and what was written.
    Backups,
}

impl Page {
    pub(crate) const ALL: [Page; 6] =
        [Page::Encoder, Page::Memory, Page::Values, Page::Setup, Page::Commutation, Page::Backups];

    pub(crate) fn icon(self) -> &'static str {
        match self {
            Page::Encoder => icons::CPU,
            Page::Memory => icons::MEMORY,
            Page::Values => icons::GAUGE,
            Page::Setup => icons::SLIDERS,
            Page::Commutation => icons::LIGHTNING,
            Page::Backups => icons::CLOCK_COUNTER_CLOCKWISE,
        }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Page::Encoder => "page.encoder",
            Page::Memory => "page.memory",
            Page::Values => "page.values",
            Page::Setup => "page.setup",
            Page::Commutation => "page.commutation",
            Page::Backups => "page.backups",
        }
    }

    pub(crate) fn help(self) -> &'static str {
        match self {
            Page::Encoder => "help.encoder",
            Page::Memory => "help.memory",
            Page::Values => "help.values",
            Page::Setup => "help.setup",
            Page::Commutation => "help.commutation",
            Page::Backups => "help.backups",
        }
    }
}

/// What the tab remembers of one session while the window is open: text buffers and selections.
#[derive(Default)]
pub(crate) struct View {
    /// The open page.
    pub page: Page,
    /// The encoder that the rest is about.
    serial_number: Option<String>,
    memory: memory::View,
    values: values::View,
    setup: setup::View,
    check_restart: bool,
}

impl View {
    /// What was typed for another encoder is not for this one.
    pub(crate) fn follow(&mut self, encoder: &Encoder) {
        let Some(identity) = &encoder.identity else { return };
        let own = &identity.serial.serial_number;
        if self.serial_number.as_ref().is_some_and(|before| before != own) {
            *self = View { page: self.page, ..View::default() };
        }
        self.serial_number = Some(own.clone());
    }
}

/// Draws the open page.
pub(crate) fn page_ui(
    ui: &mut Ui,
    skin: &Skin,
    (studio, device): (&Studio, &AnyDevice),
    encoder: &Encoder,
    view: &mut View,
    actions: &mut Vec<Action>,
) {
    if view.page == Page::Memory {
        // The editor scrolls by itself; its buttons stay where they are.
        egui::Frame::NONE
            .inner_margin(page::around(ui, skin))
            .show(ui, |ui| memory::page_ui(ui, skin, (studio, device), encoder, &mut view.memory, actions));
        return;
    }
    page::scrolling(ui, skin, (encoder.session.id, view.page.word()), |ui| match view.page {
        Page::Encoder => encoder::page_ui(ui, skin, encoder, &mut view.check_restart, actions),
        Page::Values => values::page_ui(ui, skin, encoder, &mut view.values, actions),
        Page::Setup => setup::page_ui(ui, skin, encoder, &mut view.setup, actions),
        Page::Commutation => commutation::page_ui(ui, skin, encoder, actions),
        Page::Backups => backups::page_ui(ui, skin, device, actions),
        Page::Memory => {}
    });
}
