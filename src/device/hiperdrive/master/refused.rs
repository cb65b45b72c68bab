//! Why a parameter was refused, as far as the device can be asked: whether there is such a drive, whether anything is wanted of
//! it, and what a value may be at the moment.

use super::{Master, Repeats, settable};
use crate::device::hiperdrive::Error;
use crate::device::hiperdrive::error::{Asked, Refusal};
use crate::device::hiperdrive::identify::topology;
use crate::protocol::ethernet_ip::{GeneralStatus, Request};
use crate::protocol::hiperdrive::{DriveNumber, OutOfRange, ParameterNumber, ParameterRow, Range};

impl Master<'_> {
    /// Why a parameter was refused, as far as can be asked.
    ///
    /// # Errors
    /// The way.
    pub(super) fn why_refused(
        &mut self,
        asked: Asked,
        number: ParameterNumber,
        refusal: Refusal,
    ) -> Result<Error, Error> {
        let Some(drive) = number.drive() else { return Ok(Error::Refused { asked, refusal }) };
        let topology = match self.station.known.topology {
            None if refusal.status == GeneralStatus::PATH_UNKNOWN => Some(topology(self)?),
            known => known,
        };
        if let Some(topology) = topology.filter(|topology| drive.get() > topology.drives()) {
            return Ok(Error::NoPlace { drive, topology });
        }
        if self.is_zero(number, 120, drive)? {
            return Ok(Error::NoDrive { drive });
        }
        // What is asked of it is refused in this state: because nobody wants anything of it?
        if refusal.status == GeneralStatus::STATE && self.is_zero(number, 152, drive)? {
            return Ok(Error::NotRequested { drive });
        }
        Ok(Error::Refused { asked, refusal })
    }

    /// Another parameter of a drive is known to be 0.
    fn is_zero(&mut self, refused: ParameterNumber, base: u16, drive: DriveNumber) -> Result<bool, Error> {
        let Some(number) = ParameterNumber::of_drive(base, drive).filter(|own| *own != refused) else {
            return Ok(false);
        };
        let request = Request::get(number.class(), 1, number.attribute());
        match self.request(Asked::Parameter(number), &request, Repeats::Always) {
            Ok(reply) => Ok(!reply.data.is_empty() && reply.data.iter().all(|byte| *byte == 0)),
            Err(Error::Refused { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }

    pub(super) fn why_not_set(
        &mut self,
        number: ParameterNumber,
        value: i64,
        refusal: Refusal,
    ) -> Result<Error, Error> {
        let row = settable(number)?;
        match refusal.status {
            GeneralStatus::NOT_SETTABLE => Ok(Error::ReadOnly { number, name: row.name }),
            GeneralStatus::INVALID_VALUE => {
                let range = self.range_now(number, row)?;
                Ok(match range {
                    Some(range) => Error::Refuses(OutOfRange { number, name: row.name, value, range }),
                    None => Error::Refused { asked: Asked::Set(number), refusal },
                })
            }
            _ => self.why_refused(Asked::Set(number), number, refusal),
        }
    }

    /// What a parameter may be at the moment: 160 is above 158, position and reference lie between them (reference 4).
    fn range_now(&mut self, number: ParameterNumber, row: &ParameterRow) -> Result<Option<Range>, Error> {
        let Some(drive) = number.drive().filter(|_| matches!(row.number, 158 | 160 | 198)) else {
            return Ok(row.allowed());
        };
        let mut of_drive = |base| match ParameterNumber::of_drive(base, drive) {
            Some(number) => self.read_number(number).map(Some),
            None => Ok(None),
        };
        let values = [of_drive(158)?, of_drive(160)?, of_drive(107)?];
        let (least, most) = row.kind.limits().unwrap_or_default();
        let [Some(lower), Some(upper), Some(position)] = values else { return Ok(row.allowed()) };
        Ok(Some(match row.number {
            158 => Range::Within(least, position.min(upper - 1)),
            160 => Range::Within(position.max(lower + 1), most),
            _ => Range::Within(lower, upper),
        }))
    }
}
