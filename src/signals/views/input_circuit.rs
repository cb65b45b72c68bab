//! Calculator for the input circuit of a drive. Nothing is measured here.

use egui::{RichText, Ui};

use crate::analysis::input_circuit::BANDWIDTH_HZ;
use crate::app::Text;
use crate::signals::state::input_circuit::{Form, InputCircuitResult, OperatingPoint};
use crate::signals::state::{TEXTS, Unit};
use crate::signals::views::translate;
use crate::ui::controls::{card, labelled_entry, paragraph, row, show_error_below, split};
use crate::ui::widgets::{Chart, Trace, chart};
use crate::ui::{Theme, icons};

const ENTRY_WIDTH: f32 = 80.0;
const ROWS: u32 = 10;
const POINTS: u32 = 100;
const CHART_HEIGHT: f32 = 220.0;

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, form: &mut Form) {
    // The result is drawn beside the entries, and so it is calculated first.
    let circuit = form.calculate_circuit();
    split(
        ui,
        theme,
        (0.4, 560.0),
        form,
        |ui, form| {
            entries_ui(ui, theme, form, circuit.as_ref().err());
            theme.add_gap(ui);
            notes_ui(ui, theme);
        },
        |ui, _| {
            if let Ok(circuit) = &circuit {
                operating_point_ui(ui, theme, circuit);
                theme.add_gap(ui);
                table_ui(ui, theme, circuit);
            }
        },
    );
    if let Ok(circuit) = &circuit {
        theme.add_gap(ui);
        curves_ui(ui, theme, circuit);
    }
}

fn entries_ui(ui: &mut Ui, theme: &Theme, form: &mut Form, refused: Option<&Text>) {
    card(ui, theme, TEXTS.text("input.entries"), |ui| {
        for (id, text, hint) in [
            ("input.periods", &mut form.periods, "1024"),
            ("input.speed", &mut form.speed, "6000"),
            ("input.resistance", &mut form.resistance, "10k"),
            ("input.capacitance", &mut form.capacitance, "47p"),
        ] {
            labelled_entry(ui, theme, TEXTS.text(id), text, ENTRY_WIDTH, hint);
        }
        show_error_below(ui, theme, refused);
    });
}

fn notes_ui(ui: &mut Ui, theme: &Theme) {
    card(ui, theme, TEXTS.text("input.notes"), |ui| {
        for id in ["input.note_resistor", "input.note_adc", "input.note_lag"] {
            paragraph(ui, theme.label(translate(theme, id)));
        }
    });
}

fn operating_point_ui(ui: &mut Ui, theme: &Theme, circuit: &InputCircuitResult) {
    let OperatingPoint { frequency_hz, response, shaft_deg, .. } = circuit.here;
    let limit_khz = BANDWIDTH_HZ / 1e3;
    card(ui, theme, TEXTS.text("input.here"), |ui| {
        ui.label(theme.value(format!(
            "{} {}",
            theme.format_number(frequency_hz / 1e3, 3),
            Unit::Kilohertz.unit_symbol()
        )));
        let (icon, colour, id) = match circuit.is_within_bandwidth() {
            true => (icons::CHECK_CIRCLE, theme.palette.good, "input.within"),
            false => (icons::WARNING, theme.palette.warn, "input.beyond"),
        };
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icon).color(colour));
            let text = TEXTS.text(id).with_number("limit", limit_khz, 0);
            paragraph(ui, RichText::new(theme.format_text(&text)).color(colour));
        });
        let number =
            |value, decimals, unit: &str| theme.monospace(format!("{}{unit}", theme.format_number(value, decimals)));
        let khz = |hertz: f64| {
            theme.monospace(format!("{} {}", theme.format_number(hertz / 1e3, 1), Unit::Kilohertz.unit_symbol()))
        };
        let rpm = format!("{} {}", theme.format_number(circuit.most_rpm, 1), translate(theme, "input.rpm"));
        row(ui, theme, &translate(theme, "input.most"), theme.monospace(rpm));
        row(ui, theme, &translate(theme, "input.lag"), number(response.phase_deg, 3, "° el."));
        row(ui, theme, &translate(theme, "input.lag_steps"), number(response.lag_in_steps(), 3, "/32"));
        row(ui, theme, &translate(theme, "input.lag_shaft"), number(shaft_deg, 5, "°"));
        let gain = format!(
            "{}  ({} dB)",
            theme.format_number(response.gain, 5),
            theme.format_number(20.0 * response.gain.log10(), 2)
        );
        row(ui, theme, &translate(theme, "input.gain"), theme.monospace(gain));
        row(ui, theme, &translate(theme, "input.corner"), khz(circuit.corner_hz));
        row(ui, theme, &translate(theme, "input.sampling"), khz(2.0 * frequency_hz));
        row(ui, theme, &translate(theme, "input.skew"), number(circuit.sampling_skew_deg(), 2, "° el./µs"));
    });
}

fn table_ui(ui: &mut Ui, theme: &Theme, circuit: &InputCircuitResult) {
    card(ui, theme, TEXTS.text("input.table"), |ui| {
        // The rows are low, because they contain no controls.
        ui.spacing_mut().interact_size.y = theme.space.groups;
        egui::ScrollArea::horizontal().id_salt("input.table").show(ui, |ui| {
            let grid = egui::Grid::new("input.table").spacing([theme.space.between, theme.space.inside]);
            grid.show(ui, |ui| {
                for id in ["input.rpm", "input.khz", "input.column_lag", "input.column_steps", "input.gain"] {
                    ui.label(theme.caption(translate(theme, id)));
                }
                ui.end_row();
                for point in circuit.operating_points(ROWS) {
                    let response = point.response;
                    for (value, decimals) in [
                        (point.speed_rpm, 1),
                        (point.frequency_hz / 1e3, 1),
                        (response.phase_deg, 3),
                        (response.lag_in_steps(), 3),
                        (response.gain, 5),
                    ] {
                        ui.label(theme.monospace(format!("{:>7}", theme.format_number(value, decimals))));
                    }
                    ui.end_row();
                }
            });
        });
    });
}

fn curves_ui(ui: &mut Ui, theme: &Theme, circuit: &InputCircuitResult) {
    let course = circuit.operating_points(POINTS);
    let trace = |id, colour, dashed, value: fn(&OperatingPoint) -> f64| Trace {
        name: translate(theme, id),
        points: course.iter().map(|point| (point.speed_rpm, value(point))).collect(),
        colour,
        dashed,
    };
    let traces = [
        trace("input.curve_lag", 0, false, |point| point.response.phase_deg),
        trace("input.curve_gain", 1, true, |point| 100.0 * point.response.gain),
    ];
    card(ui, theme, TEXTS.text("input.curves"), |ui| {
        let (label, rpm) = (translate(theme, "input.curves"), translate(theme, "input.rpm"));
        let value = TEXTS
            .text("input.curves_value")
            .with_number("lag", course.last().map_or(0.0, |point| point.response.phase_deg), 2)
            .with_number("rpm", circuit.most_rpm, 0);
        let value = theme.format_text(&value);
        let drawn = Chart {
            traces: &traces,
            label: &label,
            value: &value,
            height: CHART_HEIGHT,
            x_unit: &rpm,
            y_floor: Some(0.0),
            x_range: Some((0.0, circuit.most_rpm)),
            ..Chart::default()
        };
        chart(ui, theme, &drawn);
    });
}
