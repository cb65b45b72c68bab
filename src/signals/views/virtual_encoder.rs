//! The settings of the virtual encoder: its motion and its faults.

use egui::{Slider, SliderClamping, Ui, WidgetInfo};

use crate::analysis::wiring::Wire;
use crate::app::{Action, explain, parse_decimal};
use crate::signals::state::{SignalsAction as Signals, Source, SourceAction, TEXTS};
use crate::signals::views::translate;
use crate::sim::sine_cosine::{Quantity, ReferenceLevel, Settings};
use crate::ui::controls::{
    card_with_trailing, dropdown, entry, label_width, labelled_button, paragraph, show_error_below, two_columns,
};
use crate::ui::{Theme, icons};

/// A slider for a setting, with its range and number of decimals. Values outside the range can be typed.
struct SliderSpec {
    quantity: Quantity,
    ends: (f64, f64),
    decimals: usize,
    /// Whether the slider is logarithmic, which gives small values more room.
    logarithmic: bool,
}

const fn linear_slider(quantity: Quantity, least: f64, most: f64, decimals: usize) -> SliderSpec {
    SliderSpec { quantity, ends: (least, most), decimals, logarithmic: false }
}

const fn slider_spec(quantity: Quantity, least: f64, most: f64, decimals: usize) -> SliderSpec {
    SliderSpec { quantity, ends: (least, most), decimals, logarithmic: true }
}

const SIGNAL: [SliderSpec; 9] = [
    slider_spec(Quantity::Speed, -6000.0, 6000.0, 1),
    slider_spec(Quantity::Periods, 1.0, 65_536.0, 0),
    slider_spec(Quantity::Rate, 1_000.0, 1_000_000.0, 0),
    linear_slider(Quantity::Amplitude, 0.0, 1.0, 3),
    linear_slider(Quantity::GainRatio, 0.5, 1.5, 3),
    linear_slider(Quantity::PhaseError, -20.0, 20.0, 2),
    linear_slider(Quantity::OffsetSine, -0.2, 0.2, 3),
    linear_slider(Quantity::OffsetCosine, -0.2, 0.2, 3),
    linear_slider(Quantity::Level, 0.0, 5.0, 2),
];
const DISTURBANCES: [SliderSpec; 8] = [
    slider_spec(Quantity::Noise, 0.0, 0.2, 4),
    slider_spec(Quantity::Interference, 0.0, 0.2, 4),
    slider_spec(Quantity::InterferenceFrequency, 10.0, 100_000.0, 0),
    slider_spec(Quantity::Hum, 0.0, 0.2, 4),
    linear_slider(Quantity::HumFrequency, 16.0, 400.0, 1),
    linear_slider(Quantity::ThirdHarmonic, 0.0, 10.0, 2),
    linear_slider(Quantity::Modulation, 0.0, 20.0, 1),
    slider_spec(Quantity::Eccentricity, 0.0, 3600.0, 1),
];
/// Selectable durations of the measured samples, in milliseconds.
const WINDOWS: [u32; 5] = [20, 50, 200, 1000, 5000];

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, source: &Source, actions: &mut Vec<Action>) {
    let mut ask = |action: SourceAction| actions.push(Action::tool(Signals::Source(action)));
    let mut reset = false;
    let aside = |ui: &mut Ui| {
        reset = labelled_button(ui, icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "virtual.reset")).clicked();
    };
    card_with_trailing(ui, theme, TEXTS.text("virtual.settings"), aside, |ui| {
        // The rows are low, because all of them must fit beside the curves that they affect.
        ui.spacing_mut().interact_size.y = 20.0;
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        ui.visuals_mut().widgets.inactive.bg_fill = theme.palette.line.into();
        show_error_below(ui, theme, source.problem());
        two_columns(
            ui,
            theme,
            &mut ask,
            |ui, ask| sliders_ui(ui, theme, source.settings(), &SIGNAL, *ask),
            |ui, ask| {
                sliders_ui(ui, theme, source.settings(), &DISTURBANCES, *ask);
                wires_ui(ui, theme, source.settings(), *ask);
                window_ui(ui, theme, source, *ask);
            },
        );
    });
    if reset {
        ask(SourceAction::Reset);
    }
}

fn sliders_ui(
    ui: &mut Ui,
    theme: &Theme,
    settings: &Settings,
    list: &[SliderSpec],
    ask: &mut impl FnMut(SourceAction),
) {
    const NUMBER_WIDTH: f32 = 96.0;
    let label = label_width(ui);
    let rail = (ui.available_width() - label - NUMBER_WIDTH - 3.0 * theme.space.between).clamp(40.0, 220.0);
    ui.spacing_mut().slider_width = rail;
    for own in list {
        let word = theme.format_text(&explain::signal::setting_name(own.quantity));
        let mut value = settings.get(own.quantity);
        let (style, decimals) = (*theme, own.decimals);
        let unit = own.quantity.unit();
        let suffix = if unit.is_empty() || unit == "°" { unit.to_owned() } else { format!(" {unit}") };
        entry(ui, theme, &word, |ui| {
            let slider = Slider::new(&mut value, own.ends.0..=own.ends.1)
                .logarithmic(own.logarithmic)
                .clamping(SliderClamping::Never)
                .suffix(suffix)
                .max_decimals(own.decimals)
                .custom_formatter(move |value, _| style.format_number(value, decimals))
                .custom_parser(parse_decimal);
            let response = ui.add(slider);
            response.widget_info(|| WidgetInfo::slider(true, value, &word));
            if response.on_hover_text(&word).changed() {
                ask(SourceAction::Set(own.quantity, value));
            }
        });
    }
}

fn wires_ui(ui: &mut Ui, theme: &Theme, settings: &Settings, ask: &mut impl FnMut(SourceAction)) {
    let word = translate(theme, "virtual.open_wire");
    let mut open = settings.open_wire;
    entry(ui, theme, &word, |ui| {
        let wires = Wire::ALL.map(|wire| (Some(wire), wire.name().to_owned()));
        let none = [(None, translate(theme, "virtual.no_wire"))];
        if dropdown(ui, &word, &mut open, none.into_iter().chain(wires)) {
            ask(SourceAction::SetOpenWire(open));
        }
    });
    let word = translate(theme, "virtual.references");
    let mut references = settings.references;
    entry(ui, theme, &word, |ui| {
        let options = [
            (ReferenceLevel::Level, translate(theme, "virtual.level")),
            (ReferenceLevel::Complement, translate(theme, "virtual.complement")),
        ];
        if dropdown(ui, &word, &mut references, options) {
            ask(SourceAction::SetReferences(references));
        }
    });
    let mut terminated = settings.terminated;
    if ui.checkbox(&mut terminated, translate(theme, "virtual.terminated")).changed() {
        ask(SourceAction::SetTerminated(terminated));
    }
}

fn window_ui(ui: &mut Ui, theme: &Theme, source: &Source, ask: &mut impl FnMut(SourceAction)) {
    let word = translate(theme, "virtual.window");
    let mut window = source.window_ms();
    entry(ui, theme, &word, |ui| {
        if dropdown(ui, &word, &mut window, WINDOWS.map(|own| (own, format!("{own} ms")))) {
            ask(SourceAction::SetWindow(window));
        }
    });
    if let Some(ms) = source.limited_window_ms() {
        let text = TEXTS.text("virtual.shortened").with_number("ms", ms, 0);
        paragraph(ui, theme.caption(theme.format_text(&text)));
    }
}
