//! The parts common to all sessions: source, connection, line, trace, backups and writes. Each kind of device adds
//! further parts.

mod drafted;
mod drafts;
mod has_session;
mod kind;
mod memory;
mod profiles;
mod saved;
mod saving;
mod session_events;
mod state;

use std::ops::{Deref, DerefMut};
use std::path::PathBuf;
use std::time::Duration;

pub use drafted::HasDraft;
pub(in crate::app) use drafts::{ActiveDraft, file_key};
pub use drafts::{DraftEdits, DraftKey, DraftOutcome};
pub use has_session::HasSession;
pub use kind::{JobCompletion, Kind};
pub use memory::{ApprovedReviewPlan, HasMemory};
pub use profiles::DeviceHistory;
pub use saved::{HasProfile, KnownProfile, unsaved_edits_remark};
pub(in crate::app) use saving::DivergedFile;
pub use saving::{FileSnapshot, ProfileFile, SaveRequest};
pub(crate) use session_events::first;
pub use session_events::{Interruption, SessionEvents};
pub use state::SessionState;

use super::action::OpenedConnection;
pub(crate) use super::explain::truncated_list;
use super::kinds::KindRegistry;
use super::live_session::LiveSession;
use super::services::{JobState, Services};
use super::shutdown::ClosingSessionInfo;
use super::studio::SessionId;
use super::{Severity, Text};
use crate::link::{LinkScheme, LinkUrl};
use crate::profile::ProfileDocument;
use crate::worker::SubmitError;

#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Link(LinkUrl),
    File {
        path: PathBuf,
        key: String,
        /// The document without the user's edits.
        document: Box<ProfileDocument>,
        /// Text of the file. The user's comments, order and line endings are preserved.
        text: String,
    },
    /// A new profile that has never been saved.
    New {
        suggested: PathBuf,
    },
}

impl Source {
    /// Returns the suggested name of a profile that has not been saved.
    pub(in crate::app) fn suggested_path(&self) -> Option<PathBuf> {
        match self {
            Source::New { suggested } => Some(suggested.clone()),
            Source::Link(_) | Source::File { .. } => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    Opening,
    Connected,
    /// The link is open, but the device does not reply. Contains the reason and a remedy.
    Silent(Text),
    /// The connection was lost or could not be opened. Contains the reason and a remedy.
    Lost(Text),
    /// A profile that is open without a connection.
    Offline,
}

pub(crate) struct PendingOpen {
    pub(crate) attempt: Option<u32>,
    /// Channel that closes when the attempt to open the link has ended.
    pub(crate) over: crossbeam_channel::Receiver<()>,
    pub(crate) is_sole_master: bool,
}

pub struct Session<D: Kind> {
    state: SessionState,
    pub(crate) line: Option<LiveSession<D>>,
    pub(crate) drafting: ActiveDraft<D::Edits>,
    pub review: Option<D::Review>,
}

/// Gives direct access to the session's common state.
impl<D: Kind> Deref for Session<D> {
    type Target = SessionState;

    fn deref(&self) -> &SessionState {
        &self.state
    }
}

impl<D: Kind> DerefMut for Session<D> {
    fn deref_mut(&mut self) -> &mut SessionState {
        &mut self.state
    }
}

impl<D: Kind> Session<D> {
    /// Creates a session for a link that is being opened. `kinds` determine which link parameters are secret.
    pub fn for_link(id: SessionId, url: LinkUrl, kinds: KindRegistry) -> Self {
        let mut own = Session::new(id, Source::Link(url), Phase::Opening);
        own.kinds = kinds;
        own
    }

    pub fn from_file(id: SessionId, file: ProfileFile, document: ProfileDocument) -> Self {
        Session::new(id, file.source(document), Phase::Offline)
    }

    /// Creates a session for a profile without a tab, such as one shown in a report.
    pub(crate) fn without_tab(document: &ProfileDocument) -> Self {
        let file = ProfileFile { path: PathBuf::new(), key: String::new(), text: String::new() };
        Session::from_file(SessionId::default(), file, document.clone())
    }

    /// Creates a session for a profile that has not been saved.
    pub(crate) fn new_unsaved(id: SessionId, suggested: PathBuf) -> Self {
        Session::new(id, Source::New { suggested }, Phase::Offline)
    }

    fn new(id: SessionId, source: Source, phase: Phase) -> Self {
        Session {
            state: SessionState::new(id, source, phase),
            line: None,
            drafting: ActiveDraft::new(id),
            review: None,
        }
    }

    pub fn live_session(&self) -> Option<&LiveSession<D>> {
        self.line.as_ref()
    }

    pub fn is_virtual(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_virtual)
            || matches!(&self.source, Source::Link(url) if url.scheme == LinkScheme::Sim)
    }

    pub fn is_busy(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.running_job().is_some())
    }

    pub fn is_writing(&self) -> bool {
        self.line.as_ref().and_then(LiveSession::running_job).is_some_and(|running| running.writes)
    }

