//! The commutation assistant, which determines the offset between encoder and motor. A static vector is energised, and
//! the motor's rest position is read. Both methods of the manual are supported. The assistant does not energise the
//! motor or write to the encoder. Its result is an edit of the memory or a position to set, and both are reviewed
//! before they are written. See SICK 8010701, commutation, and section 5 of the project's sine/cosine reference.

mod act;
mod form;
mod offset_location;
mod outcome;
mod report;

use crate::analysis::arctan::{Phase, from_voltages};
use crate::analysis::quality::{Limits, Verdict};
use crate::analysis::synchronise::Synchroniser;
use crate::app::Text;
use crate::devices::hiperface::procedures::RestPosition;
use crate::devices::hiperface::protocol::{Geometry, STEPS_PER_PERIOD};
use crate::devices::hiperface::state::TEXTS;

pub use form::{EnergisedVector, Form, OffsetInputs, Source, Storage, VectorSlot};
pub use offset_location::OffsetLocation;
pub use outcome::{CommutationOffset, PositionSetting, StoredRecord, reading_permission, stored};
pub use report::reading_kind_text;

pub enum CommutationAction {
    Edit(Box<Form>),
    Read(VectorSlot),
    Use(VectorSlot),
    Clear,
    /// Enters the offset in the memory as an edit (method 1 of the manual).
    Store,
    /// Plans to set the position, and starts the review (method 2 of the manual).
    Set,
}

#[derive(Debug, Default)]
pub struct Commutation {
    pub form: Form,
    /// Reason why the last action was not executed.
    pub problem: Option<Text>,
    readings: [Option<RestReading>; 3],
    /// The last reading, after which the shaft is assumed not to have moved.
    last: Option<VectorSlot>,
    asked: Option<PendingReading>,
}

/// A reading in progress, with the source and phase at the time of the request, because the user may edit the form in
/// the meantime.
#[derive(Debug)]
struct PendingReading {
    slot: VectorSlot,
    source: Source,
    /// Phase as entered by the user.
    phase: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestReading {
    /// Position in signal periods within the encoder's whole range.
    pub fine_periods: f64,
    pub kind: PositionKind,
    /// Position word of the encoder, or `None` if the user typed the position.
    pub raw: Option<u32>,
}

/// Source and accuracy of a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionKind {
    Fine {
        residual_periods: f64,
        verdict: Verdict,
        /// Resolution in signal periods, or `None` if the user typed the phase.
        resolution_periods: Option<f64>,
    },
    /// Absolute position without the analogue signals. The shaft is assumed to be at the middle of the step.
    Absolute,
    Typed,
}

impl Commutation {
    pub fn reading_at(&self, slot: VectorSlot) -> Option<&RestReading> {
        let [one, other, second] = &self.readings;
        match slot {
            VectorSlot::OneSide => one,
            VectorSlot::OtherSide => other,
            VectorSlot::Second => second,
        }
        .as_ref()
    }

    pub fn pending_slot(&self) -> Option<VectorSlot> {
        self.asked.as_ref().map(|asked| asked.slot)
    }

    fn request_reading(&mut self, slot: VectorSlot) {
        self.asked = Some(PendingReading { slot, source: self.form.source, phase: self.form.phase.clone() });
    }

    fn store_reading(&mut self, slot: VectorSlot, reading: RestReading) {
        let [one, other, second] = &mut self.readings;
        let place = match slot {
            VectorSlot::OneSide => one,
            VectorSlot::OtherSide => other,
            VectorSlot::Second => second,
        };
        *place = Some(reading);
        self.last = Some(slot);
        self.problem = None;
    }

    /// Discards the readings, for example because the zero position has changed.
    pub(super) fn forget_readings(&mut self) {
        (self.readings, self.last, self.problem) = ([None; 3], None, None);
    }

    /// Stores the position of a reading that the assistant has requested. Other readings are ignored.
    pub(super) fn accept_position(&mut self, rest: RestPosition, geometry: Option<Geometry>) {
        let Some(asked) = self.asked.take() else { return };
        match asked.to_reading(rest, geometry) {
            Ok(reading) => self.store_reading(asked.slot, reading),
            Err(why) => self.problem = Some(why),
        }
    }

    /// Handles a failed job, and returns whether it was a reading that the assistant has requested. If so, its error is
    /// displayed.
    pub(super) fn handle_failure(&mut self, why: &Text) -> bool {
        let own = self.asked.take().is_some();
        if own {
            self.problem = Some(why.clone());
        }
        own
    }

    pub(super) fn cancel_request(&mut self) {
        self.asked = None;
    }

    fn apply_typed_value(&mut self, slot: VectorSlot) {
        match self.form.fine_position(slot) {
            Ok(fine_periods) => {
                self.store_reading(slot, RestReading { fine_periods, kind: PositionKind::Typed, raw: None })
            }
            Err(why) => self.problem = Some(why),
        }
    }
}

