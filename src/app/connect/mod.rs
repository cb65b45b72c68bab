//! The connection dialog: a form for the link, a list of serial ports, and the search for devices. Each kind of device
//! provides its own form.

mod act;
pub mod context;
pub mod form;
pub(crate) mod parameters;
mod ports;
pub(crate) mod target;

pub use parameters::EnteredValues;
pub use ports::{PortEntry, offered_ports};
pub use target::is_missing;

use std::any::Any;
use std::path::PathBuf;

use form::{AnyForm, Finder, FormModel};

use super::kinds::KindRegistry;
use super::payload::Payload;
use super::services::Services;
use super::tab::Tab;
use super::{Text, explain};
use crate::app::action::TaskResult;
use crate::link::LinkUrl;

pub enum ConnectAction {
    Open,
    Close,
    ListPorts,
    Device(Tab),
    /// The entries of a form were edited. See [`ConnectAction::edit_form`].
    Edit(Payload),
    /// The user requested an action of the device search. See [`ConnectAction::find`].
    Find(Payload),
    /// A link was typed, pasted or selected. A valid link fills in the form.
    Use(String),
    AskRecording,
    Recording(PathBuf),
    Connect,
    StopSearch,
}

impl ConnectAction {
    pub fn edit_form<F: FormModel>(form: F) -> Self {
        ConnectAction::Edit(Payload::new(form))
    }

    pub fn find<S: Finder>(action: S::Action) -> Self {
        ConnectAction::Find(Payload::new(action))
    }
}

pub struct ConnectDialog {
    pub device: Tab,
    kinds: KindRegistry,
    forms: Vec<(Tab, Box<dyn AnyForm>)>,
    /// The link as entered. `None` after the form has been edited: the form then defines the link.
    pub typed: Option<String>,
    /// Serial ports of this computer, or `None` while they are being listed.
    pub ports: Option<Result<Vec<PortEntry>, Text>>,
    pub problem: Option<Text>,
}

impl ConnectDialog {
    /// Creates the dialog for a kind of device. `last` returns a tab's most recently used link.
    pub(super) fn new(kinds: KindRegistry, device: Tab, last: impl Fn(Tab) -> Option<LinkUrl>) -> Self {
        let forms = kinds.devices().iter().map(|kind| (kind.tab(), kind.create_form(last(kind.tab())))).collect();
        ConnectDialog { device, kinds, forms, typed: None, ports: None, problem: None }
    }

    pub fn form_as<F: Any>(&self) -> Option<&F> {
        self.forms.iter().find_map(|(_, form)| form.as_any_form().downcast_ref())
    }

    pub fn finder_as<S: Any>(&self) -> Option<&S> {
        self.forms.iter().find_map(|(_, form)| form.as_any_finder().downcast_ref())
    }

    fn current_form(&self) -> Option<&dyn AnyForm> {
        self.forms.iter().find(|(tab, _)| *tab == self.device).map(|(_, form)| form.as_ref())
    }

    fn forms_mut(&mut self) -> impl Iterator<Item = &mut Box<dyn AnyForm>> {
        self.forms.iter_mut().map(|(_, form)| form)
    }

    /// Returns the link as entered or, if none was entered, the link of the form.
    ///
    /// # Errors
    /// Returns a message that names the invalid part and the allowed values.
    pub fn url(&self) -> Result<LinkUrl, Text> {
        match &self.typed {
            Some(link) => self.read(link),
            None => self.current_form().map_or_else(|| Err(Text::new("session.wrong_kind")), AnyForm::url),
        }
    }

    /// Parses a link to the selected kind of device.
    fn read(&self, link: &str) -> Result<LinkUrl, Text> {
        let url: LinkUrl = link.parse().map_err(|error| target::unusable_link_text(explain::url_error_text(&error)))?;
        target::validated_link(url, |url| {
            self.kinds.kind_for_tab(self.device).map_or(Ok(()), |kind| kind.check_link(url))
        })
    }

    /// Adopts a typed link. A valid link fills in the form.
    pub(super) fn set_typed_link(&mut self, link: String) {
        let (device, url) = (self.device, self.read(&link));
        if let (Ok(url), Some((_, form))) = (url, self.forms.iter_mut().find(|(tab, _)| *tab == device)) {
            form.fill_from_link(&url);
        }
        self.typed = Some(link);
    }

    /// Returns whether a device search is using the form's connection.
    pub fn is_searching(&self) -> bool {
        self.forms.iter().any(|(_, form)| form.is_running())
    }

    /// Returns the link as entered, or else the link of the form. The string is empty if the form yields no valid link.
    pub fn typed_link(&self) -> String {
        match &self.typed {
            Some(link) => link.clone(),
            None => self.url().map(|url| url.to_string()).unwrap_or_default(),
        }
    }

    pub fn example_link(&self) -> &'static str {
        self.current_form().map(AnyForm::example_link).unwrap_or_default()
    }

    pub(super) fn process_events(&mut self) {
        self.forms_mut().for_each(|form| form.process_events());
    }

    pub(super) fn stop(&mut self) {
        self.forms_mut().for_each(|form| form.stop());
    }
}

/// Starts a task that lists the serial ports. `links` are the previously used links, most recent first.
pub(super) fn list_ports(services: &Services, links: &[String]) {
    let (ports, links) = (services.world.ports.clone(), links.to_vec());
    services.tasks.run("ports", move || {
        let exists = |path: &str| std::path::Path::new(path).exists();
        super::Action::Done(TaskResult::Ports(ports().map(|ports| offered_ports(&ports, &links, exists))))
    });
}
