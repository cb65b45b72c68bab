//! A survey, which reads all values that are displayed for an encoder in one job.

use super::fields::separate_value_error;
use super::{
    Error, Identity, LineQuality, Master, PolledSample, UnreadableField, identify, read_all_fields, read_counter,
    read_sample, try_read_field,
};
use crate::devices::hiperface::profile::FieldImage;
use crate::devices::hiperface::protocol::{EncoderTypes, StatusCode};

#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    pub identity: Identity,
    /// Codes from the status queue, in the encoder's order, followed by codes announced during the survey.
    pub codes: Vec<StatusCode>,
    /// All data fields. A field has no bytes if its access code is unknown or if it is listed in `unreadable`.
    pub fields: Vec<FieldImage>,
    /// Data fields that could not be read for a reason other than their access code.
    pub unreadable: Vec<UnreadableField>,
    /// Quality of the line at the end of the survey.
    pub line: LineQuality,
    pub counter: Option<u32>,
    /// Position, or `None` if it could not be read. A temporary lack of a position is still a sample.
    pub position: Option<PolledSample>,
}

/// Reads the status queue, and then all other values. Features that the encoder type does not support cause no error.
///
/// # Errors
/// Returns an error if the exchange fails, or if the encoder rejects a command that every type supports.
pub fn read_all_values(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Survey, Error> {
    // The codes stay in the station until the survey is complete, so that they are reported even if it fails.
    master.collect_codes()?;
    let mut survey = read_survey(master, types, progress, ReadPolicy::AsFarAsPossible)?;
    survey.codes = master.station().take_undisplayed_codes();
    // A code that the encoder announced earlier also applies to this position.
    let spoilt = survey.codes.iter().any(|code| code.invalidates_position());
    if let Some(PolledSample::Position(reading)) = &mut survey.position {
        reading.valid &= !spoilt;
    }
    Ok(survey)
}

/// How to handle data fields that cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadPolicy {
    AsFarAsPossible,
    /// Returns an error if a field cannot be read, because a saved profile must be complete.
    Complete,
}

/// Reads all values except the status queue.
pub(super) fn read_survey(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    progress: &mut dyn FnMut(u64, u64),
    reading: ReadPolicy,
) -> Result<Survey, Error> {
    let identity = identify(master, types)?;
    let count = identity.memory.map_or(0, |memory| memory.fields);
    let mut unreadable = Vec::new();
    let fields = match reading {
        ReadPolicy::Complete => read_all_fields(master, count, progress)?,
        ReadPolicy::AsFarAsPossible => read_accessible_fields(master, count, &mut unreadable, progress)?,
    };
    // A restore requires neither value, so a rejection does not end the survey.
    let position = read_sample(master, identity.geometry);
    let position = separate_value_error(master, position)?.ok();
    let counter = read_counter(master);
    let counter = separate_value_error(master, counter)?.ok();
    let line = master.station().line.quality.clone();
    Ok(Survey { identity, codes: Vec::new(), fields, unreadable, line, counter, position })
}

/// Reads all readable fields. Other fields are reported with their status, if known.
fn read_accessible_fields(
    master: &mut Master<'_>,
    count: u8,
    unreadable: &mut Vec<UnreadableField>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Vec<FieldImage>, Error> {
    let mut fields = Vec::new();
    for number in 0..count {
        progress(u64::from(number), u64::from(count));
        match try_read_field(master, number)? {
            Ok(field) => fields.push(field),
            Err(field) => {
                fields.extend(field.status.map(|status| FieldImage { number, status, bytes: None }));
                unreadable.push(field);
            }
        }
    }
    Ok(fields)
}
