//! The associated types and functions of a kind of device, which allow opening, running and leaving sessions to be
//! shared.

#![warn(missing_docs)]

use crate::app::action::OpenFailure;
use crate::app::services::JobState;
use crate::app::session::{DraftEdits, first};
use crate::app::{Severity, Text, explain};
use crate::link::LinkUrl;
use crate::store::Store;
use crate::worker::{Device, Event, JobId, OpenError, Session};

/// A kind of device, with everything that its sessions require.
pub trait Kind: Device + Sized {
    /// Name of the device kind in profiles.
    const KIND: &'static str;

    /// Edits that survive a crash.
    type Edits: DraftEdits;

    /// The part of a session that stays outside its thread.
    type SessionHandle: Send;

    /// Review of a write, which is [`Review`](crate::app::review::Review) for a kind with a memory.
    type Review;

    /// Whether live values may start automatically on a line without another master.
    const STARTS_LIVE: bool = true;

    /// Returns the handle that stays with the window when the session moves to its thread.
    fn session_handle(session: &Session<Self>) -> Self::SessionHandle;

    /// Opens a link to a device of this kind.
    ///
    /// # Errors
    /// Returns an error if the link cannot be opened or leads to a different kind of device.
    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError>;

    /// Explains why a link cannot be opened and what to do.
    fn open_error(error: &OpenError) -> Text {
        explain::open(error)
    }

    /// Explains why a link could not be opened, including the case that no thread could be started.
    fn open_failed(failed: &OpenFailure) -> Text {
        explain::open_failed(failed, Self::open_error)
    }

    /// Describes a job.
    fn job_text(job: &Self::Job) -> Text;

    /// Returns whether a job changes the memory of the device.
    fn writes(_job: &Self::Job) -> bool {
        false
    }

    /// Returns the job that reads all displayed values of the device.
    fn survey() -> Self::Job;

    /// Describes a step of a job.
    fn step_text(what: &Self::JobStep) -> Text;

    /// Describes the result of a job that writes. Returns `None` for other jobs.
    fn result_texts(_output: &Self::Output) -> Option<(Severity, Vec<Text>)> {
        None
    }

    /// Explains why a job ended early and what to do.
    fn error_texts(error: &Self::Error) -> Vec<Text>;

    /// Explains why the connection failed. Returns `None` if further requests are still possible over the connection.
    fn connection_error(error: &Self::Error) -> Option<Text>;

    /// Returns the final message about the job from an event of a released session, if the event ends the job.
    fn job_endings(event: &Event<Self>) -> Option<JobCompletion> {
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

/// The end of the last job of a released session.
pub struct JobCompletion {
    pub(in crate::app) job: JobId,
    pub(in crate::app) end: JobState,
    pub(in crate::app) severity: Severity,
    pub(in crate::app) texts: Vec<Text>,
}
