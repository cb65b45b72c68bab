//! Events from the connection to an encoder: job results, live samples, and loss of the connection.

use super::drafts::Edits;
use super::encoder::Encoder;
use super::format;
use crate::app::FrameExplanation;
use crate::app::review::{Review, write_result_messages};
use crate::app::services::{JobState, Services};
use crate::app::session::{HasMemory, Interruption, Kind, SessionEvents, first};
use crate::app::{Severity, Text};
use crate::devices::biss::jobs::{Biss, BissJob, BissOutput, DeviceMessage, JobError, JobStep};
use crate::devices::biss::procedures::{Error, PolledSample};
use crate::devices::biss::protocol::KIND;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as explained;
use crate::link::{LinkUrl, TraceEntry};
use crate::sim::Motor;
use crate::store::Store;
use crate::worker::{OpenError, Session};

impl Kind for Biss {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type SessionHandle = Option<Motor>;
    type Review = Review<Self>;

    fn session_handle(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError> {
        crate::devices::biss::jobs::open(url, store)
    }

    fn job_text(job: &BissJob) -> Text {
        format::job_name(job)
    }

    fn writes_memory(job: &BissJob) -> bool {
        matches!(job, BissJob::Commit(_) | BissJob::ReturnToOperation)
    }

    fn survey_job() -> BissJob {
        BissJob::Survey
    }

    fn step_text(what: &JobStep) -> Text {
        explained::step_text(what)
    }

    fn result_texts(output: &BissOutput) -> Option<(Severity, Vec<Text>)> {
        let BissOutput::Committed(committed) = output else { return None };
        Some(write_result_messages::<Biss>(committed))
    }

    fn error_texts(error: &JobError) -> Vec<Text> {
        explained::job_error_texts(error)
    }

    fn connection_error(error: &JobError) -> Option<Text> {
        explained::connection_loss_text(error)
    }
}

impl Encoder {
    /// Reads back the next bank on the list of written banks.
    fn read_back_changes(&mut self, services: &mut Services) {
        if let Some(bank) = self.read_after.pop_first() {
            self.submit(BissJob::ReadBank(bank), services);
        }
    }
}

impl SessionEvents for Encoder {
    fn handle_samples(&mut self, samples: Vec<PolledSample>, dropped: u64) {
        self.record.add_samples(samples, dropped);
    }

    fn explain_frame(&mut self, frame: &TraceEntry) -> FrameExplanation {
        self.meaning.explain(frame)
    }

    fn handle_progress(&mut self, what: JobStep) {
        let running = self.guide.as_mut().filter(|guide| guide.is_running());
        if let (JobStep::Operation { progress: news, .. }, Some(guide)) = (what, running) {
            guide.set_progress(*news);
        }
    }

    fn message_received(&mut self, remark: DeviceMessage, services: &mut Services) {
        match remark {
            DeviceMessage::CrcErrors(count) => self.record.add_crc_errors(count),
            remark => services.notify(Severity::Warning, explained::message_texts(&remark), None),
        }
    }

    fn handle_finished_job(&mut self, output: BissOutput, services: &mut Services) {
        match output {
            BissOutput::Surveyed(survey) => {
                self.apply_survey(*survey, services);
                self.read_back_changes(services);
            }
            BissOutput::Status(status) => {
                if let Some(position) = status.position {
                    self.record.add_position(position);
                }
                self.status = Some(*status);
            }
            BissOutput::Check(lines) => self.check = Some(explained::check_lines(&lines)),
            BissOutput::Position(reading) => self.record.add_position(reading),
            BissOutput::Registers(read) => {
                self.memory.store_bytes(read.start, &read.bytes);
                if read.start.bank().is_some() {
                    self.set_device_mode(read.unsaved);
                }
                self.read_back_changes(services);
            }
            BissOutput::Area { banks, unsaved } => {
                self.set_device_mode(unsaved);
                for bank in banks {
                    bank.registers().for_each(|(at, byte)| self.memory.store_bytes(at, &[byte]));
                }
            }
            BissOutput::Saved(profile) => self.save_profile(*profile, services),
            BissOutput::Prepared(prepared) => self.adopt_plan(prepared, services),
            BissOutput::Committed(committed) => {
                self.log_outcomes(&committed.written.outcomes, services);
                self.handle_commit_end(*committed, services);
            }
            BissOutput::ReturnedToOperation(mode) => {
                self.mark_returned_to_operation();
                let text = TEXTS.text("guide.led_back").with_text("mode", explained::mode_text(mode));
                services.notify(Severity::Good, vec![text], Some(&self.session.name()));
                self.submit(BissJob::Survey, services);
            }
            // The survey contains more than the identity.
            BissOutput::Identity(_) => {}
        }
    }

    /// Returns whether an error means that neither the encoder nor the adapter responds.
    fn is_no_response(&self, error: &JobError) -> bool {
        let is_lost = match error {
            JobError::Device(cause) => cause.is_lost(),
            JobError::Interrupted { interrupted, .. } => interrupted.cause.is_lost(),
            _ => false,
        };
        is_lost && explained::connection_loss_text(error).is_none()
    }

    fn discard_requests(&mut self) {
        self.seen.clear();
        self.read_after.clear();
        self.discard_plan();
    }

    fn handle_interruption(&mut self, how: Interruption<JobError>, texts: &[Text], _: &mut Services) -> bool {
        let moves = matches!(how, Interruption::Failed(JobError::Device(Error::Moving { .. })));
        let stands_there = self.end_interrupted_procedure(&how, texts) || self.handle_interrupted_write(how, texts);
        if stands_there || !moves || self.session.save_to.is_some() || self.session.just_connected {
            return stands_there;
        }
        // The rejection is shown on the data pages.
        self.refusal = Some(first(texts));
        true
    }

    fn try_submit(&mut self, job: BissJob, services: &mut Services) -> bool {
        // If necessary, the next request sets the message again.
        self.refusal = None;
        self.session.submit(job, services)
    }

    fn release_thread(&mut self, end: JobState, services: &mut Services) {
        self.motor = None;
        self.discard_requests();
        self.session.release_thread(end, services);
    }
}
