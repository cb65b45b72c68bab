//! The operator at the motor during a procedure: tasks, measurements and confirmations. In the window, the operator is
//! the user. In a test, it is a script. On a production line, there may be no operator.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::ShaftMotion;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotorRun {
    CalibrationCounterclockwise,
    /// Second calibration run. If it fails, the calibration table is lost.
    CalibrationClockwise,
    WiegandClockwise,
    WiegandCounterclockwise,
}

/// An inclusive range of speeds in revolutions per minute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedRange {
    pub least: f64,
    pub greatest: f64,
}

impl SpeedRange {
    /// Error to allow for in a speed measurement, as a fraction of the speed.
    const MEASURING_TOLERANCE: f64 = 0.01;

    const fn new(least: f64, greatest: f64) -> Self {
        SpeedRange { least, greatest }
    }

    /// Returns the range widened by the measuring tolerance.
    pub fn with_tolerance(self) -> Self {
        SpeedRange::new(
            self.least / (1.0 + Self::MEASURING_TOLERANCE),
            self.greatest / (1.0 - Self::MEASURING_TOLERANCE),
        )
    }

    pub fn midpoint(self) -> f64 {
        f64::midpoint(self.least, self.greatest)
    }

    fn contains(self, rpm: f64) -> bool {
        (self.least..=self.greatest).contains(&rpm)
    }
}

impl MotorRun {
    pub const fn is_clockwise(self) -> bool {
        matches!(self, MotorRun::CalibrationClockwise | MotorRun::WiegandClockwise)
    }

    pub const fn is_calibration(self) -> bool {
        matches!(self, MotorRun::CalibrationCounterclockwise | MotorRun::CalibrationClockwise)
    }

    /// Returns the speeds at which the run may be started (manual 6.3 and 6.4).
    pub const fn allowed_speeds(self) -> SpeedRange {
        if self.is_calibration() { SpeedRange::new(300.0, 700.0) } else { SpeedRange::new(500.0, 2000.0) }
    }

    /// Returns the speeds that give the best result (manual 6.4). For the Wiegand test, any allowed speed is good.
    pub const fn recommended_range(self) -> SpeedRange {
        if self.is_calibration() { SpeedRange::new(498.0, 502.0) } else { self.allowed_speeds() }
    }

    /// Returns how much the speed may vary during a calibration, in revolutions per minute (manual 6.4). Returns `None`
    /// for the Wiegand test, for which the manual only requires a constant speed.
    pub const fn max_fluctuation(self) -> Option<f64> {
        if self.is_calibration() { Some(2.0) } else { None }
    }

    /// Returns the speed variation in revolutions per minute up to which the motor is considered steady. The limit
    /// grows with the speed, like the measuring error.
    pub fn accepted_fluctuation(self, rpm: f64) -> f64 {
        match self.max_fluctuation() {
            Some(fluctuation) => fluctuation + rpm.abs() * SpeedRange::MEASURING_TOLERANCE,
            None => rpm.abs() * Self::MAX_FLUCTUATION,
        }
    }

