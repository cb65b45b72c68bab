//! Views of devices. Each device module implements a typed trait, which an adapter turns into the object-safe trait
//! used by the window.

#![warn(missing_docs)]

use egui::Ui;

use super::commands::NamedAction;
use super::dialogs::connect::{self, ConnectForm, TypedConnectForm};
use super::{Theme, status_line};
use crate::app::{Action, AnyDevice, DeviceKind, DeviceType, LOGBOOK_TAB, Rgb, Studio, Tab, Text, ToolKind};
use crate::profile::Body;

/// A page of a tab, as listed in the navigation and the help.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageInfo {
    /// Icon of the page in the navigation.
    pub icon: &'static str,
    /// Text id of the page's name.
    pub word: &'static str,
    /// Text id of the page's help.
    pub help: &'static str,
}

impl PageInfo {
    /// Creates a page from its icon and the ids of its name and help texts.
    pub const fn new(icon: &'static str, word: &'static str, help: &'static str) -> Self {
        PageInfo { icon, word, help }
    }
}

/// An enumeration of the pages of a tab.
pub trait TabPage: Copy + PartialEq + Default + 'static {
    /// All pages, in navigation order.
    const PAGES: &'static [(Self, PageInfo)];

    /// Returns the index of the page within its tab.
    fn index(self) -> usize {
        Self::PAGES.iter().position(|(own, _)| *own == self).unwrap_or_default()
    }
}

pub(crate) fn page_infos<P: TabPage>() -> Vec<PageInfo> {
    P::PAGES.iter().map(|(_, info)| *info).collect()
}

/// Returns the page at an index, or `None` if the tab has fewer pages.
pub(crate) fn page_at<P: TabPage>(place: usize) -> Option<P> {
    P::PAGES.get(place).map(|(page, _)| *page)
}

/// A view of one kind of device that uses the types of that kind.
pub trait TypedDeviceView: Sync + 'static {
    /// Application state of the device, independent of drawing.
    type Device: DeviceType;
    /// Pages of the device's tab.
    type Page: TabPage;
    /// Text buffers and selections of one session. They are dropped when a different device replies.
    type Memory: Default + 'static;
    /// The form that edits a link to this device.
    type ConnectForm: TypedConnectForm;

    /// Whether the undo and redo keys act on the device's edits. `false` if an editor handles these keys.
    const HAS_UNDO_KEYS: bool;

    /// Returns the serial number that distinguishes a device from others of its kind. Returns `None` if the number is
    /// unknown or irrelevant.
    fn serial_number(_device: &Self::Device) -> Option<&str> {
        None
    }

    /// Returns whether a page contains edits that have not been written to the device.
    fn is_edited(_device: &Self::Device, _page: Self::Page) -> bool {
        false
    }

    /// Draws the open page.
    fn page_ui(
        ui: &mut Ui,
        theme: &Theme,
        shared: (&Studio, &AnyDevice),
        device: &Self::Device,
        open: (Self::Page, &mut Self::Memory),
        actions: &mut Vec<Action>,
    );

    /// Draws the progress of the running job in the status line, right-aligned.
    fn running_ui(
        ui: &mut Ui,
        theme: &Theme,
        any: &AnyDevice,
        _device: &Self::Device,
        _page: Self::Page,
        actions: &mut Vec<Action>,
    ) {
        status_line::running_ui(ui, theme, any, None, actions);
    }

    /// Draws the position in large digits in the given colour, followed by further values.
    fn value_ui(ui: &mut Ui, theme: &Theme, device: &Self::Device, ink: Rgb);

    /// Draws the menu for choosing values to read together with the position, if the device has any.
    fn watch_menu(
        _ui: &mut Ui,
        _skin: &Theme,
        _device: &Self::Device,
        _memory: &mut Self::Memory,
        _actions: &mut Vec<Action>,
    ) {
    }

    /// Returns the header text of a moving device. Returns `None` while the device stands still.
    fn motion(_device: &Self::Device) -> Option<Text> {
        None
    }

    /// Returns the actions of this kind for the command palette. None of them may start a motion.
    fn named_actions(_theme: &Theme, _device: &Self::Device) -> Vec<NamedAction> {
        Vec::new()
    }

    /// Draws the part of an empty tab below the common buttons. A tab is empty while no device is open.
    fn empty_ui(_ui: &mut Ui, _skin: &Theme, _actions: &mut Vec<Action>) {}

    /// Returns the label of the picture that compares two profiles, or `None` for a kind without a picture.
    fn compared_picture() -> Option<Text> {
        None
    }

    /// Draws both profiles in one picture.
    fn compared_picture_ui(_ui: &mut Ui, _theme: &Theme, _left: &ViewedProfile<Self>, _right: &ViewedProfile<Self>) {}
}

/// Profile type of the devices that a view displays.
pub type ViewedProfile<V> = <<V as TypedDeviceView>::Device as DeviceType>::Profile;

