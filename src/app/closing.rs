//! Closing a session or the window: what would be lost or cut off is asked about once, and waited for.

use super::Text;
use super::action::{Action, Done, Question, Then, Waited};
use super::hiperface::{Encoder, Source};
use super::recorder;
use super::services::JobEnd;
use super::studio::{SessionId, Studio};

/// Nanoseconds of a recording that nobody wants to lose by a click.
pub(super) const MUCH: i64 = 120_000_000_000;

impl Studio {
    /// The window may close now: nothing runs any more, not even in sessions that were let go, and what is to be kept is
    /// on disk; or it has had time enough.
    pub fn may_close(&self) -> bool {
        let services = &self.services;
        let drafts = services.drafts_on_their_way == 0 && self.encoders.iter().all(Encoder::is_draft_kept);
        let writes = services.leaves_writing() || self.encoders.iter().any(Encoder::is_writing);
        let runs = !services.leaving.is_empty() || self.encoders.iter().any(Encoder::is_busy);
        let over = |what, done: bool| done || self.waited.is_some_and(|waited| waited >= what);
        self.closing
            && over(Waited::Writes, !writes)
            && over(Waited::Jobs, !runs)
            && over(Waited::Disk, drafts && self.keeper.is_idle())
    }

    pub(super) fn close_session(&mut self, id: SessionId) {
        let Some(encoder) = self.encoder_mut(id) else { return };
        if encoder.is_busy() || encoder.staged.is_dirty() {
            let text = match (&encoder.source, encoder.staged.is_dirty() && !encoder.keeps_edits()) {
                (_, true) => "question.session_lost",
                _ if encoder.is_busy() => "question.session_busy",
                (Source::Link(_), false) => "question.session_edits",
                (Source::File { .. }, false) => "question.profile_edits",
            };
            let text = Text::new(text).with("name", encoder.name());
            let confirm = Text::new("question.close_session");
            self.question = Some(Question { text, confirm, then: Then::CloseSession(id) });
        } else {
            self.remove(id);
        }
    }

    fn remove(&mut self, id: SessionId) {
        self.with_encoder(id, |encoder, services| {
            encoder.leave_draft(services);
            encoder.let_go(JobEnd::Cancelled, services);
        });
        self.encoders.retain(|encoder| encoder.id != id);
        if self.shown == Some(id) {
            self.shown = self.encoders.last().map(|encoder| encoder.id);
        }
    }

    pub(super) fn close(&mut self) {
        let busy = self.encoders.iter().any(Encoder::is_busy);
        let edits = self.encoders.iter().any(|encoder| encoder.staged.is_dirty());
        let recorded = self.encoders.iter().any(|encoder| encoder.record.recorder.unsaved() >= MUCH);
        if busy || edits || recorded {
            let lost = |encoder: &Encoder| encoder.staged.is_dirty() && !encoder.keeps_edits();
            let text = match self.encoders.iter().find(|encoder| lost(encoder)) {
                Some(encoder) => Text::new("question.session_lost").with("name", encoder.name()),
                None if busy => Text::new("question.busy"),
                None => Text::new(if edits { "question.edits" } else { "question.recording" }),
            };
            let confirm = Text::new("question.close_window");
            self.question = Some(Question { text, confirm, then: Then::CloseWindow });
        } else {
            self.begin_to_close();
        }
    }

    fn begin_to_close(&mut self) {
        if std::mem::replace(&mut self.closing, true) {
            return;
        }
        let patience = self.services.world.patience;
        let limits = [(Waited::Disk, patience.disk), (Waited::Jobs, patience.job), (Waited::Writes, patience.write)];
        for (what, limit) in limits {
            self.services.tasks.run("close", move || {
                std::thread::sleep(limit);
                Action::Done(Done::Waited(what))
            });
        }
    }

    pub(super) fn confirm(&mut self) {
        match self.question.take().map(|question| question.then) {
            Some(Then::CloseWindow) => {
                self.stop();
                self.begin_to_close();
            }
            Some(Then::CloseSession(id)) => self.remove(id),
            Some(Then::Write(question, path)) => self.chosen(question, path),
            Some(Then::Forget(desk)) => self.act_recorder(desk, recorder::Action::Clear),
            None => {}
        }
    }
}
