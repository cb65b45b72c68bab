//! Searches a line for encoders with unknown settings by trying every baud rate, parity and address.

use crossbeam_channel::Receiver;

use crate::app::action::{OpenFailure, OpenedConnection, OpenedSession, TaskResult};
use crate::app::connect::context::FinderContext;
use crate::app::connect::form::Finder;
use crate::app::live_session::LiveSession;
use crate::app::services::Services;
use crate::app::session::Kind as _;
use crate::app::shutdown::ClosingSessionInfo;
use crate::app::studio::SessionId;
use crate::app::{DeviceModel, Text, explain};
use crate::devices::hiperface::jobs::{
    DeviceMessage, Hiperface, HiperfaceJob, HiperfaceOutput, JobStep, may_have_other_master,
};
use crate::devices::hiperface::procedures::find::{EncoderSearchResult, FindOptions, FoundEncoder};
use crate::devices::hiperface::state::explain as words;
use crate::devices::hiperface::state::{Encoder, LinkForm, TEXTS};
use crate::link::LinkUrl;
use crate::worker::{Event, Progress};

pub struct Search {
    pub(crate) number: u32,
    pub(crate) url: LinkUrl,
    pub(crate) options: FindOptions,
    pub(crate) line: Option<LiveSession<Hiperface>>,
    /// Receiver that is disconnected once the attempt to open the link is over.
    pub(crate) over: crossbeam_channel::Receiver<()>,
    pub found: Vec<FoundEncoder>,
    /// Message about the result of the search, or `None` while the search is running.
    pub end: Option<Text>,
}

impl Search {
    pub fn progress(&self) -> Option<&Progress<JobStep>> {
        self.line.as_ref()?.running_job()?.progress.as_ref()
    }

    pub fn is_running(&self) -> bool {
        self.end.is_none()
    }

    pub(crate) fn encoder_link(&self, found: &FoundEncoder) -> LinkUrl {
        let mut url = self.url.clone();
        url.query.set("baud", &found.format.baud.to_string());
        url.query.set("parity", found.format.parity.keyword());
        url.query.set("address", &format!("0x{:02X}", found.address));
        url
    }

    pub(crate) fn handle_opened(
        &mut self,
        result: Result<Box<OpenedConnection<Hiperface>>, Box<OpenFailure>>,
        services: &Services,
    ) {
        match result {
            Ok(opened) => {
                let mut line = LiveSession::new(*opened);
                let job = HiperfaceJob::Find(self.options.clone());
                if line.submit(job, TEXTS.text("job.find"), false, services.current_time()).is_err() {
                    self.end = Some(Text::new("session.ended"));
                }
                self.line = Some(line);
            }
            Err(failed) => self.end = Some(Hiperface::open_failure_text(&failed)),
        }
    }

    pub(crate) fn process_events(&mut self) {
        let dead = self.line.as_ref().is_some_and(LiveSession::is_dead);
        while let Some(event) = self.line.as_mut().and_then(LiveSession::next) {
            match event {
                Event::DeviceMessage(DeviceMessage::Found(found)) => self.found.push(found),
                Event::Finished(_, output) => self.finish(*output),
                Event::Failed(_, error) | Event::Cancelled(_, error) => {
                    self.end = words::job_error_texts(&error).into_iter().next();
                }
                Event::Lost(error) => self.end = Some(explain::link_error_text(&error)),
                Event::Started(_)
                | Event::Progress(..)
                | Event::DeviceMessage(
                    DeviceMessage::Codes(_) | DeviceMessage::CodesLost(_) | DeviceMessage::Line(_),
                )
                | Event::PollFailed(_) => {}
            }
        }
        if dead && self.end.is_none() {
            self.end = Some(Text::new("session.ended"));
        }
    }

