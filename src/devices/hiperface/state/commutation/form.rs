//! The form of the commutation assistant and the interpretation of its entries.

use crate::analysis::arctan::Phase;
use crate::analysis::commutation::Motor;
use crate::app::Text;
use crate::app::number::{MOST_PERIODS, whole, within};
use crate::devices::hiperface::protocol::Geometry;
use crate::devices::hiperface::state::TEXTS;

/// Entries of the assistant. If the number of periods is empty, that of the encoder type is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Whether the user has confirmed that the controller is disabled.
    pub disabled: bool,
    /// Whether the user has confirmed that the motor is uncoupled and without load.
    pub uncoupled: bool,
    /// Whether the user has confirmed that the brake is released.
    pub released: bool,
    /// Current limit in amperes, as typed.
    pub current_a: String,
    /// Maximum time with current in seconds, as typed.
    pub time_s: String,
    pub vector: Vector,
    /// Typed angle of a custom vector in electrical degrees.
    pub vector_deg: String,
    /// Pole pairs of the motor, as typed.
    pub pole_pairs: String,
    /// Signal periods per revolution, as typed.
    pub periods: String,
    /// Whether the position decreases as the electrical angle increases.
    pub reversed: bool,
    pub source: Source,
    /// Typed position in periods, if measured externally.
    pub phase: String,
    /// Permitted difference between both approach directions in electrical degrees, as typed.
    pub limit_deg: String,
    /// Lead of the second vector in electrical degrees, as typed.
    pub second_deg: String,
    /// Whether the user has decided to use the offset without verifying it with a second vector.
    pub without_second: bool,
    /// Fine positions in periods, as typed, in the order of [`Slot::ALL`].
    pub typed: [String; 3],
    pub storage: Storage,
    /// Data field for the offset, or `None` for the proposed field.
    pub field: Option<u8>,
    /// Index of the first byte, as typed; empty for the proposed index.
    pub address: String,
    /// Period of the position for method 2, as typed.
    pub period: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    OneSide,
    /// Position at rest, approached from the other side.
    OtherSide,
    /// Position at rest in the second vector.
    Second,
}

/// Vector energised while the position is read, named by its wiring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vector {
    /// Current into U, returning through V and W: 0°.
    UAgainstBoth,
    /// Current into U, returning through V: −30°.
    UAgainstV,
    /// Current into U, returning through W: 30°.
    UAgainstW,
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Analogue channels of the encoder if available, otherwise the absolute position.
    Signals,
    Typed,
    /// Absolute position alone, with a resolution of 1/32 period.
    Absolute,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Commutation record of sixteen bytes.
    Record,
    /// Plain number of four bytes, most significant byte first.
    Number,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetInputs {
    pub motor: Motor,
    pub periods: u32,
    pub pole_pairs: u32,
    /// Whether the position decreases as the electrical angle increases.
    pub reversed: bool,
    pub vector_turns: f64,
    /// Permitted difference between both approach directions, in electrical degrees.
    pub limit_deg: f64,
}

/// Limit for the number of pole pairs, greater than that of any motor.
const MOST_POLE_PAIRS: u32 = 500;

impl Slot {
    pub const ALL: [Slot; 3] = [Slot::OneSide, Slot::OtherSide, Slot::Second];
}

impl Default for Form {
    fn default() -> Self {
        Form {
            disabled: false,
            uncoupled: false,
            released: false,
            current_a: String::new(),
            time_s: String::new(),
            vector: Vector::UAgainstBoth,
            vector_deg: String::new(),
            pole_pairs: String::new(),
            periods: String::new(),
            reversed: false,
            source: Source::Signals,
            phase: String::new(),
            limit_deg: "5".to_owned(),
            second_deg: "90".to_owned(),
            without_second: false,
            typed: Default::default(),
            storage: Storage::Record,
            field: None,
            address: String::new(),
            period: "0".to_owned(),
        }
    }
}

impl Form {
    /// Returns the current in amperes and the time in seconds.
    ///
    /// # Errors
    /// States what is missing.
    pub fn limits(&self) -> Result<(f64, f64), Text> {
        let (current, time) = self.each_limit();
        Ok((current?, time?))
    }

    /// Returns the problems with the entered current and time; an empty entry is not yet a problem.
    pub fn limit_problems(&self) -> (Option<Text>, Option<Text>) {
        let typed = |text: &str| !text.trim().is_empty();
        let (current, time) = self.each_limit();
        (current.err().filter(|_| typed(&self.current_a)), time.err().filter(|_| typed(&self.time_s)))
    }

    fn each_limit(&self) -> (Result<f64, Text>, Result<f64, Text>) {
        let current = within(TEXTS.text("commutation.current"), &self.current_a, 0.001, 1000.0);
        (current, within(TEXTS.text("commutation.time"), &self.time_s, 0.1, 600.0))
    }

