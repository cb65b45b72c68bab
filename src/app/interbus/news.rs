//! What the line to an encoder tells: results of jobs, live words, and its loss.

use super::drafts::Edits;
use super::encoder::Encoder;
use super::review::Review;
use super::trace::Meaning;
use crate::app::action::{Attempt, Done, Opened};
use crate::app::line::Line;
use crate::app::review::told;
use crate::app::services::{JobEnd, Opener, Services, World};
use crate::app::session::{Kind, LastWords, Phase};
use crate::app::{Severity, Text, explain};
use crate::protocol::interbus::KIND;
use crate::sim::Motor;
use crate::worker::interbus::{Doing, Interbus, InterbusJob, InterbusOutput, JobError, Remark};
use crate::worker::{Event, JobId, Session};

impl Kind for Interbus {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type Aside = Option<Motor>;

    fn aside(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn opener(world: &World) -> &Opener<Self> {
        &world.open_interbus
    }

    fn opened(attempt: Attempt<Self>) -> Done {
        Done::OpenedInterbus(attempt)
    }

    fn last_words(event: &Event<Self>) -> Option<LastWords> {
        let (job, end, severity, texts) = match event {
            Event::Finished(job, output) => match &**output {
                InterbusOutput::Committed(committed) => {
                    let (severity, texts) = told::<Interbus>(committed);
                    (job, JobEnd::Done, severity, texts)
                }
                _ => (job, JobEnd::Done, Severity::Note, vec![Text::new("session.ended")]),
            },
            Event::Cancelled(job, error) => (job, JobEnd::Cancelled, Severity::Warning, explain::interbus::job(error)),
            Event::Failed(job, error) => {
                let texts = explain::interbus::job(error);
                let why = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
                (job, JobEnd::Failed(why), Severity::Error, texts)
            }
            _ => return None,
        };
        Some(LastWords { job: *job, end, severity, texts })
    }

    fn doing(what: &Doing) -> Text {
        explain::interbus::doing(what)
    }
}

impl Encoder {
    /// The link is open: the word that comes is read, and nothing that a machine would notice is done.
    pub(in crate::app) fn connect(&mut self, opened: Opened<Interbus>, services: &mut Services) {
        self.let_go(JobEnd::Cancelled, services);
        self.record.begin(&opened.began);
        self.motor = opened.aside.clone();
        self.trace = Meaning::new(self.order());
        self.session.take_line(opened, services);
        self.submit(InterbusJob::Hello, services);
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
        self.trace.shift = self.shift();
        let Some(line) = &mut self.session.line else { return };
        let (samples, dropped) = line.samples();
        let (frames, missed) = line.frames();
        if !samples.is_empty() || dropped > 0 {
            if let Some(image) = self.staged.device() {
                self.preview.follow(&image.programs);
            }
            samples.iter().for_each(|reading| self.preview.compare(reading));
            self.record.add(samples, dropped);
            self.session.answers();
        }
        if !frames.is_empty() {
            let trace = &mut self.trace;
            self.session.trace.add(frames, missed, |entry| trace.of(entry));
        }
    }

    fn take(&mut self, event: Event<Interbus>, services: &mut Services) {
        match event {
            Event::Started(_) => {}
            Event::Progress(..) => {}
            Event::Remark(Remark::Handshake(step)) => self.shake(step),
            Event::Finished(id, output) => {
                services.job_ends(self.session.id, id, JobEnd::Done);
                self.session.answers();
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => {
                services.job_ends(self.session.id, id, JobEnd::Cancelled);
                self.session.save_to = None;
                let texts = explain::interbus::job(&error);
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
                    self.submit(InterbusJob::Survey, services);
                }
            }
            Event::PollFailed(error) => {
                let texts = explain::interbus::job(&error);
                match explain::interbus::loss(&error) {
                    Some(why) => self.lose(why, services),
                    None => self.session.polling_failed(texts, is_silence(&error), services),
                }
            }
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn finished(&mut self, output: InterbusOutput, services: &mut Services) {
        match output {
            InterbusOutput::Hello(reading) => {
                if std::mem::take(&mut self.session.just_connected) {
                    let word = Text::new("log.interbus_word").with("word", format!("0x{:08X}", reading.word));
                    self.session.log_answer(vec![word], services);
                }
                self.record.glimpse(reading);
                self.read_on(services);
            }
            InterbusOutput::Surveyed(survey) => {
                self.take_survey(*survey, services);
                let programs = std::mem::take(&mut self.read_after);
                if !programs.is_empty() {
                    self.submit(InterbusJob::Programs(programs), services);
                } else if !self.read_on(services) {
                    self.see_a_word(services);
                }
            }
            InterbusOutput::Programs(programs, shift) => {
                self.staged.refresh_programs(&programs, Some(shift));
                self.see_a_word(services);
            }
            InterbusOutput::Position(reading) => self.record.add(vec![reading], 0),
            InterbusOutput::ReadOut(what, value) => {
                self.read_outs.insert(what.number(), value);
            }
            InterbusOutput::Selected(mode) | InterbusOutput::LedBack(mode) => {
                if let Some(survey) = &mut self.survey {
                    survey.identity.mode = mode;
                }
                self.see_a_word(services);
            }
            InterbusOutput::Check(lines) => self.check = Some(explain::interbus::check(&lines)),
            InterbusOutput::Saved(profile) => self.saved(*profile, services),
            InterbusOutput::Prepared(prepared) if self.is_another(&prepared.identity) => {
                // Exchanged behind our gateway: what was wanted for the one before is not for it.
                self.review = None;
                if !self.is_dirty() {
                    let text = Text::new("session.other_encoder").with("serial", &prepared.identity.serial_number);
                    services.tell(Severity::Warning, vec![text], Some(&self.session.name()));
                }
                self.submit(InterbusJob::Survey, services);
            }
            InterbusOutput::Prepared(prepared) => self.planned(prepared),
            InterbusOutput::Committed(committed) => self.committed(*committed, services),
            // The command line asks for these.
            InterbusOutput::Identity(_) | InterbusOutput::Status(_) | InterbusOutput::Item(_) => {}
        }
    }

    /// What comes is to be seen with what is known by now, unless it comes anyway.
    fn see_a_word(&mut self, services: &mut Services) {
        if !self.session.is_polling() {
            self.submit(InterbusJob::Position, services);
        }
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = explain::interbus::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.session.id, id, JobEnd::Failed(first.clone()));
        self.session.save_to = None;
        let is_shown = self.write_failed(error, &texts);
        match explain::interbus::loss(error) {
            Some(why) => self.lose(why, services),
            None if is_silence(error) || self.session.just_connected => {
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
                    self.submit(InterbusJob::Survey, services);
                }
            }
        }
    }
}

/// The link is open, and the gateway does not answer.
fn is_silence(error: &JobError) -> bool {
    explain::interbus::is_silence(error)
}
