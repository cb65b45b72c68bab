//! Actions of the studio, triggered by the user, a view or a finished task.

use std::any::Any;
use std::path::PathBuf;

use super::devices::{AnyDevice, DeviceCommand, OpenProfile};
use super::diverged::{ConflictResolution, ProfileConflict};
use super::file_question::FileQuestion;
use super::payload::Payload;
use super::recorder::{self, ExportResult};
use super::review::Permit;
use super::services::Services;
use super::session::{DeviceHistory, DraftOutcome, Kind, ProfileFile, SaveRequest};
use super::settings_store::{LoadedSettings, SavedSettings};
use super::shutdown::ClosingSessionInfo;
use super::studio::SessionId;
use super::tab::Tab;
use super::{ColorScheme, Language, Picture, Settings, Text, connect};
use crate::link::LinkError;
use crate::profile::{PlanId, ProfileDocument, ProfileError};
use crate::store::{DeviceKey, FileError};
use crate::worker::{OpenError, Worker};

pub enum Action {
    ShowTab(Tab),
    SetTheme(ColorScheme),
    SetLanguage(Language),
    KeepLayout(String),
    /// Open the lower panel, or collapse it to one line.
    OpenLowerPanel(bool),
    /// Show live values with or without their plot.
    ShowValuesAlone(bool),
    /// Store the new size of the window, in points.
    KeepSize(u32, u32),
    Select(SessionId),
    /// End a session, after asking for confirmation if it has edits.
    CloseSession(SessionId),
    Stop,
    StopMotion,
    /// Release all held buttons, because the window has lost the keyboard or is covered by a dialog.
    LetGo,
    /// Stop the running job or, if there is none, close the dialog, in response to the Escape key.
    Escape,
    /// Close the window, after asking for confirmation if data would be lost.
    Close,
    /// Close the window without questions, because the system is ending the program.
    Quit,
    Confirm,
    Dismiss,
    Connect(connect::ConnectAction),
    OpenVirtual,
    Save(SessionId),
    /// Resolve the conflict in a profile that another program has changed in the meantime.
    Resolve(ConflictResolution),
    /// Ask for a file to open: a capture in the Signals tab, a profile elsewhere.
    AskOpen,
    /// Open a file as a capture if it is a `.csv` file, or as a profile otherwise.
    Open(PathBuf),
    FileNotChosen,
    /// Ask for a path as text, because the system has no file dialog.
    TypePath(FileQuestion),
    /// Use the path that the user typed. An existing file is not replaced without a question, which the system's
    /// dialogs ask themselves.
    Typed(FileQuestion, PathBuf),
    /// Use the file chosen in the system's dialog, which may be replaced if it exists.
    Chosen(FileQuestion, PathBuf),
    CloseComparison,
    Recorder(RecorderOwner, recorder::RecorderAction),
    /// Clear a recording, after asking for confirmation if it is long.
    AskForget(RecorderOwner),
    /// Ask for the file name of a table, which contains either the visible part of a recording or all of it.
    AskTable {
        owner: RecorderOwner,
        /// Only the visible part.
        visible: bool,
    },
    AskPicture(Picture),
    /// Ask for the file name of the trace of a session.
    AskTrace(SessionId),
    /// Report that a picture was requested of a plot that is not completely visible.
    PictureCut,
    Review(SessionId, ReviewAction),
    /// Execute a command that every kind of device supports, for the given session even if another one is shown by
    /// then.
    Command(SessionId, DeviceCommand),
    /// Execute an action specific to one kind of device; see [`Action::device`].
    Device(SessionId, Payload),
    /// Create an unsaved profile for the kind of device shown in a tab.
    New(Tab),
    /// Execute an action of a tab that does not require a device; see [`Action::tool`].
    Tool(Tab, Payload),
    Done(Done),
    /// The system could not start a thread for a task.
    NoThread(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReviewAction {
    /// Execute the plan with this id, which the user has reviewed.
    Write(PlanId),
    /// Grant or withdraw a permit, which results in a different plan.
    Toggle(Permit),
    /// Write even though the device has reached its limit of write cycles.
    ForceWear(bool),
    Close,
}

pub enum Done {
    /// The target path of a save operation was checked for an existing file.
    Looked {
        question: FileQuestion,
        path: PathBuf,
        exists: bool,
    },
    /// The attempt to open a link for a session has succeeded or failed.
    Opened(Attempt),
    /// The result of a search started from the connection form of a tab; see [`Done::finder`].
    Finder(Tab, Payload),
    /// The result of a task that belongs to no particular session, with its handler.
    Shared(SharedResult),
    Ports(Result<Vec<connect::PortEntry>, LinkError>),
    Read {
        file: ProfileFile,
        result: Result<Box<ProfileDocument>, ReadError>,
        /// Function that opens the profile with the tables required by its kind, or `None` for a kind that the window
        /// does not support.
        open: Option<OpenProfile>,
    },
    /// Reading a profile for comparison with a session has succeeded or failed.
    Compare {
        session: SessionId,
        path: PathBuf,
        result: Result<Box<ProfileDocument>, ReadError>,
    },
    Written {
        saving: Box<SaveRequest>,
        file: ProfileFile,
        result: Result<(), FileError>,
    },
    /// A profile was not saved, because its file has changed since it was opened.
    Diverged(Box<ProfileConflict>),
    /// A profile was not saved, because these comments of the user would be lost.
    WouldLose(Box<SaveRequest>, Vec<String>),
    TableWritten(RecorderOwner, ExportResult),
    /// A picture, a report or a trace has been saved, or could not be saved. `message` names what was saved.
    FileSaved {
        message: Text,
        path: PathBuf,
        result: Result<(), FileError>,
    },
    /// The time limit for a wait before closing has expired.
    Waited(ShutdownWait),
    Left,
    /// The settings have been read, but too late for the start of the program.
    SettingsRead(LoadedSettings),
    SettingsKept(Result<SavedSettings, FileError>),
    /// The settings have been read while drives are under control. `None` means that there are no settings.
    SettingsSeen(Result<Option<Box<Settings>>, FileError>),
    Draft(SessionId, DraftOutcome),
    Listed(SessionId, DeviceKey, Box<DeviceHistory>),
    /// Reading a backup has succeeded or failed.
    Backup {
        session: SessionId,
        of: DeviceKey,
        path: PathBuf,
        result: Result<Box<ProfileDocument>, ReadError>,
    },
    /// The result of a task specific to one kind of device, for one session; see `Done::device`.
    Device(SessionId, Payload),
    /// The result of a task of a tab that does not require a device; see [`Done::tool`].
    Tool(Tab, Payload),
}

pub struct Attempt {
    pub session: SessionId,
    /// Number of the attempt within its session. Only the latest attempt counts.
    pub attempt: u32,
    pub(super) result: Result<Box<dyn OpenedSession>, Box<OpenFailure>>,
}

/// A session running on its own thread, with the ring buffer for its trace.
pub struct Opened<D: Kind> {
    pub(super) worker: Worker<D>,
    /// The part of the session outside its thread.
    pub(crate) aside: D::SessionHandle,
    pub(super) url: crate::link::LinkUrl,
    pub(super) trace: crate::worker::Ring<crate::link::TraceEntry>,
    pub(super) is_virtual: bool,
    pub began: jiff::Zoned,
    /// Sender that lets the next attempt use the connection when it is dropped.
    pub(super) turn: crossbeam_channel::Sender<()>,
}

/// An opened session on its own thread, with its kind of device erased.
pub trait OpenedSession: Any + Send {
    /// Closes a session that is no longer required.
    fn close_unneeded(self: Box<Self>, session: SessionId, services: &mut Services);

    fn into_any(self: Box<Self>) -> Box<dyn Any>;
}

impl<D: Kind> OpenedSession for Opened<D> {
    fn close_unneeded(self: Box<Self>, session: SessionId, services: &mut Services) {
        let Opened { worker, url, turn, .. } = *self;
        let about = services.world.kinds.display_link(&url);
        services.leave(worker, ClosingSessionInfo { session, about, url, write: None }, Some(turn));
    }

    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

/// The waits before the window closes, in order. Each wait includes the preceding ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShutdownWait {
    Drives,
    Disk,
    /// Jobs that write nothing.
    Jobs,
    Writes,
}

#[derive(Debug)]
pub enum OpenFailure {
    Link(OpenError),
    Thread(String),
    Held,
}

/// Handles a result that belongs to no single session.
pub(crate) type SharedResult = Box<dyn FnOnce(&mut Services, &mut [Box<AnyDevice>]) + Send>;

#[derive(Debug)]
pub enum ReadError {
    File(FileError),
    Profile(ProfileError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderOwner {
    Device(SessionId),
    /// A tab that does not require a device.
    Tool(Tab),
}
