//! The search for an encoder whose settings nobody remembers: on the line of the connection form, at every speed, parity
//! and address.

use crossbeam_channel::Receiver;

use crate::app::action::{Done, OpenFailed, Opened};
use crate::app::connect::Connect;
use crate::app::leaving::Leaver;
use crate::app::line::Line;
use crate::app::question::{Question, Then};
use crate::app::services::Services;
use crate::app::studio::{SessionId, Studio};
use crate::app::{Text, explain};
use crate::devices::hiperface::jobs::{Doing, Hiperface, HiperfaceJob, HiperfaceOutput, Remark, may_have_other_master};
use crate::devices::hiperface::procedures::find::{FindOptions, Findings, Found};
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::explain as words;
use crate::link::LinkUrl;
use crate::worker::{Event, Progress};

/// A search for encoders.
pub struct Search {
    /// Its number in the studio.
    pub(crate) number: u32,
    /// The link it searches on.
    pub(crate) url: LinkUrl,
    pub(crate) options: FindOptions,
    pub(crate) line: Option<Line<Hiperface>>,
    /// Ends when its link is open or cannot be opened.
    pub(crate) over: crossbeam_channel::Receiver<()>,
    /// All that answered so far.
    pub found: Vec<Found>,
    /// How it ended; `None` while it goes on.
    pub end: Option<Text>,
}

impl Search {
    /// How far it is.
    pub fn progress(&self) -> Option<&Progress<Doing>> {
        self.line.as_ref()?.running()?.progress.as_ref()
    }

    /// It goes on.
    pub fn is_running(&self) -> bool {
        self.end.is_none()
    }

    /// The link of an encoder that was found.
    pub(crate) fn link_to(&self, found: &Found) -> LinkUrl {
        let mut url = self.url.clone();
        url.query.set("baud", &found.format.baud.to_string());
        url.query.set("parity", found.format.parity.word());
        url.query.set("address", &format!("0x{:02X}", found.address));
        url
    }

    pub(crate) fn opened(&mut self, result: Result<Box<Opened<Hiperface>>, Box<OpenFailed>>, services: &Services) {
        match result {
            Ok(opened) => {
                let mut line = Line::new(*opened);
                let job = HiperfaceJob::Find(self.options.clone());
                if line.submit(job, TEXTS.text("job.find"), false, services.now()).is_err() {
                    self.end = Some(Text::new("session.ended"));
                }
                self.line = Some(line);
            }
            Err(failed) => self.end = Some(words::open_failed(&failed)),
        }
    }

    pub(crate) fn pump(&mut self) {
        let dead = self.line.as_ref().is_some_and(Line::is_dead);
        while let Some(event) = self.line.as_mut().and_then(Line::next) {
            match event {
                Event::Remark(Remark::Found(found)) => self.found.push(found),
                Event::Finished(_, output) => self.finish(*output),
                Event::Failed(_, error) | Event::Cancelled(_, error) => {
                    self.end = words::job(&error).into_iter().next();
                }
                Event::Lost(error) => self.end = Some(explain::link(&error)),
                Event::Started(_)
                | Event::Progress(..)
                | Event::Remark(Remark::Codes(_) | Remark::CodesUnheard(_) | Remark::Line(_))
                | Event::PollFailed(_) => {}
            }
        }
        if dead && self.end.is_none() {
            self.end = Some(Text::new("session.ended"));
        }
    }

    fn finish(&mut self, output: HiperfaceOutput) {
        self.end = Some(match output {
            HiperfaceOutput::Found(Findings::Searched { found, complete }) => {
                let id = match (found.is_empty(), complete) {
                    (true, true) => "find.nothing",
                    (false, true) => "find.done",
                    (_, false) => "find.cut_short",
                };
                let text = TEXTS.text(id).with("count", found.len());
                self.found = found;
                text
            }
            HiperfaceOutput::Found(Findings::ForeignTraffic { bytes }) => {
                TEXTS.text("find.foreign_traffic").with("bytes", bytes)
            }
            _ => Text::new("session.ended"),
        });
    }

    pub(crate) fn stop(&mut self) {
        match &mut self.line {
            Some(line) => line.stop(),
            // The link is still being opened, which may take for ever.
            None => self.end = Some(TEXTS.text("find.cut_short").with("count", 0)),
        }
    }
}

impl Studio {
    /// Searches the line of the form; where a drive may be on it, that is asked before.
    pub(crate) fn search_for(&mut self, options: FindOptions) {
        match self.connect.as_ref().map(Connect::url) {
            Some(Ok(url)) if may_have_other_master(&url) => {
                self.question = Some(Question::other_master(&url, Then::Search(options)));
            }
            Some(_) => self.search_confirmed(options),
            None => {}
        }
    }

    /// The user says that no drive is on the line of the form.
    pub(crate) fn search_confirmed(&mut self, options: FindOptions) {
        let Some(connect) = &mut self.connect else { return };
        let url = match connect.url() {
            Ok(url) => url,
            Err(problem) => {
                connect.problem = Some(problem);
                return;
            }
        };
        let earlier = match self.free_wire(&url, "session.let_go_for_search") {
            Ok(earlier) => self.end_search().or(earlier),
            Err(problem) => return self.refuse(problem),
        };
        let number = self.new_number();
        let done = move |result| Done::OpenedForSearch { number, result };
        self.signals.source.free_wire(&url, &mut self.services);
        let over = self.services.open_task::<Hiperface>(url.clone(), earlier, |_| (), done);
        let search = Search { number, url, options, line: None, over, found: Vec::new(), end: None };
        if let Some(connect) = &mut self.connect {
            connect.search = Some(search);
        }
    }

    /// Ends the search and forgets it. Where its link was still being opened, that is over when what is given tells so.
    pub(crate) fn end_search(&mut self) -> Option<Receiver<()>> {
        let search = self.connect.as_mut()?.search.take()?;
        if let Some(line) = search.line {
            let (session, about) = (SessionId(search.number), search.url.to_string());
            let who = Leaver { session, about, url: search.url, write: None };
            self.services.leave(line.into_worker(), who, None);
        }
        Some(search.over)
    }

    pub(crate) fn choose(&mut self, at: usize) {
        let Some(search) = self.connect.as_ref().and_then(|connect| connect.search.as_ref()) else { return };
        let Some(url) = search.found.get(at).map(|found| search.link_to(found)) else { return };
        self.close_dialog();
        self.open_found(url);
    }
}
