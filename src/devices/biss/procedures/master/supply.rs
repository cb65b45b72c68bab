//! The encoder's supply over an adapter: on where that is wished, and at the end of the session as it was found.

use std::time::Duration;

use super::Master;
use crate::devices::biss::procedures::Error;
use crate::devices::biss::procedures::station::{Supply, Transport};
use crate::devices::biss::protocol::DeviceMode;

/// A register that was written may begin a store that no status tells of; how long one takes is not published (`U`).
const SETTLES: Duration = Duration::from_secs(1);

impl Master<'_> {
    /// Switches the supply on where that is wished and was not done yet.
    pub(super) fn switch_on(&mut self) -> Result<(), Error> {
        let Some(Supply { millivolt, measured: None }) = self.station.supply else { return Ok(()) };
        if self.station.adapter.found_supplied().is_none() {
            let has_power = self.has_power();
            self.station.adapter.find_supplied(has_power);
        }
        let measured = self.adapter().supply(Supply::voltage(millivolt))?;
        self.station.supply = Some(Supply { millivolt, measured: Some(measured) });
        // Data sheet, 02:0Eh: 500 ms until registers can be asked.
        self.wait(Supply::POWER_UP)
    }

    /// Returns whether the encoder has power: one that sends a frame does, whatever its supply.
    fn has_power(&mut self) -> bool {
        let bits = self.station.frame().bits();
        let ones = u64::MAX >> (64 - u32::from(bits.clamp(1, 64)));
        matches!(self.frame_once(), Ok(Ok((raw, _))) if raw != 0 && raw != ones)
    }

    /// Switches the supply off at the end of a session, unless it was on before or is to stay on. It stays on as well where
    /// a store, a calibration or a restart may be under way: to cut the power then loses what the encoder holds.
    ///
    /// # Errors
    /// The adapter's.
    pub fn leave_supply(&mut self) -> Result<(), Error> {
        if self.station.transport != Transport::Adapter || !self.station.adapter.supply_goes_off() {
            return Ok(());
        }
        self.shielded(|master| {
            master.end_frames()?;
            if master.is_unfinished()? {
                tracing::warn!("the encoder's supply stays on: it may be storing, calibrating or restarting");
                return Ok(());
            }
            Ok(master.adapter().leave_supply()?)
        })
    }

    /// Returns whether the encoder may be doing something that needs its power.
    fn is_unfinished(&mut self) -> Result<bool, Error> {
        if self.station.unfinished {
            return Ok(true);
        }
        // In this session nothing was written; one that says nothing at all may be at what an earlier one has begun.
        let Some(written_at) = self.station.written_at else { return Ok(!self.has_power()) };
        let since = self.now().since(written_at);
        self.wait(SETTLES.saturating_sub(since))?;
        let Some(lock) = self.station.description.as_ref().and_then(|own| own.lock()) else { return Ok(false) };
        // One that is silent calibrates or restarts.
        Ok(self.read(lock.mode_at).map(DeviceMode::new) != Ok(DeviceMode::OPERATION))
    }
}
