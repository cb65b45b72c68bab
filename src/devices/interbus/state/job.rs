//! Names of jobs, and their effect on a running machine.

use crate::app::Text;
use crate::devices::interbus::jobs::InterbusJob;
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain;

pub(super) fn job_name(job: &InterbusJob) -> Text {
    match job {
        InterbusJob::Hello | InterbusJob::Position => TEXTS.text("ib_job.word"),
        InterbusJob::Survey | InterbusJob::Identify => TEXTS.text("ib_job.survey"),
        InterbusJob::Programs(_) => TEXTS.text("ib_job.programs"),
        InterbusJob::Status => Text::new("job.status"),
        InterbusJob::Check => Text::new("job.check"),
        InterbusJob::Read(item) => Text::new("job.read").with("item", item),
        InterbusJob::ReadOut(what) => Text::new("job.read").with_text("item", explain::read_out(*what)),
        InterbusJob::Select(mode) => TEXTS.text("ib_job.select").with_text("mode", explain::startup_mode_text(*mode)),
        InterbusJob::Save { .. } => Text::new("job.save"),
        InterbusJob::Prepare(change) => Text::new("job.prepare").with_text("change", explain::change_text(change)),
        InterbusJob::Commit(_) => Text::new("job.write"),
        InterbusJob::RestoreMode => Text::new("job.lead_back"),
    }
}

/// Returns whether a job interrupts the position or switches outputs, so that the machine must be at standstill.
pub(super) fn requires_standstill(job: &InterbusJob) -> bool {
    !matches!(job, InterbusJob::Hello | InterbusJob::Position)
}
