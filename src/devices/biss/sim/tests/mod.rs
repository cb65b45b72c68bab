//! Tests of the virtual kit encoder from the perspective of a host, in virtual time. Expected values are from the
//! manual and the reference, never from the code under test.

mod at_adapter;
mod modes;
mod motor;
mod registers;
mod storage;
mod ubicom;

use std::time::Duration;

use super::*;
use crate::devices::biss::protocol::RegisterAddress;
use crate::units::Moment;

/// A host that accesses registers by name, without a line.
struct Host {
    encoder: Encoder,
    now: Moment,
}

impl Host {
    /// Creates a host for the virtual encoder described by the query of a `sim:` link.
    fn with(query: &str) -> Self {
        Host { encoder: Encoder::new(&config(query)), now: Moment::START }
    }

    fn read(&mut self, register: &str) -> u8 {
        self.encoder.read(self.now, address(register)).unwrap()
    }

    fn write(&mut self, register: &str, value: u8) -> bool {
        self.encoder.write(self.now, address(register), value)
    }

    /// Writes a value and checks that the encoder accepts it.
    #[track_caller]
    fn put(&mut self, register: &str, value: u8) {
        assert!(self.write(register, value), "{register} = {value:02X}");
    }

    #[track_caller]
    fn expect(&mut self, register: &str, value: u8) {
        assert_eq!(self.read(register), value, "{register}");
    }

    /// Enters a device mode, as every procedure does at its start.
    #[track_caller]
    fn enter(&mut self, mode: u8) {
        self.put("0x6B", 0x2A);
        self.put("0x6A", mode);
        self.expect("0x6A", mode);
    }

    fn wait(&mut self, seconds: f64) {
        self.now = self.now + Duration::from_secs_f64(seconds);
    }

    fn turn(&mut self, rpm: f64) {
        self.encoder.set_rpm(self.now, rpm);
    }

    fn answers(&mut self) -> bool {
        self.encoder.can_access_registers(self.now)
    }

    /// Returns the multiturn and singleturn position.
    fn position(&mut self) -> Option<(u32, u32)> {
        self.encoder.position_at(self.now).map(|reading| (reading.multiturn, reading.singleturn))
    }
}

fn config(query: &str) -> Config {
    let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
    let pairs: Vec<_> = query.split('&').filter_map(pair).collect();
    Config::from_pairs(&pairs).unwrap()
}

fn address(register: &str) -> RegisterAddress {
    register.parse().unwrap()
}
