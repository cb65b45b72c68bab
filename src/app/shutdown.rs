//! Released sessions that are still ending. Until they have ended, the window cannot close and their connections are
//! not free.

use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::Sender;

use super::action::{Action, TaskResult};
use super::brakes::DriveStopHandles;
use super::services::{JobState, Services};
use super::session::{JobCompletion, Kind};
use super::studio::SessionId;
use super::{Severity, Text};
use crate::link::{LinkUrl, Wire};
use crate::worker::stream::StreamEnd;
use crate::worker::{EndingWorker, JobId, Worker};

/// Maximum waiting times for closing a session or the window, and for a connection that is still in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GracePeriods {
    pub drives: Duration,
    pub disk: Duration,
    /// Maximum waiting time for a job that does not write anything.
    pub job: Duration,
    /// Maximum waiting time for a write, which must first reach a safe point and lock the memory again.
    pub write: Duration,
}

impl Default for GracePeriods {
    fn default() -> Self {
        GracePeriods {
            drives: DriveStopHandles::SHUTDOWN_TIMEOUT,
            disk: Duration::from_secs(3),
            job: Duration::from_secs(10),
            write: Duration::from_secs(90),
        }
    }
}

pub(crate) struct ClosingSessionInfo {
    pub(crate) session: SessionId,
    pub(crate) about: String,
    pub(crate) url: LinkUrl,
    pub(crate) write: Option<JobId>,
}

pub(super) struct ClosingSession {
    info: ClosingSessionInfo,
    ending: Arc<dyn ClosingWorker>,
}

pub(crate) trait ClosingWorker: Send + Sync {
    /// Returns whether the thread has ended and the connection is free.
    fn is_finished(&self) -> bool;

    /// Waits for at most `patience` until the session has ended, and returns whether it has.
    fn wait_for_end(&self, patience: Duration) -> bool;

    fn job_completions(&self) -> Vec<JobCompletion>;
}

impl<D: Kind> ClosingWorker for EndingWorker<D> {
    fn is_finished(&self) -> bool {
        EndingWorker::is_finished(self)
    }

    fn wait_for_end(&self, patience: Duration) -> bool {
        EndingWorker::wait_for_end(self, patience)
    }

    fn job_completions(&self) -> Vec<JobCompletion> {
        self.events().try_iter().filter_map(|event| D::job_completions(&event)).collect()
    }
}

impl ClosingWorker for StreamEnd {
    fn is_finished(&self) -> bool {
        self.has_ended()
    }

    fn wait_for_end(&self, patience: Duration) -> bool {
        StreamEnd::wait_for_end(self, patience)
    }

    fn job_completions(&self) -> Vec<JobCompletion> {
        Vec::new()
    }
}

pub(crate) fn is_same_connection(one: &LinkUrl, other: &LinkUrl) -> bool {
    one.wire() == other.wire() && one.wire() != Wire::InProcess
}

impl Services {
    /// Releases the thread of a session. When the thread ends, `turn` is dropped, which frees the connection for its
    /// next user.
    pub(crate) fn release_worker<D: Kind>(
        &mut self,
        worker: Worker<D>,
        info: ClosingSessionInfo,
        turn: Option<Sender<()>>,
    ) {
        self.close_session_thread(Arc::new(worker.end()), info, turn);
    }

    /// Releases a stream that belongs to no session.
    pub(crate) fn close_stream(&mut self, end: StreamEnd, url: LinkUrl) {
        let info = ClosingSessionInfo { session: SessionId::default(), about: String::new(), url, write: None };
        self.close_session_thread(Arc::new(end), info, None);
    }

    fn close_session_thread(
        &mut self,
        ending: Arc<dyn ClosingWorker>,
        info: ClosingSessionInfo,
        turn: Option<Sender<()>>,
    ) {
        let (watched, patience) = (ending.clone(), self.closing_timeout(info.write.is_some()));
        self.tasks.run("leave", move || {
            watched.wait_for_end(patience);
            drop(turn);
            Action::Done(TaskResult::Left)
        });
        self.closing_sessions.push(ClosingSession { info, ending });
    }

    pub(super) fn poll_closing_sessions(&mut self) {
        let mut endings = Vec::new();
        self.closing_sessions.retain_mut(|closing| {
            // The order matters: a thread that has ended does not report anything more.
            let ended = closing.ending.is_finished();
            for end in closing.ending.job_completions() {
                if closing.info.write == Some(end.job) {
                    closing.info.write = None;
                    endings.push((closing.info.session, closing.info.about.clone(), end));
                }
            }
            if ended && let Some(job) = closing.info.write.take() {
                let why = Text::new("session.ended");
                let end = JobState::Failed(why.clone());
                let end = JobCompletion { job, end, severity: Severity::Error, texts: vec![why] };
                endings.push((closing.info.session, closing.info.about.clone(), end));
            }
            !ended
        });
        for (session, about, last) in endings {
            self.end_job(session, last.job, last.end);
            self.notify(last.severity, last.texts, Some(&about));
        }
    }

    /// Returns whether any session that is ending is still writing.
    pub(super) fn has_closing_write(&self) -> bool {
        self.closing_sessions.iter().any(|closing| closing.info.write.is_some())
    }

    /// Returns the sessions that are still ending on a link's connection, each with its maximum waiting time.
    pub(crate) fn sessions_closing_on_link(&self, url: &LinkUrl) -> Vec<(Arc<dyn ClosingWorker>, Duration)> {
        let own = self.closing_sessions.iter().filter(|closing| is_same_connection(&closing.info.url, url));
        own.map(|closing| (closing.ending.clone(), self.closing_timeout(closing.info.write.is_some()))).collect()
    }

    fn closing_timeout(&self, writes: bool) -> Duration {
        if writes { self.world.patience.write } else { self.world.patience.job }
    }
}
