//! A virtual drive: how it responds to control words, moves and fails (reference, sections 2 to 5).
//!
//! Assumptions (`U`: not documented):
//! - Words with reserved bits are ignored.
//! - At 0 % speed or torque nothing starts, and there is no error.
//! - A drive never leaves "not ready" if it is not requested (152 = 0) or if S3 selects it.
//! - A target beyond the limits is fault 8503.
//! - A blocked drive fails after 200 ms (8300, 8301), a drive that is too weak after 500 ms (8203), and a drive hotter
//!   than 80 °C immediately (8202).
//! - The loss of the master is fault 8601.
//! - A moving drive that leaves the operational state brakes as for a stop.

use std::collections::VecDeque;

use super::axis::{Axis, AxisSetpoint, DriveDefect, SpindleLoad, TICK, TURN, TickOutcome};
use super::memory::Memory;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, MAXIMUM_SPEED, NUMERATOR, SPEED_DENOMINATOR, SPEED_NUMERATOR,
    UPPER_LIMIT,
};
use crate::devices::hiperdrive::protocol::{
    ActualValues, ControlBit, ControlWord, ErrorCode, Family, MotionStart, OutputData, PositionScale, SpeedScale,
    State, StatusBit, StatusWord, Topology, Travel, Trigger, Variant, effective_torque,
};
use crate::units::Moment;

#[derive(Clone, Debug)]
pub struct Drive {
    pub(super) variant: Variant,
    pub(super) memory: Memory,
    pub(super) axis: Axis,
    /// Offset of the drive's position from that of the axis, in steps of the axis.
    pub(super) offset: f64,
    pub(super) out: OutputData,
    pub(super) errors: VecDeque<ErrorCode>,
    /// Number of faults since the last acknowledgement.
    pub(super) faults: u8,
    pub(super) celsius: f64,
    load: SpindleLoad,
    control: ControlWord,
    /// State of the drive. Whether it moves is read from the axis instead.
    state: State,
    motion: Motion,
    target_reached: bool,
    acknowledged: bool,
    over_current: bool,
    /// Time in milliseconds for which a moving drive has made no progress.
    stuck_ms: u32,
    allowed: bool,
    at: Moment,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Rest,
    /// A move to a position, or a jog step. A stop does not end a jog step.
    Job {
        at: f64,
        jog: Option<Jog>,
    },
    /// A paused job, which resumes when control bit 5 is set.
    Paused {
        at: f64,
    },
    /// A run in speed mode, either to a position or endless.
    Run {
        to: Option<f64>,
        clockwise: bool,
    },
}

/// Speed and torque of a jog step, in percent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Jog {
    speed: u8,
    torque: u8,
}

/// Number of stored errors, parameters 108 to 115.
const ERRORS: usize = 8;
const BLOCKED_FAULT_DELAY_MS: u32 = 200;
const STALL_FAULT_DELAY_MS: u32 = 500;
const HOT: f64 = 80.0;
/// Temperature rise above ambient at full torque, in kelvin.
const FULL_TORQUE_TEMPERATURE_RISE: f64 = 40.0;
const THERMAL_TIME_CONSTANT_SECONDS: f64 = 60.0;

impl Drive {
    /// Creates a drive with factory settings, switched on at time zero.
    pub fn new(variant: Variant, topology: Topology, load: SpindleLoad) -> Self {
        let family = variant.row().map_or(Family::Short, |row| row.family);
        Drive {
            variant,
            memory: Memory::new(topology, family, |row| row.number >= DRIVE_REQUESTED),
            axis: Axis::default(),
            offset: 0.0,
            out: OutputData { speed: 100, torque: 100, ..OutputData::default() },
            errors: VecDeque::new(),
            faults: 0,
            celsius: load.ambient,
            load,
            control: ControlWord::OFF,
            state: State::NotReady,
            motion: Motion::Rest,
            target_reached: false,
            acknowledged: false,
            over_current: false,
            stuck_ms: 0,
            allowed: true,
            at: Moment::START,
        }
    }

    pub fn actual_values(&mut self, now: Moment) -> ActualValues {
        self.advance_to(now);
        ActualValues {
            status: self.status(),
            speed: self.speed_scale().speed(self.axis.rpm()),
            position: self.position(),
        }
    }

