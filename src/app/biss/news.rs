//! What the line to an encoder tells: results of jobs, live samples, and its loss.

use super::drafts::Edits;
use super::encoder::Encoder;
use super::review::Review;
use crate::app::action::{Attempt, Done, Opened};
use crate::app::line::Line;
use crate::app::review::told;
use crate::app::services::{JobEnd, Opener, Services, World};
use crate::app::session::{Kind, LastWords, Phase};
use crate::app::{Severity, Text, explain};
use crate::device::biss::Error;
use crate::protocol::biss::KIND;
use crate::sim::biss::Motor;
use crate::worker::biss::{Biss, BissJob, BissOutput, Doing, JobError, Remark};
use crate::worker::{Event, JobId, Session};

impl Kind for Biss {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type Aside = Option<Motor>;

    fn aside(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn opener(world: &World) -> &Opener<Self> {
        &world.open_biss
    }

    fn opened(attempt: Attempt<Self>) -> Done {
        Done::OpenedBiss(attempt)
    }

    fn last_words(event: &Event<Self>) -> Option<LastWords> {
        let (job, end, severity, texts) = match event {
            Event::Finished(job, output) => match &**output {
                BissOutput::Committed(committed) => {
                    let (severity, texts) = told::<Biss>(committed);
                    (job, JobEnd::Done, severity, texts)
                }
                _ => (job, JobEnd::Done, Severity::Note, vec![Text::new("session.ended")]),
            },
            Event::Cancelled(job, error) => (job, JobEnd::Cancelled, Severity::Warning, explain::biss::job(error)),
            Event::Failed(job, error) => {
                let texts = explain::biss::job(error);
                let why = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
                (job, JobEnd::Failed(why), Severity::Error, texts)
            }
            _ => return None,
        };
        Some(LastWords { job: *job, end, severity, texts })
    }

    fn doing(what: &Doing) -> Text {
        explain::biss::doing(what)
    }
}

impl Encoder {
    /// The link is open: the encoder is read.
    pub(in crate::app) fn connect(&mut self, opened: Opened<Biss>, services: &mut Services) {
        self.let_go(JobEnd::Cancelled, services);
        self.record.begin(&opened.began);
        self.motor = opened.aside.clone();
        self.session.take_line(opened, services);
        self.wish_watched();
        self.submit(BissJob::Survey, services);
    }

    /// Takes what has come over the line since the last time.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        // What was sampled before a job comes before what the job says; what was sampled after it comes the next time.
        self.take_samples_and_frames();
        while let Some(event) = self.session.line.as_mut().and_then(Line::next) {
            self.take(event, services);
        }
        if self.session.line.as_ref().is_some_and(Line::is_dead) {
            self.lose(Text::new("session.ended"), services);
        }
    }

    pub(super) fn take_samples_and_frames(&mut self) {
        let Some(line) = &mut self.session.line else { return };
        let (samples, dropped) = line.samples();
        let (frames, missed) = line.frames();
        if !samples.is_empty() || dropped > 0 {
            self.record.add(samples, dropped);
            self.session.answers();
        }
        if !frames.is_empty() {
            let meaning = &mut self.meaning;
            self.session.trace.add(frames, missed, |entry| meaning.of(entry));
        }
    }

