//! State of the views while the window is open: text buffers and selections, but no application state.

use std::collections::BTreeMap;

use super::device_view::{PageInfo, SessionView, TabViews, ToolPages};
use super::dialogs::{CompanyView, ConnectView, FileView, PaletteUiState, ServerView};
use super::logbook::{self, LogbookView};
use super::panels::TraceView;
use super::plot;
use super::profile_library::LibraryView;
use crate::app::{AnyDevice, LOGBOOK_TAB, SessionId, Studio, Tab};

pub struct Views {
    pub(super) tabs: TabViews,
    sessions: BTreeMap<SessionId, Box<dyn SessionView>>,
    tools: Vec<(Tab, Box<dyn ToolPages>)>,
    pub(super) connect: ConnectView,
    pub(super) server: ServerView,
    pub(super) company: CompanyView,
    pub(super) library: LibraryView,
    pub(super) file: Option<FileView>,
    pub(super) about: bool,
    /// Whether a comparison is shown as a picture instead of a list of items.
    pub(super) compares_pictures: bool,
    pub(super) help: bool,
    pub(super) palette: Option<PaletteUiState>,
    pub(super) trace: TraceView,
    pub(super) logbook: LogbookView,
    pub(super) plot: plot::PlotUiState,
    /// Polling interval of the position in microseconds.
    pub(super) rate: u64,
}

impl Views {
    pub(super) fn new(tabs: TabViews) -> Self {
        Views {
            tabs,
            sessions: BTreeMap::new(),
            tools: tabs.tool_views().iter().map(|view| (view.kind().tab(), view.create_pages())).collect(),
            connect: ConnectView::default(),
            server: ServerView::default(),
            company: CompanyView::default(),
            library: LibraryView::default(),
            file: None,
            about: false,
            compares_pictures: false,
            help: false,
            palette: None,
            trace: TraceView::default(),
            logbook: LogbookView::default(),
            plot: plot::PlotUiState::for_panel(),
            rate: 50_000,
        }
    }

    /// Returns the view of a session. Returns `None` if no tab shows the device's kind.
    pub(super) fn session(&mut self, device: &AnyDevice) -> Option<&mut dyn SessionView> {
        let view = self.tabs.device(device.tab())?;
        Some(self.sessions.entry(device.id()).or_insert_with(|| view.session()).as_mut())
    }

    pub(super) fn tool_pages(&mut self, tab: Tab) -> Option<&mut dyn ToolPages> {
        let (_, tool) = self.tools.iter_mut().find(|(own, _)| *own == tab)?;
        Some(tool.as_mut())
    }

    /// Returns the open page of the open tab. For a device tab without an open device, this is the first page.
    pub(super) fn page(&mut self, studio: &Studio) -> Option<PageInfo> {
        let tab = studio.settings.tab;
        if tab == LOGBOOK_TAB {
            return Some(logbook::PAGE);
        }
        let page = match (self.tool_pages(tab), device_in_tab(studio, tab)) {
            (Some(tool), _) => tool.page(),
            (None, Some(device)) => self.session(device)?.page(),
            (None, None) => 0,
        };
        self.tabs.pages(tab).get(page).copied()
    }

    pub(super) fn remove_closed_sessions(&mut self, studio: &Studio) {
        self.sessions.retain(|id, _| studio.device(*id).is_some());
    }
}

/// Returns the device shown by a tab, if that tab is open.
pub(super) fn device_in_tab(studio: &Studio, tab: Tab) -> Option<&AnyDevice> {
    studio.selected_device().filter(|device| device.tab() == tab)
}
