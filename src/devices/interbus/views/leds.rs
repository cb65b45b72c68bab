//! What the LEDs on the encoder mean, and the identification codes of its interfaces.

use egui::{RichText, Ui};

use crate::app::Action;
use crate::devices::interbus::protocol::{Class, Interface, LedState, Leds, id_code};
use crate::devices::interbus::state::{TEXTS, format};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{folding_card, name, paragraph, row, two_columns};
use crate::ui::{Theme, icons};

pub(super) struct LedsUiState {
    leds: Leds,
}

impl Default for LedsUiState {
    fn default() -> Self {
        LedsUiState { leds: Leds { ul: LedState::On, ba: LedState::On, rc: LedState::On, rbda: LedState::On } }
    }
}

const LED_WIDTH: f32 = 92.0;

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, view: &mut LedsUiState) {
    let none: Vec<Action> = Vec::new();
    two_columns(
        ui,
        theme,
        (view, none),
        |ui, (view, _)| output_indicators_ui(ui, theme, view),
        |ui, _| codes_ui(ui, theme),
    );
}

fn output_indicators_ui(ui: &mut Ui, theme: &Theme, view: &mut LedsUiState) {
    folding_card(ui, theme, TEXTS.text("ib_leds.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_leds.words")));
        ui.horizontal_wrapped(|ui| {
            let LedsUiState { leds } = view;
            for (word, lamp, blinks) in [
                ("UL", &mut leds.ul, false),
                ("RC", &mut leds.rc, false),
                ("BA", &mut leds.ba, true),
                ("RBDA", &mut leds.rbda, false),
            ] {
                led_ui(ui, theme, word, lamp, blinks);
            }
        });
        ui.add_space(theme.space.inside);
        let Some(own) = view.leds.row() else {
            paragraph(ui, RichText::new(translate(theme, "ib_leds.unknown")).color(theme.palette.warn));
            return;
        };
        let (meaning, remedy) = format::led_labels(own);
        paragraph(ui, theme.value(theme.format_text(&meaning)));
        paragraph(ui, theme.format_text(&remedy));
    });
}

/// Draws an LED that can be clicked. Each click selects its next state: off, on or, if `blinks` is set, blinking.
fn led_ui(ui: &mut Ui, theme: &Theme, word: &str, lamp: &mut LedState, blinks: bool) {
    let palette = theme.palette;
    let (id, ink) = match lamp {
        LedState::Off => ("ib_leds.off", palette.muted),
        LedState::On => ("ib_leds.on", palette.good),
        LedState::Blinking => ("ib_leds.blinking", palette.warn),
    };
    let state = translate(theme, id);
    let icon = RichText::new(if *lamp == LedState::Off { icons::STOP } else { icons::LIGHTNING }).color(ink);
    let button =
        egui::Button::new((icon, RichText::new(format!("{word}  {state}")))).min_size([LED_WIDTH, 28.0].into());
    if name(ui.add(button), true, &format!("{word}: {state}")).clicked() {
        *lamp = match lamp {
            LedState::Off => LedState::On,
            LedState::On if blinks => LedState::Blinking,
            LedState::On | LedState::Blinking => LedState::Off,
        };
    }
}

fn codes_ui(ui: &mut Ui, theme: &Theme) {
    folding_card(ui, theme, TEXTS.text("ib_id.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_id.words")));
        for class in Class::ALL {
            let codes: Vec<String> = Interface::ALL
                .into_iter()
                .map(|interface| {
                    let code = id_code(class, interface);
                    format!("{} 0x{code:02X} ({code})", theme.format_text(&format::interface(interface)))
                })
                .collect();
            let (bytes_in, bytes_out) = class.bytes();
            let bytes = TEXTS.text("ib_id.bytes").with("in", bytes_in).with("out", bytes_out);
            row(ui, theme, &format!("{class:?}"), codes.join(" · "));
            paragraph(ui, theme.caption(theme.format_text(&bytes)));
        }
    });
}
