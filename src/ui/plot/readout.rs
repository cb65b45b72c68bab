//! The numbers below the chart: of each line the raw sample under the pointer, or the newest, and what the cursors tell.

use egui::{RichText, Sense, Ui, vec2};

use super::{Context, axes, chart};
use crate::app::recorder::{Line, Measured, SAMPLE};
use crate::signal::Time;
use crate::signal::history::{Flags, Sample};
use crate::ui::Skin;

pub(super) fn readout_ui(ui: &mut Ui, context: &Context<'_>, hovered: Option<Time>) {
    let (skin, recorder) = (context.skin, context.recorder);
    if recorder.is_empty() {
        return;
    }
    ui.spacing_mut().item_spacing = vec2(skin.space.between, 2.0);
    ui.spacing_mut().interact_size.y = 16.0;
    if let Some(between) = recorder.between_cursors() {
        ui.horizontal_wrapped(|ui| {
            if recorder.counts() {
                figure(ui, skin, "Δn", &(between / SAMPLE).to_string());
                return;
            }
            figure(ui, skin, "Δt", &axes::duration(between, skin.language));
            if between != 0 {
                let hertz = 1e9 / between.abs() as f64;
                figure(ui, skin, "1/Δt", &format!("{} Hz", skin.number(hertz, if hertz < 100.0 { 3 } else { 1 })));
            }
        });
    }
    for line in recorder.shown() {
        ui.horizontal_wrapped(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
            ui.painter().rect_filled(rect.shrink(1.0), 2.0, chart::colour(skin, line));
            ui.label(skin.caption(skin.words(&line.name)));
            let sample = hovered.map_or_else(|| newest(context, line), |time| recorder.nearest(line, time));
            ui.label(small(skin, sample.map_or_else(|| "–".to_owned(), |sample| value(skin, line, &sample))));
            let unit = line.scale().map(|scale| skin.words(&scale.unit)).unwrap_or_default();
            ui.label(skin.caption(unit));
            if let Some(remark) = &line.remark {
                ui.label(RichText::new(skin.words(remark)).size(skin.sizes.caption).color(skin.palette.warn));
            }
            if let Some(measured) = recorder.measure(line) {
                measured_ui(ui, skin, line, &measured);
            }
        });
    }
}

fn measured_ui(ui: &mut Ui, skin: &Skin, line: &Line, measured: &Measured) {
    let decimals = line.decimals();
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| skin.number(value, decimals));
    figure(ui, skin, "A", &number(measured.a));
    figure(ui, skin, "B", &number(measured.b));
    figure(ui, skin, "Δ", &number(measured.difference));
    if let Some(between) = &measured.between {
        figure(ui, skin, &skin.say("recorder.mean"), &number(Some(between.mean)));
        figure(ui, skin, &skin.say("recorder.min"), &number(Some(between.min)));
        figure(ui, skin, &skin.say("recorder.max"), &number(Some(between.max)));
        // Noise is smaller than what is measured.
        figure(ui, skin, "σ", &skin.number(between.deviation, decimals + 1));
        figure(ui, skin, "n", &between.count.to_string());
        if between.bad > 0 && !line.derived {
            let words = RichText::new(format!("{} {}", between.bad, skin.say("recorder.bad")));
            ui.label(words.size(skin.sizes.caption).color(skin.palette.bad));
        }
    }
}

/// The last sample of a line.
fn newest(context: &Context<'_>, line: &Line) -> Option<Sample> {
    let history = context.recorder.history(line)?;
    history.sample(line.column(), history.all().end.checked_sub(1)?)
}

fn value(skin: &Skin, line: &Line, sample: &Sample) -> String {
    let value = line.value(sample);
    if sample.flags.contains(Flags::BAD) || !value.is_finite() {
        return "–".to_owned();
    }
    skin.number(value, line.decimals())
}

fn small(skin: &Skin, words: impl Into<String>) -> RichText {
    RichText::new(words).font(egui::FontId::monospace(skin.sizes.caption + 1.0))
}

fn figure(ui: &mut Ui, skin: &Skin, label: &str, value: &str) {
    // Sign and number stay together where a line ends.
    let mut job = egui::text::LayoutJob::default();
    let format = |size, colour: crate::app::Rgb| egui::TextFormat {
        font_id: egui::FontId::monospace(size),
        color: colour.into(),
        ..egui::TextFormat::default()
    };
    job.append(label, 0.0, format(skin.sizes.caption, skin.palette.muted));
    job.append(value, 4.0, format(skin.sizes.caption + 1.0, skin.palette.text));
    ui.add(egui::Label::new(job).extend());
}
