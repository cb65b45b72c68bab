//! The parts that every session has, whatever its device: source, connection, line, trace, backups and writes. It knows
//! no device; the additions of a kind are in its own folder.

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

pub use drafted::Drafted;
pub use drafts::{DraftDone, DraftEdits, DraftKey};
pub(in crate::app) use drafts::{Drafting, file_key};
pub use has_session::HasSession;
pub use kind::{Kind, LastWords};
pub use memory::{ApprovedPlanOf, WithMemory};
pub use profiles::Listed;
pub(crate) use saved::some;
pub use saved::{Known, Saved, without_edits};
pub(in crate::app) use saving::Found;
pub use saving::{Guard, ProfileFile, Saving};
pub(crate) use session_events::first;
pub use session_events::{EarlyEnd, SessionEvents};
pub use state::SessionState;

use super::action::Opened;
use super::kinds::Kinds;
use super::live_session::LiveSession;
use super::services::{JobEnd, Services};
use super::shutdown::Leaver;
use super::studio::SessionId;
use super::{Severity, Text};
use crate::link::{LinkUrl, Scheme};
use crate::profile::Document;
use crate::worker::SubmitError;

/// The source of the data.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A device at the end of a link.
    Link(LinkUrl),
    /// A profile in a file.
    File {
        /// The file.
        path: PathBuf,
        /// The same for every way that leads to it.
        key: String,
        /// The document without the edits.
        document: Box<Document>,
        /// As it is written there: comments, order and line ends are its person's.
        text: String,
    },
    /// Made here, and in no file yet.
    New {
        /// A name to begin with.
        suggested: PathBuf,
    },
}

impl Source {
    /// Returns the name to begin with of what is in no file yet.
    pub(in crate::app) fn suggested(&self) -> Option<PathBuf> {
        match self {
            Source::New { suggested } => Some(suggested.clone()),
            Source::Link(_) | Source::File { .. } => None,
        }
    }
}

/// The state of the connection.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// The link is being opened.
    Opening,
    /// Connected, and the device answers.
    Connected,
    /// The link is open, and the device does not answer: why, and what to do.
    Silent(Text),
    /// It was connected, or could not be: why, and what to do.
    Lost(Text),
    /// A profile: there is no connection.
    Offline,
}

/// A link that is being opened.
pub(crate) struct Opening {
    /// The attempt to connect.
    pub(crate) attempt: Option<u32>,
    /// Ends when it is over.
    pub(crate) over: crossbeam_channel::Receiver<()>,
}

/// A device on the desk, or a profile of one: its state, its line and its draft.
pub struct Session<D: Kind> {
    state: SessionState,
    pub(crate) line: Option<LiveSession<D>>,
    /// The state of the draft of its edits.
    pub(crate) drafting: Drafting<D::Edits>,
    /// A write on its way.
    pub review: Option<D::Review>,
}

