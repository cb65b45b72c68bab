//! The condition for an endless run: the limits and the scaling of the drive must be at their factory values.

use super::unit::HiperdriveDevice;
use crate::app::Text;
use crate::devices::hiperdrive::protocol::drive_parameter::{DENOMINATOR, LOWER_LIMIT, NUMERATOR, UPPER_LIMIT};
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber};
use crate::devices::hiperdrive::state::TEXTS;

impl HiperdriveDevice {
    /// Returns a message for each parameter that prevents an endless run of a drive. The list is empty if none does, or
    /// if limits and scaling are unknown.
    pub fn endless_run_obstacles(&self, drive: DriveNumber) -> Vec<Text> {
        let Some(rules) = self.drive_limits(drive).map(|own| own.rules()) else { return Vec::new() };
        let Some(((numerator, denominator), (lower, upper))) = rules.scale.zip(rules.limits) else {
            return Vec::new();
        };
        let parameters =
            [(LOWER_LIMIT, lower), (UPPER_LIMIT, upper), (NUMERATOR, numerator), (DENOMINATOR, denominator)];
        parameters.into_iter().filter_map(|(number, value)| self.factory_difference(drive, number, value)).collect()
    }

    fn factory_difference(&self, drive: DriveNumber, number: u16, value: i64) -> Option<Text> {
        let number = ParameterNumber::for_drive(number, drive)?;
        let factory = number.row().and_then(|row| self.factory_value(number, row));
        let text = match factory {
            Some(factory) if factory == value => return None,
            Some(factory) => TEXTS.text("hd_run.differs").with("factory", factory),
            None => TEXTS.text("hd_run.unknown_factory"),
        };
        Some(text.with("number", number.get()).with("value", value))
    }
}
