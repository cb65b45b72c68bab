//! The connection dialog: a form for the link, recent links, the ports of this computer, and a search for an encoder
//! with unknown settings.

pub(crate) mod entries;
pub(in crate::ui) mod form;

use std::collections::HashMap;

use egui::{RichText, ScrollArea, Ui};

use crate::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog, is_missing};
use crate::app::{Action, Studio, Tab, Text};
use crate::link::LinkUrl;
use crate::ui::controls::{
    entry, icon_button, labelled_button, modal, mono_entry, name, paragraph, primary_button, problem_ui, right_aligned,
};
use crate::ui::{TabViews, Theme, icons};

pub use form::ConnectForm;
pub use form::TypedConnectForm;

#[derive(Default)]
pub(in crate::ui) struct ConnectView {
    forms: HashMap<Tab, Box<dyn ConnectForm>>,
    more: bool,
}

/// Maximum number of recent links offered.
const LINKS: usize = 5;
const DIALOG_WIDTH: f32 = 600.0;
/// Height in points of the two lines reserved for the reason why the dialog cannot continue.
const REASON_HEIGHT: f32 = 40.0;

pub(in crate::ui) fn connect_ui(
    ctx: &egui::Context,
    theme: &Theme,
    studio: &Studio,
    (tabs, view): (TabViews, &mut ConnectView),
    actions: &mut Vec<Action>,
) {
    let Some(dialog) = &studio.connect else { return };
    let height = (ctx.content_rect().height() - 250.0).min(540.0);
    modal(ctx, theme, "connect", DIALOG_WIDTH, |ui| {
        ui.horizontal(|ui| {
            ui.label(theme.heading(theme.translate("connect.title")));
            theme.add_gap(ui);
            devices_ui(ui, theme, tabs, dialog.device, actions);
        });
        ui.add_space(theme.space.inside);
        // The height is constant, so nothing moves under the pointer.
        ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
            recent_links_ui(ui, theme, studio.settings.links_of(dialog.device), actions);
            if let Some(own) = tabs.device(dialog.device) {
                let form = view.forms.entry(dialog.device).or_insert_with(|| own.connect_form());
                form.form_ui(ui, theme, dialog, &mut view.more, actions);
            }
        });
        ui.add_space(theme.space.between);
        let url = dialog.url();
        link_ui(ui, theme, dialog, url.as_ref().ok(), actions);
        let searching = dialog.is_searching().then(|| Text::new("connect.searching"));
        let refused = searching.or(url.err());
        reason_ui(ui, theme, refused.as_ref().or(dialog.problem.as_ref()));
        right_aligned(ui, |ui| {
            let word = theme.translate("connect.connect");
            if primary_button(ui, theme, refused.is_none(), icons::PLUGS_CONNECTED, &word).clicked() {
                actions.push(Action::Connect(Connect::Connect));
            }
            if labelled_button(ui, "", &theme.translate("connect.cancel")).clicked() {
                actions.push(Action::Connect(Connect::Close));
            }
        });
    });
}

fn devices_ui(ui: &mut Ui, theme: &Theme, tabs: TabViews, device: Tab, actions: &mut Vec<Action>) {
    for own in tabs.device_tabs() {
        let word = tabs.title(theme, own);
        let text = RichText::new(&word).font(theme.bold_font(theme.sizes.body));
        let response = ui.add(egui::Button::selectable(device == own, text));
        if name(response, true, &word).clicked() && own != device {
            actions.push(Action::Connect(Connect::Device(own)));
        }
    }
}

fn recent_links_ui(ui: &mut Ui, theme: &Theme, links: &[String], actions: &mut Vec<Action>) {
    if links.is_empty() {
        return;
    }
    ui.label(theme.caption(theme.translate("connect.used")));
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for link in links.iter().take(LINKS) {
            let response = ui.add(egui::Button::new(theme.monospace(link)).frame_when_inactive(false).truncate());
            if response.clicked() {
                actions.push(Action::Connect(Connect::Use(link.clone())));
            }
        }
    });
    ui.add_space(theme.space.between);
}

/// Draws the text entry for the link, in command-line notation. The link and the form update each other.
fn link_ui(ui: &mut Ui, theme: &Theme, dialog: &Dialog, url: Option<&LinkUrl>, actions: &mut Vec<Action>) {
    let hint = Text::new("connect.link_hint").with("link", dialog.example_link());
    let (word, hint) = (theme.translate("connect.link"), theme.format_text(&hint));
    let mut link = dialog.typed_link();
    entry(ui, theme, &word, |ui| {
        let width = (ui.available_width() - 52.0).max(0.0);
        if mono_entry(ui, theme, &mut link, width, &word, &hint).changed() {
            actions.push(Action::Connect(Connect::Use(link)));
        }
        if icon_button(ui, url.is_some(), icons::COPY, &theme.translate("shell.copy_link")).clicked()
            && let Some(url) = url
        {
            ui.copy_text(url.to_string());
        }
    });
}

/// Draws the reason why the dialog cannot continue. Two lines are always reserved, so the buttons do not move under the
/// pointer.
fn reason_ui(ui: &mut Ui, theme: &Theme, why: Option<&Text>) {
    let top = ui.cursor().top();
    match why {
        Some(why) if is_missing(why) => paragraph(ui, theme.label(theme.format_text(why))),
        why => problem_ui(ui, theme, why),
    }
    let rest = top + REASON_HEIGHT - ui.cursor().top();
    ui.add_space(rest.max(0.0));
}
