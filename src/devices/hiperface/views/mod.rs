//! The HIPERFACE tab: one page per task.

mod commutation;
mod connect_form;
mod encoder;
mod live;
mod memory;
mod position;
mod setup;
mod values;
mod wiring;

use egui::Ui;

use crate::app::{Action, AnyDevice, PendingEdits, Rgb, Studio};
use crate::devices::hiperface::state::{Encoder, HiperfaceAction, TEXTS};
use crate::ui::device_view::{PageInfo, TabPage, TypedDeviceView};
use crate::ui::{NamedAction, Theme, backups, icons, page};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Encoder,
    Memory,
    Values,
    Setup,
    Commutation,
    Backups,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Encoder, PageInfo::new(icons::CPU, "page.encoder", "help.encoder")),
        (Page::Memory, PageInfo::new(icons::MEMORY, "page.memory", "help.memory")),
        (Page::Values, PageInfo::new(icons::GAUGE, "page.values", "help.values")),
        (Page::Setup, PageInfo::new(icons::SLIDERS, "page.setup", "help.setup")),
        (Page::Commutation, PageInfo::new(icons::LIGHTNING, "page.commutation", "help.commutation")),
        (Page::Backups, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.backups", "help.backups")),
    ];
}

/// State of the tab for one session, such as selections and entered text.
#[derive(Default)]
pub(crate) struct HiperfaceUiState {
    memory: memory::MemoryUiState,
    values: values::ValuesUiState,
    setup: setup::SetupUiState,
    check_restart: bool,
    /// Analogue channel to watch, as entered.
    channel: String,
}

pub(crate) struct HiperfaceView;

impl TypedDeviceView for HiperfaceView {
    type Device = Encoder;
    type Page = Page;
    type Memory = HiperfaceUiState;
    type ConnectForm = connect_form::HiperfaceConnectForm;

    const HAS_UNDO_KEYS: bool = false;

    fn serial_number(encoder: &Encoder) -> Option<&str> {
        encoder.identity.as_ref().map(|identity| identity.serial.serial_number.as_str())
    }

    fn named_actions(theme: &Theme, encoder: &Encoder) -> Vec<NamedAction> {
        let own = |word, action| {
            NamedAction::new(theme, word, encoder.session.is_ready(), Action::device(encoder.session.id, action))
        };
        vec![
            own("check_card.run", HiperfaceAction::Check { restart: false }),
            own("palette.read_status", HiperfaceAction::ReadStatus),
        ]
    }

    fn is_edited(encoder: &Encoder, page: Page) -> bool {
        page == Page::Memory && encoder.staged.is_dirty()
    }

    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        encoder: &Encoder,
        (page, view): (Page, &mut HiperfaceUiState),
        actions: &mut Vec<Action>,
    ) {
        if page == Page::Memory {
            // The editor handles its own scrolling, so that its buttons stay in place.
            egui::Frame::NONE
                .inner_margin(page::page_margin(ui, theme))
                .show(ui, |ui| memory::page_ui(ui, theme, (studio, device), encoder, &mut view.memory, actions));
            return;
        }
        page::scrollable_page(ui, theme, (encoder.session.id, page.index()), |ui| match page {
            Page::Encoder => encoder::page_ui(ui, theme, encoder, &mut view.check_restart, actions),
            Page::Values => values::page_ui(ui, theme, encoder, &mut view.values, actions),
            Page::Setup => setup::page_ui(ui, theme, encoder, &mut view.setup, actions),
            Page::Commutation => commutation::page_ui(ui, theme, encoder, actions),
            Page::Backups => backups::page_ui(ui, theme, (studio, device), actions),
            Page::Memory => {}
        });
    }

    fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
        live::value_ui(ui, theme, encoder, ink);
    }

    fn watch_menu(
        ui: &mut Ui,
        theme: &Theme,
        encoder: &Encoder,
        view: &mut HiperfaceUiState,
        actions: &mut Vec<Action>,
    ) {
        live::watch_menu(ui, theme, encoder, &mut view.channel, actions);
    }
}

/// Returns a message in the window's language, from the HIPERFACE catalogue or the common one.
pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
