//! The steps of each operation, in order. They are listed in advance, and each step is marked when it is reported.

use std::time::Duration;

use super::{MotorRun, OperatorPrompt, OperatorTask};
use crate::devices::biss::profile::Op;
use crate::devices::biss::protocol::DeviceMode;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProcedureStep {
    /// Checks the active filter. The motor need not turn.
    Conditions,
    Await(OperatorTask),
    Enter(DeviceMode),
    Open,
    Write,
    Run(MotorRun),
    Results,
    Save,
    Fire,
    Restart,
    ReturnToOperation,
    ReadBack,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ProcedureProgress {
    /// Index of the operation in the plan, counted from 0.
    pub op: usize,
    pub step: ProcedureStep,
    pub detail: StepDetail,
}

#[derive(Clone, Debug, PartialEq)]
pub enum StepDetail {
    Begins,
    Count {
        done: u64,
        total: u64,
    },
    Lasts {
        elapsed: Duration,
        /// Expected duration, if known.
        expected: Option<Duration>,
    },
    Demand(OperatorPrompt),
}

/// Returns the steps of an operation. A restart already returns the encoder to operation mode, so no separate step
/// follows it.
pub fn operation_steps(op: &Op) -> Vec<ProcedureStep> {
    let entered = |mode, steps: &[ProcedureStep]| {
        let mut all = vec![ProcedureStep::Enter(mode)];
        all.extend(steps);
        all
    };
    match op {
        Op::StoreData { .. } => {
            let own = [
                ProcedureStep::Open,
                ProcedureStep::Write,
                ProcedureStep::Save,
                ProcedureStep::ReturnToOperation,
                ProcedureStep::ReadBack,
            ];
            let mut steps = vec![ProcedureStep::Await(OperatorTask::HoldStill)];
            steps.extend(entered(DeviceMode::DATA_WRITE, &own));
            steps
        }
        Op::StorePreset { .. } => entered(
            DeviceMode::PRESET,
            &[
                ProcedureStep::Open,
                ProcedureStep::Write,
                ProcedureStep::Save,
                ProcedureStep::Restart,
                ProcedureStep::ReadBack,
            ],
        ),
        Op::FirePreset { .. } => {
            let mut steps = vec![ProcedureStep::Await(OperatorTask::HoldAtPresetAngle)];
            steps.extend(entered(
                DeviceMode::PRESET,
                &[ProcedureStep::Fire, ProcedureStep::Restart, ProcedureStep::ReadBack],
            ));
            steps
        }
        Op::SelectFilter { .. } => entered(
            DeviceMode::FILTER,
            &[
                ProcedureStep::Open,
                ProcedureStep::Write,
                ProcedureStep::Save,
                ProcedureStep::Restart,
                ProcedureStep::ReadBack,
            ],
        ),
        Op::Calibrate => {
            let (first, second) = (MotorRun::CalibrationCounterclockwise, MotorRun::CalibrationClockwise);
            vec![
                ProcedureStep::Conditions,
                ProcedureStep::Await(OperatorTask::Turn(first)),
                ProcedureStep::Enter(DeviceMode::CALIBRATION),
                ProcedureStep::Run(first),
                ProcedureStep::Await(OperatorTask::Turn(second)),
                ProcedureStep::Run(second),
                ProcedureStep::ReturnToOperation,
            ]
        }
        Op::WiegandTest { save } => {
            let (first, second) = (MotorRun::WiegandClockwise, MotorRun::WiegandCounterclockwise);
            let mut steps = vec![
                ProcedureStep::Await(OperatorTask::Turn(first)),
                ProcedureStep::Enter(DeviceMode::WIEGAND_TEST),
                ProcedureStep::Run(first),
                ProcedureStep::Await(OperatorTask::Turn(second)),
                ProcedureStep::Run(second),
                ProcedureStep::Results,
            ];
            steps.extend(save.then_some(ProcedureStep::Save));
            steps.push(ProcedureStep::ReturnToOperation);
            steps
        }
        Op::WriteRegister { .. } => vec![ProcedureStep::Write, ProcedureStep::ReadBack],
    }
}
