//! Handles events from the line: identity of the adapter, words, and loss of the connection.

use std::convert::Infallible;

use super::drafts::Drafts;
use super::encoder::Encoder;
use super::{job, trace};
use crate::app::FrameExplanation;
use crate::app::services::{JobState, Services};
use crate::app::session::{Kind, SessionEvents};
use crate::app::{Severity, Text};
use crate::buses::bridge::procedures::AdapterError;
use crate::devices::ssi::jobs::{JobError, Ssi, SsiJob, SsiOutput};
use crate::devices::ssi::procedures::{Identity, Words};
use crate::devices::ssi::protocol::KIND;
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain as explained;
use crate::link::{LinkUrl, TraceEntry};
use crate::sim::Motor;
use crate::store::Store;
use crate::worker::{JobId, OpenError, Session};

impl Kind for Ssi {
    const KIND: &'static str = KIND;
    type Edits = Drafts;
    type SessionHandle = Option<Motor>;
    /// Nothing is written to an SSI encoder, so there is nothing to review.
    type Review = Infallible;

    fn session_handle(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError> {
        crate::devices::ssi::jobs::open(url, store)
    }

    fn job_text(job: &SsiJob) -> Text {
        job::job_name(job)
    }

    fn survey_job() -> SsiJob {
        SsiJob::Hello
    }

    fn step_text(_: &Self::JobStep) -> Text {
        TEXTS.text("ssi_job.words")
    }

    fn error_texts(error: &JobError) -> Vec<Text> {
        explained::job_error_texts(error)
    }

    fn connection_error(error: &JobError) -> Option<Text> {
        explained::connection_loss_text(error)
    }
}

impl Encoder {
    /// Sends the reading settings to the adapter if they differ from those last sent.
    fn send_reading_settings(&mut self, services: &mut Services) {
        let clock_settings = self.query_settings();
        // The adapter must be identified and idle. Settings that it rejected are not sent again.
        if self.identity.is_some() && self.session.is_ready() && self.requested != Some(clock_settings) {
            self.requested = Some(clock_settings);
            self.submit(SsiJob::Set(clock_settings), services);
        }
    }

    /// Reads a single SSI word for display, unless words are already being polled.
    fn refresh_word(&mut self, services: &mut Services) {
        if !self.session.is_polling() {
            self.submit(SsiJob::Read, services);
        }
    }

    fn accept_identity(&mut self, identity: Identity, services: &mut Services) {
        let fresh = std::mem::take(&mut self.session.just_connected);
        self.set_title_from_family();
        if fresh {
            let hello = &identity.hello;
            let adapter = Text::new("log.adapter")
                .with("name", &hello.name)
                .with("firmware", &hello.firmware)
                .with("serial", &hello.serial);
            self.session.log_first_reply(vec![adapter], services);
        }
        self.identity = Some(identity);
    }
}

impl SessionEvents for Encoder {
    fn handle_samples(&mut self, samples: Vec<Words>, dropped: u64) {
        self.record.add_words(samples, dropped);
    }

    fn explain_frame(&mut self, frame: &TraceEntry) -> FrameExplanation {
        trace::explain(frame)
    }

    fn process_events(&mut self, services: &mut Services) {
        self.process_pending_events(services);
        self.send_reading_settings(services);
    }

    fn message_received(&mut self, remark: Infallible, _: &mut Services) {
        match remark {}
    }

    fn handle_finished_job(&mut self, output: SsiOutput, services: &mut Services) {
        match output {
            SsiOutput::Hello(identity) => {
                self.requested = Some(identity.clock_settings);
                self.accept_identity(*identity, services);
                self.refresh_word(services);
            }
            SsiOutput::Set(identity) => {
                self.identity = Some(*identity);
                self.refresh_word(services);
            }
            SsiOutput::Read(words) => self.record.add_words(vec![words], 0),
            SsiOutput::Check(lines) => self.check = Some(explained::check_lines(&lines)),
        }
    }

    fn is_no_response(&self, error: &JobError) -> bool {
        matches!(error, JobError::Adapter(AdapterError::Silent | AdapterError::StreamSilent))
    }

    fn discard_requests(&mut self) {
        (self.motor, self.requested, self.identity) = (None, None, None);
    }

    fn cancelled(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        services.end_job(self.session.id, id, JobState::Cancelled);
        services.notify(Severity::Warning, Ssi::error_texts(error), Some(&self.session.name()));
    }
}