    pub fn set_load(&mut self, now: Moment, load: SpindleLoad) {
        self.advance_to(now);
        self.load = load;
    }

    /// Turns the spindle by hand, by the given number of steps of 65536 per turn.
    pub fn turn_by_hand(&mut self, now: Moment, steps: f64) {
        self.advance_to(now);
        self.axis = Axis::at_position(self.axis.place() + steps);
    }

    /// Injects and stores an error. It becomes a fault and ends the motion if the drive is operational.
    pub fn inject_error(&mut self, now: Moment, code: ErrorCode) {
        self.advance_to(now);
        self.enter_fault(code);
    }

    pub fn command(&mut self, now: Moment, out: OutputData) {
        self.advance_to(now);
        let Ok(control) = out.control_word() else { return };
        self.out = out;
        let before = std::mem::replace(&mut self.control, control);
        // A run and a jog step start on an edge. A job starts on a level, with the next millisecond.
        let begins = control.motion_start(before, self.status()).filter(|begins| *begins != MotionStart::Job);
        self.enter(self.next(before));
        self.apply_command();
        if let Some(begins) = begins {
            self.start_motion(begins);
        }
    }

    /// Sets whether the drive may be moved over the bus, as is the case while S3 is at 0.
    pub(super) const fn set_motion_allowed(&mut self, allowed: bool) {
        self.allowed = allowed;
    }

    pub(super) fn reset(&mut self, now: Moment) {
        self.advance_to(now);
        self.axis.halt();
        self.clear_faults();
        self.out = OutputData { speed: 100, torque: 100, ..OutputData::default() };
        (self.control, self.state, self.motion) = (ControlWord::OFF, State::NotReady, Motion::Rest);
        (self.target_reached, self.acknowledged) = (false, false);
    }

    pub(super) fn status(&self) -> StatusWord {
        let level = match self.state {
            State::NotReady | State::Fault | State::Locked => 0,
            State::Ready => 1,
            State::Operational => 2,
            State::Enabled | State::Moving => 3,
        };
        let (low, high) = self.limits();
        let position = self.position();
        let says_outside = self.load.defect == Some(DriveDefect::SaysOutside);
        [
            (StatusBit::Ready, level >= 1),
            (StatusBit::Operational, level >= 2),
            (StatusBit::OperationEnabled, level >= 3),
            (StatusBit::Fault, self.state == State::Fault),
            (StatusBit::SwitchOnLock, self.state == State::Locked),
            (StatusBit::Warning, self.faults > 0),
            (StatusBit::TargetReached, self.target_reached),
            (StatusBit::SetpointAcknowledged, self.acknowledged),
            (StatusBit::Standstill, self.is_at_rest()),
            (StatusBit::OverCurrent, self.over_current),
            (StatusBit::PositionLimit, position < low || position > high || says_outside),
        ]
        .into_iter()
        .fold(StatusWord::DETECTED_DRIVE, |status, (bit, set)| status.with_bit(bit, set))
    }

    /// Returns whether the drive is at rest, with no motion in progress.
    pub(super) fn is_at_rest(&self) -> bool {
        self.axis.is_at_rest() && matches!(self.motion, Motion::Rest | Motion::Paused { .. })
    }

    /// Returns the position in scaled steps.
    pub(super) fn position(&self) -> i32 {
        // The float cast saturates at the limits of the type.
        ((self.axis.place() + self.offset) / TURN * self.scale().steps_per_turn()).floor() as i32
    }

    pub(super) fn travel(&self) -> Travel {
        Travel { family: self.variant.row().map(|row| row.family), scale: Some(self.scale()) }
    }

    pub(super) fn scale(&self) -> PositionScale {
        PositionScale::new(self.parameter_word(NUMERATOR), self.parameter_word(DENOMINATOR))
            .unwrap_or(PositionScale::FACTORY)
    }

    fn speed_scale(&self) -> SpeedScale {
        SpeedScale::new(self.parameter_word(SPEED_NUMERATOR), self.parameter_word(SPEED_DENOMINATOR))
            .unwrap_or(SpeedScale::FACTORY)
    }

    pub(super) fn limits(&self) -> (i32, i32) {
        let limit = |number| self.memory.get(number).and_then(|value| i32::try_from(value).ok()).unwrap_or_default();
        (limit(LOWER_LIMIT), limit(UPPER_LIMIT))
    }