/// Object-safe view of one kind of device. For a device of another kind, it draws nothing and reports no edits.
pub trait DeviceView: Sync {
    /// Returns the kind of device that the view displays.
    fn kind(&self) -> &'static dyn DeviceKind;

    /// Returns all pages, in navigation order.
    fn pages(&self) -> Vec<PageInfo>;

    /// Returns whether the undo and redo keys apply to edits of the device.
    fn has_undo_keys(&self) -> bool;

    /// Returns the header text of a moving device. Returns `None` while the device stands still.
    fn motion(&self, device: &AnyDevice) -> Option<Text>;

    /// Returns the actions of this kind for the command palette. None of them may start a motion.
    fn named_actions(&self, theme: &Theme, device: &AnyDevice) -> Vec<NamedAction>;

    /// Draws the position in large digits in the given colour, followed by further values.
    fn value_ui(&self, ui: &mut Ui, theme: &Theme, device: &AnyDevice, ink: Rgb);

    /// Creates the form for the connection dialog.
    fn connect_form(&self) -> Box<dyn ConnectForm>;

    /// Creates the view of a session.
    fn session(&self) -> Box<dyn SessionView>;

    /// Draws the part of an empty tab below the common buttons. A tab is empty while no device is open.
    fn empty_ui(&self, ui: &mut Ui, theme: &Theme, actions: &mut Vec<Action>);

    /// Returns the label of the picture that compares two profiles, or `None` for a kind without a picture.
    fn compared_picture(&self) -> Option<Text>;

    /// Draws both profiles in one picture. Draws nothing if they are of another kind.
    fn compared_picture_ui(&self, ui: &mut Ui, theme: &Theme, left: &Body, right: &Body);
}

/// View of one session, with its open page, text buffers and selections.
pub trait SessionView {
    /// Returns the index of the open page.
    fn page(&self) -> usize;

    /// Opens the page with the given index.
    fn open(&mut self, page: usize);

    /// Returns whether a page contains edits that have not been written to the device.
    fn is_edited(&self, device: &AnyDevice, page: usize) -> bool;

    /// Draws the open page.
    fn page_ui(&mut self, ui: &mut Ui, theme: &Theme, shared: (&Studio, &AnyDevice), actions: &mut Vec<Action>);

    /// Draws the progress of the running job in the status line, right-aligned.
    fn running_ui(&self, ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>);

    /// Draws the menu for choosing values to read together with the position, if the device has any.
    fn watch_menu(&mut self, ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>);
}

impl<V: TypedDeviceView> DeviceView for V {
    fn kind(&self) -> &'static dyn DeviceKind {
        V::Device::KIND
    }

    fn pages(&self) -> Vec<PageInfo> {
        page_infos::<V::Page>()
    }

    fn has_undo_keys(&self) -> bool {
        V::HAS_UNDO_KEYS
    }

    fn motion(&self, device: &AnyDevice) -> Option<Text> {
        device.get::<V::Device>().and_then(V::motion)
    }

    fn named_actions(&self, theme: &Theme, device: &AnyDevice) -> Vec<NamedAction> {
        device.get::<V::Device>().map(|device| V::named_actions(theme, device)).unwrap_or_default()
    }

    fn value_ui(&self, ui: &mut Ui, theme: &Theme, device: &AnyDevice, ink: Rgb) {
        if let Some(device) = device.get::<V::Device>() {
            V::value_ui(ui, theme, device, ink);
        }
    }

    fn connect_form(&self) -> Box<dyn ConnectForm> {
        connect::form::new_form::<V::ConnectForm>()
    }

    fn session(&self) -> Box<dyn SessionView> {
        Box::new(Session::<V> { page: V::Page::default(), memory: Memory::default() })
    }

    fn empty_ui(&self, ui: &mut Ui, theme: &Theme, actions: &mut Vec<Action>) {
        V::empty_ui(ui, theme, actions);
    }

    fn compared_picture(&self) -> Option<Text> {
        V::compared_picture()
    }

    fn compared_picture_ui(&self, ui: &mut Ui, theme: &Theme, left: &Body, right: &Body) {
        if let Some((left, right)) = left.get().zip(right.get()) {
            V::compared_picture_ui(ui, theme, left, right);
        }
    }
}

struct Session<V: TypedDeviceView> {
    page: V::Page,
    memory: Memory<V::Memory>,
}

#[derive(Default)]
struct Memory<M> {
    serial_number: Option<String>,
    own: M,
}

impl<M: Default> Memory<M> {
    /// Returns the view memory for the given device. Text and selections of a previous device are cleared first.
    fn for_device(&mut self, serial_number: Option<&str>) -> &mut M {
        if let Some(own) = serial_number
            && self.serial_number.as_deref() != Some(own)
            && self.serial_number.replace(own.to_owned()).is_some()
        {
            self.own = M::default();
        }
        &mut self.own
    }
}

impl<V: TypedDeviceView> SessionView for Session<V> {
    fn page(&self) -> usize {
        self.page.index()
    }