    fn take(&mut self, event: Event<Biss>, services: &mut Services) {
        match event {
            Event::Started(_) => {}
            Event::Progress(_, progress) => {
                let running = self.guide.as_mut().filter(|guide| guide.is_running());
                if let (Doing::Operation { news, .. }, Some(guide)) = (progress.what, running) {
                    guide.tell(*news);
                }
            }
            Event::Remark(Remark::CrcErrors(count)) => self.record.add_crc_errors(count),
            Event::Remark(remark) => services.tell(Severity::Warning, explain::biss::remark(&remark), None),
            Event::Finished(id, output) => {
                services.job_ends(self.session.id, id, JobEnd::Done);
                self.session.answers();
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => {
                services.job_ends(self.session.id, id, JobEnd::Cancelled);
                self.session.save_to = None;
                let texts = explain::biss::job(&error);
                let begun = matches!(*error, JobError::Interrupted { .. });
                // As the user wished; what was written until then is to be looked at.
                let severity = if begun { Severity::Warning } else { Severity::Note };
                if self.review.as_ref().is_some_and(Review::is_planning) {
                    self.review = None;
                }
                if self.write_failed(&error, &texts) {
                    services.note(severity, texts, Some(&self.session.name()));
                } else {
                    services.tell(severity, texts, Some(&self.session.name()));
                }
                if begun {
                    self.submit(BissJob::Survey, services);
                }
            }
            Event::PollFailed(error) => match explain::biss::loss(&error) {
                Some(why) => self.lose(why, services),
                None => {
                    let is_silent = is_silence(&error);
                    self.session.polling_failed(explain::biss::job(&error), is_silent, services);
                }
            },
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn finished(&mut self, output: BissOutput, services: &mut Services) {
        match output {
            BissOutput::Surveyed(survey) => {
                self.take_survey(*survey, services);
                self.read_written(services);
            }
            BissOutput::Status(status) => {
                if let Some(position) = status.position {
                    self.record.add_position(position);
                }
                self.status = Some(*status);
            }
            BissOutput::Check(lines) => self.check = Some(explain::biss::check(&lines)),
            BissOutput::Position(reading) => self.record.add_position(reading),
            BissOutput::Registers(read) => {
                self.memory.take(read.start, &read.bytes);
                self.read_written(services);
            }
            BissOutput::Area(banks) => {
                for bank in banks {
                    bank.registers().for_each(|(at, byte)| self.memory.take(at, &[byte]));
                }
            }
            BissOutput::Saved(profile) => self.saved(*profile, services),
            BissOutput::Prepared(prepared) if self.is_another(&prepared.identity) => {
                // Exchanged behind our adapter: what was edited for the one before is not for it.
                self.review = None;
                self.submit(BissJob::Survey, services);
            }
            BissOutput::Prepared(prepared) => self.planned(prepared),
            BissOutput::Committed(committed) => self.committed(*committed, services),
            BissOutput::LedBack(mode) => {
                self.led_back();
                let text = Text::new("guide.led_back").with_text("mode", explain::biss::mode(mode));
                services.tell(Severity::Good, vec![text], Some(&self.session.name()));
                self.submit(BissJob::Survey, services);
            }
            // The survey tells more.
            BissOutput::Identity(_) => {}
        }
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = explain::biss::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.session.id, id, JobEnd::Failed(first.clone()));
        let saves = self.session.save_to.take().is_some();
        let stands_there = self.write_failed(error, &texts);
        let begun = matches!(error, JobError::Interrupted { .. });
        let silent = is_silence(error) || (self.session.just_connected && explain::biss::loss(error).is_none());
        match explain::biss::loss(error) {
            Some(why) => self.lose(why, services),
            None if silent => {
                self.session.phase = Phase::Silent(first);
                services.log.settle("session.not_connected", Some(&self.session.name()));
                services.note(Severity::Error, texts, Some(&self.session.name()));
            }
            None => {
                self.session.answers();
                let moving = matches!(error, JobError::Device(Error::Moving { .. })) && !stands_there && !saves;
                if moving {
                    // It stands on the pages that show data.
                    self.refusal = Some(first);
                }
                if stands_there || moving {
                    services.note(Severity::Error, texts, Some(&self.session.name()));
                } else {
                    services.tell(Severity::Error, texts, Some(&self.session.name()));
                }
                if begun {
                    self.submit(BissJob::Survey, services);
                }
            }
        }
    }

    /// Reads the next of the banks that were written.
    fn read_written(&mut self, services: &mut Services) {
        if let Some(bank) = self.read_after.pop_first() {
            self.submit(BissJob::ReadBank(bank), services);
        }
    }
}

/// The link is open, and the encoder or the adapter does not answer.
fn is_silence(error: &JobError) -> bool {
    let is_lost = match error {
        JobError::Device(cause) => cause.is_lost(),
        JobError::Interrupted { interrupted, .. } => interrupted.cause.is_lost(),
        _ => false,
    };
    is_lost && explain::biss::loss(error).is_none()
}
