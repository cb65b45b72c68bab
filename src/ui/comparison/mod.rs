//! The comparison dialog: two sources side by side, with buttons that copy values to the right side.

mod side;
mod table;

use egui::{Align, Layout, Rect, RichText, ScrollArea, Ui, UiBuilder, vec2};

use self::table::table_ui;
use super::controls::{
    empty_placeholder, icon_button, labelled_button, modal, paragraph, primary_button, right_aligned,
};
use super::{DeviceView, TabViews, Theme, icons};
use crate::app::{
    Action, AnyDevice, ComparedRows, ComparisonAction, ComparisonSource, ComparisonView, DeviceCommand, Side, Studio,
    Text,
};

/// Width of the dialog in points, if the window is wide enough.
const WIDTH: f32 = 1160.0;
/// Space between the dialog and the window in points.
const MARGIN: f32 = 24.0;
/// Height in points of a side, including the line of details below it.
const SIDE_HEIGHT: f32 = 56.0;
/// Width of the button between the sides in points.
const SWAP_BUTTON_WIDTH: f32 = 28.0;

pub(super) fn comparison_ui(
    ctx: &egui::Context,
    theme: &Theme,
    studio: &Studio,
    (tabs, as_picture): (TabViews, &mut bool),
    actions: &mut Vec<Action>,
) {
    let Some(view) = studio.comparison() else { return };
    let kind = view.kind().and_then(|kind| tabs.for_profile(kind));
    let picture = kind.and_then(|kind| Some((kind, kind.compared_picture()?)));
    let window = ctx.content_rect().size();
    let inside = 2.0 * (MARGIN + theme.space.groups);
    let size = vec2((window.x - inside).min(WIDTH), window.y - inside);
    modal(ctx, theme, "comparison", size.x, |ui| {
        ui.set_height(size.y);
        ui.label(theme.heading(theme.translate("comparison.title")));
        ui.add_space(theme.space.between);
        sides_ui(ui, theme, studio, view, actions);
        ui.add_space(theme.space.between);
        summary_ui(ui, theme, view, picture.as_ref().map(|(_, name)| (name, &mut *as_picture)), actions);
        ui.add_space(theme.space.inside);
        // The buttons and the line above them keep their place.
        let below = 2.0 * ui.spacing().interact_size.y + theme.space.between + ui.spacing().item_spacing.y;
        let room = ui.available_rect_before_wrap();
        let (list, buttons) = room.split_top_bottom_at_y(room.bottom() - below);
        ui.scope_builder(UiBuilder::new().max_rect(list), |ui| match (view.rows(), &picture) {
            (Some(Ok(_)), Some((kind, _))) if *as_picture => picture_ui(ui, theme, view, *kind),
            (Some(Ok(rows)), _) => rows_ui(ui, theme, studio, rows, actions),
            (Some(Err(why)), _) => paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.bad)),
            (None, _) => drop(empty_placeholder(ui, theme, &theme.translate("comparison.empty"), None)),
        });
        ui.scope_builder(UiBuilder::new().max_rect(buttons), |ui| buttons_ui(ui, theme, studio, view, actions));
    });
}

fn sides_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, view: &ComparisonView, actions: &mut Vec<Action>) {
    let (room, _) = ui.allocate_exact_size(vec2(ui.available_width(), SIDE_HEIGHT), egui::Sense::hover());
    let width = (room.width() - SWAP_BUTTON_WIDTH - 2.0 * theme.space.between) / 2.0;
    let left = Rect::from_min_size(room.min, vec2(width, SIDE_HEIGHT));
    let right = Rect::from_min_size(egui::pos2(room.right() - width, room.top()), vec2(width, SIDE_HEIGHT));
    let swap = Rect::from_min_size(
        egui::pos2(left.right() + theme.space.between, room.top()),
        vec2(SWAP_BUTTON_WIDTH, SIDE_HEIGHT),
    );
    let choices = studio.comparison_choices();
    for (side, rect) in [(Side::Left, left), (Side::Right, right)] {
        ui.scope_builder(UiBuilder::new().max_rect(rect).id_salt(side), |ui| {
            side::side_ui(ui, theme, studio, (view, side), &choices, actions);
        });
    }
    ui.scope_builder(UiBuilder::new().max_rect(swap), |ui| {
        if icon_button(ui, true, icons::ARROWS_CLOCKWISE, &theme.translate("comparison.swap")).clicked() {
            actions.push(Action::Comparison(ComparisonAction::Swap));
        }
    });
}

