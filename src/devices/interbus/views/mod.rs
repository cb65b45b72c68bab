//! The INTERBUS tab, with one page per task.

mod cams;
mod compared;
mod connect_form;
mod encoder;
mod leds;
mod live;
mod marks;
mod parameters;
mod read_outs;
mod reader;
mod standstill;
mod widgets;

use egui::Ui;

use crate::app::{Action, AnyDevice, Rgb, Studio, Text};
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::state::{Encoder, InterbusAction, TEXTS};
use crate::ui::device_view::{PageInfo, TabPage, TypedDeviceView};
use crate::ui::{NamedAction, Theme, backups, edit_bar, icons, page};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Encoder,
    /// Position parameters, and the words that set them.
    Parameters,
    Cams,
    Diagnosis,
    Backups,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Encoder, PageInfo::new(icons::CPU, "page.encoder", "help.ib_encoder")),
        (Page::Parameters, PageInfo::new(icons::SLIDERS, "page.parameters", "help.ib_parameters")),
        (Page::Cams, PageInfo::new(icons::CHART_LINE, "page.cams", "help.ib_cams")),
        (Page::Diagnosis, PageInfo::new(icons::MAGNIFYING_GLASS, "page.diagnosis", "help.ib_diagnosis")),
        (Page::Backups, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.backups", "help.backups")),
    ];
}

impl Page {
    /// Returns whether the page has a bar for writing edits to the encoder.
    fn has_edit_bar(self) -> bool {
        matches!(self, Page::Parameters | Page::Cams)
    }
}

/// State of the tab that is kept between frames, such as entered text and selections.
#[derive(Default)]
pub(crate) struct InterbusUiState {
    parameters: parameters::EncoderParametersUiState,
    cams: cams::CamsUiState,
    reader: reader::WordReaderUiState,
    lamps: leds::LedsUiState,
}

pub(crate) struct InterbusView;

impl TypedDeviceView for InterbusView {
    type Device = Encoder;
    type Page = Page;
    type Memory = InterbusUiState;
    type ConnectForm = connect_form::InterbusConnectForm;

    const HAS_UNDO_KEYS: bool = true;

    fn serial_number(encoder: &Encoder) -> Option<&str> {
        encoder.serial_number()
    }

    fn compared_picture() -> Option<Text> {
        Some(TEXTS.text("ib_card.programs"))
    }

    fn compared_picture_ui(ui: &mut Ui, theme: &Theme, left: &InterbusProfile, right: &InterbusProfile) {
        compared::programs_ui(ui, theme, left, right);
    }

    fn named_actions(theme: &Theme, encoder: &Encoder) -> Vec<NamedAction> {
        let own = |word, action| {
            NamedAction::new(
                theme,
                word,
                encoder.session.is_ready() && encoder.is_stopped(),
                Action::device(encoder.session.id, action),
            )
        };
        vec![own("check_card.run", InterbusAction::Check)]
    }

    fn is_edited(encoder: &Encoder, page: Page) -> bool {
        match page {
            Page::Parameters => encoder.has_parameter_edits(),
            Page::Cams => encoder.has_cam_edits(),
            _ => false,
        }
    }

    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        encoder: &Encoder,
        (page, view): (Page, &mut InterbusUiState),
        actions: &mut Vec<Action>,
    ) {
        if page.has_edit_bar() {
            // The bar stays in place while the page scrolls.
            let around = page::side_margin(ui, theme);
            let margin = egui::Margin { left: around, right: around, top: 0, bottom: 8 };
            egui::Panel::bottom(egui::Id::unique(encoder.session.id).with("interbus_foot"))
                .frame(egui::Frame::NONE.inner_margin(margin))
                .show_separator_line(false)
                .show(ui, |ui| edit_bar::edit_bar_ui(ui, theme, (studio, device), edit_bar::EditKind::Values, actions));
        }
        let shown = (page == Page::Cams).then(|| view.cams.displayed_program());
        marks::marks_ui(ui, theme, encoder, shown);
        page::scrollable_page(ui, theme, (encoder.session.id, page.index()), |ui| {
            if page != Page::Backups {
                standstill::bar_ui(ui, theme, encoder, actions);
            }
            match page {
                Page::Encoder => encoder::page_ui(ui, theme, encoder, actions),
                Page::Parameters => parameters::page_ui(ui, theme, encoder, &mut view.parameters, actions),
                Page::Cams => cams::page_ui(ui, theme, encoder, &mut view.cams, actions),
                Page::Diagnosis => {
                    read_outs::cards_ui(ui, theme, encoder, actions);
                    theme.add_gap(ui);
                    reader::card_ui(ui, theme, &mut view.reader);
                    theme.add_gap(ui);
                    leds::cards_ui(ui, theme, &mut view.lamps);
                }
                Page::Backups => backups::page_ui(ui, theme, (studio, device), actions),
            }
        });
    }

    fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
        live::value_ui(ui, theme, encoder, ink);
    }
}

pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
