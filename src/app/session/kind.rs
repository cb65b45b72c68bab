//! What a kind of device tells the studio of its types, so that opening, leaving and running are the same for all.

use crate::app::action::{Attempt, Done};
use crate::app::services::{JobEnd, Opener, World};
use crate::app::session::DraftEdits;
use crate::app::{Severity, Text};
use crate::worker::{Device, Event, JobId, Session};

/// A kind of device on the desk.
pub trait Kind: Device + Sized {
    /// Its name in profiles.
    const KIND: &'static str;

    /// What is kept of its edits over a crash.
    type Edits: DraftEdits;

    /// What is kept of a session beside its thread.
    type Aside: Send;

    /// Takes that before the session goes to its thread.
    fn aside(session: &Session<Self>) -> Self::Aside;

    /// Opens links to such devices.
    fn opener(world: &World) -> &Opener<Self>;

    /// What a task that opened a link, or could not, comes back with.
    fn opened(attempt: Attempt<Self>) -> Done;

    /// What an event of a session that was let go says about the end of its job.
    fn last_words(event: &Event<Self>) -> Option<LastWords>;

    /// A step of a job in words.
    fn doing(what: &Self::Doing) -> Text;
}

/// How the last job of a session that was let go ended.
pub struct LastWords {
    pub(in crate::app) job: JobId,
    pub(in crate::app) end: JobEnd,
    pub(in crate::app) severity: Severity,
    pub(in crate::app) texts: Vec<Text>,
}
