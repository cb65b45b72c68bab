//! A guided procedure as a list of completed, current and future steps, with measured values and their limits.
//!
//! * **Size**: the available width, with one line per step. The current step is as high as its content.
//! * **Keyboard**: Tab moves from button to button.
//! * **Pointer**: clicks the buttons. A tooltip explains why a button is disabled.
//! * **Accessible**: a label for each step with its state, a progress indicator for each gauge with its value and
//!   allowed range, and buttons with the given labels.
//! * **Painting**: a rail with a filled, ringed or hollow dot per step and an icon in the colour of the result. A gauge
//!   shows the allowed band with its best part more intense, and a hand at the value, which has the warning colour
//!   outside the band.

mod gauge;

use std::ops::RangeInclusive;

use egui::accesskit::Role;
use egui::{Align, Align2, FontId, Layout, Painter, Pos2, Rect, RichText, Sense, Stroke, Ui, Vec2, WidgetInfo, pos2};

use crate::app::Rgb;
use crate::ui::controls::{enabled_button, fill_width, paragraph, primary_button};
use crate::ui::{Theme, icons};

#[derive(Clone, Debug, Default)]
pub struct StepRow {
    pub title: String,
    pub state: StepState,
    pub word: String,
    /// Current task, result or reason for failure. May be empty.
    pub note: String,
    pub gauges: Vec<Gauge>,
    /// Completed fraction, 0 to 1, or `None` if unknown or the step is not running.
    pub progress: Option<f32>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StepState {
    #[default]
    ToCome,
    Waiting,
    Running,
    Done,
    Skipped,
    Failed,
}

#[derive(Clone, Debug)]
pub struct Gauge {
    pub name: String,
    /// Current value, or `None` if none is available.
    pub value: Option<f64>,
    /// Value with its unit, formatted for display.
    pub shown: String,
    pub allowed: RangeInclusive<f64>,
    /// Best range, or `None` if all allowed values are equally good.
    pub best: Option<RangeInclusive<f64>>,
    /// Label of the allowed range, such as `498…502 rpm`.
    pub limits: String,
    pub scale: RangeInclusive<f64>,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Steps<'a> {
    pub steps: &'a [StepRow],
    /// Label of the button that starts the waiting step, with the reason if the button is disabled.
    pub start: Option<(&'a str, Result<(), &'a str>)>,
    /// Label of the button that skips the waiting step, or `None` if the step cannot be skipped.
    pub skip: Option<&'a str>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepsEvent {
    Start,
    Skip,
}

impl Gauge {
    pub fn is_in_range(&self) -> bool {
        self.value.is_some_and(|value| self.allowed.contains(&value))
    }

    /// Returns whether the value lies in both the allowed and the best range.
    pub fn is_in_best_range(&self) -> bool {
        self.is_in_range() && self.value.zip(self.best.as_ref()).is_none_or(|(value, best)| best.contains(&value))
    }
}

impl StepState {
    const fn is_complete(self) -> bool {
        matches!(self, StepState::Waiting | StepState::Running)
    }

    fn icon(self, theme: &Theme) -> (&'static str, Rgb) {
        let palette = theme.palette;
        match self {
            StepState::ToCome => ("", palette.muted),
            StepState::Waiting => (icons::CARET_RIGHT, palette.accent),
            StepState::Running => (icons::SPINNER, palette.accent),
            StepState::Done => (icons::CHECK, palette.good),
            StepState::Skipped => (icons::X, palette.muted),
            StepState::Failed => (icons::X, palette.bad),
        }
    }
}

/// Radius of a step's dot, in points.
const DOT_RADIUS: f32 = 9.0;
/// Width of the rail with the dots, in points.
const RAIL_WIDTH: f32 = 32.0;

pub fn steps(ui: &mut Ui, theme: &Theme, model: &Steps<'_>) -> Option<StepsEvent> {
    let mut event = None;
    let mut dots: Vec<Pos2> = Vec::new();
    // This id stores which step was the current one in the last frame, and its height.
    let at = ui.scope_id().with("step");
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        for (number, step) in (1_usize..).zip(model.steps) {
            let left = ui.cursor().left();
            let mut middle = pos2(left + DOT_RADIUS + 1.0, 0.0);
            let drawn = ui.horizontal_top(|ui| {
                ui.add_space(RAIL_WIDTH);
                ui.vertical(|ui| {
                    fill_width(ui);
                    middle.y = title_ui(ui, theme, step);
                    event = event.or(content_ui(ui, theme, model, step));
                });
            });
            // Scroll again if the step grows, because its gauges and buttons must be visible.
            let height = drawn.response.rect.height();
            let before: Option<(usize, f32)> = ui.data(|data| data.get_temp(at));
            if step.state.is_complete() && before.is_none_or(|(own, seen)| own != number || height > seen + 1.0) {
                ui.data_mut(|data| data.insert_temp(at, (number, height)));
                drawn.response.scroll_to_me(None);
            }
            paint_dot(ui.painter(), theme, middle, number, step);
            dots.push(middle);
            ui.add_space(theme.space.between + theme.space.inside);
        }
    });
    for (upper, lower) in dots.iter().zip(dots.iter().skip(1)) {
        let (from, to) = (upper.y + DOT_RADIUS + theme.space.inside, lower.y - DOT_RADIUS - theme.space.inside);
        ui.painter().vline(upper.x, from..=to, Stroke::new(1.0, theme.palette.line));
    }
    event
}

