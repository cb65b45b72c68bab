//! Calculator for the input circuit of a drive. It uses typed values only.

use egui::{Align, FontId, Layout, RichText, Ui, vec2};

use crate::analysis::input_circuit::BANDWIDTH_HZ;
use crate::app::Text;
use crate::signals::state::input_circuit::{Form, InputCircuitResult, OperatingPoint};
use crate::signals::state::{TEXTS, Unit};
use crate::signals::views::translate;
use crate::ui::controls::{card, labelled_number_entry, paragraph, row, show_error_below, split};
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
            labelled_number_entry(ui, theme, TEXTS.text(id), text, ENTRY_WIDTH, hint);
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
        let heads = ["input.rpm", "input.khz", "input.column_lag", "input.column_steps", "input.gain"];
        let rows: Vec<[String; 5]> =
            circuit.operating_points(ROWS).iter().map(|point| table_row(theme, point)).collect();
        let columns = column_widths(ui, theme, &heads.map(|id| translate(theme, id)), &rows);
        let room = ui.available_width() - columns.iter().sum::<f32>();
        // In a wide card, the last column does not extend to the edge.
        let between = (room / columns.len() as f32).clamp(theme.space.inside, theme.space.around);
        let line = |ui: &mut Ui, cells: Vec<RichText>| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = between;
                for (width, cell) in columns.iter().zip(cells) {
                    let size = vec2(*width, ui.spacing().interact_size.y);
                    ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Max), |ui| {
                        ui.set_min_width(*width);
                        ui.label(cell);
                    });
                }
            });
        };
        // The rows are low, because they contain no controls.
        ui.spacing_mut().interact_size.y = theme.space.groups;
        ui.spacing_mut().item_spacing.y = theme.space.inside;
        line(ui, heads.iter().map(|id| theme.caption(translate(theme, id))).collect());
        for row in rows {
            line(ui, row.into_iter().map(|cell| theme.monospace(cell)).collect());
        }
    });
}

fn table_row(theme: &Theme, point: &OperatingPoint) -> [String; 5] {
    let response = point.response;
    [
        theme.format_number(point.speed_rpm, 0),
        theme.format_number(point.frequency_hz / 1e3, 1),
        theme.format_number(response.phase_deg, 3),
        theme.format_number(response.lag_in_steps(), 3),
        theme.format_number(response.gain, 4),
    ]
}

/// Returns the width of each column, which fits its heading and its widest cell.
fn column_widths(ui: &Ui, theme: &Theme, heads: &[String; 5], rows: &[[String; 5]]) -> [f32; 5] {
    let width = |words: &str, font: FontId| {
        ui.painter().layout_no_wrap(words.to_owned(), font, theme.palette.text.into()).size().x.ceil()
    };
    let mut widths = heads.each_ref().map(|head| width(head, FontId::proportional(theme.sizes.caption)));
    for row in rows {
        for (own, cell) in widths.iter_mut().zip(row) {
            *own = own.max(width(cell, FontId::monospace(theme.sizes.body)));
        }
    }
    widths
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
