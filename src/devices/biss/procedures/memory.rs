//! Reading the memory of the encoder: banks, data areas, and all restorable values. Data areas are not accessed while
//! the shaft turns. See manual 6.5.

use std::time::Duration;

use super::error::to_register_array;
use super::identify::identify_and_record;
use super::registers::Registers;
use super::survey::read_survey;
use super::write::non_operational_mode;
use super::{Error, Master, PositionReading, Survey};
use crate::devices::biss::profile::{Bank, BissProfile, DataImage, ListedBank, PresetSetting, RecordedValues};
use crate::devices::biss::protocol::{Area, Descriptions, DeviceMode, RegisterAddress};
use crate::profile::UnknownValues;

/// Number of position readings for detecting standstill.
const READINGS: usize = 3;
const READING_INTERVAL: Duration = Duration::from_millis(100);
/// Minimum multiturn width in bits for measuring a speed. During the readings, a motor at 12,000 rpm turns forty times,
/// which this width can count.
const MIN_MULTITURN_BITS: u8 = 7;
/// Reciprocal of the maximum jitter of a shaft at rest, in revolutions. The jitter is not documented (`U`).
const REST_JITTER_DIVISOR: u64 = 8192;

/// How to treat values that were entered in a device mode but never saved. The encoder reports them like stored values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsavedValues {
    Marked,
    /// Unsaved values are an error, because a comparison would take them for stored values.
    Refused,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadStep {
    Register(RegisterAddress),
    Bank(u8),
}

/// Reads the position three times, a tenth of a second apart, and returns the last one if the shaft is at rest.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, or another error if a reading fails.
pub fn ensure_standstill(master: &mut Master<'_>) -> Result<PositionReading, Error> {
    let first = master.position()?;
    let mut readings = vec![first];
    let mut last = first;
    for _ in 1..READINGS {
        master.wait(READING_INTERVAL)?;
        last = master.position()?;
        readings.push(last);
    }
    let range = 1u64.checked_shl(first.position_word().bits.into());
    let allowed = ((1u64 << first.singleturn_bits) / REST_JITTER_DIVISOR).max(1);
    if readings.iter().all(|reading| shortest_distance(first.position(), reading.position(), range) <= allowed) {
        Ok(last)
    } else {
        Err(Error::Moving { rpm: speed(&readings) })
    }
}

/// Returns the mean speed of the readings in revolutions per minute, positive clockwise. Returns `None` if the
/// multiturn width is unknown or too small to count the turns.
fn speed(readings: &[PositionReading]) -> Option<f64> {
    let (first, last) = (readings.first()?, readings.last()?);
    if first.multiturn_bits < MIN_MULTITURN_BITS || !first.is_split_known {
        return None;
    }
    let range = 1_i64.checked_shl((first.multiturn_bits + first.singleturn_bits).into())?;
    let steps = last.position() as i64 - first.position() as i64;
    // The shaft is assumed to have moved in the shorter direction.
    let steps = (steps + range / 2).rem_euclid(range) - range / 2;
    let turns = steps as f64 / f64::powi(2.0, first.singleturn_bits.into());
    let minutes = last.at.duration_since(first.at).as_secs_f64() / 60.0;
    (minutes > 0.0).then(|| turns / minutes)
}

/// Returns the number of steps between two positions in the shorter direction, because a shaft at rest may jitter
/// across zero.
fn shortest_distance(a: u64, b: u64, range: Option<u64>) -> u64 {
    let straight = a.abs_diff(b);
    range.map_or(straight, |range| straight.min(range.saturating_sub(straight)))
}

/// Reads consecutive registers. Registers of a data area are read only at standstill.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, or another error if a reading fails.
pub fn read_registers(master: &mut Master<'_>, start: RegisterAddress, count: u8) -> Result<Vec<u8>, Error> {
    let in_area = master.station().description.as_ref().is_some_and(|own| own.area_at(start).is_some());
    if in_area {
        ensure_standstill(master)?;
    }
    read_reliably(master, |master| master.read_consecutive(start, count.into()))
}

/// Reads a data area. The shaft must be at rest.
///
/// # Errors
/// Returns an error if a reading fails.
pub fn read_area(master: &mut Master<'_>, area: &Area, progress: &mut dyn FnMut(u8)) -> Result<Vec<Bank>, Error> {
    let mut banks = Vec::new();
    for number in area.banks() {
        progress(number);
        let start = RegisterAddress::bank_start(number);
        banks.push(Bank { number, bytes: to_register_array(start, master.read_consecutive(start, Bank::SIZE)?)? });
    }
    Ok(banks)
}

