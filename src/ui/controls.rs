//! Small widgets used by every view: rows of label and value, buttons with icons, badges and empty states. A screen
//! reader receives the same text as on the screen, without icons.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, Response, RichText, Sense, Stroke, Ui, WidgetInfo, vec2};

pub use super::cards::card;
pub(crate) use super::cards::{card_with_trailing, disclosure, folding_card, folding_card_with_trailing};
pub(crate) use super::entries::{clear_secret, labelled_number_entry, mono_entry, secret_entry};
pub use super::entries::{committed_entry, text_entry};
pub(crate) use super::label_column::label_width;
pub use super::label_column::{entry, row};
use super::{Theme, icons};
use crate::analysis::quality::Verdict;

/// Minimum width in points for text next to an entry. In a narrower space, an icon replaces the text.
const MIN_LABEL_WIDTH: f32 = 64.0;
/// Minimum width of a dialog in points.
const MIN_MODAL_WIDTH: f32 = 240.0;
/// Expands the UI to the available width, which may be negative in a very small window.
pub(crate) fn fill_width(ui: &mut Ui) {
    ui.set_width(ui.available_width().max(0.0));
}

pub(crate) fn paragraph(ui: &mut Ui, text: impl Into<egui::WidgetText>) {
    ui.add(egui::Label::new(text).wrap().halign(egui::Align::Min));
}

/// Draws the reason why an item cannot be shown or an action is not possible.
pub(crate) fn problem_ui(ui: &mut Ui, theme: &Theme, problem: Option<&crate::app::Text>) {
    match problem {
        Some(problem) => paragraph(ui, RichText::new(theme.format_text(problem)).color(theme.palette.bad)),
        // The ids of the entries below must not depend on the message. Otherwise, a message that appears would
        // interrupt typing.
        None => ui.skip_ahead_auto_ids(1),
    }
}

/// Draws the reason why entries are invalid below them. The space is always reserved, so a message does not move the
/// widgets below.
pub(crate) fn show_error_below(ui: &mut Ui, theme: &Theme, problem: Option<&crate::app::Text>) {
    let size = vec2(ui.available_width().max(0.0), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_size(vec2(0.0, size.y));
        if let Some(problem) = problem {
            message_label(ui, theme, theme.format_text(problem), theme.palette.bad.into());
        }
    });
}

/// Draws the reason why an entry is invalid to the right of it, so a message does not move other widgets.
pub(crate) fn show_error_beside(ui: &mut Ui, theme: &Theme, problem: Option<&crate::app::Text>) {
    let Some(problem) = problem else { return };
    let (words, ink) = (theme.format_text(problem), theme.palette.bad);
    if ui.available_width() < MIN_LABEL_WIDTH {
        ui.label(RichText::new(icons::WARNING_CIRCLE).color(ink)).on_hover_text(words);
    } else {
        message_label(ui, theme, words, ink.into());
    }
}

/// Draws a message on one line, or on two lines in a smaller font. It is always as high as a button, so nothing below
/// moves. A tooltip shows the full text of a longer message.
pub(crate) fn message_label(ui: &mut Ui, theme: &Theme, words: String, ink: egui::Color32) -> Response {
    let width = ui.available_width();
    let font = |size: f32| egui::FontId::proportional(size);
    let whole = ui.painter().layout_no_wrap(words.clone(), font(theme.sizes.body), ink);
    let galley = if whole.size().x <= width {
        whole
    } else {
        let mut job = egui::text::LayoutJob::simple(words.clone(), font(theme.sizes.caption), ink, width);
        job.wrap.max_rows = 2;
        ui.painter().layout_job(job)
    };
    let elided = galley.elided;
    let response = ui.label(galley);
    if elided { response.on_hover_text(words) } else { response }
}

pub(super) fn modal<R>(
    ctx: &egui::Context,
    theme: &Theme,
    name: &str,
    width: f32,
    content: impl FnOnce(&mut Ui) -> R,
) -> R {
    let frame = theme.card_frame().inner_margin(theme.space.groups);
    let id = egui::Id::unique(name);
    let shown = egui::Modal::new(id).frame(frame).show(ctx, |ui| {
        ui.set_width(width.max(MIN_MODAL_WIDTH));
        content(ui)
    });
    // The dialog can be centred only once its size is known, which requires another frame.
    let place = shown.response.rect;
    if ctx.data(|data| data.get_temp(id)) != Some(place) {
        ctx.data_mut(|data| data.insert_temp(id, place));
        ctx.request_repaint();
    }
    shown.inner
}

