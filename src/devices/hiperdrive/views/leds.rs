//! What the lamps say: drawn as they look, clicked until they look like the real ones.

use egui::{Align2, Color32, FontId, Painter, Pos2, RichText, Shape, Stroke, Ui, pos2, vec2};

use crate::devices::hiperdrive::protocol::{BusLamp, BusLight, DriveLight, PortLight};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::leds::{Lamp, Leds};
use crate::devices::hiperdrive::views::say;
use crate::ui::Skin;
use crate::ui::controls::{card, entry, name, options, paragraph, severity};

/// What is picked.
#[derive(Default)]
pub(super) struct View(Leds);

/// Size of a lamp's button, and of the lamp in it.
const BUTTON: egui::Vec2 = vec2(248.0, 44.0);
const RADIUS: f32 = 9.0;

pub(super) fn cards_ui(ui: &mut Ui, skin: &Skin, View(leds): &mut View) {
    card(ui, skin, TEXTS.text("hd_led.title"), |ui| {
        paragraph(ui, skin.label(say(skin, "hd_led.words")));
        device(ui, skin, leds);
        ui.add_space(skin.space.between);
        for lamp in Lamp::ALL {
            row(ui, skin, leds, lamp);
        }
    });
}

/// Which device it is, and where its switch S3 is.
fn device(ui: &mut Ui, skin: &Skin, leds: &mut Leds) {
    let (mut hub, mut s3) = (leds.hub, leds.s3);
    let word = say(skin, "hd_led.device");
    entry(ui, skin, &word, |ui| {
        let kinds = [(false, "hd_led.adapter"), (true, "hd_led.hub")];
        options(ui, &word, &mut hub, kinds.map(|(own, id)| (own, say(skin, id))))
    });
    if hub {
        let word = say(skin, "hd_led.switch");
        let positions = (0..=8_u8).map(|own| match own {
            0 => (own, say(skin, "hd_led.switch_zero")),
            drive => (own, drive.to_string()),
        });
        entry(ui, skin, &word, |ui| options(ui, &word, &mut s3, positions));
        if s3 != 0 {
            let away = TEXTS.text("hd_led.switch_away").with("drive", s3);
            paragraph(ui, RichText::new(skin.words(&away)).color(skin.palette.warn));
        }
    }
    if (hub, s3) != (leds.hub, leds.s3) {
        leds.look_at(hub, s3);
    }
}

/// A lamp, and what it says beside it.
fn row(ui: &mut Ui, skin: &Skin, leds: &mut Leds, lamp: Lamp) {
    ui.horizontal_top(|ui| {
        lamp_ui(ui, skin, leds, lamp);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = skin.space.inside;
            let said = leds.said(lamp);
            let (icon, ink) = severity(skin, said.severity);
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icon).color(ink));
                paragraph(ui, RichText::new(skin.words(&said.meaning)).font(skin.strong(skin.sizes.body)));
            });
            paragraph(ui, skin.label(skin.words(&said.remedy)));
        });
    });
    ui.add_space(skin.space.inside);
}

/// Pressed, it shows the next of what it can.
fn lamp_ui(ui: &mut Ui, skin: &Skin, leds: &mut Leds, lamp: Lamp) {
    let shown = skin.words(&leds.shown(lamp));
    let response = ui.add(egui::Button::new("").min_size(BUTTON));
    let (rect, painter) = (response.rect, ui.painter());
    let middle = pos2(rect.left() + 24.0, rect.center().y);
    paint(painter, skin, middle, look(skin, leds, lamp));
    let text = pos2(rect.left() + 48.0, rect.center().y);
    let about = match lamp {
        Lamp::Drives if leds.hub && leds.s3 != 0 => {
            skin.words(&TEXTS.text("hd_led.switch_drive").with("drive", leds.s3))
        }
        Lamp::Drives => say(skin, "hd_led.what_drives"),
        Lamp::Bus(BusLamp::Module) => say(skin, "hd_led.what_module"),
        Lamp::Bus(BusLamp::Network) => say(skin, "hd_led.what_network"),
        Lamp::Port => say(skin, "hd_led.what_port"),
    };
    let strong = skin.strong(skin.sizes.body);
    let named = painter.text(text, Align2::LEFT_BOTTOM, lamp.name(), strong, skin.palette.text.into());
    let caption = FontId::proportional(skin.sizes.caption);
    let beside = named.right_bottom() + vec2(skin.space.between, -1.0);
    painter.text(beside, Align2::LEFT_BOTTOM, about, caption, skin.palette.muted.into());
    let body = FontId::proportional(skin.sizes.body);
    painter.text(text, Align2::LEFT_TOP, &shown, body, skin.palette.muted.into());
    if name(response, true, &format!("{}: {shown}", lamp.name())).clicked() {
        leds.click(lamp);
    }
}

/// How a lamp is drawn: its left and its right half, and whether it comes and goes.
struct Look {
    left: Option<Color32>,
    right: Option<Color32>,
    blinks: bool,
}

fn look(skin: &Skin, leds: &Leds, lamp: Lamp) -> Look {
    let palette = skin.palette;
    let (green, red, yellow) = (Some(palette.good.into()), Some(palette.bad.into()), Some(palette.staged.into()));
    let look = |left, right, blinks| Look { left, right, blinks };
    match lamp {
        Lamp::Drives => match leds.drives {
            DriveLight::Off => look(None, None, false),
            DriveLight::Green => look(green, green, false),
            DriveLight::Red => look(red, red, false),
            DriveLight::RedGreen => look(red, green, false),
            DriveLight::GreenFlashing => look(green, green, true),
            DriveLight::RedGreenFlashing | DriveLight::Alternating => look(red, green, true),
        },
        Lamp::Bus(own) => match if own == BusLamp::Module { leds.module } else { leds.network } {
            BusLight::Off => look(None, None, false),
            BusLight::Green => look(green, green, false),
            BusLight::GreenFlashing => look(green, green, true),
            BusLight::Red => look(red, red, false),
            BusLight::RedFlashing => look(red, red, true),
            BusLight::Alternating => look(red, green, true),
        },
        Lamp::Port => match leds.port {
            PortLight::Off => look(None, None, false),
            PortLight::Link => look(green, None, false),
            PortLight::Active => look(green, yellow, true),
        },
    }
}

/// A disc of two halves; what comes and goes has rays.
fn paint(painter: &Painter, skin: &Skin, middle: Pos2, look: Look) {
    let half = |from: f32, colour: Color32| {
        let points = (0..=16_u8).map(|step| {
            let angle = from + std::f32::consts::PI * f32::from(step) / 16.0;
            middle + vec2(angle.cos(), angle.sin()) * RADIUS
        });
        Shape::convex_polygon(points.collect(), colour, Stroke::NONE)
    };
    let quarter = std::f32::consts::FRAC_PI_2;
    for (from, colour) in [(quarter, look.left), (-quarter, look.right)] {
        if let Some(colour) = colour {
            painter.add(half(from, colour));
        }
    }
    painter.circle_stroke(middle, RADIUS, Stroke::new(1.0, skin.palette.muted));
    if look.blinks {
        for ray in 0..8_u8 {
            let angle = f32::from(ray) * std::f32::consts::TAU / 8.0;
            let along = vec2(angle.cos(), angle.sin());
            let ends = [middle + along * (RADIUS + 3.0), middle + along * (RADIUS + 6.0)];
            painter.line_segment(ends, Stroke::new(1.5, skin.palette.muted));
        }
    }
}