/// Draws the filter and the number of differences. `picture` contains the label of the picture and whether it is shown.
fn summary_ui(
    ui: &mut Ui,
    theme: &Theme,
    view: &ComparisonView,
    picture: Option<(&Text, &mut bool)>,
    actions: &mut Vec<Action>,
) {
    ui.horizontal(|ui| {
        ui.set_min_height(ui.spacing().interact_size.y);
        let mut only = !view.shows_all();
        if ui.checkbox(&mut only, theme.translate("comparison.only_differences")).changed() {
            actions.push(Action::Comparison(ComparisonAction::ShowAll(!only)));
        }
        if let Some(Ok(rows)) = view.rows() {
            ui.add_space(theme.space.groups);
            ui.label(theme.label(theme.format_text(&summary(rows))));
        }
        let Some((name, as_picture)) = picture else { return };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            for (own, word) in [(true, theme.format_text(name)), (false, theme.translate("comparison.items"))] {
                if ui.selectable_label(*as_picture == own, word).clicked() {
                    *as_picture = own;
                }
            }
        });
    });
}

fn picture_ui(ui: &mut Ui, theme: &Theme, view: &ComparisonView, kind: &dyn DeviceView) {
    let sides = view.side(Side::Left).document().zip(view.side(Side::Right).document());
    ScrollArea::vertical().id_salt("picture").auto_shrink(false).show(ui, |ui| {
        ui.set_width(ui.available_width());
        if let Some((left, right)) = sides {
            kind.compared_picture_ui(ui, theme, &left.body, &right.body);
        }
    });
}

fn summary(rows: &ComparedRows) -> Text {
    match rows.different {
        0 => Text::new("comparison.equal"),
        1 => Text::new("comparison.one"),
        count => Text::new("comparison.some").with("count", count),
    }
    .with("compared", rows.compared)
}

fn rows_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, rows: &ComparedRows, actions: &mut Vec<Action>) {
    let shows_all = studio.comparison().is_some_and(ComparisonView::shows_all);
    if rows.different == 0 && !shows_all {
        empty_placeholder(ui, theme, &theme.translate("comparison.none"), None);
        return;
    }
    table_ui(ui, theme, studio.editable_device(), rows, shows_all, actions);
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, view: &ComparisonView, actions: &mut Vec<Action>) {
    super::controls::show_error_below(ui, theme, view.refusal());
    ui.add_space(theme.space.between);
    right_aligned(ui, |ui| {
        if let Some((device, restore)) = restore_command(studio, view) {
            let differs = matches!(view.rows(), Some(Ok(rows)) if rows.different > 0);
            let word = theme.translate("comparison.restore");
            if primary_button(ui, theme, differs && device.is_ready(), icons::DOWNLOAD_SIMPLE, &word).clicked() {
                actions.push(Action::Comparison(ComparisonAction::Close));
                actions.push(restore);
            }
        }
        if labelled_button(ui, "", &theme.translate("about.close")).clicked() {
            actions.push(Action::Comparison(ComparisonAction::Close));
        }
    });
}

/// Returns the device on the right side and the command that writes the left side to it. Returns `None` unless the right
/// side is a connected device with a memory.
fn restore_command<'s>(studio: &'s Studio, view: &ComparisonView) -> Option<(&'s AnyDevice, Action)> {
    let device = studio.device(view.side(Side::Right).session()?)?;
    if !device.has_memory() || !device.is_connected() {
        return None;
    }
    let command = match view.side(Side::Left).source()? {
        ComparisonSource::Session(id) => {
            let profile = studio.device(*id).filter(|own| !own.is_connected())?;
            profile.command(DeviceCommand::WriteInto(device.id()))
        }
        source => device.command(DeviceCommand::Restore(source.path()?.to_owned())),
    };
    Some((device, command))
}
