//! What the line to an SSI encoder tells: who the adapter is, words, and its loss.

use super::drafts::Drafts;
use super::encoder::Encoder;
use super::trace;
use crate::app::action::{Attempt, Done, Opened};
use crate::app::line::Line;
use crate::app::services::{JobEnd, Opener, Services, World};
use crate::app::session::{Drafted, Kind, LastWords, Phase};
use crate::app::{Severity, Text, explain};
use crate::device::bridge::AdapterError;
use crate::device::ssi::Identity;
use crate::protocol::ssi::KIND;
use crate::sim::biss::Motor;
use crate::worker::ssi::{JobError, Ssi, SsiJob, SsiOutput};
use crate::worker::{Event, JobId, Session};

impl Kind for Ssi {
    const KIND: &'static str = KIND;
    type Edits = Drafts;
    type Aside = Option<Motor>;

    fn aside(session: &Session<Self>) -> Option<Motor> {
        session.motor()
    }

    fn opener(world: &World) -> &Opener<Self> {
        &world.open_ssi
    }

    fn opened(attempt: Attempt<Self>) -> Done {
        Done::OpenedSsi(attempt)
    }

    fn last_words(event: &Event<Self>) -> Option<LastWords> {
        let (job, end, severity, texts) = match event {
            Event::Finished(job, _) => (job, JobEnd::Done, Severity::Note, vec![Text::new("session.ended")]),
            Event::Cancelled(job, error) => (job, JobEnd::Cancelled, Severity::Warning, explain::ssi::job(error)),
            Event::Failed(job, error) => {
                let texts = explain::ssi::job(error);
                let why = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
                (job, JobEnd::Failed(why), Severity::Error, texts)
            }
            _ => return None,
        };
        Some(LastWords { job: *job, end, severity, texts })
    }

    fn doing(_: &Self::Doing) -> Text {
        Text::new("ssi_job.words")
    }
}

impl Encoder {
    /// The link is open: the adapter is asked who it is.
    pub(in crate::app) fn connect(&mut self, opened: Opened<Ssi>, services: &mut Services) {
        self.let_go(JobEnd::Cancelled, services);
        self.record.begin(&opened.began);
        self.motor = opened.aside.clone();
        self.told = None;
        self.session.take_line(opened, services);
        if !self.session.drafting.has_looked() {
            self.load_draft(services);
        }
        self.submit(SsiJob::Hello, services);
    }

    /// Takes what has come over the line since the last time.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        self.take_samples_and_frames();
        while let Some(event) = self.session.line.as_mut().and_then(Line::next) {
            self.take(event, services);
        }
        if self.session.line.as_ref().is_some_and(Line::is_dead) {
            self.lose(Text::new("session.ended"), services);
        }
        self.tell_asking(services);
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
            self.session.trace.add(frames, missed, trace::meaning);
        }
    }

    /// The layout has other clocks, or is read otherwise, than the adapter was told.
    fn tell_asking(&mut self, services: &mut Services) {
        let asking = self.asking();
        // Once it has said who it is, and nothing else runs; what it refused is not asked again.
        if self.identity.is_some() && self.session.is_ready() && self.told != Some(asking) {
            self.told = Some(asking);
            self.submit(SsiJob::Set(asking), services);
        }
    }

    fn take(&mut self, event: Event<Ssi>, services: &mut Services) {
        match event {
            Event::Started(_) => {}
            Event::Progress(..) => {}
            Event::Remark(remark) => match remark {},
            Event::Finished(id, output) => {
                services.job_ends(self.session.id, id, JobEnd::Done);
                self.session.answers();
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => {
                services.job_ends(self.session.id, id, JobEnd::Cancelled);
                services.tell(Severity::Warning, explain::ssi::job(&error), Some(&self.session.name()));
            }
            Event::PollFailed(error) => {
                let texts = explain::ssi::job(&error);
                match explain::ssi::loss(&error) {
                    Some(why) => self.lose(why, services),
                    None => self.session.polling_failed(texts, is_silence(&error), services),
                }
            }
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn finished(&mut self, output: SsiOutput, services: &mut Services) {
        match output {
            SsiOutput::Hello(identity) => {
                self.told = Some(identity.asking);
                self.take_identity(*identity, services);
                self.see_a_word(services);
            }
            SsiOutput::Set(identity) => {
                self.identity = Some(*identity);
                self.see_a_word(services);
            }
            SsiOutput::Read(words) => self.record.add(vec![words], 0),
            SsiOutput::Check(lines) => self.check = Some(explain::ssi::check(&lines)),
        }
    }

    /// What comes like this is to be seen, unless it comes anyway.
    fn see_a_word(&mut self, services: &mut Services) {
        if !self.session.is_polling() {
            self.submit(SsiJob::Read, services);
        }
    }

    fn take_identity(&mut self, identity: Identity, services: &mut Services) {
        let fresh = std::mem::take(&mut self.session.just_connected);
        self.name_after_family();
        if fresh {
            let hello = &identity.hello;
            let adapter = Text::new("log.adapter")
                .with("name", &hello.name)
                .with("firmware", &hello.firmware)
                .with("serial", &hello.serial);
            self.session.log_answer(vec![adapter], services);
        }
        self.identity = Some(identity);
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = explain::ssi::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.session.id, id, JobEnd::Failed(first.clone()));
        match explain::ssi::loss(error) {
            Some(why) => self.lose(why, services),
            None if is_silence(error) || self.session.just_connected => {
                self.session.phase = Phase::Silent(first);
                services.log.settle("session.not_connected", Some(&self.session.name()));
                services.note(Severity::Error, texts, Some(&self.session.name()));
            }
            None => {
                self.session.answers();
                services.tell(Severity::Error, texts, Some(&self.session.name()));
            }
        }
    }
}

/// The link is open, and the adapter does not answer.
fn is_silence(error: &JobError) -> bool {
    matches!(error, JobError::Adapter(AdapterError::Silent | AdapterError::Mute))
}
