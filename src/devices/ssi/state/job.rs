//! Names of the jobs of an SSI encoder.

use crate::app::Text;
use crate::devices::ssi::jobs::SsiJob;
use crate::devices::ssi::state::TEXTS;

pub(super) fn job_name(job: &SsiJob) -> Text {
    match job {
        SsiJob::Hello => TEXTS.text("ssi_job.hello"),
        SsiJob::Set(clock_settings) => TEXTS.text("ssi_job.set").with("clocks", clock_settings.clocks),
        SsiJob::Check(_) => Text::new("job.check"),
        SsiJob::Read => TEXTS.text("ssi_job.read"),
    }
}
