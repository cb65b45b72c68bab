//! The virtual encoder without its line: the effects of reads and writes (manual 4, 6 and appendix).
//!
//! ```text
//! operation ── password, mode ──▶ mode m ── mode 00 ──▶ operation
//!                                   └── save or preset of modes 05, 07 ──▶ restart (silent) ──▶ operation
//! ```
//! The manual leaves some rules open (`U`). In this model, a mode can only be entered from operation, and can be left
//! without the password. Undescribed registers read as 00h and cannot be written. Entered values are discarded when the
//! mode is left.

mod registers;
mod time;

use std::time::Duration;

use super::calibration::{Calibration, CalibrationConditions, RunOutcome};
use super::config::Config;
use super::entry::{Area, DataEntry, EntryEffect, FilterEntry, PresetEntry};
use super::flash::Flash;
use super::motor::Drive;
use super::shaft::{FRACTIONAL_BITS, Shaft};
use super::wiegand::{WiegandPulses, WiegandState};
use crate::devices::biss::protocol::{
    CalibrationStatus, DeviceMode, Eds, EdsBank, ErrorRegister, Firmware, Layout, PositionData, RegisterAddress,
    WiegandCommand, WiegandStatus,
};
use crate::sim::{Motor, SimulatedFaults};
use crate::units::Moment;

#[derive(Clone, Debug)]
pub struct Encoder {
    firmware: Firmware,
    serial_number: u32,
    waver: f64,
    pulses: WiegandPulses,
    silent_calibration: bool,
    die_in_store: Option<u32>,
    eds: [Eds; 2],
    drive: Drive,
    shaft: Shaft,
    celsius: i16,
    errors: ErrorRegister,
    hot: bool,
    power: Power,
    bank: u8,
    password: u8,
    mode: DeviceMode,
    flash: Flash,
    /// Saved result of the Wiegand test, as read when the encoder started.
    saved_wiegand: [u8; 4],
    calibration: Calibration,
    wiegand: WiegandState,
    data: DataEntry,
    filter: FilterEntry,
    preset: PresetEntry,
    stores_begun: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Power {
    Off,
    Starting { ready: Moment },
    On,
}

impl Encoder {
    /// Time from power-up until registers can be accessed, 500 ms (data sheet, 02:0Eh).
    pub(super) const START: Duration = Duration::from_millis(500);
    const MAX_BANK: u8 = 0x43;
    /// Temperature in degrees Celsius at which the warning is set. The warning is cleared below 123 °C (manual 6.8).
    const HOT: i16 = 125;
    const COOLDOWN_CELSIUS: i16 = 123;
    const MIN_DIAGNOSTICS_FIRMWARE: Firmware = Firmware::new(1, 6, 0);
    const PRESET_PARTS_SINCE: Firmware = Firmware::new(1, 6, 0);
    const MIN_PRESET_FIRMWARE: Firmware = Firmware::new(1, 2, 0);
    const MIN_FILTER_FIRMWARE: Firmware = Firmware::new(1, 1, 0);

    /// Creates an encoder that has been on for a long time.
    pub fn new(config: &Config) -> Self {
        let flash = Flash { filter: config.filter, ..Flash::factory_default(config.cycles) };
        let mut encoder = Encoder {
            firmware: config.firmware,
            serial_number: config.serial_number,
            waver: config.waver,
            pulses: config.pulses,
            silent_calibration: config.silent_calibration,
            die_in_store: config.faults.save_with_power_failure(),
            eds: [EdsBank::Common, EdsBank::Encoder].map(Eds::factory_default),
            drive: Drive::new(config.rpm, config.reverses),
            shaft: Shaft::new(Layout::default(), config.position, config.rpm),
            celsius: config.temperature,
            errors: ErrorRegister::new(config.errors),
            hot: false,
            power: Power::On,
            bank: 0,
            password: 0,
            mode: DeviceMode::OPERATION,
            saved_wiegand: flash.wiegand,
            calibration: Calibration::new(config.calibration_time, config.keeps_status),
            wiegand: WiegandState::new(),
            data: DataEntry::default(),
            filter: FilterEntry::default(),
            preset: PresetEntry::new(flash.preset),
            flash,
            stores_begun: 0,
        };
        encoder.watch_temperature();
        encoder
    }

    pub const fn flash(&self) -> &Flash {
        &self.flash
    }

    pub const fn layout(&self) -> &Layout {
        self.shaft.layout()
    }

    pub const fn mode(&self) -> DeviceMode {
        self.mode
    }

    pub fn motor(&self) -> Motor {
        self.drive.motor().clone()
    }

    pub fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.drive.motor().set_rpm(rpm);
        self.update(now);
    }

    pub fn set_temperature(&mut self, celsius: i16) {
        self.celsius = celsius;
        self.watch_temperature();
    }

