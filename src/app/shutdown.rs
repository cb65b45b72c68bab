//! Released sessions: their end is still reported, and neither the window nor the connection is free before.

use std::sync::Arc;
use std::time::Duration;

use crossbeam_channel::Sender;

use super::action::{Action, Done};
use super::brakes::Brakes;
use super::services::{JobEnd, Services};
use super::session::{Kind, LastWords};
use super::studio::SessionId;
use super::{Severity, Text};
use crate::link::{LinkUrl, Wire};
use crate::worker::stream::End;
use crate::worker::{Ending, JobId, Worker};

/// Maximum waiting times of closing, and of opening while a connection is still held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GracePeriods {
    /// For drives: they stop and are released.
    pub drives: Duration,
    pub disk: Duration,
    /// For a job that writes nothing.
    pub job: Duration,
    /// For a write: it reaches a point at which it can end, and locks again what it unlocked.
    pub write: Duration,
}

impl Default for GracePeriods {
    fn default() -> Self {
        GracePeriods {
            drives: Brakes::PATIENCE,
            disk: Duration::from_secs(3),
            job: Duration::from_secs(10),
            write: Duration::from_secs(90),
        }
    }
}

/// Session whose thread was released.
pub(crate) struct Leaver {
    /// Its number.
    pub(crate) session: SessionId,
    /// Its name.
    pub(crate) about: String,
    pub(crate) url: LinkUrl,
    /// The write that runs there.
    pub(crate) write: Option<JobId>,
}

/// A session that was let go and has not ended.
pub(super) struct Leaving {
    who: Leaver,
    ending: Arc<dyn Left>,
}

/// Released worker, for any device.
pub(crate) trait Left: Send + Sync {
    /// Returns whether the thread has ended and the wire is free.
    fn is_ended(&self) -> bool;

    /// Waits at most `patience` for the end; returns whether it has come.
    fn wait(&self, patience: Duration) -> bool;

    /// Returns how jobs ended since the last call.
    fn last_words(&self) -> Vec<LastWords>;
}

impl<D: Kind> Left for Ending<D> {
    fn is_ended(&self) -> bool {
        Ending::is_ended(self)
    }

    fn wait(&self, patience: Duration) -> bool {
        Ending::wait(self, patience)
    }

    fn last_words(&self) -> Vec<LastWords> {
        self.events().try_iter().filter_map(|event| D::last_words(&event)).collect()
    }
}

impl Left for End {
    fn is_ended(&self) -> bool {
        self.has_come()
    }

    fn wait(&self, patience: Duration) -> bool {
        End::wait(self, patience)
    }

    fn last_words(&self) -> Vec<LastWords> {
        Vec::new()
    }
}

/// Returns whether two links lead to the same wire.
pub(crate) fn same_wire(one: &LinkUrl, other: &LinkUrl) -> bool {
    one.wire() == other.wire() && one.wire() != Wire::Inside
}

impl Services {
    /// Releases a thread. The next user of the connection gets its turn when `turn` is dropped, at the end.
    pub(crate) fn leave<D: Kind>(&mut self, worker: Worker<D>, who: Leaver, turn: Option<Sender<()>>) {
        self.let_end(Arc::new(worker.end()), who, turn);
    }

    /// Lets a stream go, which belongs to no session.
    pub(crate) fn leave_stream(&mut self, end: End, url: LinkUrl) {
        let who = Leaver { session: SessionId::default(), about: String::new(), url, write: None };
        self.let_end(Arc::new(end), who, None);
    }

    fn let_end(&mut self, ending: Arc<dyn Left>, who: Leaver, turn: Option<Sender<()>>) {
        let (watched, patience) = (ending.clone(), self.patience_with(who.write.is_some()));
        self.tasks.run("leave", move || {
            watched.wait(patience);
            drop(turn);
            Action::Done(Done::Left)
        });
        self.leaving.push(Leaving { who, ending });
    }

    /// Takes the events of sessions that are ending.
    pub(super) fn pump_leaving(&mut self) {
        let mut told = Vec::new();
        self.leaving.retain_mut(|leaving| {
            // In this order: a thread that has ended reports nothing more.
            let ended = leaving.ending.is_ended();
            for end in leaving.ending.last_words() {
                if leaving.who.write == Some(end.job) {
                    leaving.who.write = None;
                    told.push((leaving.who.session, leaving.who.about.clone(), end));
                }
            }
            if ended && let Some(job) = leaving.who.write.take() {
                let why = Text::new("session.ended");
                let end = JobEnd::Failed(why.clone());
                let end = LastWords { job, end, severity: Severity::Error, texts: vec![why] };
                told.push((leaving.who.session, leaving.who.about.clone(), end));
            }
            !ended
        });
        for (session, about, last) in told {
            self.job_ends(session, last.job, last.end);
            self.tell(last.severity, last.texts, Some(&about));
        }
    }

    /// Returns whether an ending session still writes.
    pub(super) fn leaves_writing(&self) -> bool {
        self.leaving.iter().any(|leaving| leaving.who.write.is_some())
    }

    /// Returns the sessions that are ending on the wire of a link, with the time each gets.
    pub(crate) fn endings_on(&self, url: &LinkUrl) -> Vec<(Arc<dyn Left>, Duration)> {
        let own = self.leaving.iter().filter(|leaving| same_wire(&leaving.who.url, url));
        own.map(|leaving| (leaving.ending.clone(), self.patience_with(leaving.who.write.is_some()))).collect()
    }

    fn patience_with(&self, writes: bool) -> Duration {
        if writes { self.world.patience.write } else { self.world.patience.job }
    }
}