/// Draws the buttons at the end of a dialog in a row, with the first button at the far right. Centring them in the
/// remaining space would prevent the dialog from shrinking.
pub(super) fn right_aligned(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, egui::Layout::right_to_left(egui::Align::Center), content);
}

pub(crate) fn labelled_button(ui: &mut Ui, icon: &str, word: &str) -> Response {
    enabled_button(ui, true, icon, word)
}

pub(crate) fn enabled_button(ui: &mut Ui, enabled: bool, icon: &str, word: &str) -> Response {
    let shown = if icon.is_empty() { word.to_owned() } else { format!("{icon}  {word}") };
    name(ui.add_enabled(enabled, Button::new(shown)), enabled, word)
}

/// Draws a STOP button, which acts when it is pressed rather than released. Its label stays readable while the button
/// is disabled.
pub(crate) fn stop_button(ui: &mut Ui, theme: &Theme, active: bool, button: Button<'_>, size: egui::Vec2) -> Response {
    let palette = theme.palette;
    let button = if active { button } else { button.fill(palette.surface).stroke(Stroke::new(1.0, palette.line)) };
    ui.add_enabled_ui(active, |ui| {
        ui.set_opacity(1.0);
        if size.y > 0.0 { ui.add_sized(size, button) } else { ui.add(button.min_size(size)) }
    })
    .inner
}

/// Draws a button. The tooltip of a disabled button shows the reason.
pub(crate) fn button_with_reason(
    ui: &mut Ui,
    theme: &Theme,
    allowed: &Result<(), crate::app::Text>,
    icon: &str,
    word: &str,
) -> Response {
    let response = enabled_button(ui, allowed.is_ok(), icon, word);
    match allowed {
        Ok(()) => response,
        Err(why) => response.on_disabled_hover_text(theme.format_text(why)),
    }
}

pub(crate) fn primary_button(ui: &mut Ui, theme: &Theme, enabled: bool, icon: &str, word: &str) -> Response {
    let shown = if icon.is_empty() { word.to_owned() } else { format!("{icon}  {word}") };
    let ink = if enabled { theme.palette.on_accent } else { theme.palette.muted };
    let mut button = Button::new(RichText::new(shown).color(ink)).min_size(vec2(96.0, 0.0));
    if enabled {
        // The border is as wide as that of a disabled button, so both buttons have the same size.
        button = button.fill(theme.palette.accent).stroke(Stroke::new(1.0, theme.palette.accent));
    }
    name(ui.add_enabled(enabled, button), enabled, word)
}

/// Draws an icon button with its label as a tooltip.
pub(crate) fn icon_button(ui: &mut Ui, enabled: bool, icon: &str, word: &str) -> Response {
    let response = ui.add_enabled(enabled, Button::new(icon).min_size(vec2(28.0, 28.0)));
    name(response, enabled, word).on_hover_text(word).on_disabled_hover_text(word)
}

/// Sets the name by which screen readers and tests find a widget.
pub(crate) fn name(response: Response, enabled: bool, word: &str) -> Response {
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, enabled, word));
    response
}

pub(crate) fn badge(ui: &mut Ui, theme: &Theme, word: &str, colour: impl Into<egui::Color32>) {
    let colour = colour.into();
    let font = egui::FontId::proportional(theme.sizes.caption);
    let words = ui.painter().layout_no_wrap(word.to_owned(), font, colour);
    let (rect, response) = ui.allocate_exact_size(words.size() + vec2(12.0, 6.0), Sense::hover());
    ui.painter().rect_stroke(rect, 4.0, Stroke::new(1.0, colour), egui::StrokeKind::Inside);
    ui.painter().galley(rect.min + vec2(6.0, 3.0), words, colour);
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, word));
}

