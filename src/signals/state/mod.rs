//! State of the Signals tab: a capture of sine and cosine from a file, a virtual encoder or an adapter, with its
//! results. Neither a window nor an encoder is needed. Long operations run as tasks, and late results are ignored.

mod act;
mod action;
mod feed;
pub mod forms;
pub mod input_circuit;
pub mod interpolation;
mod live;
mod measurement;
mod quantities;
mod reading;
mod recent;
mod reference_comparison;
pub(crate) mod report;
mod scope;
mod spectra;
pub mod synchronise;
mod table;
mod task_guard;
mod texts;

pub(crate) use feed::{bridge_error_text, open_error_text};
pub use texts::TEXTS;

use crate::app::{Tab, Tool, ToolAction, ToolKind};

pub(crate) const TAB: Tab = Tab::named("Signals");

/// The entry for the Signals tab in the list of tools.
pub(crate) struct SignalsKind;

impl ToolKind for SignalsKind {
    fn tab(&self) -> Tab {
        TAB
    }

    fn create_tool(&self, links: &[String]) -> Box<dyn Tool> {
        Box::new(Signals::with_links(links))
    }
}

impl ToolAction for SignalsAction {
    const TAB: Tab = TAB;
}

pub use act::Signals;
pub use action::{FailedTask, ReadCapture, SignalsAction, TaskResult};
pub use live::{Source, SourceAction, SourceKind, VIRTUAL_ADAPTER};
pub use measurement::{DiagnosisSettings, Measurement, MeasurementResult, Origin, TableSource};
pub use quantities::{Quantity, QuantityLimit, Unit, error_quantities, signal_quantities};
pub use reading::{CaptureReading, ExampleCapture};
pub use reference_comparison::{AbsoluteOffset, Nonlinearities, OffsetError, nonlinearity_quantities};
pub use scope::{Scope, TimeAxisError};
pub use spectra::{ChannelSpectrum, Spectra, to_decibel_volts};
pub use table::{Column, Table};
