//! Events from the connection: job results, encoder messages, live samples and the loss of the connection.

use super::drafts::Edits;
use super::encoder::Encoder;
use super::job;
use super::review::Review;
use crate::app::FrameExplanation;
use crate::app::review::write_result_messages;
use crate::app::services::{JobState, Services};
use crate::app::session::{HasDraft, HasMemory, Interruption, Kind, SessionEvents, Source, first};
use crate::app::{PendingEdits, Severity, Text};
use crate::devices::hiperface::jobs::{
    DeviceMessage, Hiperface, HiperfaceJob, HiperfaceOutput, JobError, JobStep, SavedProfile, Value,
};
use crate::devices::hiperface::procedures::{Error, PolledSample, Station};
use crate::devices::hiperface::profile::{Item, Op};
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, KIND, StatusCode};
use crate::devices::hiperface::state::explain as explained;
use crate::link::{LinkUrl, TraceEntry};
use crate::profile::Body;
use crate::store::Store;
use crate::worker::{JobId, JobInterruption as _, OpenError, Session};

impl Kind for Hiperface {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type SessionHandle = ();
    type Review = Review;

    fn session_handle(_session: &Session<Self>) {}

    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError> {
        crate::devices::hiperface::jobs::open(url, store)
    }

    fn open_error(error: &OpenError) -> Text {
        explained::open_error_text(error)
    }

    fn job_text(job: &HiperfaceJob) -> Text {
        job::job_name(job)
    }

    fn writes_memory(job: &HiperfaceJob) -> bool {
        matches!(job, HiperfaceJob::Commit(_))
    }

    fn survey_job() -> HiperfaceJob {
        HiperfaceJob::Survey
    }

    fn step_text(what: &JobStep) -> Text {
        explained::step_text(what)
    }

    fn result_texts(output: &HiperfaceOutput) -> Option<(Severity, Vec<Text>)> {
        let HiperfaceOutput::Committed(committed) = output else { return None };
        Some(write_result_messages::<Hiperface>(committed))
    }

    fn error_texts(error: &JobError) -> Vec<Text> {
        explained::job_error_texts(error)
    }

    fn connection_error(error: &JobError) -> Option<Text> {
        explained::connection_loss_text(error)
    }
}

impl Encoder {
    /// Reads the encoder. If access codes are to be used, the encoder is identified first, because codes belong to a
    /// specific encoder.
    pub(super) fn read_encoder(&mut self, services: &mut Services) {
        let identify = self.session.just_connected && !self.access_codes.is_empty();
        self.submit(if identify { HiperfaceJob::Identify } else { HiperfaceJob::Survey }, services);
    }

    /// Passes the next access code to the session, or reads the encoder if no access code is left.
    fn submit_access_codes(&mut self, services: &mut Services) {
        match self.pending_codes.pop() {
            Some((number, code)) => self.submit(HiperfaceJob::UseCode { number, code }, services),
            None => self.submit(HiperfaceJob::Survey, services),
        }
    }

    fn add_announced_codes(&mut self, codes: Vec<StatusCode>, services: &mut Services) {
        let texts = codes.iter().map(|code| explained::status_code_name(*code)).collect();
        services.notify(Severity::Warning, texts, Some(&self.session.name()));
        self.codes.get_or_insert_default().extend(codes);
    }

    /// Updates the session's address, access codes and position offset after a write. The offset is known only to this
    /// program, because the encoder does not report it.
    pub(super) fn apply_operations(&mut self, ops: &[Op], services: &mut Services) {
        for op in ops {
            match op {
                Op::ChangeCode { number, new, .. } => self.remember_code(*number, *new),
                Op::SetAddress { to, .. } => {
                    if let Source::Link(url) = &mut self.session.source {
                        url.query.set("address", &format!("0x{:02X}", to.byte()));
                    }
                }
                Op::SetPosition { from, to, .. } => {
                    self.position_set = Some((*from, *to));
                    // Earlier readings refer to the previous zero position.
                    self.commutation.forget_readings();
                    let steps = i64::from(*to) - i64::from(*from);
                    let text = Text::new("session.position_set").with("from", from).with("to", to);
                    services.log_without_display(
                        Severity::Note,
                        vec![text.with("steps", format!("{steps:+}"))],
                        Some(&self.session.name()),
                    );
                }
                _ => {}
            }
        }
    }

