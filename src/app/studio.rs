//! All that the window knows, and what it can do. It is complete without a window: a test sends actions and reads state.

use std::path::PathBuf;

use super::action::{Action, AnyOpened, Done, Waited};
use super::connect::Connect;
use super::devices::{AnyDevice, Shown};
use super::diverged::Diverged;
use super::documents::{is_capture, read_document};
use super::file_question::FileQuestion;
use super::keep::Keeper;
use super::question::{Question, Then};
use super::services::{Services, World};
use super::sine_cosine::SineCosineSource;
use super::tab::Tab;
use super::tasks::{Mailbox, Wake};
use super::{Settings, Severity, Text, explain};
use crate::devices::biss::state as biss;
use crate::devices::hiperface::state::Encoder;
use crate::link::LinkUrl;
use crate::signals::state::{self as signals, Signals};

/// A session's number, from the start of the program on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SessionId(pub(crate) u32);

/// All state of the window.
pub struct Studio {
    /// What is remembered from one start to the next.
    pub settings: Settings,
    /// The connection dialog, when it is open.
    pub connect: Option<Connect>,
    /// A question that has to be answered.
    pub question: Option<Question>,
    /// A profile that others have changed in its file since it was opened.
    pub diverged: Option<Diverged>,
    /// The log, the jobs.
    pub services: Services,
    /// The Signals tab.
    pub signals: Signals,
    pub(crate) devices: Vec<Box<AnyDevice>>,
    pub(crate) shown: Shown,
    next_id: u32,
    pub(crate) keeper: Keeper,
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
            signals: Signals::at(settings.links(Tab::Signals)),
            settings,
            connect: None,
            question: None,
            diverged: None,
            services,
            devices: Vec::new(),
            shown: Shown::default(),
            next_id: 0,
            keeper,
            closing: false,
            waited: None,
            path_question: None,
        }
    }

    /// What the window begins with: a link, a profile, or else the virtual encoder.
    pub fn begin(&mut self, link: Option<LinkUrl>, profile: Option<PathBuf>) {
        let tab = self.tab_of(link.as_ref());
        let link = link.or_else(|| profile.is_none().then(|| tab.virtual_link()));
        if let Some(link) = link {
            self.open_link(tab, link);
        }
        if let Some(profile) = profile {
            self.act(Action::Open(profile));
        }
    }

    /// Does what is asked.
    pub fn act(&mut self, action: Action) {
        match self.with_whole_path(action) {
            Action::ShowTab(tab) => self.show_tab(tab),
            Action::NewLayout => self.new_layout(),
            Action::SetTheme(theme) => self.settings.theme = theme,
            Action::SetLanguage(language) => self.settings.language = language,
            Action::KeepLayout(layout) => self.settings.layout = Some(layout),
            Action::KeepSize(width, height) => self.settings.size = Some((width, height)),
            Action::Select(id) => {
                if let Some(tab) = self.device(id).map(|device| device.tab()) {
                    self.show(tab, id);
                }
            }
            Action::CloseSession(id) => self.close_session(id),
            Action::Stop => self.stop(),
            Action::StopMotion => self.stop_motion(),
            Action::LetGo => self.let_go_of_jogs(),
            Action::Escape => self.escape(),
            Action::Close => self.close(),
            Action::Quit => self.quit(),
            Action::Confirm => self.confirm(),
            Action::Dismiss => self.services.log.dismiss(),
            Action::Connect(action) => self.act_connect(action),
            Action::OpenVirtual => {
                let tab = self.settings.tab;
                self.open_link(tab, tab.virtual_link());
            }
            Action::Save(id) => self.save_in_place(id),
            Action::Resolve(resolve) => self.resolve(resolve),
            Action::AskOpen => {
                self.services.file_question = Some(match self.settings.tab {
                    Tab::Signals => FileQuestion::OpenCapture,
                    Tab::Hiperface | Tab::Biss | Tab::Ssi | Tab::Interbus | Tab::Hiperdrive => FileQuestion::Open,
                });
            }
            Action::Open(path) if is_capture(&path) => {
                self.settings.tab = Tab::Signals;
                self.signals.act(signals::Action::Open(path), &mut self.services);
            }
            Action::Open(path) => {
                let (store, formats) = (self.services.world.store.clone(), self.services.world.formats);
                self.services.opening_files.push(path.clone());
                self.services.tasks.run("open", move || read_document(path, &store, formats));
            }
            Action::FileNotChosen => {}
            Action::TypePath(question) => self.path_question = Some(question),
            Action::Typed(question, path) => self.typed(question, path),
            Action::Chosen(question, path) => self.chosen(question, path),
            Action::Recorder(desk, action) => self.act_recorder(desk, action),
            Action::AskForget(desk) => self.ask_forget(desk),
            Action::AskTable { desk, visible } => self.ask_table(desk, visible),
            Action::AskPicture(picture) => self.ask_picture(picture),
            Action::PictureCut => self.tell_picture_cut(),
            Action::Review(id, action) => self.with_device(id, |device, services| device.act_review(action, services)),
            Action::Command(id, command) => self.command(id, command),
            Action::Device(id, action) => self.act_device(id, action),
            Action::Signals(action) => self.act_signals(action),
            Action::Done(done) => self.done(done),
            Action::NoThread(why) => {
                self.devices.iter_mut().for_each(|device| device.save_waits());
                let text = Text::new("session.no_thread").with("why", why);
                self.services.tell(Severity::Error, vec![text], None);
            }
        }
        self.hold_in_sight();
        self.keep();
    }

    /// Looks what has happened since the last time: called for every picture.
    pub fn poll(&mut self) {
        while let Some(action) = self.services.tasks.next() {
            self.act(action);
        }
        for device in &mut self.devices {
            device.pump(&mut self.services);
            if let Some(source) = device.sine_cosine_mut() {
                self.signals.follow(source);
            }
        }
        self.signals.pump(&mut self.services);
        if let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.as_mut()) {
            search.pump();
        }
        self.services.pump_leaving();
        self.feed_exports();
        self.remember_drives();
        self.look_at_settings();
        self.hold_in_sight();
        self.keep();
    }

    fn keep(&mut self) {
        self.keeper.keep(&self.settings, &self.services);
        for device in &mut self.devices {
            device.keep_draft(&mut self.services);
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

    /// All devices, in the order in which they came.
    pub fn devices(&self) -> &[Box<AnyDevice>] {
        &self.devices
    }

    /// One of them.
    pub fn device(&self, id: SessionId) -> Option<&AnyDevice> {
        self.devices.iter().map(Box::as_ref).find(|device| device.id() == id)
    }

    /// The device that the open tab shows; where that shows none, the one that was shown last.
    pub fn shown(&self) -> Option<&AnyDevice> {
        let id = match self.settings.tab {
            Tab::Signals => self.shown.last(),
            tab => self.shown.of(tab),
        };
        self.device(id?)
    }

    /// The encoder that the HIPERFACE tab shows.
    pub fn hiperface(&self) -> Option<&Encoder> {
        self.device(self.shown.of(Tab::Hiperface)?)?.get()
    }

    /// Sine and cosine of a device that is shown in its own tab.
    pub fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        Tab::DEVICES.into_iter().find_map(|tab| self.device(self.shown.of(tab)?)?.sine_cosine())
    }

    /// The encoder that the BiSS tab shows.
    pub fn biss(&self) -> Option<&biss::Encoder> {
        self.device(self.shown.of(Tab::Biss)?)?.get()
    }

    /// Shows a device in its tab.
    pub(crate) fn show(&mut self, tab: Tab, id: SessionId) {
        self.settings.tab = tab;
        self.shown.set(tab, id);
    }

    /// Something runs or is read all the time, in any session: there is something to stop.
    pub fn can_stop(&self) -> bool {
        let search = self.search().is_some_and(crate::devices::hiperface::state::Search::is_running);
        self.devices.iter().any(|device| device.is_active()) || search || self.signals.can_stop()
    }

    /// Something runs that comes to an end by itself, or measures; being read all the time is none of that.
    pub fn works(&self) -> bool {
        let search = self.search().is_some_and(crate::devices::hiperface::state::Search::is_running);
        let device = |device: &AnyDevice| device.is_opening() || device.is_busy();
        self.devices.iter().map(Box::as_ref).any(device) || search || self.signals.can_stop()
    }

    /// Live values come in: the picture has to be drawn again and again.
    pub fn is_live(&self) -> bool {
        self.devices.iter().any(|device| device.is_polling()) || self.is_in_control()
    }

    fn search(&self) -> Option<&crate::devices::hiperface::state::Search> {
        self.connect.as_ref()?.search.as_ref()
    }

    pub(super) fn device_mut(&mut self, id: SessionId) -> Option<&mut AnyDevice> {
        self.devices.iter_mut().map(Box::as_mut).find(|device| device.id() == id)
    }

    pub(crate) fn new_id(&mut self) -> SessionId {
        self.next_id += 1;
        SessionId(self.next_id)
    }

    pub(crate) fn new_number(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id
    }

    pub(crate) fn with_device(&mut self, id: SessionId, act: impl FnOnce(&mut AnyDevice, &mut Services)) {
        if let Some(device) = self.devices.iter_mut().find(|device| device.id() == id) {
            act(device.as_mut(), &mut self.services);
        }
    }

    fn done(&mut self, done: Done) {
        match done {
            Done::Opened(attempt) => self.opened(attempt),
            Done::FoundDrives(number, found) => self.found_drives(number, found),
            Done::Device(id, done) => self.device_done(id, done),
            Done::Families(families, broken) => self.take_families(families, &broken),
            Done::OpenedForSearch { number, result } => {
                let search = self.connect.as_mut().and_then(|connect| connect.search.as_mut());
                match (search.filter(|search| search.number == number && search.is_running()), result) {
                    (Some(search), result) => search.opened(result, &self.services),
                    // One that was ended while it opened has no use for it.
                    (None, Ok(opened)) => opened.turn_away(SessionId(number), &mut self.services),
                    (None, Err(_)) => {}
                }
            }
            Done::Ports(ports) => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = Some(ports.map_err(|error| explain::link(&error)));
                }
            }
            Done::Read { file, result, known } => self.read(file, result, known),
            Done::Waited(what) => self.waited = self.waited.max(Some(what)),
            Done::Looked { question, path, exists: true } => {
                let text = Text::new("question.replace").with("path", path.display());
                let confirm = Text::new("question.replace_it");
                self.question = Some(Question::before(text, confirm, Then::Write(question, path)));
            }
            Done::Looked { question, path, exists: false } => self.chosen(question, path),
            Done::TableWritten(desk, exported) => self.table_written(desk, exported),
            Done::PictureSaved(path, result) => self.picture_saved(&path, result),
            Done::ReportSaved(path, result) => self.report_saved(&path, result),
            // That was to be looked at.
            Done::Left => {}
            Done::Written { saving, file, result } => self.with_device(saving.session, |device, services| {
                device.written(*saving, file, result, services);
            }),
            Done::Diverged(diverged) => self.has_diverged(*diverged),
            Done::WouldLose(saving, lost) => self.ask_to_lose(*saving, &lost),
            Done::SettingsRead(read) => self.keeper.take(read, &mut self.settings, &mut self.services),
            Done::SettingsKept(result) => self.keeper.kept(result, &mut self.settings, &mut self.services),
            Done::SettingsSeen(Ok(found)) => self.saw_settings(found.map(|found| *found)),
            Done::SettingsSeen(Err(error)) => self.could_not_see_settings(&error),
            Done::Draft(id, done) => self.draft_done(id, done),
            Done::Listed(id, of, listed) => self.with_device(id, |device, _| device.listed(&of, *listed)),
            Done::Backup { session, of, path, result } => {
                self.with_device(session, |device, services| device.take_backup(&of, &path, result, services));
            }
            Done::Signals(done) => self.signals.done(done, &mut self.services),
        }
    }

    pub(super) fn stop(&mut self) {
        for device in &mut self.devices {
            device.stop(&mut self.services);
        }
        self.signals.stop(&mut self.services);
        if let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.as_mut()) {
            search.stop();
        }
    }

    fn escape(&mut self) {
        // Before anything else.
        if self.moves_by_hand() {
            return self.stop_motion();
        }
        if self.decline() || self.diverged.take().is_some() {
            return;
        }
        // Watching is no work: whoever closes a dialog, or has drives in hand, goes on seeing them.
        if self.works() {
            self.stop();
            return;
        }
        if self.connect.is_some() {
            self.close_dialog();
            return;
        }
        if let Some(id) = self.shown().filter(|device| device.is_reviewing()).map(|device| device.id()) {
            self.with_device(id, |device, _| device.close_review());
            return;
        }
        if self.is_in_control() {
            return self.stop_motion();
        }
        self.stop();
    }
}
