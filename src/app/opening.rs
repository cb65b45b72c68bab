//! Opening links: on a thread, after what holds the wire has let go of it, and in the session that has the wire already.

use crossbeam_channel::{Receiver, Sender, bounded};

use super::action::{Action, Done, OpenFailed, Opened};
use super::hiperface::{self, Encoder, Opening, Phase, Source};
use super::leaving::{Leaver, same_wire};
use super::services::{JobEnd, World};
use super::studio::{SessionId, Studio};
use super::tasks::Wake;
use super::{Severity, Text, explain};
use crate::link::{LinkUrl, TraceEntry};
use crate::protocol::hiperface::{AccessCode, CodeNumber};
use crate::worker::{Ring, Worker};

/// Frames that wait for the window, at most.
const FRAMES: usize = 2_000;

impl Studio {
    /// Opens a link: in the session that has this wire already, else in a new one.
    pub(super) fn open_link(&mut self, url: LinkUrl) {
        let known = |encoder: &&mut Encoder| matches!(&encoder.source, Source::Link(own) if same_wire(own, &url));
        let id = match self.encoders.iter_mut().find(known) {
            Some(encoder) if encoder.is_writing() => {
                self.services.tell(Severity::Warning, vec![Text::new("session.busy")], Some(&encoder.name()));
                self.shown = Some(encoder.id);
                return;
            }
            Some(encoder) => {
                encoder.let_go(JobEnd::Cancelled, &mut self.services);
                encoder.source = Source::Link(url.clone());
                encoder.id
            }
            None => {
                let id = self.new_id();
                self.encoders.push(Encoder::at_link(id, url.clone()));
                id
            }
        };
        self.shown = Some(id);
        self.open_for(id, url);
    }

    pub(super) fn reconnect(&mut self, id: SessionId, url: LinkUrl) {
        let Some(encoder) = self.encoders.iter_mut().find(|encoder| encoder.id == id && !encoder.is_writing()) else {
            return;
        };
        encoder.let_go(JobEnd::Cancelled, &mut self.services);
        self.open_for(id, url);
    }

    /// Another attempt to open a link for a session: from now on only its result counts.
    fn open_for(&mut self, id: SessionId, url: LinkUrl) {
        let attempt = self.new_number();
        let codes = self.services.world.codes.clone();
        let earlier = self.encoder_mut(id).and_then(|encoder| encoder.opening.take()).map(|opening| opening.over);
        let done = move |result| Done::Opened { session: id, attempt, result };
        let over = self.open_task(url, earlier, codes, done);
        if let Some(encoder) = self.encoder_mut(id) {
            encoder.phase = Phase::Opening;
            encoder.opening = Some(Opening { attempt: Some(attempt), over });
        }
    }

    /// Opens a link on a thread, after an earlier attempt and after whoever still holds the wire. What it gives tells by
    /// its end that the wire is free again, or in use.
    pub(super) fn open_task(
        &self,
        url: LinkUrl,
        earlier: Option<Receiver<()>>,
        codes: Vec<(CodeNumber, AccessCode)>,
        done: impl FnOnce(Result<Box<Opened>, Box<OpenFailed>>) -> Done + Send + 'static,
    ) -> Receiver<()> {
        let (turn, over) = bounded(0);
        let (world, wake) = (self.services.world.clone(), self.services.tasks.wake());
        let endings = self.services.endings_on(&url);
        self.services.tasks.run("open", move || {
            if let Some(earlier) = earlier {
                // Nothing is ever sent: it ends, or hangs for ever.
                let _ = earlier.recv_timeout(world.patience.job);
            }
            let free = endings.into_iter().all(|(ending, patience)| ending.wait(patience));
            let result = if free { open(&world, &url, &codes, wake, turn) } else { Err(Box::new(OpenFailed::Held)) };
            Action::Done(done(result))
        });
        over
    }

    pub(super) fn opened(&mut self, session: SessionId, attempt: u32, result: Result<Box<Opened>, Box<OpenFailed>>) {
        let own = |encoder: &&mut Encoder| encoder.id == session && encoder.is_attempt(attempt);
        let Some(encoder) = self.encoders.iter_mut().find(own) else {
            if let Ok(opened) = result {
                self.turn_away(*opened, session);
            }
            return;
        };
        match result {
            Ok(opened) => {
                if let Source::Link(url) = &encoder.source {
                    self.settings.use_link(&hiperface::without_codes(url));
                }
                encoder.connect(*opened, &mut self.services);
            }
            Err(failed) => encoder.lose(explain::open_failed(&failed), &mut self.services),
        }
    }

    /// Nobody wants any more what was opened: its session was closed, or has opened another one since.
    pub(super) fn turn_away(&mut self, opened: Opened, session: SessionId) {
        let Opened { worker, url, turn, .. } = opened;
        self.services.leave(worker, Leaver { session, about: url.to_string(), url, write: None }, Some(turn));
    }
}

fn open(
    world: &World,
    url: &LinkUrl,
    codes: &[(CodeNumber, AccessCode)],
    wake: Wake,
    turn: Sender<()>,
) -> Result<Box<Opened>, Box<OpenFailed>> {
    let began = (world.now)();
    let mut session = (world.open)(url, world.store.clone()).map_err(|error| Box::new(OpenFailed::Link(error)))?;
    for (number, code) in codes {
        session.codes_mut().set(*number, *code);
    }
    let is_virtual = session.is_virtual();
    let trace: Ring<TraceEntry> = Ring::new(FRAMES);
    let (ring, last) = (trace.clone(), WakeAtTheEnd(wake.clone()));
    session.watch(move |entry| {
        let _ = &last;
        ring.push(entry.clone());
    });
    match Worker::spawn(session, wake) {
        Ok(worker) => Ok(Box::new(Opened { worker, trace, is_virtual, began, url: url.clone(), turn })),
        Err(error) => Err(Box::new(OpenFailed::Thread(error.to_string()))),
    }
}

/// Wakes the window when a session's thread is gone, however it ended.
struct WakeAtTheEnd(Wake);

impl Drop for WakeAtTheEnd {
    fn drop(&mut self) {
        (self.0)();
    }
}
