//! Chart of the selected cam program, as lanes or as a ring.

use egui::{RichText, Ui};

use crate::app::Action;
use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::{CamNumber, StartupMode};
use crate::devices::interbus::state::cams::{Chart, VisibleRange as Stretch};
use crate::devices::interbus::state::{Edit, Encoder, InterbusAction as Interbus, OutputComparison, TEXTS};
use crate::devices::interbus::views::translate;
use crate::devices::interbus::views::widgets::{CamChart, CamEvent, cam_lanes, cam_ring};
use crate::ui::controls::{card_with_trailing, icon_button, name, paragraph};
use crate::ui::{Theme, icons};

pub(super) struct CamChartUiState {
    ring: bool,
    snaps: bool,
    /// Visible part of the measuring range, or `None` if all of it is visible.
    stretch: Option<Stretch>,
    selected: Option<CamNumber>,
}

impl Default for CamChartUiState {
    fn default() -> Self {
        CamChartUiState { ring: false, snaps: true, stretch: None, selected: None }
    }
}

/// Maximum side length of the ring in points.
const MAX_RING_SIDE: f32 = 420.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    chart: &Chart,
    view: &mut CamChartUiState,
    actions: &mut Vec<Action>,
) {
    let CamChartUiState { ring: is_ring, snaps, stretch, selected } = *view;
    let aside = |ui: &mut Ui| {
        for (own, id) in [(true, "ib_cams.ring"), (false, "ib_cams.lanes")] {
            let word = translate(theme, id);
            if name(ui.add(egui::Button::selectable(is_ring == own, &word)), true, &word).clicked() {
                view.ring = own;
            }
        }
        ui.checkbox(&mut view.snaps, translate(theme, "ib_cams.snap"))
            .on_hover_text(translate(theme, "ib_cams.snap_words"));
        let word = translate(theme, "ib_cams.whole_range");
        if !is_ring && icon_button(ui, stretch.is_some(), icons::CORNERS_OUT, &word).clicked() {
            view.stretch = None;
        }
    };
    let mut event = None;
    let edit = |edit: Edit| Action::device(encoder.session.id, Interbus::Edit(Box::new(edit)));
    card_with_trailing(ui, theme, TEXTS.text("ib_cams.title"), aside, |ui| {
        let label = theme.format_text(&TEXTS.text("ib_startup.program").with("program", chart.program.get()));
        // Without polling, the last reading is old and must not be shown as the current one.
        let reading = encoder.record.last().filter(|_| encoder.session.is_polling());
        let sends = reading.filter(|own| own.mode == Some(StartupMode::Cams(chart.program)));
        let model = CamChart {
            label: &label,
            chart,
            compared: None,
            scale: &encoder.scale,
            position: reading.and_then(WordReading::position),
            own: sends.and_then(|own| own.cams()).map(|cams| cams.outputs),
            selected,
            movable: !encoder.session.is_writing(),
            snaps,
        };
        ui.push_id(chart.program.get(), |ui| {
            event = if is_ring {
                let side = ui.available_width().min(MAX_RING_SIDE);
                ui.vertical_centered(|ui| cam_ring(ui, theme, &model, side)).inner
            } else {
                let stretch = stretch.unwrap_or_else(|| Stretch::full(chart.range));
                cam_lanes(ui, theme, &model, stretch)
            };
        });
        if sends.is_some() {
            output_comparison_ui(ui, theme, &encoder.preview);
        } else if reading.is_none() && encoder.session.live_session().is_some() {
            paragraph(ui, theme.caption(translate(theme, "ib_cams.not_live")));
        }
        paragraph(ui, theme.caption(translate(theme, "ib_cams.chart_words")));
    });
    let program = chart.program;
    match event {
        Some(CamEvent::Moved { cam, to, drawn }) => {
            view.selected = Some(cam);
            let (start, stop) = (to.start.get(), to.stop.get());
            actions.push(edit(Edit::Cam { program, cam, start, stop, on: drawn }));
        }
        Some(CamEvent::Switched(cam, on)) => actions.push(edit(Edit::Switch { program, cam, on })),
        Some(CamEvent::Selected(cam)) => view.selected = Some(cam),
        Some(CamEvent::Viewed(stretch)) => {
            view.stretch = Some(stretch).filter(|own| !own.is_whole(chart.range));
        }
        // The chart draws the preview itself.
        Some(CamEvent::Preview(..)) | None => {}
    }
}

fn output_comparison_ui(ui: &mut Ui, theme: &Theme, preview: &OutputComparison) {
    let OutputComparison { same, other, last, .. } = preview;
    let Some(last) = last else {
        if *same > 0 {
            let text = TEXTS.text("ib_cams.agree").with("words", same);
            paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.good));
        }
        return;
    };
    let bits = |outputs: u8| format!("{outputs:08b}");
    let text = TEXTS
        .text("ib_cams.differ")
        .with("words", same + other)
        .with("other", other)
        .with("position", last.position)
        .with("own", bits(last.own))
        .with("expected", bits(last.expected));
    paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.warn));
}