    /// Replaces the simulated faults of the flash, but keeps the count of stores.
    pub fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.die_in_store = faults.save_with_power_failure();
    }

    /// Sets the errors that the encoder reports from its self-monitoring.
    pub fn set_errors(&mut self, errors: ErrorRegister) {
        self.errors = errors;
    }

    pub fn power_cycle(&mut self, now: Moment) {
        self.update(now);
        self.disconnect();
        self.start(now);
    }

    pub fn disconnect(&mut self) {
        self.abort_mode();
        self.power = Power::Off;
    }

    pub fn connect(&mut self, now: Moment) {
        if self.power == Power::Off {
            self.start(now);
        }
    }

    /// Returns whether the encoder has power, even if it is still starting.
    pub fn has_power(&self) -> bool {
        self.power != Power::Off
    }

    /// Returns whether registers can be read at `now`. The encoder is silent while starting, and may be silent during
    /// calibration.
    pub fn can_access_registers(&mut self, now: Moment) -> bool {
        self.update(now);
        self.power == Power::On && !(self.silent_calibration && self.calibration.is_running())
    }

    /// Returns the position at `now`, or `None` without power or during start-up. During a calibration, the position is
    /// marked as invalid.
    pub fn position_at(&mut self, now: Moment) -> Option<PositionData> {
        self.update(now);
        let reading = self.shaft.position_at(now);
        let error = self.errors != ErrorRegister::default() || self.calibration.is_running();
        (self.power == Power::On).then_some(PositionData { error, warning: self.hot, ..reading })
    }

    /// Returns the shaft position at `now` and the number of steps per revolution, even if the encoder does not report
    /// a position.
    pub fn shaft_position(&mut self, now: Moment) -> (u64, u64) {
        self.update(now);
        (self.shaft.fractional_position_at(now), 1 << (self.shaft.layout().singleturn_bits() + FRACTIONAL_BITS))
    }

    pub const fn bank(&self) -> u8 {
        self.bank
    }

    /// Resolves an address from a control frame, using the selected bank.
    pub fn address(&self, address: u8) -> Option<RegisterAddress> {
        if address < RegisterAddress::BANK_SIZE {
            RegisterAddress::in_bank(self.bank, address)
        } else {
            RegisterAddress::direct_register(address)
        }
    }

    /// Reads a register at `now`. Returns `None` if its bank does not exist.
    pub fn read(&mut self, now: Moment, address: RegisterAddress) -> Option<u8> {
        self.update(now);
        let offset = address.address();
        let value = match address.bank() {
            None => self.direct_register(offset),
            Some(0x00) => self.bank_0_register(offset),
            Some(0x01) => self.preset_register(offset),
            Some(bank @ (0x02 | 0x03)) => {
                let [common, encoder] = &self.eds;
                let eds = if bank == EdsBank::Common.kit_number() { common } else { encoder };
                eds.emit().get(usize::from(offset)).copied().unwrap_or(0)
            }
            Some(bank) if bank <= Self::MAX_BANK => {
                let (area, begin) = Area::find_bank_area(bank)?;
                let at = begin + usize::from(offset);
                self.data.byte(area, at).or_else(|| self.area_bytes(area).get(at).copied())?
            }
            Some(_) => return None,
        };
        Some(value)
    }

    /// Writes a register at `now`. Returns `false`, without any effect, if the encoder rejects the request.
    pub fn write(&mut self, now: Moment, address: RegisterAddress, value: u8) -> bool {
        self.update(now);
        let offset = address.address();
        let accepted = match (address.bank(), offset) {
            (None, 0x40) => {
                self.bank = value;
                true
            }
            (None, 0x6A) => self.change_mode(DeviceMode::new(value)),
            (None, 0x6B) => {
                self.password = value;
                true
            }
            (Some(0x00), 0x00) if self.mode == DeviceMode::CALIBRATION => {
                let conditions = self.calibration_conditions();
                self.calibration.write(now, value, conditions)
            }
            (Some(0x00), 0x06) if self.mode == DeviceMode::WIEGAND_TEST => self.wiegand_command(now, value),
            (Some(0x00), 0x1A) if self.mode == DeviceMode::DATA_WRITE => {
                let then = self.data.command(value);
                self.apply_effect(now, then)
            }
            (Some(0x00), 0x24) if self.mode == DeviceMode::FILTER => {
                let then = self.filter.command(value);
                self.apply_effect(now, then)
            }
            (Some(0x01), 0x00) if self.mode == DeviceMode::PRESET => {
                let parts = self.firmware >= Self::PRESET_PARTS_SINCE;
                let then = self.preset.command(value, parts, self.shaft.layout());
                self.apply_effect(now, then)
            }
            (Some(0x01), 0x02..=0x07) if self.mode == DeviceMode::PRESET => {
                self.preset.enter(usize::from(offset - 2), value)
            }
            (Some(bank), _) => Area::find_bank_area(bank)
                .is_some_and(|(area, begin)| self.data.enter(area, begin + usize::from(offset), value)),
            _ => false,
        };
        self.update(now);
        accepted
    }

    fn area_bytes(&self, area: Area) -> &[u8] {
        match area {
            Area::Motor => &self.flash.motor_data,
            Area::Oem => &self.flash.oem_data,
        }
    }

    fn calibration_conditions(&self) -> CalibrationConditions {
        CalibrationConditions {
            rpm: self.shaft.rpm(),
            waver: self.waver,
            celsius: self.celsius,
            filter: self.flash.filter,
        }
    }

    fn change_mode(&mut self, mode: DeviceMode) -> bool {
        let there = match mode {
            DeviceMode::FILTER => self.firmware >= Self::MIN_FILTER_FIRMWARE,
            DeviceMode::PRESET => self.firmware >= Self::MIN_PRESET_FIRMWARE,
            _ => mode.is_known(),
        };
        let opened = self.password == DeviceMode::PASSWORD;
        let may = opened && (mode == self.mode || self.mode == DeviceMode::OPERATION);
        if !there || !(may || mode == DeviceMode::OPERATION) {
            return false;
        }
        if mode != self.mode {
            self.abort_mode();
            self.mode = mode;
        }
        true
    }

    fn wiegand_command(&mut self, now: Moment, value: u8) -> bool {
        if WiegandCommand::from_byte(value) != WiegandCommand::Save {
            return self.wiegand.write(now, value);
        }
        if self.wiegand.status != WiegandStatus::Complete {
            return false;
        }
        let result = self.wiegand.result;
        self.wiegand.command = value;
        self.write_flash(|flash, whole| {
            if whole {
                flash.wiegand = result;
            }
        });
        true
    }

    fn apply_effect(&mut self, now: Moment, then: EntryEffect) -> bool {
        match then {
            EntryEffect::Refused => return false,
            EntryEffect::Nothing => {}
            EntryEffect::Open(area) => {
                let bytes = self.area_bytes(area).to_vec();
                self.data.open(area, bytes);
            }
            EntryEffect::SaveData(area, bytes) => {
                self.write_flash(|flash, whole| {
                    let place = match area {
                        Area::Motor => &mut flash.motor_data,
                        Area::Oem => &mut flash.oem_data,
                    };
                    let count = if whole { bytes.len() } else { bytes.len() / 2 };
                    place.iter_mut().zip(bytes.into_iter().take(count)).for_each(|(old, new)| *old = new);
                });
            }
            EntryEffect::SaveFilter(filter) => self.write_flash_and_restart(now, |flash| flash.filter = filter),
            EntryEffect::SavePreset(preset) => self.write_flash_and_restart(now, |flash| flash.preset = preset),
            EntryEffect::Preset { singleturn, multiturn } => {
                let preset = self.flash.preset;
                self.write_flash_and_restart(now, |_| {});
                if self.power != Power::Off {
                    let (own_singleturn, own_multiturn) = (preset.singleturn(), preset.multiturn());
                    self.shaft.preset(now, singleturn.then_some(own_singleturn), multiturn.then_some(own_multiturn));
                }
            }
        }
        true
    }

    /// Writes the flash once. The second argument of `change` is `false` if power fails during the write.
    fn write_flash(&mut self, change: impl FnOnce(&mut Flash, bool)) {
        self.stores_begun = self.stores_begun.saturating_add(1);
        self.flash.cycles = self.flash.cycles.saturating_add(1);
        let whole = self.die_in_store != Some(self.stores_begun);
        change(&mut self.flash, whole);
        if !whole {
            self.disconnect();
        }
    }

    fn write_flash_and_restart(&mut self, now: Moment, change: impl FnOnce(&mut Flash)) {
        self.write_flash(|flash, whole| {
            if whole {
                change(flash);
            }
        });
        if self.power != Power::Off {
            self.start(now);
        }
    }

    /// Starts the encoder and clears its volatile memory.
    fn start(&mut self, now: Moment) {
        self.abort_mode();
        self.power = Power::Starting { ready: now + Self::START };
        (self.bank, self.password, self.mode) = (0, 0, DeviceMode::OPERATION);
        self.calibration.status = CalibrationStatus::Idle;
        self.wiegand = WiegandState::new();
        self.saved_wiegand = self.flash.wiegand;
    }

    fn abort_mode(&mut self) {
        if self.calibration.abort() == RunOutcome::Lost {
            self.flash.calibrated = false;
        }
        self.wiegand.abort();
        self.data = DataEntry::default();
        self.filter = FilterEntry::default();
        self.preset = PresetEntry::new(self.flash.preset);
    }

    fn watch_temperature(&mut self) {
        self.hot = self.celsius >= Self::HOT || (self.hot && self.celsius >= Self::COOLDOWN_CELSIUS);
    }
}
