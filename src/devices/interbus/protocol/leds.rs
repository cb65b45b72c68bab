//! Meaning of the four encoder LEDs (reference 1).

/// State of an LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LedState {
    /// Off.
    Off,
    /// On.
    On,
    /// Blinking.
    Blinking,
}

/// States of the four LEDs, named by their labels on the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Leds {
    /// LED labelled UL.
    pub ul: LedState,
    /// LED labelled BA.
    pub ba: LedState,
    /// LED labelled RC.
    pub rc: LedState,
    /// LED labelled RBDA.
    pub rbda: LedState,
}

/// Meaning and remedy of an LED combination.
#[derive(Clone, Copy, Debug)]
pub struct LedRow {
    /// Combination of LED states.
    pub leds: Leds,
    /// Meaning in the words of the manual.
    pub meaning: &'static str,
    /// Suggested remedy. The manual does not give one (`U`).
    pub remedy: &'static str,
}

use LedState::{Blinking, Off, On};

const fn led_states(ul: LedState, ba: LedState, rc: LedState, rbda: LedState) -> Leds {
    Leds { ul, ba, rc, rbda }
}

/// The LED combinations in the order of the manual.
pub const LEDS: [LedRow; 4] = [
    LedRow {
        leds: led_states(On, Off, On, Off),
        meaning: "no run",
        remedy: "start the bus master: the encoder has its supply and the incoming cable, and no data come",
    },
    LedRow {
        leds: led_states(On, Blinking, On, Off),
        meaning: "configured",
        remedy: "let the bus master run: it knows the encoder and exchanges no data with it yet",
    },
    LedRow { leds: led_states(On, On, On, On), meaning: "run", remedy: "nothing: data are exchanged" },
    LedRow {
        leds: led_states(On, Off, Off, On),
        meaning: "bus error",
        remedy: "check the bus cables and plugs before and behind the encoder, then ask the master's diagnosis",
    },
];

impl Leds {
    /// Returns the table row for this LED combination, or `None` if the manual does not define it.
    pub fn row(self) -> Option<&'static LedRow> {
        LEDS.iter().find(|row| row.leds == self)
    }
}
