//! An encoder on the desk, or a profile of one: what is known of it, the user's edits beside it, what runs on its line.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::curve::Curve;
use super::drafts::Drafting;
use super::meaning::Meaning;
use super::review::Review;
use super::{Done, Staged};
use crate::app::line::Line;
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::trace::TraceLog;
use crate::app::{Severity, Text, explain};
use crate::device::hiperface::check;
use crate::device::hiperface::{Identity, Survey, profile_of};
use crate::link::LinkUrl;
use crate::profile::hiperface::{FieldImage, HiperfaceProfile, Item, Recorded};
use crate::profile::{Body, Document};
use crate::protocol::hiperface::{AccessCode, CodeNumber, EncoderTypes, KIND, StatusCode};
use crate::store::{Backup, Entry, FileError};
use crate::worker::hiperface::{Hiperface, device_key};

/// Where the data come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// An encoder at the end of a link.
    Link(LinkUrl),
    /// A profile in a file.
    File {
        /// The file.
        path: PathBuf,
        /// What is in it, without the edits.
        document: Box<Document>,
    },
}

/// How it stands with the connection.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// The link is being opened.
    Opening,
    /// Connected.
    Connected,
    /// It was connected, or could not be: why, and what to do.
    Lost(Text),
    /// A profile: there is no connection.
    Offline,
}

/// An encoder, or a profile of one.
pub struct Encoder {
    /// Its number in the studio.
    pub id: SessionId,
    /// Where the data come from.
    pub source: Source,
    /// How it stands with the connection.
    pub phase: Phase,
    pub(super) line: Option<Line<Hiperface>>,
    /// Who it is.
    pub identity: Option<Identity>,
    /// Its memory and the edits beside it.
    pub staged: Staged,
    /// The error queue as it was last read, with what the encoder announced since; `None`: never read.
    pub codes: Option<Vec<StatusCode>>,
    /// The last device check.
    pub check: Option<Vec<check::Line>>,
    /// The counter as last read.
    pub counter: Option<u32>,
    /// The last position that was set here: from where, to where.
    pub position_set: Option<(u32, u32)>,
    /// Analogue values as last read, with their limits; or why the encoder does not give them.
    pub analogue: BTreeMap<u8, Result<(i16, Option<i16>), Text>>,
    /// Positions.
    pub curve: Curve,
    /// A write on its way.
    pub review: Option<Review>,
    /// Backups, or why there are none.
    pub backups: Option<Result<Vec<Backup>, Text>>,
    /// Writes of this encoder that the logbook knows, or why it does not tell.
    pub writes: Option<Result<Vec<Entry>, Text>>,
    /// What has passed over the line.
    pub trace: TraceLog,
    pub(super) meaning: Meaning,
    pub(super) drafting: Drafting,
    /// Access codes that the user gave or changed: the next session with this encoder begins with them.
    pub(super) access_codes: Vec<(CodeNumber, AccessCode)>,
    /// What was asked for by the job that reads a single value.
    pub(super) asked: Option<Item>,
    /// Where the profile goes that is being read.
    pub(super) save_to: Option<PathBuf>,
}

impl Encoder {
    /// An encoder at a link that is being opened.
    pub(in crate::app) fn at_link(id: SessionId, url: LinkUrl) -> Self {
        Encoder {
            id,
            source: Source::Link(url),
            phase: Phase::Opening,
            line: None,
            identity: None,
            staged: Staged::default(),
            codes: None,
            check: None,
            counter: None,
            position_set: None,
            analogue: BTreeMap::new(),
            curve: Curve::default(),
            review: None,
            backups: None,
            writes: None,
            trace: TraceLog::default(),
            meaning: Meaning::default(),
            drafting: Drafting::default(),
            access_codes: Vec::new(),
            asked: None,
            save_to: None,
        }
    }

    /// A profile of an encoder.
    pub(in crate::app) fn in_file(
        id: SessionId,
        path: PathBuf,
        document: Document,
        types: &EncoderTypes,
        services: &Services,
    ) -> Self {
        let Body::Hiperface(profile) = &document.body;
        let fields = profile.fields.clone();
        let identity = crate::device::hiperface::identity_of(profile, types);
        let counter = profile.recorded.counter;
        let source = Source::File { path, document: Box::new(document) };
        // A link is needed to make the rest; a profile has none.
        let mut encoder = Encoder::at_link(id, LinkUrl::sim());
        encoder.source = source;
        encoder.phase = Phase::Offline;
        encoder.identity = Some(identity);
        encoder.counter = counter;
        encoder.staged.refresh(fields);
        encoder.load_draft(services);
        encoder
    }

    /// The line to the encoder, while it is connected.
    pub fn line(&self) -> Option<&Line<Hiperface>> {
        self.line.as_ref()
    }

