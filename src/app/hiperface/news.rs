//! What the line to an encoder tells: results of jobs, what the encoder says on the way, live samples, and its loss.

use super::act::document_of;
use super::drafts::Edits;
use super::encoder::Encoder;
use super::review::ReviewState;
use super::rules;
use crate::app::action::{Attempt, Done, Opened};
use crate::app::line::Line;
use crate::app::review::told;
use crate::app::services::{JobEnd, Opener, Services, World};
use crate::app::session::{Kind, LastWords, Phase, Source};
use crate::app::{Severity, Text, explain};
use crate::device::hiperface::{Error, Sample, Station};
use crate::profile::hiperface::Op;
use crate::protocol::hiperface::{AccessCode, CodeNumber, KIND, StatusCode};
use crate::worker::hiperface::{
    Doing, Hiperface, HiperfaceJob, HiperfaceOutput, JobError, Remark, SavedProfile, Value,
};
use crate::worker::{Event, JobId, Session};

impl Kind for Hiperface {
    const KIND: &'static str = KIND;
    type Edits = Edits;
    type Aside = ();

    fn aside(_session: &Session<Self>) {}

    fn opener(world: &World) -> &Opener<Self> {
        &world.open_hiperface
    }

    fn opened(attempt: Attempt<Self>) -> Done {
        Done::OpenedHiperface(attempt)
    }

    fn last_words(event: &Event<Self>) -> Option<LastWords> {
        last_words(event)
    }

    fn doing(what: &Doing) -> Text {
        explain::hiperface::doing(what)
    }
}

impl Encoder {
    /// The link is open: the encoder is read.
    pub(in crate::app) fn connect(&mut self, opened: Opened<Hiperface>, services: &mut Services) {
        self.let_go(JobEnd::Cancelled, services);
        self.record.begin(&opened.began);
        self.session.take_line(opened, services);
        self.wish_watched();
        self.codes_due.clear();
        self.tried_code = None;
        self.read_encoder(services);
    }

    /// Reads the encoder. After connecting, who is there comes before the access codes: they are for one encoder and no
    /// other.
    pub(super) fn read_encoder(&mut self, services: &mut Services) {
        let identify = self.session.just_connected && !self.access_codes.is_empty();
        self.submit(if identify { HiperfaceJob::Identify } else { HiperfaceJob::Survey }, services);
    }

