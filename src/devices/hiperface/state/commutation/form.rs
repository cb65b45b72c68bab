//! The input form of the commutation assistant, and the parsing of its entries.

use crate::analysis::arctan::Phase;
use crate::analysis::commutation::Motor;
use crate::app::Text;
use crate::app::number::{MAX_PERIODS, parse_in_range, parse_integer};
use crate::devices::hiperface::protocol::Geometry;
use crate::devices::hiperface::state::TEXTS;

/// Entries of the commutation assistant, as typed or selected. If the number of periods is empty, the number for the
/// encoder type is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Whether the user has confirmed that the controller is disabled.
    pub disabled: bool,
    /// Whether the user has confirmed that the motor is uncoupled and has no load.
    pub uncoupled: bool,
    /// Whether the user has confirmed that the brake is released.
    pub released: bool,
    /// Current limit in amperes, as entered.
    pub current_a: String,
    /// Maximum time in seconds for which the motor is energised, as entered.
    pub time_s: String,
    pub vector: EnergisedVector,
    /// Angle of a custom vector in electrical degrees, as entered.
    pub vector_deg: String,
    /// Pole pairs of the motor, as entered.
    pub pole_pairs: String,
    /// Signal periods per revolution, as entered.
    pub periods: String,
    /// Whether the position decreases as the electrical angle increases.
    pub reversed: bool,
    pub source: Source,
    /// Position within a period, as entered, for a phase that was measured with another device.
    pub phase: String,
    /// Permitted difference, in electrical degrees, between approaches from opposite sides, as entered.
    pub limit_deg: String,
    /// Angle from the first to the second vector in electrical degrees, as entered.
    pub second_deg: String,
    /// Whether the user accepts the offset without verification by a second vector.
    pub without_second: bool,
    /// Typed fine positions in periods, in the order of [`VectorSlot::ALL`].
    pub typed: [String; 3],
    pub storage: Storage,
    /// Data field for the offset, or `None` for the proposed field.
    pub field: Option<u8>,
    /// Index of the first byte, as entered, or empty for the proposed index.
    pub address: String,
    /// Signal period in which the position of method 2 lies, as entered.
    pub period: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VectorSlot {
    OneSide,
    /// Rest position after approaching it from the other side.
    OtherSide,
    /// Rest position at the second vector.
    Second,
}

/// Vector that is energised during a reading, named after its wiring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergisedVector {
    /// Current into U that returns through V and W, at 0°.
    UAgainstBoth,
    /// Current into U that returns through V, at −30°.
    UAgainstV,
    /// Current into U that returns through W, at 30°.
    UAgainstW,
    Other,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Analogue channels of the encoder, or its absolute position if it has no such channels.
    Signals,
    Typed,
    /// Absolute position only, with a resolution of 1/32 of a period.
    Absolute,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Commutation record of sixteen bytes.
    Record,
    /// Offset as a four-byte number, most significant byte first.
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
    /// Permitted difference, in electrical degrees, between approaches from opposite sides.
    pub limit_deg: f64,
}

/// Maximum accepted number of pole pairs. It is greater than that of any motor.
const MAX_POLE_PAIRS: u32 = 500;

impl VectorSlot {
    pub const ALL: [VectorSlot; 3] = [VectorSlot::OneSide, VectorSlot::OtherSide, VectorSlot::Second];
}

