//! Everything that there is to see of an encoder, in one go.

use super::{Error, Identity, Master, Sample, identify, read_all_fields, read_counter, read_sample, read_status};
use crate::profile::hiperface::FieldImage;
use crate::protocol::hiperface::{EncoderTypes, StatusCode};

/// An encoder as it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Who is there.
    pub identity: Identity,
    /// The error queue, in the encoder's order, and what came to it meanwhile.
    pub codes: Vec<StatusCode>,
    /// All data fields, without bytes where the access code is not known.
    pub fields: Vec<FieldImage>,
    /// The counter, where the type has one.
    pub counter: Option<u32>,
    /// The position, where the encoder does not refuse it for another reason than that it has none at the moment.
    pub position: Option<Sample>,
}

/// Reads the error queue first, then all the rest. What a type does not have is no error.
///
/// # Errors
/// The line, or a refusal of what every type has.
pub fn survey(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Survey, Error> {
    let codes = read_status(master)?;
    let mut survey = look_around(master, types, progress)?;
    survey.codes = codes;
    survey.codes.extend(master.station().take_codes());
    // A code that the encoder announced before is about this position too.
    let spoilt = survey.codes.iter().any(|code| code.spoils_position());
    if let Some(Sample::Position(reading)) = &mut survey.position {
        reading.valid &= !spoilt;
    }
    Ok(survey)
}

/// All but the error queue.
pub(super) fn look_around(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Survey, Error> {
    let identity = identify(master, types)?;
    let fields = read_all_fields(master, identity.memory.map_or(0, |memory| memory.fields), progress)?;
    // Neither is needed for a restore: an encoder that refuses them is looked at all the same.
    let position = refused(read_sample(master, identity.geometry))?;
    let counter = refused(read_counter(master))?;
    Ok(Survey { identity, codes: Vec::new(), fields, counter, position })
}

fn refused<T>(result: Result<T, Error>) -> Result<Option<T>, Error> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(Error::Rejected { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
