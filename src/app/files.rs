//! Handling of files chosen by the user. The disk is accessed only in tasks.

use std::path::{Path, PathBuf};

use super::action::{Action, RecorderOwner, TaskResult};
use super::closing::LONG_RECORDING_NS;
use super::file_question::FileQuestion;
use super::question::{FollowUpAction, Question};
use super::recorder::{self, ExportResult, Recorder};
use super::studio::{SessionId, Studio};
use super::{ComparisonAction, ComparisonSource, DeviceCommand, Picture, Severity, Text, connect, explain};
use crate::link::{LinkScheme, LinkUrl};
use crate::store::{BaseFolders, FileError, write_atomically};

impl Studio {
    /// Makes the paths of an action absolute. All paths from the user pass through here.
    pub(super) fn with_absolute_path(&self, action: Action) -> Action {
        let whole = |path: PathBuf| self.services.world.folders.absolute_path(&path);
        match action {
            Action::Open(path) => Action::Open(whole(path)),
            Action::Typed(question, path) => Action::Typed(question, whole(path)),
            Action::Chosen(question, path) => Action::Chosen(question, whole(path)),
            action => action,
        }
    }

    /// Makes the path of a link absolute, if the link refers to a file.
    pub(super) fn with_absolute_file(&self, mut url: LinkUrl) -> LinkUrl {
        if url.scheme == LinkScheme::Replay {
            url.target = self.services.world.folders.absolute_path(Path::new(&url.target)).display().to_string();
        }
        url
    }

    pub fn folders(&self) -> &BaseFolders {
        &self.services.world.folders
    }

    /// Handles a typed path. The user is asked before an existing file is replaced.
    pub(super) fn handle_typed_path(&mut self, question: FileQuestion, path: PathBuf) {
        if question.suggested_path().is_none() {
            return self.handle_chosen_path(question, path);
        }
        self.services.tasks.run("look", move || {
            let exists = path.exists();
            Action::Done(TaskResult::TargetChecked { question, path, exists })
        });
    }

    pub(super) fn handle_chosen_path(&mut self, question: FileQuestion, path: PathBuf) {
        match question {
            FileQuestion::Open => self.handle_action(Action::Open(path)),
            FileQuestion::Restore(session) => {
                self.handle_action(Action::Command(session, DeviceCommand::Restore(path)))
            }
            FileQuestion::Compare(side) => {
                let source = ComparisonSource::File(path);
                self.handle_action(Action::Comparison(ComparisonAction::Choose(side, source)));
            }
            FileQuestion::OpenCapture => self.open_capture(path),
            FileQuestion::Logo => self.choose_logo(path),
            FileQuestion::Recording => self.handle_action(Action::Connect(connect::ConnectAction::Recording(path))),
            FileQuestion::Save { session, .. } => self.save(session, path),
            FileQuestion::OfDevice(file) => {
                let action = file.action_for_path(path, self.settings.language);
                self.handle_action(Action::Device(file.session(), action));
            }
            FileQuestion::Table { owner, visible, .. } => self.write_table(owner, visible, &path),
            FileQuestion::Picture { picture, .. } => self.services.tasks.run("picture", move || {
                let result = picture.save(&path);
                Action::Done(TaskResult::FileSaved { message: Text::new("picture.saved"), path, result })
            }),
            FileQuestion::Trace { session, .. } => self.save_trace(session, path),
            FileQuestion::Report { owner, .. } => self.write_report(owner, path),
        }
    }

    pub(super) fn save(&mut self, session: SessionId, path: PathBuf) {
        self.with_device(session, |device, services| device.save(path, services));
    }

    pub fn recorder_for(&self, owner: RecorderOwner) -> Option<&Recorder> {
        match owner {
            RecorderOwner::Device(id) => self.device(id).map(|device| device.recorder()),
            RecorderOwner::Tool(tab) => self.tool(tab).map(|tool| tool.recorder()),
        }
    }

    fn recorder_mut(&mut self, owner: RecorderOwner) -> Option<&mut Recorder> {
        match owner {
            RecorderOwner::Device(id) => self.device_mut(id).map(|device| device.recorder_mut()),
            RecorderOwner::Tool(tab) => {
                self.tools.iter_mut().find(|(own, _)| *own == tab).map(|(_, tool)| tool.recorder_mut())
            }
        }
    }

    pub(super) fn apply_recorder_action(&mut self, owner: RecorderOwner, action: recorder::RecorderAction) {
        if let Some(recorder) = self.recorder_mut(owner) {
            recorder.handle_action(action);
        }
    }

    pub(super) fn confirm_discard_recording(&mut self, owner: RecorderOwner) {
        if self.recorder_for(owner).is_some_and(|recorder| recorder.unexported_duration() >= LONG_RECORDING_NS) {
            let (text, confirm) = (Text::new("question.forget"), Text::new("question.forget_it"));
            self.question = Some(Question::new(text, confirm, FollowUpAction::Forget(owner)));
        } else {
            self.apply_recorder_action(owner, recorder::RecorderAction::Clear);
        }
    }

