//! State of the program and its actions. No window is needed: tests send actions and read the state.

use std::path::{Path, PathBuf};

use super::action::{Action, ShutdownWait, TaskResult};
use super::company_form::CompanyForm;
use super::comparison::ComparisonView;
use super::connect::ConnectDialog;
use super::devices::{AnyDevice, DeviceType, Selection};
use super::diverged::ProfileConflict;
use super::documents::read_document;
use super::file_question::FileQuestion;
use super::logbook::{LOGBOOK_TAB, LogbookPage};
use super::logbook_server::ServerThread;
use super::profile_library::ProfileLibrary;
use super::question::{FollowUpAction, Question};
use super::server_form::ServerForm;
use super::services::{Services, StudioEnvironment};
use super::settings_store::SettingsStore;
use super::sine_cosine::SineCosineSource;
use super::tab::Tab;
use super::tasks::{ActionMailbox, WakeCallback};
use super::tool::{Tool, ToolKind};
use super::{Settings, Severity, Text, explain};
use crate::link::LinkUrl;

/// The number of a session, counted from the start of the program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SessionId(pub(crate) u32);

pub struct Studio {
    pub settings: Settings,
    pub connect: Option<ConnectDialog>,
    pub question: Option<Question>,
    /// Profile whose file has changed since it was opened.
    pub diverged: Option<ProfileConflict>,
    pub services: Services,
    pub(super) tools: Vec<(Tab, Box<dyn Tool>)>,
    pub(crate) devices: Vec<Box<AnyDevice>>,
    pub(crate) shown: Selection,
    next_id: u32,
    pub(crate) settings_store: SettingsStore,
    pub(super) closing: bool,
    pub(super) waited: Option<ShutdownWait>,
    path_question: Option<FileQuestion>,
    pub(super) comparison: Option<Box<ComparisonView>>,
    pub(super) library: ProfileLibrary,
    pub(super) logbook: LogbookPage,
    pub(super) server_thread: Option<ServerThread>,
    pub(super) server_form: Option<ServerForm>,
    pub(super) company_form: Option<CompanyForm>,
}

impl Studio {
    /// Creates the application state from the stored settings. `wake` is called when there are new events.
    pub fn new(world: StudioEnvironment, wake: WakeCallback) -> Self {
        let mut services = Services::new(world, wake);
        let kinds = services.world.kinds;
        let (settings, settings_store) = SettingsStore::load(&mut services);
        let begin = |kind: &&dyn ToolKind| (kind.tab(), kind.create_tool(settings.links_of(kind.tab())));
        Studio {
            tools: kinds.tools().iter().map(begin).collect(),
            settings,
            connect: None,
            question: None,
            diverged: None,
            services,
            devices: Vec::new(),
            shown: Selection::default(),
            next_id: 0,
            settings_store,
            closing: false,
            waited: None,
            path_question: None,
            comparison: None,
            library: ProfileLibrary::default(),
            logbook: LogbookPage::default(),
            server_thread: None,
            server_form: None,
            company_form: None,
        }
    }

    /// Opens a link or a profile, or the virtual encoder if neither is given.
    pub fn start_with(&mut self, link: Option<LinkUrl>, profile: Option<PathBuf>) {
        let tab = self.tab_for_link(link.as_ref());
        let is_empty = link.is_none() && profile.is_none();
        let link = link.or_else(|| self.virtual_link(tab).filter(|_| is_empty));
        if let Some(link) = link {
            self.open_link(tab, link);
        }
        if let Some(profile) = profile {
            self.handle_action(Action::Open(profile));
        }
    }

