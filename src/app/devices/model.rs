//! The interface that each kind of device implements for the studio. Everything else is shared by all kinds.

#![warn(missing_docs)]

use std::any::Any;
use std::path::{Path, PathBuf};

use super::memory::DeviceMemory;
use crate::app::action::OpenedConnection;
use crate::app::documents::read_only_reason;
use crate::app::recorder::Recorder;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{Services, StudioEnvironment};
use crate::app::session::{HasDraft, HasSession, Kind, SessionEvents};
use crate::app::studio::SessionId;
use crate::app::{
    AnyDevice, DeviceAction, DeviceCommand, EditStep, Recording, Severity, SineCosineSource, StoredDriveData, Tab, Text,
};
use crate::link::LinkUrl;
use crate::profile::{Body, ProfileError};
use crate::worker;

type Job<T> = <<T as HasSession>::Device as worker::Device>::Job;

/// The state of a device or profile, with all data known about it.
pub trait DeviceModel: SessionEvents + HasDraft + 'static {
    /// Tab in which the device is shown.
    const TAB: Tab;

    /// Actions specific to this kind of device.
    type Action: DeviceAction;

    /// Results of the tasks that a device starts.
    type TaskResult: Any + Send;

    /// Returns a function that prepares the session before it is moved to its thread.
    fn prepare_session(&self, _world: &StudioEnvironment) -> PrepareFn<Self::Device> {
        Box::new(|_| ())
    }

    /// Adopts the session after its link has been opened.
    fn connect(&mut self, opened: OpenedConnection<Self::Device>, services: &mut Services);

    /// Executes an action specific to this kind of device.
    fn handle_action(&mut self, action: Self::Action, context: &mut ActionContext<'_>);

    /// Handles the result of a task that this device has started.
    fn handle_result(&mut self, done: Self::TaskResult, services: &mut Services);

    /// Returns the job that reads the position once.
    fn position_job(&self) -> Job<Self>;

    /// Returns the recording of the device.
    fn recording(&self) -> &dyn Recording;

    /// Returns the recording of the device, mutably.
    fn record_mut(&mut self) -> &mut dyn Recording;

    /// Returns all recorders of the device, starting with the displayed one.
    fn recorders(&self) -> Vec<&Recorder> {
        vec![self.recording().recorder()]
    }

    /// Returns all recorders of the device, mutably.
    fn recorders_mut(&mut self) -> Vec<&mut Recorder> {
        vec![self.record_mut().recorder_mut()]
    }

    /// Executes a command that every device supports.
    fn command(&mut self, command: DeviceCommand, services: &mut Services) {
        match command {
            // The studio executes these commands, because it opens links, asks for files and knows the other sessions.
            DeviceCommand::Reconnect
            | DeviceCommand::WriteInto(_)
            | DeviceCommand::AskRestore
            | DeviceCommand::AskCompare
            | DeviceCommand::AskReport
            | DeviceCommand::Compare(_) => {}
            DeviceCommand::Read => {
                if !self.session().reload_file(services) {
                    self.read_device(services);
                }
            }
            DeviceCommand::ReadPosition => self.submit(self.position_job(), services),
            DeviceCommand::Poll(interval) => {
                if let Some(begins) = self.session_mut().poll(interval) {
                    self.record_mut().poll(interval, begins);
                }
            }
            DeviceCommand::Undo => self.apply_edit_step(|edits| edits.undo()),
            DeviceCommand::Redo => self.apply_edit_step(|edits| edits.redo()),
            DeviceCommand::RevertAll => self.apply_edit_step(|edits| edits.discard_all()),
            DeviceCommand::Review => {
                self.with_memory(services, |memory, services| memory.review_edits(services));
            }
            DeviceCommand::AskSave => self.ask_where_to_save(services),
            DeviceCommand::Assign(asset) => {
                self.with_memory(services, |memory, services| memory.assign_asset(asset, services));
            }
            DeviceCommand::Restore(path) => {
                self.with_memory(services, |memory, services| memory.read_backup(path, None, services));
            }
            DeviceCommand::UndoWrite(entry) => {
                self.with_memory(services, |memory, services| {
                    if let Ok(path) = entry.undo_backup().map(Path::to_owned) {
                        memory.read_backup(path, Some(entry), services);
                    }
                });
            }
        }
    }

    /// Reads all values that the device's pages display.
    fn read_device(&mut self, services: &mut Services) {
        self.submit(Self::Device::survey_job(), services);
    }

    /// Undoes or redoes an edit.
    fn apply_edit_step(&mut self, step: EditStep) {
        step(self.pending_mut());
    }

    /// Asks the user where to save a profile.
    fn ask_where_to_save(&mut self, services: &mut Services) {
        self.session().ask_where_to_save(services);
    }

    /// Returns whether the device can stream thousands of positions per second.
    fn can_stream(&self) -> bool {
        false
    }

    /// Returns whether a job is running or values are being polled.
    fn is_active(&self) -> bool {
        self.session().is_active()
    }

    /// Stops the running job.
    fn stop(&mut self, services: &mut Services) {
        self.session_mut().stop(services);
    }

    /// Switches to another link on the same wire.
    fn switch_link(&mut self, _url: &LinkUrl) {}

    /// Returns the memory of the device, or `None` for a kind that is never written to.
    fn memory(&self) -> Option<&dyn DeviceMemory>;

    /// Returns the memory of the device, mutably.
    ///
    /// # Errors
    /// Returns the reason why nothing can be written to this kind of device.
    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text>;

    /// Calls `act` with the memory of the device, or reports that the device has no writable memory.
    fn with_memory<R>(
        &mut self,
        services: &mut Services,
        act: impl FnOnce(&mut dyn DeviceMemory, &mut Services) -> R,
    ) -> Option<R> {
        match self.memory_mut() {
            Ok(memory) => Some(act(memory, services)),
            Err(why) => {
                services.notify(Severity::Note, vec![why], Some(&self.session().name()));
                None
            }
        }
    }

    /// Returns the edited profile for writing to another device, if any.
    fn edited_body(&self) -> Option<Body> {
        self.memory()?.edited_body()
    }

    /// Returns the profile to compare, or `None` if no data has been read. This is the edited profile, or else the one
    /// read last.
    ///
    /// # Errors
    /// Returns a message for each value that a profile requires but that has not been read.
    fn comparable_body(&self) -> Option<Result<Body, Vec<Text>>> {
        self.edited_body().map(Ok).or_else(|| self.memory()?.last_read_profile())
    }

    /// Returns the profile or the device's values with all edits, or `None` if no data has been read.
    ///
    /// # Errors
    /// Returns a message for each value that a profile requires but that has not been read.
    fn edited_values(&self) -> Option<Result<Body, Vec<Text>>> {
        self.edited_body().map(Ok).or_else(|| self.memory()?.edited_values())
    }

    /// Returns whether an item can be edited to take its value from another profile.
    fn accepts_item(&self, _item: &str) -> bool {
        false
    }

    /// Edits an item to take its value from another profile, as one undo step.
    ///
    /// # Errors
    /// Returns the reason why the value cannot be adopted.
    fn take_item(&mut self, _item: &str, _from: &Body) -> Result<(), Text> {
        Err(Text::new("comparison.not_taken"))
    }

    /// Returns the errors and warnings read last, for a report. Returns `None` if none have been read.
    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        None
    }

    /// Returns the results of this session for a report. Profiles do not contain them.
    fn session_results(&self) -> Vec<SessionResult> {
        Vec::new()
    }

    /// Adopts the values of a profile. Depending on the kind of device, this opens the review of a write or edits the
    /// layout.
    ///
    /// # Errors
    /// Returns an error if the profile belongs to another kind of device.
    fn apply_profile(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError> {
        self.with_memory(services, |memory, services| memory.restore(body, services)).unwrap_or(Ok(()))
    }

    /// Saves a profile.
    fn save(&mut self, path: PathBuf, services: &mut Services) {
        self.with_memory(services, |memory, services| memory.save(path, services));
    }

    /// Returns whether a profile can currently be saved.
    fn is_savable(&self) -> bool {
        self.memory().is_some_and(DeviceMemory::is_savable)
    }

    /// Returns the source of sine and cosine signals, or `None` for a kind that has no such signals.
    fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        None
    }

    /// Returns the source of sine and cosine signals, mutably.
    fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource> {
        None
    }

    /// Returns the motion control, or `None` for a kind that does not move anything.
    fn motion(&self) -> Option<&dyn MotionControl> {
        None
    }

    /// Returns the motion control, mutably.
    fn motion_mut(&mut self) -> Option<&mut dyn MotionControl> {
        None
    }

    /// Returns the interface to the stored data about drives, or `None` for a kind without drives.
    fn drive_memory(&mut self) -> Option<&mut dyn StoredDriveData> {
        None
    }
}

