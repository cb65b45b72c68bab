//! Tests of the virtual drives against the reference, in virtual time: control words and the replies to them.

mod faults;
mod motion;
mod parameters;

use std::time::Duration;

use super::{Drive, SpindleLoad, Station, StationConfig};
use crate::devices::hiperdrive::protocol::{
    ActualValues, DriveNumber, ErrorCode, OutputData, OutputImage, ParameterNumber, Pkw, Topology, Value, Variant,
};
use crate::units::Moment;

/// A station with a master that sends process data every 10 ms.
struct Bench {
    station: Station,
    now: Moment,
    out: Vec<OutputData>,
    pkw: Option<Pkw>,
}

const FIRST: usize = 0;

impl Bench {
    fn new(setup: StationConfig) -> Self {
        let drives = usize::from(setup.topology.drives());
        let mut station = Station::new(setup);
        station.open(Moment::START, Duration::from_millis(40));
        let out = OutputData { speed: 100, torque: 100, ..OutputData::default() };
        Bench { station, now: Moment::START, out: vec![out; drives], pkw: None }
    }

    fn single() -> Self {
        Bench::new(StationConfig::default())
    }

    /// Creates a four-port hub with drives on the first two ports.
    fn hub() -> Self {
        let drive = Some((Variant::new(13), SpindleLoad::default()));
        Bench::new(StationConfig { topology: Topology::Hub4, drives: vec![drive, drive], serial_number: 1 })
    }

    fn cycle(&mut self) {
        let image = OutputImage { drives: self.out.clone(), pkw: self.pkw };
        self.station.handle_process_data(self.now, &image, true);
        self.now = self.now + Duration::from_millis(10);
    }

    fn run(&mut self, ms: u64) {
        (0..ms / 10).for_each(|_| self.cycle());
    }

    /// Sends a control word for 30 ms and returns the status of the first drive.
    fn word(&mut self, control: u16) -> u16 {
        self.out[FIRST].control = control;
        self.run(30);
        self.actual(FIRST).status.to_u16()
    }

    fn words(&mut self, controls: &[u16]) -> u16 {
        controls.iter().fold(0, |_, control| self.word(*control))
    }

    fn enable(&mut self) {
        assert_eq!(self.words(&[0x0000, 0x0400, 0x0401, 0x0409]), 0x2A37);
    }

    /// Enables the drive and starts a move to a target.
    fn start(&mut self, target: i32) {
        self.enable();
        self.word(0x0439);
        self.out[FIRST].target = target;
        assert_eq!(self.word(0x0479) & 0xF03F, 0x1037, "moving, acknowledged");
    }

    fn actual(&mut self, drive: usize) -> ActualValues {
        self.station.image(self.now).drives[drive]
    }

    fn position(&mut self) -> i32 {
        self.actual(FIRST).position
    }

    /// Runs cycles until the first drive reports this status, and returns the time taken.
    fn until(&mut self, status: u16) -> u64 {
        for ms in (0..120_000).step_by(10) {
            if self.actual(FIRST).status.to_u16() == status {
                return ms;
            }
            self.cycle();
        }
        panic!("{status:04X} never comes, but {:04X}", self.actual(FIRST).status.to_u16());
    }

    fn drive(&mut self) -> &mut Drive {
        self.station.drive(DriveNumber::FIRST).unwrap()
    }

    fn load(&mut self, load: SpindleLoad) {
        let now = self.now;
        self.drive().set_load(now, load);
    }

    fn read(&mut self, own: u16) -> Value {
        self.station.read(self.now, number(own)).unwrap()
    }

    fn write(&mut self, own: u16, value: i64) -> Result<(), super::ParameterError> {
        self.station.write(self.now, number(own), &Value::Number(value))
    }

    /// Returns the newest error.
    fn error(&mut self) -> ErrorCode {
        match self.read(108) {
            Value::Number(code) => ErrorCode::new(code.try_into().unwrap()),
            Value::Text(text) => panic!("{text}"),
        }
    }
}

fn number(own: u16) -> ParameterNumber {
    ParameterNumber::new(own).unwrap()
}