/// The state of a session is read and changed as a part of it.
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
    /// Creates a session for a link that is being opened; `kinds` know which of its parameters are secret.
    pub fn at_link(id: SessionId, url: LinkUrl, kinds: Kinds) -> Self {
        let mut own = Session::new(id, Source::Link(url), Phase::Opening);
        own.kinds = kinds;
        own
    }

    pub fn in_file(id: SessionId, file: ProfileFile, document: Document) -> Self {
        Session::new(id, file.source(document), Phase::Offline)
    }

    /// Creates a session whose content is in no file yet.
    pub(crate) fn of_nothing(id: SessionId, suggested: PathBuf) -> Self {
        Session::new(id, Source::New { suggested }, Phase::Offline)
    }

    fn new(id: SessionId, source: Source, phase: Phase) -> Self {
        Session { state: SessionState::new(id, source, phase), line: None, drafting: Drafting::new(id), review: None }
    }

    /// The line to the device, while it is connected.
    pub fn line(&self) -> Option<&LiveSession<D>> {
        self.line.as_ref()
    }

    /// The device lives in this process.
    pub fn is_virtual(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_virtual)
            || matches!(&self.source, Source::Link(url) if url.scheme == Scheme::Sim)
    }

    /// Returns whether a job runs on its line.
    pub fn is_busy(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.running().is_some())
    }

    /// Returns whether its memory is being changed.
    pub fn is_writing(&self) -> bool {
        self.line.as_ref().and_then(LiveSession::running).is_some_and(|running| running.writes)
    }

    /// Returns whether the device is polled.
    pub fn is_polling(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.polling().is_some())
    }

    /// Returns whether there is something to stop.
    pub fn is_active(&self) -> bool {
        self.phase == Phase::Opening || self.is_busy() || self.is_polling()
    }

    /// Connected and nothing runs: a job may begin.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Connected && self.line.is_some() && !self.is_busy()
    }

    /// Returns whether it can be read again; also true for a device that did not answer, and for a profile.
    pub fn is_readable(&self) -> bool {
        self.is_savable() || (matches!(self.phase, Phase::Silent(_)) && self.line.is_some() && !self.is_busy())
    }

    /// A profile of it can be saved now.
    pub fn is_savable(&self) -> bool {
        self.is_ready() || self.phase == Phase::Offline
    }

    /// Takes over the opened line.
    pub fn take_line(&mut self, opened: Opened<D>, services: &mut Services) {
        self.opening = None;
        self.trace.begin(opened.began.clone());
        self.line = Some(LiveSession::new(opened));
        self.phase = Phase::Connected;
        services.log.settle("session.not_connected", Some(&self.name()));
        self.just_connected = true;
    }

    /// Samples are wished at this interval, or none any more. Whether they begin with that; `None` without a line.
    pub(crate) fn poll(&mut self, interval: Option<Duration>) -> Option<bool> {
        let line = self.line.as_mut()?;
        let begins = line.polling().is_none();
        line.poll(interval);
        Some(begins)
    }

    /// Polling has ended by itself: why, and whether the device says nothing at all. One that was wished since goes on.
    pub(in crate::app) fn polling_failed(&mut self, why: Vec<Text>, is_silent: bool, services: &mut Services) {
        if self.is_polling() {
            return;
        }
        if let Some(first) = why.first().filter(|_| is_silent && !self.is_busy()) {
            self.phase = Phase::Silent(first.clone());
        }
        let texts = std::iter::once(Text::new("session.poll_failed")).chain(why).collect();
        services.tell(Severity::Error, texts, Some(&self.name()));
    }

    /// Starts a job, or says why not and gives false.
    pub(crate) fn submit(&mut self, job: D::Job, services: &mut Services) -> bool {
        let (name, what, writes) = (self.name(), D::job_text(&job), D::writes(&job));
        let Some(line) = &mut self.line else {
            services.tell(Severity::Error, vec![Text::new("session.not_connected")], Some(&name));
            return false;
        };
        match line.submit(job, what.clone(), writes, services.now()) {
            Ok(id) => {
                services.job_begins(self.id, id, &name, what);
                return true;
            }
            Err(SubmitError::Busy | SubmitError::Unread) => {
                services.tell(Severity::Warning, vec![Text::new("session.busy")], Some(&name));
            }
            // How the session ended comes with its last events.
            Err(SubmitError::Ended) => {}
        }
        false
    }

    /// Returns why no plan can be made now; `None` if one can.
    pub(crate) fn why_not_ready(&self) -> Option<Text> {
        match &self.phase {
            _ if self.is_ready() => None,
            _ if self.is_busy() => Some(Text::new("session.busy")),
            Phase::Silent(why) => Some(why.clone()),
            _ => Some(Text::new("session.not_connected")),
        }
    }

    /// Ends what runs, and gives up a link that is being opened.
    pub(crate) fn stop(&mut self, services: &mut Services) {
        if self.phase == Phase::Opening {
            let why = Text::new("session.open_cancelled");
            services.note(Severity::Note, vec![why.clone()], Some(&self.name()));
            self.phase = Phase::Lost(why);
            if let Some(opening) = &mut self.opening {
                // Its further results are dropped; the next attempt waits until it is over.
                opening.attempt = None;
            }
        }
        if let Some(line) = &mut self.line {
            line.stop();
        }
    }

    /// Lets its thread go; what runs ends as `end` says. A write that was cancelled ends by itself, and tells how.
    pub(crate) fn let_go(&mut self, end: JobEnd, services: &mut Services) {
        self.save_to = None;
        let Source::Link(url) = &self.source else { return };
        let (url, about) = (url.clone(), self.name());
        let Some(line) = self.line.take() else { return };
        let write = line.running().filter(|running| running.writes && end == JobEnd::Cancelled).map(|own| own.id);
        if let Some(running) = line.running().filter(|_| write.is_none()) {
            services.job_ends(self.id, running.id, end);
        }
        services.leave(line.into_worker(), Leaver { session: self.id, about, url, write }, None);
    }

    /// The connection is gone.
    pub(in crate::app) fn lose(&mut self, why: Text, services: &mut Services) {
        // It stands where the session is shown.
        services.note(Severity::Error, vec![why.clone()], Some(&self.name()));
        self.let_go(JobEnd::Failed(why.clone()), services);
        self.opening = None;
        self.phase = Phase::Lost(why);
    }
}
