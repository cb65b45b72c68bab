//! The panels around the workspace: live values, trace, jobs and log.

mod lists;
pub(crate) mod live;
mod trace;

pub(super) use lists::{jobs_ui, log_ui};
pub(super) use live::{live_ui, plot_ui};
pub(super) use trace::{TraceView, trace_ui};
