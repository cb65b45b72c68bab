//! A device of any kind, as seen by the studio, the shared parts of the window and other devices. One implementation
//! covers all kinds.

#![warn(missing_docs)]

use std::any::Any;
use std::path::PathBuf;

use crossbeam_channel::Receiver;

use super::command::DeviceCommand;
use super::memory::DeviceMemory;
use super::model::{ActionContext, DeviceModel, MotionControl};
use crate::app::action::{ConnectAttempt, OpenFailure, OpenedSession, TaskResult};
use crate::app::live_session::JobProgress;
use crate::app::recorder::Recorder;
use crate::app::report::{SessionResult, StatusLine};
use crate::app::services::{JobState, Services};
use crate::app::session::{
    DraftOutcome, HasDraft, Kind, ProfileFile, SaveRequest, SessionEvents, SessionState, Source,
};
use crate::app::{Payload, PayloadKindError, SineCosineSource, StoredDriveData, Tab, Text};
use crate::link::LinkUrl;
use crate::profile::{Body, ProfileDocument, ProfileError};
use crate::store::FileError;

/// A device or profile of any kind.
pub type AnyDevice = dyn OpenDevice;

/// The object-safe interface of a device of any kind, implemented for every `DeviceModel`.
pub trait OpenDevice: Any {
    /// Returns the state common to all sessions.
    fn state(&self) -> &SessionState;
    #[doc(hidden)]
    fn state_mut(&mut self) -> &mut SessionState;
    /// Returns the tab in which the device is shown.
    fn tab(&self) -> Tab;
    /// Returns whether the device is simulated in this process.
    fn is_virtual(&self) -> bool;
    /// Returns whether the connection is open.
    fn is_connected(&self) -> bool;
    /// Returns whether a job is running.
    fn is_busy(&self) -> bool;
    /// Returns whether the memory of the device is being changed.
    fn is_writing(&self) -> bool;
    /// Returns whether values are polled.
    fn is_polling(&self) -> bool;
    /// Returns whether a job is running or values are being polled.
    fn is_active(&self) -> bool;
    /// Returns whether the device is connected and idle, so that a job may start.
    fn is_ready(&self) -> bool;
    /// Returns whether the device can be read again. This is also true for a device that did not reply, and for a
    /// profile.
    fn is_readable(&self) -> bool;
    /// Returns whether a profile can currently be saved.
    fn is_savable(&self) -> bool;
    /// Returns whether the device can stream thousands of positions per second.
    fn can_stream(&self) -> bool;
    /// Returns the running job, if any.
    fn running_job(&self) -> Option<JobProgress>;
    /// Returns whether any edits have not been written.
    fn is_dirty(&self) -> bool;
    /// Returns the number of edits that have not been written.
    fn edit_count(&self) -> usize;
    /// Returns whether there is an edit to undo.
    fn can_undo(&self) -> bool;
    /// Returns whether there is an edit to redo.
    fn can_redo(&self) -> bool;
    /// Returns whether edits are restored when the device is closed and opened again.
    fn preserves_edits(&self) -> bool;
    /// Returns whether every edit is stored on disk. A failed write is disregarded.
    fn is_draft_kept(&self) -> bool;
    /// Returns the number of samples that were dropped before they could be recorded.
    fn dropped_count(&self) -> u64;
    /// Returns the displayed recorder.
    fn recorder(&self) -> &Recorder;
    #[doc(hidden)]
    fn recorder_mut(&mut self) -> &mut Recorder;
    /// Returns all recorders, starting with the displayed one.
    fn recorders(&self) -> Vec<&Recorder>;
    #[doc(hidden)]
    fn recorders_mut(&mut self) -> Vec<&mut Recorder>;
    /// Returns the source of sine and cosine signals, or `None` for a kind that has no such signals.
    fn sine_cosine(&self) -> Option<&dyn SineCosineSource>;
    #[doc(hidden)]
    fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource>;
    #[doc(hidden)]
    fn memory(&self) -> Option<&dyn DeviceMemory>;
    #[doc(hidden)]
    fn memory_mut(&mut self) -> Option<&mut dyn DeviceMemory>;
    #[doc(hidden)]
    fn motion(&self) -> Option<&dyn MotionControl>;
    #[doc(hidden)]
    fn motion_mut(&mut self) -> Option<&mut dyn MotionControl>;
    #[doc(hidden)]
    fn drive_memory(&mut self) -> Option<&mut dyn StoredDriveData>;
    #[doc(hidden)]
    fn open(&self, url: LinkUrl, attempt: u32, earlier: Option<Receiver<()>>, services: &mut Services) -> Receiver<()>;
    #[doc(hidden)]
    fn open_failure_text(&self, failed: &OpenFailure) -> Text;
    #[doc(hidden)]
    fn connect(&mut self, opened: Box<dyn OpenedSession>, services: &mut Services) -> Result<(), PayloadKindError>;
    #[doc(hidden)]
    fn handle_action(&mut self, action: Payload, context: &mut ActionContext<'_>) -> Result<(), PayloadKindError>;
    #[doc(hidden)]
    fn apply_command(&mut self, command: DeviceCommand, services: &mut Services);
    #[doc(hidden)]
    fn handle_result(&mut self, done: Payload, services: &mut Services) -> Result<(), PayloadKindError>;
    #[doc(hidden)]
    fn edited_body(&self) -> Option<Body>;
    #[doc(hidden)]
    fn comparable_body(&self) -> Option<Result<Body, Vec<Text>>>;
    #[doc(hidden)]
    fn edited_values(&self) -> Option<Result<Body, Vec<Text>>>;
    /// Returns whether an item can be edited so that it has the value of another profile.
    fn accepts_item(&self, item: &str) -> bool;
    #[doc(hidden)]
    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text>;
    #[doc(hidden)]
    fn reported_status(&self) -> Option<Vec<StatusLine>>;
    #[doc(hidden)]
    fn session_results(&self) -> Vec<SessionResult>;
    #[doc(hidden)]
    fn apply_profile(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError>;
    #[doc(hidden)]
    fn switch_link(&mut self, url: LinkUrl);
    #[doc(hidden)]
    fn save(&mut self, path: PathBuf, services: &mut Services);
    #[doc(hidden)]
    fn process_events(&mut self, services: &mut Services);
    #[doc(hidden)]
    fn stop(&mut self, services: &mut Services);
    #[doc(hidden)]
    fn connection_lost(&mut self, why: Text, services: &mut Services);
    #[doc(hidden)]
    fn release_thread(&mut self, end: JobState, services: &mut Services);
    #[doc(hidden)]
    fn mark_draft_due(&mut self);
    #[doc(hidden)]
    fn write_draft(&mut self, services: &mut Services);
    #[doc(hidden)]
    fn release_draft(&mut self, services: &mut Services);
    #[doc(hidden)]
    fn take_draft(&mut self, done: DraftOutcome, services: &mut Services);
    #[doc(hidden)]
    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument);
    #[doc(hidden)]
    fn revert_edits(&mut self);
    #[doc(hidden)]
    fn handle_profile_written(
        &mut self,
        saving: SaveRequest,
        file: ProfileFile,
        result: Result<(), FileError>,
        services: &mut Services,
    );
}

impl<M: DeviceModel> OpenDevice for M {
    fn state(&self) -> &SessionState {
        self.session()
    }

