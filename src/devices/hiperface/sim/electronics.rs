//! The electronics of an encoder: its data, and the effects of the twenty commands on them (manual, "Die Befehle").
//! Timing and frames are implemented in [`encoder`](super::encoder).

use std::collections::{BTreeMap, VecDeque};

use super::config::Config;
use super::memory::Memory;
use super::models::Model;
use super::shaft::Shaft;
use crate::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, Command, DataFieldStatus, DeviceAddress, EncoderTypes, FieldSize, LineSettings,
    Request, StatusCode,
};
use crate::units::Moment;

/// Number of EEPROM writes for each command.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wear(BTreeMap<u8, u32>);

impl Wear {
    pub fn write_count(&self, command: Command) -> u32 {
        self.0.get(&command.byte()).copied().unwrap_or(0)
    }

    pub fn total(&self) -> u32 {
        self.0.values().sum()
    }

    fn count(&mut self, command: Command) {
        *self.0.entry(command.byte()).or_default() += 1;
    }
}

/// Status codes that wait to be read with command 50h, oldest first. The queue holds four codes. While it is full,
/// further codes are lost.
#[derive(Clone, Debug, Default)]
pub(super) struct StatusQueue(VecDeque<StatusCode>);

impl StatusQueue {
    const CAPACITY: usize = 4;