    /// Takes over the line settings that a job has changed, so that the next session starts with them.
    fn adopt_line_settings(&mut self) {
        let Some(settings) = self.settings_after_job.take() else { return };
        let (Source::Link(url), Some(format)) = (&mut self.session.source, settings.character_format()) else { return };
        let Ok(now) = Station::from_query(&url.query, std::time::Duration::ZERO) else { return };
        if now.format.baud != format.baud {
            url.query.set("baud", &format.baud.to_string());
        }
        if now.format.parity != format.parity {
            url.query.set("parity", format.parity.keyword());
        }
        if now.long_timeout != settings.has_long_timeout() {
            url.query.set("timeout", if settings.has_long_timeout() { "44" } else { "11" });
        }
    }

    pub(super) fn remember_code(&mut self, number: AccessCodeNumber, code: AccessCode) {
        self.access_codes.retain(|(own, _)| *own != number);
        self.access_codes.push((number, code));
    }

    fn apply_value(&mut self, value: Value) {
        match (value, self.asked.take()) {
            (Value::Analogue { value, limit }, Some(Item::Analogue(channel))) => {
                self.analogue.insert(channel, Ok((value, limit)));
            }
            (Value::Number(number), Some(Item::Counter)) => {
                self.counter = u32::try_from(number).ok();
            }
            _ => {}
        }
    }

    fn save_profile(&mut self, saved: SavedProfile, services: &mut Services) {
        let edits = self.is_dirty().then(|| self.staged.count());
        let locked = saved.locked.iter();
        let remarks = locked
            .map(|(field, number)| Text::new("session.saved_locked").with("field", field).with("number", number))
            .collect();
        let device = self.device_key();
        self.session.save_read_values(device, Body::new(saved.profile), edits, remarks, services);
    }

    fn apply_completed_steps(&mut self, error: &JobError, services: &mut Services) {
        let JobError::Interrupted { interrupted, .. } = error else { return };
        let Some(prepared) = self.open_review().and_then(Review::plan_in_progress) else { return };
        let done: Vec<Op> = prepared.plan.ops.iter().take(interrupted.done.ops).cloned().collect();
        self.apply_operations(&done, services);
    }
}

impl SessionEvents for Encoder {
    fn handle_samples(&mut self, samples: Vec<PolledSample>, dropped: u64) {
        self.add_samples(samples, dropped);
    }

    fn explain_frame(&mut self, frame: &TraceEntry) -> FrameExplanation {
        self.meaning.explain(frame)
    }

    fn message_received(&mut self, remark: DeviceMessage, services: &mut Services) {
        match remark {
            DeviceMessage::Codes(codes) => self.add_announced_codes(codes, services),
            DeviceMessage::CodesLost(count) => {
                let text = explained::unanswered_codes(count);
                services.notify(Severity::Warning, vec![text], Some(&self.session.name()));
            }
            DeviceMessage::Line(quality) => self.line_quality = quality,
            DeviceMessage::Found(_) => {}
        }
    }

    fn is_device_reply(output: &HiperfaceOutput) -> bool {
        !matches!(output, HiperfaceOutput::CodeNoted)
    }

