//! Writes edits or a profile to an encoder, and selects the values to read again afterwards.

use super::cams::labels;
use super::encoder::Encoder;
use super::review::Review;
use crate::app::session::{
    ApprovedReviewPlan, HasMemory, HasProfile, KnownProfile, truncated_list, unsaved_edits_remark,
};
use crate::app::{PendingEdits, Text};
use crate::devices::interbus::jobs::{Change, Interbus, InterbusJob};
use crate::devices::interbus::profile::{
    Image, InterbusPlan, InterbusProfile, Op, RestoreOptions, check_device, other_type,
};
use crate::devices::interbus::protocol::ProgramNumber;
use crate::devices::interbus::state::TEXTS;
use crate::profile::{Body, ProfileError};

impl Encoder {
    /// Returns the edited values. Unedited programs are left out, since a plan would have to select them to read them.
    /// If the measuring range becomes shorter, all known programs are included, since their cams must lie within the
    /// new range.
    fn edited_image(&self) -> Option<Image> {
        let (wanted, device) = (&self.staged.edited_values()?.image, self.staged.device()?);
        let mut edited = Image::from_parameters(wanted.parameters);
        edited.shift = wanted.shift.filter(|shift| device.shift != Some(*shift));
        let shrinks = wanted.parameters.steps < device.parameters.steps;
        for (number, program) in wanted.known_programs() {
            let differs = device.program(number) != Some(program);
            if let Some(own) = edited.program_mut(number).filter(|_| differs || shrinks) {
                *own = Some(*program);
            }
        }
        Some(edited)
    }
}

impl HasMemory for Encoder {
    fn edited_change(&self) -> Option<Change> {
        let edited = self.edited_image().filter(|_| self.staged.is_dirty())?;
        Some(Change::Write(Box::new(edited)))
    }

    fn is_for_other_device(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        check_device(profile, &own.profile()).is_err()
    }

    fn is_for_other_type(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        other_type(&profile.identity, &own.profile()).is_some()
    }

    fn prepare_job(change: Change) -> InterbusJob {
        InterbusJob::Prepare(change)
    }

    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Interbus>) -> InterbusJob {
        InterbusJob::Commit(Box::new(agreed))
    }

    fn schedule_rereads(&mut self) {
        let programs =
            self.open_review().and_then(Review::plan_in_progress).and_then(|own| changed_programs(&own.plan));
        self.read_after = programs.unwrap_or_else(|| self.known_programs());
    }

    fn discard_device_data(&mut self) {
        (self.survey, self.check, self.refusal) = (None, None, None);
        self.staged.clear();
        self.read_outs.clear();
        self.record.clear();
    }
}

impl HasProfile for Encoder {
    fn read_all() -> InterbusJob {
        InterbusJob::Save { programs: true }
    }

    fn edited_body(&self) -> Option<Body> {
        Some(Body::new(self.edited_profile()?))
    }

    fn save_remarks(&self) -> Vec<Text> {
        truncated_list(&labels::describe_findings(&self.findings()), Text::clone)
    }

    fn last_read_profile(&self) -> Option<KnownProfile> {
        let (survey, base) = (self.survey.as_ref()?, self.staged.base()?);
        let is_missing = |number: &ProgramNumber| base.image.program(*number).is_none();
        let missing: Vec<Text> = ProgramNumber::all()
            .filter(is_missing)
            .map(|number| TEXTS.text("ib_startup.program").with("program", number.get()))
            .collect();
        if !missing.is_empty() {
            return Some(Err(missing));
        }
        let profile = InterbusProfile::new(survey.identity.profile(), base.image.clone(), survey.recorded_values());
        let profile = InterbusProfile { names: base.names.clone(), ..profile };
        let remarks = unsaved_edits_remark(self.staged.count()).into_iter().collect();
        Some(Ok((Body::new(profile), remarks)))
    }

    fn add_edits(&self, body: &mut Body) {
        let wanted = self.staged.edited_values();
        if let Some((profile, wanted)) = body.get_mut::<InterbusProfile>().zip(wanted) {
            profile.image = wanted.image.clone();
            profile.names = wanted.names.clone();
        }
    }

    fn restore_change(body: Body) -> Result<Change, ProfileError> {
        let profile = Box::new(body.into_profile()?);
        Ok(Change::Restore { profile, options: RestoreOptions::default() })
    }
}

/// Returns the programs that a plan changes, or `None` if it may change all of them.
fn changed_programs(plan: &InterbusPlan) -> Option<Vec<ProgramNumber>> {
    let of_programs = plan.base.programs.iter().map(|(number, _)| *number).collect();
    (!plan.ops.contains(&Op::Default)).then_some(of_programs)
}
