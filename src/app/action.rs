//! Actions of the studio, triggered by the user, a view or a finished task.

use std::any::Any;
use std::path::PathBuf;

use super::devices::{AnyDevice, DeviceCommand, OpenProfile};
use super::diverged::{Diverged, Resolve};
use super::file_question::FileQuestion;
use super::payload::Payload;
use super::recorder::{self, Exported};
use super::review::Permit;
use super::services::Services;
use super::session::{DeviceHistory, DraftDone, Kind, ProfileFile, Saving};
use super::settings_store::{SettingsRead, SettingsWritten};
use super::shutdown::ClosingSessionInfo;
use super::studio::SessionId;
use super::tab::Tab;
use super::{ColorScheme, Language, Picture, Settings, connect};
use crate::link::LinkError;
use crate::profile::{Document, PlanId, ProfileError};
use crate::store::{DeviceKey, FileError};
use crate::worker::{OpenError, Worker};

pub enum Action {
    ShowTab(Tab),
    SetTheme(ColorScheme),
    SetLanguage(Language),
    KeepLayout(String),
    /// Open the lower panel, or close it to one line.
    OpenLowerPanel(bool),
    /// Show live values without their plot, or with it.
    ShowValuesAlone(bool),
    /// The window has another size, in points.
    KeepSize(u32, u32),
    Select(SessionId),
    /// End a session; asks first if it has edits.
    CloseSession(SessionId),
    Stop,
    /// Stop all drives of all sessions, and nothing else.
    StopMotion,
    /// The window has lost the keyboard, or something covers it: release held buttons.
    LetGo,
    /// Escape: stops the running job, or else closes the dialog.
    Escape,
    /// Close the window; asks first if something would be lost.
    Close,
    /// The system ends the program: close the window without questions.
    Quit,
    Confirm,
    Dismiss,
    Connect(connect::ConnectAction),
    OpenVirtual,
    /// Save a profile: to the open file, else to one that is asked for.
    Save(SessionId),
    /// Resolves a profile that another program has changed meanwhile.
    Resolve(Resolve),
    /// Ask for a file to open: a capture in the Signals tab, else a profile.
    AskOpen,
    /// Open a capture (`.csv`), or else a profile.
    Open(PathBuf),
    FileNotChosen,
    /// The system has no file dialog: the path must be typed.
    TypePath(FileQuestion),
    /// A path was typed. An existing file is not replaced without a question, which the system's dialogs ask themselves.
    Typed(FileQuestion, PathBuf),
    /// A file was chosen, which may be replaced if it exists.
    Chosen(FileQuestion, PathBuf),
    CloseComparison,
    Recorder(RecorderOwner, recorder::RecorderAction),
    /// Clear a recording; asks first if it is long.
    AskForget(RecorderOwner),
    /// Ask where to write a table of a recording: of the visible part, or of everything.
    AskTable {
        owner: RecorderOwner,
        /// Only the visible part.
        visible: bool,
    },
    AskPicture(Picture),
    /// A picture was requested of something that is not visible as a whole.
    PictureCut,
    Review(SessionId, ReviewAction),
    /// Something that every kind of device can be asked for, about one session, whichever is shown by then.
    Command(SessionId, DeviceCommand),
    /// An action of one kind of device; see [`Action::device`].
    Device(SessionId, Payload),
    /// A profile that is in no file yet, of the kind of device of this tab.
    New(Tab),
    /// An action of a tab that needs no device; see [`Action::tool`].
    Tool(Tab, Payload),
    Done(Done),
    /// The system has no thread left for a task.
    NoThread(String),
}

/// An action on the review of a write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReviewAction {
    /// Write the plan that was shown, and no other.
    Write(PlanId),
    /// Give or withdraw a permission, which makes another plan.
    Toggle(Permit),
    /// Write although the device counts as worn.
    ForceWear(bool),
    Close,
}