/// Draws a placeholder for missing content, with an action that adds it.
pub(crate) fn empty_placeholder(ui: &mut Ui, theme: &Theme, words: &str, action: Option<(&str, &str, bool)>) -> bool {
    let mut pressed = false;
    ui.vertical_centered(|ui| {
        theme.add_gap(ui);
        ui.add(egui::Label::new(theme.label(words)).wrap());
        if let Some((icon, word, enabled)) = action {
            ui.add_space(theme.space.inside);
            pressed = enabled_button(ui, enabled, icon, word).clicked();
        }
        theme.add_gap(ui);
    });
    pressed
}

/// Draws an icon button that opens a small panel below it. Clicks and typing inside the panel do not close it.
pub(crate) fn icon_menu(ui: &mut Ui, icon: &str, word: &str, content: impl FnOnce(&mut Ui)) {
    let config = MenuConfig::new().close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    let button = Button::new(icon).min_size(vec2(28.0, 28.0));
    let (response, _) = MenuButton::from_button(button).config(config).ui(ui, |ui| {
        // In menu style, which has no borders, an unchecked box would be invisible.
        ui.set_style(ui.ctx().global_style());
        content(ui);
    });
    name(response, true, word).on_hover_text(word);
}

/// Draws a drop-down list with a name for screen readers.
pub(crate) fn dropdown<T: PartialEq + Copy>(
    ui: &mut Ui,
    label: &str,
    value: &mut T,
    options: impl IntoIterator<Item = (T, String)>,
) -> bool {
    let options: Vec<(T, String)> = options.into_iter().collect();
    let shown = options.iter().find(|(own, _)| own == value).map(|(_, word)| word.clone()).unwrap_or_default();
    let before = *value;
    // A long list may use most of the height of the window.
    let height = ui.ctx().content_rect().height() * 0.6;
    let list = egui::ComboBox::from_id_salt(label).selected_text(shown.clone()).height(height);
    let list = if choice_width(ui, &shown) > ui.available_width() {
        list.width(ui.available_width().max(0.0)).truncate()
    } else {
        list
    };
    let response = list.show_ui(ui, |ui| {
        // Twelve entries fit without scrolling. By default, egui gives such an area a height of 400 points.
        ui.spacing_mut().item_spacing.y = ui.spacing().button_padding.y;
        for (own, word) in options {
            ui.selectable_value(value, own, word);
        }
    });
    response.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(egui::Role::ComboBox, true, label);
        info.current_text_value = Some(shown.clone());
        info
    });
    *value != before
}

/// Returns the width at which a drop-down list shows the given text in full.
fn choice_width(ui: &Ui, shown: &str) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let words = ui.painter().layout_no_wrap(shown.to_owned(), font, egui::Color32::PLACEHOLDER);
    let spacing = ui.spacing();
    words.size().x + spacing.icon_spacing + spacing.icon_width + 2.0 * spacing.button_padding.x
}

/// Draws a choice with all options visible, as many per row as fit. It also works in a panel that closes on an outside
/// click, unlike a drop-down list.
pub(crate) fn options<T: PartialEq + Copy>(
    ui: &mut Ui,
    label: &str,
    value: &mut T,
    options: impl IntoIterator<Item = (T, String)>,
) -> bool {
    let before = *value;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(4.0, 4.0);
        ui.spacing_mut().button_padding.x = 6.0;
        for (own, word) in options {
            let chosen = *value == own;
            let button = Button::selectable(chosen, word.as_str()).frame_when_inactive(true);
            let response = ui.add(button);
            let name = format!("{label}: {word}");
            response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, chosen, &name));
            if response.clicked() {
                *value = own;
                // The Tab key continues from here.
                response.request_focus();
            }
        }
    });
    *value != before
}

/// Draws a spinner. It turns slowly to use little CPU time.
pub(crate) fn spinner(ui: &mut Ui, theme: &Theme) {
    const STEPS: f64 = 8.0;
    let (rect, _) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::hover());
    let step = (ui.input(|input| input.time) * STEPS).floor();
    for dot in 0..8_u8 {
        let angle = f64::from(dot) * std::f64::consts::TAU / STEPS;
        let age = (f64::from(dot) - step).rem_euclid(STEPS) / STEPS;
        let place = rect.center() + vec2(angle.cos() as f32, angle.sin() as f32) * 6.0;
        let colour = egui::Color32::from(theme.palette.accent).gamma_multiply(0.2 + 0.8 * age as f32);
        ui.painter().circle_filled(place, 1.5, colour);
    }
    ui.ctx().request_repaint_after(std::time::Duration::from_millis(125));
}

