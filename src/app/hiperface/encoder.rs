//! An encoder on the desk, or a profile of one: what is known of it, the user's edits beside it, what runs on its line.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::commutation::Commutation;
use super::drafts::Drafting;
use super::meaning::Meaning;
use super::record::Record;
use super::rest::RestAsked;
use super::review::Review;
use super::{Done, Staged};
use crate::app::line::Line;
use crate::app::services::Services;
use crate::app::studio::SessionId;
use crate::app::trace::TraceLog;
use crate::app::{Severity, Text, explain};
use crate::device::hiperface::check;
use crate::device::hiperface::{Identity, Sample, Survey};
use crate::link::LinkUrl;
use crate::profile::hiperface::{FieldImage, Item};
use crate::profile::{Body, Document};
use crate::protocol::hiperface::{AccessCode, CodeNumber, EncoderTypes, KIND, LineSettings, StatusCode};
use crate::store::{Backup, DeviceKey, Entry, FileError};
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
        /// The same for every way that leads to it.
        key: String,
        /// What is in it, without the edits.
        document: Box<Document>,
    },
}

/// How it stands with the connection.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// The link is being opened.
    Opening,
    /// Connected, and the encoder answers.
    Connected,
    /// The link is open, and the encoder does not answer: why, and what to do.
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

