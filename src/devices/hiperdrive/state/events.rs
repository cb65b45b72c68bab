//! Events from a session: job results, drive positions, and loss of the connection.

use std::time::Duration;

use super::drafts::Edits;
use super::job;
use super::review::ReviewState;
use super::unit::HiperdriveDevice;
use crate::app::FrameExplanation;
use crate::app::review::{Review, write_result_messages};
use crate::app::services::Services;
use crate::app::session::{HasMemory, Interruption, Kind, SessionEvents};
use crate::app::{Severity, Text};
use crate::devices::hiperdrive::jobs::{
    DeviceMessage, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobError, JobStep, Motion,
};
use crate::devices::hiperdrive::procedures::dead_man::ActionEnd;
use crate::devices::hiperdrive::procedures::{DriveReading, PolledSample};
use crate::devices::hiperdrive::protocol::{DriveNumber, KIND, State};
use crate::devices::hiperdrive::sim::Target;
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as words;
use crate::link::{LinkUrl, TraceEntry};
use crate::store::Store;
use crate::worker::{OpenError, Session};

/// Default interval for reading the position of a drive.
const DEFAULT_INTERVAL: Duration = Duration::from_millis(200);
/// Message ID of the notice that the limits of a drive under control cannot be read. The notice is removed once they
/// are read or no longer needed.
const LIMITS_UNREADABLE_ID: &str = "hd_end.rules";

/// Returns whether a drive in this state must be acknowledged before it can move.
const fn has_failed(state: State) -> bool {
    matches!(state, State::Fault | State::Locked)
}

pub struct DriveHandle {
    pub(super) motion: Motion,
    pub(super) target: Option<Target>,
}

impl Kind for Hiperdrive {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type SessionHandle = DriveHandle;
    type Review = Review<Self>;

    fn session_handle(session: &Session<Self>) -> DriveHandle {
        DriveHandle { motion: session.motion(), target: session.target() }
    }

    fn open(url: &LinkUrl, store: Store) -> Result<Session<Self>, OpenError> {
        crate::devices::hiperdrive::jobs::open(url, store)
    }

    fn job_text(job: &HiperdriveJob) -> Text {
        job::job_name(job)
    }

    fn writes_memory(job: &HiperdriveJob) -> bool {
        matches!(job, HiperdriveJob::Commit(_))
    }

    fn survey_job() -> HiperdriveJob {
        HiperdriveJob::Survey
    }

    fn step_text(what: &JobStep) -> Text {
        words::step_text(what)
    }

    fn result_texts(output: &HiperdriveOutput) -> Option<(Severity, Vec<Text>)> {
        let HiperdriveOutput::Committed(committed) = output else { return None };
        Some(write_result_messages::<Hiperdrive>(committed))
    }

    fn error_texts(error: &JobError) -> Vec<Text> {
        words::job_error_texts(error)
    }

    fn connection_error(error: &JobError) -> Option<Text> {
        words::connection_loss_text(error)
    }
}

impl HiperdriveDevice {
    /// Requests missing data as soon as the line is free: the cause of a fault, and the position of the selected drive.
    fn request_missing_data(&mut self, services: &mut Services) {
        if self.survey.is_none() || !self.session.is_ready() {
            return;
        }
        if std::mem::take(&mut self.looks_at_all) {
            self.submit(HiperdriveJob::Survey, services);
        } else if std::mem::take(&mut self.looks_at_errors) {
            self.submit(HiperdriveJob::Status, services);
        } else {
            self.update_watched(services);
        }
    }

    pub(super) fn update_watched(&mut self, services: &mut Services) {
        if self.watched != self.drive()
            && self.session.is_ready()
            && self.submit(HiperdriveJob::Watch(self.drive()), services)
        {
            self.watched = self.drive();
        }
    }

