//! The position, large, and its curve.

use std::time::Duration;

use egui::{RichText, Ui};
use egui_plot::{Line, Plot, PlotPoints, Points};

use super::nothing;
use crate::app::hiperface::{Action as Hiperface, Curve, Encoder, Phase, Unit};
use crate::app::{Action, Studio};
use crate::ui::controls::{choice, enabled_button, icon_button, row};
use crate::ui::{Skin, Views, icons};

/// How often the position may be read; back to back first.
const RATES: [(u64, &str); 4] =
    [(0, "live.fastest"), (50, "live.every_50"), (200, "live.every_200"), (1000, "live.every_1000")];

/// Draws the panel.
pub(in crate::ui) fn live_ui(ui: &mut Ui, skin: &Skin, studio: &Studio, views: &mut Views, actions: &mut Vec<Action>) {
    let Some(encoder) = studio.encoder() else {
        nothing(ui, skin, &skin.say("live.nothing"));
        return;
    };
    value(ui, skin, encoder);
    ui.add_space(skin.space.inside);
    controls(ui, skin, encoder, views, actions);
    ui.add_space(skin.space.between);
    curve(ui, skin, encoder, actions);
}

fn value(ui: &mut Ui, skin: &Skin, encoder: &Encoder) {
    let curve = &encoder.curve;
    let reading = curve.last();
    let position = reading.and_then(|reading| reading.position);
    let number = |value: f64, decimals: usize| skin.number(value, decimals);
    let (main, unit) = match (reading, position) {
        (_, Some(position)) if position.millimetres().is_some() => {
            (number(position.millimetres().unwrap_or_default(), 4), "mm".to_owned())
        }
        (_, Some(position)) => (number(position.degrees().unwrap_or_default(), 3), "°".to_owned()),
        (Some(reading), None) => (reading.raw.to_string(), skin.say("live.steps")),
        (None, None) => ("–".to_owned(), String::new()),
    };
    let stale = encoder.line().is_none_or(|line| line.polling().is_none());
    let colour = if stale { skin.palette.muted } else { skin.palette.text };
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(skin.sizes.live)).color(colour));
        ui.label(skin.label(unit));
        if curve.refused() {
            ui.label(RichText::new(skin.say("live.refused")).color(skin.palette.bad));
        } else if reading.is_some_and(|reading| !reading.valid) {
            ui.label(RichText::new(skin.say("live.invalid")).color(skin.palette.bad));
        }
    });
    let Some(reading) = reading else { return };
    if let Some((turns, steps)) = position.and_then(|position| Some((position.turns()?, position.steps()?))) {
        row(ui, skin, &skin.say("live.turns"), skin.mono(turns.to_string()));
        row(ui, skin, &skin.say("live.step"), skin.mono(steps.to_string()));
    }
    row(ui, skin, &skin.say("live.raw"), skin.mono(format!("{:08X}h  {}", reading.raw, reading.raw)));
}

fn controls(ui: &mut Ui, skin: &Skin, encoder: &Encoder, views: &mut Views, actions: &mut Vec<Action>) {
    let connected = encoder.phase == Phase::Connected;
    let polling = encoder.line().and_then(|line| line.polling());
    ui.horizontal_wrapped(|ui| {
        if polling.is_some() {
            if enabled_button(ui, true, icons::PAUSE, &skin.say("live.pause")).clicked() {
                actions.push(Action::Hiperface(encoder.id, Hiperface::Poll(None)));
            }
        } else if enabled_button(ui, connected, icons::PLAY, &skin.say("live.start")).clicked() {
            actions.push(Action::Hiperface(encoder.id, Hiperface::Poll(Some(Duration::from_millis(views.rate)))));
        }
        let ready = encoder.is_ready();
        if enabled_button(ui, ready, "", &skin.say("live.once")).clicked() {
            actions.push(Action::Hiperface(encoder.id, Hiperface::ReadPosition));
        }
        let rates = RATES.map(|(milliseconds, id)| (milliseconds, skin.say(id)));
        if choice(ui, &skin.say("live.rate"), &mut views.rate, rates) && polling.is_some() {
            actions.push(Action::Hiperface(encoder.id, Hiperface::Poll(Some(Duration::from_millis(views.rate)))));
        }
    });
}

fn curve(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let (connected, curve) = (encoder.line().is_some(), &encoder.curve);
    let unit = match curve.unit() {
        Unit::Turns => skin.say("live.unit_turns"),
        Unit::Millimetres => "mm".to_owned(),
        Unit::Steps => skin.say("live.steps"),
    };
    ui.horizontal(|ui| {
        ui.label(skin.caption(format!("{} / {unit}", skin.say("live.position"))));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if icon_button(ui, curve.points().len() > 1, icons::TRASH, &skin.say("live.clear")).clicked() {
                actions.push(Action::Hiperface(encoder.id, Hiperface::ClearCurve));
            }
        });
    });
    let colour = skin.palette.series.first().copied().unwrap_or(skin.palette.accent);
    skin.sunken().inner_margin(4).show(ui, |ui| {
        let height = ui.available_height().max(80.0);
        if curve.points().len() < 2 {
            ui.set_min_size(egui::vec2(ui.available_width().max(0.0), height));
            nothing(ui, skin, &skin.say(if connected { "live.no_curve" } else { "live.nothing" }));
            return;
        }
        // Ticks fade from one colour into the other as they come closer together.
        ui.visuals_mut().widgets.noninteractive.fg_stroke.color = skin.palette.muted.into();
        ui.visuals_mut().override_text_color = Some(skin.palette.muted.into());
        let plot = Plot::new("position")
            .allow_scroll(false)
            .allow_drag(false)
            .allow_boxed_zoom(false)
            .show_background(false)
            .grid_spacing(egui::Rangef::new(48.0, 300.0))
            .set_margin_fraction(egui::vec2(0.0, 0.15))
            .x_axis_formatter(|mark, _| format!("{} s", mark.value))
            .auto_bounds(true);
        plot.height(height).show(ui, |plot| {
            for (at, run) in runs(curve).into_iter().enumerate() {
                if run.len() == 1 {
                    plot.points(Points::new(at.to_string(), PlotPoints::Owned(run)).color(colour).radius(2.0));
                } else {
                    plot.line(Line::new(at.to_string(), PlotPoints::Owned(run)).color(colour).width(1.5));
                }
            }
        });
    });
}

/// Seconds between readings from which they do not belong together.
const APART: f64 = 2.5;

/// The stretches of the curve between its gaps.
fn runs(curve: &Curve) -> Vec<Vec<egui_plot::PlotPoint>> {
    let mut runs = vec![Vec::new()];
    for point in curve.points() {
        match (point.value, runs.last_mut()) {
            (Some(value), _) => {
                let point = egui_plot::PlotPoint::new(point.seconds, value);
                match runs.last_mut() {
                    // A line between readings far apart would tell of a movement that nobody has seen.
                    Some(run) if run.last().is_none_or(|last: &egui_plot::PlotPoint| point.x - last.x < APART) => {
                        run.push(point);
                    }
                    _ => runs.push(vec![point]),
                }
            }
            (None, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
            (None, _) => {}
        }
    }
    runs
}
