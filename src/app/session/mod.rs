//! What every device on the desk has, whatever its kind: where its data come from, how it stands with the connection, its
//! line, what has passed over it, its backups and writes. It knows no device; what a kind adds stands in its own room.

mod drafted;
mod drafts;
mod kind;
mod memory;
mod on_desk;
mod on_line;
mod profiles;
mod saved;
mod saving;

use std::path::PathBuf;
use std::time::Duration;

pub(crate) use drafted::Drafted;
pub use drafts::{DraftDone, DraftEdits, DraftKey};
pub(in crate::app) use drafts::{Drafting, file_key};
pub(crate) use kind::{Kind, LastWords};
pub(crate) use memory::{Agreed, WithMemory};
pub(crate) use on_desk::OnDesk;
pub(crate) use on_line::{Cut, OnLine, first};
pub use profiles::Listed;
pub(crate) use saved::{Known, Saved, some, without_edits};
pub(in crate::app) use saving::Found;
pub use saving::{Guard, ProfileFile, Saving};

use super::action::Opened;
use super::leaving::Leaver;
use super::line::Line;
use super::services::{JobEnd, Services};
use super::studio::SessionId;
use super::trace::TraceLog;
use super::{Severity, Text};
use crate::link::{LinkUrl, Scheme};
use crate::profile::Document;
use crate::store::{Backup, Entry, StatusEntry};
use crate::worker::SubmitError;

/// Where the data come from.
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
        /// What is in it, without the edits.
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

/// How it stands with the connection.
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
pub(in crate::app) struct Opening {
    /// Which attempt of the session it is.
    pub(in crate::app) attempt: Option<u32>,
    /// Ends when it is over.
    pub(in crate::app) over: crossbeam_channel::Receiver<()>,
}

/// A link as it may be shown and kept: the access codes of a virtual encoder are no part of that.
pub(in crate::app) fn without_codes(url: &LinkUrl) -> String {
    let query: Vec<String> =
        url.query.without(&["codes"]).into_iter().map(|(name, value)| format!("{name}={value}")).collect();
    let question = if query.is_empty() { "" } else { "?" };
    format!("{}:{}{question}{}", url.scheme.word(), url.target, query.join("&"))
}

/// A device on the desk, or a profile of one.
pub struct Session<D: Kind> {
    /// Its number in the studio.
    pub id: SessionId,
    /// Where the data come from.
    pub source: Source,
    /// How it stands with the connection.
    pub phase: Phase,
    pub(crate) line: Option<Line<D>>,
    pub(in crate::app) opening: Option<Opening>,
    /// What the device calls itself, once it is known.
    pub(crate) title: Option<String>,
    /// What has passed over the line.
    pub trace: TraceLog,
    /// Backups, or why there are none.
    pub backups: Option<Result<Vec<Backup>, Text>>,
    /// Writes of this device that the logbook knows, or why it does not tell.
    pub writes: Option<Result<Vec<Entry>, Text>>,
    /// Write cycles that the logbook has seen of this device; `None` where it does not tell, or was not asked.
    pub cycles: Option<u64>,
    /// Status codes of this device that the logbook knows, the newest first.
    pub statuses: Vec<StatusEntry>,
    /// Nothing has been read since the link was opened.
    pub(crate) just_connected: bool,
    /// Where the profile goes that is being read.
    pub(crate) save_to: Option<PathBuf>,
    /// A profile is on its way into a file: what that says next is not known before it is there.
    pub(in crate::app) is_saving: bool,
    /// How it stands with the draft of its edits.
    pub(crate) drafting: Drafting<D::Edits>,
}

impl<D: Kind> Session<D> {
    /// At a link that is being opened.
    pub(crate) fn at_link(id: SessionId, url: LinkUrl) -> Self {
        Session::new(id, Source::Link(url), Phase::Opening)
    }

    /// Tells the log who has answered for the first time since the link was opened, and what is to be known of it.
    pub(crate) fn log_answer(&self, facts: Vec<Text>, services: &mut Services) {
        let Source::Link(url) = &self.source else { return };
        let texts = std::iter::once(Text::new("log.answers").with("link", without_codes(url))).chain(facts).collect();
        services.note(Severity::Note, texts, Some(&self.name()));
    }

    /// With a profile.
    pub(crate) fn in_file(id: SessionId, file: ProfileFile, document: Document) -> Self {
        Session::new(id, file.source(document), Phase::Offline)
    }

    /// With what is in no file yet.
    pub(crate) fn of_nothing(id: SessionId, suggested: PathBuf) -> Self {
        Session::new(id, Source::New { suggested }, Phase::Offline)
    }

