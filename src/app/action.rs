//! The actions of the studio: requests from the user or a view, and results of finished tasks.

use std::any::Any;
use std::path::PathBuf;

use super::company_form::CompanyAction;
use super::comparison::{ComparisonAction, ComparisonCandidates};
use super::devices::{AnyDevice, DeviceCommand, OpenProfile};
use super::diverged::{ConflictResolution, ProfileConflict};
use super::file_question::FileQuestion;
use super::logbook::LogbookMatches;
use super::logbook_server::ServerExchange;
use super::payload::Payload;
use super::profile_library::{LibraryAction, LibraryListing};
use super::recorder::{self, ExportResult};
use super::review::Permit;
use super::server_form::ServerAction;
use super::services::Services;
use super::session::{DeviceHistory, DraftOutcome, Kind, ProfileFile, SaveRequest};
use super::settings_store::{LoadedSettings, SavedSettings};
use super::shutdown::ClosingSessionInfo;
use super::studio::SessionId;
use super::tab::Tab;
use super::{ColorScheme, Language, Picture, Settings, Text, connect};
use crate::link::LinkError;
use crate::profile::{PlanId, ProfileDocument, ProfileError};
use crate::store::{DeviceKey, Entry, EntryFilter, FileError, KeyringError, LogbookError, ServerError, UserName};
use crate::worker::{OpenError, Worker};

