//! A test bench for a virtual drive with its dead-man control, run cycle by cycle.

use std::collections::VecDeque;
use std::time::Duration;

use encoder_studio::devices::hiperdrive::procedures::dead_man::{
    ActionEnd, DeadMan, MotionIntent, MotionRequest, Permit,
};
use encoder_studio::devices::hiperdrive::protocol::{
    ActualValues, ControlBit, ControlWord, DriveNumber, ErrorCode, OutputImage, ParameterNumber, Setpoint, State, Value,
};
use encoder_studio::devices::hiperdrive::sim::{SpindleLoad, Station, StationConfig};
use encoder_studio::units::Moment;

pub(super) const INTERVAL: Duration = Duration::from_millis(10);
/// Watchdog time of the connection, which is eight intervals.
const TIMEOUT: Duration = Duration::from_millis(80);

/// A drive with its dead-man control. The user's request is refreshed unless `absent` is set.
pub(super) struct Bench {
    pub(super) station: Station,
    pub(super) man: DeadMan,
    pub(super) now: Moment,
    pub(super) intent: MotionIntent,
    pub(super) permit: Permit,
    /// Whether the user's request is no longer refreshed.
    pub(super) absent: bool,
    /// Whether control words are lost on their way to the drive.
    pub(super) cut_out: bool,
    /// Whether the drive's reports are lost.
    pub(super) cut_back: bool,
    /// Delay of reports in cycles.
    pub(super) late: usize,
    /// Reports that replace the drive's, as if it were jogging without a command.
    pub(super) heard: Option<ActualValues>,
    reports: VecDeque<ActualValues>,
    words: Vec<u16>,
    before: ControlWord,
}

impl Bench {
    pub(super) fn new() -> Self {
        let mut station = Station::new(StationConfig::default());
        station.open(Moment::START, TIMEOUT);
        let intent = MotionIntent::idle(DriveNumber::FIRST, 7, Moment::START);
        Bench {
            station,
            man: DeadMan::new(DriveNumber::FIRST, 7),
            now: Moment::START,
            intent,
            permit: Permit::for_range(-20_000_000, 20_000_000),
            absent: false,
            cut_out: false,
            cut_back: false,
            late: 0,
            heard: None,
            reports: VecDeque::new(),
            words: Vec::new(),
            before: ControlWord::OFF,
        }
    }

    /// Makes a request as the user would and returns the number of the action.
    pub(super) fn act(&mut self, wish: MotionRequest) -> u64 {
        let number = self.intent.number + 1;
        self.intent = MotionIntent { drive: DriveNumber::FIRST, request: wish, number, refreshed: self.now };
        number
    }

    /// Runs one interval, then checks and returns the set-point sent.
    pub(super) fn cycle(&mut self) -> Setpoint {
        if !self.absent {
            self.intent.refreshed = self.now;
        }
        let fresh = !self.intent.is_stale(self.now);
        let spent = self.man.last_end().map_or(7, |(number, _)| number);
        let report = self.station.image(self.now).drives[0];
        self.reports.push_back(report);
        let heard = (self.reports.len() > self.late).then(|| self.reports.pop_front()).flatten();
        let heard = heard.filter(|_| !self.cut_back);
        let setpoint = self.man.next(self.now, self.heard.or(heard), &self.intent, &self.permit);
        let word = setpoint.control;
        assert!(!word.is_set(ControlBit::JogOne) && !word.is_set(ControlBit::JogTwo), "{word:?}");
        if let Some(begins) = word.motion_start(self.before, report.status) {
            let wish = self.intent.request;
            let act = fresh && wish.needs_motion() && self.intent.number > spent && self.permit.locks.is_empty();
            assert!(act, "{begins:?} by {word:?} behind {:?}, {:?} is wanted", self.before, self.intent);
        }
        if !self.cut_out {
            let image = OutputImage { drives: vec![setpoint.into()], pkw: None };
            self.station.handle_process_data(self.now, &image, true);
            self.before = word;
        }
        if self.words.last() != Some(&word.to_u16()) {
            self.words.push(word.to_u16());
        }
        self.now = self.now + INTERVAL;
        setpoint
    }

    pub(super) fn run(&mut self, ms: u64) {
        (0..ms / 10).for_each(|_| {
            self.cycle();
        });
    }

    /// Runs until the last action has ended and returns the outcome.
    pub(super) fn until_over(&mut self) -> ActionEnd {
        for _ in 0..6000 {
            self.cycle();
            if let Some((number, ended)) = self.man.last_end()
                && number >= self.intent.number
            {
                return ended;
            }
        }
        panic!("it never ends: {:?} {:?}", self.man.phase(), self.actual());
    }

    /// Returns the actual values of the drive.
    pub(super) fn actual(&mut self) -> ActualValues {
        self.station.image(self.now).drives[0]
    }

    pub(super) fn status(&mut self) -> u16 {
        self.actual().status.to_u16()
    }

    pub(super) fn position(&mut self) -> i32 {
        self.actual().position
    }

    pub(super) fn moves(&mut self) -> bool {
        let actual = self.actual();
        actual.speed != 0 || actual.status.state() == State::Moving
    }

    /// Returns the words sent since the previous call without repetitions, starting with the word in effect at that
    /// call.
    pub(super) fn take_words(&mut self) -> Vec<u16> {
        let last = self.words.last().copied();
        std::mem::replace(&mut self.words, last.into_iter().collect())
    }

    pub(super) fn fail(&mut self, code: ErrorCode) {
        let now = self.now;
        self.station.drive(DriveNumber::FIRST).unwrap().inject_error(now, code);
    }

    pub(super) fn load(&mut self, load: SpindleLoad) {
        let now = self.now;
        self.station.drive(DriveNumber::FIRST).unwrap().set_load(now, load);
    }

    pub(super) fn write(&mut self, number: u16, value: i64) {
        let number = ParameterNumber::new(number).unwrap();
        self.station.write(self.now, number, &Value::Number(value)).unwrap();
    }

    /// Restarts the drives with 47 = −4 while the connection stays open. Words are rejected meanwhile.
    pub(super) fn reset(&mut self) {
        let _ = self.station.write(self.now, ParameterNumber::SAVE, &Value::Number(-4));
    }

    /// Reopens the connection without any user action.
    pub(super) fn reconnect(&mut self) {
        self.station.close(self.now);
        self.station.open(self.now, TIMEOUT);
        self.man = DeadMan::new(DriveNumber::FIRST, self.intent.number);
        self.before = ControlWord::OFF;
        self.reports.clear();
    }
}
