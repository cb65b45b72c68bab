//! The associated types and functions of a kind of device, so that opening, leaving and running are the same for all.

#![warn(missing_docs)]

use crate::app::action::OpenFailed;
use crate::app::services::JobEnd;
use crate::app::session::{DraftEdits, first};
use crate::app::{Severity, Text, explain};
use crate::link::LinkUrl;
use crate::store::Store;
use crate::worker::{Device, Event, JobId, OpenError, Session};

/// A kind of device on the desk.
pub trait Kind: Device + Sized {
    /// Its name in profiles.
    const KIND: &'static str;

    /// The edits that are kept over a crash.
    type Edits: DraftEdits;

    /// The part of a session outside its thread.
    type SessionHandle: Send;

    /// Review of a write: the [`Review`](crate::app::review::Review) of a kind with a memory.
    type Review;

    /// Whether its live values may start by themselves, on a line that has no other master.
    const STARTS_LIVE: bool = true;

    /// Returns the handle of a session before the session moves to its thread.
    fn session_handle(session: &Session<Self>) -> Self::SessionHandle;

    /// Opens links to such devices.
    ///
    /// # Errors
    /// The link cannot be opened, or is not for such a device.
    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError>;

    /// Returns why a link cannot be opened, and what to do.
    fn open_error(error: &OpenError) -> Text {
        explain::open(error)
    }

    /// Returns the same, or that it has no thread to run on.
    fn open_failed(failed: &OpenFailed) -> Text {
        explain::open_failed(failed, Self::open_error)
    }

    /// Returns a job as text.
    fn job_text(job: &Self::Job) -> Text;

    /// Returns whether a job changes the device's memory.
    fn writes(_job: &Self::Job) -> bool {
        false
    }

    /// Returns the job that reads everything displayed about the device.
    fn survey() -> Self::Job;

    /// Returns a step of a job as text.
    fn step_text(what: &Self::JobStep) -> Text;

    /// Returns the result of a writing job; `None` for any other.
    fn result_texts(_output: &Self::Output) -> Option<(Severity, Vec<Text>)> {
        None
    }

    /// Returns why a job ended early, and what to do.
    fn error_texts(error: &Self::Error) -> Vec<Text>;

    /// Returns why the connection failed, if nothing more can be requested over it.
    fn connection_error(error: &Self::Error) -> Option<Text>;

    /// Returns the last message about the job in an event of a released session.
    fn job_endings(event: &Event<Self>) -> Option<JobEnding> {
        let (job, end, (severity, texts)) = match event {
            Event::Finished(job, output) => {
                let result =
                    Self::result_texts(output).unwrap_or_else(|| (Severity::Note, vec![Text::new("session.ended")]));
                (job, JobEnd::Done, result)
            }
            Event::Cancelled(job, error) => (job, JobEnd::Cancelled, (Severity::Warning, Self::error_texts(error))),
            Event::Failed(job, error) => {
                let texts = Self::error_texts(error);
                (job, JobEnd::Failed(first(&texts)), (Severity::Error, texts))
            }
            _ => return None,
        };
        Some(JobEnding { job: *job, end, severity, texts })
    }
}

/// How the last job of a released session ended.
pub struct JobEnding {
    pub(in crate::app) job: JobId,
    pub(in crate::app) end: JobEnd,
    pub(in crate::app) severity: Severity,
    pub(in crate::app) texts: Vec<Text>,
}
