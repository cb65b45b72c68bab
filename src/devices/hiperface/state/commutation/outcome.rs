//! Results of the commutation readings: the mean of both approaches, the offset and its check by a second vector, the
//! bytes for method 1, and the position for method 2.

use super::{Commutation, OffsetInputs, OffsetLocation, PositionKind, RestReading, Source, Storage, VectorSlot};
use crate::analysis::arctan::Phase;
use crate::analysis::commutation::{ElectricalAngle, preset_position};
use crate::analysis::quality::Verdict;
use crate::app::Text;
use crate::app::number::parse_integer;
use crate::devices::hiperface::profile::{CommutationRecord, CommutationRecordError};
use crate::devices::hiperface::protocol::{Geometry, STEPS_PER_PERIOD};
use crate::devices::hiperface::state::{ActionPermission, StagedEdits, TEXTS};

/// Electrical degrees per signal period at or above which method 2 is rejected, because the torque may have the wrong
/// sign. The limit is not documented (`U`).
const UNUSABLE_DEG: f64 = 90.0;
/// Electrical degrees per signal period at or above which the user is warned, because the torque is reduced to cos 30°
/// or less. The limit is not documented (`U`).
const WEAK_TORQUE_DEG: f64 = 30.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommutationOffset {
    /// Rest position of the shaft in signal periods, within a revolution.
    pub fine_periods: f64,
    pub shaft_deg: f64,
    /// Difference, in electrical degrees, between approaches from opposite sides, or `None` for a single typed
    /// position.
    pub apart_deg: Option<f64>,
    /// Electrical offset, where the electrical angle is pole pairs × shaft angle − offset.
    pub angle: ElectricalAngle,
    /// Resolution of the readings in electrical degrees, if known.
    pub resolution_deg: Option<f64>,
}

/// Position to set with method 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionSetting {
    pub value: u32,
    /// Whether exactly this value must be set, because the encoder's absolute position and phase disagree.
    pub exact: bool,
    /// Offset in electrical degrees that remains after setting the position, −180 to 180.
    pub remaining_deg: f64,
    pub verdict: Verdict,
}

/// Commutation record found in the memory or in its unwritten edits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredRecord {
    pub field: u8,
    /// Index of the first byte.
    pub address: usize,
    pub record: Result<CommutationRecord, CommutationRecordError>,
    /// Whether the record contains edits that have not been written yet.
    pub edited: bool,
}

impl Commutation {
    /// Returns the commutation offset from the readings.
    ///
    /// # Errors
    /// Returns an error if an entry or a reading is missing, or if the readings cannot be used.
    pub fn offset(&self, geometry: Option<Geometry>) -> Result<CommutationOffset, Text> {
        let inputs = self.form.inputs(geometry)?;
        let (one, other) = (self.reading_at(VectorSlot::OneSide), self.reading_at(VectorSlot::OtherSide));
        let (first, apart) = match (one, other) {
            (Some(one), Some(other)) => {
                (one, Some(signed_distance(one.fine_periods, other.fine_periods, inputs.periods)))
            }
            (Some(own), None) | (None, Some(own)) if own.kind == PositionKind::Typed => (own, None),
            (None, None) => return Err(TEXTS.text("commutation.no_reading")),
            _ => return Err(TEXTS.text("commutation.one_side_only")),
        };
        let apart_deg = apart.map(|apart| periods_to_electrical_deg(apart.abs(), &inputs));
        if let Some(apart_deg) = apart_deg.filter(|apart| *apart > inputs.limit_deg) {
            let text = TEXTS.text("commutation.friction").with_number("apart", apart_deg, 1);
            return Err(text.with_number("limit", inputs.limit_deg, 1));
        }
        let turn = f64::from(inputs.periods);
        let fine_periods = (first.fine_periods + apart.unwrap_or(0.0) / 2.0).rem_euclid(turn);
        let resolution = [one, other].into_iter().flatten().map(|reading| match reading.kind {
            PositionKind::Fine { resolution_periods, .. } => resolution_periods,
            PositionKind::Absolute => Some(1.0 / f64::from(STEPS_PER_PERIOD)),
            PositionKind::Typed => None,
        });
        // The mean has the coarser of both resolutions.
        let resolution = resolution.collect::<Option<Vec<f64>>>().and_then(|all| all.into_iter().reduce(f64::max));
        Ok(CommutationOffset {
            fine_periods,
            shaft_deg: fine_periods / turn * 360.0,
            apart_deg,
            angle: offset_angle(fine_periods, &inputs).ok_or_else(|| TEXTS.text("commutation.no_reading"))?,
            resolution_deg: resolution.map(|periods| periods_to_electrical_deg(periods, &inputs)),
        })
    }