    pub fn handle_action(&mut self, action: Action) {
        self.devices.iter_mut().for_each(|device| device.mark_draft_due());
        match self.with_absolute_path(action) {
            Action::ShowTab(tab) => self.show_tab(tab),
            Action::New(tab) => self.new_profile(tab),
            Action::SearchLogbook(filter) => self.search_logbook(filter),
            Action::EditNote(device, note) => self.logbook.edit_note(device, note),
            Action::AddNote(device) => self.add_note(device),
            Action::SetTheme(theme) => self.settings.theme = theme,
            Action::SetLanguage(language) => self.settings.language = language,
            Action::SetUserName(name) => {
                self.settings.user_name = name;
                name.apply();
            }
            Action::KeepLayout(layout) => self.settings.layout = Some(layout),
            Action::OpenLowerPanel(open) => self.settings.lower_open = open,
            Action::ShowValuesAlone(alone) => self.settings.values_alone = alone,
            Action::StoreWindowSize(width, height) => self.settings.size = Some((width, height)),
            Action::Select(id) => {
                if let Some(tab) = self.device(id).map(|device| device.tab()) {
                    self.show(tab, id);
                }
            }
            Action::CloseSession(id) => self.close_session(id),
            Action::Stop => self.stop(),
            Action::StopMotion => self.stop_motion(),
            Action::ReleaseMotion => self.release_jogs(),
            Action::Escape => self.handle_escape_key(),
            Action::Close => self.close(),
            Action::Quit => self.force_quit(),
            Action::Confirm => self.confirm_question(),
            Action::Dismiss => self.services.log.dismiss(),
            Action::Connect(action) => self.apply_connect_action(action),
            Action::Server(action) => self.apply_server_action(action),
            Action::Company(action) => self.apply_company_action(action),
            Action::OpenVirtual => {
                let tab = self.settings.tab;
                if let Some(link) = self.virtual_link(tab) {
                    self.open_link(tab, link);
                }
            }
            Action::Save(id) => self.save_in_place(id),
            Action::Resolve(resolve) => self.resolve_conflict(resolve),
            Action::AskOpen => {
                let is_tool = self.is_tool(self.settings.tab);
                self.services.file_question =
                    Some(if is_tool { FileQuestion::OpenCapture } else { FileQuestion::Open });
            }
            Action::Open(path) => {
                self.close_library();
                if let Err(path) = self.open_in_tool(path) {
                    let (store, kinds) = (self.services.world.store.clone(), self.services.world.kinds);
                    self.services.opening_files.push(path.clone());
                    self.services.tasks.run("open", move || read_document(path, &store, kinds));
                }
            }
            Action::FileNotChosen => {}
            Action::TypePath(question) => self.path_question = Some(question),
            Action::Typed(question, path) => self.handle_typed_path(question, path),
            Action::Chosen(question, path) => self.handle_chosen_path(question, path),
            Action::Comparison(action) => self.apply_comparison_action(action),
            Action::Library(action) => self.apply_library_action(action),
            Action::Recorder(owner, action) => self.apply_recorder_action(owner, action),
            Action::AskClearRecording(owner) => self.confirm_discard_recording(owner),
            Action::AskTable { owner, visible } => self.ask_table_path(owner, visible),
            Action::AskReport(owner) => self.ask_report_path(owner),
            Action::AskPicture(picture) => self.ask_picture_path(picture),
            Action::AskTrace(session) => self.ask_trace_path(session),
            Action::PictureTruncated => self.notify_picture_truncated(),
            Action::Review(id, action) => {
                self.with_device(id, |device, services| device.apply_review_action(action, services))
            }
            Action::Command(id, command) => self.command(id, command),
            Action::Device(id, action) => self.apply_device_action(id, action),
            Action::Tool(tab, action) => self.apply_tool_action(tab, action),
            Action::Done(done) => self.handle_result(done),
            Action::NoThread(why) => {
                self.devices.iter_mut().for_each(|device| device.pause_save_for_question());
                let text = Text::new("session.no_thread").with("why", why);
                self.services.notify(Severity::Error, vec![text], None);
            }
        }
        self.stop_hidden_motion();
        self.write_if_changed();
    }

    /// Handles all events received since the last call. Must be called in every frame.
    pub fn poll(&mut self) {
        while let Some(action) = self.services.tasks.next() {
            self.handle_action(action);
        }
        for device in &mut self.devices {
            device.process_events(&mut self.services);
            if let Some(source) = device.sine_cosine_mut() {
                self.tools.iter_mut().for_each(|(_, tool)| tool.adopt_reading(source));
            }
        }
        self.tools.iter_mut().for_each(|(_, tool)| tool.process_events(&mut self.services));
        if let Some(connect) = &mut self.connect {
            connect.process_events();
        }
        self.services.poll_closing_sessions();
        self.start_due_live_values();
        self.feed_exports();
        self.remember_drives();
        self.refresh_settings();
        self.start_exchange();
        self.refresh_comparison();
        self.stop_hidden_motion();
        self.write_if_changed();
    }

    fn write_if_changed(&mut self) {
        self.settings_store.write_if_changed(&self.settings, &self.services);
        for device in &mut self.devices {
            device.write_draft(&mut self.services);
        }
    }

    pub fn mailbox(&self) -> ActionMailbox {
        self.services.tasks.mailbox()
    }

    pub fn take_file_question(&mut self) -> Option<FileQuestion> {
        self.services.file_question.take()
    }

    /// Takes the pending request for a file whose path the user must type, if any.
    pub fn take_path_question(&mut self) -> Option<FileQuestion> {
        self.path_question.take()
    }

