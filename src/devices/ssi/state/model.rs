//! Implementation of the studio's device traits for SSI encoders.

use std::path::PathBuf;

use super::design::Edit;
use super::{Encoder, SearchState, SsiAction, TEXTS, TaskResult};
use crate::app::action::OpenedConnection;
use crate::app::documents::{new_document, read_only_reason};
use crate::app::report::SessionResult;
use crate::app::services::{JobState, Services, StudioEnvironment};
use crate::app::session::{HasDraft, SessionEvents, Source};
use crate::app::{
    ActionContext, DeviceMemory, DeviceModel, EditStep, FileQuestion, PrepareFn, Recording, Severity, Tab, Text,
    explain,
};
use crate::devices::ssi::jobs::{Ssi, SsiJob};
use crate::devices::ssi::profile::SsiProfile;
use crate::link::LinkUrl;
use crate::profile::{Body, ProfileDocument, ProfileError};

impl DeviceModel for Encoder {
    const TAB: Tab = Tab::named("Ssi");
    type Action = SsiAction;
    type TaskResult = TaskResult;

    fn prepare_session(&self, _world: &StudioEnvironment) -> PrepareFn<Ssi> {
        let clock_settings = self.query_settings();
        Box::new(move |session| session.request_settings(clock_settings))
    }

    fn connect(&mut self, opened: OpenedConnection<Ssi>, services: &mut Services) {
        self.release_thread(JobState::Cancelled, services);
        self.record.begin_session(&opened.began);
        self.motor = opened.session_handle.clone();
        self.requested = None;
        self.session.attach_connection(opened, services);
        if !self.session.drafting.is_loaded() {
            self.load_draft(services);
        }
        self.submit(SsiJob::Hello, services);
    }

    fn handle_action(&mut self, action: SsiAction, context: &mut ActionContext<'_>) {
        Encoder::handle_action(self, action, context);
    }

    fn handle_result(&mut self, done: TaskResult, services: &mut Services) {
        match done {
            TaskResult::Found { number, search } => {
                if self.search == SearchState::Running(number) {
                    self.search = *search;
                }
            }
            TaskResult::Written(path, Ok(())) => {
                services.log.remove_file_notices(&path);
                let text = Text::new("session.saved").with("path", path.display());
                services.notify(Severity::Good, vec![text], Some(&self.session.name()));
            }
            TaskResult::Written(_, Err(error)) => {
                self.session.report_rejection(explain::file_error_text(&error), services)
            }
        }
    }

    fn edited_body(&self) -> Option<Body> {
        Some(Body::new(self.edited_profile()))
    }

    fn accepts_item(&self, _item: &str) -> bool {
        true
    }

    fn take_item(&mut self, item: &str, from: &Body) -> Result<(), Text> {
        let from = from.get::<SsiProfile>().ok_or_else(|| Text::new("comparison.not_taken"))?;
        self.apply_edit(Edit::Whole(Box::new(self.edited_profile().with_item(item, from))));
        self.designer.problem().cloned().map_or(Ok(()), Err)
    }

    fn apply_profile(&mut self, body: Body, _services: &mut Services) -> Result<(), ProfileError> {
        self.apply_edit(Edit::Whole(Box::new(body.into_profile()?)));
        Ok(())
    }

    fn save(&mut self, path: PathBuf, services: &mut Services) {
        if let Some(refusal) = read_only_reason(&self.session.source) {
            return self.session.report_rejection(refusal, services);
        }
        let body = Body::new(self.edited_profile());
        let document = match &self.session.source {
            Source::File { document, .. } => ProfileDocument { body, ..(**document).clone() },
            Source::Link(_) | Source::New { .. } => new_document(body),
        };
        self.session.write_document(path, None, document, Vec::new(), services);
    }

    fn is_savable(&self) -> bool {
        // A layout can be saved at any time.
        true
    }

    fn session_results(&self) -> Vec<SessionResult> {
        self.check.iter().cloned().map(SessionResult::Check).collect()
    }

    fn position_job(&self) -> SsiJob {
        SsiJob::Read
    }

    fn recording(&self) -> &dyn Recording {
        &self.record
    }

    fn record_mut(&mut self) -> &mut dyn Recording {
        &mut self.record
    }

    fn memory(&self) -> Option<&dyn DeviceMemory> {
        None
    }

    fn memory_mut(&mut self) -> Result<&mut dyn DeviceMemory, Text> {
        Err(TEXTS.text("ssi.never_written"))
    }

    fn read_device(&mut self, services: &mut Services) {
        if !matches!(self.session.source, Source::New { .. }) {
            self.submit(SsiJob::Hello, services);
        }
    }

    fn apply_edit_step(&mut self, step: EditStep) {
        let before = self.designer.layout().clone();
        if step(&mut self.designer) {
            self.handle_layout_change(&before);
        }
    }

    fn ask_where_to_save(&mut self, services: &mut Services) {
        let suggested = self.suggested_path("ron");
        services.file_question = Some(FileQuestion::Save { session: self.session.id, suggested });
    }

    fn can_stream(&self) -> bool {
        // An adapter is always present.
        true
    }

    fn switch_link(&mut self, url: &LinkUrl) {
        if let Source::Link(before) = &self.session.source {
            self.apply_edit(Edit::Reading(self.designer.reading_after_link_change(before, url)));
        }
    }
}
