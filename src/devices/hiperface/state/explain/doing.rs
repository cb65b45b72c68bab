//! The step that a job is at, in words.

use super::op;
use crate::app::Text;
use crate::devices::hiperface::jobs::Doing;
use crate::devices::hiperface::procedures::find::Attempt;
use crate::devices::hiperface::state::TEXTS;

/// What a job does at the moment.
pub fn doing(doing: &Doing) -> Text {
    match doing {
        Doing::Field(field) => TEXTS.text("op.field").with("field", field),
        Doing::Operation(operation) => op(operation).item,
        Doing::Attempt(Attempt::Listening) => TEXTS.text("doing.listening"),
        Doing::Attempt(Attempt::DefaultWindow) => TEXTS.text("doing.default_window"),
        Doing::Attempt(Attempt::Probing { address, format }) => {
            TEXTS.text("doing.probing").with("address", format!("{address:02X}h")).with("format", format)
        }
    }
}
