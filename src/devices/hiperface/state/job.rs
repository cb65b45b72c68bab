//! Job names for display.

use crate::app::Text;
use crate::bits::hex;
use crate::devices::hiperface::jobs::HiperfaceJob;
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::explain;

pub(super) fn job_name(job: &HiperfaceJob) -> Text {
    match job {
        HiperfaceJob::Identify | HiperfaceJob::Survey => Text::new("job.survey"),
        HiperfaceJob::Status => Text::new("job.status"),
        HiperfaceJob::Position(_) => Text::new("job.position"),
        HiperfaceJob::Rest => TEXTS.text("job.rest"),
        HiperfaceJob::Read(item) => Text::new("job.read").with_text("item", explain::item_text(item)),
        HiperfaceJob::Save(_) => Text::new("job.save"),
        HiperfaceJob::Check { .. } => Text::new("job.check"),
        HiperfaceJob::Reset => TEXTS.text("job.reset"),
        HiperfaceJob::Find(_) => TEXTS.text("job.find"),
        HiperfaceJob::ConfigureForNow(settings) => {
            TEXTS.text("job.configure_for_now").with("settings", hex(&[settings.byte()]))
        }
        HiperfaceJob::UseCode { number, .. } => TEXTS.text("job.use_code").with("number", number),
        HiperfaceJob::Prepare(change) => Text::new("job.prepare").with_text("change", explain::change_text(change)),
        HiperfaceJob::Commit(_) => Text::new("job.write"),
    }
}
