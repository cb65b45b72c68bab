//! The encoder at the serial line of a virtual adapter, where it is asked for.

use super::{Bus, Config};
use crate::buses::bridge::sim::{Attachable, Attached, SerialDevice};
use crate::sim::ConfigError;
use crate::sim::setting::Setting;
use crate::units::Moment;

/// An encoder as delivered at the adapter's serial line; its key is `uart`: `none` or `hiperface`.
#[derive(Clone, Copy, Debug)]
pub struct AtAdapter;

impl Attachable for AtAdapter {
    fn keys(&self) -> &'static [&'static str] {
        &["uart"]
    }

    fn attached(&self, pairs: &[(String, String)]) -> Result<Option<Attached>, ConfigError> {
        let mut is_there = false;
        for (key, value) in pairs {
            let choices = [("none", false), ("hiperface", true)];
            is_there = Setting { key, value }.one_of(&choices)?;
        }
        Ok(is_there.then(|| Attached::Serial(Box::new(Bus::new(&Config::default())))))
    }
}

impl SerialDevice for Bus {
    fn another(&self) -> Box<dyn SerialDevice> {
        Box::new(self.clone())
    }

    fn turn(&mut self, now: Moment, rpm: f64) {
        if let Some(encoder) = self.encoder_mut(0) {
            encoder.set_rpm(now, rpm);
        }
    }
}
