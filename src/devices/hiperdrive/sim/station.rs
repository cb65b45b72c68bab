//! An adapter or a hub with all its drives: process data, parameters, saving, loss of the master.
//!
//! Assumptions (`U`: not documented):
//! - A connection that ends for any reason is treated as a loss of the master.
//! - A packet with an idle header stops the drives, as control words of 0 do.
//! - During a save or a reset, 47 is 1 and nothing is written.
//! - A drive has its saved parameters after a reset.
//! - In an empty port, only 120 and 152 can be read. Both are 0.
//! - A string is read in elements of four characters, the first one lowest.

use std::time::Duration;

use super::axis::{Axis, SpindleLoad};
use super::config::Config;
use super::drive::Drive;
use super::memory::Memory;
use super::parameters::ParameterError;
use super::write_fault::{ActiveWriteFault, WriteFault};
use crate::devices::hiperdrive::protocol::drive_parameter::{DRIVE_REQUESTED, MAXIMUM_SPEED, SERVICE, VARIANT};
use crate::devices::hiperdrive::protocol::{
    ActualValues, DriveNumber, Family, InputImage, OutputData, OutputImage, ParameterAccess, ParameterNumber,
    ParameterRow, Pkw, Topology, Travel, Value, Variant,
};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq)]
pub struct StationConfig {
    pub topology: Topology,
    /// Drives by port. An empty port is `None`.
    pub drives: Vec<Option<(Variant, SpindleLoad)>>,
    /// Serial number, parameter 17.
    pub serial_number: u16,
}

#[derive(Clone, Debug)]
pub struct Station {
    setup: StationConfig,
    drives: Vec<Option<Drive>>,
    memory: Memory,
    master: Option<Master>,
    busy_until: Moment,
    /// Time at which the last write is answered, if it resets drives.
    answers_at: Option<Moment>,
    /// Last received parameter words, and the current answer to them.
    words: (Pkw, Pkw),
    /// Next answer, and the time at which it appears in the process data.
    answers: Option<(Moment, Pkw)>,
    resets: Duration,
    plate: StationIdentity,
    store: Store,
    hindered: ActiveWriteFault,
}

/// Identity data that are not part of [`StationConfig`].
#[derive(Clone, Debug)]
struct StationIdentity {
    name: String,
    switch: u8,
    supply_tenths: u16,
}

/// State of saving, which can be interrupted by a loss of supply.
#[derive(Clone, Copy, Debug, Default)]
struct Store {
    count: u32,
    /// Number of the save during which the supply fails, counted from 1.
    failing_save: Option<u32>,
    dies_at: Option<Moment>,
    /// Whether the supply was lost.
    dead: bool,
}

#[derive(Clone, Copy, Debug)]
struct Master {
    timeout: Duration,
    heard: Moment,
}

/// Duration of a save. It is within the limit in the manual.
const SAVE_TIME: Duration = Duration::from_millis(150);
/// Duration of a reset of all drives, unless the settings give another.
pub(super) const RESET_TIME: Duration = Duration::from_secs(1);
const DRIVE_RESETS: Duration = Duration::from_millis(300);

impl Default for StationConfig {
    /// Creates an adapter with an HDA30A drive.
    fn default() -> Self {
        let drives = vec![Some((Variant::new(7), SpindleLoad::default()))];
        StationConfig { topology: Topology::Adapter, drives, serial_number: 4711 }
    }
}

impl Station {
    /// Creates a station with factory settings, switched on at time zero.
    pub fn new(setup: StationConfig) -> Self {
        let places = setup.drives.iter().copied().chain(std::iter::repeat(None));
        let drives = places
            .take(setup.topology.drives().into())
            .map(|place| place.map(|(variant, load)| Drive::new(variant, setup.topology, load)))
            .collect();
        let memory = Memory::new(setup.topology, Family::Short, |row| row.number < 100);
        let plate = StationIdentity { name: "HIPERDRIVE".to_owned(), switch: 0, supply_tenths: 240 };
        Station {
            setup,
            drives,
            memory,
            master: None,
            busy_until: Moment::START,
            answers_at: None,
            words: Default::default(),
            answers: None,
            resets: RESET_TIME,
            plate,
            store: Store::default(),
            hindered: ActiveWriteFault::default(),
        }
    }

    pub fn from_config(config: &Config) -> Self {
        let drives = DriveNumber::all_in_topology(config.topology).map(|number| config.drive(number)).collect();
        let setup = StationConfig { topology: config.topology, drives, serial_number: config.serial_number };
        let mut station = Station::new(setup);
        station.plate = StationIdentity {
            name: config.name.clone(),
            switch: config.switch,
            supply_tenths: config.supply_in_tenths_of_volt(),
        };
        station.store.failing_save = config.faults.save_with_power_failure();
        station.resets = config.resets;
        for drive in station.present_drives() {
            drive.axis = Axis::at_position(config.position.into());
            config.requested.iter().for_each(|requested| drive.memory.preset(DRIVE_REQUESTED, i64::from(*requested)));
            config.speed.iter().for_each(|speed| drive.memory.preset(MAXIMUM_SPEED, i64::from(*speed)));
        }
        station.set_drive_select_switch(Moment::START, config.s3);
        station
    }

