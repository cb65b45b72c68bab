//! What is done on the line, in words.

use crate::app::Text;
use crate::devices::ssi::jobs::SsiJob;

/// What a job is.
pub(super) fn job(job: &SsiJob) -> Text {
    match job {
        SsiJob::Hello => Text::new("ssi_job.hello"),
        SsiJob::Set(asking) => Text::new("ssi_job.set").with("clocks", asking.clocks),
        SsiJob::Check(_) => Text::new("job.check"),
        SsiJob::Read => Text::new("ssi_job.read"),
    }
}
