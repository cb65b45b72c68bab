//! Resources for a device search beyond its connection form.

use crossbeam_channel::Receiver;

use crate::app::Text;
use crate::app::question::{FollowUpAction, Question};
use crate::app::services::Services;
use crate::app::studio::Studio;
use crate::app::tab::Tab;
use crate::link::LinkUrl;

/// The resources that a device search uses in addition to its connection form.
pub struct FinderContext<'a> {
    studio: &'a mut Studio,
    tab: Tab,
    link: Result<LinkUrl, Text>,
    found: Option<LinkUrl>,
    problem: Option<Text>,
}

/// What a device search has requested from the dialog.
#[derive(Default)]
pub(super) struct FinderRequests {
    pub(super) found: Option<LinkUrl>,
    /// Reason why the request could not be executed, for the user.
    pub(super) problem: Option<Text>,
}

impl<'a> FinderContext<'a> {
    pub(super) fn new(studio: &'a mut Studio, tab: Tab, link: Result<LinkUrl, Text>) -> Self {
        FinderContext { studio, tab, link, found: None, problem: None }
    }

    pub(super) fn into_requests(self) -> FinderRequests {
        FinderRequests { found: self.found, problem: self.problem }
    }

    pub fn services(&mut self) -> &mut Services {
        &mut self.studio.services
    }

    /// Returns the link in the dialog.
    ///
    /// # Errors
    /// Returns the reason why the link cannot be used.
    pub fn link(&self) -> Result<LinkUrl, Text> {
        self.link.clone()
    }

    /// Returns a number that no other search or session has.
    pub fn next_number(&mut self) -> u32 {
        self.studio.next_number()
    }

    /// Releases a connection that a session or tool may be using. The session shows `why` as the reason. The returned
    /// channel, if any, closes when the connection is free.
    ///
    /// # Errors
    /// Returns an error if a session is writing. Such a session is not released.
    pub fn release_connection(&mut self, url: &LinkUrl, why: Text) -> Result<Option<Receiver<()>>, Text> {
        let earlier = self.studio.release_connection(url, why)?;
        self.studio.release_tool_connections(url);
        Ok(earlier)
    }

    /// Asks the user whether there is another master on the line. If there is none, the search continues.
    pub fn ask_about_other_master(&mut self, url: &LinkUrl) {
        self.studio.question = Some(Question::other_master(
            self.studio.services.world.kinds.display_link(url),
            FollowUpAction::Find(self.tab),
        ));
    }

    pub fn show_problem(&mut self, problem: Text) {
        self.problem = Some(problem);
    }

    /// Closes the dialog and connects to a device that was found. The search has already asked about other masters on
    /// the line.
    pub fn open_discovered(&mut self, url: LinkUrl) {
        self.found = Some(url);
    }
}
