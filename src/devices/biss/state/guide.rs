//! What is displayed about a guided procedure: steps, progress, current task and results. The procedure runs in a job,
//! to which the operator's answers are sent.

use crate::app::Text;
use crate::devices::biss::procedures::procedure::{
    OperatorAnswer, OperatorChannel, OperatorPrompt, OperatorTask, Outcome, ProcedureProgress, ProcedureStep,
    StepDetail, operation_steps,
};
use crate::devices::biss::profile::Op;

pub struct ProcedureRun {
    ops: Vec<Op>,
    progress: Option<ProcedureProgress>,
    /// The interrupted step. The last reported step may be a later one, if the encoder was then returned to operation
    /// mode.
    pub(super) cut: Option<ProcedureStep>,
    pub(super) seat: OperatorChannel,
    skips: Vec<(usize, OperatorTask)>,
    /// Result of the procedure, or `None` while it is running.
    pub end: Option<ProcedureEnd>,
}

#[derive(Clone, Debug)]
pub enum ProcedureEnd {
    /// The procedure ran to completion, with the result of each operation.
    Done(Vec<Outcome>),
    /// The procedure failed or was cancelled.
    Failed {
        /// Messages about the cause, the state in which the encoder was left, and what to do next.
        texts: Vec<Text>,
        /// Results of the operations that were completed before the interruption.
        before: Vec<Outcome>,
        /// Whether the encoder may still be outside operation mode, so that the user can return it.
        may_return_to_operation: bool,
        cancelled: bool,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepStatus {
    Done,
    Waits,
    Runs,
    Skipped,
    Failed,
    /// The user cancelled the procedure in this step.
    Cancelled,
    /// The step has not been reached, and possibly never will be.
    Ahead,
}

#[derive(Clone, Debug)]
pub struct GuideStep<'a> {
    pub op: &'a Op,
    pub is_first: bool,
    pub step: ProcedureStep,
    pub reached: StepStatus,
}

impl ProcedureRun {
    pub(super) fn new(ops: Vec<Op>) -> Self {
        ProcedureRun { ops, progress: None, cut: None, seat: OperatorChannel::default(), skips: Vec::new(), end: None }
    }

    pub fn is_running(&self) -> bool {
        self.end.is_none()
    }

    pub fn operations(&self) -> &[Op] {
        &self.ops
    }

    pub(super) fn set_progress(&mut self, progress: ProcedureProgress) {
        self.progress = Some(progress);
    }

    /// Returns the detail of the current step, or `None` if the procedure is not running.
    pub fn step_detail(&self) -> Option<&StepDetail> {
        self.progress.as_ref().filter(|_| self.is_running()).map(|news| &news.detail)
    }

    pub fn operator_prompt(&self) -> Option<&OperatorPrompt> {
        match self.step_detail()? {
            StepDetail::Demand(demand) => Some(demand),
            _ => None,
        }
    }

    pub(super) fn answer_task(&mut self, task: OperatorTask, answer: OperatorAnswer) {
        if self.is_running() {
            if let Some(op) = self.progress.as_ref().map(|news| news.op).filter(|_| answer == OperatorAnswer::Skip) {
                self.skips.push((op, task));
            }
            self.seat.answer_task(task, answer);
        }
    }

    pub fn steps(&self) -> Vec<GuideStep<'_>> {
        let at = self.progress.as_ref().map(|news| (news.op, self.cut.unwrap_or(news.step)));
        let mut steps = Vec::new();
        let mut passed = true;
        for (number, op) in self.ops.iter().enumerate() {
            let all = operation_steps(op);
            let skipped = self.skipped_steps(number, &all);
            for (place, step) in all.into_iter().enumerate() {
                let is_own = at == Some((number, step));
                passed &= !is_own && at.is_some_and(|(own, _)| number <= own);
                let is_skipped = skipped.as_ref().is_some_and(|range| range.contains(&place));
                let reached = match &self.end {
                    Some(ProcedureEnd::Done(_)) if is_skipped => StepStatus::Skipped,
                    Some(ProcedureEnd::Done(_)) => StepStatus::Done,
                    Some(ProcedureEnd::Failed { cancelled: true, .. }) if is_own => StepStatus::Cancelled,
                    Some(ProcedureEnd::Failed { .. }) if is_own => StepStatus::Failed,
                    Some(ProcedureEnd::Failed { .. }) if self.was_returned_to_operation(number, step) => {
                        StepStatus::Done
                    }
                    _ if is_own && self.operator_prompt().is_some() => StepStatus::Waits,
                    _ if is_own => StepStatus::Runs,
                    _ if passed && is_skipped => StepStatus::Skipped,
                    _ if passed => StepStatus::Done,
                    _ => StepStatus::Ahead,
                };
                steps.push(GuideStep { op, is_first: place == 0, step, reached });
            }
        }
        steps
    }

    /// Returns the range of skipped steps in an operation. It is based on the result if there is one, and on the
    /// operator's answers otherwise.
    fn skipped_steps(&self, number: usize, steps: &[ProcedureStep]) -> Option<std::ops::Range<usize>> {
        let outcomes = match &self.end {
            Some(ProcedureEnd::Done(outcomes) | ProcedureEnd::Failed { before: outcomes, .. }) => outcomes.as_slice(),
            None => &[],
        };
        let asks = |step: &ProcedureStep| matches!(step, ProcedureStep::Await(_));
        let from = match outcomes.get(number) {
            Some(Outcome::Skipped { after }) => {
                let done =
                    after.and_then(|run| steps.iter().position(|step| *step == ProcedureStep::Run(run))).unwrap_or(0);
                steps.iter().skip(done).position(asks).map(|place| done + place)
            }
            Some(_) => None,
            None => {
                let task = self.skips.iter().find(|(op, _)| *op == number).map(|(_, task)| *task)?;
                steps.iter().position(|step| *step == ProcedureStep::Await(task))
            }
        }?;
        // The encoder is returned to operation only if the device mode was entered.
        let entered = steps.iter().take(from).any(|step| matches!(step, ProcedureStep::Enter(_)));
        let led_back = steps.iter().position(|step| *step == ProcedureStep::ReturnToOperation).filter(|_| entered);
        Some(from..led_back.unwrap_or(steps.len()))
    }

