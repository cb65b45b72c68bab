//! A picture of the plot: the window gives its pixels with the next frame, and a part of them is kept.

use std::sync::{Arc, OnceLock};

use egui::{ColorImage, Context, Rect};

use crate::app::{Action, Picture};

/// The pixels of the window, as soon as they are there.
#[derive(Default)]
pub(super) struct Shot(Option<Arc<OnceLock<Arc<ColorImage>>>>);

impl Shot {
    /// Wishes a picture: the next one, without the menu that it was wished in.
    pub(super) fn wish(&mut self, ctx: &Context) {
        let place: Arc<OnceLock<Arc<ColorImage>>> = Arc::default();
        self.0 = Some(place.clone());
        let waker = ctx.clone();
        ctx.request_screenshot(move |image| {
            // It is called once.
            let _ = place.set(image);
            waker.request_repaint();
        });
    }

    /// Takes the pixels of the plot out of those of the window when they have come.
    pub(super) fn take(&mut self, ctx: &Context, plot: Rect, actions: &mut Vec<Action>) {
        let Some(image) = self.0.as_ref().and_then(|place| place.get()).cloned() else { return };
        self.0 = None;
        actions.extend(part(&image, plot, ctx.pixels_per_point()).map(Action::AskPicture));
    }
}

fn part(image: &ColorImage, wanted: Rect, pixels_per_point: f32) -> Option<Picture> {
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
    fn a_part_of_the_window_is_taken() {
        let mut image = ColorImage::filled([8, 6], Color32::BLACK);
        image.pixels[2 * 8 + 4] = Color32::RED;
        let wanted = Rect::from_min_max(pos2(2.0, 1.0), pos2(3.0, 2.0));
        let mut bytes = vec![0; 12];
        bytes[0] = 255;
        assert_eq!(part(&image, wanted, 2.0), Picture::new(2, 2, bytes), "a point is two pixels");
        assert_eq!(part(&image, Rect::NOTHING, 2.0), None);
        let beyond = Rect::from_min_max(pos2(-5.0, -5.0), pos2(99.0, 99.0));
        assert_eq!(
            part(&image, beyond, 1.0).unwrap(),
            Picture::new(8, 6, {
                let mut all = vec![0; 8 * 6 * 3];
                all[(2 * 8 + 4) * 3] = 255;
                all
            })
            .unwrap()
        );
    }
}