    fn state_mut(&mut self) -> &mut SessionState {
        self.session_mut()
    }

    fn tab(&self) -> Tab {
        M::TAB
    }

    fn is_virtual(&self) -> bool {
        self.session().is_virtual()
    }

    fn is_connected(&self) -> bool {
        self.session().live_session().is_some()
    }

    fn is_busy(&self) -> bool {
        self.session().is_busy()
    }

    fn is_writing(&self) -> bool {
        self.session().is_writing()
    }

    fn is_polling(&self) -> bool {
        self.session().is_polling()
    }

    fn is_active(&self) -> bool {
        DeviceModel::is_active(self)
    }

    fn is_ready(&self) -> bool {
        self.session().is_ready()
    }

    fn is_readable(&self) -> bool {
        self.session().is_readable()
    }

    fn is_savable(&self) -> bool {
        DeviceModel::is_savable(self)
    }

    fn can_stream(&self) -> bool {
        DeviceModel::can_stream(self)
    }

    fn running_job(&self) -> Option<JobProgress> {
        self.session().live_session().and_then(|line| line.job_progress())
    }

    fn is_dirty(&self) -> bool {
        self.pending_edits().is_dirty()
    }

    fn edit_count(&self) -> usize {
        self.pending_edits().count()
    }

    fn can_undo(&self) -> bool {
        self.pending_edits().can_undo()
    }

    fn can_redo(&self) -> bool {
        self.pending_edits().can_redo()
    }

    fn preserves_edits(&self) -> bool {
        HasDraft::preserves_edits(self)
    }

    fn is_draft_kept(&self) -> bool {
        self.session().drafting.is_kept()
    }

    fn dropped_count(&self) -> u64 {
        self.recording().dropped_count()
    }

    fn recorder(&self) -> &Recorder {
        self.recording().recorder()
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        self.record_mut().recorder_mut()
    }

    fn recorders(&self) -> Vec<&Recorder> {
        DeviceModel::recorders(self)
    }

    fn recorders_mut(&mut self) -> Vec<&mut Recorder> {
        DeviceModel::recorders_mut(self)
    }

