//! The steps of each operation, in their order: what a view lists beforehand and marks as they come.

use std::time::Duration;

use super::{Demand, Run, Task};
use crate::devices::biss::profile::Op;
use crate::devices::biss::protocol::DeviceMode;

/// A step of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// Checks conditions that do not depend on the motor: the filter.
    Conditions,
    /// Waits for the person at the motor.
    Await(Task),
    /// Password and device mode.
    Enter(DeviceMode),
    /// The encoder is asked to take something.
    Open,
    /// Registers are written.
    Write,
    /// A run of a procedure.
    Run(Run),
    Results,
    /// The flash is written.
    Save,
    /// The preset is carried out.
    Fire,
    /// The encoder restarts.
    Restart,
    /// Back to operation, and the password cleared.
    LeadBack,
    /// Reads back what was written.
    ReadBack,
}

/// The progress of a write.
#[derive(Clone, Debug, PartialEq)]
pub struct News {
    /// Index of the operation in the plan, counted from 0.
    pub op: usize,
    /// The step of the operation.
    pub step: Step,
    /// Detail of the step.
    pub detail: Detail,
}

/// The detail of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Detail {
    Begins,
    /// Registers done, and their total.
    Count {
        done: u64,
        total: u64,
    },
    /// It takes its time.
    Lasts {
        /// Time so far.
        elapsed: Duration,
        /// As long as it takes, where that can be told.
        expected: Option<Duration>,
    },
    /// The task of the person, and the measurement.
    Demand(Demand),
}

/// The steps of an operation. A restart of the encoder leads back by itself.
pub fn steps_of(op: &Op) -> Vec<Step> {
    let entered = |mode, steps: &[Step]| {
        let mut all = vec![Step::Enter(mode)];
        all.extend(steps);
        all
    };
    match op {
        Op::StoreData { .. } => {
            let own = [Step::Open, Step::Write, Step::Save, Step::LeadBack, Step::ReadBack];
            let mut steps = vec![Step::Await(Task::Stand)];
            steps.extend(entered(DeviceMode::DATA_WRITE, &own));
            steps
        }
        Op::StorePreset { .. } => {
            entered(DeviceMode::PRESET, &[Step::Open, Step::Write, Step::Save, Step::Restart, Step::ReadBack])
        }
        Op::FirePreset { .. } => {
            let mut steps = vec![Step::Await(Task::StandAtPlace)];
            steps.extend(entered(DeviceMode::PRESET, &[Step::Fire, Step::Restart, Step::ReadBack]));
            steps
        }
        Op::SelectFilter { .. } => {
            entered(DeviceMode::FILTER, &[Step::Open, Step::Write, Step::Save, Step::Restart, Step::ReadBack])
        }
        Op::Calibrate => {
            let (first, second) = (Run::CalibrationCounterclockwise, Run::CalibrationClockwise);
            vec![
                Step::Conditions,
                Step::Await(Task::Turn(first)),
                Step::Enter(DeviceMode::CALIBRATION),
                Step::Run(first),
                Step::Await(Task::Turn(second)),
                Step::Run(second),
                Step::LeadBack,
            ]
        }
        Op::WiegandTest { save } => {
            let (first, second) = (Run::WiegandClockwise, Run::WiegandCounterclockwise);
            let mut steps = vec![
                Step::Await(Task::Turn(first)),
                Step::Enter(DeviceMode::WIEGAND_TEST),
                Step::Run(first),
                Step::Await(Task::Turn(second)),
                Step::Run(second),
                Step::Results,
            ];
            steps.extend(save.then_some(Step::Save));
            steps.push(Step::LeadBack);
            steps
        }
        Op::WriteRegister { .. } => vec![Step::Write, Step::ReadBack],
    }
}