/// A function that prepares a session before it is moved to its thread.
pub(crate) type PrepareFn<D> = Box<dyn FnOnce(&mut worker::Session<D>) + Send>;

/// Resources that an action may use in addition to the device.
pub struct ActionContext<'a> {
    pub(crate) services: &'a mut Services,
    others: &'a [Box<AnyDevice>],
    next: Vec<DeviceCommand>,
}

impl<'a> ActionContext<'a> {
    pub(in crate::app) fn new(services: &'a mut Services, others: &'a [Box<AnyDevice>]) -> Self {
        ActionContext { services, others, next: Vec::new() }
    }

    /// Queues a command for the same device, to be executed after the present action.
    pub(crate) fn queue_command(&mut self, command: DeviceCommand) {
        self.next.push(command);
    }

    pub(in crate::app) fn into_requests(self) -> Vec<DeviceCommand> {
        self.next
    }

    /// Returns the profile as edited in another session, if any.
    ///
    /// # Errors
    /// Returns a message if the profile is read-only.
    pub(crate) fn edited_session_profile(&self, id: SessionId) -> Result<Option<Body>, Text> {
        let Some(other) = self.others.iter().find(|other| other.id() == id) else { return Ok(None) };
        read_only_reason(other.source()).map_or_else(|| Ok(other.edited_body()), Err)
    }
}

/// Control of motion requested in this window. STOP and the release of a key always use this interface, never an action
/// specific to a kind of device.
pub trait MotionControl {
    /// Stops all motion.
    fn stop(&mut self);

    /// Ends every motion that would otherwise last forever or until a button is released.
    fn release_motion(&mut self);

    /// Returns whether a drive is moving or about to move.
    fn is_moving(&self) -> bool;

    /// Returns whether a drive is moving, or about to move, because of a request from this window.
    fn is_requested_motion_running(&self) -> bool;

    /// Returns whether a motion requested in this window has not ended yet.
    fn is_motion_active(&self) -> bool;

    /// Returns whether this window controls the drives. If so, they send their values without being polled.
    fn has_control(&self) -> bool;
}