    /// Handles the loss of the master, which causes a fault if the drive is operational.
    pub(super) fn handle_master_loss(&mut self, now: Moment) {
        self.advance_to(now);
        if self.state.after_event(Trigger::Fails) == State::Fault && self.state != State::Fault {
            self.enter_fault(ErrorCode::CONNECTION_TIMEOUT);
        }
    }

    pub(super) const fn clear_faults(&mut self) {
        self.faults = 0;
        self.over_current = false;
    }

    pub(super) fn enter_fault(&mut self, code: ErrorCode) {
        self.errors.push_front(code);
        self.errors.truncate(ERRORS);
        self.faults = self.faults.saturating_add(1);
        self.over_current |= code == ErrorCode::OVER_CURRENT;
        self.enter(self.state.after_event(Trigger::Fails));
    }

    fn parameter_word(&self, number: u16) -> u16 {
        self.memory.get(number).and_then(|value| u16::try_from(value).ok()).unwrap_or_default()
    }

    fn mechanical_position(&self, position: i32) -> f64 {
        f64::from(position) / self.scale().steps_per_turn() * TURN - self.offset
    }

    /// Advances the simulation to the given time in steps of one millisecond. A time in the past has no effect.
    pub(super) fn advance_to(&mut self, now: Moment) {
        while self.at + TICK <= now {
            let ticks = if self.is_settled() { now.duration_since(self.at).as_millis().max(1) } else { 1 };
            let ticks = u32::try_from(ticks).unwrap_or(u32::MAX);
            self.tick(ticks);
            self.at = self.at + TICK * ticks;
        }
    }

    /// Returns whether nothing but the temperature can change by itself.
    fn is_settled(&self) -> bool {
        let begins = self.control.motion_start(self.control, self.status()).is_some();
        self.motion == Motion::Rest && self.axis.is_at_rest() && !begins && self.next(self.control) == self.state
    }

    /// Returns the state after the control word has changed from `before` to the current one.
    fn next(&self, before: ControlWord) -> State {
        match self.state {
            State::NotReady if !self.may_move() => State::NotReady,
            state => state.after_control_word(before, self.control),
        }
    }

    /// Returns whether the drive may be moved: it is requested, and switch S3 is at 0.
    fn may_move(&self) -> bool {
        self.allowed && self.memory.get(DRIVE_REQUESTED) == Some(1)
    }

    fn tick(&mut self, ticks: u32) {
        self.enter(self.next(self.control));
        if let Some(MotionStart::Job) = self.control.motion_start(self.control, self.status()) {
            self.start_motion(MotionStart::Job);
        }
        let torque = effective_torque(self.speed_and_torque().1);
        let wants = !matches!(self.motion, Motion::Rest | Motion::Paused { .. });
        let weak = wants && torque < self.load.percent;
        let wanted = if weak { AxisSetpoint::Rest } else { self.demanded_setpoint() };
        let came = self.axis.tick(wanted, &self.load);
        self.heat_up(if self.is_at_rest() { 0 } else { torque }, ticks);
        let stuck = weak || matches!(came, TickOutcome::Held { .. });
        self.stuck_ms = if stuck { self.stuck_ms + 1 } else { 0 };
        match came {
            TickOutcome::Held { above } if self.stuck_ms >= BLOCKED_FAULT_DELAY_MS => {
                self.enter_fault(if above { ErrorCode::BLOCK_FORWARD } else { ErrorCode::BLOCK_REVERSE });
            }
            _ if weak && self.stuck_ms >= STALL_FAULT_DELAY_MS => self.enter_fault(ErrorCode::FOLLOWING_ERROR),
            TickOutcome::There if wants && !weak => {
                self.target_reached |= matches!(self.motion, Motion::Job { .. });
                self.motion = Motion::Rest;
            }
            _ => {}
        }
    }