/// An encoder, or a profile of one.
pub struct Encoder {
    /// Its number in the studio.
    pub id: SessionId,
    /// Where the data come from.
    pub source: Source,
    /// How it stands with the connection.
    pub phase: Phase,
    pub(super) line: Option<Line<Hiperface>>,
    pub(in crate::app) opening: Option<Opening>,
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
    /// What was recorded while it was polled.
    pub record: Record,
    /// The commutation assistant.
    pub commutation: Commutation,
    pub(super) rest: RestAsked,
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
    /// Access codes that are given to the session again, once it is known who is connected.
    pub(super) codes_due: Vec<(CodeNumber, AccessCode)>,
    /// Interface settings with which the encoder talks when the job that runs is done.
    pub(super) settings_then: Option<LineSettings>,
    /// Nothing has been read since the link was opened.
    pub(super) just_connected: bool,
    /// The access code that the user gave last: whether it fits shows when the fields are read.
    pub(super) tried_code: Option<CodeNumber>,
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
            opening: None,
            identity: None,
            staged: Staged::default(),
            codes: None,
            check: None,
            counter: None,
            position_set: None,
            analogue: BTreeMap::new(),
            record: Record::default(),
            commutation: Commutation::default(),
            rest: RestAsked::default(),
            review: None,
            backups: None,
            writes: None,
            trace: TraceLog::default(),
            meaning: Meaning::default(),
            drafting: Drafting::default(),
            access_codes: Vec::new(),
            asked: None,
            codes_due: Vec::new(),
            settings_then: None,
            just_connected: false,
            tried_code: None,
            save_to: None,
        }
    }

    /// A profile of an encoder.
    pub(in crate::app) fn in_file(
        id: SessionId,
        (path, key): (PathBuf, String),
        document: Document,
        types: &EncoderTypes,
        services: &Services,
    ) -> Self {
        let Body::Hiperface(profile) = &document.body;
        let fields = profile.fields.clone();
        let identity = crate::device::hiperface::identity_of(profile, types);
        let counter = profile.recorded.counter;
        let source = Source::File { path, key, document: Box::new(document) };
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

    /// Connected and nothing runs: a job may begin.
    pub fn is_ready(&self) -> bool {
        self.phase == Phase::Connected && self.line.is_some() && !self.is_busy()
    }

    /// It can be read again: also an encoder that did not answer, and a profile.
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
        }
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
            (Source::Link(url), None) => without_codes(url),
        }
    }

    /// One of its data fields, as the encoder has it.
    pub fn field(&self, number: u8) -> Option<&FieldImage> {
        self.staged.device().iter().find(|field| field.number == number)
    }

    /// Ends what runs, and gives up a link that is being opened.
    pub(in crate::app) fn stop(&mut self, services: &mut Services) {
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

    /// A profile was read again from its file; edits stay.
    pub(in crate::app) fn take_document(&mut self, path: PathBuf, key: String, document: Document) {
        let Body::Hiperface(profile) = &document.body;
        self.staged.refresh(profile.fields.clone());
        self.source = Source::File { path, key, document: Box::new(document) };
    }

    /// A profile was written, or not.
    pub(in crate::app) fn written(
        &mut self,
        (path, key): (PathBuf, String),
        document: Document,
        remarks: Vec<Text>,
        result: Result<(), FileError>,
        services: &mut Services,
    ) {
        match result {
            Ok(()) => {
                let severity = if remarks.is_empty() { Severity::Good } else { Severity::Warning };
                let mut texts = vec![Text::new("session.saved").with("path", path.display())];
                texts.extend(remarks);
                services.tell(severity, texts, Some(&self.name()));
                if self.phase == Phase::Offline {
                    let moved = self.forget_draft_unless(&key, services);
                    self.take_document(path, key, document);
                    if moved {
                        self.begin_draft(services);
                    }
                }
            }
            Err(error) => services.tell(Severity::Error, vec![explain::file(&error)], Some(&self.name())),
        }
    }

    /// Takes over what was read from the encoder; edits stay, unless they are another encoder's.
    pub(super) fn take_survey(&mut self, survey: Survey, services: &mut Services) {
        let Survey { identity, codes, fields, counter, position } = survey;
        let fresh = std::mem::take(&mut self.just_connected);
        // Without a serial number, it may be any of its type; the same memory makes it as good as the same.
        let unproven = fresh && identity.serial.serial_number.is_empty() && fields != self.staged.device();
        if self.is_another(&identity) || (self.identity.is_some() && unproven) {
            if self.staged.is_dirty() {
                let kept = self.identity.as_ref().is_some_and(|known| !known.serial.serial_number.is_empty());
                let text = if kept { Text::new("session.other_encoder") } else { Text::new("session.edits_gone") };
                let text = text.with("serial", &identity.serial.serial_number);
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
            self.add_samples(vec![position], 0);
        }
        if first {
            self.load_draft(services);
        }
        self.tell_of_code(services);
        self.list_backups(services);
    }

    /// Records what was sampled, or read on its own.
    pub(super) fn add_samples(&mut self, samples: Vec<Sample>, dropped: u64) {
        let geometry = self.identity.as_ref().and_then(|identity| identity.geometry);
        self.record.add(samples, dropped, geometry);
    }

    /// Whether the access code that the user gave opens the fields that it guards; never the code itself.
    fn tell_of_code(&mut self, services: &mut Services) {
        let Some(number) = self.tried_code.take() else { return };
        let own = |field: &&FieldImage| field.status.code() == number && field.status.code_required();
        let fields: Vec<&FieldImage> = self.staged.device().iter().filter(own).collect();
        let shut: Vec<String> =
            fields.iter().filter(|field| field.bytes.is_none()).map(|field| field.number.to_string()).collect();
        let (severity, text) = match (fields.is_empty(), shut.is_empty()) {
            (true, _) => (Severity::Note, Text::new("session.code_unused")),
            (false, true) => (Severity::Good, Text::new("session.code_fits")),
            (false, false) => (Severity::Warning, Text::new("session.code_wrong").with("fields", shut.join(", "))),
        };
        if severity == Severity::Warning {
            self.access_codes.retain(|(own, _)| *own != number);
        }
        services.tell(severity, vec![text.with("number", number)], Some(&self.name()));
    }

    /// Another encoder than the one that was read before.
    pub(super) fn is_another(&self, identity: &Identity) -> bool {
        let who = |identity: &Identity| (identity.label.encoder_type, identity.serial.serial_number.clone());
        self.identity.as_ref().is_some_and(|known| who(known) != who(identity))
    }

    fn forget_encoder(&mut self, services: &mut Services) {
        self.leave_draft(services);
        self.identity = None;
        self.staged.clear();
        self.check = None;
        self.position_set = None;
        self.analogue.clear();
        self.record.forget();
        self.backups = None;
        self.writes = None;
        self.access_codes.clear();
        self.tried_code = None;
        self.commutation = Commutation::default();
        self.review = None;
    }

    /// Reads the list of backups and writes again, on a thread.
    pub(super) fn list_backups(&mut self, services: &Services) {
        let Some(identity) = &self.identity else { return };
        if self.phase == Phase::Offline {
            return;
        }
        let (store, id, serial) = (services.world.store.clone(), self.id, identity.serial.serial_number.clone());
        let key = self.key_of(identity);
        services.tasks.run("backups", move || {
            let backups = store.backups().list(KIND, &serial);
            let writes = match store.logbook_path() {
                path if !path.exists() => Ok(Vec::new()),
                path => crate::store::Logbook::open(&path).and_then(|logbook| logbook.history(&key, 200)),
            };
            let done = Done::Backups { of: key, backups, writes };
            crate::app::Action::Done(crate::app::action::Done::Hiperface(id, done))
        });
    }

    /// How the logbook knows an encoder on this line.
    fn key_of(&self, identity: &Identity) -> DeviceKey {
        device_key(identity, self.is_virtual())
    }

    /// How the logbook knows it.
    pub(super) fn key(&self) -> Option<DeviceKey> {
        self.identity.as_ref().map(|identity| self.key_of(identity))
    }

    /// Takes over what a task came back with.
    pub(in crate::app) fn done(&mut self, done: Done, services: &mut Services) {
        match done {
            Done::Draft { key, claim, result } => self.take_draft(&key, claim, result, services),
            Done::DraftKept { key, result } => self.draft_kept(&key, result, services),
            // About another encoder than the one that is connected by now.
            Done::Backups { of, .. } | Done::Backup { of, .. } if self.key().as_ref() != Some(&of) => {}
            Done::Backups { backups, writes, .. } => {
                self.backups = Some(backups.map_err(|error| explain::file(&error)));
                self.writes = Some(writes.map_err(|error| {
                    Text::new("backups.no_logbook").with_text("why", explain::logbook_problem(&error))
                }));
            }
            Done::Backup { result: Ok(profile), .. } => self.plan_restore(*profile, services),
            Done::Backup { path, result: Err(error), .. } => {
                let text = crate::app::studio::read_error(&path, &error);
                services.tell(Severity::Error, vec![text], Some(&self.name()));
            }
        }
    }
}
