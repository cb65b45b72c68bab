//! What the line to a device tells: results of jobs, where drives are, and its loss.

use std::time::Duration;

use super::drafts::Edits;
use super::review::Review;
use super::unit::Unit;
use crate::app::action::{Attempt, Done, Opened};
use crate::app::line::Line;
use crate::app::review::told;
use crate::app::services::{JobEnd, Opener, Services, World};
use crate::app::session::{Kind, LastWords, Phase};
use crate::app::{Severity, Text, explain};
use crate::device::hiperdrive::dead_man::Ended;
use crate::protocol::hiperdrive::{DriveNumber, KIND};
use crate::sim::hiperdrive::Target;
use crate::worker::hiperdrive::{Doing, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobError, Motion, Remark};
use crate::worker::{Event, JobId, Session};

/// How often a drive is asked where it is, to begin with.
const PACE: Duration = Duration::from_millis(200);

/// What is kept of a session beside its thread.
pub struct Aside {
    /// Moves its drives.
    motion: Motion,
    /// The virtual device.
    target: Option<Target>,
}

impl Kind for Hiperdrive {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type Aside = Aside;

    fn aside(session: &Session<Self>) -> Aside {
        Aside { motion: session.motion(), target: session.target() }
    }

    fn opener(world: &World) -> &Opener<Self> {
        &world.open_hiperdrive
    }

    fn opened(attempt: Attempt<Self>) -> Done {
        Done::OpenedHiperdrive(attempt)
    }

    fn last_words(event: &Event<Self>) -> Option<LastWords> {
        let (job, end, severity, texts) = match event {
            Event::Finished(job, output) => match &**output {
                HiperdriveOutput::Committed(committed) => {
                    let (severity, texts) = told::<Hiperdrive>(committed);
                    (job, JobEnd::Done, severity, texts)
                }
                _ => (job, JobEnd::Done, Severity::Note, vec![Text::new("session.ended")]),
            },
            Event::Cancelled(job, error) => {
                (job, JobEnd::Cancelled, Severity::Warning, explain::hiperdrive::job(error))
            }
            Event::Failed(job, error) => {
                let texts = explain::hiperdrive::job(error);
                let why = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
                (job, JobEnd::Failed(why), Severity::Error, texts)
            }
            _ => return None,
        };
        Some(LastWords { job: *job, end, severity, texts })
    }

    fn doing(what: &Doing) -> Text {
        explain::hiperdrive::doing(what)
    }
}

impl Unit {
    /// The link is open: the device is asked who it is, then for all it has. Nothing is set, and nothing moves.
    pub(in crate::app) fn connect(&mut self, opened: Opened<Hiperdrive>, services: &mut Services) {
        self.let_go(JobEnd::Cancelled, services);
        self.record.begin(&opened.began);
        self.moves.begin(opened.aside.motion.clone());
        self.target = opened.aside.target.clone();
        (self.watched, self.has_polled, self.is_stale) = (DriveNumber::FIRST, false, false);
        self.session.take_line(opened, services);
        self.submit(HiperdriveJob::Hello, services);
    }

