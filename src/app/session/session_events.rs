//! Events of a session: samples, job results, interruptions, and loss of the connection. Each kind of device handles
//! its own results. Otherwise, the end of a job is handled in the same way for all kinds.

#![warn(missing_docs)]

use super::{HasSession, Kind};
use crate::app::live_session::LiveSession;
use crate::app::services::{JobState, Services};
use crate::app::trace::FrameExplanation;
use crate::app::{Severity, Text, explain};
use crate::link::TraceEntry;
use crate::worker::{Device, Event, JobId, JobInterruption as _};

type Job<T> = <<T as HasSession>::Device as Device>::Job;
type Output<T> = <<T as HasSession>::Device as Device>::Output;
type Error<T> = <<T as HasSession>::Device as Device>::Error;
type DeviceMessage<T> = <<T as HasSession>::Device as Device>::DeviceMessage;
type Sample<T> = <<T as HasSession>::Device as Device>::Sample;
type JobStep<T> = <<T as HasSession>::Device as Device>::JobStep;

/// The reason why a request was interrupted.
pub enum Interruption<'e, E> {
    /// The user cancelled the request.
    Cancelled(&'e E),
    /// The request failed with this error.
    Failed(&'e E),
    /// The connection was lost.
    Lost,
}

/// A device that handles the events of its session.
pub trait SessionEvents: HasSession {
    /// Records samples. `dropped` is the number of samples lost before them.
    fn handle_samples(&mut self, samples: Vec<Sample<Self>>, dropped: u64);

    /// Returns the explanation of a trace frame, empty if the bytes need none. Called once per frame, in order.
    fn explain_frame(&mut self, _frame: &TraceEntry) -> FrameExplanation {
        FrameExplanation::default()
    }

    /// Handles a message that the device sent during a job.
    fn message_received(&mut self, remark: DeviceMessage<Self>, services: &mut Services);

    /// Handles the result of a completed job.
    fn handle_finished_job(&mut self, output: Output<Self>, services: &mut Services);

    /// Returns whether the error means that the link is open, but the device does not reply.
    fn is_no_response(&self, error: &Error<Self>) -> bool;

    /// Discards pending requests, because their replies will not arrive.
    fn discard_requests(&mut self);

    /// Prepares for the release of the connection.
    fn prepare_release(&mut self) {}

    /// Handles progress of the running job.
    fn handle_progress(&mut self, _what: JobStep<Self>) {}

    /// Returns whether the result of a job proves that the device has replied.
    fn is_device_reply(_output: &Output<Self>) -> bool {
        true
    }

    /// Handles the interruption of a job. Returns whether the review reports it.
    fn handle_interruption(
        &mut self,
        _how: Interruption<Error<Self>>,
        _texts: &[Text],
        _services: &mut Services,
    ) -> bool {
        false
    }

    /// Handles the end of polling after a failed sample, whatever the cause.
    fn on_polling_end(&mut self) {}

    /// Starts a job. If this is impossible, reports the reason and returns `false`.
    fn try_submit(&mut self, job: Job<Self>, services: &mut Services) -> bool {
        self.session_mut().submit(job, services)
    }

    /// Starts a job. If this is impossible, reports the reason.
    fn submit(&mut self, job: Job<Self>, services: &mut Services) {
        self.try_submit(job, services);
    }

    /// Processes the session's events received since the last call.
    fn process_events(&mut self, services: &mut Services) {
        self.process_pending_events(services);
    }

    /// Processes the session's pending events. Kinds of devices with additional work override this method.
    fn process_pending_events(&mut self, services: &mut Services) {
        // Samples that precede a job are handled before its result. Later ones are handled in the next call.
        self.fetch_samples_and_frames();
        while let Some(event) = self.session_mut().line.as_mut().and_then(LiveSession::next) {
            self.handle_event(event, services);
        }
        if self.session().line.as_ref().is_some_and(LiveSession::is_dead) {
            self.connection_lost(Text::new("session.ended"), services);
        }
    }

    /// Fetches the samples and frames received since the last call.
    fn fetch_samples_and_frames(&mut self) {
        let Some(line) = &mut self.session_mut().line else { return };
        let (samples, dropped) = line.take_samples();
        let (frames, missed) = line.take_frames();
        if !samples.is_empty() || dropped > 0 {
            self.handle_samples(samples, dropped);
            self.session_mut().mark_replying();
        }
        if !frames.is_empty() {
            let meanings: Vec<_> = frames.iter().map(|frame| self.explain_frame(frame)).collect();
            self.session_mut().trace.add_frames(frames.into_iter().zip(meanings), missed);
        }
    }

    /// Handles one event that the session has reported.
    fn handle_event(&mut self, event: Event<Self::Device>, services: &mut Services) {
        match event {
            Event::Started(_) => {}
            Event::Progress(_, progress) => self.handle_progress(progress.step),
            Event::DeviceMessage(remark) => self.message_received(remark, services),
            Event::Finished(id, output) => {
                services.end_job(self.session().id, id, JobState::Done);
                if Self::is_device_reply(&output) {
                    self.session_mut().mark_replying();
                }
                self.handle_finished_job(*output, services);
            }
            Event::Failed(id, error) => self.handle_failed_job(id, &error, services),
            Event::Cancelled(id, error) => self.cancelled(id, &error, services),
            Event::PollFailed(error) => self.poll_failed(&error, services),
            Event::Lost(error) => self.connection_lost(explain::link_error_text(&error), services),
        }
        self.session_mut().drafting.mark_draft_due();
    }

    /// Handles the end of polling after a failed sample.
    fn poll_failed(&mut self, error: &Error<Self>, services: &mut Services) {
        self.on_polling_end();
        match Self::Device::connection_error(error) {
            Some(why) => self.connection_lost(why, services),
            None => {
                let is_silent = self.is_no_response(error);
                self.session_mut().handle_polling_failure(Self::Device::error_texts(error), is_silent, services);
            }
        }
    }

    /// Handles the cancellation of a job. Values that the job has written are read again.
    fn cancelled(&mut self, id: JobId, error: &Error<Self>, services: &mut Services) {
        services.end_job(self.session().id, id, JobState::Cancelled);
        self.session_mut().save_to = None;
        let (texts, begun) = (Self::Device::error_texts(error), error.has_begun());
        let stands_there = self.handle_interruption(Interruption::Cancelled(error), &texts, services);
        let severity = if begun { Severity::Warning } else { Severity::Note };
        self.session().report_message(severity, texts, stands_there, services);
        if begun {
            self.submit(Self::Device::survey_job(), services);
        }
    }

    /// Handles a job that failed.
    fn handle_failed_job(&mut self, id: JobId, error: &Error<Self>, services: &mut Services) {
        let texts = Self::Device::error_texts(error);
        services.end_job(self.session().id, id, JobState::Failed(first(&texts)));
        let stands_there = self.handle_interruption(Interruption::Failed(error), &texts, services);
        self.session_mut().save_to = None;
        match Self::Device::connection_error(error) {
            Some(why) => self.connection_lost(why, services),
            None if self.is_no_response(error) || self.session().just_connected => {
                self.session_mut().mark_unresponsive(texts, services);
            }
            None => {
                self.session_mut().mark_replying();
                self.session().report_message(Severity::Error, texts, stands_there, services);
                if error.has_begun() {
                    self.submit(Self::Device::survey_job(), services);
                }
            }
        }
    }

    /// Handles the loss of the connection. Known data and edits are kept.
    fn connection_lost(&mut self, why: Text, services: &mut Services) {
        self.prepare_release();
        // The last frames are fetched because they best show the cause.
        self.fetch_samples_and_frames();
        self.discard_requests();
        self.handle_interruption(Interruption::Lost, std::slice::from_ref(&why), services);
        self.session_mut().connection_lost(why, services);
    }

    /// Releases the session's thread, ends the running job with `end`, and discards a pending plan.
    fn release_thread(&mut self, end: JobState, services: &mut Services) {
        self.prepare_release();
        self.discard_requests();
        self.session_mut().release_thread(end, services);
    }
}

/// Returns the first text, for places with room for only one.
pub(crate) fn first(texts: &[Text]) -> Text {
    texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"))
}