pub enum Done {
    /// The target of a save was checked for an existing file.
    Looked {
        question: FileQuestion,
        path: PathBuf,
        exists: bool,
    },
    /// A link was opened for a session, or not.
    Opened(Attempt),
    /// A task of a search, from the connection form for this tab's kind of device; see [`Done::finder`].
    Finder(Tab, Payload),
    /// A task whose result belongs to no particular session, and the handler of the result.
    Shared(SharedResult),
    Ports(Result<Vec<connect::Offer>, LinkError>),
    Read {
        file: ProfileFile,
        result: Result<Box<Document>, ReadError>,
        /// Opens the profile, with the tables that its kind needs; `None` for a kind that the window does not support.
        open: Option<OpenProfile>,
    },
    /// A profile was read to be compared with a session, or not.
    Compare {
        session: SessionId,
        path: PathBuf,
        result: Result<Box<Document>, ReadError>,
    },
    Written {
        saving: Box<Saving>,
        file: ProfileFile,
        result: Result<(), FileError>,
    },
    /// The file of a profile differs from what was opened, and was not written.
    Diverged(Box<Diverged>),
    /// A user's comments would be lost, and the file was not written: which.
    WouldLose(Box<Saving>, Vec<String>),
    TableWritten(RecorderOwner, Exported),
    PictureSaved(PathBuf, Result<(), FileError>),
    ReportSaved(PathBuf, Result<(), FileError>),
    /// A wait before closing has run out of time.
    Waited(Waited),
    Left,
    /// The settings were read, later than the start could wait for them.
    SettingsRead(SettingsRead),
    SettingsKept(Result<SettingsWritten, FileError>),
    /// The settings were read while drives are under control; `None` if there are none to read.
    SettingsSeen(Result<Option<Box<Settings>>, FileError>),
    Draft(SessionId, DraftDone),
    Listed(SessionId, DeviceKey, Box<DeviceHistory>),
    /// A backup was read, or not.
    Backup {
        session: SessionId,
        of: DeviceKey,
        path: PathBuf,
        result: Result<Box<Document>, ReadError>,
    },
    /// A task of one kind of device, for one session; see `Done::device`.
    Device(SessionId, Payload),
    /// A task of a tab that needs no device; see [`Done::tool`].
    Tool(Tab, Payload),
}

/// The result of opening a link for a session.
pub struct Attempt {
    pub session: SessionId,
    /// Number of the attempt within its session: only the latest counts.
    pub attempt: u32,
    /// The session on its thread, or the error.
    pub(super) result: Result<Box<dyn AnyOpened>, Box<OpenFailed>>,
}

/// Session on its thread, with the ring for its trace.
pub struct Opened<D: Kind> {
    pub(super) worker: Worker<D>,
    /// The part of the session outside its thread.
    pub(crate) aside: D::SessionHandle,
    pub(super) url: crate::link::LinkUrl,
    pub(super) trace: crate::worker::Ring<crate::link::TraceEntry>,
    pub(super) is_virtual: bool,
    pub began: jiff::Zoned,
    /// Dropping it lets the next attempt use the wire.
    pub(super) turn: crossbeam_channel::Sender<()>,
}

/// Session on its thread, with its kind of device erased.
pub trait AnyOpened: Any + Send {
    /// Closes the session that is no longer needed.
    fn turn_away(self: Box<Self>, session: SessionId, services: &mut Services);

    fn into_any(self: Box<Self>) -> Box<dyn Any>;
}

impl<D: Kind> AnyOpened for Opened<D> {
    fn turn_away(self: Box<Self>, session: SessionId, services: &mut Services) {
        let Opened { worker, url, turn, .. } = *self;
        let about = services.world.kinds.shown_link(&url);
        services.leave(worker, ClosingSessionInfo { session, about, url, write: None }, Some(turn));
    }

    fn into_any(self: Box<Self>) -> Box<dyn Any> {
        self
    }
}

/// The waits before the window closes, in order; a later one includes the earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Waited {
    Drives,
    Disk,
    /// Jobs that write nothing.
    Jobs,
    Writes,
}

/// Why there is no session.
#[derive(Debug)]
pub enum OpenFailed {
    Link(OpenError),
    Thread(String),
    /// The wire is still held by another user.
    Held,
}

/// Handles a result that belongs to no single session.
pub(crate) type SharedResult = Box<dyn FnOnce(&mut Services, &mut [Box<AnyDevice>]) + Send>;

/// Why a profile cannot be read.
#[derive(Debug)]
pub enum ReadError {
    File(FileError),
    Profile(ProfileError),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecorderOwner {
    Device(SessionId),
    /// A tab that needs no device.
    Tool(Tab),
}