/// Draws the title, which may have several lines, and returns the vertical centre of its first line.
fn title_ui(ui: &mut Ui, theme: &Theme, step: &StepRow) -> f32 {
    let palette = theme.palette;
    let ink = match step.state {
        StepState::ToCome | StepState::Skipped => palette.muted,
        StepState::Failed => palette.bad,
        StepState::Waiting | StepState::Running | StepState::Done => palette.text,
    };
    let font = if step.state.is_complete() {
        theme.bold_font(theme.sizes.section)
    } else {
        FontId::proportional(theme.sizes.body)
    };
    let half = ui.fonts_mut(|fonts| fonts.row_height(&font)) / 2.0;
    let response = ui.add(egui::Label::new(RichText::new(&step.title).font(font).color(ink)).wrap());
    let words = format!("{}: {}", step.title, step.word);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &words));
    response.rect.top() + half
}

fn content_ui(ui: &mut Ui, theme: &Theme, model: &Steps<'_>, step: &StepRow) -> Option<StepsEvent> {
    let palette = theme.palette;
    if !step.note.is_empty() {
        let ink = match step.state {
            StepState::Failed => palette.bad,
            StepState::Waiting | StepState::Running => palette.text,
            StepState::ToCome | StepState::Done | StepState::Skipped => palette.muted,
        };
        paragraph(ui, RichText::new(&step.note).color(ink));
    }
    if !step.state.is_complete() {
        return None;
    }
    gauge::gauges_ui(ui, theme, &step.gauges);
    if let Some(share) = step.progress {
        progress_ui(ui, theme, &step.title, share);
    }
    if step.state != StepState::Waiting {
        return None;
    }
    buttons_ui(ui, theme, model)
}

/// Draws the buttons. Start comes first, followed by Skip and the obstacle, so the start button does not move while the
/// motor speed changes.
fn buttons_ui(ui: &mut Ui, theme: &Theme, model: &Steps<'_>) -> Option<StepsEvent> {
    let mut event = None;
    if model.start.is_none() && model.skip.is_none() {
        return None;
    }
    // The line has a fixed height. Centred in the remaining space, the buttons would be misplaced.
    let size = Vec2::new(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
        if let Some((word, allowed)) = model.start {
            let response = primary_button(ui, theme, allowed.is_ok(), icons::PLAY, word);
            if response.clicked() {
                event = Some(StepsEvent::Start);
            }
            if let Err(why) = allowed {
                response.on_disabled_hover_text(why);
            }
        }
        if let Some(word) = model.skip
            && enabled_button(ui, true, "", word).clicked()
        {
            event = Some(StepsEvent::Skip);
        }
        if let Some((_, Err(why))) = model.start {
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
                paragraph(ui, RichText::new(why).color(theme.palette.warn));
            });
        }
    });
    event
}

fn progress_ui(ui: &mut Ui, theme: &Theme, label: &str, share: f32) {
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width().max(0.0), 6.0), Sense::hover());
    let done = Rect::from_min_size(rect.min, Vec2::new(rect.width() * share, rect.height()));
    ui.painter().rect_filled(rect, 3.0, theme.palette.sunken);
    ui.painter().rect_filled(done, 3.0, theme.palette.accent);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ProgressIndicator, true, label);
        info.current_text_value = Some(format!("{:.0} %", share * 100.0));
        info
    });
}

fn paint_dot(painter: &Painter, theme: &Theme, middle: Pos2, number: usize, step: &StepRow) {
    let palette = theme.palette;
    let (icon, colour) = step.state.icon(theme);
    let (font, ink) = match step.state {
        StepState::Done | StepState::Failed => {
            painter.circle_filled(middle, DOT_RADIUS, egui::Color32::from(colour).gamma_multiply(0.22));
            (theme.sizes.body, colour)
        }
        StepState::Waiting | StepState::Running => {
            painter.circle_filled(middle, DOT_RADIUS, egui::Color32::from(colour).gamma_multiply(0.22));
            painter.circle_stroke(middle, DOT_RADIUS, Stroke::new(2.0, colour));
            (theme.sizes.caption, palette.text)
        }
        StepState::ToCome | StepState::Skipped => {
            painter.circle_stroke(middle, DOT_RADIUS, Stroke::new(1.0, colour));
            (theme.sizes.caption, palette.muted)
        }
    };
    let has_icon = matches!(step.state, StepState::Done | StepState::Failed | StepState::Skipped);
    let words = if has_icon { icon.to_owned() } else { number.to_string() };
    painter.text(middle, Align2::CENTER_CENTER, words, FontId::proportional(font), ink.into());
}