    fn open(&mut self, page: usize) {
        self.page = page_at(page).unwrap_or(self.page);
    }

    fn is_edited(&self, device: &AnyDevice, page: usize) -> bool {
        let (device, page) = (device.get::<V::Device>(), page_at(page));
        device.zip(page).is_some_and(|(device, page)| V::is_edited(device, page))
    }

    fn page_ui(&mut self, ui: &mut Ui, theme: &Theme, shared: (&Studio, &AnyDevice), actions: &mut Vec<Action>) {
        let Some(device) = shared.1.get::<V::Device>() else { return };
        let memory = self.memory.for_device(V::serial_number(device));
        V::page_ui(ui, theme, shared, device, (self.page, memory), actions);
    }

    fn running_ui(&self, ui: &mut Ui, theme: &Theme, any: &AnyDevice, actions: &mut Vec<Action>) {
        let Some(device) = any.get::<V::Device>() else { return };
        V::running_ui(ui, theme, any, device, self.page, actions);
    }

    fn watch_menu(&mut self, ui: &mut Ui, theme: &Theme, device: &AnyDevice, actions: &mut Vec<Action>) {
        let Some(device) = device.get::<V::Device>() else { return };
        V::watch_menu(ui, theme, device, self.memory.for_device(V::serial_number(device)), actions);
    }
}

/// A tab that requires no device. It creates a view for each window.
pub trait ToolView: Sync {
    /// Returns the tool shown on the tab.
    fn kind(&self) -> &'static dyn ToolKind;

    /// Returns the text id of the tab's name.
    fn title(&self) -> &'static str;

    /// Returns all pages, in navigation order.
    fn pages(&self) -> Vec<PageInfo>;

    /// Creates the view for a window.
    fn create_pages(&self) -> Box<dyn ToolPages>;
}

/// A window's view of a tab that requires no device, with its open page, text buffers and selections.
pub trait ToolPages {
    /// Returns the index of the open page.
    fn page(&self) -> usize;

    /// Opens the page with the given index.
    fn open(&mut self, page: usize);

    /// Draws the open page.
    fn page_ui(&mut self, ui: &mut Ui, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>);
}

/// Views of all tabs in navigation order. Device tabs come first.
#[derive(Clone, Copy)]
pub struct TabViews {
    devices: &'static [&'static dyn DeviceView],
    tools: &'static [&'static dyn ToolView],
}

impl TabViews {
    /// Creates the list of views, one for each tab.
    pub const fn new(devices: &'static [&'static dyn DeviceView], tools: &'static [&'static dyn ToolView]) -> Self {
        TabViews { devices, tools }
    }

    /// Returns the text ids of a tab's pages in navigation order.
    pub fn page_text_ids(self, tab: Tab) -> Vec<&'static str> {
        self.pages(tab).into_iter().map(|page| page.word).collect()
    }

    pub(crate) fn pages(self, tab: Tab) -> Vec<PageInfo> {
        let of_device = self.device(tab).map(DeviceView::pages);
        of_device.or_else(|| self.tool_view(tab).map(ToolView::pages)).unwrap_or_default()
    }

    pub(crate) fn tabs(self) -> impl Iterator<Item = Tab> {
        self.device_tabs().chain(self.tools.iter().map(|view| view.kind().tab())).chain([LOGBOOK_TAB])
    }

    pub(crate) fn title(self, theme: &Theme, tab: Tab) -> String {
        if tab == LOGBOOK_TAB {
            return theme.translate("logbook.title");
        }
        let title = self.tool_view(tab).map(|view| theme.translate(view.title()));
        title.or_else(|| self.device(tab).map(|view| view.kind().bus_name().to_owned())).unwrap_or_default()
    }

    pub(crate) fn device_tabs(self) -> impl Iterator<Item = Tab> {
        self.devices.iter().map(|view| view.kind().tab())
    }

    pub(crate) fn device(self, tab: Tab) -> Option<&'static dyn DeviceView> {
        self.devices.iter().copied().find(|view| view.kind().tab() == tab)
    }

    /// Returns the view of a kind of device, by its keyword in profiles.
    pub(crate) fn for_profile(self, keyword: &str) -> Option<&'static dyn DeviceView> {
        self.devices.iter().copied().find(|view| view.kind().keyword() == keyword)
    }

    pub(crate) fn tool_views(self) -> &'static [&'static dyn ToolView] {
        self.tools
    }

    fn tool_view(self, tab: Tab) -> Option<&'static dyn ToolView> {
        self.tools.iter().copied().find(|view| view.kind().tab() == tab)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_typed_text_on_device_change() {
        let mut memory = Memory::<String>::default();
        memory.for_device(None).push_str("48");
        assert_eq!(memory.for_device(Some("00123")), "48", "the first device that is known");
        assert_eq!(memory.for_device(None), "48", "read again");
        assert_eq!(memory.for_device(Some("00123")), "48");
        assert_eq!(memory.for_device(Some("00124")), "");
    }
}
