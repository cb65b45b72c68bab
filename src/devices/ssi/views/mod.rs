//! The SSI tab: its pages, each about one thing that a person wants of a frame or of an encoder that sends it.

pub(crate) mod connect_form;
mod encoder;
mod export;
mod find;
mod form;
mod frame;
pub(crate) mod live;
mod timing;
mod trial;
mod widgets;
mod wiring;

use egui::Ui;

use crate::app::{Action, AnyDevice, Studio};
use crate::devices::ssi::state::Encoder;
use crate::ui::{Skin, icons, page};

/// A page of the tab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    /// The frame on the drawing board, and a frame to try it with.
    #[default]
    Frame,
    /// What the times of a transfer allow.
    Timing,
    /// The search for the layout of frames that were read.
    Find,
    /// The layout for other programs.
    Export,
    /// The encoder behind its adapter, what its error bits said, its wiring.
    Encoder,
}

impl Page {
    pub(crate) const ALL: [Page; 5] = [Page::Frame, Page::Timing, Page::Find, Page::Export, Page::Encoder];

    pub(crate) fn icon(self) -> &'static str {
        match self {
            Page::Frame => icons::TABLE,
            Page::Timing => icons::CLOCK_COUNTER_CLOCKWISE,
            Page::Find => icons::MAGNIFYING_GLASS,
            Page::Export => icons::DOWNLOAD_SIMPLE,
            Page::Encoder => icons::CPU,
        }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Page::Frame => "page.frame",
            Page::Timing => "page.timing",
            Page::Find => "page.find",
            Page::Export => "page.export",
            Page::Encoder => "page.encoder",
        }
    }

    pub(crate) fn help(self) -> &'static str {
        match self {
            Page::Frame => "help.ssi_frame",
            Page::Timing => "help.ssi_timing",
            Page::Find => "help.ssi_find",
            Page::Export => "help.ssi_export",
            Page::Encoder => "help.ssi_encoder",
        }
    }
}

/// What the tab remembers of one session while the window is open: text buffers and selections.
#[derive(Default)]
pub(crate) struct View {
    /// The open page.
    pub page: Page,
    form: form::View,
    frame: frame::View,
    trial: trial::View,
    export: export::View,
    find: find::View,
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
    page::scrolling(ui, skin, (encoder.session.id, view.page.word()), |ui| match view.page {
        Page::Frame => frame::page_ui(ui, skin, (studio, device), encoder, view, actions),
        Page::Timing => timing::page_ui(ui, skin, encoder, &mut view.form, actions),
        Page::Find => find::page_ui(ui, skin, encoder, &mut view.find, actions),
        Page::Export => export::page_ui(ui, skin, encoder, &mut view.export, actions),
        Page::Encoder => encoder::page_ui(ui, skin, encoder, actions),
    });
}