    /// The encoder lives in this process.
    pub fn is_virtual(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.is_virtual)
            || matches!(&self.source, Source::Link(url) if url.scheme == crate::link::Scheme::Sim)
    }

    /// Something runs on its line.
    pub fn is_busy(&self) -> bool {
        self.line.as_ref().is_some_and(|line| line.running().is_some())
    }

    /// Its memory is being changed.
    pub fn is_writing(&self) -> bool {
        self.line.as_ref().and_then(Line::running).is_some_and(|running| running.writes)
    }

    /// Connected and nothing runs: a job may begin.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Connected && self.line.is_some() && !self.is_busy()
    }

    /// A profile of it can be saved now.
    pub fn is_savable(&self) -> bool {
        self.is_ready() || self.phase == Phase::Offline
    }

    /// The name by which the log and the jobs call it.
    pub fn name(&self) -> String {
        match (&self.source, &self.identity) {
            (Source::File { path, .. }, _) => {
                path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
            }
            (Source::Link(_), Some(identity)) if !identity.serial.serial_number.is_empty() => {
                format!("{} · {}", identity.name, identity.serial.serial_number)
            }
            (Source::Link(_), Some(identity)) => identity.name.clone(),
            (Source::Link(url), None) => url.to_string(),
        }
    }

    /// One of its data fields, as the encoder has it.
    pub fn field(&self, number: u8) -> Option<&FieldImage> {
        self.staged.device().iter().find(|field| field.number == number)
    }

    /// What in a field belongs to the mounting, with its meaning.
    pub fn mounting(&self, field: u8) -> Vec<(std::ops::Range<usize>, String)> {
        let own = |profile: &HiperfaceProfile| {
            let marks = profile.mounting.iter().filter(|mark| mark.range.field == field);
            marks
                .map(|mark| {
                    let start = mark.range.start;
                    (start..start.saturating_add(mark.range.count.unwrap_or(0)), mark.meaning.clone())
                })
                .collect()
        };
        match &self.source {
            Source::File { document, .. } => {
                let Body::Hiperface(profile) = &document.body;
                own(profile)
            }
            Source::Link(_) => {
                let Some(identity) = &self.identity else { return Vec::new() };
                own(&profile_of(identity, self.staged.device().to_vec(), Recorded::default()))
            }
        }
    }

    /// Access codes for the next session with it.
    pub(in crate::app) fn access_codes(&self) -> &[(CodeNumber, AccessCode)] {
        &self.access_codes
    }

    /// Ends what runs.
    pub(in crate::app) fn stop(&mut self) {
        if let Some(line) = &mut self.line {
            line.stop();
        }
    }

    /// A profile was read again from its file; edits stay.
    pub(in crate::app) fn take_document(&mut self, path: PathBuf, document: Document) {
        let Body::Hiperface(profile) = &document.body;
        self.staged.refresh(profile.fields.clone());
        self.source = Source::File { path, document: Box::new(document) };
    }

    /// A profile was written, or not.
    pub(in crate::app) fn written(
        &mut self,
        path: PathBuf,
        document: Document,
        result: Result<(), FileError>,
        services: &mut Services,
    ) {
        match result {
            Ok(()) => {
                let text = Text::new("session.saved").with("path", path.display());
                services.tell(Severity::Good, vec![text], Some(&self.name()));
                if self.phase == Phase::Offline {
                    self.forget_draft_unless(&path, services);
                    self.take_document(path, document);
                }
            }
            Err(error) => services.tell(Severity::Error, vec![explain::file(&error)], Some(&self.name())),
        }
    }

    /// Takes over what was read from the encoder; edits stay, unless they are another encoder's.
    pub(super) fn take_survey(&mut self, survey: Survey, services: &mut Services) {
        let Survey { identity, codes, fields, counter, position } = survey;
        if self.is_another(&identity) {
            if self.staged.is_dirty() {
                let text = Text::new("session.other_encoder").with("serial", &identity.serial.serial_number);
                services.tell(Severity::Warning, vec![text], Some(&self.name()));
            }
            self.forget_encoder(services);
        }
        let first = self.identity.is_none();
        self.identity = Some(identity);
        self.staged.refresh(fields);
        self.counter = counter;
        self.codes = Some(codes);
        if let Some(position) = position {
            self.curve.add(vec![position], 0);
        }
        if first {
            self.load_draft(services);
        }
        self.list_backups(services);
    }

    /// Another encoder than the one that was read before.
    pub(super) fn is_another(&self, identity: &Identity) -> bool {
        let known = self.identity.as_ref().map(|identity| &identity.serial.serial_number);
        known.is_some_and(|known| *known != identity.serial.serial_number)
    }

    fn forget_encoder(&mut self, services: &Services) {
        self.leave_draft(services);
        self.identity = None;
        self.staged.clear();
        self.check = None;
        self.position_set = None;
        self.analogue.clear();
        self.curve.forget();
        self.backups = None;
        self.writes = None;
        self.access_codes.clear();
        self.review = None;
    }

    /// Reads the list of backups and writes again, on a thread.
    pub(super) fn list_backups(&mut self, services: &Services) {
        let Some(identity) = &self.identity else { return };
        if self.phase == Phase::Offline {
            return;
        }
        let (store, id, serial) = (services.world.store.clone(), self.id, identity.serial.serial_number.clone());
        let key = device_key(identity, self.is_virtual());
        services.tasks.run("backups", move || {
            let backups = store.backups().list(KIND, &serial);
            let writes = match store.logbook_path() {
                path if !path.exists() => Ok(Vec::new()),
                path => crate::store::Logbook::open(&path).and_then(|logbook| logbook.history(&key, 200)),
            };
            crate::app::Action::Done(crate::app::action::Done::Hiperface(id, Done::Backups { backups, writes }))
        });
    }

    /// Takes over what a task came back with.
    pub(in crate::app) fn done(&mut self, done: Done, services: &mut Services) {
        match done {
            Done::Draft { key, result } => self.take_draft(&key, result, services),
            Done::DraftKept { key, result } => self.draft_kept(&key, result, services),
            Done::Backups { backups, writes } => {
                self.backups = Some(backups.map_err(|error| explain::file(&error)));
                self.writes = Some(writes.map_err(|error| {
                    Text::new("backups.no_logbook").with_text("why", explain::logbook_problem(&error))
                }));
            }
            Done::Backup(profile) => self.plan_restore(*profile, services),
            Done::NoBackup(path, error) => {
                let text = crate::app::studio::read_error(&path, &error);
                services.tell(Severity::Error, vec![text], Some(&self.name()));
            }
        }
    }
}