    fn finish(&mut self, output: HiperfaceOutput) {
        self.end = Some(match output {
            HiperfaceOutput::Found(EncoderSearchResult::Searched { found, complete }) => {
                let id = match (found.is_empty(), complete) {
                    (true, true) => "find.nothing",
                    (false, true) => "find.done",
                    (_, false) => "find.cut_short",
                };
                let text = TEXTS.text(id).with("count", found.len());
                self.found = found;
                text
            }
            HiperfaceOutput::Found(EncoderSearchResult::ForeignTraffic { bytes }) => {
                TEXTS.text("find.foreign_traffic").with("bytes", bytes)
            }
            _ => Text::new("session.ended"),
        });
    }

    pub(crate) fn stop(&mut self) {
        match &mut self.line {
            Some(line) => line.stop(),
            // The link is still being opened, and this attempt may never end.
            None => self.end = Some(TEXTS.text("find.cut_short").with("count", 0)),
        }
    }
}

/// The search function of the connection form.
#[derive(Default)]
pub struct EncoderSearchForm {
    pub search: Option<Search>,
    /// Options of the requested search, which starts once the user confirms that no drive is on the line.
    asked: Option<FindOptions>,
}

pub enum SearchAction {
    Search(FindOptions),
    Choose(usize),
}

pub struct SearchLinkResult {
    number: u32,
    result: Result<Box<OpenedConnection<Hiperface>>, Box<OpenFailure>>,
}

impl Finder for EncoderSearchForm {
    type Form = LinkForm;
    type Action = SearchAction;
    type TaskResult = SearchLinkResult;

    fn handle_action(&mut self, action: SearchAction, _form: &mut LinkForm, context: &mut FinderContext<'_>) {
        match action {
            SearchAction::Search(options) => {
                self.asked = Some(options);
                match context.link() {
                    Ok(url) if may_have_other_master(&url) => context.ask_about_other_master(&url),
                    _ => self.handle_confirmation(context),
                }
            }
            SearchAction::Choose(at) => {
                let Some(search) = &self.search else { return };
                if let Some(found) = search.found.get(at) {
                    context.open_discovered(search.encoder_link(found));
                }
            }
        }
    }

    fn handle_confirmation(&mut self, context: &mut FinderContext<'_>) {
        let Some(options) = self.asked.take() else { return };
        let url = match context.link() {
            Ok(url) => url,
            Err(problem) => return context.show_problem(problem),
        };
        let earlier = match context.release_connection(&url, Text::new("session.let_go_for_search")) {
            Ok(earlier) => self.finish(context.services()).or(earlier),
            Err(problem) => return context.show_problem(problem),
        };
        let number = context.next_number();
        let done = move |result| {
            TaskResult::from_finder::<EncoderSearchForm>(Encoder::TAB, SearchLinkResult { number, result })
        };
        let over = context.services().open_task::<Hiperface>(url.clone(), earlier, |_| (), done);
        self.search = Some(Search { number, url, options, line: None, over, found: Vec::new(), end: None });
    }

    fn handle_result(finder: Option<&mut Self>, done: SearchLinkResult, services: &mut Services) {
        let SearchLinkResult { number, result } = done;
        let search = finder.and_then(|finder| finder.search.as_mut());
        match (search.filter(|search| search.number == number && search.is_running()), result) {
            (Some(search), result) => search.handle_opened(result, services),
            // The search has ended while its link was being opened, so the link is not needed.
            (None, Ok(opened)) => opened.close_unused(SessionId(number), services),
            (None, Err(_)) => {}
        }
    }

    fn process_events(&mut self) {
        if let Some(search) = &mut self.search {
            search.process_events();
        }
    }

    fn is_running(&self) -> bool {
        self.search.as_ref().is_some_and(Search::is_running)
    }

    fn stop(&mut self) {
        if let Some(search) = &mut self.search {
            search.stop();
        }
    }

    fn finish(&mut self, services: &mut Services) -> Option<Receiver<()>> {
        let search = self.search.take()?;
        if let Some(line) = search.line {
            let (session, about) = (SessionId(search.number), services.world.kinds.display_link(&search.url));
            let who = ClosingSessionInfo { session, about, url: search.url, write: None };
            services.release_worker(line.into_worker(), who, None);
        }
        Some(search.over)
    }
}
