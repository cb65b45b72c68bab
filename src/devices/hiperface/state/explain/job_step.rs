//! Descriptions of job steps.

use super::operation_texts;
use crate::app::Text;
use crate::devices::hiperface::jobs::JobStep;
use crate::devices::hiperface::procedures::find::SearchStep;
use crate::devices::hiperface::state::TEXTS;

pub fn step_text(job_step: &JobStep) -> Text {
    match job_step {
        JobStep::Field(field) => TEXTS.text("op.field").with("field", field),
        JobStep::Operation(operation) => operation_texts(operation, None).item,
        JobStep::Attempt(SearchStep::Listening) => TEXTS.text("doing.listening"),
        JobStep::Attempt(SearchStep::DefaultWindow) => TEXTS.text("doing.default_window"),
        JobStep::Attempt(SearchStep::Probing { address, format }) => {
            TEXTS.text("doing.probing").with("address", format!("{address:02X}h")).with("format", format)
        }
    }
}
