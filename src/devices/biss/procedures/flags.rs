//! Errors and warnings for transports that do not send them with the position. Over the configuration pin, they are
//! read from separate registers. See section 4 of the UBICOM reference.

use std::time::Duration;

use super::{Error, Master, PositionReading};
use crate::devices::biss::protocol::Role;
use crate::units::Moment;

/// The last values read from the error and warning registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flags {
    error: Option<bool>,
    warning: Option<bool>,
    looked_at: Moment,
    /// Whether the error register was read more recently than the warning register.
    errors_last: bool,
}

/// Interval at which one of the two registers is read while the position is polled. It is long enough not to slow the
/// polling noticeably.
const READ_INTERVAL: Duration = Duration::from_millis(500);

/// Reads the position once, together with the encoder's current errors and warnings.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_position(master: &mut Master<'_>) -> Result<PositionReading, Error> {
    let reading = master.position()?;
    if reading.frame.is_some() {
        return Ok(reading);
    }
    master.station().flags = None;
    add_error_flags(master, reading)
}

/// Adds the last known error and warning to the position. A register that is due is read first.
pub(super) fn add_error_flags(master: &mut Master<'_>, reading: PositionReading) -> Result<PositionReading, Error> {
    let now = master.now();
    let flags = match master.station().flags {
        None => Flags {
            error: is_set(master, Role::Errors)?,
            warning: is_set(master, Role::Warnings)?,
            looked_at: now,
            errors_last: false,
        },
        Some(flags) if now.duration_since(flags.looked_at) < READ_INTERVAL => flags,
        Some(flags) if flags.errors_last => {
            Flags { warning: is_set(master, Role::Warnings)?, looked_at: now, errors_last: false, ..flags }
        }
        Some(flags) => Flags { error: is_set(master, Role::Errors)?, looked_at: now, errors_last: true, ..flags },
    };
    master.station().flags = Some(flags);
    Ok(PositionReading { error: flags.error, warning: flags.warning, ..reading })
}

/// Returns whether a bit of the register is set, or `None` if the encoder has no such register.
fn is_set(master: &mut Master<'_>, role: Role) -> Result<Option<bool>, Error> {
    let (description, firmware) = (master.station().description.clone(), master.station().firmware.unwrap_or_default());
    let register =
        description.as_ref().and_then(|own| own.register_with_role(role)).filter(|own| firmware >= own.since);
    let Some(register) = register else { return Ok(None) };
    match master.read_consecutive(register.address, register.width.into()) {
        Ok(bytes) => Ok(Some(bytes.iter().any(|byte| *byte != 0))),
        Err(Error::NoSuchRegister { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