    pub(super) fn ask_table_path(&mut self, owner: RecorderOwner, visible: bool) {
        let suggested = self.suggested_path(Some(owner), "csv");
        self.services.file_question = Some(FileQuestion::Table { owner, visible, suggested });
    }

    /// Reports that no picture was taken, because the plot is not completely visible.
    pub(super) fn notify_picture_truncated(&mut self) {
        self.services.notify(Severity::Warning, vec![Text::new("recorder.picture_cut")], None);
    }

    pub(super) fn ask_picture_path(&mut self, picture: Picture) {
        let suggested = self.suggested_path(None, "png");
        self.services.file_question = Some(FileQuestion::Picture { picture, suggested });
    }

    pub(super) fn ask_trace_path(&mut self, session: SessionId) {
        let suggested = self.suggested_path(Some(RecorderOwner::Device(session)), "trace");
        self.services.file_question = Some(FileQuestion::Trace { session, suggested });
    }

    /// Saves all frames of the session's log, in the format of the command line.
    fn save_trace(&mut self, session: SessionId, path: PathBuf) {
        let Some(content) = self.device(session).map(|device| device.trace().file_content()) else { return };
        self.services.tasks.run("trace", move || {
            let result = write_atomically(&path, content.as_bytes());
            Action::Done(TaskResult::FileSaved { message: Text::new("trace.saved"), path, result })
        });
    }

    /// Suggests a file name that contains the encoder and the time of day, so that each recording gets a different
    /// name.
    pub(super) fn suggested_path(&self, owner: Option<RecorderOwner>, ending: &str) -> PathBuf {
        let device = match owner {
            Some(RecorderOwner::Device(id)) => self.device(id),
            Some(RecorderOwner::Tool(_)) => None,
            None => self.selected_device(),
        };
        let stem = device.and_then(|device| device.suggested_file().file_stem().map(ToOwned::to_owned));
        let stem = stem.map_or_else(|| "recording".to_owned(), |stem| stem.to_string_lossy().into_owned());
        PathBuf::from(format!("{stem}-{}.{ending}", self.services.current_time().strftime("%Y%m%d-%H%M%S")))
    }

    fn write_table(&mut self, owner: RecorderOwner, visible: bool, path: &Path) {
        let mailbox = self.services.tasks.mailbox();
        let Some(recorder) = self.recorder_mut(owner) else { return };
        let busy = recorder.export().is_some();
        match recorder.begin_export(path, visible) {
            Some(writing) => self.services.tasks.run("table", move || {
                Action::Done(TaskResult::TableWritten(owner, writing.run(&|| mailbox.wake_window())))
            }),
            None => {
                let text = Text::new(if busy { "recorder.still_writing" } else { "recorder.nothing_to_write" });
                self.services.notify(Severity::Warning, vec![text], None);
            }
        }
    }

    pub(super) fn finish_table_export(&mut self, owner: RecorderOwner, exported: ExportResult) {
        let is_written = matches!(exported.rows, Ok(Some(_)));
        // All recorders are searched, because another drive may be selected by now.
        let recorders = match owner {
            RecorderOwner::Device(id) => self.device_mut(id).map(|device| device.recorders_mut()).unwrap_or_default(),
            RecorderOwner::Tool(_) => self.recorder_mut(owner).into_iter().collect(),
        };
        let ended = recorders.into_iter().find_map(|recorder| recorder.end_export(exported.number, is_written));
        let lost = ended.unwrap_or(0);
        let path = exported.path.display();
        let (severity, mut texts) = match &exported.rows {
            Ok(Some(rows)) => {
                (Severity::Good, vec![Text::new("recorder.written").with("rows", rows).with("path", path)])
            }
            Ok(None) => (Severity::Note, vec![Text::new("recorder.given_up").with("path", path)]),
            Err(error) => (Severity::Error, vec![explain::file_error_text(error)]),
        };
        if lost > 0 {
            texts.push(Text::new("recorder.lost").with("count", lost));
        }
        if is_written {
            self.services.log.remove_file_notices(&exported.path);
        }
        let severity = if lost > 0 { severity.max(Severity::Warning) } else { severity };
        self.services.notify(severity, texts, None);
    }

    /// Reports that a file was saved, or the reason why it was not. `message` names what was saved.
    pub(super) fn finish_file_save(&mut self, message: Text, path: &Path, result: Result<(), FileError>) {
        let (severity, text) = match result {
            Ok(()) => {
                self.services.log.remove_file_notices(path);
                (Severity::Good, message.with("path", path.display()))
            }
            Err(error) => (Severity::Error, explain::file_error_text(&error)),
        };
        self.services.notify(severity, vec![text], None);
    }

    /// Passes new samples to the running table exports.
    pub(super) fn feed_exports(&mut self) {
        for device in &mut self.devices {
            device.recorders_mut().into_iter().for_each(Recorder::pass_rows_to_export);
        }
        self.tools.iter_mut().for_each(|(_, tool)| tool.recorder_mut().pass_rows_to_export());
    }
}