impl PendingReading {
    fn to_reading(&self, rest: RestPosition, geometry: Option<Geometry>) -> Result<RestReading, Text> {
        if !rest.valid {
            return Err(Text::new("commutation.invalid"));
        }
        let absolute = RestReading {
            fine_periods: (f64::from(rest.raw) + 0.5) / f64::from(STEPS_PER_PERIOD),
            kind: PositionKind::Absolute,
            raw: Some(rest.raw),
        };
        match (self.source, rest.signals) {
            (Source::Absolute, _) | (Source::Signals, None) => Ok(absolute),
            (Source::Typed, _) => combine_with_phase(rest.raw, form::phase(&self.phase)?, geometry, None),
            (Source::Signals, Some(signals)) => {
                let volts = signals.sine_v.hypot(signals.cosine_v);
                let no_signal = || TEXTS.text("commutation.no_signal").with_number("volts", 2.0 * volts, 3);
                if Limits::HIPERFACE.amplitude_verdict(volts) == Verdict::Fault {
                    return Err(no_signal());
                }
                let phase = from_voltages(signals.sine_v, signals.cosine_v).ok_or_else(no_signal)?;
                combine_with_phase(rest.raw, phase, geometry, Some(signals.resolution_periods()))
            }
        }
    }
}

/// Combines the absolute position and the phase. If they differ by more than 14/32 of a period, returns an error.
fn combine_with_phase(
    raw: u32,
    phase: Phase,
    geometry: Option<Geometry>,
    resolution: Option<f64>,
) -> Result<RestReading, Text> {
    let steps = u64::from(STEPS_PER_PERIOD);
    // If the range is unknown, the position is assumed never to wrap.
    let periods = geometry.and_then(Geometry::position_count).map_or(1 << 32, |range| range / steps);
    let synchroniser = Synchroniser { half_step: true, ..Synchroniser::new(periods) };
    let synchronised = synchroniser.combine(raw.into(), phase).map_err(|_| TEXTS.text("commutation.half_apart"))?;
    if synchronised.verdict == Verdict::Fault {
        let apart = synchronised.residual_periods.abs() * f64::from(STEPS_PER_PERIOD);
        return Err(TEXTS.text("commutation.far_apart").with_number("steps", apart, 1));
    }
    let kind = PositionKind::Fine {
        residual_periods: synchronised.residual_periods,
        verdict: synchronised.verdict,
        resolution_periods: resolution,
    };
    Ok(RestReading { fine_periods: synchronised.periods(), kind, raw: Some(raw) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperface::procedures::Signals;

    const SKM36: Option<Geometry> = Some(Geometry::Rotary { periods: 128, turns: 4096 });

    fn rest(raw: u32, volts: Option<(f64, f64)>) -> RestPosition {
        RestPosition { raw, valid: true, signals: volts.map(|(sine_v, cosine_v)| Signals { sine_v, cosine_v }) }
    }

    fn read(source: Source, phase: &str, rest: RestPosition) -> Result<RestReading, &'static str> {
        let asked = PendingReading { slot: VectorSlot::OneSide, source, phase: phase.to_owned() };
        asked.to_reading(rest, SKM36).map_err(|text| text.id())
    }

    #[test]
    fn reading_keeps_requested_source() {
        let form = Form { source: Source::Typed, phase: "0.27".to_owned(), ..Form::default() };
        let mut commutation = Commutation { form, ..Commutation::default() };
        commutation.request_reading(VectorSlot::OneSide);
        commutation.form = Form { source: Source::Absolute, phase: String::new(), ..Form::default() };
        commutation.accept_position(rest(40, None), SKM36);
        let reading = commutation.reading_at(VectorSlot::OneSide).unwrap();
        assert!((reading.fine_periods - 1.27).abs() < 1e-12, "{reading:?}");
    }

    #[test]
    fn signals_refine_reading() {
        let without = read(Source::Signals, "", rest(40, None)).unwrap();
        assert_eq!((without.fine_periods, without.kind, without.raw), (40.5 / 32.0, PositionKind::Absolute, Some(40)));
        let with = read(Source::Signals, "", rest(40, Some((0.5, 0.0)))).unwrap();
        assert_eq!(with.fine_periods, 1.25);
        assert_eq!(read(Source::Absolute, "", rest(40, Some((0.5, 0.0)))).unwrap().kind, PositionKind::Absolute);
        let typed = read(Source::Typed, "0,27", rest(40, None)).unwrap();
        assert!((typed.fine_periods - 1.27).abs() < 1e-12);
        // SKM36 at the last step of the range, with a phase beyond the end of the range.
        let around = read(Source::Typed, "0.01", rest(0x00FF_FFFF, None)).unwrap();
        assert!((around.fine_periods - 0.01).abs() < 1e-12, "{around:?}");
    }

    #[test]
    fn rejects_invalid_positions() {
        assert_eq!(
            read(Source::Absolute, "", RestPosition { valid: false, ..rest(40, None) }),
            Err("commutation.invalid")
        );
        for volts in [(0.0, 0.0), (0.1, 0.1), (0.7, 0.7), (f64::NAN, 0.5)] {
            assert_eq!(read(Source::Signals, "", rest(40, Some(volts))), Err("commutation.no_signal"), "{volts:?}");
        }
        assert_eq!(read(Source::Typed, "", rest(40, None)), Err("entry.missing"));
        assert_eq!(read(Source::Typed, "0.765625", rest(40, None)), Err("commutation.half_apart"), "8.5 + 16 steps");
        assert_eq!(read(Source::Typed, "0.75", rest(40, None)), Err("commutation.far_apart"), "15.5 steps");
    }
}
