//! The types and functions that define a kind of device, so that sessions of all kinds can be opened, run and released
//! in the same way.

#![warn(missing_docs)]

use crate::app::action::OpenFailure;
use crate::app::services::JobState;
use crate::app::session::{DraftEdits, first};
use crate::app::{Severity, Text, explain};
use crate::link::LinkUrl;
use crate::store::Store;
use crate::worker::{Device, Event, JobId, OpenError, Session};

/// A kind of device, as needed by its sessions.
pub trait Kind: Device + Sized {
    /// Name of the kind of device in profiles.
    const KIND: &'static str;

    /// Edits that survive a crash.
    type Edits: DraftEdits;

    /// Handle that stays with the window while the session runs on its thread.
    type SessionHandle: Send;

    /// Review of a write: [`Review`](crate::app::review::Review) for a kind of device with a memory.
    type Review;

    /// Whether live values may start automatically on a line without another master.
    const STARTS_LIVE: bool = true;

    /// Returns the handle that stays with the window when the session moves to its thread.
    fn session_handle(session: &Session<Self>) -> Self::SessionHandle;

    /// Opens a link to a device of this kind.
    ///
    /// # Errors
    /// Returns an error if the link cannot be opened or refers to another kind of device.
    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError>;

    /// Returns the reason why a link cannot be opened, and what to do.
    fn open_error(error: &OpenError) -> Text {
        explain::open_error_text(error)
    }

    /// Returns the reason why a link could not be opened or its thread could not be started.
    fn open_failure_text(failed: &OpenFailure) -> Text {
        explain::open_failure_text(failed, Self::open_error)
    }

    /// Returns the name of a job.
    fn job_text(job: &Self::Job) -> Text;

    /// Returns whether a job writes to the memory of the device.
    fn writes_memory(_job: &Self::Job) -> bool {
        false
    }

    /// Returns the job that reads all displayed values of the device.
    fn survey_job() -> Self::Job;

    /// Returns the description of a step of a job.
    fn step_text(what: &Self::JobStep) -> Text;

    /// Returns the message about the result of a writing job, or `None` for any other job.
    fn result_texts(_output: &Self::Output) -> Option<(Severity, Vec<Text>)> {
        None
    }

    /// Returns the reason why a job was aborted, and what to do.
    fn error_texts(error: &Self::Error) -> Vec<Text>;

    /// Returns the reason why the connection was lost, or `None` if the error does not end the connection.
    fn connection_error(error: &Self::Error) -> Option<Text>;

    /// Returns the message about the last job of a released session, or `None` if the event does not end a job.
    fn job_completions(event: &Event<Self>) -> Option<JobCompletion> {
        let (job, end, (severity, texts)) = match event {
            Event::Finished(job, output) => {
                let result =
                    Self::result_texts(output).unwrap_or_else(|| (Severity::Note, vec![Text::new("session.ended")]));
                (job, JobState::Done, result)
            }
            Event::Cancelled(job, error) => (job, JobState::Cancelled, (Severity::Warning, Self::error_texts(error))),
            Event::Failed(job, error) => {
                let texts = Self::error_texts(error);
                (job, JobState::Failed(first(&texts)), (Severity::Error, texts))
            }
            _ => return None,
        };
        Some(JobCompletion { job: *job, end, severity, texts })
    }
}

/// How the last job of a released session has ended.
pub struct JobCompletion {
    pub(in crate::app) job: JobId,
    pub(in crate::app) end: JobState,
    pub(in crate::app) severity: Severity,
    pub(in crate::app) texts: Vec<Text>,
}
