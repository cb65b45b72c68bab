//! Handles job results, received words and the loss of the connection.

use super::drafts::Edits;
use super::encoder::Encoder;
use super::job;
use crate::app::FrameExplanation;
use crate::app::review::{Review, write_result_messages};
use crate::app::services::{JobState, Services};
use crate::app::session::{HasMemory, HasProfile, Interruption, Kind, SessionEvents};
use crate::app::{Severity, Text};
use crate::devices::interbus::jobs::{DeviceMessage, Interbus, InterbusJob, InterbusOutput, JobError, JobStep};
use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::KIND;
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain as words;
use crate::link::{LinkUrl, TraceEntry};
use crate::sim::Motor;
use crate::store::Store;
use crate::worker::{OpenError, Session};

impl Kind for Interbus {
    const KIND: &'static str = KIND;
    /// Polling is initially off, because a control system may be reading the same word.
    const STARTS_LIVE: bool = false;
    type Edits = Edits;
    type SessionHandle = Option<Motor>;
    type Review = Review<Self>;

    fn session_handle(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError> {
        crate::devices::interbus::jobs::open(url, store)
    }

    fn job_text(job: &InterbusJob) -> Text {
        job::job_name(job)
    }

    fn writes_memory(job: &InterbusJob) -> bool {
        matches!(job, InterbusJob::Commit(_))
    }

    fn survey_job() -> InterbusJob {
        InterbusJob::Survey
    }

    fn step_text(what: &JobStep) -> Text {
        words::step_text(what)
    }

    fn result_texts(output: &InterbusOutput) -> Option<(Severity, Vec<Text>)> {
        let InterbusOutput::Committed(committed) = output else { return None };
        Some(write_result_messages::<Interbus>(committed))
    }

    fn error_texts(error: &JobError) -> Vec<Text> {
        words::job_error_texts(error)
    }

    fn connection_error(error: &JobError) -> Option<Text> {
        words::connection_loss_text(error)
    }
}

impl Encoder {
    /// Reads the current word, unless it is already being polled.
    fn refresh_word(&mut self, services: &mut Services) {
        if !self.session.is_polling() {
            self.submit(InterbusJob::Position, services);
        }
    }
}

impl SessionEvents for Encoder {
    fn handle_samples(&mut self, samples: Vec<WordReading>, dropped: u64) {
        if let Some(image) = self.staged.device() {
            self.preview.set_programs(&image.programs);
        }
        samples.iter().for_each(|reading| self.preview.compare(reading));
        self.record.add_readings(samples, dropped);
    }

    fn explain_frame(&mut self, frame: &TraceEntry) -> FrameExplanation {
        self.trace.shift = self.shift();
        self.trace.explain(frame)
    }

    fn message_received(&mut self, DeviceMessage::Handshake(step): DeviceMessage, _: &mut Services) {
        self.record_handshake_step(step);
    }

    fn handle_finished_job(&mut self, output: InterbusOutput, services: &mut Services) {
        match output {
            InterbusOutput::Hello(reading) => {
                if std::mem::take(&mut self.session.just_connected) {
                    let word = TEXTS.text("log.interbus_word").with("word", format!("0x{:08X}", reading.word));
                    self.session.log_first_reply(vec![word], services);
                }
                self.record.set_latest_reading(reading);
                self.read_next_unread_part(services);
            }
            InterbusOutput::Surveyed(survey) => {
                self.apply_survey(*survey, services);
                let programs = std::mem::take(&mut self.read_after);
                if !programs.is_empty() {
                    self.submit(InterbusJob::Programs(programs), services);
                } else if !self.read_next_unread_part(services) {
                    self.refresh_word(services);
                }
            }
            InterbusOutput::Programs(programs, shift) => {
                self.staged.refresh_programs(&programs, Some(shift));
                // The job may have used EEPROM write cycles.
                self.list_backups(services);
                self.refresh_word(services);
            }
            InterbusOutput::Position(reading) => self.record.add_readings(vec![reading], 0),
            InterbusOutput::ReadOut(what, value) => {
                self.read_outs.insert(what.to_u16(), value);
            }
            InterbusOutput::Selected(mode) | InterbusOutput::ModeRestored(mode) => {
                if let Some(survey) = &mut self.survey {
                    survey.identity.mode = mode;
                }
                self.refresh_word(services);
            }
            InterbusOutput::Check(lines) => self.check = Some(words::check_lines(&lines)),
            InterbusOutput::Saved(profile) => self.save_profile(*profile, services),
            InterbusOutput::Prepared(prepared) => self.adopt_plan(prepared, services),
            InterbusOutput::Committed(committed) => self.handle_commit_end(*committed, services),
            // Only the command line runs these jobs.
            InterbusOutput::Identity(_) | InterbusOutput::Status(_) | InterbusOutput::Item(_) => {}
        }
    }

    fn is_no_response(&self, error: &JobError) -> bool {
        words::is_no_response(error)
    }

    /// Discards the planned write and the confirmation of the standstill.
    fn discard_requests(&mut self) {
        self.set_stopped(false);
        self.discard_plan();
    }

    fn handle_interruption(&mut self, how: Interruption<JobError>, texts: &[Text], _: &mut Services) -> bool {
        self.handle_interrupted_write(how, texts)
    }

    /// Submits a job. A job that disturbs the machine requires a confirmed standstill.
    fn try_submit(&mut self, job: InterbusJob, services: &mut Services) -> bool {
        if job::requires_standstill(&job) && !self.is_stopped() {
            services.notify(Severity::Warning, vec![TEXTS.text("ib_stop.first")], Some(&self.session.name()));
            return false;
        }
        if job::requires_standstill(&job) && self.session.is_ready() {
            self.handshake.clear();
        }
        self.session.submit(job, services)
    }

    fn release_thread(&mut self, end: JobState, services: &mut Services) {
        self.motor = None;
        self.discard_requests();
        self.session.release_thread(end, services);
    }
}