/// Reads a data area after checking that the shaft is at rest.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, or another error if a reading fails.
pub fn read_area_at_standstill(
    master: &mut Master<'_>,
    area: &Area,
    progress: &mut dyn FnMut(u8),
) -> Result<Vec<Bank>, Error> {
    ensure_standstill(master)?;
    read_reliably(master, |master| read_area(master, area, progress))
}

/// Reads the identity and all values that a profile can restore. The device mode is left unchanged, because a return to
/// operation mode would discard entered values.
///
/// # Errors
/// Returns [`Error::NotInOperation`] if unsaved values are not allowed, [`Error::Moving`] if the shaft moves, or
/// another error if the exchange fails.
pub fn save(
    master: &mut Master<'_>,
    types: &Descriptions,
    unsaved: UnsavedValues,
    progress: &mut dyn FnMut(u64, u64, ReadStep),
) -> Result<BissProfile, Error> {
    read_reliably(master, |master| {
        let mut registers = Registers::default();
        let identity = identify_and_record(master, types, &mut registers)?;
        let description = identity.description.clone();
        let refused = |mode: &Option<DeviceMode>| mode.filter(|_| unsaved == UnsavedValues::Refused);
        let before = non_operational_mode(master, &description)?;
        if let Some(mode) = refused(&before) {
            return Err(Error::NotInOperation { mode });
        }
        let areas: Vec<&Area> = description.areas().iter().filter(|area| area.access.is_readable()).collect();
        let (mut done, mut total) = (0, areas.iter().map(|area| area.size() as u64).sum());
        let in_areas = total;
        let survey = read_survey(master, identity, registers, &mut |at, of, address| {
            (done, total) = (of, of + in_areas);
            progress(at, total, ReadStep::Register(address));
        })?;
        let mut data = Vec::new();
        for area in areas {
            ensure_standstill(master)?;
            let banks = read_area(master, area, &mut |bank| {
                progress(done, total, ReadStep::Bank(bank));
                done += Bank::SIZE as u64;
            })?;
            data.push(DataImage::new(area, banks));
        }
        // Another host may have entered a device mode in the meantime.
        let mode = before.or(non_operational_mode(master, &description)?);
        match refused(&mode) {
            Some(mode) => Err(Error::NotInOperation { mode }),
            None => Ok(create_profile(&survey, data, mode)),
        }
    })
}

/// Runs `read`. If any data is damaged on the line meanwhile, other damage may have gone unnoticed. Then `read` is run
/// again, and every value must arrive twice.
fn read_reliably<T>(
    master: &mut Master<'_>,
    mut read: impl FnMut(&mut Master<'_>) -> Result<T, Error>,
) -> Result<T, Error> {
    let was_sure = master.station().requires_double_read();
    let value = read(master)?;
    if was_sure || !master.station().requires_double_read() { Ok(value) } else { master.run_double_checked(read) }
}

/// Creates the profile of an encoder. `unsaved` is the device mode in which the encoder was read, or `None` for
/// operation mode.
pub fn create_profile(survey: &Survey, data: Vec<DataImage>, unsaved: Option<DeviceMode>) -> BissProfile {
    let identity = &survey.identity;
    let sheets = identity.data_sheet.iter().flat_map(|sheet| [&sheet.common, &sheet.encoder]);
    let mut profile = BissProfile {
        identity: identity.profile(),
        filter: survey.status.filter,
        preset: survey.preset.map(|value| PresetSetting { value, unknown: UnknownValues::new() }),
        recorded: RecordedValues {
            eds: sheets.map(|sheet| ListedBank::from(Bank { number: sheet.bank, bytes: sheet.bytes })).collect(),
            wiegand_last: survey.wiegand_last,
            wiegand_production: survey.wiegand_production,
            wiegand_saved: survey.wiegand_saved,
            calibration_status: survey.calibration.map(|status| status.byte()),
            device_mode: unsaved,
            unknown: UnknownValues::new(),
        },
        mounting: Vec::new(),
        data,
    };
    profile.mark_mounting_dependent_values();
    profile
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_shorter_distance() {
        assert_eq!(shortest_distance(0, (1 << 33) - 1, Some(1 << 33)), 1);
        assert_eq!(shortest_distance(5, 3, Some(1 << 33)), 2);
        assert_eq!(shortest_distance(0, u64::MAX, None), u64::MAX);
    }
}