    pub fn is_polling(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.polling_interval().is_some())
    }

    pub fn is_active(&self) -> bool {
        self.phase == Phase::Opening || self.is_busy() || self.is_polling()
    }

    /// Returns whether the device is connected and idle, so that a job may start.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Connected && self.line.is_some() && !self.is_busy()
    }

    /// Returns whether the device can be read again. This is also `true` for a device that does not reply, and for a
    /// profile.
    pub fn is_readable(&self) -> bool {
        self.is_savable() || (matches!(self.phase, Phase::Silent(_)) && self.line.is_some() && !self.is_busy())
    }

    pub fn is_savable(&self) -> bool {
        self.is_ready() || self.phase == Phase::Offline
    }

    pub fn attach_connection(&mut self, opened: OpenedConnection<D>, services: &mut Services) {
        let is_sole_master = self.opening.take().is_some_and(|opening| opening.is_sole_master);
        self.trace.begin_connection(opened.began.clone());
        self.line = Some(LiveSession::new(opened));
        self.live_due = D::STARTS_LIVE && (is_sole_master || self.is_virtual());
        self.phase = Phase::Connected;
        services.log.remove_from_window("session.not_connected", Some(&self.name()));
        self.just_connected = true;
    }

    /// Sets the polling interval, or stops polling. Returns whether polling starts with this call, or `None` without a
    /// connection.
    pub(crate) fn poll(&mut self, interval: Option<Duration>) -> Option<bool> {
        let line = self.line.as_mut()?;
        let begins = line.polling_interval().is_none();
        line.poll(interval);
        Some(begins)
    }

    /// Handles the end of polling and its reason. `is_silent` is set if the device does not reply at all. Has no effect
    /// if polling has been requested again in the meantime.
    pub(in crate::app) fn handle_polling_failure(&mut self, why: Vec<Text>, is_silent: bool, services: &mut Services) {
        if self.is_polling() {
            return;
        }
        let silent = why.first().filter(|_| is_silent && !self.is_busy()).cloned();
        let stands_there = silent.is_some();
        if let Some(why) = silent {
            self.phase = Phase::Silent(why);
        }
        let texts = std::iter::once(Text::new("session.poll_failed")).chain(why).collect();
        self.report_message(Severity::Error, texts, stands_there, services);
    }

    /// Starts a job. If this is impossible, reports the reason and returns `false`.
    pub(crate) fn submit(&mut self, job: D::Job, services: &mut Services) -> bool {
        let (name, what, writes) = (self.name(), D::job_text(&job), D::writes_memory(&job));
        let Some(line) = &mut self.line else {
            services.notify(Severity::Error, vec![Text::new("session.not_connected")], Some(&name));
            return false;
        };
        match line.submit(job, what.clone(), writes, services.current_time()) {
            Ok(id) => {
                services.record_job_start(self.id, id, &name, what);
                return true;
            }
            Err(SubmitError::Busy | SubmitError::Unread) => {
                services.notify(Severity::Warning, vec![Text::new("session.busy")], Some(&name));
            }
            // The last events of the session report how it ended.
            Err(SubmitError::Ended) => {}
        }
        false
    }

    /// Returns the reason why no plan can currently be made, if any.
    pub(crate) fn plan_obstacle(&self) -> Option<Text> {
        match &self.phase {
            _ if self.is_ready() => None,
            _ if self.is_busy() => Some(Text::new("session.busy")),
            Phase::Silent(why) => Some(why.clone()),
            _ => Some(Text::new("session.not_connected")),
        }
    }

    /// Stops the running job, or cancels the opening of a link.
    pub(crate) fn stop(&mut self, services: &mut Services) {
        self.live_due = false;
        if self.phase == Phase::Opening {
            let why = Text::new("session.open_cancelled");
            services.log_without_display(Severity::Note, vec![why.clone()], Some(&self.name()));
            self.phase = Phase::Lost(why);
            if let Some(opening) = &mut self.opening {
                // Results of this attempt are ignored. The next attempt waits until it has ended.
                opening.attempt = None;
            }
        }
        if let Some(line) = &mut self.line {
            line.stop();
        }
    }

    /// Releases the session's thread and ends the running job with `end`. A cancelled write ends later and reports its
    /// own result.
    pub(crate) fn release_thread(&mut self, end: JobState, services: &mut Services) {
        self.save_to = None;
        let Source::Link(url) = &self.source else { return };
        let (url, about) = (url.clone(), self.name());
        let Some(line) = self.line.take() else { return };
        let write = line.running_job().filter(|running| running.writes && end == JobState::Cancelled).map(|own| own.id);
        if let Some(running) = line.running_job().filter(|_| write.is_none()) {
            services.end_job(self.id, running.id, end);
        }
        services.release_worker(line.into_worker(), ClosingSessionInfo { session: self.id, about, url, write }, None);
    }

    pub(in crate::app) fn connection_lost(&mut self, why: Text, services: &mut Services) {
        // The session itself displays the message.
        services.log.remove_minor(&self.name());
        services.log_without_display(Severity::Error, vec![why.clone()], Some(&self.name()));
        self.release_thread(JobState::Failed(why.clone()), services);
        self.opening = None;
        self.phase = Phase::Lost(why);
    }
}