    /// Takes what has come over the line since the last time, and keeps alive what pictures keep alive.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        let before: Vec<_> = self.drives().into_iter().map(|drive| (drive, self.state(drive))).collect();
        self.moves.beat();
        self.notice_rules();
        for (drive, before) in before {
            self.notice_fault(drive, before);
        }
        if let Some((drive, ended)) = self.moves.take_end() {
            self.tell_end(drive, ended, services);
        }
        // What was sampled before a job comes before what the job says; what was sampled after it comes the next time.
        self.take_samples_and_frames();
        while let Some(event) = self.session.line.as_mut().and_then(Line::next) {
            self.take(event, services);
        }
        if self.session.line.as_ref().is_some_and(Line::is_dead) {
            self.lose(Text::new("session.ended"), services);
        }
        self.follow_axes();
        self.ask_on(services);
    }

    /// What is to be asked as soon as the line is free: why a drive has failed, and where the one is that is shown.
    fn ask_on(&mut self, services: &mut Services) {
        if self.survey.is_none() || !self.session.is_ready() {
            return;
        }
        if std::mem::take(&mut self.looks_at_all) {
            self.submit(HiperdriveJob::Survey, services);
        } else if std::mem::take(&mut self.looks_at_errors) {
            self.submit(HiperdriveJob::Status, services);
        } else {
            self.watch(services);
        }
    }

    /// Polls the drive that is shown.
    pub(super) fn watch(&mut self, services: &mut Services) {
        if self.watched != self.drive()
            && self.session.is_ready()
            && self.submit(HiperdriveJob::Watch(self.drive()), services)
        {
            self.watched = self.drive();
        }
    }

    fn tell_end(&self, drive: DriveNumber, ended: Ended, services: &mut Services) {
        let weight = explain::hiperdrive::weight(ended);
        if weight == Severity::Note {
            return;
        }
        let words = explain::hiperdrive::ended(ended, |steps| self.place(drive, steps));
        services.tell(weight, vec![words], Some(&self.session.name()));
    }

    pub(super) fn take_samples_and_frames(&mut self) {
        let Some(line) = &mut self.session.line else { return };
        let (samples, dropped) = line.samples();
        let (frames, missed) = line.frames();
        if dropped > 0 {
            self.record.lose(dropped);
        }
        if !samples.is_empty() {
            self.session.answers();
        }
        for reading in samples {
            self.see(reading);
        }
        if !frames.is_empty() {
            self.session.trace.add(frames, missed, super::trace::meaning);
        }
    }

    /// Where a drive is: recorded where it is the one that is shown.
    fn see(&mut self, reading: crate::device::hiperdrive::Reading) {
        self.take_reading(reading);
        let drive = reading.drive;
        if drive == self.drive() {
            let target = self.moves.sent(drive).map(|sent| sent.target);
            self.record.add(reading, self.ruler(drive), self.speed_scale(drive), target);
        }
    }

    fn take(&mut self, event: Event<Hiperdrive>, services: &mut Services) {
        match event {
            Event::Started(_) | Event::Progress(..) => {}
            Event::Remark(Remark::ControlLost) => {
                self.moves.stop();
                let text = explain::hiperdrive::lost(self.moves.view().lost.as_ref());
                services.tell(Severity::Error, vec![text], Some(&self.session.name()));
            }
            Event::Finished(id, output) => {
                services.job_ends(self.session.id, id, JobEnd::Done);
                self.session.answers();
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => {
                services.job_ends(self.session.id, id, JobEnd::Cancelled);
                self.session.save_to = None;
                let texts = explain::hiperdrive::job(&error);
                let begun = matches!(*error, JobError::Interrupted { .. });
                // As the user wished; what was written until then is to be looked at.
                let severity = if begun { Severity::Warning } else { Severity::Note };
                if self.review.as_ref().is_some_and(Review::is_planning) {
                    self.review = None;
                    services.tell(severity, texts, Some(&self.session.name()));
                } else if self.write_failed(&error, &texts) {
                    services.note(severity, texts, Some(&self.session.name()));
                } else {
                    services.tell(severity, texts, Some(&self.session.name()));
                }
                if begun {
                    self.submit(HiperdriveJob::Survey, services);
                }
            }
            Event::PollFailed(error) => {
                self.moves.stop();
                let texts = explain::hiperdrive::job(&error);
                match explain::hiperdrive::loss(&error) {
                    Some(why) => self.lose(why, services),
                    None => self.session.polling_failed(texts, explain::hiperdrive::is_silence(&error), services),
                }
            }
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn finished(&mut self, output: HiperdriveOutput, services: &mut Services) {
        match output {
            HiperdriveOutput::Hello(identity) => {
                self.session.just_connected = false;
                // What is plugged in may be another since it was read.
                if self.is_another(&identity) || self.survey.is_none() || !self.has_polled {
                    self.submit(HiperdriveJob::Survey, services);
                }
            }
            HiperdriveOutput::Surveyed(survey) => {
                self.take_survey(*survey, services);
                self.submit(HiperdriveJob::Status, services);
            }
            HiperdriveOutput::Status(status) => {
                self.status = Some(*status);
                if !std::mem::replace(&mut self.has_polled, true) {
                    self.poll();
                }
            }
            HiperdriveOutput::Check(lines) => self.check = Some(explain::hiperdrive::check(&lines)),
            HiperdriveOutput::Position(reading) => self.see(reading),
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
            HiperdriveOutput::Saved(profile) => self.saved(*profile, services),
            HiperdriveOutput::Prepared(prepared) if self.is_another(&prepared.identity) => {
                // Exchanged under our address: what was wanted for the one before is not for it.
                self.review = None;
                if !self.is_dirty() {
                    let text = Text::new("session.other_encoder").with("serial", &prepared.identity.serial_number);
                    services.tell(Severity::Warning, vec![text], Some(&self.session.name()));
                }
                self.submit(HiperdriveJob::Survey, services);
            }
            HiperdriveOutput::Prepared(prepared) => self.planned(prepared),
            HiperdriveOutput::Committed(committed) => self.committed(*committed, services),
            HiperdriveOutput::Taken => {
                self.moves.beat();
                self.poll();
                // Somebody else may have set limits and scaling since they were read: nothing moves by the old ones.
                self.is_stale = true;
                self.submit(HiperdriveJob::Survey, services);
            }
            HiperdriveOutput::Given => {
                self.moves.beat();
                self.is_stale = false;
            }
            HiperdriveOutput::Watched(drive) => self.watched = drive,
            // The command line asks for it.
            HiperdriveOutput::Identity(_) => {}
        }
    }

    /// The drive that is shown is asked where it is, unless somebody has chosen another pace.
    fn poll(&mut self) {
        let Some(line) = self.session.line.as_mut().filter(|line| line.polling().is_none()) else { return };
        line.poll(Some(PACE));
        self.record.poll(Some(PACE), true);
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        self.moves.stop();
        let texts = explain::hiperdrive::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.session.id, id, JobEnd::Failed(first.clone()));
        self.session.save_to = None;
        let is_shown = self.write_failed(error, &texts);
        match explain::hiperdrive::loss(error) {
            Some(why) => self.lose(why, services),
            None if explain::hiperdrive::is_silence(error) || self.session.just_connected => {
                self.session.phase = Phase::Silent(first);
                services.log.settle("session.not_connected", Some(&self.session.name()));
                services.note(Severity::Error, texts, Some(&self.session.name()));
            }
            None => {
                self.session.answers();
                match is_shown {
                    true => services.note(Severity::Error, texts, Some(&self.session.name())),
                    false => services.tell(Severity::Error, texts, Some(&self.session.name())),
                }
                if matches!(error, JobError::Interrupted { .. }) {
                    self.submit(HiperdriveJob::Survey, services);
                }
            }
        }
    }
}
