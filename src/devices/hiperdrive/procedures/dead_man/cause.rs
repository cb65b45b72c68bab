//! Reasons why a running action ends early.

use super::{
    ActionEnd, CONTACT_TIMEOUT, DeadMan, MotionIntent, MotionKind, MotionLock, MotionRejection, MotionRequest, Permit,
    Stage,
};
use crate::devices::hiperdrive::protocol::{ActualValues, StatusBit};
use crate::units::Moment;

impl DeadMan {
    /// Ends the running motion if an end condition is met.
    pub(super) fn check_end_conditions(
        &mut self,
        now: Moment,
        actual: ActualValues,
        intent: &MotionIntent,
        permit: &Permit,
    ) {
        if self.act.is_none() {
            return;
        }
        self.accept_pause_or_resume(intent, permit, now);
        if let Some(how) = self.cause(now, actual, intent, permit) {
            if self.stage.has_motion() {
                self.stop(now, how);
            } else {
                self.end_action(how);
                self.hold_state(actual.status.state());
            }
        }
    }

    /// Pauses or resumes the job if requested. The request must directly follow the previous one, because a stop in
    /// between may have been missed.
    fn accept_pause_or_resume(&mut self, intent: &MotionIntent, permit: &Permit, now: Moment) {
        let mark = self.current_mark(now);
        let Some(act) = &mut self.act else { return };
        let fresh = intent.drive == self.drive && intent.number == act.number + 1 && !intent.is_stale(now);
        let job = matches!(act.motion, Some(motion) if matches!(motion.kind, MotionKind::Job { .. }));
        if !fresh || !job {
            return;
        }
        match (self.stage, intent.request) {
            (Stage::Go { acknowledged, .. }, MotionRequest::Pause) => {
                (act.number, act.request) = (intent.number, intent.request);
                self.stage = Stage::Paused { since: mark, acknowledged };
            }
            (Stage::Paused { acknowledged, .. }, MotionRequest::Resume)
                if permit.locks.is_empty() && !permit.doubted =>
            {
                (act.number, act.request) = (intent.number, intent.request);
                self.stage = Stage::Go { since: mark, acknowledged, standing_since: None };
            }
            _ => {}
        }
    }

    fn cause(
        &mut self,
        now: Moment,
        actual: ActualValues,
        intent: &MotionIntent,
        permit: &Permit,
    ) -> Option<ActionEnd> {
        let act = self.act?;
        let status = actual.status;
        let state = status.state();
        let is_out_of_contact = self.received.is_none_or(|(at, _)| now.duration_since(at) > CONTACT_TIMEOUT);
        let (down, acknowledges) = match (self.stage, act.request) {
            (Stage::Lead(lead), MotionRequest::Lead(_)) => {
                (lead.is_torque_removal(state), lead.goal() == super::TargetState::Off)
            }
            (_, MotionRequest::Acknowledge) => (false, true),
            _ => (false, false),
        };
        let moves = self.stage.has_motion();
        if status.is_set(StatusBit::Fault) && !acknowledges {
            return Some(ActionEnd::Fault);
        }
        if is_out_of_contact {
            return Some(ActionEnd::Deaf);
        }
        if let Some(how) = self.superseded_end(act.number, act.request, intent, permit) {
            return Some(how);
        }
        if intent.is_stale(now) && !down {
            return Some(ActionEnd::Stale);
        }
        if moves && !status.is_set(StatusBit::OperationEnabled) {
            return Some(ActionEnd::Left(state));
        }
        if let (Stage::Go { acknowledged, .. } | Stage::Paused { acknowledged, .. }, false) =
            (self.stage, self.is_speed_mode())
            && status.is_set(StatusBit::SetpointAcknowledged) == acknowledged
        {
            // The drive has restarted. The control word being sent would start the job again.
            return Some(ActionEnd::Left(state));
        }
        let motion = act.motion?;
        match permit.check_request(motion.request, motion.kind.target()) {
            Ok(()) => self.watch_motion(now, actual, permit),
            Err(MotionRejection::Locked(lock)) => Some(ActionEnd::Locked(lock)),
            Err(refusal) => Some(ActionEnd::Refused(refusal)),
        }
    }

    /// Returns how a motion ends that is no longer requested, or `None` if it is still requested.
    fn superseded_end(
        &self,
        number: u64,
        request: MotionRequest,
        intent: &MotionIntent,
        permit: &Permit,
    ) -> Option<ActionEnd> {
        let rests = matches!(
            intent.request,
            MotionRequest::Rest | MotionRequest::Stop | MotionRequest::Pause | MotionRequest::Resume
        );
        if intent.drive == self.drive && intent.number == number && intent.request == request {
            None
        } else if intent.request == MotionRequest::Resume && permit.doubted {
            Some(ActionEnd::Refused(MotionRejection::Locked(MotionLock::Outdated)))
        } else if rests || intent.number < number {
            Some(ActionEnd::Stopped)
        } else {
            Some(ActionEnd::Replaced)
        }
    }
}
