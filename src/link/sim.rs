//! `sim:` — a virtual device in this process. In virtual time, waiting for an answer takes no time at all.

use std::sync::{Arc, Mutex, PoisonError};

use super::{ByteLink, Clock, LinkError};
use crate::sim::ByteDevice;
use crate::units::{CharacterFormat, Moment};

/// A wire to a virtual device. The device can be shared: with a test that looks into it, or with the link that comes
/// after this one.
pub struct SimLink {
    device: Arc<Mutex<dyn ByteDevice>>,
    clock: Arc<dyn Clock>,
}

impl SimLink {
    /// Connects to the device.
    pub fn connect(device: Arc<Mutex<dyn ByteDevice>>, clock: Arc<dyn Clock>) -> Self {
        let link = SimLink { device, clock };
        let now = link.clock.now();
        link.with_device(|device| device.connect(now));
        link
    }

    fn with_device<T>(&self, work: impl FnOnce(&mut dyn ByteDevice) -> T) -> T {
        // A virtual device left behind by a panicking test is still a device.
        let mut device = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut *device)
    }
}

impl ByteLink for SimLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let now = self.clock.now();
        self.with_device(|device| device.on_bytes(now, bytes));
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        loop {
            let now = self.clock.now();
            let (bytes, next) = self.with_device(|device| (device.poll(now), device.poll_at()));
            if !bytes.is_empty() {
                into.extend(bytes);
                return Ok(());
            }
            if now >= until {
                return Ok(());
            }
            self.clock.sleep_until(next.map_or(until, |next| next.min(until)));
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        let now = self.clock.now();
        self.with_device(|device| device.set_host_format(now, format));
        Ok(())
    }

    fn check(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}
