//! The meaning of the four LEDs of an encoder (reference 1).

/// The state of an LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LedState {
    /// Dark.
    Off,
    /// Lit.
    On,
    /// On and off.
    Blinking,
}

/// The LEDs by their names at the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Leds {
    /// UL.
    pub ul: LedState,
    /// BA.
    pub ba: LedState,
    /// RC.
    pub rc: LedState,
    /// RBDA.
    pub rbda: LedState,
}

/// The meaning of a combination of LEDs, and what to do.
#[derive(Clone, Copy, Debug)]
pub struct LedRow {
    /// The combination.
    pub leds: Leds,
    /// Meaning in the manual's words.
    pub meaning: &'static str,
    /// Remedy; not in the manual (`U`).
    pub remedy: &'static str,
}

use LedState::{Blinking, Off, On};

const fn leds(ul: LedState, ba: LedState, rc: LedState, rbda: LedState) -> Leds {
    Leds { ul, ba, rc, rbda }
}

/// The combinations of the manual, in its order.
pub const LEDS: [LedRow; 4] = [
    LedRow {
        leds: leds(On, Off, On, Off),
        meaning: "no run",
        remedy: "start the bus master: the encoder has its supply and the incoming cable, and no data come",
    },
    LedRow {
        leds: leds(On, Blinking, On, Off),
        meaning: "configured",
        remedy: "let the bus master run: it knows the encoder and exchanges no data with it yet",
    },
    LedRow { leds: leds(On, On, On, On), meaning: "run", remedy: "nothing: data are exchanged" },
    LedRow {
        leds: leds(On, Off, Off, On),
        meaning: "bus error",
        remedy: "check the bus cables and plugs before and behind the encoder, then ask the master's diagnosis",
    },
];

impl Leds {
    /// Returns the row of the table; `None` if it is not in the manual.
    pub fn row(self) -> Option<&'static LedRow> {
        LEDS.iter().find(|row| row.leds == self)
    }
}
