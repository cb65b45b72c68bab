//! Closing of a session or the window. The user is asked once if data would be lost or a job interrupted. Everything
//! else is waited for.

use super::action::{Action, ShutdownWait, TaskResult};
use super::brakes::DriveStopHandles;
use super::question::{FollowUpAction, Question};
use super::services::JobState;
use super::session::Source;
use super::studio::{SessionId, Studio};
use super::{AnyDevice, Text, recorder};

/// Minimum duration of a recording, in nanoseconds, for asking the user before it is discarded.
pub(super) const LONG_RECORDING_NS: i64 = 120_000_000_000;

impl Studio {
    /// Returns the stop handles for the drives of all sessions, for use when the program ends.
    pub fn drive_stop_handles(&self) -> DriveStopHandles {
        self.services.brakes.clone()
    }

    /// Returns whether the window is closing. A closing window asks no more questions.
    pub fn is_closing(&self) -> bool {
        self.closing
    }

    /// Returns whether the window may close now. This is the case if no drive is under control, nothing is running and
    /// all data are on disk, or if the grace period has expired. Released sessions that are still ending count as
    /// running.
    pub fn can_close(&self) -> bool {
        let services = &self.services;
        let drafts = services.drafts_on_their_way == 0 && self.devices.iter().all(|device| device.is_draft_kept());
        let writes = services.has_closing_write() || self.devices.iter().any(|device| device.is_writing());
        let runs = !services.closing_sessions.is_empty() || self.devices.iter().any(|device| device.is_busy());
        let over = |what, done: bool| done || self.waited.is_some_and(|waited| waited >= what);
        self.closing
            && over(ShutdownWait::Drives, services.brakes.is_done())
            && over(ShutdownWait::Writes, !writes)
            && over(ShutdownWait::Jobs, !runs)
            && over(ShutdownWait::Disk, drafts && self.settings_store.is_idle())
    }

    pub(super) fn close_session(&mut self, id: SessionId) {
        let Some(device) = self.device_mut(id) else { return };
        if let Some(motion) = device.motion_mut() {
            motion.stop();
        }
        if device.is_busy() || device.is_dirty() || device.has_long_unsaved_recording() {
            let text = match (device.source(), device.is_dirty() && !device.preserves_edits()) {
                (_, true) => "question.session_lost",
                _ if device.is_busy() => "question.session_busy",
                _ if !device.is_dirty() => "question.session_recording",
                (Source::Link(_), false) => "question.session_edits",
                (Source::File { .. } | Source::New { .. }, false) => "question.profile_edits",
            };
            let text = Text::new(text).with("name", device.name());
            let confirm = Text::new("question.close_session");
            self.question = Some(Question::new(text, confirm, FollowUpAction::CloseSession(id)));
        } else {
            self.remove(id);
        }
    }

    fn remove(&mut self, id: SessionId) {
        self.with_device(id, |device, services| {
            device.release_draft(services);
            device.release_thread(JobState::Cancelled, services);
        });
        self.diverged.take_if(|diverged| diverged.session() == id);
        self.devices.retain(|device| device.id() != id);
        self.shown.remove(self.services.world.kinds, &self.devices, id);
    }

    pub(super) fn close(&mut self) {
        self.stop_motion();
        let busy = self.devices.iter().any(|device| device.is_busy());
        let edits = self.devices.iter().any(|device| device.is_dirty());
        let recorded = self.devices.iter().any(|device| device.has_long_unsaved_recording());
        if busy || edits || recorded {
            let lost = |device: &&AnyDevice| device.is_dirty() && !device.preserves_edits();
            let text = match self.devices.iter().map(Box::as_ref).find(lost) {
                Some(device) => Text::new("question.session_lost").with("name", device.name()),
                None if busy => Text::new("question.busy"),
                None => Text::new(if edits { "question.edits" } else { "question.recording" }),
            };
            let confirm = Text::new("question.close_window");
            self.question = Some(Question::new(text, confirm, FollowUpAction::CloseWindow));
        } else {
            self.begin_closing();
        }
    }

    /// Handles a request from the system to end the program. The user is not asked, and edits are kept as drafts.
    pub(super) fn force_quit(&mut self) {
        self.question = None;
        self.stop();
        self.begin_closing();
    }

    fn begin_closing(&mut self) {
        if std::mem::replace(&mut self.closing, true) {
            return;
        }
        self.services.brakes.begin_stop();
        self.services.brakes.set_closing();
        self.stop_tools();
        let patience = self.services.world.patience;
        let limits = [
            (ShutdownWait::Drives, patience.drives),
            (ShutdownWait::Disk, patience.disk),
            (ShutdownWait::Jobs, patience.job),
            (ShutdownWait::Writes, patience.write),
        ];
        for (what, limit) in limits {
            self.services.tasks.run("close", move || {
                std::thread::sleep(limit);
                Action::Done(TaskResult::Waited(what))
            });
        }
    }

    /// Dismisses the open question. Returns whether a question was open.
    pub(super) fn dismiss_question(&mut self) -> bool {
        let Some(question) = self.question.take() else { return false };
        match question.then {
            FollowUpAction::OpenLink(id) => {
                let why = Text::new("session.maybe_drive");
                self.with_device(id, |device, services| device.connection_lost(why, services));
            }
            FollowUpAction::Find(_) => {
                if let Some(connect) = &mut self.connect {
                    connect.problem = Some(Text::new("session.maybe_drive"));
                }
            }
            FollowUpAction::CloseWindow
            | FollowUpAction::CloseSession(_)
            | FollowUpAction::Write(..)
            | FollowUpAction::Forget(_)
            | FollowUpAction::Save(_) => {}
        }
        true
    }

    pub(super) fn confirm_question(&mut self) {
        match self.question.take().map(|question| question.then) {
            Some(FollowUpAction::CloseWindow) => {
                self.stop();
                self.begin_closing();
            }
            Some(FollowUpAction::CloseSession(id)) => self.remove(id),
            Some(FollowUpAction::Write(question, path)) => self.handle_chosen_path(question, path),
            Some(FollowUpAction::Save(saving)) => {
                let (kinds, store) = (self.services.world.kinds, self.services.world.store.clone());
                self.services.tasks.run("save", move || saving.run(kinds, &store));
            }
            Some(FollowUpAction::OpenLink(id)) => self.open_confirmed(id),
            Some(FollowUpAction::Find(tab)) => self.start_confirmed_search(tab),
            Some(FollowUpAction::Forget(owner)) => self.apply_recorder_action(owner, recorder::RecorderAction::Clear),
            None => {}
        }
    }
}
