//! The header of a lane, with the cam's switch, number, name and output indicator.

use egui::accesskit::Role;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, CornerRadius, FontId, Rect, Sense, Stroke, StrokeKind, Vec2, WidgetInfo, pos2};

use super::LanePainter;
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::cams::{Lane, OutputState, labels};
use crate::devices::interbus::views::translate;
use crate::devices::interbus::views::widgets::cam_chart::{CamEvent, display_colour};
use crate::ui::widgets::focus_ring;
use crate::ui::{controls, icons};

const SWITCH_WIDTH: f32 = 24.0;
const NUMBER_WIDTH: f32 = 18.0;
const INDICATOR_WIDTH: f32 = 34.0;

impl LanePainter<'_> {
    pub(super) fn draw_lane_headers(&self) -> Option<CamEvent> {
        let lamps = self.model.chart.output_states(self.model.position, self.model.own);
        let mut event = None;
        for (lane, lamp) in self.shown.lanes.iter().zip(lamps) {
            let head = self.place.lane_header_rect(lane.cam);
            event = self.name(lane, head).or(event);
            self.paint_output_lamp(lane, lamp, head);
        }
        event
    }

    pub(super) fn paint_switch(&self, lane: &Lane) -> Option<CamEvent> {
        let (ui, head) = (self.ui, self.place.lane_header_rect(lane.cam));
        let can = self.model.movable && (lane.edges.is_some() || lane.on);
        let size = ui.spacing().icon_width;
        let square = Rect::from_center_size(pos2(head.left() + size / 2.0 + 1.0, head.center().y), Vec2::splat(size));
        let sense = if can { Sense::click() } else { Sense::hover() };
        let response = ui.interact(square, self.base.with("switch").with(lane.cam), sense);
        let label = TEXTS.text("cams.works_of").with_text("cam", labels::cam_name(lane.cam));
        let label = self.theme.format_text(&label);
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, can, lane.on, label.clone()));
        let painter = ui.painter();
        let palette = self.theme.palette;
        let (fill, edge) = match (can, lane.on, response.hovered()) {
            (true, true, _) => (palette.accent, palette.accent),
            (true, false, true) => (palette.sunken, palette.accent),
            (true, false, false) => (palette.sunken, palette.muted),
            (false, true, _) => (palette.muted, palette.muted),
            (false, false, _) => (palette.sunken, palette.line),
        };
        let corners = CornerRadius::same(4);
        painter.rect_filled(square, corners, fill);
        painter.rect_stroke(square, corners, Stroke::new(1.0, edge), StrokeKind::Inside);
        if lane.on {
            let font = FontId::proportional(self.theme.sizes.body);
            let ink = if can { palette.on_accent } else { palette.surface };
            painter.text(square.center(), Align2::CENTER_CENTER, icons::CHECK, font, ink.into());
        }
        if response.has_focus() {
            focus_ring(painter, self.theme, square, corners);
        }
        let pressed = response.clicked().then_some(CamEvent::Switched(lane.cam, !lane.on));
        response.on_hover_text(label);
        pressed
    }

    fn name(&self, lane: &Lane, head: Rect) -> Option<CamEvent> {
        let (theme, palette) = (self.theme, self.theme.palette);
        let left = head.left() + SWITCH_WIDTH;
        let rect = Rect::from_min_max(pos2(left, head.top()), pos2(head.right() - INDICATOR_WIDTH, head.bottom()));
        let response = self.ui.interact(rect, self.base.with("name").with(lane.cam), Sense::CLICK);
        let painter = self.ui.painter().with_clip_rect(rect.intersect(self.ui.clip_rect()));
        let colour = if lane.on { palette.text } else { palette.muted };
        let y = rect.center().y;
        let font = FontId::monospace(theme.sizes.body);
        painter.text(pos2(left, y), Align2::LEFT_CENTER, lane.cam.get().to_string(), font, colour.into());
        let troubled = lane.beyond || lane.clashes;
        let mark = match (troubled, lane.edited) {
            (true, _) => Some((icons::WARNING, palette.bad)),
            (false, true) => Some((icons::PENCIL_SIMPLE, palette.staged)),
            (false, false) => None,
        };
        let mut x = left + NUMBER_WIDTH;
        if let Some((icon, colour)) = mark {
            let font = FontId::proportional(theme.sizes.body);
            painter.text(pos2(x, y), Align2::LEFT_CENTER, icon, font, colour.into());
            x += theme.sizes.body + theme.space.inside;
        }
        let name = lane.name.clone().unwrap_or_default();
        let ink = if lane.edited { palette.staged } else { colour };
        let mut job = LayoutJob::simple_singleline(name, FontId::proportional(theme.sizes.body), ink.into());
        job.wrap = TextWrapping::truncate_at_width((rect.right() - x).max(0.0));
        let galley = painter.layout_job(job);
        let size = galley.size();
        painter.galley(pos2(x, y - size.y / 2.0), galley, ink.into());
        if lane.edited && size.x > 0.0 {
            painter.hline(x..=x + size.x, y + size.y / 2.0, Stroke::new(1.0, palette.staged));
        }
        let clicked = response.clicked().then_some(CamEvent::Selected(lane.cam));
        response.on_hover_ui(|ui| {
            ui.set_max_width(300.0);
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
            ui.label(theme.format_text(&labels::cam(lane)));
            ui.label(theme.format_text(&labels::lane_text(lane, self.model.scale, self.model.chart.range)));
            if lane.edited {
                ui.label(egui::RichText::new(translate(theme, "cams.edited")).color(palette.staged));
            }
            for trouble in labels::lane_problems(self.shown, lane) {
                ui.label(egui::RichText::new(theme.format_text(&trouble)).color(palette.bad));
            }
        });
        clicked
    }

    fn paint_output_lamp(&self, lane: &Lane, lamp: OutputState, head: Rect) {
        let (theme, palette) = (self.theme, self.theme.palette);
        let rect = Rect::from_min_max(pos2(head.right() - INDICATOR_WIDTH, head.top()), head.max);
        let response = self.ui.interact(rect, self.base.with("lamp").with(lane.cam), Sense::hover());
        let label = theme.format_text(&TEXTS.text("cams.output_of").with("cam", lane.cam.get()));
        let value = theme.format_text(&labels::output_text(lamp));
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Image, true, label.clone());
            info.current_text_value = Some(value.clone());
            info
        });
        let painter = self.ui.painter();
        let middle = pos2(rect.right() - 9.0, rect.center().y);
        let colour = display_colour(theme, lane.cam);
        match lamp.effective_state() {
            Some(true) => {
                painter.circle_filled(middle, 8.0, colour.gamma_multiply(0.25));
                painter.circle_filled(middle, 5.5, colour);
            }
            Some(false) => {
                painter.circle_stroke(middle, 5.0, Stroke::new(1.5, palette.muted));
            }
            None => {
                painter.circle_stroke(middle, 5.0, Stroke::new(1.0, palette.muted));
            }
        }
        if lamp.is_mismatch() {
            let (icon, colour) = controls::verdict_badge(theme, crate::analysis::quality::Verdict::Warn);
            let font = FontId::proportional(theme.sizes.body);
            painter.text(pos2(rect.left() + 7.0, middle.y), Align2::CENTER_CENTER, icon, font, colour.into());
        }
        response.on_hover_text(format!("{label}: {value}"));
    }
}