    fn handle_control_loss(&mut self, services: &mut Services) {
        self.moves.stop();
        // The last data of the drives, including any that were not fetched yet, date from before the loss. Their
        // current state is unknown.
        self.fetch_samples_and_frames();
        self.forget_readings();
        (self.is_stale, self.looks_at_all) = (true, true);
        services.log.remove_from_window(LIMITS_UNREADABLE_ID, Some(&self.session.name()));
        let text = words::cyclic_loss_text(self.moves.snapshot().lost.as_ref());
        services.notify(Severity::Error, vec![text], Some(&self.session.name()));
    }

    /// Removes the fault notice, which all drives share, once no drive has a fault.
    fn update_fault_notice(&self, failed: bool, services: &mut Services) {
        let fails =
            |drive: &DriveNumber| self.moves.actual_values(*drive).is_some_and(|own| has_failed(own.status.state()));
        if !failed && !self.drives().iter().any(fails) {
            services.log.remove_from_window("hd_end.fault", Some(&self.session.name()));
        }
    }

    fn report_motion_end(&self, drive: DriveNumber, ended: ActionEnd, services: &mut Services) {
        let weight = words::end_severity(ended);
        if weight == Severity::Note {
            return;
        }
        let words = words::end_text(ended, |steps| self.position_text(drive, steps));
        self.report_drive_message(drive, weight, vec![words], services);
    }

    /// Processes a drive position, and records it if the drive is selected.
    fn handle_reading(&mut self, reading: DriveReading) {
        self.take_reading(reading);
        let drive = reading.drive;
        if drive == self.drive() {
            let target = self.moves.last_setpoint(drive).map(|sent| sent.target);
            self.record.add_reading(reading, self.ruler(drive), self.speed_scale(drive), target);
        }
    }

    /// Polls the position of the selected drive, unless the user has chosen another interval.
    fn poll(&mut self) {
        let Some(line) = self.session.line.as_mut().filter(|line| line.polling_interval().is_none()) else { return };
        line.poll(Some(DEFAULT_INTERVAL));
        self.record.track.poll(Some(DEFAULT_INTERVAL), true);
    }
}

impl SessionEvents for HiperdriveDevice {
    fn handle_samples(&mut self, samples: Vec<PolledSample>, dropped: u64) {
        if dropped > 0 {
            self.record.record_dropped_samples(dropped);
        }
        for sample in samples {
            match sample {
                PolledSample::Position(reading) => self.handle_reading(reading),
                PolledSample::Temperature(reading) => self.record.add_temperature(reading),
            }
        }
    }

    fn explain_frame(&mut self, frame: &TraceEntry) -> FrameExplanation {
        self.decoder.explain(frame)
    }

    /// Processes new session events, and refreshes the actions that need a refresh in every frame.
    fn process_events(&mut self, services: &mut Services) {
        let before: Vec<_> = self.drives().into_iter().map(|drive| (drive, self.state(drive))).collect();
        self.set_remote(services.is_remote());
        self.moves.send_heartbeat();
        self.handle_limit_change();
        for (drive, before) in before {
            self.request_fault_cause(drive, before);
            if before.is_some_and(has_failed) && self.state(drive).is_some_and(|state| !has_failed(state)) {
                let failed = self.drives().into_iter().any(|drive| self.state(drive).is_some_and(has_failed));
                self.update_fault_notice(failed, services);
            }
        }
        if let Some((drive, ended)) = self.moves.take_motion_end() {
            self.report_motion_end(drive, ended, services);
        }
        self.process_pending_events(services);
        self.update_axes();
        self.request_missing_data(services);
    }

    fn message_received(&mut self, remark: DeviceMessage, services: &mut Services) {
        match remark {
            DeviceMessage::ControlLost => self.handle_control_loss(services),
            DeviceMessage::RulesUnread(why) => {
                self.moves.stop();
                let texts = vec![TEXTS.text(LIMITS_UNREADABLE_ID), words::device_error_text(&why)];
                services.notify(Severity::Error, texts, Some(&self.session.name()));
            }
            DeviceMessage::RulesRead => {
                services.log.remove_from_window(LIMITS_UNREADABLE_ID, Some(&self.session.name()))
            }
        }
    }

