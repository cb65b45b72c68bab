//! The BiSS tab, which has one page per task.

mod connect_form;
mod data;
mod encoder;
mod frame;
mod live;
mod motor;
mod procedures;
mod registers;
mod run;
mod sheet;
mod wiring;

use egui::Ui;

use crate::app::{Action, AnyDevice, Rgb, Studio};
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS};
use crate::ui::controls::{enabled_button, paragraph};
use crate::ui::device_view::{PageInfo, TabPage, TypedDeviceView};
use crate::ui::{NamedAction, Theme, backups, icons, page, status_line};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Page {
    #[default]
    Encoder,
    Registers,
    Data,
    Procedures,
    Backups,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Encoder, PageInfo::new(icons::CPU, "page.encoder", "help.biss_encoder")),
        (Page::Registers, PageInfo::new(icons::TABLE, "page.registers", "help.biss_registers")),
        (Page::Data, PageInfo::new(icons::MEMORY, "page.data", "help.biss_data")),
        (Page::Procedures, PageInfo::new(icons::LIST_CHECKS, "page.procedures", "help.biss_procedures")),
        (Page::Backups, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.backups", "help.backups")),
    ];
}

impl Page {
    /// Returns whether the page scrolls its content itself, so that its buttons stay in place.
    fn handles_scrolling(self) -> bool {
        matches!(self, Page::Registers | Page::Data)
    }
}

#[derive(Default)]
pub(crate) struct BissUiState {
    registers: registers::RegistersUiState,
    data: data::DataUiState,
    procedures: procedures::ProceduresUiState,
}

/// Draws messages below the table of a page, so that they do not move anything clickable.
fn messages_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let id = egui::Id::unique(encoder.session.id).with("biss_messages");
    egui::Panel::bottom(id).frame(egui::Frame::NONE).show_separator_line(false).show(ui, |ui| {
        unsaved_warning_ui(ui, theme, encoder, actions);
        read_rejection_ui(ui, theme, encoder, actions);
    });
}

fn read_rejection_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(why) = &encoder.refusal else { return };
    ui.horizontal_top(|ui| {
        ui.label(egui::RichText::new(icons::WARNING).color(theme.palette.warn));
        paragraph(ui, theme.format_text(why));
    });
    motor::motor_running_note_ui(ui, theme, encoder, actions);
}

fn unsaved_warning_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(why) = encoder.unsaved_warning() else { return };
    ui.horizontal_top(|ui| {
        ui.label(egui::RichText::new(icons::WARNING).color(theme.palette.warn));
        paragraph(ui, theme.format_text(&why));
    });
    if encoder.profile().is_none() {
        return_to_operation_ui(ui, theme, encoder, actions);
    }
    ui.add_space(theme.space.inside);
}

fn return_to_operation_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let word = theme.translate("lead_back_card.button");
    if enabled_button(ui, encoder.session.is_ready(), icons::ARROW_U_UP_LEFT, &word).clicked() {
        actions.push(Action::device(encoder.session.id, Biss::ReturnToOperation));
    }
}

pub(crate) struct BissView;

impl TypedDeviceView for BissView {
    type Device = Encoder;
    type Page = Page;
    type Memory = BissUiState;
    type ConnectForm = connect_form::BissConnectForm;

    const HAS_UNDO_KEYS: bool = false;

    fn serial_number(encoder: &Encoder) -> Option<&str> {
        encoder.serial_number()
    }

    fn named_actions(theme: &Theme, encoder: &Encoder) -> Vec<NamedAction> {
        let own = |word, action| {
            NamedAction::new(theme, word, encoder.session.is_ready(), Action::device(encoder.session.id, action))
        };
        vec![own("check_card.run", Biss::Check), own("palette.read_status", Biss::ReadStatus)]
    }

    fn is_edited(encoder: &Encoder, page: Page) -> bool {
        page == Page::Data && encoder.is_dirty()
    }

    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        encoder: &Encoder,
        (page, view): (Page, &mut BissUiState),
        actions: &mut Vec<Action>,
    ) {
        if page.handles_scrolling() {
            // Tables fill the available space.
            let frame = egui::Frame::NONE.inner_margin(page::page_margin(ui, theme));
            frame.show(ui, |ui| match page {
                Page::Data => data::page_ui(ui, theme, (studio, device), encoder, &mut view.data, actions),
                _ => registers::page_ui(ui, theme, encoder, &mut view.registers, actions),
            });
            return;
        }
        page::scrollable_page(ui, theme, (encoder.session.id, page.index()), |ui| match page {
            Page::Backups => backups::page_ui(ui, theme, (studio, device), actions),
            Page::Procedures => procedures::page_ui(ui, theme, studio, encoder, &mut view.procedures, actions),
            _ => encoder::page_ui(ui, theme, encoder, actions),
        });
    }

    fn running_ui(
        ui: &mut Ui,
        theme: &Theme,
        device: &AnyDevice,
        encoder: &Encoder,
        page: Page,
        actions: &mut Vec<Action>,
    ) {
        let is_led = encoder.guide.as_ref().is_some_and(|guide| guide.is_running()) && page == Page::Procedures;
        // Progress is shown step by step below. The bar explains the effect of cancelling.
        let instead = is_led.then(|| translate(theme, "guide.cancel_note"));
        status_line::running_ui(ui, theme, device, instead, actions);
    }

    fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
        live::value_ui(ui, theme, encoder, ink);
    }

    fn watch_menu(ui: &mut Ui, theme: &Theme, encoder: &Encoder, _view: &mut BissUiState, actions: &mut Vec<Action>) {
        live::watch_menu(ui, theme, encoder, actions);
    }
}

/// Returns a label from the BiSS or common catalogue, in the window's language.
pub(crate) fn translate(theme: &Theme, id: &'static str) -> String {
    theme.format_text(&TEXTS.text(id))
}
