//! The singleturn calibration, which consists of a counterclockwise and a clockwise run of about five seconds each. See
//! manual 6.4.
//!
//! The manual leaves some rules open (`U`). In this model, a run ends after one second if a condition is not met, and
//! immediately if the speed changes. The second run is rejected if the first run has not been completed. A final status
//! is kept until the next run has started, even if the device mode changes.

use std::time::Duration;

use crate::devices::biss::protocol::{CalibrationCommand, CalibrationStatus, PositionFilter};
use crate::units::Moment;

#[derive(Clone, Copy, Debug)]
pub(super) struct CalibrationConditions {
    /// Shaft speed in revolutions per minute, positive for clockwise rotation.
    pub(super) rpm: f64,
    /// Variation of the speed in revolutions per minute.
    pub(super) waver: f64,
    pub(super) celsius: i16,
    pub(super) filter: PositionFilter,
}

#[derive(Clone, Debug)]
pub(super) struct Calibration {
    pub(super) command: u8,
    pub(super) status: CalibrationStatus,
    run: Option<CalibrationRun>,
    duration: Duration,
    keeps_status: bool,
}

#[derive(Clone, Copy, Debug)]
struct CalibrationRun {
    clockwise: bool,
    begins: Moment,
    ends: Moment,
    outcome: CalibrationStatus,
}

/// What a calibration run did to the calibration table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RunOutcome {
    No,
    /// The second run is complete and the table has been saved.
    Saved,
    /// The second run has failed and the table is lost.
    Lost,
}

impl Calibration {
    const START_DELAY: Duration = Duration::from_millis(300);
    const FAILURE_DELAY: Duration = Duration::from_secs(1);
    /// Allowed speed in revolutions per minute, in either direction.
    const SPEED: std::ops::RangeInclusive<f64> = 300.0..=700.0;
    const MAX_SPEED_DEVIATION: f64 = 2.0;
    const CELSIUS: std::ops::RangeInclusive<i16> = 25..=40;

    pub(super) fn new(duration: Duration, keeps_status: bool) -> Self {
        Calibration { command: 0, status: CalibrationStatus::Idle, run: None, duration, keeps_status }
    }

    pub(super) fn is_running(&self) -> bool {
        self.run.is_some() && self.status == CalibrationStatus::Running
    }

    /// Handles a command. Returns `false` if the command is rejected.
    pub(super) fn write(&mut self, now: Moment, value: u8, conditions: CalibrationConditions) -> bool {
        let clockwise = match CalibrationCommand::from_byte(value) {
            CalibrationCommand::StartCounterclockwise => false,
            CalibrationCommand::StartClockwise if self.status == CalibrationStatus::CounterclockwiseDone => true,
            CalibrationCommand::StartClockwise | CalibrationCommand::Unknown(_) => return false,
        };
        if self.run.is_some() {
            return false;
        }
        self.command = value;
        let success =
            if clockwise { CalibrationStatus::ClockwiseDone } else { CalibrationStatus::CounterclockwiseDone };
        let (outcome, duration) = match run_failure(conditions, clockwise) {
            Some(failure) => (failure, Self::FAILURE_DELAY),
            None => (success, self.duration),
        };
        let begins = if self.keeps_status { now + Self::START_DELAY } else { now };
        self.run = Some(CalibrationRun { clockwise, begins, ends: begins + duration, outcome });
        self.update(now);
        true
    }

    pub(super) fn force_failure(&mut self, now: Moment) {
        if let Some(run) = &mut self.run {
            (run.ends, run.outcome) = (now, CalibrationStatus::Failed);
        }
    }

    /// Starts a run that is due, and ends a run whose time has elapsed.
    pub(super) fn update(&mut self, now: Moment) -> RunOutcome {
        if self.run.is_some_and(|run| run.begins <= now) {
            self.status = CalibrationStatus::Running;
        }
        let Some(run) = self.run.filter(|run| run.ends <= now) else { return RunOutcome::No };
        self.run = None;
        self.status = run.outcome;
        match run.outcome {
            CalibrationStatus::ClockwiseDone => RunOutcome::Saved,
            CalibrationStatus::CounterclockwiseDone => RunOutcome::No,
            _ if run.clockwise => RunOutcome::Lost,
            _ => RunOutcome::No,
        }
    }

    /// Aborts the calibration when the device mode is left or power is lost.
    pub(super) fn abort(&mut self) -> RunOutcome {
        let lost = self.run.take().is_some_and(|run| run.clockwise);
        self.command = 0;
        if !self.keeps_status || self.status == CalibrationStatus::Running {
            self.status = CalibrationStatus::Idle;
        }
        if lost { RunOutcome::Lost } else { RunOutcome::No }
    }
}

fn run_failure(conditions: CalibrationConditions, clockwise: bool) -> Option<CalibrationStatus> {
    if !Calibration::CELSIUS.contains(&conditions.celsius) {
        Some(CalibrationStatus::Temperature)
    } else if !Calibration::SPEED.contains(&conditions.rpm.abs()) {
        Some(CalibrationStatus::Speed)
    } else if (conditions.rpm > 0.0) != clockwise {
        Some(CalibrationStatus::WrongDirection)
    } else if conditions.waver > Calibration::MAX_SPEED_DEVIATION || conditions.filter != PositionFilter::Balanced {
        Some(CalibrationStatus::Failed)
    } else {
        None
    }
}
