//! Tabs that need no device. The application uses all tools through the same trait and does not depend on any
//! particular one.

#![warn(missing_docs)]

use std::any::Any;
use std::path::{Path, PathBuf};

use crossbeam_channel::Receiver;

use super::payload::{Payload, PayloadKindError};
use super::recorder::Recorder;
use super::report::CreateReport;
use super::services::Services;
use super::sine_cosine::SineCosineSource;
use super::studio::Studio;
use super::tab::Tab;
use super::{Action, Text};
use crate::link::LinkUrl;

/// A kind of tool, which creates the tool when the window opens.
pub trait ToolKind: Sync {
    /// Returns the tab in which the tool is shown.
    fn tab(&self) -> Tab;

    /// Creates the tool. `links` are the links previously used in it, most recent first.
    fn create_tool(&self, links: &[String]) -> Box<dyn Tool>;
}

/// A tab that needs no device.
pub trait Tool: Any {
    /// Executes an action.
    ///
    /// # Errors
    /// Returns an error if the action belongs to another tool.
    fn handle_action(&mut self, action: Payload, context: &mut ToolContext<'_>) -> Result<(), PayloadKindError>;

    /// Handles the result of a task.
    ///
    /// # Errors
    /// Returns an error if the result belongs to another tool.
    fn handle_result(&mut self, done: Payload, services: &mut Services) -> Result<(), PayloadKindError>;

    /// Processes the events received since the last call.
    fn process_events(&mut self, services: &mut Services);

    /// Returns whether the tool has a running job.
    fn can_stop(&self) -> bool;

    /// Stops the running job of the tool.
    fn stop(&mut self, services: &mut Services);

    /// Returns the recorder of the tool.
    fn recorder(&self) -> &Recorder;

    /// Returns the recorder of the tool, mutably.
    fn recorder_mut(&mut self) -> &mut Recorder;

    /// Adopts the next reading, if any, that a source has taken at standstill.
    fn adopt_reading(&mut self, source: &mut dyn SineCosineSource);

    /// Releases a connection because it is needed elsewhere.
    fn release_connection(&mut self, url: &LinkUrl, services: &mut Services);

    /// Returns the function that creates a report on the displayed data, if any.
    fn report(&self) -> Option<CreateReport>;

    /// Returns whether the tool can open the given file.
    fn can_open(&self, path: &Path) -> bool;

    /// Opens a file.
    fn open(&mut self, path: PathBuf, services: &mut Services);
}

/// An action of a tool, which can be passed as a payload.
pub trait ToolAction: Any + Send {
    /// Tab in which the tool is shown.
    const TAB: Tab;
}

impl Action {
    /// Wraps an action for a tool.
    pub fn tool<A: ToolAction>(action: A) -> Self {
        Action::Tool(A::TAB, Payload::new(action))
    }
}

impl dyn Tool {
    /// Returns the tool as `T`, or `None` if it is of another type.
    pub fn get<T: Any>(&self) -> Option<&T> {
        (self as &dyn Any).downcast_ref()
    }
}

/// Resources that a tool may use.
pub struct ToolContext<'a> {
    tab: Tab,
    studio: &'a mut Studio,
}

impl ToolContext<'_> {
    /// Returns the services common to all devices and tools.
    pub fn services(&mut self) -> &mut Services {
        &mut self.studio.services
    }

    /// Releases the session on a connection, unless it is writing. The session then shows `why`. The connection is free
    /// as soon as the returned channel, if any, closes.
    ///
    /// # Errors
    /// Returns the session that is writing.
    pub fn release_connection(&mut self, url: &LinkUrl, why: Text) -> Result<Option<Receiver<()>>, Text> {
        self.studio.release_connection(url, why)
    }

    /// Adds a link to the list of recently used links.
    pub fn use_link(&mut self, link: &str) {
        self.studio.settings.use_link(self.tab, link);
    }
}

impl Studio {
    /// Returns the tool of the given type.
    pub fn tool_as<T: Any>(&self) -> Option<&T> {
        self.tools.iter().find_map(|(_, tool)| tool.get())
    }

    pub(super) fn tool(&self, tab: Tab) -> Option<&dyn Tool> {
        self.tools.iter().find(|(own, _)| *own == tab).map(|(_, tool)| tool.as_ref())
    }

    /// Returns whether the tool in a tab can create a report on its data.
    pub fn can_report(&self, tab: Tab) -> bool {
        self.tool(tab).is_some_and(|tool| tool.report().is_some())
    }

    pub(super) fn apply_tool_action(&mut self, tab: Tab, action: Payload) {
        let Some(at) = self.tools.iter().position(|(own, _)| *own == tab) else { return self.notify_wrong_kind(None) };
        let (_, mut tool) = self.tools.remove(at);
        let done = tool.handle_action(action, &mut ToolContext { tab, studio: self });
        self.tools.insert(at, (tab, tool));
        if done.is_err() {
            self.notify_wrong_kind(None);
        }
    }

    pub(super) fn finish_tool_action(&mut self, tab: Tab, done: Payload) {
        let tool = self.tools.iter_mut().find(|(own, _)| *own == tab);
        if tool.is_none_or(|(_, tool)| tool.handle_result(done, &mut self.services).is_err()) {
            self.notify_wrong_kind(None);
        }
    }

    /// Opens a file in the tool that accepts it. Returns the path as an error if no tool accepts the file.
    pub(super) fn open_in_tool(&mut self, path: PathBuf) -> Result<(), PathBuf> {
        let Some((tab, tool)) = self.tools.iter_mut().find(|(_, tool)| tool.can_open(&path)) else { return Err(path) };
        self.settings.tab = *tab;
        tool.open(path, &mut self.services);
        Ok(())
    }

    /// Opens a capture in the open tab if that is a tool, or else in the first tool. If another tab is opened in the
    /// meantime, it stays open.
    pub(super) fn open_capture(&mut self, path: PathBuf) {
        let tab = self.settings.tab;
        let at = self.tools.iter().position(|(own, _)| *own == tab).unwrap_or_default();
        if let Some((_, tool)) = self.tools.get_mut(at) {
            tool.open(path, &mut self.services);
        }
    }

    /// Makes all tools release a connection that is needed elsewhere.
    pub(super) fn release_tool_connections(&mut self, url: &LinkUrl) {
        for (_, tool) in &mut self.tools {
            tool.release_connection(url, &mut self.services);
        }
    }
}