    /// Returns whether the given step is a return to operation mode that was completed after an interruption.
    fn was_returned_to_operation(&self, op: usize, step: ProcedureStep) -> bool {
        let was_reported = self.progress.as_ref().is_some_and(|news| (news.op, news.step) == (op, step));
        let in_operation = matches!(self.end, Some(ProcedureEnd::Failed { may_return_to_operation: false, .. }));
        step == ProcedureStep::ReturnToOperation && was_reported && in_operation
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::procedures::procedure::MotorRun;
    use crate::devices::biss::protocol::DeviceMode;

    fn step_status(
        reported: &[ProcedureStep],
        cut: Option<ProcedureStep>,
        may_return_to_operation: bool,
    ) -> Vec<StepStatus> {
        let mut guide = ProcedureRun::new(vec![Op::Calibrate]);
        reported
            .iter()
            .for_each(|step| guide.set_progress(ProcedureProgress { op: 0, step: *step, detail: StepDetail::Begins }));
        guide.cut = cut;
        guide.end = Some(ProcedureEnd::Failed {
            texts: Vec::new(),
            before: Vec::new(),
            may_return_to_operation,
            cancelled: false,
        });
        guide.steps().iter().map(|own| own.reached).collect()
    }

    #[test]
    fn does_not_mark_skipped_steps_done() {
        use StepStatus::{Ahead, Done, Runs, Skipped};
        let (first, second) = (MotorRun::CalibrationCounterclockwise, MotorRun::CalibrationClockwise);
        let states = |guide: &ProcedureRun| guide.steps().iter().map(|own| own.reached).collect::<Vec<_>>();
        for (task, after, expected) in [
            (first, None, [Done, Skipped, Skipped, Skipped, Skipped, Skipped, Skipped]),
            (second, Some(first), [Done, Done, Done, Done, Skipped, Skipped, Done]),
        ] {
            let mut guide = ProcedureRun::new(vec![Op::Calibrate, Op::WiegandTest { save: false }]);
            guide.set_progress(ProcedureProgress {
                op: 0,
                step: ProcedureStep::Await(OperatorTask::Turn(task)),
                detail: StepDetail::Begins,
            });
            guide.answer_task(OperatorTask::Turn(task), OperatorAnswer::Skip);
            let next = ProcedureStep::Await(OperatorTask::Turn(MotorRun::WiegandClockwise));
            guide.set_progress(ProcedureProgress { op: 1, step: next, detail: StepDetail::Begins });
            assert_eq!(states(&guide), [&expected[..], &[Runs], &[Ahead; 6]].concat());
            guide.end = Some(ProcedureEnd::Done(vec![Outcome::Skipped { after }, Outcome::Skipped { after: None }]));
            assert_eq!(states(&guide), [&expected[..], &[Skipped; 7]].concat());
        }
    }

    #[test]
    fn interrupted_procedure_shows_failed_step() {
        use StepStatus::{Ahead, Done, Failed};
        let first = MotorRun::CalibrationCounterclockwise;
        let (turn, run) = (ProcedureStep::Await(OperatorTask::Turn(first)), ProcedureStep::Run(first));
        let told = [ProcedureStep::Conditions, turn, ProcedureStep::Enter(DeviceMode::CALIBRATION), run];
        let led = [&told[..], &[ProcedureStep::ReturnToOperation]].concat();
        assert_eq!(step_status(&led, Some(run), false), [Done, Done, Done, Failed, Ahead, Ahead, Done]);
        assert_eq!(step_status(&led, Some(run), true), [Done, Done, Done, Failed, Ahead, Ahead, Ahead]);
        // If the link is lost, no return to operation is reported.
        assert_eq!(step_status(&told, Some(run), true), [Done, Done, Done, Failed, Ahead, Ahead, Ahead]);
        // The encoder never left operation.
        assert_eq!(step_status(&told[..2], Some(turn), false), [Done, Failed, Ahead, Ahead, Ahead, Ahead, Ahead]);
        // The return to operation itself failed.
        assert_eq!(
            step_status(&led, Some(ProcedureStep::ReturnToOperation), true),
            [Done, Done, Done, Done, Done, Done, Failed]
        );
        assert_eq!(step_status(&[], None, false), [Ahead; 7]);
    }

    #[test]
    fn cancelled_procedure_has_not_failed() {
        let mut guide = ProcedureRun::new(vec![Op::Calibrate]);
        guide.set_progress(ProcedureProgress { op: 0, step: ProcedureStep::Conditions, detail: StepDetail::Begins });
        guide.cut = Some(ProcedureStep::Conditions);
        let (texts, before) = (Vec::new(), Vec::new());
        guide.end = Some(ProcedureEnd::Failed { texts, before, may_return_to_operation: false, cancelled: true });
        assert_eq!(guide.steps().first().map(|own| own.reached), Some(StepStatus::Cancelled));
    }
}
