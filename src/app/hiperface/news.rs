//! What the line to an encoder tells: results of jobs, what the encoder says on the way, live samples, and its loss.

use super::act::document_of;
use super::encoder::{Encoder, Phase, Source};
use super::review::ReviewState;
use crate::app::action::Opened;
use crate::app::line::Line;
use crate::app::services::{JobEnd, Services};
use crate::app::{Severity, Text, explain};
use crate::device::hiperface::{Error, Sample};
use crate::profile::hiperface::{HiperfacePlan, Op};
use crate::protocol::hiperface::{AccessCode, CodeNumber, StatusCode};
use crate::worker::hiperface::{Hiperface, HiperfaceJob, HiperfaceOutput, JobError, Remark, SavedProfile, Value};
use crate::worker::{Event, JobId};

impl Encoder {
    /// The link is open: the encoder is read.
    pub(in crate::app) fn connect(&mut self, opened: Opened, services: &mut Services) {
        self.trace.begin(opened.began.clone());
        self.line = Some(Line::new(opened));
        self.phase = Phase::Connected;
        self.curve.forget();
        self.submit(HiperfaceJob::Survey, services);
    }

    /// Takes what has come over the line since the last time.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        while let Some(event) = self.line.as_mut().and_then(Line::next) {
            self.take(event, services);
        }
        self.take_samples_and_frames();
    }

    pub(super) fn take_samples_and_frames(&mut self) {
        let Some(line) = &mut self.line else { return };
        let (samples, dropped) = line.samples();
        let (frames, missed) = line.frames();
        if !samples.is_empty() || dropped > 0 {
            self.curve.add(samples, dropped);
        }
        if !frames.is_empty() {
            let meaning = &mut self.meaning;
            self.trace.add(frames, missed, |entry| meaning.of(entry));
        }
    }

    fn take(&mut self, event: Event<Hiperface>, services: &mut Services) {
        match event {
            Event::Started(_) | Event::Progress(..) => {}
            Event::Remark(Remark::Codes(codes)) => self.announced(codes, services),
            Event::Remark(Remark::Found(_)) => {}
            Event::Finished(id, output) => {
                services.job_ends(self.id, id, JobEnd::Done);
                self.finished(*output, services);
            }
            Event::Failed(id, error) => self.failed(id, &error, services),
            Event::Cancelled(id, error) => self.cancelled(id, &error, services),
            Event::PollFailed(error) => match explain::hiperface::loss(&error) {
                Some(why) => self.lose(why, services),
                None => {
                    let mut texts = vec![Text::new("session.poll_failed")];
                    texts.extend(explain::hiperface::job(&error));
                    services.tell(Severity::Error, texts, Some(&self.name()));
                }
            },
            Event::Lost(error) => self.lose(explain::link(&error), services),
        }
    }

    fn announced(&mut self, codes: Vec<StatusCode>, services: &mut Services) {
        let texts = codes.iter().map(|code| explain::hiperface::status(*code)).collect();
        services.tell(Severity::Warning, texts, Some(&self.name()));
        self.codes.get_or_insert_default().extend(codes);
    }

    fn finished(&mut self, output: HiperfaceOutput, services: &mut Services) {
        match output {
            HiperfaceOutput::Surveyed(survey) => self.take_survey(*survey, services),
            HiperfaceOutput::Identity(identity) => self.identity = Some(identity),
            HiperfaceOutput::Status(codes) => self.codes = Some(codes),
            HiperfaceOutput::Position(reading) => self.curve.add(vec![Sample::Position(reading)], 0),
            HiperfaceOutput::Value(value) => self.take_value(value),
            HiperfaceOutput::Check(lines) => self.check = Some(lines),
            HiperfaceOutput::Reset(codes) => {
                self.codes = Some(codes);
                services.tell(Severity::Good, vec![Text::new("session.restarted")], Some(&self.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::Configured => {
                services.tell(Severity::Good, vec![Text::new("session.configured")], Some(&self.name()));
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::CodeNoted => self.submit(HiperfaceJob::Survey, services),
            HiperfaceOutput::Saved(saved) => self.saved(*saved, services),
            HiperfaceOutput::Prepared(prepared) if self.is_another(&prepared.identity) => {
                // Exchanged behind our adapter: what was edited for the one before is not for it.
                self.review = None;
                self.submit(HiperfaceJob::Survey, services);
            }
            HiperfaceOutput::Prepared(prepared) => {
                if let Some(review) = &mut self.review {
                    review.state = ReviewState::Ready(prepared);
                }
            }
            HiperfaceOutput::Committed(committed) => {
                let mut texts = vec![explain::hiperface::written(&committed.written)];
                if let Some(why) = &committed.logbook_warning {
                    texts.push(explain::logbook(why));
                }
                let severity = if texts.len() > 1 { Severity::Warning } else { Severity::Good };
                services.tell(severity, texts, Some(&self.name()));
                self.staged.forget_steps();
                if let Some(review) = &mut self.review
                    && let ReviewState::Writing(prepared) = &review.state
                {
                    let prepared = prepared.clone();
                    review.state = ReviewState::Done(prepared.clone(), committed);
                    self.follow(&prepared.plan, services);
                }
                self.submit(HiperfaceJob::Survey, services);
            }
            // A search has a session of its own.
            HiperfaceOutput::Found(_) => {}
        }
    }

    /// After a write, the session talks to another address or with other codes: so will the next one. What a position was
    /// before it was set is nowhere but here: the encoder does not tell its offset.
    fn follow(&mut self, plan: &HiperfacePlan, services: &mut Services) {
        for op in &plan.ops {
            match op {
                Op::ChangeCode { number, new, .. } => self.know_code(*number, *new),
                Op::SetAddress { to, .. } => {
                    if let Source::Link(url) = &mut self.source {
                        url.query.set("address", &format!("0x{:02X}", to.byte()));
                    }
                }
                Op::SetPosition { from, to, .. } => {
                    self.position_set = Some((*from, *to));
                    let steps = i64::from(*to) - i64::from(*from);
                    let text = Text::new("session.position_set").with("from", from).with("to", to);
                    services.note(Severity::Note, vec![text.with("steps", format!("{steps:+}"))], Some(&self.name()));
                }
                _ => {}
            }
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
        for (field, number) in &saved.locked {
            let text = Text::new("session.saved_locked").with("field", field).with("number", number);
            services.tell(Severity::Warning, vec![text], Some(&self.name()));
        }
        if let Some(path) = self.save_to.take() {
            self.write_document(path, document_of(saved.profile), services);
        }
    }

    fn failed(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        let texts = explain::hiperface::job(error);
        let first = texts.first().cloned().unwrap_or_else(|| Text::new("session.ended"));
        services.job_ends(self.id, id, JobEnd::Failed(first.clone()));
        if let (Some(crate::profile::hiperface::Item::Analogue(channel)), JobError::Device(Error::Rejected { .. })) =
            (self.asked.take(), error)
        {
            // The encoder has no such channel: that is an answer, and stands where it was asked for.
            self.analogue.insert(channel, Err(first));
            return;
        }
        self.save_to = None;
        let gone = explain::hiperface::loss(error);
        let begun = matches!(error, JobError::Interrupted { .. });
        match &mut self.review {
            Some(review) if matches!(review.state, ReviewState::Planning | ReviewState::Writing(_)) => {
                review.state = ReviewState::Failed { texts: texts.clone(), begun };
                services.note(Severity::Error, texts, Some(&self.name()));
            }
            // That is told below.
            _ if gone.is_some() => {}
            _ => services.tell(Severity::Error, texts, Some(&self.name())),
        }
        if let Some(why) = gone {
            self.lose(why, services);
        } else if begun {
            self.submit(HiperfaceJob::Survey, services);
        }
    }

    fn cancelled(&mut self, id: JobId, error: &JobError, services: &mut Services) {
        services.job_ends(self.id, id, JobEnd::Cancelled);
        self.asked = None;
        self.save_to = None;
        let texts = explain::hiperface::job(error);
        services.tell(Severity::Warning, texts.clone(), Some(&self.name()));
        let begun = matches!(error, JobError::Interrupted { .. });
        if let Some(review) = &mut self.review
            && matches!(review.state, ReviewState::Planning | ReviewState::Writing(_))
        {
            review.state = ReviewState::Failed { texts, begun };
        }
        if begun {
            self.submit(HiperfaceJob::Survey, services);
        }
    }
}