    pub fn files_being_opened(&self) -> &[PathBuf] {
        &self.services.opening_files
    }

    /// Returns all devices, in the order in which they were opened.
    pub fn devices(&self) -> &[Box<AnyDevice>] {
        &self.devices
    }

    pub fn device(&self, id: SessionId) -> Option<&AnyDevice> {
        self.devices.iter().map(Box::as_ref).find(|device| device.id() == id)
    }

    /// Returns the device shown in the open tab, or else the one shown last.
    pub fn selected_device(&self) -> Option<&AnyDevice> {
        let tab = self.settings.tab;
        let id = if self.is_tool(tab) { self.shown.last() } else { self.shown.session_in_tab(tab) };
        self.device(id?)
    }

    /// Returns the device of type `M` that its tab shows.
    pub fn selected_model<M: DeviceType>(&self) -> Option<&M> {
        self.device(self.shown.session_in_tab(M::TAB)?)?.get()
    }

    fn is_tool(&self, tab: Tab) -> bool {
        self.tools.iter().any(|(own, _)| *own == tab)
    }

    /// Returns the link to the virtual device of a tab, or `None` for a tool.
    fn virtual_link(&self, tab: Tab) -> Option<LinkUrl> {
        Some(self.services.world.kinds.kind_for_tab(tab)?.virtual_link())
    }

    /// Shows a tab. If no device is open in it, an unsaved profile is created, provided the kind of device supports
    /// this.
    fn show_tab(&mut self, tab: Tab) {
        if tab == LOGBOOK_TAB {
            // Another window or a command may have added entries.
            self.logbook.mark_stale();
        }
        self.settings.tab = tab;
        if self.shown.session_in_tab(tab).is_none() {
            self.new_profile(tab);
        }
    }

    /// Creates an unsaved profile, if the kind of device supports unsaved profiles.
    fn new_profile(&mut self, tab: Tab) {
        let Some(kind) = self.services.world.kinds.kind_for_tab(tab) else { return };
        let taken: Vec<PathBuf> = self.devices.iter().filter_map(|device| device.source().suggested_path()).collect();
        let id = self.new_id();
        let is_taken = |name: &Path| taken.iter().any(|own| own == name);
        if let Some(device) = kind.new_profile(id, &is_taken, &mut self.services) {
            self.devices.push(device);
            self.show(tab, id);
        }
    }