pub enum Action {
    ShowTab(Tab),
    SetTheme(ColorScheme),
    SetLanguage(Language),
    /// Set how the logbook refers to the user.
    SetUserName(UserName),
    KeepLayout(String),
    /// Open the lower panel, or collapse it to one line.
    OpenLowerPanel(bool),
    /// Show live values without (`true`) or with their plot.
    ShowValuesAlone(bool),
    /// Store the new size of the window, in points.
    StoreWindowSize(u32, u32),
    Select(SessionId),
    /// End a session. If the session has edits, the user is asked first.
    CloseSession(SessionId),
    Stop,
    StopMotion,
    /// End all motions that last while a button is held, because the window has lost the keyboard focus or a dialog
    /// covers it.
    ReleaseMotion,
    /// Handle the Escape key: stop the running job, or else close the dialog.
    Escape,
    /// Close the window. The user is asked first if data would be lost.
    Close,
    /// Close the window without asking, because the system is ending the program.
    Quit,
    Confirm,
    Dismiss,
    Connect(connect::ConnectAction),
    /// Execute an action of the form for the logbook server.
    Server(ServerAction),
    Company(CompanyAction),
    OpenVirtual,
    Save(SessionId),
    /// Resolve the conflict between a profile and its file, which another program has changed.
    Resolve(ConflictResolution),
    /// Ask for a file to open: a capture in the Signals tab, or a profile in any other tab.
    AskOpen,
    /// Open a `.csv` file as a capture, or any other file as a profile.
    Open(PathBuf),
    FileNotChosen,
    /// Ask for a path as text, because the system has no file dialog.
    TypePath(FileQuestion),
    /// Use the path that the user typed. Before an existing file is replaced, the user is asked, as a system dialog
    /// would do.
    Typed(FileQuestion, PathBuf),
    /// Use the file chosen in a system dialog. It may be replaced without asking again.
    Chosen(FileQuestion, PathBuf),
    Comparison(ComparisonAction),
    Library(LibraryAction),
    /// Show the logbook entries that match a filter.
    SearchLogbook(EntryFilter),
    /// Set the text of an unfinished note about a device.
    EditNote(DeviceKey, String),
    /// Add the unfinished note about a device to the logbook.
    AddNote(DeviceKey),
    Recorder(RecorderOwner, recorder::RecorderAction),
    /// Clear a recording. The user is asked first if the recording is long.
    AskClearRecording(RecorderOwner),
    /// Ask for the file to which a recording is exported as a table.
    AskTable {
        owner: RecorderOwner,
        /// Whether the table contains only the visible part of the recording.
        visible: bool,
    },
    /// Ask for the file to which a report is written.
    AskReport(RecorderOwner),
    AskPicture(Picture),
    /// Ask for the file to which a session's trace is written.
    AskTrace(SessionId),
    /// Report that no picture was taken, because the plot is not completely visible.
    PictureTruncated,
    Review(SessionId, ReviewAction),
    /// Execute a command that every kind of device supports. The session need not be the one shown.
    Command(SessionId, DeviceCommand),
    /// Execute an action specific to one kind of device. See [`Action::device`].
    Device(SessionId, Payload),
    /// Create an unsaved profile for the kind of device shown in a tab.
    New(Tab),
    /// Execute an action of a tool. See [`Action::tool`].
    Tool(Tab, Payload),
    Done(TaskResult),
    /// Report that the system could not start a thread for a task.
    NoThread(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReviewAction {
    /// Execute the plan with this id, which the user has reviewed.
    Write(PlanId),
    /// Grant or withdraw a permission for the write. The plan is then made again.
    Toggle(Permit),
    /// Set whether to write although the device has reached its limit of write cycles.
    ForceWear(bool),
    Close,
}

pub enum TaskResult {
    /// The check whether the target file of a save exists has ended.
    TargetChecked {
        question: FileQuestion,
        path: PathBuf,
        exists: bool,
    },
    /// The attempt to open a link for a session has succeeded or failed.
    OpenedConnection(ConnectAttempt),
    /// A device search in the connection form of a tab has a result. See [`TaskResult::from_finder`].
    Finder(Tab, Payload),
    /// A task that belongs to no session has ended. The function handles its result.
    Shared(SharedResultHandler),
    Ports(Result<Vec<connect::PortEntry>, LinkError>),
    Read {
        file: ProfileFile,
        result: Result<Box<ProfileDocument>, ReadError>,
        /// Function that opens the profile, or `None` if the window does not support its kind of device.
        open: Option<OpenProfile>,
    },
    /// A profile for one side of the comparison was read, or could not be read.
    Compare {
        /// Number of the task.
        reading: u32,
        path: PathBuf,
        result: Result<Box<ProfileDocument>, ReadError>,
    },
    /// The profiles of the library were read. The number identifies the reading.
    LibraryRead(u64, LibraryListing),
    /// The backups and logbook entries that can be compared with a kind of device were listed.
    ComparisonCandidates(Box<ComparisonCandidates>),
    Written {
        saving: Box<SaveRequest>,
        file: ProfileFile,
        result: Result<(), FileError>,
    },
    /// A profile was not saved because its file has changed since it was opened.
    Diverged(Box<ProfileConflict>),
    /// A profile was not saved because these comments in its file would be lost.
    WouldLose(Box<SaveRequest>, Vec<String>),
    TableWritten(RecorderOwner, ExportResult),
    /// A report was written, or could not be created or written.
    ReportWritten {
        path: PathBuf,
        result: Result<Result<(), FileError>, Text>,
    },
    /// The company name and logo were checked for use in reports. Contains the number of the check, and the reason if
    /// they cannot be used.
    CompanyChecked(u32, Box<Settings>, Result<(), Text>),
    /// A picture, a report or a trace was saved, or could not be saved. `message` names what was saved.
    FileSaved {
        message: Text,
        path: PathBuf,
        result: Result<(), FileError>,
    },
    /// The time limit of a wait before closing has expired.
    Waited(ShutdownWait),
    Left,
    /// The settings were read later than the start of the program.
    SettingsRead(LoadedSettings),
    SettingsKept(Result<SavedSettings, FileError>),
    /// The settings were read again while drives are under control. `None` means that there is no file.
    SettingsReread(Result<Option<Box<Settings>>, FileError>),
    Draft(SessionId, DraftOutcome),
    Listed(SessionId, DeviceKey, Box<DeviceHistory>),
    /// A logbook search has ended. The number identifies the search.
    LogbookRead(u64, Result<LogbookMatches, LogbookError>),
    NoteAdded(Result<(), LogbookError>),
    /// A connection test has ended. Contains the number of the test and the number of entries on the server.
    ServerTested(u32, Result<Option<u64>, ServerError>),
    /// The server password was saved in the keyring, or could not be saved.
    PasswordSaved(Result<(), KeyringError>),
    /// Entries were exchanged with the logbook server, or the exchange failed.
    EntriesExchanged {
        /// Whether entries from other computers were received.
        received: bool,
        state: ServerExchange,
    },
    /// A backup was read, or could not be read.
    Backup(SessionId, Box<BackupReadResult>),
    /// A task started by a device has ended. See `TaskResult::device`.
    Device(SessionId, Payload),
    /// A task of a tool has ended. See [`TaskResult::from_tool`].
    Tool(Tab, Payload),
}

pub struct ConnectAttempt {
    pub session: SessionId,
    /// Number of the attempt. Results of earlier attempts of a session are ignored.
    pub attempt: u32,
    pub(super) result: Result<Box<dyn OpenedSession>, Box<OpenFailure>>,
}

/// An opened session, which runs on its thread, with the ring buffer for its trace.
pub struct OpenedConnection<D: Kind> {
    pub(super) worker: Worker<D>,
    /// Handle that stays with the window while the session runs on its thread.
    pub(crate) session_handle: D::SessionHandle,
    pub(super) url: crate::link::LinkUrl,
    pub(super) trace: crate::worker::Ring<crate::link::TraceEntry>,
    pub(super) is_virtual: bool,
    pub began: jiff::Zoned,
    /// Sender that is dropped to let the next attempt use the connection.
    pub(super) turn: crossbeam_channel::Sender<()>,
}

/// An opened session on its thread, for any kind of device.
pub trait OpenedSession: Any + Send {
    /// Closes a session that is no longer needed.
    fn close_unused(self: Box<Self>, session: SessionId, services: &mut Services);

    fn into_any(self: Box<Self>) -> Box<dyn Any>;
}

impl<D: Kind> OpenedSession for OpenedConnection<D> {
    fn close_unused(self: Box<Self>, session: SessionId, services: &mut Services) {
        let OpenedConnection { worker, url, turn, .. } = *self;
        let about = services.world.kinds.display_link(&url);
        services.release_worker(worker, ClosingSessionInfo { session, about, url, write: None }, Some(turn));
    }

    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

/// The waits before the window closes, in order. Each one includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShutdownWait {
    Drives,
    Disk,
    /// Wait for jobs that write nothing.
    Jobs,
    Writes,
}

#[derive(Debug)]
pub enum OpenFailure {
    Link(OpenError),
    Thread(String),
    Held,
}

/// A function that handles the result of a task that belongs to no session.
pub(crate) type SharedResultHandler = Box<dyn FnOnce(&mut Services, &mut [Box<AnyDevice>]) + Send>;

/// A backup read for a restore, or the error.
pub struct BackupReadResult {
    pub of: DeviceKey,
    pub path: PathBuf,
    /// Logbook entry to be undone by restoring the backup, if any.
    pub undone: Option<Box<Entry>>,
    pub result: Result<Box<ProfileDocument>, ReadError>,
}

#[derive(Debug)]
pub enum ReadError {
    File(FileError),
    Profile(ProfileError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderOwner {
    Device(SessionId),
    Tool(Tab),
}