    /// Compares the second vector with the offset, or returns `None` if the second vector has not been read yet.
    ///
    /// # Errors
    /// Returns an error if an entry or a reading is missing or unusable.
    pub fn second_vector_result(&self, geometry: Option<Geometry>) -> Option<Result<(Verdict, Text), Text>> {
        let reading = self.reading_at(VectorSlot::Second)?;
        Some(self.evaluate_second_reading(reading.fine_periods, geometry))
    }

    fn evaluate_second_reading(&self, fine_periods: f64, geometry: Option<Geometry>) -> Result<(Verdict, Text), Text> {
        /// Fraction of the expected movement below which the shaft counts as not moved.
        const MIN_MOVEMENT_FRACTION: f64 = 0.1;
        /// Permitted ratio of actual to expected movement.
        const MOVEMENT_RATIO: std::ops::RangeInclusive<f64> = 0.8..=1.25;
        let (inputs, offset, turns) =
            (self.form.inputs(geometry)?, self.offset(geometry)?, self.form.second_vector_turns()?);
        let moved = signed_distance(offset.fine_periods, fine_periods, inputs.periods);
        let moved = if inputs.reversed { -moved } else { moved };
        let second =
            inputs.motor.second_vector(moved, turns).filter(|second| second.ratio.abs() >= MIN_MOVEMENT_FRACTION);
        let degrees = |text: Text| {
            let text = text.with_number("moved", moved / f64::from(inputs.periods) * 360.0, 2);
            text.with_number("expected", turns * 360.0 / f64::from(inputs.pole_pairs), 2)
        };
        let Some(second) = second else { return Ok((Verdict::Fault, degrees(TEXTS.text("commutation.still")))) };
        let pairs = turns * f64::from(inputs.periods) / moved.abs();
        let whole = (pairs - pairs.round()).abs() < 0.25 && second.pole_pairs > 0;
        let own = second.pole_pairs == inputs.pole_pairs;
        let id = match (own && MOVEMENT_RATIO.contains(&second.ratio.abs()), second.ratio > 0.0) {
            (true, true) => return Ok((Verdict::Ok, degrees(TEXTS.text("commutation.fits")))),
            (true, false) => "commutation.exchanged",
            (false, true) if whole && !own => "commutation.other_pairs",
            (false, false) if whole && !own => "commutation.exchanged_pairs",
            _ => "commutation.unclear",
        };
        Ok((Verdict::Fault, degrees(TEXTS.text(id)).with("pairs", second.pole_pairs)))
    }

    /// Returns whether the second vector confirms the offset.
    pub fn is_confirmed(&self, geometry: Option<Geometry>) -> bool {
        matches!(self.second_vector_result(geometry), Some(Ok((Verdict::Ok, _))))
    }

    /// Returns whether both approaches gave exactly the same reading, which suggests that the shaft was not turned.
    pub fn are_sides_identical(&self) -> bool {
        let is_fine = |reading: &&RestReading| matches!(reading.kind, PositionKind::Fine { .. });
        let [one, other] =
            [VectorSlot::OneSide, VectorSlot::OtherSide].map(|slot| self.reading_at(slot).filter(is_fine));
        one.is_some() && one == other
    }

    /// Checks that a second vector has confirmed the offset, unless the user has chosen to omit the second vector.
    ///
    /// # Errors
    /// Returns an error if an entry or a reading is missing or unusable.
    pub fn check_offset_is_verified(&self, geometry: Option<Geometry>) -> Result<(), Text> {
        let is_usable = self.form.without_second || self.is_confirmed(geometry);
        if is_usable { Ok(()) } else { Err(TEXTS.text("commutation.needs_second")) }
    }

    fn check_second_vector_agrees(&self, geometry: Option<Geometry>) -> Result<(), Text> {
        match self.second_vector_result(geometry) {
            Some(Ok((Verdict::Fault, _))) => Err(TEXTS.text("commutation.second_refuses")),
            _ => Ok(()),
        }
    }

    /// Returns what method 1 writes: the data field, the index of the first byte, and the bytes.
    ///
    /// # Errors
    /// Returns an error if an entry or a reading is missing or unusable.
    pub fn bytes(&self, geometry: Option<Geometry>, staged: &StagedEdits) -> Result<(u8, usize, Vec<u8>), Text> {
        let (inputs, offset) = (self.form.inputs(geometry)?, self.offset(geometry)?);
        self.check_second_vector_agrees(geometry)?;
        let OffsetLocation { field, address } = self.offset_location(staged)?;
        let bytes = match self.form.storage {
            Storage::Number => offset.angle.bits().to_be_bytes().to_vec(),
            Storage::Record => {
                if !address.is_multiple_of(CommutationRecord::BYTES) {
                    return Err(TEXTS.text("commutation.block").with("address", address));
                }
                let pole_pairs = u8::try_from(inputs.pole_pairs);
                let pole_pairs = pole_pairs.map_err(|_| TEXTS.text("commutation.too_many_pairs"))?;
                let confirmed = self.is_confirmed(geometry);
                let record =
                    CommutationRecord { offset: offset.angle, pole_pairs, reversed: inputs.reversed, confirmed };
                record.emit().to_vec()
            }
        };
        Ok((field, address, bytes))
    }