    /// Returns the source of sine and cosine signals, if one of the devices shown in their tabs has them.
    pub fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        let kinds = self.services.world.kinds.devices().iter();
        kinds.into_iter().find_map(|kind| self.device(self.shown.session_in_tab(kind.tab())?)?.sine_cosine())
    }

    pub(crate) fn show(&mut self, tab: Tab, id: SessionId) {
        self.settings.tab = tab;
        self.shown.select_session(tab, id);
    }

    /// Returns whether there is anything to stop: a job, polling, a device search or a tool.
    pub fn can_stop(&self) -> bool {
        self.devices.iter().any(|device| device.is_active()) || self.has_active_search() || self.can_stop_tools()
    }

    /// Returns whether a job or a measurement is running. Polling does not count.
    pub fn is_working(&self) -> bool {
        let device = |device: &AnyDevice| device.is_opening() || device.is_busy();
        self.devices.iter().map(Box::as_ref).any(device) || self.has_active_search() || self.can_stop_tools()
    }

    /// Returns whether live values are arriving. The window must then be drawn continuously.
    pub fn is_live(&self) -> bool {
        self.devices.iter().any(|device| device.is_polling()) || self.has_control()
    }

    fn has_active_search(&self) -> bool {
        self.connect.as_ref().is_some_and(ConnectDialog::is_searching)
    }

    fn can_stop_tools(&self) -> bool {
        self.tools.iter().any(|(_, tool)| tool.can_stop())
    }

    pub(super) fn device_mut(&mut self, id: SessionId) -> Option<&mut AnyDevice> {
        self.devices.iter_mut().map(Box::as_mut).find(|device| device.id() == id)
    }

    pub(crate) fn new_id(&mut self) -> SessionId {
        self.next_id += 1;
        SessionId(self.next_id)
    }

    pub(crate) fn next_number(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id
    }

    pub(crate) fn with_device(&mut self, id: SessionId, act: impl FnOnce(&mut AnyDevice, &mut Services)) {
        if let Some(device) = self.devices.iter_mut().find(|device| device.id() == id) {
            act(device.as_mut(), &mut self.services);
        }
    }

    fn handle_result(&mut self, done: TaskResult) {
        match done {
            TaskResult::OpenedConnection(attempt) => self.handle_opened(attempt),
            TaskResult::Device(id, done) => self.finish_device_action(id, done),
            TaskResult::Finder(tab, done) => self.handle_finder_result(tab, done),
            TaskResult::Shared(with) => with(&mut self.services, &mut self.devices),
            TaskResult::Ports(ports) => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = Some(ports.map_err(|error| explain::link_error_text(&error)));
                }
            }
            TaskResult::Read { file, result, open } => self.read(file, result, open),
            TaskResult::Compare { reading, path, result } => self.show_compared_profile(reading, &path, result),
            TaskResult::LibraryRead(number, listing) => self.show_library(number, listing),
            TaskResult::ComparisonCandidates(candidates) => self.show_candidates(*candidates),
            TaskResult::Waited(what) => self.waited = self.waited.max(Some(what)),
            TaskResult::TargetChecked { question, path, exists: true } => {
                let text = Text::new("question.replace").with("path", path.display());
                let confirm = Text::new("question.replace_it");
                self.question = Some(Question::new(text, confirm, FollowUpAction::Write(question, path)));
            }
            TaskResult::TargetChecked { question, path, exists: false } => self.handle_chosen_path(question, path),
            TaskResult::TableWritten(owner, exported) => self.finish_table_export(owner, exported),
            TaskResult::CompanyChecked(number, wanted, checked) => self.save_company(number, *wanted, checked),
            TaskResult::ReportWritten { path, result } => self.finish_report(&path, result),
            TaskResult::FileSaved { message, path, result } => self.finish_file_save(message, &path, result),
            // It has been handled by polling.
            TaskResult::Left => {}
            TaskResult::Written { saving, file, result } => self.finish_profile_save(*saving, file, result),
            TaskResult::Diverged(diverged) => self.show_conflict(*diverged),
            TaskResult::WouldLose(saving, lost) => self.confirm_comment_loss(*saving, &lost),
            TaskResult::SettingsRead(read) => self.settings_store.adopt(read, &mut self.settings, &mut self.services),
            TaskResult::SettingsKept(result) => {
                self.settings_store.finish_write(result, &mut self.settings, &mut self.services)
            }
            TaskResult::SettingsReread(Ok(found)) => self.apply_read_settings(found.map(|found| *found)),
            TaskResult::SettingsReread(Err(error)) => self.handle_settings_error(&error),
            TaskResult::Draft(id, done) => self.finish_draft(id, done),
            TaskResult::Listed(id, of, listed) => {
                self.with_device(id, |device, _| device.set_history(&of, *listed));
                self.logbook.mark_stale();
            }
            TaskResult::ServerTested(number, result) => self.show_server_test(number, result),
            TaskResult::PasswordSaved(saved) => self.finish_password(saved),
            TaskResult::EntriesExchanged { received, state } => self.show_exchange(received, state),
            TaskResult::LogbookRead(number, matches) => self.show_logbook_matches(number, matches),
            TaskResult::NoteAdded(result) => self.finish_note(result),
            TaskResult::Backup(session, read) => {
                self.with_device(session, |device, services| device.apply_backup(*read, services));
            }
            TaskResult::Tool(tab, done) => self.finish_tool_action(tab, done),
        }
    }

    pub(super) fn stop(&mut self) {
        for device in &mut self.devices {
            device.stop(&mut self.services);
        }
        self.stop_tools();
        if let Some(connect) = &mut self.connect {
            connect.stop();
        }
    }

    pub(super) fn stop_tools(&mut self) {
        self.tools.iter_mut().for_each(|(_, tool)| tool.stop(&mut self.services));
    }

    fn handle_escape_key(&mut self) {
        // Escape stops a motion before anything else.
        if self.is_requested_motion_running() {
            return self.stop_motion();
        }
        if self.dismiss_question() || self.diverged.take().is_some() || self.close_comparison() {
            return;
        }
        // Escape does not stop polling, because values of drives must stay visible while a dialog closes or while
        // drives are under control.
        if self.is_working() {
            self.stop();
            return;
        }
        if self.connect.is_some() {
            self.close_dialog();
            return;
        }
        if self.close_library() || self.server_form.take().is_some() || self.company_form.take().is_some() {
            return;
        }
        if let Some(id) = self.selected_device().filter(|device| device.is_reviewing()).map(|device| device.id()) {
            self.with_device(id, |device, _| device.close_review());
            return;
        }
        if self.has_control() {
            return self.stop_motion();
        }
        self.stop();
    }
}
