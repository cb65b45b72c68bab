//! Finds out why a parameter was rejected: whether the drive exists and is requested, and which range of values is
//! currently allowed.

use super::{Master, RetryPolicy, writable_parameter};
use crate::buses::ethernet_ip::protocol::{GeneralStatus, Request};
use crate::devices::hiperdrive::procedures::Error;
use crate::devices::hiperdrive::procedures::error::{ErrorReply, RequestedItem};
use crate::devices::hiperdrive::procedures::identify::read_topology;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, NUMERATOR, POSITION, REFERENCE, UPPER_LIMIT, VARIANT,
};
use crate::devices::hiperdrive::protocol::{
    DriveNumber, OutOfRange, ParameterNumber, ParameterRange, ParameterRow, PositionScale, Travel, Value, Variant,
};

impl Master<'_> {
    /// Finds out why a parameter was rejected, as far as possible.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub(super) fn find_rejection_reason(
        &mut self,
        requested: RequestedItem,
        number: ParameterNumber,
        refusal: ErrorReply,
    ) -> Result<Error, Error> {
        let Some(drive) = number.drive() else { return Ok(Error::Refused { requested, refusal }) };
        let topology = match self.station.known.topology {
            None if refusal.status == GeneralStatus::PATH_UNKNOWN => Some(read_topology(self)?),
            known => known,
        };
        if let Some(topology) = topology.filter(|topology| drive.get() > topology.drives()) {
            return Ok(Error::NoPlace { drive, topology });
        }
        if self.is_zero(number, VARIANT, drive)? {
            return Ok(Error::NoDrive { drive });
        }
        // The drive rejects the request in its current state, possibly because the drive is not requested.
        if refusal.status == GeneralStatus::STATE && self.is_zero(number, DRIVE_REQUESTED, drive)? {
            return Ok(Error::NotRequested { drive });
        }
        Ok(Error::Refused { requested, refusal })
    }

    /// Reads another parameter of the drive and returns whether its value is 0.
    fn is_zero(&mut self, refused: ParameterNumber, base: u16, drive: DriveNumber) -> Result<bool, Error> {
        let Some(number) = ParameterNumber::for_drive(base, drive).filter(|own| *own != refused) else {
            return Ok(false);
        };
        let request = Request::get(number.class(), 1, number.attribute());
        match self.request(RequestedItem::Parameter(number), &request, RetryPolicy::Always) {
            Ok(reply) => Ok(number.row().is_some_and(|row| row.kind.parse(&reply.data) == Ok(Value::Number(0)))),
            Err(Error::Refused { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }

    pub(super) fn write_rejection_reason(
        &mut self,
        number: ParameterNumber,
        value: i64,
        refusal: ErrorReply,
    ) -> Result<Error, Error> {
        let row = writable_parameter(number)?;
        match refusal.status {
            GeneralStatus::NOT_SETTABLE => Ok(Error::ReadOnly { number, name: row.name }),
            GeneralStatus::INVALID_VALUE => {
                let range = self.current_range(number, row)?;
                Ok(match range {
                    Some(range) => Error::Refuses(OutOfRange { number, name: row.name, value, range }),
                    None => Error::Refused { requested: RequestedItem::Set(number), refusal },
                })
            }
            _ => self.find_rejection_reason(RequestedItem::Set(number), number, refusal),
        }
    }

    /// Returns the currently allowed range of a parameter. The upper limit (parameter 160) must be above the lower
    /// limit (parameter 158), with the position and the reference between them (reference, section 4). Each limit must
    /// be within the turns of the drive (reference, section 5).
    fn current_range(&mut self, number: ParameterNumber, row: &ParameterRow) -> Result<Option<ParameterRange>, Error> {
        let travel = match number.drive().filter(|_| row.reach.is_some()) {
            Some(drive) => self.travel(drive)?,
            None => Travel::UNKNOWN,
        };
        let allowed = row.allowed_values(travel);
        let Some(drive) = number.drive().filter(|_| matches!(row.number, LOWER_LIMIT | UPPER_LIMIT | REFERENCE)) else {
            return Ok(allowed);
        };
        let mut of_drive = |base| match ParameterNumber::for_drive(base, drive) {
            Some(number) => match self.read_number(number) {
                Ok(value) => Ok(Some(value)),
                // Only the cause of the original rejection is reported.
                Err(error) if error.is_unavailable() => Ok(None),
                Err(error) => Err(error),
            },
            None => Ok(None),
        };
        let values = [of_drive(LOWER_LIMIT)?, of_drive(UPPER_LIMIT)?, of_drive(POSITION)?];
        let Some(ParameterRange::Within(least, most)) = allowed else { return Ok(allowed) };
        let [Some(lower), Some(upper), Some(position)] = values else { return Ok(allowed) };
        Ok(Some(match row.number {
            LOWER_LIMIT => ParameterRange::Within(least, position.min(upper - 1).min(most)),
            UPPER_LIMIT => ParameterRange::Within(position.max(lower + 1).max(least), most),
            _ => ParameterRange::Within(lower.max(least), upper.min(most)),
        }))
    }

    fn travel(&mut self, drive: DriveNumber) -> Result<Travel, Error> {
        let mut word = |base| {
            let Some(number) = ParameterNumber::for_drive(base, drive) else { return Ok(None) };
            match self.read_number(number) {
                Ok(value) => Ok(u16::try_from(value).ok()),
                Err(error) if error.is_unavailable() => Ok(None),
                Err(error) => Err(error),
            }
        };
        let (variant, numerator, denominator) = (word(VARIANT)?, word(NUMERATOR)?, word(DENOMINATOR)?);
        let family = variant.and_then(|number| Variant::new(number).row()).map(|row| row.family);
        let scale = numerator.zip(denominator).and_then(|(n, d)| PositionScale::new(n, d).ok());
        Ok(Travel { family, scale })
    }
}