    /// Returns the position to set with method 2. The shaft must not have moved since the last reading.
    ///
    /// # Errors
    /// Returns an error if an entry or a reading is missing, or if method 2 cannot be used.
    pub fn setting(&self, geometry: Option<Geometry>) -> Result<PositionSetting, Text> {
        let (inputs, _) = (self.form.inputs(geometry)?, self.offset(geometry)?);
        self.check_second_vector_agrees(geometry)?;
        let step = inputs.motor.electrical_step_deg();
        if step >= UNUSABLE_DEG {
            return Err(TEXTS.text("commutation.unusable").with_number("step", step, 1));
        }
        let here = self.last.filter(|slot| *slot != VectorSlot::Second).and_then(|slot| self.reading_at(slot));
        let here = here.ok_or_else(|| TEXTS.text("commutation.not_there"))?;
        let phase = Phase::from_periods(here.fine_periods).ok_or_else(|| TEXTS.text("commutation.not_there"))?;
        let steps = u64::from(STEPS_PER_PERIOD);
        let periods =
            geometry.and_then(Geometry::position_count).map_or(u64::from(inputs.periods), |range| range / steps);
        let last = u32::try_from(periods.saturating_sub(1)).unwrap_or(u32::MAX).min((1 << 27) - 1);
        let period = parse_integer(TEXTS.text("commutation.period"), &self.form.period, 0, last)?;
        let value = preset_position(period, phase).ok_or_else(|| TEXTS.text("commutation.not_there"))?;
        let remaining = offset_angle(f64::from(period) + phase.to_periods(), &inputs);
        let remaining = remaining.ok_or_else(|| TEXTS.text("commutation.not_there"))?.to_degrees();
        let off_step = here.raw.map_or(0, |raw| (raw % STEPS_PER_PERIOD).abs_diff(value % STEPS_PER_PERIOD));
        Ok(PositionSetting {
            value,
            // A difference of one step may be due to rounding.
            exact: off_step.min(STEPS_PER_PERIOD - off_step) > 1,
            remaining_deg: if remaining > 180.0 { remaining - 360.0 } else { remaining },
            verdict: if step >= WEAK_TORQUE_DEG { Verdict::Warn } else { Verdict::Ok },
        })
    }
}

pub fn stored(staged: &StagedEdits) -> Vec<StoredRecord> {
    let mut found = Vec::new();
    for field in staged.edited_fields() {
        let blocks = field.bytes.as_deref().unwrap_or_default().chunks(CommutationRecord::BYTES).enumerate();
        for (block, bytes) in blocks {
            let Some(record) = CommutationRecord::parse(bytes) else { continue };
            let address = block * CommutationRecord::BYTES;
            let edited = (address..address + bytes.len()).any(|at| staged.is_edited(field.number, at));
            found.push(StoredRecord { field: field.number, address, record, edited });
        }
    }
    found
}

/// Checks whether a position may be read, which requires that all previous steps of the assistant are complete.
pub fn reading_permission(commutation: &Commutation, ready: bool) -> ActionPermission {
    commutation.form.check_prepared()?;
    if commutation.form.source == Source::Typed {
        commutation.form.phase()?;
    }
    if ready { Ok(()) } else { Err(TEXTS.text("commutation.not_ready")) }
}

/// Returns the signed distance between two positions in signal periods, in the shorter direction within a revolution.
fn signed_distance(from: f64, to: f64, periods: u32) -> f64 {
    let turn = f64::from(periods);
    let forward = (to - from).rem_euclid(turn);
    if forward > turn / 2.0 { forward - turn } else { forward }
}

fn periods_to_electrical_deg(periods: f64, inputs: &OffsetInputs) -> f64 {
    periods * inputs.motor.electrical_step_deg()
}

/// Returns the offset that makes the electrical angle at a position equal to the angle of the vector.
fn offset_angle(fine_periods: f64, inputs: &OffsetInputs) -> Option<ElectricalAngle> {
    let shaft = if inputs.reversed { -fine_periods } else { fine_periods };
    let vector = ElectricalAngle::from_turns(inputs.vector_turns)?;
    inputs.motor.electrical_angle(shaft, vector)
}
