//! Draws an exported picture in the window, with the same shapes as in the exported file.

use egui::accesskit::Role;
use egui::{
    Align2, Color32, FontId, Pos2, Rect, ScrollArea, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2,
};

use crate::drawing::{Drawing, DrawingLabel, DrawingShape, LabelAlign, PathSegment};
use crate::ui::Theme;

/// Minimum scale at which the numbers are legible. A picture that would be drawn smaller can be scrolled.
const MIN_SCALE: f32 = 0.75;
const MAX_SCALE: f32 = 1.4;

/// Draws a picture on a white background in the available width. Its title is the accessible name.
pub(super) fn picture_ui(ui: &mut Ui, theme: &Theme, picture: &Drawing) {
    ScrollArea::horizontal().id_salt("picture").auto_shrink([false, true]).show(ui, |ui| {
        let scale = (ui.available_width() / picture.width as f32).clamp(MIN_SCALE, MAX_SCALE);
        let size = Vec2::new(picture.width as f32, picture.height as f32) * scale;
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let told = texts(picture);
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Image, true, &picture.title);
            info.current_text_value = Some(told.clone());
            info
        });
        if ui.is_rect_visible(rect) {
            let paper = DiagramCanvas { ui, theme, origin: rect.min, scale };
            ui.painter().rect_filled(rect, theme.radius, Color32::WHITE);
            picture.shapes.iter().for_each(|shape| paper.draw(shape));
        }
    });
}

fn texts(picture: &Drawing) -> String {
    let texts = picture.shapes.iter().filter_map(|shape| match shape {
        DrawingShape::Text(label) if !label.text.is_empty() => Some(label.text.as_str()),
        _ => None,
    });
    texts.collect::<Vec<_>>().join(", ")
}

struct DiagramCanvas<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    origin: Pos2,
    scale: f32,
}

impl DiagramCanvas<'_> {
    fn screen_position(&self, x: f64, y: f64) -> Pos2 {
        self.origin + Vec2::new(x as f32, y as f32) * self.scale
    }

    fn draw(&self, shape: &DrawingShape) {
        let painter = self.ui.painter();
        match shape {
            DrawingShape::Box { x, y, width, height, fill, line } => {
                let from = self.screen_position(x.units(), y.units());
                let to = self.screen_position(x.units() + width.units(), y.units() + height.units());
                let stroke = Stroke::new(self.scale, parse_colour(line));
                painter.rect(Rect::from_min_max(from, to), 0.0, parse_colour(fill), stroke, StrokeKind::Middle);
            }
            DrawingShape::Line { path, colour: own } => self.paint_line(path, parse_colour(own)),
            DrawingShape::Text(label) => self.text(label),
        }
    }

    fn paint_line(&self, path: &[PathSegment], colour: Color32) {
        let stroke = Stroke::new(self.scale, colour);
        let mut runs: Vec<Vec<Pos2>> = Vec::new();
        for step in path {
            let last = runs.last().and_then(|run| run.last()).copied().unwrap_or(self.origin);
            let next = match step {
                PathSegment::Move(x, y) => {
                    runs.push(vec![self.screen_position(x.units(), y.units())]);
                    continue;
                }
                PathSegment::Across(x) => pos2(self.screen_position(x.units(), 0.0).x, last.y),
                PathSegment::To(x, y) => self.screen_position(x.units(), y.units()),
                PathSegment::Down(y) => pos2(last.x, self.screen_position(0.0, y.units()).y),
            };
            if let Some(run) = runs.last_mut() {
                run.push(next);
            }
        }
        self.ui.painter().extend(runs.into_iter().map(|run| Shape::line(run, stroke)));
    }

    fn text(&self, label: &DrawingLabel) {
        let size = label.size as f32 * self.scale;
        let font = if label.is_bold { self.theme.bold_font(size) } else { FontId::proportional(size) };
        let align = match label.align {
            LabelAlign::Left => Align2::LEFT_BOTTOM,
            LabelAlign::Centre => Align2::CENTER_BOTTOM,
            LabelAlign::Right => Align2::RIGHT_BOTTOM,
        };
        // Descenders reach about a fifth of the font size below the baseline.
        let at = self.screen_position(label.x.units(), label.y.units()) + Vec2::new(0.0, 0.22 * size);
        self.ui.painter().text(at, align, &label.text, font, label.colour.map_or(Color32::BLACK, parse_colour));
    }
}

/// Parses a colour. An invalid colour becomes black.
fn parse_colour(text: &str) -> Color32 {
    Color32::from_hex(text).unwrap_or(Color32::BLACK)
}
