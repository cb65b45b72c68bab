//! Draws the bits of the control and status words, and the timing of the cyclic connection.

use egui::accesskit::Role;
use egui::{Align2, FontId, Rect, RichText, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use crate::devices::hiperdrive::procedures::cyclic::{Bucket, Histogram};
use crate::devices::hiperdrive::protocol::{ControlBit, DriveNumber, StatusBit};
use crate::devices::hiperdrive::state::{HiperdriveDevice, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{card, empty_placeholder, folding_card, paragraph, row};
use crate::ui::widgets::series_colour;

pub(super) fn control_status_words_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, drive: DriveNumber) {
    folding_card(ui, theme, TEXTS.text("hd_words.title"), |ui| {
        let Some(actual) = unit.actual_values(drive) else {
            empty_placeholder(ui, theme, &translate(theme, "hd_words.nothing"), None);
            return;
        };
        let bits = |names: Vec<String>, word: u16| RichText::new(format!("0x{word:04X}  {}", names.join(" · ")));
        let set = actual.status.set_bits().map(|bit: StatusBit| theme.format_text(&explain::status_bit(bit))).collect();
        row(ui, theme, &translate(theme, "hd_words.status"), bits(set, actual.status.to_u16()));
        if let Some(sent) = unit.moves.last_setpoint(drive) {
            let speed_mode = sent.control.is_set(ControlBit::SpeedMode);
            let set = ControlBit::ALL.into_iter().filter(|bit| sent.control.is_set(*bit));
            let set = set.map(|bit| theme.format_text(&explain::control_bit(bit, speed_mode))).collect();
            row(ui, theme, &translate(theme, "hd_words.control"), bits(set, sent.control.to_u16()));
        }
    });
}

const BARS_HEIGHT: f32 = 96.0;
const LABEL_HEIGHT: f32 = 16.0;

/// Draws the statistics of the cyclic connection: number of packets, errors, and deviations from the interval.
pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    card(ui, theme, TEXTS.text("hd_link.title"), |ui| {
        let view = unit.moves.snapshot();
        let link = &view.link;
        if link.sent == 0 {
            empty_placeholder(ui, theme, &translate(theme, "hd_link.nothing"), None);
            return;
        }
        let milliseconds = theme.format_number(link.interval.as_secs_f64() * 1e3, 1);
        row(ui, theme, &translate(theme, "hd_link.interval"), theme.monospace(format!("{milliseconds} ms")));
        let priority = if view.punctual { "hd_link.real_time" } else { "hd_link.ordinary" };
        row(ui, theme, &translate(theme, "hd_link.priority"), translate(theme, priority));
        row(
            ui,
            theme,
            &translate(theme, "hd_link.packets"),
            theme.monospace(format!("{} → · ← {}", link.sent, link.received)),
        );
        let bad =
            [("hd_link.missed", link.missed), ("hd_link.stale", link.stale), ("hd_link.malformed", link.malformed)];
        for (id, count) in bad {
            let ink = if count == 0 { theme.palette.text } else { theme.palette.warn };
            row(ui, theme, &translate(theme, id), theme.monospace(count.to_string()).color(ink));
        }
        row(
            ui,
            theme,
            &translate(theme, "hd_link.parameter_words"),
            theme.format_text(&explain::parameter_words(view)),
        );
        if let Some((least, greatest)) = link.intervals.deviation_range_us() {
            let off =
                TEXTS.text("hd_link.off").with("least", format!("{least:+}")).with("greatest", format!("{greatest:+}"));
            row(ui, theme, &translate(theme, "hd_link.jitter"), theme.monospace(theme.format_text(&off)));
        }
        histogram(ui, theme, &view.link.intervals);
        paragraph(ui, theme.caption(translate(theme, "hd_link.words")));
    });
}

/// Draws a histogram with a logarithmic scale, so that even one late packet in a million is visible.
fn histogram(ui: &mut Ui, theme: &Theme, histogram: &Histogram) {
    let buckets: Vec<Bucket> = histogram.buckets().collect();
    let size = vec2(ui.available_width().max(0.0), BARS_HEIGHT + LABEL_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let values: Vec<String> =
        buckets.iter().map(|bucket| format!("{} {}", format_bucket(bucket), bucket.count)).collect();
    let label = translate(theme, "hd_link.jitter");
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, &label);
        info.current_text_value = Some(values.join(", "));
        info
    });
    if !ui.is_rect_visible(rect) || buckets.is_empty() {
        return;
    }
    let most = buckets.iter().map(|bucket| bucket.count).max().unwrap_or(0);
    let height =
        |count: u64| if count == 0 { 0.0 } else { (1.0 + (count as f32).log10()) / (1.0 + (most as f32).log10()) };
    let width = rect.width() / buckets.len() as f32;
    let painter = ui.painter();
    let ground = rect.top() + BARS_HEIGHT;
    for (at, bucket) in buckets.iter().enumerate() {
        let left = rect.left() + width * at as f32;
        let bar = Rect::from_min_max(
            pos2(left + 1.0, ground - BARS_HEIGHT * height(bucket.count)),
            pos2(left + width - 1.0, ground),
        );
        painter.rect_filled(bar, 1.0, series_colour(theme, 1));
        let place = Rect::from_min_max(pos2(left, rect.top()), pos2(left + width, rect.bottom()));
        if response.hover_pos().is_some_and(|at| place.contains(at)) {
            response.clone().on_hover_text(format!("{}: {}", format_bucket(bucket), bucket.count));
        }
    }
    painter.hline(rect.x_range(), ground, Stroke::new(1.0, theme.palette.line));
    let font = FontId::monospace(theme.sizes.caption);
    let ink = theme.palette.muted.into();
    // The labels are the middle and both ends of the scale.
    let first = buckets.first().map(format_bucket).unwrap_or_default();
    let last = buckets.last().map(format_bucket).unwrap_or_default();
    painter.text(pos2(rect.left(), rect.bottom()), Align2::LEFT_BOTTOM, first, font.clone(), ink);
    painter.text(pos2(rect.center().x, rect.bottom()), Align2::CENTER_BOTTOM, "0", font.clone(), ink);
    painter.text(pos2(rect.right(), rect.bottom()), Align2::RIGHT_BOTTOM, last, font, ink);
}

/// Formats the range of a bucket, in microseconds.
fn format_bucket(bucket: &Bucket) -> String {
    match (bucket.from_us, bucket.below_us) {
        (None, Some(below)) => format!("< {below} µs"),
        (Some(from), None) => format!("≥ {from:+} µs"),
        (Some(from), Some(below)) => format!("{from:+}…{below:+} µs"),
        (None, None) => String::new(),
    }
}
