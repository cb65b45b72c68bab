//! Descriptions of job steps.

use super::op;
use crate::app::Text;
use crate::devices::hiperface::jobs::JobStep;
use crate::devices::hiperface::procedures::find::Attempt;
use crate::devices::hiperface::state::TEXTS;

pub fn step_text(job_step: &JobStep) -> Text {
    match job_step {
        JobStep::Field(field) => TEXTS.text("op.field").with("field", field),
        JobStep::Operation(operation) => op(operation).item,
        JobStep::Attempt(Attempt::Listening) => TEXTS.text("doing.listening"),
        JobStep::Attempt(Attempt::DefaultWindow) => TEXTS.text("doing.default_window"),
        JobStep::Attempt(Attempt::Probing { address, format }) => {
            TEXTS.text("doing.probing").with("address", format!("{address:02X}h")).with("format", format)
        }
    }
}