    fn new(id: SessionId, source: Source, phase: Phase) -> Self {
        Session {
            id,
            source,
            phase,
            line: None,
            opening: None,
            title: None,
            trace: TraceLog::default(),
            backups: None,
            writes: None,
            cycles: None,
            statuses: Vec::new(),
            just_connected: false,
            save_to: None,
            is_saving: false,
            drafting: Drafting::new(id),
        }
    }

    /// The line to the device, while it is connected.
    pub fn line(&self) -> Option<&Line<D>> {
        self.line.as_ref()
    }

    /// The device lives in this process.
    pub fn is_virtual(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_virtual)
            || matches!(&self.source, Source::Link(url) if url.scheme == Scheme::Sim)
    }

    /// This is the attempt to open its link that counts.
    pub(in crate::app) fn is_attempt(&self, attempt: u32) -> bool {
        self.opening.as_ref().is_some_and(|opening| opening.attempt == Some(attempt))
    }

    /// Something runs on its line.
    pub fn is_busy(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.running().is_some())
    }

    /// Its memory is being changed.
    pub fn is_writing(&self) -> bool {
        self.line.as_ref().and_then(Line::running).is_some_and(|running| running.writes)
    }

    /// It is read all the time.
    pub fn is_polling(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.polling().is_some())
    }

    /// There is something to stop.
    pub fn is_active(&self) -> bool {
        self.phase == Phase::Opening || self.is_busy() || self.is_polling()
    }

    /// Connected and nothing runs: a job may begin.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Connected && self.line.is_some() && !self.is_busy()
    }

    /// It can be read again: also a device that did not answer, and a profile.
    pub fn is_readable(&self) -> bool {
        self.is_savable() || (matches!(self.phase, Phase::Silent(_)) && self.line.is_some() && !self.is_busy())
    }

    /// A profile of it can be saved now.
    pub fn is_savable(&self) -> bool {
        self.is_ready() || self.phase == Phase::Offline
    }

    /// Where the data come from, in words that may be seen.
    pub fn place(&self) -> String {
        match &self.source {
            Source::Link(url) => without_codes(url),
            Source::File { path, .. } => path.display().to_string(),
            Source::New { .. } => String::new(),
        }
    }

    /// The name by which the log and the jobs call it.
    pub fn name(&self) -> String {
        match (&self.source, &self.title) {
            (Source::File { path, .. }, _) => {
                path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
            }
            (Source::Link(_) | Source::New { .. }, Some(title)) => title.clone(),
            (Source::New { suggested }, None) => suggested.display().to_string(),
            (Source::Link(url), None) => without_codes(url),
        }
    }

    /// Its link is open.
    pub(crate) fn take_line(&mut self, opened: Opened<D>, services: &mut Services) {
        self.opening = None;
        self.trace.begin(opened.began.clone());
        self.line = Some(Line::new(opened));
        self.phase = Phase::Connected;
        services.log.settle("session.not_connected", Some(&self.name()));
        self.just_connected = true;
    }

    /// The device has answered, if only with a refusal.
    pub(crate) fn answers(&mut self) {
        if matches!(self.phase, Phase::Silent(_)) {
            self.phase = Phase::Connected;
        }
    }

    /// The link is open, and the device does not answer: why, and what to do.
    pub(crate) fn fall_silent(&mut self, why: Vec<Text>, services: &mut Services) {
        self.phase = Phase::Silent(first(&why));
        services.log.settle("session.not_connected", Some(&self.name()));
        services.note(Severity::Error, why, Some(&self.name()));
    }

    /// Tells of this device; in the log alone what stands where it was asked for.
    pub(crate) fn say(&self, severity: Severity, texts: Vec<Text>, stands_there: bool, services: &mut Services) {
        match stands_there {
            true => services.note(severity, texts, Some(&self.name())),
            false => services.tell(severity, texts, Some(&self.name())),
        }
    }

    /// Another device was read than the one before.
    pub(crate) fn tell_of_another(&self, serial: &str, services: &mut Services) {
        let text = Text::new("session.other_encoder").with("serial", serial);
        services.tell(Severity::Warning, vec![text], Some(&self.name()));
    }

    /// What was asked for cannot be.
    pub(crate) fn refuse(&self, why: Text, services: &mut Services) {
        services.tell(Severity::Error, vec![why], Some(&self.name()));
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
        let (name, what, writes) = (self.name(), D::job(&job), D::writes(&job));
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

    /// Why no plan can be made now; `None`: one can.
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
                // What it still gives is for nobody; the next attempt waits until it is over.
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