    /// Gives the session the next access code of the encoder that is connected again; after the last it is read.
    fn give_codes(&mut self, services: &mut Services) {
        match self.codes_due.pop() {
            Some((number, code)) => self.submit(HiperfaceJob::UseCode { number, code }, services),
            None => self.submit(HiperfaceJob::Survey, services),
        }
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
            self.add_samples(samples, dropped);
            self.session.answers();
        }
        if !frames.is_empty() {
            let meaning = &mut self.meaning;
            self.session.trace.add(frames, missed, |entry| meaning.of(entry));
        }
    }

    fn take(&mut self, event: Event<Hiperface>, services: &mut Services) {
        match event {
            Event::Started(_) | Event::Progress(..) => {}
            Event::Remark(Remark::Codes(codes)) => self.announced(codes, services),
            Event::Remark(Remark::Found(_)) => {}
            Event::Finished(id, output) => {
                services.job_ends(self.session.id, id, JobEnd::Done);
                if !matches!(*output, HiperfaceOutput::CodeNoted) {
                    self.session.answers();
                }
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => self.cancelled(id, &error, services),
            Event::PollFailed(error) => match explain::hiperface::loss(&error) {
                Some(why) => self.lose(why, services),
                None => {
                    let is_silent = self.is_silence(&error);
                    self.session.polling_failed(explain::hiperface::job(&error), is_silent, services);
                }
            },
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn announced(&mut self, codes: Vec<StatusCode>, services: &mut Services) {
        let texts = codes.iter().map(|code| explain::hiperface::status(*code)).collect();
        services.tell(Severity::Warning, texts, Some(&self.session.name()));
        self.codes.get_or_insert_default().extend(codes);
    }

    fn finished(&mut self, output: HiperfaceOutput, services: &mut Services) {
        match output {
            HiperfaceOutput::Surveyed(survey) => self.take_survey(*survey, services),
            HiperfaceOutput::Identity(identity) => {
                let proven = !identity.serial.serial_number.is_empty() && !self.is_another(&identity);
                if proven {
                    self.codes_due.clone_from(&self.access_codes);
                } else {
                    self.access_codes.clear();
                }
                self.give_codes(services);
            }
            HiperfaceOutput::Status(codes) => self.codes = Some(codes),
            HiperfaceOutput::Position(reading) => self.add_samples(vec![Sample::Position(reading)], 0),
            HiperfaceOutput::Rest(rest) => self.take_rest(rest),
            HiperfaceOutput::Value(value) => self.take_value(value),
            HiperfaceOutput::Check(lines) => {
                self.check = Some(lines);
                self.follow_settings();
            }
            HiperfaceOutput::Reset(codes) => {
                self.codes = Some(codes);
                self.follow_settings();
                services.tell(Severity::Good, vec![Text::new("session.restarted")], Some(&self.session.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::Configured => {
                self.follow_settings();
                services.tell(Severity::Good, vec![Text::new("session.configured")], Some(&self.session.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::CodeNoted => self.give_codes(services),
            HiperfaceOutput::Saved(saved) => self.saved(*saved, services),
            HiperfaceOutput::Prepared(prepared) if self.is_another(&prepared.identity) => {
                // Exchanged behind our adapter: what was edited for the one before is not for it.
                self.review = None;
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::Prepared(prepared) => {
                let allowed = rules::keeps_edits(&self.staged, &prepared.plan);
                if let Some(review) = &mut self.review {
                    review.state = match allowed {
                        Ok(()) => ReviewState::Ready(prepared),
                        Err(why) => ReviewState::Failed { texts: vec![why], begun: false },
                    };
                }
            }
            HiperfaceOutput::Committed(committed) => {
                let (severity, texts) = told::<Hiperface>(&committed);
                services.tell(severity, texts, Some(&self.session.name()));
                self.staged.forget_steps();
                if let Some(review) = &mut self.review
                    && let ReviewState::Writing(prepared) = &review.state
                {
                    let prepared = prepared.clone();
                    review.state = ReviewState::Done(prepared.clone(), committed);
                    self.follow(&prepared.plan.ops, services);
                }
                self.submit(HiperfaceJob::Survey, services);
            }
            // A search has a session of its own.
            HiperfaceOutput::Found(_) => {}
        }
    }

    /// After a write, the session talks to another address or with other codes: so will the next one. What a position was
    /// before it was set is nowhere but here: the encoder does not tell its offset.
    fn follow(&mut self, ops: &[Op], services: &mut Services) {
        for op in ops {
            match op {
                Op::ChangeCode { number, new, .. } => self.know_code(*number, *new),
                Op::SetAddress { to, .. } => {
                    if let Source::Link(url) = &mut self.session.source {
                        url.query.set("address", &format!("0x{:02X}", to.byte()));
                    }
                }
                Op::SetPosition { from, to, .. } => {
                    self.position_set = Some((*from, *to));
                    // They were read from another zero.
                    self.commutation.forget_readings();
                    let steps = i64::from(*to) - i64::from(*from);
                    let text = Text::new("session.position_set").with("from", from).with("to", to);
                    services.note(
                        Severity::Note,
                        vec![text.with("steps", format!("{steps:+}"))],
                        Some(&self.session.name()),
                    );
                }
                _ => {}
            }
        }
    }

    /// The encoder talks by now as the job was to bring about, so the next session begins like that.
    fn follow_settings(&mut self) {
        let Some(settings) = self.settings_then.take() else { return };
        let (Source::Link(url), Some(format)) = (&mut self.session.source, settings.format()) else { return };
        let Ok(now) = Station::from_query(&url.query, std::time::Duration::ZERO) else { return };
        if now.format.baud != format.baud {
            url.query.set("baud", &format.baud.to_string());
        }
        if now.format.parity != format.parity {
            url.query.set("parity", format.parity.word());
        }
        if now.long_timeout != settings.long_timeout() {
            url.query.set("timeout", if settings.long_timeout() { "44" } else { "11" });
        }
    }

    pub(super) fn know_code(&mut self, number: CodeNumber, code: AccessCode) {
        self.access_codes.retain(|(own, _)| *own != number);
        self.access_codes.push((number, code));
    }

    fn take_value(&mut self, value: Value) {
        match (value, self.asked.take()) {
            (Value::Analogue { value, limit }, Some(crate::profile::hiperface::Item::Analogue(channel))) => {
                self.analogue.insert(channel, Ok((value, limit)));
            }
            (Value::Number(number), Some(crate::profile::hiperface::Item::Counter)) => {
                self.counter = u32::try_from(number).ok();
            }
            _ => {}
        }
    }

    fn saved(&mut self, saved: SavedProfile, services: &mut Services) {
        let Some(path) = self.session.save_to.take() else { return };
        let mut remarks = Vec::new();
        // The profile holds what the encoder has.
        let edits = self.staged.edits().count();
        if edits > 0 {
            remarks.push(Text::new("session.saved_without").with("count", edits));
        }
        let locked = saved.locked.iter();
        remarks.extend(
            locked.map(|(field, number)| Text::new("session.saved_locked").with("field", field).with("number", number)),
        );
        self.session.write_document(path, document_of(saved.profile), remarks, services);
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = explain::hiperface::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.session.id, id, JobEnd::Failed(first.clone()));
        let stands_there = self.rest_failed(&first);
        if let (Some(crate::profile::hiperface::Item::Analogue(channel)), JobError::Device(Error::Rejected { .. })) =
            (self.asked.take(), error)
        {
            // The encoder has no such channel: that is an answer, and stands where it was asked for.
            self.analogue.insert(channel, Err(first));
            self.session.answers();
            return;
        }
        self.session.save_to = None;
        let gone = explain::hiperface::loss(error);
        let begun = matches!(error, JobError::Interrupted { .. });
        self.follow_what_was_done(error, services);
        let silent = gone.is_none() && self.is_silence(error);
        let garbled = matches!(error, JobError::Device(Error::Damaged { .. } | Error::NeverSilent));
        if gone.is_none() && !silent && !garbled {
            self.session.answers();
        }
        if silent {
            self.session.phase = Phase::Silent(first.clone());
            services.log.settle("session.not_connected", Some(&self.session.name()));
        }
        match &mut self.review {
            Some(review) if matches!(review.state, ReviewState::Planning | ReviewState::Writing(_)) => {
                review.state = ReviewState::Failed { texts: texts.clone(), begun };
                services.note(Severity::Error, texts, Some(&self.session.name()));
            }
            // That is told below.
            _ if gone.is_some() => {}
            // It stands where the session is shown.
            _ if silent || stands_there => services.note(Severity::Error, texts, Some(&self.session.name())),
            _ => services.tell(Severity::Error, texts, Some(&self.session.name())),
        }
        if let Some(why) = gone {
            self.lose(why, services);
        } else if begun && !silent {
            self.submit(HiperfaceJob::Survey, services);
        }
    }

    /// The link is open and the encoder does not answer; or nothing has been read at all since it was opened, because what
    /// comes makes no sense.
    fn is_silence(&self, error: &JobError) -> bool {
        let cause = match error {
            JobError::Device(cause) => cause,
            JobError::Interrupted { interrupted, .. } => &interrupted.cause,
            _ => return false,
        };
        cause.is_lost() || (self.session.just_connected && matches!(cause, Error::Damaged { .. } | Error::NeverSilent))
    }

    /// After a write that ended early, the session follows those operations that were carried out.
    fn follow_what_was_done(&mut self, error: &JobError, services: &mut Services) {
        let JobError::Interrupted { interrupted, .. } = error else { return };
        let Some(ReviewState::Writing(prepared)) = self.review.as_ref().map(|review| &review.state) else { return };
        let done: Vec<Op> = prepared.plan.ops.iter().take(interrupted.done.ops).cloned().collect();
        self.follow(&done, services);
    }

    fn cancelled(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        services.job_ends(self.session.id, id, JobEnd::Cancelled);
        self.follow_what_was_done(error, services);
        self.asked = None;
        self.give_up_rest();
        self.session.save_to = None;
        let texts = explain::hiperface::job(error);
        let begun = matches!(error, JobError::Interrupted { .. });
        // As the user wished; what was written until then is to be looked at.
        let severity = if begun { Severity::Warning } else { Severity::Note };
        services.tell(severity, texts.clone(), Some(&self.session.name()));
        if self.review.as_ref().is_some_and(|review| matches!(review.state, ReviewState::Planning)) {
            self.review = None;
        }
        if let Some(review) = &mut self.review
            && review.is_writing()
        {
            review.state = ReviewState::Failed { texts, begun };
        }
        if begun {
            self.submit(HiperfaceJob::Survey, services);
        }
    }
}

/// What an event of a session that was let go says about the end of its job.
fn last_words(event: &Event<Hiperface>) -> Option<LastWords> {
    let (job, end, (severity, texts)) = match event {
        Event::Finished(job, output) => match &**output {
            HiperfaceOutput::Committed(committed) => (job, JobEnd::Done, told::<Hiperface>(committed)),
            _ => (job, JobEnd::Done, (Severity::Note, vec![Text::new("session.ended")])),
        },
        Event::Cancelled(job, error) => (job, JobEnd::Cancelled, (Severity::Warning, explain::hiperface::job(error))),
        Event::Failed(job, error) => {
            let texts = explain::hiperface::job(error);
            let why = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
            (job, JobEnd::Failed(why), (Severity::Error, texts))
        }
        _ => return None,
    };
    Some(LastWords { job: *job, end, severity, texts })
}