pub(crate) fn verdict_badge(theme: &Theme, verdict: Verdict) -> (&'static str, crate::app::Rgb) {
    let palette = theme.palette;
    match verdict {
        Verdict::Ok => (icons::CHECK_CIRCLE, palette.good),
        Verdict::Warn => (icons::WARNING, palette.warn),
        Verdict::Fault => (icons::X_CIRCLE, palette.bad),
    }
}

pub(crate) fn verdict_ui(ui: &mut Ui, theme: &Theme, own: Verdict, words: &crate::app::Text) {
    let (icon, colour) = verdict_badge(theme, own);
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(colour));
        paragraph(ui, RichText::new(theme.format_text(words)).color(colour));
    });
}

pub(crate) fn severity(theme: &Theme, severity: crate::app::Severity) -> (&'static str, crate::app::Rgb) {
    use crate::app::Severity;
    let palette = theme.palette;
    match severity {
        Severity::Note => (icons::INFO, palette.accent),
        Severity::Good => (icons::CHECK_CIRCLE, palette.good),
        Severity::Warning => (icons::WARNING, palette.warn),
        Severity::Error => (icons::X_CIRCLE, palette.bad),
    }
}

/// Draws two columns of cards if they fit, and a single column otherwise.
pub(crate) fn two_columns<C>(
    ui: &mut Ui,
    theme: &Theme,
    context: C,
    left: impl FnOnce(&mut Ui, &mut C),
    right: impl FnOnce(&mut Ui, &mut C),
) {
    split(ui, theme, (0.5, 640.0), context, left, right);
}

/// Draws the page of an encoder: its identity and check next to its readings. For a profile, it contains only the
/// identity and the wiring.
pub(crate) fn encoder_page<C>(
    ui: &mut Ui,
    theme: &Theme,
    context: C,
    is_profile: bool,
    (identity, check): (impl FnOnce(&mut Ui, &mut C), impl FnOnce(&mut Ui, &mut C)),
    (wiring, status): (impl FnOnce(&mut Ui), impl FnOnce(&mut Ui, &mut C)),
) {
    let left = |ui: &mut Ui, context: &mut C| {
        identity(ui, context);
        if !is_profile {
            theme.add_gap(ui);
            check(ui, context);
        }
    };
    two_columns(ui, theme, context, left, |ui, context| if is_profile { wiring(ui) } else { status(ui, context) });
}

/// Draws two columns of cards. `share` is the fraction of the width for the left column. Below the minimum width, draws
/// a single column.
pub(crate) fn split<C>(
    ui: &mut Ui,
    theme: &Theme,
    (share, least): (f32, f32),
    mut context: C,
    left: impl FnOnce(&mut Ui, &mut C),
    right: impl FnOnce(&mut Ui, &mut C),
) {
    if ui.available_width() < least {
        left(ui, &mut context);
        theme.add_gap(ui);
        right(ui, &mut context);
        return;
    }
    let room = (ui.available_width() - theme.space.groups).max(0.0);
    let width = (room * share).floor();
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = theme.space.between;
        ui.allocate_ui_with_layout(vec2(width, 0.0), egui::Layout::top_down(egui::Align::Min), |ui| {
            left(ui, &mut context);
        });
        ui.add_space(theme.space.groups - theme.space.between);
        ui.allocate_ui_with_layout(vec2((room - width).floor(), 0.0), egui::Layout::top_down(egui::Align::Min), |ui| {
            right(ui, &mut context);
        });
    });
}

/// Draws the dot that indicates the connection: filled if connected, hollow otherwise.
pub(crate) fn connection_dot(ui: &mut Ui, filled: bool, colour: impl Into<egui::Color32>) {
    let (rect, _) = ui.allocate_exact_size(vec2(12.0, 16.0), Sense::hover());
    let colour = colour.into();
    if filled {
        ui.painter().circle_filled(rect.center(), 4.0, colour);
    } else {
        ui.painter().circle_stroke(rect.center(), 4.0, Stroke::new(1.5, colour));
    }
}
