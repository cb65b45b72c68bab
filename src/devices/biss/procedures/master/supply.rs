//! The encoder's supply from an adapter. It is switched on if requested, and restored at the end of the session.

use std::time::Duration;

use super::Master;
use crate::devices::biss::procedures::Error;
use crate::devices::biss::procedures::station::{Supply, Transport};
use crate::devices::biss::protocol::DeviceMode;

/// Time allowed for the encoder to store data after a register write. No status register shows when it has finished,
/// and the duration is not published (`U`).
const STORE_TIME: Duration = Duration::from_secs(1);

impl Master<'_> {
    pub(super) fn switch_on(&mut self) -> Result<(), Error> {
        let Some(Supply { millivolt, measured: None }) = self.station.supply else { return Ok(()) };
        if self.station.adapter.was_supplied_at_start().is_none() {
            let has_power = self.has_power();
            self.station.adapter.set_supplied_at_start(has_power);
        }
        let measured = self.adapter_host().switch_supply_on(Supply::with_voltage(millivolt))?;
        self.station.supply = Some(Supply { millivolt, measured: Some(measured) });
        // Registers can be read 500 ms after power-up (data sheet, 02:0Eh).
        self.wait(Supply::POWER_UP)
    }

    /// Returns whether the encoder has power, from any source. Only a powered encoder sends a frame.
    fn has_power(&mut self) -> bool {
        let bits = self.station.frame_layout().bits();
        let ones = u64::MAX >> (64 - u32::from(bits.clamp(1, 64)));
        matches!(self.read_frame_once(), Ok(Ok((raw, _))) if raw != 0 && raw != ones)
    }

    /// Switches off the supply at the end of a session, unless it was already on before or is to remain on. It also
    /// remains on while the encoder may be storing data, calibrating or restarting, because data could be lost.
    ///
    /// # Errors
    /// Returns an error if the adapter fails.
    pub fn switch_off_after_session(&mut self) -> Result<(), Error> {
        if self.station.transport != Transport::Adapter || !self.station.adapter.must_switch_supply_off() {
            return Ok(());
        }
        self.run_uncancellable(|master| {
            master.stop_frame_stream()?;
            if master.is_power_still_needed()? {
                tracing::warn!("the encoder's supply stays on: it may be storing, calibrating or restarting");
                return Ok(());
            }
            Ok(master.adapter_host().switch_off_after_session()?)
        })
    }

    /// Returns whether a loss of power could interrupt the encoder while it stores data, calibrates or restarts.
    fn is_power_still_needed(&mut self) -> Result<bool, Error> {
        if self.station.unfinished {
            return Ok(true);
        }
        // Nothing was written in this session, but an encoder that does not reply may be busy with an earlier
        // operation.
        let Some(written_at) = self.station.written_at else { return Ok(!self.has_power()) };
        let since = self.now().duration_since(written_at);
        self.wait(STORE_TIME.saturating_sub(since))?;
        let Some(lock) = self.station.description.as_ref().and_then(|own| own.lock()) else { return Ok(false) };
        // An encoder that does not reply is calibrating or restarting.
        Ok(self.read(lock.mode_at).map(DeviceMode::new) != Ok(DeviceMode::OPERATION))
    }
}