impl Default for Form {
    fn default() -> Self {
        Form {
            disabled: false,
            uncoupled: false,
            released: false,
            current_a: String::new(),
            time_s: String::new(),
            vector: EnergisedVector::UAgainstBoth,
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
    /// Returns the current limit in amperes and the time limit in seconds.
    ///
    /// # Errors
    /// Returns an error that names a missing or invalid entry.
    pub fn limits(&self) -> Result<(f64, f64), Text> {
        let (current, time) = self.current_and_time_limits();
        Ok((current?, time?))
    }

    /// Returns the errors in the entries for the current limit and the time limit. Empty entries are not reported.
    pub fn limit_problems(&self) -> (Option<Text>, Option<Text>) {
        let typed = |text: &str| !text.trim().is_empty();
        let (current, time) = self.current_and_time_limits();
        (current.err().filter(|_| typed(&self.current_a)), time.err().filter(|_| typed(&self.time_s)))
    }

    fn current_and_time_limits(&self) -> (Result<f64, Text>, Result<f64, Text>) {
        let current = parse_in_range(TEXTS.text("commutation.current"), &self.current_a, 0.001, 1000.0);
        (current, parse_in_range(TEXTS.text("commutation.time"), &self.time_s, 0.1, 600.0))
    }

    /// Checks that the user has confirmed all preparations and entered all limits. This is required before the motor is
    /// energised.
    ///
    /// # Errors
    /// Returns an error that names a missing or invalid entry.
    pub fn check_prepared(&self) -> Result<(), Text> {
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

    /// Returns the angle of the first vector in electrical degrees.
    ///
    /// # Errors
    /// Returns an error if the entry is invalid.
    pub fn vector_deg(&self) -> Result<f64, Text> {
        match self.vector {
            EnergisedVector::UAgainstBoth => Ok(0.0),
            EnergisedVector::UAgainstV => Ok(-30.0),
            EnergisedVector::UAgainstW => Ok(30.0),
            EnergisedVector::Other => {
                parse_in_range(TEXTS.text("commutation.vector_angle"), &self.vector_deg, -360.0, 360.0)
            }
        }
    }

    /// Returns the angle from the first to the second vector in electrical turns, which is always below ½. At ½ or
    /// more, the shaft could turn in the opposite direction.
    ///
    /// # Errors
    /// Returns an error if the entry is invalid.
    pub fn second_vector_turns(&self) -> Result<f64, Text> {
        Ok(parse_in_range(TEXTS.text("commutation.second_angle"), &self.second_deg, 1.0, 170.0)? / 360.0)
    }

    /// Returns the entered position within a period.
    ///
    /// # Errors
    /// Returns an error if the entry is invalid.
    pub fn phase(&self) -> Result<Phase, Text> {
        phase(&self.phase)
    }

    /// Returns the entered position of a slot in signal periods.
    ///
    /// # Errors
    /// Returns an error if the entry is invalid.
    pub fn fine_position(&self, slot: VectorSlot) -> Result<f64, Text> {
        let [one, other, second] = &self.typed;
        let text = match slot {
            VectorSlot::OneSide => one,
            VectorSlot::OtherSide => other,
            VectorSlot::Second => second,
        };
        parse_in_range(TEXTS.text("commutation.fine"), text, 0.0, f64::from(1_u32 << 27))
    }

    /// Returns the entered number of signal periods per revolution, or the number for the encoder type if the entry is
    /// empty.
    ///
    /// # Errors
    /// Returns an error if the entry is invalid.
    pub fn signal_periods(&self, geometry: Option<Geometry>) -> Result<u32, Text> {
        match (self.periods.trim().is_empty(), geometry) {
            (_, Some(Geometry::Linear { .. })) => Err(TEXTS.text("commutation.linear")),
            (true, Some(Geometry::Rotary { periods, .. })) => Ok(periods.max(1)),
            _ => parse_integer(TEXTS.text("commutation.periods"), &self.periods, 1, MAX_PERIODS),
        }
    }

    /// Returns a warning if the entered number of periods differs from that of the encoder type.
    pub fn periods_warning(&self, geometry: Option<Geometry>) -> Option<Text> {
        let Some(Geometry::Rotary { periods: own, .. }) = geometry else { return None };
        let typed = self.signal_periods(geometry).ok().filter(|typed| *typed != own.max(1))?;
        Some(TEXTS.text("commutation.other_periods").with("own", own).with("typed", typed))
    }

    /// Returns the input values for calculating the offset.
    ///
    /// # Errors
    /// Returns an error with the reason if an entry is invalid. Only the first invalid entry is reported.
    pub fn inputs(&self, geometry: Option<Geometry>) -> Result<OffsetInputs, Text> {
        let pole_pairs = parse_integer(TEXTS.text("commutation.pole_pairs"), &self.pole_pairs, 1, MAX_POLE_PAIRS)?;
        let periods = self.signal_periods(geometry)?;
        Ok(OffsetInputs {
            motor: Motor::new(periods, pole_pairs).ok_or_else(|| missing_entry_text("commutation.pole_pairs"))?,
            periods,
            pole_pairs,
            reversed: self.reversed,
            vector_turns: self.vector_deg()? / 360.0,
            limit_deg: parse_in_range(TEXTS.text("commutation.limit"), &self.limit_deg, 0.1, 90.0)?,
        })
    }
}

fn missing_entry_text(what: &'static str) -> Text {
    Text::new("entry.missing").with_text("what", TEXTS.text(what))
}

pub(super) fn phase(text: &str) -> Result<Phase, Text> {
    let periods = parse_in_range(TEXTS.text("commutation.phase"), text, 0.0, 0.999_999_999)?;
    Phase::from_periods(periods).ok_or_else(|| missing_entry_text("commutation.phase"))
}