    fn handle_finished_job(&mut self, output: HiperdriveOutput, services: &mut Services) {
        match output {
            HiperdriveOutput::Hello(identity) => {
                self.session.just_connected = false;
                // The connected drives may have changed in the meantime.
                if self.is_different_device(&identity) || self.survey.is_none() || !self.has_polled {
                    self.submit(HiperdriveJob::Survey, services);
                }
            }
            HiperdriveOutput::Surveyed(survey) => {
                self.apply_survey(*survey, services);
                self.submit(HiperdriveJob::Status, services);
            }
            HiperdriveOutput::Status(status) => {
                let failed = status.drives.iter().any(|own| has_failed(own.status.state()));
                self.update_fault_notice(failed, services);
                self.status = Some(*status);
                if !std::mem::replace(&mut self.has_polled, true) {
                    self.poll();
                }
            }
            HiperdriveOutput::Check(lines) => self.check = Some(words::check_lines(&lines)),
            HiperdriveOutput::Position(reading) => self.handle_reading(reading),
            HiperdriveOutput::Value(number, value) => {
                if let Some(survey) = &mut self.survey {
                    survey.values.insert(number, value);
                }
            }
            HiperdriveOutput::Network(network) => {
                if let Some(survey) = &mut self.survey {
                    survey.network = *network;
                }
            }
            HiperdriveOutput::Saved(profile) => self.save_profile(*profile, services),
            HiperdriveOutput::Prepared(prepared) => self.adopt_plan(prepared, services),
            HiperdriveOutput::Committed(committed) => self.handle_commit_end(*committed, services),
            HiperdriveOutput::Taken => {
                self.moves.send_heartbeat();
                self.handle_limit_change();
                for lost in words::CONNECTION_LOSS_IDS.into_iter().chain([LIMITS_UNREADABLE_ID]) {
                    services.log.remove_from_window(lost, Some(&self.session.name()));
                }
                self.poll();
                // Another master may have changed limits and scaling since they were read. Therefore, no motion uses
                // the old values. They are read again as soon as the line is free.
                (self.is_stale, self.looks_at_all) = (true, true);
            }
            HiperdriveOutput::Given => {
                self.moves.send_heartbeat();
                // The limits are no longer read, so the notice is removed.
                services.log.remove_from_window(LIMITS_UNREADABLE_ID, Some(&self.session.name()));
                // Values that were not read while another master was in control are read now.
                self.looks_at_all |= self.is_stale;
            }
            HiperdriveOutput::Watched(drive) => self.watched = drive,
            // Only the command line requests the identity.
            HiperdriveOutput::Identity(_) => {}
        }
    }

    fn is_no_response(&self, error: &JobError) -> bool {
        words::is_no_response(error)
    }

    fn discard_requests(&mut self) {
        self.forget_readings();
        self.target = None;
        self.discard_plan();
    }

    fn handle_interruption(&mut self, how: Interruption<JobError>, texts: &[Text], _: &mut Services) -> bool {
        match how {
            Interruption::Failed(_) => self.moves.stop(),
            // Values required before a controlled drive moves are read even if the job ended early.
            Interruption::Cancelled(_) => self.looks_at_all |= self.is_stale && self.moves.is_open(),
            Interruption::Lost => {}
        }
        let is_told = self.handle_interrupted_write(how, texts);
        let begun =
            matches!(self.open_review().map(|review| &review.state), Some(ReviewState::Failed { begun: true, .. }));
        self.unsaved.interrupt_plan(begun);
        is_told
    }

    fn on_polling_end(&mut self) {
        self.moves.stop();
    }

    /// Ends all motion before control of the drives is released.
    fn prepare_release(&mut self) {
        self.moves.end_session();
    }
}
