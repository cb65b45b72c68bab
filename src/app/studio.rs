//! All that the window knows, and what it can do. It is complete without a window: a test sends actions and reads state.

use std::path::{Path, PathBuf};

use super::action::{Action, Done, FileQuestion, Question, ReadError, Then, Waited};
use super::connect::{self, Connect};
use super::hiperface::{self, Encoder, Phase, Source};
use super::keep::Keeper;
use super::services::{Services, World};
use super::signals::{self, Signals};
use super::tasks::{Mailbox, Wake};
use super::{Settings, Severity, Text, explain};
use crate::link::LinkUrl;
use crate::profile::Document;
use crate::protocol::hiperface::EncoderTypes;
use crate::store::{Store, StoreError, read_file};

/// A session's number, from the start of the program on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SessionId(pub(super) u32);

/// A tab of the window: a kind of device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Tab {
    /// HIPERFACE motor-feedback encoders.
    #[default]
    Hiperface,
    /// Captures of sine and cosine, whatever encoder they are from.
    Signals,
}

/// All state of the window.
pub struct Studio {
    /// What is remembered from one start to the next.
    pub settings: Settings,
    /// The connection dialog, when it is open.
    pub connect: Option<Connect>,
    /// A question that has to be answered.
    pub question: Option<Question>,
    /// The log, the jobs.
    pub services: Services,
    /// The Signals tab.
    pub signals: Signals,
    pub(super) encoders: Vec<Encoder>,
    pub(super) shown: Option<SessionId>,
    next_id: u32,
    pub(super) keeper: Keeper,
    pub(super) closing: bool,
    pub(super) waited: Option<Waited>,
    path_question: Option<FileQuestion>,
}

impl Studio {
    /// A studio with what it remembers; `wake` is called when there is something to look at.
    pub fn new(world: World, wake: Wake) -> Self {
        let mut services = Services::new(world, wake);
        let (settings, keeper) = Keeper::load(&mut services);
        Studio {
            settings,
            connect: None,
            question: None,
            services,
            signals: Signals::default(),
            encoders: Vec::new(),
            shown: None,
            next_id: 0,
            keeper,
            closing: false,
            waited: None,
            path_question: None,
        }
    }

    /// What the window begins with: a link, a profile, or else the virtual encoder.
    pub fn begin(&mut self, link: Option<LinkUrl>, profile: Option<PathBuf>) {
        if link.is_none() && profile.is_none() {
            self.open_link(LinkUrl::sim());
        }
        if let Some(link) = link {
            self.open_link(link);
        }
        if let Some(profile) = profile {
            self.act(Action::Open(profile));
        }
    }