    /// Largest speed variation of a steady motor, as a fraction of the speed. The limit is not documented (`U`).
    const MAX_FLUCTUATION: f64 = 0.05;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OperatorTask {
    Turn(MotorRun),
    /// Keep the shaft at rest, because the data area cannot be accessed while it turns.
    HoldStill,
    /// Keep the shaft at rest at the angle that will get the preset value.
    HoldAtPresetAngle,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartBlocker {
    Measuring,
    NoPosition,
    /// The shaft is at rest but must turn.
    NotTurning,
    /// The shaft is turning but must be at rest.
    Turning {
        /// Speed in revolutions per minute, positive clockwise.
        rpm: f64,
    },
    WrongDirection,
    /// The shaft turns too slowly or too fast.
    Speed {
        /// Speed in revolutions per minute, regardless of direction.
        rpm: f64,
        allowed: SpeedRange,
    },
    /// The motor is still accelerating, or its speed varies.
    Unsteady {
        /// Speed variation in revolutions per minute.
        spread: f64,
    },
    /// The temperature is outside the range of 25 °C to 40 °C (manual 6.4).
    Temperature {
        celsius: i16,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OperatorAdvice {
    /// Another speed, or a steadier one, would give a better result.
    Speed { recommended: SpeedRange },
    /// If this run fails, the calibration table is lost (manual 6.4).
    TableAtRisk,
    /// The encoder marks its positions as invalid. The speed is calculated from them nevertheless.
    Marked,
}

#[derive(Clone, Debug, PartialEq)]
pub struct OperatorPrompt {
    pub task: OperatorTask,
    /// Motion of the shaft, or `None` until it has been measured.
    pub motion: Option<ShaftMotion>,
    /// Temperature of the encoder, if the procedure depends on it.
    pub celsius: Option<i16>,
    /// Conditions that are not met yet and prevent the start of the run.
    pub blockers: Vec<StartBlocker>,
    pub advice: Vec<OperatorAdvice>,
    pub waited: Duration,
}

impl OperatorPrompt {
    /// Allowed temperature range for the calibration in degrees Celsius (manual 6.4).
    pub const CELSIUS: std::ops::RangeInclusive<i16> = 25..=40;
    /// Lowest speed at which the shaft is considered to be turning, in revolutions per minute.
    const MIN_TURNING_RPM: f64 = 1.0;

    pub(super) fn new(task: OperatorTask, measured: ShaftReading, waited: Duration) -> Self {
        let ShaftReading { motion, celsius, marked, unreadable } = measured;
        let mut blockers = Vec::new();
        let mut advice = Vec::new();
        match (motion, task) {
            _ if unreadable => blockers.push(StartBlocker::NoPosition),
            (None, _) => blockers.push(StartBlocker::Measuring),
            (Some(motion), OperatorTask::Turn(run)) => blockers.extend(Self::motion_blocker(run, motion)),
            (Some(motion), OperatorTask::HoldStill | OperatorTask::HoldAtPresetAngle) => {
                blockers.extend((!motion.is_shaft_at_rest()).then_some(StartBlocker::Turning { rpm: motion.rpm }));
            }
        }
        if let Some(celsius) = celsius.filter(|celsius| !Self::CELSIUS.contains(celsius)) {
            blockers.push(StartBlocker::Temperature { celsius });
        }
        if let (OperatorTask::Turn(run), Some(motion)) = (task, motion) {
            let recommended = run.recommended_range();
            let wavers = run.max_fluctuation().is_some_and(|fluctuation| motion.spread > fluctuation);
            let off = !recommended.contains(motion.rpm.abs()) || wavers;
            advice.extend((run.is_calibration() && off).then_some(OperatorAdvice::Speed { recommended }));
            advice.extend(marked.then_some(OperatorAdvice::Marked));
        }
        if task == OperatorTask::Turn(MotorRun::CalibrationClockwise) {
            advice.push(OperatorAdvice::TableAtRisk);
        }
        OperatorPrompt { task, motion, celsius, blockers, advice, waited }
    }

    fn motion_blocker(run: MotorRun, motion: ShaftMotion) -> Option<StartBlocker> {
        let (rpm, allowed) = (motion.rpm.abs(), run.allowed_speeds());
        if rpm < Self::MIN_TURNING_RPM {
            Some(StartBlocker::NotTurning)
        } else if (motion.rpm > 0.0) != run.is_clockwise() {
            Some(StartBlocker::WrongDirection)
        } else if !allowed.with_tolerance().contains(rpm) {
            Some(StartBlocker::Speed { rpm, allowed })
        } else if motion.spread > run.accepted_fluctuation(rpm) {
            Some(StartBlocker::Unsteady { spread: motion.spread })
        } else {
            None
        }
    }

    /// Returns whether all conditions for the start are met.
    pub fn is_ready(&self) -> bool {
        self.blockers.is_empty()
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShaftReading {
    pub(super) motion: Option<ShaftMotion>,
    pub(super) celsius: Option<i16>,
    /// Whether the encoder marks its positions as invalid.
    pub(super) marked: bool,
    pub(super) unreadable: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatorAnswer {
    Wait,
    /// Start the run. Valid only if all conditions are met.
    Go,
    /// Skip this part and continue with the next.
    Skip,
    Cancel,
    /// Give up because no operator is present. The conditions that are not met are reported.
    GiveUp,
}

pub trait Operator {
    /// Prepares for a new task by discarding earlier confirmations.
    fn on_task_start(&mut self) {}

    /// Asks the operator to answer a task. Called several times per second with new measurements.
    fn ask(&mut self, demand: &OperatorPrompt) -> OperatorAnswer;
}

/// A substitute for an absent operator. It starts as soon as all conditions are met, and gives up after a time limit.
#[derive(Clone, Copy, Debug)]
pub struct UnattendedOperator {
    pub patience: Duration,
}

impl UnattendedOperator {
    /// Extra time before giving up, while there is no measurement yet.
    const FIRST_MEASUREMENT_TIME: Duration = Duration::from_secs(5);
}

impl Operator for UnattendedOperator {
    fn ask(&mut self, demand: &OperatorPrompt) -> OperatorAnswer {
        let hopeless = demand.blockers.iter().any(|blocker| matches!(blocker, StartBlocker::Temperature { .. }));
        // After a measurement, a more specific reason for giving up can be reported.
        let measures =
            if demand.blockers == [StartBlocker::Measuring] { Self::FIRST_MEASUREMENT_TIME } else { Duration::ZERO };
        if demand.is_ready() {
            OperatorAnswer::Go
        } else if hopeless || demand.waited >= self.patience.saturating_add(measures) {
            OperatorAnswer::GiveUp
        } else {
            OperatorAnswer::Wait
        }
    }
}

/// A channel for the answers of an operator in another thread. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct OperatorChannel(Arc<Mutex<Option<(OperatorTask, OperatorAnswer)>>>);

impl OperatorChannel {
    /// Answers a task. The answer is ignored unless this is the current task.
    pub fn answer_task(&self, to: OperatorTask, answer: OperatorAnswer) {
        *self.lock_slot() = Some((to, answer));
    }

    fn lock_slot(&self) -> std::sync::MutexGuard<'_, Option<(OperatorTask, OperatorAnswer)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Operator for OperatorChannel {
    fn on_task_start(&mut self) {
        *self.lock_slot() = None;
    }

    fn ask(&mut self, demand: &OperatorPrompt) -> OperatorAnswer {
        match self.lock_slot().take() {
            Some((task, answer)) if task == demand.task => answer,
            _ => OperatorAnswer::Wait,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(rpm: f64, spread: f64) -> ShaftReading {
        let motion = Some(ShaftMotion { rpm, spread, travel: rpm.abs() / 60.0 });
        ShaftReading { motion, celsius: Some(30), ..ShaftReading::default() }
    }

    fn operator_prompt(task: OperatorTask, measured: ShaftReading) -> OperatorPrompt {
        OperatorPrompt::new(task, measured, Duration::ZERO)
    }

    /// Checks the limits in manual 6.3 and 6.4.
    #[test]
    fn start_requires_direction_speed_and_stability() {
        let (first, second) = (MotorRun::CalibrationCounterclockwise, MotorRun::CalibrationClockwise);
        let allowed = SpeedRange { least: 300.0, greatest: 700.0 };
        let cases = [
            (first, -500.0, 0.0, vec![]),
            (first, -300.0, 0.0, vec![]),
            (first, -700.0, 0.0, vec![]),
            (first, 500.0, 0.0, vec![StartBlocker::WrongDirection]),
            (second, 500.0, 0.0, vec![]),
            (second, -500.0, 0.0, vec![StartBlocker::WrongDirection]),
            (first, -290.0, 0.0, vec![StartBlocker::Speed { rpm: 290.0, allowed }]),
            (first, -710.0, 0.0, vec![StartBlocker::Speed { rpm: 710.0, allowed }]),
            (first, 0.5, 0.0, vec![StartBlocker::NotTurning]),
            (first, -500.0, 6.9, vec![]),
            (first, -500.0, 7.1, vec![StartBlocker::Unsteady { spread: 7.1 }]),
            (MotorRun::WiegandClockwise, 500.0, 26.0, vec![StartBlocker::Unsteady { spread: 26.0 }]),
            (MotorRun::WiegandClockwise, 500.0, 20.0, vec![]),
            (MotorRun::WiegandClockwise, 499.96, 0.0, vec![]),
            (MotorRun::WiegandClockwise, 2000.0, 0.0, vec![]),
            (MotorRun::WiegandClockwise, 2000.04, 0.0, vec![]),
            (MotorRun::WiegandCounterclockwise, -1000.0, 0.0, vec![]),
            (MotorRun::WiegandCounterclockwise, 1000.0, 0.0, vec![StartBlocker::WrongDirection]),
            (
                MotorRun::WiegandClockwise,
                450.0,
                0.0,
                vec![StartBlocker::Speed { rpm: 450.0, allowed: SpeedRange { least: 500.0, greatest: 2000.0 } }],
            ),
        ];
        for (run, rpm, spread, blockers) in cases {
            let demand = operator_prompt(OperatorTask::Turn(run), turning(rpm, spread));
            assert_eq!(demand.blockers, blockers, "{run:?} at {rpm}");
            assert_eq!(demand.is_ready(), blockers.is_empty());
        }
    }

    #[test]
    fn temperature_or_missing_position_blocks_start() {
        let task = OperatorTask::Turn(MotorRun::CalibrationCounterclockwise);
        for (celsius, fits) in [(24, false), (25, true), (40, true), (41, false)] {
            let measured = ShaftReading { celsius: Some(celsius), ..turning(-500.0, 0.0) };
            let expected = if fits { vec![] } else { vec![StartBlocker::Temperature { celsius }] };
            assert_eq!(operator_prompt(task, measured).blockers, expected);
        }
        assert_eq!(operator_prompt(task, ShaftReading::default()).blockers, [StartBlocker::Measuring]);
        let unreadable = ShaftReading { unreadable: true, ..ShaftReading::default() };
        assert_eq!(operator_prompt(task, unreadable).blockers, [StartBlocker::NoPosition]);
    }

    #[test]
    fn advice_does_not_block_start() {
        let advice = |run, rpm, spread| operator_prompt(OperatorTask::Turn(run), turning(rpm, spread)).advice;
        let speed = OperatorAdvice::Speed { recommended: SpeedRange { least: 498.0, greatest: 502.0 } };
        assert_eq!(advice(MotorRun::CalibrationCounterclockwise, -500.0, 1.9), []);
        assert_eq!(advice(MotorRun::CalibrationCounterclockwise, -503.0, 0.0), [speed]);
        assert_eq!(advice(MotorRun::CalibrationCounterclockwise, -500.0, 2.1), [speed]);
        assert_eq!(advice(MotorRun::CalibrationClockwise, 501.0, 0.0), [OperatorAdvice::TableAtRisk]);
        assert_eq!(advice(MotorRun::WiegandClockwise, 1234.0, 9.0), []);
        let marked = ShaftReading { marked: true, ..turning(1000.0, 0.0) };
        assert_eq!(
            operator_prompt(OperatorTask::Turn(MotorRun::WiegandClockwise), marked).advice,
            [OperatorAdvice::Marked]
        );
    }

    #[test]
    fn turning_shaft_blocks_standstill_step() {
        for task in [OperatorTask::HoldStill, OperatorTask::HoldAtPresetAngle] {
            assert_eq!(operator_prompt(task, turning(3.0, 0.0)).blockers, [StartBlocker::Turning { rpm: 3.0 }]);
            assert!(operator_prompt(task, turning(0.0, 0.0)).is_ready());
        }
    }

    #[test]
    fn unattended_run_starts_or_times_out() {
        let mut operator = UnattendedOperator { patience: Duration::from_secs(10) };
        let task = OperatorTask::Turn(MotorRun::WiegandClockwise);
        let mut ask =
            |measured, seconds| operator.ask(&OperatorPrompt::new(task, measured, Duration::from_secs(seconds)));
        let fits = ShaftReading { celsius: None, ..turning(1000.0, 0.0) };
        let stands = ShaftReading { celsius: None, ..turning(0.0, 0.0) };
        assert_eq!(ask(fits, 0), OperatorAnswer::Go);
        assert_eq!((ask(stands, 9), ask(stands, 10)), (OperatorAnswer::Wait, OperatorAnswer::GiveUp));
        assert_eq!(ask(ShaftReading::default(), 11), OperatorAnswer::Wait, "it ends with a reason");
        assert_eq!(ask(ShaftReading::default(), 15), OperatorAnswer::GiveUp, "and not never");
        assert_eq!(
            ask(ShaftReading { celsius: Some(50), ..fits }, 0),
            OperatorAnswer::GiveUp,
            "waiting does not cool it"
        );
    }

    #[test]
    fn answer_applies_only_to_its_question() {
        let seat = OperatorChannel::default();
        let mut operator = seat.clone();
        let (first, second) =
            (OperatorTask::Turn(MotorRun::WiegandClockwise), OperatorTask::Turn(MotorRun::WiegandCounterclockwise));
        let mut ask = |task| operator.ask(&operator_prompt(task, ShaftReading::default()));
        assert_eq!(ask(first), OperatorAnswer::Wait);
        seat.answer_task(first, OperatorAnswer::Go);
        assert_eq!(ask(second), OperatorAnswer::Wait, "pressed too late, for the run before");
        assert_eq!(ask(first), OperatorAnswer::Wait, "and it does not wait there");
        seat.answer_task(first, OperatorAnswer::Skip);
        assert_eq!((ask(first), ask(first)), (OperatorAnswer::Skip, OperatorAnswer::Wait));
        seat.answer_task(first, OperatorAnswer::Go);
        operator.on_task_start();
        assert_eq!(
            operator.ask(&operator_prompt(first, ShaftReading::default())),
            OperatorAnswer::Wait,
            "for the same of an operation before"
        );
    }
}