    pub const fn topology(&self) -> Topology {
        self.setup.topology
    }

    /// Returns the number of saves so far, including interrupted ones.
    pub const fn save_count(&self) -> u32 {
        self.store.count
    }

    /// Returns whether the supply has failed. The station then does not reply until [`power_cycle`](Self::power_cycle)
    /// is called.
    pub fn is_dead(&mut self, now: Moment) -> bool {
        self.advance_to(now);
        self.store.dead
    }

    /// Makes the supply fail during the save with this number, counted from 1. `None` removes the failure.
    pub const fn set_failing_save(&mut self, number: Option<u32>) {
        self.store.failing_save = number;
    }

    /// Injects a fault that affects writes of a parameter. `None` removes the fault and restores a lost line.
    pub const fn set_write_fault(&mut self, what: Option<(ParameterNumber, WriteFault)>) {
        self.hindered = ActiveWriteFault::new(what);
    }

    pub(super) const fn is_cut_off(&self) -> bool {
        self.hindered.is_cut_off()
    }

    pub fn drive(&mut self, number: DriveNumber) -> Option<&mut Drive> {
        self.drives.get_mut(usize::from(number.get()) - 1)?.as_mut()
    }

    /// Records that a master has opened the cyclic connection. The connection is lost if no packet arrives for the
    /// given time.
    pub fn open(&mut self, now: Moment, timeout: Duration) {
        self.advance_to(now);
        self.master = Some(Master { timeout, heard: now });
    }

    pub fn close(&mut self, now: Moment) {
        self.advance_to(now);
        if self.master.take().is_some() {
            self.present_drives().for_each(|drive| drive.handle_master_loss(now));
        }
    }

    pub fn is_open(&mut self, now: Moment) -> bool {
        self.advance_to(now);
        self.master.is_some()
    }

    /// Handles process data. They are dropped if no connection is open or the drives are being reset.
    pub fn handle_process_data(&mut self, now: Moment, image: &OutputImage, runs: bool) {
        self.advance_to(now);
        let Some(master) = &mut self.master else { return };
        master.heard = now;
        if now < self.busy_until {
            return;
        }
        for (drive, out) in self.drives.iter_mut().zip(&image.drives) {
            let out = if runs { *out } else { OutputData { control: 0, ..*out } };
            if let Some(drive) = drive {
                drive.command(now, out);
            }
        }
        if let Some(request) = image.pkw.filter(|request| *request != self.words.0) {
            self.words.0 = request;
            let answer = self.reply_to(now, request);
            self.answers = Some((self.delayed_reply_time().unwrap_or(now), answer));
        }
    }

    pub fn image(&mut self, now: Moment) -> InputImage {
        self.advance_to(now);
        if let Some((_, answer)) = self.answers.take_if(|(at, _)| *at <= now) {
            self.words.1 = answer;
        }
        let actual = |drive: &mut Option<Drive>| {
            drive.as_mut().map_or(ActualValues::default(), |drive| drive.actual_values(now))
        };
        InputImage { drives: self.drives.iter_mut().map(actual).collect(), pkw: Some(self.words.1) }
    }

    /// Sets switch S3. Drives can be moved over the bus only in position 0.
    pub fn set_drive_select_switch(&mut self, now: Moment, position: u8) {
        self.advance_to(now);
        self.present_drives().for_each(|drive| drive.set_motion_allowed(position == 0));
    }

    pub fn power_cycle(&mut self, now: Moment) {
        self.advance_to(now);
        self.memory.handle_restart();
        (self.master, self.busy_until, self.words) = (None, now, Default::default());
        (self.answers_at, self.answers) = (None, None);
        (self.store.dies_at, self.store.dead) = (None, false);
        self.reset(now);
    }

    /// Reads a parameter.
    ///
    /// # Errors
    /// Returns [`ParameterError`] for an unknown parameter or a parameter of a missing drive.
    pub fn read(&mut self, now: Moment, number: ParameterNumber) -> Result<Value, ParameterError> {
        self.advance_to(now);
        self.answers_at = None;
        let row = number.row().ok_or(ParameterError::Unknown)?;
        let Some(drive) = number.drive() else {
            return self.read_device_value(now, row).ok_or(ParameterError::Unknown);
        };
        if drive.get() > self.setup.topology.drives() {
            return Err(ParameterError::Unknown);
        }
        match (self.drive(drive), row.number) {
            (Some(drive), own) => drive.read(now, own).ok_or(ParameterError::Unknown),
            (None, VARIANT | DRIVE_REQUESTED) => Ok(Value::Number(0)),
            (None, _) => Err(ParameterError::State),
        }
    }