    pub(super) fn push(&mut self, code: StatusCode) {
        if self.0.len() < Self::CAPACITY {
            self.0.push_back(code);
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn pop(&mut self) -> StatusCode {
        self.0.pop_front().unwrap_or(StatusCode::OK)
    }
}

/// A virtual encoder without its line.
#[derive(Clone, Debug)]
pub(super) struct EncoderElectronics {
    model: Model,
    kit: bool,
    encoder_type: u8,
    serial_number: String,
    pub(super) address: DeviceAddress,
    /// Interface settings that take effect at the next start.
    pub(super) stored_settings: LineSettings,
    pub(super) memory: Memory,
    pub(super) shaft: Shaft,
    pub(super) queue: StatusQueue,
    pub(super) wear: Wear,
    pub(super) counter: u32,
    temperature: i16,
}

impl EncoderElectronics {
    /// Maximum of the 24-bit counter.
    const COUNTER_MAX: u32 = 0x00FF_FFFF;
    /// Analogue channel of the sine signal, as specified in the data sheets.
    const SINE: u8 = 0x00;
    const COSINE: u8 = 0x01;
    const TEMPERATURE: u8 = 0x48;

    /// Creates encoder number `index` on a line, counted from 0.
    pub(super) fn new(config: &Config, index: u8) -> Self {
        let model = config.model;
        let types = EncoderTypes::built_in();
        let position = config.position.unwrap_or(model.position);
        let mut electronics = EncoderElectronics {
            model,
            kit: config.is_kit(&types),
            encoder_type: config.encoder_type.unwrap_or(model.encoder_type),
            serial_number: config.derive_serial_number(index),
            address: config.device_address(index),
            stored_settings: config.settings,
            memory: factory_memory(&model, config.codes),
            shaft: Shaft::new(config.geometry(&types), position, config.rpm),
            queue: StatusQueue::default(),
            wear: Wear::default(),
            counter: 0,
            temperature: config.temperature,
        };
        electronics.watch_temperature(i16::MIN);
        electronics
    }

    /// Restarts the electronics after power-on or reset. RAM content is lost, and monitoring starts again.
    pub(super) fn restart(&mut self) {
        self.queue = StatusQueue::default();
        self.watch_temperature(i16::MIN);
    }

    pub(super) fn set_temperature(&mut self, celsius: i16) {
        let before = std::mem::replace(&mut self.temperature, celsius);
        self.watch_temperature(before);
    }

    /// Returns whether the encoder supports the command. Only kit encoders support 63h.
    pub(super) fn supports(&self, command: Command) -> bool {
        command != Command::Synchronise || self.kit
    }

    /// Executes a request at time `at`, and returns the data of its reply. For 53h, it returns no data and does not
    /// restart the encoder.
    ///
    /// # Errors
    /// Returns the status code with which the encoder rejects the request. In this case, nothing has changed.
    pub(super) fn execute(&mut self, at: Moment, request: &Request) -> Result<Vec<u8>, StatusCode> {
        let data = self.execute_request(at, request)?;
        let command = request.command();
        if command.row().persistent {
            self.wear.count(command);
        }
        Ok(data)
    }

    fn execute_request(&mut self, at: Moment, request: &Request) -> Result<Vec<u8>, StatusCode> {
        match request {
            Request::ReadPosition => self.read_position(at),
            Request::SetPosition { position, code0 } | Request::Synchronise { position, code0 } => {
                if !self.shaft.can_reach(*position) {
                    return Err(StatusCode::ARGUMENT);
                }
                self.check_code0(*code0)?;
                self.shaft.set_position(at, *position);
                Ok(vec![])
            }
            Request::ReadAnalogue { channel } => {
                let [high, low] = self.analogue_value(at, *channel)?.to_be_bytes();
                Ok(vec![*channel, high, low])
            }
            Request::ReadCounter => {
                let [_, c2, c1, c0] = self.counter.to_be_bytes();
                Ok(vec![c2, c1, c0])
            }
            Request::IncrementCounter => {
                self.counter = (self.counter + 1) & Self::COUNTER_MAX;
                if self.counter == 0 {
                    self.queue.push(StatusCode::COUNTER_OVERFLOW);
                }
                Ok(vec![])
            }
            Request::ClearCounter { code0 } => {
                self.check_code0(*code0)?;
                self.counter = 0;
                Ok(vec![])
            }
            Request::ReadData { field, address, count, code } => {
                let data = self.memory.read(*field, *address, *count, *code)?;
                Ok([&[*field, *address, *count], data].concat())
            }
            Request::StoreData { field, address, code, data } => {
                self.memory.store_bytes(*field, *address, data, *code)?;
                // 4Bh carries at most 128 bytes.
                Ok(vec![*field, *address, u8::try_from(data.len()).unwrap_or(u8::MAX)])
            }
            Request::FieldStatus { field } => Ok(vec![*field, self.memory.status(*field)?.byte()]),
            Request::DefineField { field, status, code } => {
                self.memory.define_field(*field, *status, *code)?;
                Ok(vec![*field, status.byte()])
            }
            Request::FreeMemory => {
                let free = self.memory.free_memory();
                Ok(vec![free.blocks, free.fields])
            }
            Request::ChangeCode { number, old, new } => {
                self.memory.change_code(*number, *old, *new)?;
                Ok(vec![number.get()])
            }
            Request::ReadStatus => Ok(vec![self.queue.pop().byte()]),
            Request::ReadTypeLabel => {
                let Model { eeprom_units, options, .. } = self.model;
                Ok(vec![self.stored_settings.byte(), self.encoder_type, eeprom_units, options])
            }
            Request::Reset => Ok(vec![]),
            Request::SetAddress { new, code0 } => {
                self.check_code0(*code0)?;
                self.address = *new;
                Ok(vec![new.byte()])
            }
            Request::ReadSerial => Ok([
                self.serial_number.as_bytes(),
                self.model.firmware_version.as_bytes(),
                self.model.firmware_date.as_bytes(),
            ]
            .concat()),
            Request::ConfigureLine { settings, code0 } => {
                self.check_code0(*code0)?;
                self.stored_settings = *settings;
                Ok(vec![settings.byte()])
            }
            Request::ConfigureLineTemporarily { settings } => Ok(vec![settings.byte()]),
        }
    }

    /// Writes only the first half of the bytes of a store (4Bh), as in a power failure.
    ///
    /// # Errors
    /// Returns the same errors as a complete store.
    pub(super) fn store_first_half(
        &mut self,
        field: u8,
        address: u8,
        data: &[u8],
        code: AccessCode,
    ) -> Result<(), StatusCode> {
        self.memory.check_store_request(field, address, data.len(), code)?;
        let half = data.get(..data.len().div_ceil(2)).unwrap_or(data);
        self.memory.store_bytes(field, address, half, code)?;
        self.wear.count(Command::StoreData);
        Ok(())
    }

    fn read_position(&self, at: Moment) -> Result<Vec<u8>, StatusCode> {
        if self.shaft.is_too_fast() {
            return Err(StatusCode::TOO_FAST);
        }
        Ok(self.shaft.position(at).to_be_bytes().to_vec())
    }

    fn analogue_value(&self, at: Moment, channel: u8) -> Result<i16, StatusCode> {
        match channel {
            Self::SINE => Ok(self.shaft.sine_at(at)),
            Self::COSINE => Ok(self.shaft.cosine_at(at)),
            Self::TEMPERATURE => Ok(self.temperature),
            _ => Err(StatusCode::ARGUMENT),
        }
    }

    fn check_code0(&self, code0: AccessCode) -> Result<(), StatusCode> {
        self.memory.check_code(AccessCodeNumber::ZERO, code0)
    }

    /// Adds a code to the status queue if the temperature has just risen above its limit.
    fn watch_temperature(&mut self, before: i16) {
        let limit = self.model.temperature_limit;
        if before <= limit && limit < self.temperature {
            self.queue.push(StatusCode::TEMPERATURE);
        }
    }
}

/// Returns the memory as delivered by a motor manufacturer: field 0 contains the name plate, and the rest is free.
fn factory_memory(model: &Model, codes: [AccessCode; 4]) -> Memory {
    let mut memory = Memory::new(model.user_blocks);
    if let Some(size) = FieldSize::from_bytes(model.name_plate.len()) {
        let status = DataFieldStatus::new(size, AccessCodeNumber::ZERO, true);
        // If the name plate does not fit into the memory, the field is omitted.
        let _ = memory
            .define_field(0, status, AccessCode::FACTORY)
            .and_then(|()| memory.store_bytes(0, 0, model.name_plate, AccessCode::FACTORY));
    }
    if !model.extended_label.is_empty() {
        memory = memory.with_extended_label(model.extended_label);
    }
    memory.with_codes(codes)
}
