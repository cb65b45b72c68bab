//! The pages of a Novo encoder, its live value, and its form in the connection dialog.

use egui::{RichText, Ui};
use encoder_studio::app::connect::ConnectDialog as Dialog;
use encoder_studio::app::{Action as StudioAction, AnyDevice, PendingEdits, Rgb, Studio, Text, explain};
use encoder_studio::ui::controls::{card, committed_entry, entry, text_entry};
use encoder_studio::ui::{PageInfo, TabPage, Theme, TypedConnectForm, TypedDeviceView, backups, edit_bar, icons, page};

use super::device_type::NovoForm;
use super::protocol::ITEMS;
use super::state::{Action, Encoder, TEXTS};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Page {
    #[default]
    Values,
    Backups,
}

impl TabPage for Page {
    const PAGES: &'static [(Self, PageInfo)] = &[
        (Page::Values, PageInfo::new(icons::SLIDERS, "page.values", "help.values")),
        (Page::Backups, PageInfo::new(icons::CLOCK_COUNTER_CLOCKWISE, "page.backups", "help.backups")),
    ];
}

/// Text typed for each item that is not yet a valid edit.
type Typed = [Option<(String, Option<Text>)>; ITEMS.len()];

pub(crate) struct NovoView;

impl TypedDeviceView for NovoView {
    type Device = Encoder;
    type Page = Page;
    type Memory = Typed;
    type ConnectForm = NovoConnectForm;

    const HAS_UNDO_KEYS: bool = true;

    fn is_edited(encoder: &Encoder, page: Page) -> bool {
        page == Page::Values && encoder.staged.is_dirty()
    }
    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        (studio, device): (&Studio, &AnyDevice),
        encoder: &Encoder,
        (page, typed): (Page, &mut Typed),
        actions: &mut Vec<StudioAction>,
    ) {
        page::scrollable_page(ui, theme, (device.id(), page.index()), |ui| match page {
            Page::Backups => backups::page_ui(ui, theme, (studio, device), actions),
            Page::Values => {
                card(ui, theme, TEXTS.text("novo.values"), |ui| {
                    for (item, (name, typed)) in ITEMS.into_iter().zip(typed).enumerate() {
                        let shown = encoder.wanted().map_or(String::new(), |values| values[item].to_string());
                        entry(ui, theme, name, |ui| {
                            committed_entry(ui, typed, &shown, 96.0, name, |text| {
                                let value = text.parse().map_err(|_| explain::literal_text(text))?;
                                actions.push(StudioAction::device(device.id(), Action::Set(item, value)));
                                Ok(())
                            })
                        });
                    }
                });
                edit_bar::edit_bar_ui(ui, theme, (studio, device), edit_bar::EditKind::Values, actions);
            }
        });
    }
    fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
        let position = encoder.last.map_or("–".to_owned(), |(_, position)| position.to_string());
        ui.label(RichText::new(position).monospace().size(theme.sizes.live).color(ink));
    }
}

pub(crate) struct NovoConnectForm;

impl TypedConnectForm for NovoConnectForm {
    type Form = NovoForm;
    type Memory = ();

    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        _: &Dialog,
        form: &mut NovoForm,
        _: (&mut (), &mut bool),
        _: &mut Vec<StudioAction>,
    ) {
        let word = theme.format_text(&TEXTS.text("novo.link"));
        entry(ui, theme, &word, |ui| text_entry(ui, &mut form.link, 300.0, &word, "sim:"));
    }
}
