//! Opening links: on a thread, after what holds the wire has let go of it, and in the session that has the wire already.

use super::action::{Action, Done, OpenFailed, Opened};
use super::hiperface::{Encoder, Phase, Source};
use super::services::{JobEnd, World};
use super::studio::{SessionId, Studio};
use super::tasks::Wake;
use super::{Severity, Text, explain};
use crate::link::{LinkUrl, TraceEntry};
use crate::protocol::hiperface::{AccessCode, CodeNumber};
use crate::worker::hiperface::Hiperface;
use crate::worker::{Ring, Worker};

/// How long a session may take to let go of its wire.
const PATIENCE: std::time::Duration = std::time::Duration::from_secs(10);
/// Frames that wait for the window, at most.
const FRAMES: usize = 2_000;

impl Studio {
    /// Opens a link: in the session that has this wire already, else in a new one.
    pub(super) fn open_link(&mut self, url: LinkUrl) {
        self.open_link_after(url, None);
    }

    /// Opens a link after `holder`, which holds its wire, has let go of it.
    pub(super) fn open_link_after(&mut self, url: LinkUrl, holder: Option<Worker<Hiperface>>) {
        let same_wire = |encoder: &&mut Encoder| {
            matches!(&encoder.source, Source::Link(own)
                if own.scheme == url.scheme && own.target == url.target && !url.target.is_empty())
        };
        let (id, old) = match self.encoders.iter_mut().find(same_wire) {
            Some(encoder) if encoder.is_writing() => {
                self.services.tell(Severity::Warning, vec![Text::new("session.busy")], Some(&encoder.name()));
                (encoder.id, None)
            }
            Some(encoder) => {
                let old = encoder.let_go(JobEnd::Cancelled, &mut self.services);
                encoder.source = Source::Link(url.clone());
                encoder.phase = Phase::Opening;
                (encoder.id, old)
            }
            None => {
                let id = self.new_id();
                self.encoders.push(Encoder::at_link(id, url.clone()));
                (id, None)
            }
        };
        self.shown = Some(id);
        if self.encoder().is_some_and(|encoder| encoder.phase == Phase::Opening) {
            let codes = self.codes_for(id);
            let old = old.into_iter().chain(holder).collect();
            self.open_task(url, old, codes, move |result| Done::Opened { session: id, result });
        }
    }

    /// Access codes given at the start, and those given for this encoder since.
    fn codes_for(&self, id: SessionId) -> Vec<(CodeNumber, AccessCode)> {
        let own = self.encoders.iter().find(|encoder| encoder.id == id).map(Encoder::access_codes);
        self.services.world.codes.iter().chain(own.unwrap_or_default()).copied().collect()
    }

    /// Opens a link on a thread, after what holds the wire has let go of it.
    pub(super) fn open_task(
        &self,
        url: LinkUrl,
        old: Vec<Worker<Hiperface>>,
        codes: Vec<(CodeNumber, AccessCode)>,
        done: impl FnOnce(Result<Box<Opened>, Box<OpenFailed>>) -> Done + Send + 'static,
    ) {
        let (world, wake) = (self.services.world.clone(), self.services.tasks.wake());
        self.services.tasks.run("open", move || {
            for old in old {
                old.close(PATIENCE);
            }
            Action::Done(done(open(&world, &url, &codes, wake)))
        });
    }

    pub(super) fn reconnect(&mut self, id: SessionId, url: LinkUrl) {
        let Some(encoder) = self.encoders.iter_mut().find(|encoder| encoder.id == id && !encoder.is_writing()) else {
            return;
        };
        let old = encoder.let_go(JobEnd::Cancelled, &mut self.services);
        encoder.phase = Phase::Opening;
        let codes = self.codes_for(id);
        self.open_task(url, old.into_iter().collect(), codes, move |result| Done::Opened { session: id, result });
    }

    pub(super) fn opened(&mut self, session: SessionId, result: Result<Box<Opened>, Box<OpenFailed>>) {
        match result {
            Ok(opened) => {
                let link = self.encoder_mut(session).and_then(|encoder| match &encoder.source {
                    Source::Link(url) => Some(url.to_string()),
                    Source::File { .. } => None,
                });
                if let Some(link) = link {
                    self.settings.use_link(&link);
                }
                // Without a session to take it, it was closed while it opened: dropping ends its thread.
                self.with_encoder(session, |encoder, services| encoder.connect(*opened, services));
            }
            Err(failed) => {
                let text = explain::open_failed(&failed);
                self.with_encoder(session, |encoder, services| encoder.lose(text, services));
            }
        }
    }
}

fn open(
    world: &World,
    url: &LinkUrl,
    codes: &[(CodeNumber, AccessCode)],
    wake: Wake,
) -> Result<Box<Opened>, Box<OpenFailed>> {
    let began = (world.now)();
    let mut session = (world.open)(url, world.store.clone()).map_err(|error| Box::new(OpenFailed::Link(error)))?;
    for (number, code) in codes {
        session.codes_mut().set(*number, *code);
    }
    let is_virtual = session.is_virtual();
    let trace: Ring<TraceEntry> = Ring::new(FRAMES);
    let ring = trace.clone();
    session.watch(move |entry| ring.push(entry.clone()));
    match Worker::spawn(session, wake) {
        Ok(worker) => Ok(Box::new(Opened { worker, trace, is_virtual, began })),
        Err(error) => Err(Box::new(OpenFailed::Thread(error.to_string()))),
    }
}
