//! Screenshots of the plot. The window delivers its pixels some frames after a request, and they are cropped to the
//! plot. The whole plot must be visible, not covered by a menu or the pointer.

use std::sync::{Arc, OnceLock};

use egui::{ColorImage, Context, Rect, Ui};

use crate::app::{Action, Picture};

#[derive(Default)]
pub(super) enum Screenshot {
    #[default]
    None,
    /// A snapshot was requested and waits until the plot is visible. Contains the number of frames waited so far.
    Wanted(usize),
    /// The window's pixels were requested. The rectangle is the position of the plot in the previous frame.
    Asked(Arc<OnceLock<Arc<ColorImage>>>, Rect),
}

/// Maximum number of frames to wait for the plot to scroll into view.
const FRAMES: usize = 60;

impl Screenshot {
    /// Requests a snapshot from a later frame, because the menu is still open in the current one.
    pub(super) fn request(&mut self, ctx: &Context) {
        *self = Screenshot::Wanted(0);
        ctx.request_repaint();
    }

    /// Returns whether a snapshot is pending and may be captured in the next frame.
    pub(super) fn is_wanted(&self) -> bool {
        !matches!(self, Screenshot::None)
    }

    /// Handles the plot drawn at `plot`. Requests the window's pixels once the whole plot is visible. When they have
    /// arrived, crops them to the plot.
    pub(super) fn handle_plot(&mut self, ui: &Ui, plot: Rect, actions: &mut Vec<Action>) {
        match self {
            Screenshot::None => {}
            // The menu closes in the first frame.
            Screenshot::Wanted(0) => {
                *self = Screenshot::Wanted(1);
                ui.ctx().request_repaint();
            }
            Screenshot::Wanted(frames) if !ui.clip_rect().expand(0.5).contains_rect(plot) => {
                *frames += 1;
                if *frames > FRAMES {
                    *self = Screenshot::None;
                    actions.push(Action::PictureTruncated);
                    return;
                }
                ui.scroll_to_rect(plot, None);
                ui.ctx().request_repaint();
            }
            Screenshot::Wanted(_) => *self = Screenshot::Asked(request_screenshot(ui.ctx()), plot),
            Screenshot::Asked(place, before) => match place.get().cloned() {
                // The pixels belong to the previous frame.
                Some(image) => {
                    let wanted = *before;
                    *self = Screenshot::None;
                    actions.extend(crop(&image, wanted, ui.ctx().pixels_per_point()).map(Action::AskPicture));
                }
                None => *before = plot,
            },
        }
    }
}

fn request_screenshot(ctx: &Context) -> Arc<OnceLock<Arc<ColorImage>>> {
    let place: Arc<OnceLock<Arc<ColorImage>>> = Arc::default();
    let (kept, waker) = (place.clone(), ctx.clone());
    ctx.request_screenshot(move |image| {
        // The callback is called only once.
        let _ = kept.set(image);
        waker.request_repaint();
    });
    ctx.request_repaint();
    place
}

fn crop(image: &ColorImage, wanted: Rect, pixels_per_point: f32) -> Option<Picture> {
    let [width, height] = image.size;
    let pixel = |points: f32, most: usize| ((points * pixels_per_point).round().max(0.0) as usize).min(most);
    let (left, right) = (pixel(wanted.left(), width), pixel(wanted.right(), width));
    let (top, bottom) = (pixel(wanted.top(), height), pixel(wanted.bottom(), height));
    let rows = image.pixels.chunks(width.max(1)).take(bottom).skip(top);
    let bytes: Vec<u8> = rows
        .flat_map(|row| row.get(left..right).unwrap_or_default())
        .flat_map(|colour| [colour.r(), colour.g(), colour.b()])
        .collect();
    let size = |from: usize, to: usize| u32::try_from(to.saturating_sub(from)).ok();
    Picture::new(size(left, right)?, size(top, bottom)?, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Color32, pos2};

    #[test]
    fn captures_part_of_window() {
        let mut image = ColorImage::filled([8, 6], Color32::BLACK);
        image.pixels[2 * 8 + 4] = Color32::RED;
        let wanted = Rect::from_min_max(pos2(2.0, 1.0), pos2(3.0, 2.0));
        let mut bytes = vec![0; 12];
        bytes[0] = 255;
        assert_eq!(crop(&image, wanted, 2.0), Picture::new(2, 2, bytes), "a point is two pixels");
        assert_eq!(crop(&image, Rect::NOTHING, 2.0), None);
        let beyond = Rect::from_min_max(pos2(-5.0, -5.0), pos2(99.0, 99.0));
        assert_eq!(
            crop(&image, beyond, 1.0).unwrap(),
            Picture::new(8, 6, {
                let mut all = vec![0; 8 * 6 * 3];
                all[(2 * 8 + 4) * 3] = 255;
                all
            })
            .unwrap()
        );
    }

    /// Draws a frame with a plot at the given position in an area of the given size. Returns the requests made in this
    /// frame.
    fn frame(ctx: &Context, shot: &mut Screenshot, area: f32, plot: Rect) -> Vec<Action> {
        let mut actions = Vec::new();
        let screen = Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(area, area));
        let input = egui::RawInput { screen_rect: Some(screen), ..Default::default() };
        let mut output = ctx.run_ui(input, |ui| {
            ui.set_clip_rect(screen);
            shot.handle_plot(ui, plot, &mut actions);
        });
        output.textures_delta.clear();
        actions
    }

    /// The menu is open when the snapshot is requested, and other widgets surround the plot.
    #[test]
    fn snapshot_matches_plot_of_its_frame() {
        let ctx = Context::default();
        let mut shot = Screenshot::default();
        let place = |left: f32| Rect::from_min_size(pos2(left, 2.0), egui::vec2(3.0, 2.0));
        assert!(frame(&ctx, &mut shot, 8.0, place(1.0)).is_empty() && !shot.is_wanted());
        shot.request(&ctx);
        assert!(frame(&ctx, &mut shot, 8.0, place(1.0)).is_empty());
        assert!(matches!(shot, Screenshot::Wanted(1)), "the menu is still open in this frame");
        frame(&ctx, &mut shot, 8.0, place(1.0));
        // The plot moves in the captured frame, and again before the pixels have arrived.
        frame(&ctx, &mut shot, 8.0, place(4.0));
        let Screenshot::Asked(pixels, _) = &shot else { panic!() };
        let mut image = ColorImage::filled([8, 8], Color32::BLACK);
        image.pixels[2 * 8 + 4] = Color32::RED;
        pixels.set(Arc::new(image)).unwrap();
        let mut bytes = vec![0; 3 * 2 * 3];
        bytes[0] = 255;
        let actions = frame(&ctx, &mut shot, 8.0, place(0.0));
        let [Action::AskPicture(picture)] = &actions[..] else { panic!("{} actions", actions.len()) };
        assert_eq!(Some(picture), Picture::new(3, 2, bytes).as_ref());
        assert!(!shot.is_wanted());
    }

    /// A partly hidden plot is not captured, and a message reports this.
    #[test]
    fn partly_hidden_plot_yields_no_snapshot() {
        let ctx = Context::default();
        let mut shot = Screenshot::default();
        shot.request(&ctx);
        let plot = Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(8.0, 20.0));
        let told = (0..100).flat_map(|_| frame(&ctx, &mut shot, 8.0, plot)).collect::<Vec<_>>();
        assert!(matches!(&told[..], [Action::PictureTruncated]) && !shot.is_wanted());
    }
}
