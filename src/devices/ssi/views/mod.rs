//! The SSI tab: one page per task.

mod compared;
mod connect_form;
mod encoder;
mod export;
mod find;
mod form;
mod frame;
mod frames;
mod live;
mod picture;
mod timing;
mod trial;
mod widgets;
mod wiring;

use egui::Ui;

use crate::app::{Action, AnyDevice, DeviceModel, Rgb, Studio, Text};
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::state::{Encoder, SsiAction, TEXTS};
use crate::ui::controls::labelled_button;
use crate::ui::device_view::{PageInfo, TabPage, TypedDeviceView};
use crate::ui::{NamedAction, Theme, icons, page};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    /// Page with the layout of the frame and a trial frame.
    #[default]
    Frame,
    Timing,
    Find,
    Export,
    /// Page with the adapter, reported error bits and the wiring of the encoder.
    Encoder,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Frame, PageInfo::new(icons::TABLE, "page.frame", "help.ssi_frame")),
        (Page::Timing, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.timing", "help.ssi_timing")),
        (Page::Find, PageInfo::new(icons::MAGNIFYING_GLASS, "page.find", "help.ssi_find")),
        (Page::Export, PageInfo::new(icons::DOWNLOAD_SIMPLE, "page.export", "help.ssi_export")),
        (Page::Encoder, PageInfo::new(icons::CPU, "page.encoder", "help.ssi_encoder")),
    ];
}

/// State of a session's pages that persists between UI frames, such as entered text.
#[derive(Default)]
pub(crate) struct SsiUiState {
    form: form::LayoutFormUiState,
    frame: frame::FrameUiState,
    trial: trial::TrialUiState,
    export: export::ExportUiState,
    find: find::FindUiState,
}

pub(crate) struct SsiView;

impl TypedDeviceView for SsiView {
    type Device = Encoder;
    type Page = Page;
    type Memory = SsiUiState;
    type ConnectForm = connect_form::SsiConnectForm;

    const HAS_UNDO_KEYS: bool = true;

    fn compared_picture() -> Option<Text> {
        Some(TEXTS.text("report.ssi_frame"))
    }

    fn compared_picture_ui(ui: &mut Ui, theme: &Theme, left: &SsiProfile, right: &SsiProfile) {
        compared::frames_ui(ui, theme, left, right);
    }

    fn named_actions(theme: &Theme, encoder: &Encoder) -> Vec<NamedAction> {
        let own = |word, action| {
            NamedAction::new(theme, word, encoder.session.is_ready(), Action::device(encoder.session.id, action))
        };
        vec![own("check_card.run", SsiAction::Check)]
    }

    fn is_edited(encoder: &Encoder, page: Page) -> bool {
        page == Page::Frame && encoder.is_dirty()
    }

    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        encoder: &Encoder,
        (page, view): (Page, &mut SsiUiState),
        actions: &mut Vec<Action>,
    ) {
        page::scrollable_page(ui, theme, (encoder.session.id, page.index()), |ui| match page {
            Page::Frame => frame::page_ui(ui, theme, (studio, device), encoder, view, actions),
            Page::Timing => timing::page_ui(ui, theme, encoder, &mut view.form, actions),
            Page::Find => find::page_ui(ui, theme, encoder, &mut view.find, actions),
            Page::Export => export::page_ui(ui, theme, encoder, &mut view.export, actions),
            Page::Encoder => encoder::page_ui(ui, theme, encoder, actions),
        });
    }

    /// Draws nothing, because a transfer ends immediately.
    fn running_ui(_: &mut Ui, _: &Theme, _: &AnyDevice, _: &Encoder, _: Page, _: &mut Vec<Action>) {}

    fn empty_ui(ui: &mut Ui, theme: &Theme, actions: &mut Vec<Action>) {
        // A layout can be created without a device.
        if labelled_button(ui, icons::PLUS, &translate(theme, "ssi.new_layout")).clicked() {
            actions.push(Action::New(Encoder::TAB));
        }
    }

    fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
        live::value_ui(ui, theme, encoder, ink);
    }
}

/// Returns a message from the SSI or common catalogue, in the language of the window.
pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