    /// Does what is asked.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::ShowTab(tab) => self.settings.tab = tab,
            Action::SetTheme(theme) => self.settings.theme = theme,
            Action::SetLanguage(language) => self.settings.language = language,
            Action::KeepLayout(layout) => self.settings.layout = Some(layout),
            Action::KeepSize(width, height) => self.settings.size = Some((width, height)),
            Action::Select(id) => self.shown = Some(id),
            Action::CloseSession(id) => self.close_session(id),
            Action::Stop => self.stop(),
            Action::Escape => self.escape(),
            Action::Close => self.close(),
            Action::Confirm => self.confirm(),
            Action::Dismiss => self.services.log.dismiss(),
            Action::Connect(action) => self.act_connect(action),
            Action::AskOpen => {
                self.services.file_question = Some(match self.settings.tab {
                    Tab::Hiperface => FileQuestion::Open,
                    Tab::Signals => FileQuestion::OpenCapture,
                });
            }
            Action::Open(path) if is_capture(&path) => {
                self.settings.tab = Tab::Signals;
                self.signals.act(signals::Action::Open(path), &mut self.services);
            }
            Action::Open(path) => {
                let store = self.services.world.store.clone();
                self.services.opening_files.push(path.clone());
                self.services.tasks.run("open", move || read_document(path, &store));
            }
            Action::FileNotChosen => {}
            Action::TypePath(question) => self.path_question = Some(question),
            Action::Typed(question, path) => self.typed(question, path),
            Action::Chosen(question, path) => self.chosen(question, path),
            Action::Recorder(desk, action) => self.act_recorder(desk, action),
            Action::AskForget(desk) => self.ask_forget(desk),
            Action::AskTable { desk, visible } => self.ask_table(desk, visible),
            Action::AskPicture(picture) => self.ask_picture(picture),
            Action::Hiperface(id, action) => self.act_hiperface(id, action),
            Action::Signals(action) => self.signals.act(action, &mut self.services),
            Action::Done(done) => self.done(done),
            Action::NoThread(why) => {
                let text = Text::new("session.no_thread").with("why", why);
                self.services.tell(Severity::Error, vec![text], None);
            }
        }
        self.keep();
    }

    /// Looks what has happened since the last time: called for every picture.
    pub fn poll(&mut self) {
        while let Some(action) = self.services.tasks.next() {
            self.act(action);
        }
        for encoder in &mut self.encoders {
            encoder.pump(&mut self.services);
            self.signals.follow(encoder);
        }
        self.signals.pump(&mut self.services);
        if let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.as_mut()) {
            search.pump();
        }
        self.services.pump_leaving();
        self.feed_exports();
        self.keep();
    }

    fn keep(&mut self) {
        self.keeper.keep(&self.settings, &self.services);
        for encoder in &mut self.encoders {
            encoder.keep_draft(&mut self.services);
        }
    }

    /// Puts actions into the studio from other threads.
    pub fn mailbox(&self) -> Mailbox {
        self.services.tasks.mailbox()
    }

    /// The file that the user is to be asked for, once.
    pub fn take_file_question(&mut self) -> Option<FileQuestion> {
        self.services.file_question.take()
    }

    /// The file whose path the user is to type, once.
    pub fn take_path_question(&mut self) -> Option<FileQuestion> {
        self.path_question.take()
    }

    /// Profiles that are being read from the disk.
    pub fn opening_files(&self) -> &[PathBuf] {
        &self.services.opening_files
    }

    /// All encoders, in the order in which they came.
    pub fn encoders(&self) -> &[Encoder] {
        &self.encoders
    }

    /// The encoder that is shown.
    pub fn encoder(&self) -> Option<&Encoder> {
        let id = self.shown?;
        self.encoders.iter().find(|encoder| encoder.id == id)
    }

    /// Something runs or is read all the time, in any session: there is something to stop.
    pub fn can_stop(&self) -> bool {
        let active = |encoder: &Encoder| {
            encoder.phase == Phase::Opening
                || encoder.is_busy()
                || encoder.line().is_some_and(|line| line.polling().is_some())
        };
        let search = self.search().is_some_and(connect::Search::is_running);
        self.encoders.iter().any(active) || search || self.signals.can_stop()
    }

    /// Live values come in: the picture has to be drawn again and again.
    pub fn is_live(&self) -> bool {
        self.encoders.iter().any(|encoder| encoder.line().is_some_and(|line| line.polling().is_some()))
    }

    fn search(&self) -> Option<&connect::Search> {
        self.connect.as_ref()?.search.as_ref()
    }

    pub(super) fn encoder_mut(&mut self, id: SessionId) -> Option<&mut Encoder> {
        self.encoders.iter_mut().find(|encoder| encoder.id == id)
    }

    pub(super) fn new_id(&mut self) -> SessionId {
        self.next_id += 1;
        SessionId(self.next_id)
    }

    pub(super) fn new_number(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id
    }

    pub(super) fn act_hiperface(&mut self, id: SessionId, action: hiperface::Action) {
        let Some(encoder) = self.encoders.iter().find(|encoder| encoder.id == id) else { return };
        match (action, &encoder.source) {
            (hiperface::Action::Reconnect, Source::Link(url)) => self.reconnect(id, url.clone()),
            (hiperface::Action::WriteInto(target), Source::File { document, .. }) => {
                let (document, wanted) = (document.clone(), encoder.staged.wanted());
                let crate::profile::Body::Hiperface(mut profile) = document.body;
                profile.fields = wanted;
                self.shown = Some(target);
                self.with_encoder(target, |encoder, services| encoder.plan_restore(profile, services));
            }
            (action, _) => self.with_encoder(id, |encoder, services| encoder.act(action, services)),
        }
    }

    pub(super) fn with_encoder(&mut self, id: SessionId, act: impl FnOnce(&mut Encoder, &mut Services)) {
        if let Some(encoder) = self.encoders.iter_mut().find(|encoder| encoder.id == id) {
            act(encoder, &mut self.services);
        }
    }

    fn done(&mut self, done: Done) {
        match done {
            Done::Opened { session, attempt, result } => self.opened(session, attempt, result),
            Done::OpenedForSearch { number, result } => {
                let search = self.connect.as_mut().and_then(|connect| connect.search.as_mut());
                match (search.filter(|search| search.number == number && search.is_running()), result) {
                    (Some(search), result) => search.opened(result, &self.services),
                    // One that was ended while it opened has no use for it.
                    (None, Ok(opened)) => self.turn_away(*opened, SessionId(number)),
                    (None, Err(_)) => {}
                }
            }
            Done::Ports(ports) => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = Some(ports.map_err(|error| explain::link(&error)));
                }
            }
            Done::Read { path, key, result, types } => self.read(path, key, result, types),
            Done::Waited(what) => self.waited = self.waited.max(Some(what)),
            Done::Looked { question, path, exists: true } => {
                let text = Text::new("question.replace").with("path", path.display());
                let confirm = Text::new("question.replace_it");
                self.question = Some(Question { text, confirm, then: Then::Write(question, path) });
            }
            Done::Looked { question, path, exists: false } => self.chosen(question, path),
            Done::TableWritten(desk, exported) => self.table_written(desk, exported),
            Done::PictureSaved(path, result) => self.picture_saved(&path, result),
            // That was to be looked at.
            Done::Left => {}
            Done::Written { session, path, key, document, remarks, result } => {
                self.with_encoder(session, |encoder, services| {
                    encoder.written((path, key), *document, remarks, result, services);
                })
            }
            Done::SettingsRead(read) => self.keeper.take(read, &mut self.settings, &mut self.services),
            Done::SettingsKept(result) => {
                if let Some(text) = self.keeper.kept(result) {
                    self.services.tell(Severity::Warning, vec![text], None);
                }
            }
            Done::Hiperface(id, done) => self.done_for_encoder(id, done),
            Done::Signals(done) => self.signals.done(done, &mut self.services),
        }
    }

    fn done_for_encoder(&mut self, id: SessionId, done: hiperface::Done) {
        if let hiperface::Done::DraftKept { result, .. } = &done {
            self.services.drafts_on_their_way = self.services.drafts_on_their_way.saturating_sub(1);
            if let Err(error) = result
                && !self.encoders.iter().any(|encoder| encoder.id == id)
            {
                let text = Text::new("session.draft_not_kept").with_text("why", explain::file(error));
                self.services.tell(Severity::Warning, vec![text], None);
            }
        }
        self.with_encoder(id, |encoder, services| encoder.done(done, services));
    }

    fn read(
        &mut self,
        path: PathBuf,
        key: String,
        result: Result<Box<Document>, ReadError>,
        types: Result<EncoderTypes, StoreError>,
    ) {
        let opening = &mut self.services.opening_files;
        if let Some(at) = opening.iter().position(|own| *own == path) {
            opening.remove(at);
        }
        match result {
            Ok(document) => {
                let known = self
                    .encoders
                    .iter()
                    .find(|encoder| matches!(&encoder.source, Source::File { key: own, .. } if *own == key))
                    .map(|encoder| encoder.id);
                let id = known.unwrap_or_else(|| self.new_id());
                self.shown = Some(id);
                if known.is_some() {
                    self.with_encoder(id, |encoder, _| encoder.take_document(path, key, *document));
                } else {
                    let types = self.services.encoder_types(types);
                    let encoder = Encoder::in_file(id, (path, key), *document, &types, &self.services);
                    self.encoders.push(encoder);
                }
            }
            Err(error) => self.services.tell(Severity::Error, vec![read_error(&path, &error)], None),
        }
    }

    pub(super) fn stop(&mut self) {
        for encoder in &mut self.encoders {
            encoder.stop(&mut self.services);
        }
        self.signals.stop();
        if let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.as_mut()) {
            search.stop();
        }
    }

    fn escape(&mut self) {
        if self.question.take().is_some() {
            return;
        }
        if self.can_stop() {
            self.stop();
            return;
        }
        if self.connect.is_some() {
            self.close_dialog();
            return;
        }
        if let Some(id) = self.shown
            && self.encoder().is_some_and(|encoder| encoder.review.is_some())
        {
            self.with_encoder(id, |encoder, _| encoder.close_review());
            return;
        }
        self.stop();
    }
}

/// A table, and no profile.
fn is_capture(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Reads a profile, as a task.
pub(super) fn read_document(path: PathBuf, store: &Store) -> Action {
    let result = read_profile(&path).map(Box::new);
    let key = hiperface::file_key(&path);
    // Where there is no profile, nobody waits for the table.
    let types = if result.is_ok() { store.encoder_types() } else { Ok(EncoderTypes::built_in()) };
    Action::Done(Done::Read { path, key, result, types })
}

pub(super) fn read_profile(path: &Path) -> Result<Document, ReadError> {
    let text = read_file(path).map_err(ReadError::File)?;
    Document::parse(&text).map_err(ReadError::Profile)
}

pub(super) fn read_error(path: &Path, error: &ReadError) -> Text {
    match error {
        ReadError::File(error) => explain::file(error),
        ReadError::Profile(error) => explain::profile(path, error),
    }
}