    /// Returns when the last write is answered, if its reply is delayed.
    pub const fn delayed_reply_time(&mut self) -> Option<Moment> {
        self.answers_at.take()
    }

    /// Writes a parameter.
    ///
    /// # Errors
    /// Returns a [`ParameterError`] if the write is rejected. In this case, nothing has been written.
    pub fn write(&mut self, now: Moment, number: ParameterNumber, value: &Value) -> Result<(), ParameterError> {
        self.advance_to(now);
        self.answers_at = None;
        self.hindered.write(number)?;
        let row = number.row().ok_or(ParameterError::Unknown)?;
        let place = number.drive().filter(|drive| drive.get() > self.setup.topology.drives());
        match (row.access, place, value) {
            (_, Some(_), _) => Err(ParameterError::Unknown),
            (ParameterAccess::Read, ..) => Err(ParameterError::ReadOnly),
            _ if now < self.busy_until => Err(ParameterError::State),
            (_, _, Value::Text(_)) => Err(ParameterError::Value),
            (_, _, Value::Number(value)) => self.write_number(now, number, row, *value),
        }
    }

    fn write_number(
        &mut self,
        now: Moment,
        own: ParameterNumber,
        row: &ParameterRow,
        value: i64,
    ) -> Result<(), ParameterError> {
        match own.drive() {
            Some(number) => {
                let drive = self.drive(number).ok_or(ParameterError::State)?;
                if row.check_value(own, value, drive.travel()).is_err() {
                    return Err(drive.state_rejection());
                }
                let resets = drive.resets_drive(row.number, value);
                drive.write(now, row.number, value)?;
                self.answers_at = resets.then(|| now + DRIVE_RESETS);
                Ok(())
            }
            None if row.check_value(own, value, Travel::UNKNOWN).is_err() => Err(ParameterError::Value),
            None if own == ParameterNumber::SAVE => {
                self.save_or_reset(now, value);
                Ok(())
            }
            None => {
                self.memory.set_value(row.number, value);
                Ok(())
            }
        }
    }

    /// Handles a write to parameter 47.
    fn save_or_reset(&mut self, now: Moment, value: i64) {
        if value == -4 {
            self.reset(now);
            self.busy_until = now + self.resets;
            self.answers_at = Some(self.busy_until);
            return;
        }
        let mut save: fn(&mut Memory) = Memory::save;
        if matches!(value, 1 | -3) {
            self.store.count = self.store.count.saturating_add(1);
            if self.store.failing_save == Some(self.store.count) {
                (self.store.dies_at, save) = (Some(now + SAVE_TIME / 2), Memory::save_partially);
            }
        }
        let each = |memory: &mut Memory| match value {
            1 => save(memory),
            -1 => memory.reset_device_values(),
            -2 => memory.restore_saved(),
            -3 => {
                memory.restore_factory();
                save(memory);
            }
            _ => {}
        };
        self.present_drives().for_each(|drive| {
            each(&mut drive.memory);
            if value == -3 {
                drive.invalidate_position();
            }
        });
        each(&mut self.memory);
        self.busy_until = now + SAVE_TIME;
    }

    fn reset(&mut self, now: Moment) {
        self.present_drives().for_each(|drive| {
            drive.memory.handle_restart();
            drive.reset(now);
        });
    }

    fn read_device_value(&self, now: Moment, row: &ParameterRow) -> Option<Value> {
        let text = |text: &str| Some(Value::Text(text.to_owned()));
        let number = match row.number {
            9 => self.plate.supply_tenths.into(),
            11 => 31,
            12 => self.plate.switch.into(),
            13 => return text(self.setup.topology.category()),
            15 => return text(&self.plate.name),
            16 => return text("7800.0100"),
            17 => self.setup.serial_number.into(),
            18 => return text("14/2024"),
            19 => return text("1.02"),
            SERVICE => i64::from(now < self.busy_until),
            number => self.memory.get(number)?,
        };
        Some(Value::Number(number))
    }

    fn present_drives(&mut self) -> impl Iterator<Item = &mut Drive> {
        self.drives.iter_mut().flatten()
    }

    /// Processes all events due by now, such as a failure of the supply during a save or a time-out of the master. Each
    /// takes effect at its own time.
    fn advance_to(&mut self, now: Moment) {
        if let Some(at) = self.store.dies_at.take_if(|at| *at <= now) {
            self.store.dead = true;
            self.master = None;
            self.present_drives().for_each(|drive| drive.reset(at));
        }
        let Some(Master { timeout, heard }) = self.master else { return };
        if now.duration_since(heard) >= timeout {
            self.master = None;
            self.present_drives().for_each(|drive| drive.handle_master_loss(heard + timeout));
        }
    }
}