    fn demanded_setpoint(&self) -> AxisSetpoint {
        let rpm = f64::from(self.parameter_word(MAXIMUM_SPEED)) / 10.0 * f64::from(self.speed_and_torque().0.min(100))
            / 100.0;
        let speed = rpm / 60.0 * TURN;
        let wanted = match self.motion {
            Motion::Rest | Motion::Paused { .. } => AxisSetpoint::Rest,
            Motion::Job { at, .. } | Motion::Run { to: Some(at), .. } => AxisSetpoint::Place { at, speed },
            Motion::Run { to: None, clockwise } => AxisSetpoint::Speed(if clockwise { speed } else { -speed }),
        };
        wanted.with_defect(self.load.defect, self.axis.place())
    }

    const fn speed_and_torque(&self) -> (u8, u8) {
        match self.motion {
            Motion::Job { jog: Some(Jog { speed, torque }), .. } => (speed, torque),
            _ => (self.out.speed, self.out.torque),
        }
    }

    fn heat_up(&mut self, torque: u8, ticks: u32) {
        let ends = self.load.ambient + FULL_TORQUE_TEMPERATURE_RISE * f64::from(torque) / 100.0;
        let left = (-f64::from(ticks) * TICK.as_secs_f64() / THERMAL_TIME_CONSTANT_SECONDS).exp();
        let before = self.celsius;
        self.celsius = ends + (before - ends) * left;
        if self.celsius >= HOT && (before < HOT || torque > 0) && self.state != State::Fault {
            self.enter_fault(ErrorCode::OVER_TEMPERATURE);
        }
    }

    fn enter(&mut self, state: State) {
        if self.state == State::Fault && state == State::Locked {
            self.clear_faults();
        }
        if matches!(state, State::NotReady | State::Ready) {
            (self.target_reached, self.acknowledged) = (false, false);
        }
        if !matches!(state, State::Enabled | State::Moving) {
            self.motion = Motion::Rest;
        }
        self.state = state;
    }

    /// Applies the control word to a motion in progress. Jog steps are not affected.
    fn apply_command(&mut self) {
        let has = |bit| self.control.is_set(bit);
        let speed_mode = has(ControlBit::SpeedMode);
        self.motion = match self.motion {
            Motion::Run { .. } if !speed_mode || !has(ControlBit::Start) => Motion::Rest,
            Motion::Job { jog: None, .. } | Motion::Paused { .. } if speed_mode || !has(ControlBit::NoStop) => {
                Motion::Rest
            }
            Motion::Job { at, jog: None } if !has(ControlBit::NoPause) => Motion::Paused { at },
            Motion::Paused { at } if has(ControlBit::NoPause) => Motion::Job { at, jog: None },
            motion => motion,
        };
    }

    fn start_motion(&mut self, begins: MotionStart) {
        let (low, high) = self.limits();
        let jog = |step: u16, speed: u16, torque: u16| {
            let percent = |number| u8::try_from(self.parameter_word(number)).unwrap_or_default();
            let step = self.memory.get(step).and_then(|step| i32::try_from(step).ok()).unwrap_or_default();
            (self.position().saturating_add(step), Some(Jog { speed: percent(speed), torque: percent(torque) }))
        };
        let (target, jog) = match begins {
            MotionStart::Run => {
                let clockwise = self.control.is_set(ControlBit::NoStop);
                // A drive beyond the end of its range does not move further out, and does not return either.
                let end = if clockwise { high.max(self.position()) } else { low.min(self.position()) };
                let to = (!self.control.is_set(ControlBit::NoPause)).then(|| self.mechanical_position(end));
                return self.set_motion(Motion::Run { to, clockwise });
            }
            MotionStart::Job => (self.out.target, None),
            MotionStart::JogOne => jog(170, 172, 174),
            MotionStart::JogTwo => jog(176, 178, 180),
        };
        if (low..=high).contains(&target) {
            self.set_motion(Motion::Job { at: self.mechanical_position(target), jog });
        } else if jog.is_some() || (self.out.speed > 0 && self.out.torque > 0) {
            self.enter_fault(ErrorCode::INVALID_TARGET);
        }
    }

    fn set_motion(&mut self, motion: Motion) {
        let before = std::mem::replace(&mut self.motion, motion);
        let (speed, torque) = self.speed_and_torque();
        if speed == 0 || torque == 0 || !self.may_move() {
            self.motion = before;
            return;
        }
        self.target_reached = false;
        self.acknowledged = self.control.is_set(ControlBit::Start);
        self.stuck_ms = 0;
    }
}
