//! LED page: draws the LEDs as they appear on the device. Clicking an LED selects its next state, until it matches the
//! real one.

use egui::{Align2, Color32, FontId, Painter, Pos2, RichText, Shape, Stroke, Ui, pos2, vec2};

use crate::devices::hiperdrive::protocol::{DriveLedState, NetworkLed, NetworkLedState, PortLedState};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::leds::{Led, Leds};
use crate::devices::hiperdrive::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{entry, folding_card, name, options, paragraph, severity};

#[derive(Default)]
pub(super) struct LedsUiState(Leds);

const BUTTON_SIZE: egui::Vec2 = vec2(248.0, 44.0);
const LED_RADIUS: f32 = 9.0;

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, LedsUiState(leds): &mut LedsUiState) {
    folding_card(ui, theme, TEXTS.text("hd_led.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "hd_led.words")));
        device_ui(ui, theme, leds);
        ui.add_space(theme.space.between);
        for lamp in Led::ALL {
            row_ui(ui, theme, leds, lamp);
        }
    });
}

fn device_ui(ui: &mut Ui, theme: &Theme, leds: &mut Leds) {
    let (mut hub, mut s3) = (leds.hub, leds.s3);
    let word = translate(theme, "hd_led.device");
    entry(ui, theme, &word, |ui| {
        let kinds = [(false, "hd_led.adapter"), (true, "hd_led.hub")];
        options(ui, &word, &mut hub, kinds.map(|(own, id)| (own, translate(theme, id))))
    });
    if hub {
        let word = translate(theme, "hd_led.switch");
        let positions = (0..=8_u8).map(|own| match own {
            0 => (own, translate(theme, "hd_led.switch_zero")),
            drive => (own, drive.to_string()),
        });
        entry(ui, theme, &word, |ui| options(ui, &word, &mut s3, positions));
        if s3 != 0 {
            let away = TEXTS.text("hd_led.switch_away").with("drive", s3);
            paragraph(ui, RichText::new(theme.format_text(&away)).color(theme.palette.warn));
        }
    }
    if (hub, s3) != (leds.hub, leds.s3) {
        leds.set_device(hub, s3);
    }
}

fn row_ui(ui: &mut Ui, theme: &Theme, leds: &mut Leds, lamp: Led) {
    ui.horizontal_top(|ui| {
        led_ui(ui, theme, leds, lamp);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = theme.space.inside;
            let meaning = leds.led_meaning(lamp);
            let (icon, ink) = severity(theme, meaning.severity);
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icon).color(ink));
                paragraph(
                    ui,
                    RichText::new(theme.format_text(&meaning.meaning)).font(theme.bold_font(theme.sizes.body)),
                );
            });
            paragraph(ui, theme.label(theme.format_text(&meaning.remedy)));
        });
    });
    ui.add_space(theme.space.inside);
}

/// Draws an LED. A click selects its next possible state.
fn led_ui(ui: &mut Ui, theme: &Theme, leds: &mut Leds, lamp: Led) {
    let shown = theme.format_text(&leds.state_text(lamp));
    let response = ui.add(egui::Button::new("").min_size(BUTTON_SIZE));
    let (rect, painter) = (response.rect, ui.painter());
    let middle = pos2(rect.left() + 24.0, rect.center().y);
    paint_led(painter, theme, middle, led_style(theme, leds, lamp));
    let text = pos2(rect.left() + 48.0, rect.center().y);
    let about = match lamp {
        Led::Drives if leds.hub && leds.s3 != 0 => {
            theme.format_text(&TEXTS.text("hd_led.switch_drive").with("drive", leds.s3))
        }
        Led::Drives => translate(theme, "hd_led.what_drives"),
        Led::Bus(NetworkLed::Module) => translate(theme, "hd_led.what_module"),
        Led::Bus(NetworkLed::Network) => translate(theme, "hd_led.what_network"),
        Led::Port => translate(theme, "hd_led.what_port"),
    };
    let strong = theme.bold_font(theme.sizes.body);
    let named = painter.text(text, Align2::LEFT_BOTTOM, lamp.name(), strong, theme.palette.text.into());
    let caption = FontId::proportional(theme.sizes.caption);
    let beside = named.right_bottom() + vec2(theme.space.between, -1.0);
    painter.text(beside, Align2::LEFT_BOTTOM, about, caption, theme.palette.muted.into());
    let body = FontId::proportional(theme.sizes.body);
    painter.text(text, Align2::LEFT_TOP, &shown, body, theme.palette.muted.into());
    if name(response, true, &format!("{}: {shown}", lamp.name())).clicked() {
        leds.toggle(lamp);
    }
}

/// Appearance of an LED: colours of the left and right halves, and whether it blinks.
struct LedStyle {
    left: Option<Color32>,
    right: Option<Color32>,
    blinks: bool,
}

fn led_style(theme: &Theme, leds: &Leds, lamp: Led) -> LedStyle {
    let palette = theme.palette;
    let (green, red, yellow) = (Some(palette.good.into()), Some(palette.bad.into()), Some(palette.staged.into()));
    let look = |left, right, blinks| LedStyle { left, right, blinks };
    match lamp {
        Led::Drives => match leds.drives {
            DriveLedState::Off => look(None, None, false),
            DriveLedState::Green => look(green, green, false),
            DriveLedState::Red => look(red, red, false),
            DriveLedState::RedGreen => look(red, green, false),
            DriveLedState::GreenFlashing => look(green, green, true),
            DriveLedState::RedGreenFlashing | DriveLedState::Alternating => look(red, green, true),
        },
        Led::Bus(own) => match if own == NetworkLed::Module { leds.module } else { leds.network } {
            NetworkLedState::Off => look(None, None, false),
            NetworkLedState::Green => look(green, green, false),
            NetworkLedState::GreenFlashing => look(green, green, true),
            NetworkLedState::Red => look(red, red, false),
            NetworkLedState::RedFlashing => look(red, red, true),
            NetworkLedState::Alternating => look(red, green, true),
        },
        Led::Port => match leds.port {
            PortLedState::Off => look(None, None, false),
            PortLedState::Link => look(green, None, false),
            PortLedState::Active => look(green, yellow, true),
        },
    }
}

/// Draws an LED as a disc with two halves. Rays stand for blinking.
fn paint_led(painter: &Painter, theme: &Theme, middle: Pos2, look: LedStyle) {
    let half = |from: f32, colour: Color32| {
        let points = (0..=16_u8).map(|step| {
            let angle = from + std::f32::consts::PI * f32::from(step) / 16.0;
            middle + vec2(angle.cos(), angle.sin()) * LED_RADIUS
        });
        Shape::convex_polygon(points.collect(), colour, Stroke::NONE)
    };
    let quarter = std::f32::consts::FRAC_PI_2;
    for (from, colour) in [(quarter, look.left), (-quarter, look.right)] {
        if let Some(colour) = colour {
            painter.add(half(from, colour));
        }
    }
    painter.circle_stroke(middle, LED_RADIUS, Stroke::new(1.0, theme.palette.muted));
    if look.blinks {
        for ray in 0..8_u8 {
            let angle = f32::from(ray) * std::f32::consts::TAU / 8.0;
            let along = vec2(angle.cos(), angle.sin());
            let ends = [middle + along * (LED_RADIUS + 3.0), middle + along * (LED_RADIUS + 6.0)];
            painter.line_segment(ends, Stroke::new(1.5, theme.palette.muted));
        }
    }
}
