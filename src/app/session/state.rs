//! State common to all sessions.

use std::path::PathBuf;

use jiff::Timestamp;

use super::{PendingOpen, Phase, Source, first};
use crate::analysis::check::CycleCount;
use crate::app::kinds::KindRegistry;
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::trace::TraceLog;
use crate::app::{Severity, Text};
use crate::store::{Backup, Entry};

/// The part of a session that is common to all kinds of devices: identity, data source, and connection.
pub struct SessionState {
    pub id: SessionId,
    pub source: Source,
    pub phase: Phase,
    /// Kinds of devices, which define the secret link parameters.
    pub(super) kinds: KindRegistry,
    pub(crate) opening: Option<PendingOpen>,
    pub title: Option<String>,
    pub trace: TraceLog,
    /// Backups, or the reason why they cannot be listed. `None` until they have been requested.
    pub backups: Option<Result<Vec<Backup>, Text>>,
    /// Writes recorded in the logbook, or the reason why they cannot be listed.
    pub writes: Option<Result<Vec<Entry>, Text>>,
    /// Number of write cycles in the logbook, if known.
    pub cycles: Option<CycleCount>,
    /// Asset to which the device is assigned in the logbook.
    pub asset: Option<String>,
    /// Status codes in the logbook, newest first.
    pub statuses: Vec<Entry>,
    /// Time at which the displayed values were read, if they were.
    pub(crate) last_read_time: Option<Timestamp>,
    /// Whether the device has not been read since the link was opened.
    pub just_connected: bool,
    /// Whether live values start automatically once the device has been read and its line is idle.
    pub(in crate::app) live_due: bool,
    /// File to which the profile being read will be saved.
    pub(crate) save_to: Option<PathBuf>,
    /// Whether a profile is being written to a file. Until this ends, the content of the file is unknown.
    pub(crate) is_saving: bool,
}

impl SessionState {
    pub(super) fn new(id: SessionId, source: Source, phase: Phase) -> Self {
        SessionState {
            id,
            source,
            phase,
            kinds: KindRegistry::NONE,
            opening: None,
            title: None,
            trace: TraceLog::default(),
            backups: None,
            writes: None,
            cycles: None,
            asset: None,
            statuses: Vec::new(),
            last_read_time: None,
            just_connected: false,
            live_due: false,
            save_to: None,
            is_saving: false,
        }
    }

    /// Returns whether this attempt to open the session's link is the latest one.
    pub(in crate::app) fn is_current_attempt(&self, attempt: u32) -> bool {
        self.opening.as_ref().is_some_and(|opening| opening.attempt == Some(attempt))
    }

    /// Returns where the data come from, without secrets.
    pub fn data_source(&self) -> String {
        match &self.source {
            Source::Link(url) => self.kinds.display_link(url),
            Source::File { path, .. } => path.display().to_string(),
            Source::New { .. } => String::new(),
        }
    }

    /// Returns the name used in the log and the job list.
    pub fn name(&self) -> String {
        match (&self.source, &self.title) {
            (Source::File { path, .. }, _) => {
                path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
            }
            (Source::Link(_) | Source::New { .. }, Some(title)) => title.clone(),
            (Source::New { suggested }, None) => suggested.display().to_string(),
            (Source::Link(url), None) => self.kinds.display_link(url),
        }
    }

    /// Logs the first reply since the link was opened, with details of the device.
    pub fn log_first_reply(&self, facts: Vec<Text>, services: &mut Services) {
        let Source::Link(url) = &self.source else { return };
        let link = Text::new("log.answers").with("link", self.kinds.display_link(url));
        let texts = std::iter::once(link).chain(facts).collect();
        services.log_without_display(Severity::Note, texts, Some(&self.name()));
    }

    /// Marks the device as replying, even if it only rejects requests.
    pub(crate) fn mark_replying(&mut self) {
        if matches!(self.phase, Phase::Silent(_)) {
            self.phase = Phase::Connected;
        }
    }

    /// Marks the device as silent: the link is open, but there is no reply. `why` states the reason and what to do.
    pub(crate) fn mark_unresponsive(&mut self, why: Vec<Text>, services: &mut Services) {
        self.phase = Phase::Silent(first(&why));
        services.log.remove_minor(&self.name());
        services.log.remove_from_window("session.not_connected", Some(&self.name()));
        services.log_without_display(Severity::Error, why, Some(&self.name()));
    }

    /// Reports a message about this device. If `stands_there` is set, the message is only logged, because it is already
    /// displayed where the request was made.
    pub(crate) fn report_message(
        &self,
        severity: Severity,
        texts: Vec<Text>,
        stands_there: bool,
        services: &mut Services,
    ) {
        match stands_there {
            true => services.log_without_display(severity, texts, Some(&self.name())),
            false => services.notify(severity, texts, Some(&self.name())),
        }
    }

    /// Discards all data about the device, because another device has replied.
    pub(super) fn discard_device_data(&mut self) {
        (self.title, self.backups, self.writes, self.cycles) = (None, None, None, None);
        self.asset = None;
        self.statuses.clear();
    }

    pub(crate) fn report_rejection(&self, why: Text, services: &mut Services) {
        services.notify(Severity::Error, vec![why], Some(&self.name()));
    }
}