    fn sine_cosine(&self) -> Option<&dyn SineCosineSource> {
        DeviceModel::sine_cosine(self)
    }

    fn sine_cosine_mut(&mut self) -> Option<&mut dyn SineCosineSource> {
        DeviceModel::sine_cosine_mut(self)
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        DeviceModel::memory(self)
    }

    fn memory_mut(&mut self) -> Option<&mut dyn DeviceMemory> {
        DeviceModel::memory_mut(self).ok()
    }

    fn motion(&self) -> Option<&dyn MotionControl> {
        DeviceModel::motion(self)
    }

    fn motion_mut(&mut self) -> Option<&mut dyn MotionControl> {
        DeviceModel::motion_mut(self)
    }

    fn drive_memory(&mut self) -> Option<&mut dyn StoredDriveData> {
        DeviceModel::drive_memory(self)
    }

    fn open_failure_text(&self, failed: &OpenFailure) -> Text {
        M::Device::open_failure_text(failed)
    }

    fn open(&self, url: LinkUrl, attempt: u32, earlier: Option<Receiver<()>>, services: &mut Services) -> Receiver<()> {
        let session = self.session().id;
        let prepare = DeviceModel::prepare_session(self, &services.world);
        services.open_task::<M::Device>(url, earlier, prepare, move |result| {
            let result = result.map(|opened| opened as Box<dyn OpenedSession>);
            TaskResult::OpenedConnection(ConnectAttempt { session, attempt, result })
        })
    }

    fn connect(&mut self, opened: Box<dyn OpenedSession>, services: &mut Services) -> Result<(), PayloadKindError> {
        let opened = opened.into_any().downcast().map_err(|_| PayloadKindError)?;
        DeviceModel::connect(self, *opened, services);
        Ok(())
    }

    fn handle_action(&mut self, action: Payload, context: &mut ActionContext<'_>) -> Result<(), PayloadKindError> {
        DeviceModel::handle_action(self, action.open()?, context);
        Ok(())
    }

    fn apply_command(&mut self, command: DeviceCommand, services: &mut Services) {
        DeviceModel::command(self, command, services);
    }

    fn handle_result(&mut self, done: Payload, services: &mut Services) -> Result<(), PayloadKindError> {
        DeviceModel::handle_result(self, done.open()?, services);
        Ok(())
    }

    fn edited_body(&self) -> Option<Body> {
        DeviceModel::edited_body(self)
    }

    fn comparable_body(&self) -> Option<Result<Body, Vec<Text>>> {
        DeviceModel::comparable_body(self)
    }

    fn edited_values(&self) -> Option<Result<Body, Vec<Text>>> {
        DeviceModel::edited_values(self)
    }

    fn accepts_item(&self, item: &str) -> bool {
        DeviceModel::accepts_item(self, item)
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        DeviceModel::take_item(self, item, from)
    }

    fn reported_status(&self) -> Option<Vec<StatusLine>> {
        DeviceModel::reported_status(self)
    }

    fn session_results(&self) -> Vec<SessionResult> {
        DeviceModel::session_results(self)
    }

    fn apply_profile(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError> {
        DeviceModel::apply_profile(self, body, services)
    }

    fn switch_link(&mut self, url: LinkUrl) {
        DeviceModel::switch_link(self, &url);
        self.session_mut().source = Source::Link(url);
    }

    fn save(&mut self, path: PathBuf, services: &mut Services) {
        DeviceModel::save(self, path, services);
    }

    fn process_events(&mut self, services: &mut Services) {
        SessionEvents::process_events(self, services);
    }

    fn stop(&mut self, services: &mut Services) {
        DeviceModel::stop(self, services);
    }

    fn connection_lost(&mut self, why: Text, services: &mut Services) {
        SessionEvents::connection_lost(self, why, services);
    }

    fn release_thread(&mut self, end: JobState, services: &mut Services) {
        SessionEvents::release_thread(self, end, services);
    }

    fn mark_draft_due(&mut self) {
        self.session_mut().drafting.mark_draft_due();
    }

    fn write_draft(&mut self, services: &mut Services) {
        HasDraft::write_draft(self, services);
    }

    fn release_draft(&mut self, services: &mut Services) {
        HasDraft::release_draft(self, services);
    }

    fn take_draft(&mut self, done: DraftOutcome, services: &mut Services) {
        HasDraft::take_draft(self, done, services);
    }

    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        HasDraft::apply_document(self, file, document);
    }

    fn revert_edits(&mut self) {
        HasDraft::revert_edits(self);
    }

    fn handle_profile_written(
        &mut self,
        saving: SaveRequest,
        file: ProfileFile,
        result: Result<(), FileError>,
        services: &mut Services,
    ) {
        HasDraft::handle_profile_written(self, saving, file, result, services);
    }
}