    /// Checks that everything required before energising the motor has been confirmed and recorded.
    ///
    /// # Errors
    /// States what is missing.
    pub fn prepared(&self) -> Result<(), Text> {
        let ticks = [
            (self.disabled, "commutation.disabled"),
            (self.uncoupled, "commutation.uncoupled"),
            (self.released, "commutation.released"),
        ];
        let open: Vec<Text> = ticks.into_iter().filter(|(ticked, _)| !ticked).map(|(_, id)| TEXTS.text(id)).collect();
        if !open.is_empty() {
            return Err(TEXTS.text("commutation.unprepared").with_list("what", open));
        }
        self.limits()?;
        self.vector_deg().map(|_| ())
    }

    /// Returns the angle of the energised vector in electrical degrees.
    ///
    /// # Errors
    /// States why the entry is invalid.
    pub fn vector_deg(&self) -> Result<f64, Text> {
        match self.vector {
            Vector::UAgainstBoth => Ok(0.0),
            Vector::UAgainstV => Ok(-30.0),
            Vector::UAgainstW => Ok(30.0),
            Vector::Other => within(TEXTS.text("commutation.vector_angle"), &self.vector_deg, -360.0, 360.0),
        }
    }

    /// Returns the lead of the second vector in electrical turns. The lead must be below ½, since otherwise the shaft
    /// may turn the other way.
    ///
    /// # Errors
    /// States why the entry is invalid.
    pub fn second_vector_turns(&self) -> Result<f64, Text> {
        Ok(within(TEXTS.text("commutation.second_angle"), &self.second_deg, 1.0, 170.0)? / 360.0)
    }

    /// Returns the entered position within a period.
    ///
    /// # Errors
    /// States why the entry is invalid.
    pub fn phase(&self) -> Result<Phase, Text> {
        phase(&self.phase)
    }

    /// Returns the entered fine position of a slot in periods.
    ///
    /// # Errors
    /// States why the entry is invalid.
    pub fn fine(&self, slot: Slot) -> Result<f64, Text> {
        let [one, other, second] = &self.typed;
        let text = match slot {
            Slot::OneSide => one,
            Slot::OtherSide => other,
            Slot::Second => second,
        };
        within(TEXTS.text("commutation.fine"), text, 0.0, f64::from(1_u32 << 27))
    }

    /// Returns the signal periods per revolution as entered, or otherwise those of the encoder type.
    ///
    /// # Errors
    /// States why the entry is invalid.
    pub fn periods(&self, geometry: Option<Geometry>) -> Result<u32, Text> {
        match (self.periods.trim().is_empty(), geometry) {
            (_, Some(Geometry::Linear { .. })) => Err(TEXTS.text("commutation.linear")),
            (true, Some(Geometry::Rotary { periods, .. })) => Ok(periods.max(1)),
            _ => whole(TEXTS.text("commutation.periods"), &self.periods, 1, MOST_PERIODS),
        }
    }

    /// Returns a warning if the entered number of periods differs from that of the encoder type.
    pub fn periods_mismatch(&self, geometry: Option<Geometry>) -> Option<Text> {
        let Some(Geometry::Rotary { periods: own, .. }) = geometry else { return None };
        let typed = self.periods(geometry).ok().filter(|typed| *typed != own.max(1))?;
        Some(TEXTS.text("commutation.other_periods").with("own", own).with("typed", typed))
    }

    /// Returns all numbers required for the offset.
    ///
    /// # Errors
    /// Explains why the first invalid entry is invalid.
    pub fn inputs(&self, geometry: Option<Geometry>) -> Result<OffsetInputs, Text> {
        let pole_pairs = whole(TEXTS.text("commutation.pole_pairs"), &self.pole_pairs, 1, MOST_POLE_PAIRS)?;
        let periods = self.periods(geometry)?;
        Ok(OffsetInputs {
            motor: Motor::new(periods, pole_pairs).ok_or_else(|| missing("commutation.pole_pairs"))?,
            periods,
            pole_pairs,
            reversed: self.reversed,
            vector_turns: self.vector_deg()? / 360.0,
            limit_deg: within(TEXTS.text("commutation.limit"), &self.limit_deg, 0.1, 90.0)?,
        })
    }
}

fn missing(what: &'static str) -> Text {
    Text::new("entry.missing").with_text("what", TEXTS.text(what))
}

pub(super) fn phase(text: &str) -> Result<Phase, Text> {
    let periods = within(TEXTS.text("commutation.phase"), text, 0.0, 0.999_999_999)?;
    Phase::from_periods(periods).ok_or_else(|| missing("commutation.phase"))
}
