//! Job names for display.

use crate::app::Text;
use crate::devices::hiperdrive::jobs::HiperdriveJob;
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;

pub(super) fn job_name(job: &HiperdriveJob) -> Text {
    match job {
        HiperdriveJob::Hello | HiperdriveJob::Identify => TEXTS.text("hd_job.identify"),
        HiperdriveJob::Survey => TEXTS.text("hd_job.survey"),
        HiperdriveJob::Status => Text::new("job.status"),
        HiperdriveJob::Check => Text::new("job.check"),
        HiperdriveJob::Position(drive) => TEXTS.text("hd_job.position").with("drive", drive.get()),
        HiperdriveJob::Read(number) => Text::new("job.read").with_text("item", explain::parameter_name_text(*number)),
        HiperdriveJob::Network => TEXTS.text("hd_job.network"),
        HiperdriveJob::Save => Text::new("job.save"),
        HiperdriveJob::Prepare(change) => Text::new("job.prepare").with_text("change", explain::change_text(change)),
        HiperdriveJob::Commit(_) => Text::new("job.write"),
        HiperdriveJob::Take => TEXTS.text("hd_job.take"),
        HiperdriveJob::Give => TEXTS.text("hd_job.give"),
        HiperdriveJob::Watch(drive) => TEXTS.text("hd_job.watch").with("drive", drive.get()),
    }
}