    fn handle_finished_job(&mut self, output: HiperfaceOutput, services: &mut Services) {
        match output {
            HiperfaceOutput::Surveyed(survey) => self.apply_survey(*survey, services),
            HiperfaceOutput::Identity(identity) => {
                let proven = !identity.serial.serial_number.is_empty() && !self.is_different_device(&identity);
                if proven {
                    self.pending_codes.clone_from(&self.access_codes);
                } else {
                    self.access_codes.clear();
                }
                self.submit_access_codes(services);
            }
            HiperfaceOutput::Status(codes) => self.codes = Some(codes),
            HiperfaceOutput::Position(reading) => self.add_samples(vec![PolledSample::Position(reading)], 0),
            HiperfaceOutput::Rest(rest) => self.handle_rest_reading(rest),
            HiperfaceOutput::Value(value) => self.apply_value(value),
            HiperfaceOutput::Check(lines) => {
                self.check = Some(lines);
                self.adopt_line_settings();
            }
            HiperfaceOutput::Reset(codes) => {
                self.codes = Some(codes);
                self.adopt_line_settings();
                services.notify(Severity::Good, vec![Text::new("session.restarted")], Some(&self.session.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::Configured => {
                self.adopt_line_settings();
                services.notify(Severity::Good, vec![Text::new("session.configured")], Some(&self.session.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::CodeNoted => self.submit_access_codes(services),
            HiperfaceOutput::Saved(saved) => self.save_profile(*saved, services),
            HiperfaceOutput::Prepared(prepared) => self.adopt_plan(prepared, services),
            HiperfaceOutput::Committed(committed) => self.handle_commit_end(committed, services),
            // Searches run in a separate session.
            HiperfaceOutput::Found(_) => {}
        }
    }

    /// Returns whether the error means that the encoder does not respond. Invalid bytes count as no response only
    /// directly after connecting.
    fn is_no_response(&self, error: &JobError) -> bool {
        let cause = match error {
            JobError::Device(cause) => cause,
            JobError::Interrupted { interrupted, .. } => &interrupted.cause,
            _ => return false,
        };
        cause.is_lost() || (self.session.just_connected && matches!(cause, Error::Damaged { .. } | Error::NeverSilent))
    }

    fn discard_requests(&mut self) {
        self.asked = None;
        self.cancel_rest_reading();
        self.discard_plan();
    }

    fn handle_interruption(&mut self, how: Interruption<JobError>, texts: &[Text], services: &mut Services) -> bool {
        if let Interruption::Cancelled(error) = how {
            self.apply_completed_steps(error, services);
            self.asked = None;
            self.cancel_rest_reading();
        }
        self.handle_interrupted_write(how, texts);
        // The caller also reports the interruption.
        false
    }

    fn try_submit(&mut self, job: HiperfaceJob, services: &mut Services) -> bool {
        let asked = match &job {
            HiperfaceJob::Read(item) => Some(*item),
            _ => None,
        };
        let begun = self.session.submit(job, services);
        if begun {
            self.asked = asked;
            self.settings_after_job = None;
        }
        begun
    }

    /// Handles a failed job. If the encoder rejects an analogue channel, the rejection is shown in place of a value.
    fn handle_failed_job(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = Hiperface::error_texts(error);
        let why = first(&texts);
        services.end_job(self.session.id, id, JobState::Failed(why.clone()));
        let stands_there = self.handle_rest_failure(&why);
        if let (Some(Item::Analogue(channel)), JobError::Device(Error::Rejected { .. })) = (self.asked.take(), error) {
            // The encoder does not have this channel, which is shown where the reading was requested.
            self.analogue.insert(channel, Err(why));
            self.session.mark_replying();
            return;
        }
        self.session.save_to = None;
        let gone = Hiperface::connection_error(error);
        self.apply_completed_steps(error, services);
        let silent = gone.is_none() && self.is_no_response(error);
        let garbled = matches!(error, JobError::Device(Error::Damaged { .. } | Error::NeverSilent));
        if gone.is_none() && !silent && !garbled {
            self.session.mark_replying();
        }
        let is_shown = self.handle_interrupted_write(Interruption::Failed(error), &texts);
        match gone {
            Some(why) => {
                if is_shown {
                    services.log_without_display(Severity::Error, texts, Some(&self.session.name()));
                }
                self.connection_lost(why, services);
            }
            None if silent => self.session.mark_unresponsive(texts, services),
            None => {
                self.session.report_message(Severity::Error, texts, is_shown || stands_there, services);
                if error.has_begun() {
                    self.submit(HiperfaceJob::Survey, services);
                }
            }
        }
    }
}
