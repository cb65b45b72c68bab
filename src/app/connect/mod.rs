//! The connection dialog: a link as a form, the ports of this machine, and the search for an encoder whose settings nobody
//! remembers.

mod act;
pub(crate) mod parameters;
mod ports;
pub(crate) mod target;

pub use ports::{Offer, offered_ports};
pub use target::is_missing;

use std::path::PathBuf;

use super::services::Services;
use super::tab::Tab;
use super::{Text, explain};
use crate::app::action::Done;
use crate::devices::biss::state::BissForm;
use crate::devices::hiperdrive::state::{Discovery, HiperdriveForm};
use crate::devices::hiperface::procedures::find::FindOptions;
use crate::devices::hiperface::state::{LinkForm, Search};
use crate::devices::interbus::state::InterbusForm;
use crate::devices::ssi::state::SsiForm;
use crate::link::LinkUrl;

/// What can be done in the dialog.
pub enum Action {
    /// Open it.
    Open,
    /// Close it; a search ends.
    Close,
    /// Look for serial ports again.
    ListPorts,
    /// Another kind of device.
    Device(Tab),
    /// The form for a HIPERFACE encoder was edited.
    Edit(Box<LinkForm>),
    /// The form for a BiSS encoder was edited.
    EditBiss(Box<BissForm>),
    /// The form for an SSI encoder was edited.
    EditSsi(Box<SsiForm>),
    /// The form for an INTERBUS encoder was edited.
    EditInterbus(Box<InterbusForm>),
    /// The form for HIPERDRIVE drives was edited.
    EditHiperdrive(Box<HiperdriveForm>),
    /// Ask who is there in this network.
    Discover,
    /// Fill in the device that answered.
    ChooseDevice(usize),
    /// A link was typed, pasted or chosen; where it can be used, it fills in the form.
    Use(String),
    /// Ask for a recording.
    AskRecording,
    /// A recording was chosen.
    Recording(PathBuf),
    /// Connect as the form says.
    Connect,
    /// Look for encoders on the line of the form.
    Search(FindOptions),
    /// End the search.
    StopSearch,
    /// Connect to an encoder that was found.
    Choose(usize),
}

/// The dialog.
pub struct Connect {
    /// The kind of device.
    pub device: Tab,
    /// The link to a HIPERFACE encoder as a form.
    pub form: LinkForm,
    /// The link to a BiSS encoder as a form.
    pub biss: BissForm,
    /// The link to an SSI encoder as a form.
    pub ssi: SsiForm,
    /// The link to an INTERBUS encoder as a form.
    pub interbus: InterbusForm,
    /// The link to HIPERDRIVE drives as a form.
    pub hiperdrive: HiperdriveForm,
    /// Who has answered in this network.
    pub discovery: Option<Discovery>,
    /// The link as it was typed, until the form is edited; `None`: it is what the form stands for.
    pub typed: Option<String>,
    /// The ports of this machine; `None` while they are being looked for.
    pub ports: Option<Result<Vec<Offer>, Text>>,
    /// Why what was asked for was not done.
    pub problem: Option<Text>,
    /// The search.
    pub search: Option<Search>,
}

impl Connect {
    /// For a kind of device; `last` gives the link that was used last for one.
    pub(super) fn new(device: Tab, last: impl Fn(Tab) -> Option<LinkUrl>) -> Self {
        let form = LinkForm::from_url(&last(Tab::Hiperface).unwrap_or_else(LinkUrl::sim));
        let biss = BissForm::from_url(&last(Tab::Biss).unwrap_or_else(BissForm::usual));
        let ssi = SsiForm::from_url(&last(Tab::Ssi).unwrap_or_else(SsiForm::usual));
        let interbus = InterbusForm::from_url(&last(Tab::Interbus).unwrap_or_else(InterbusForm::usual));
        let hiperdrive = HiperdriveForm::from_url(&last(Tab::Hiperdrive).unwrap_or_else(HiperdriveForm::usual));
        Connect {
            device,
            form,
            biss,
            ssi,
            interbus,
            hiperdrive,
            discovery: None,
            typed: None,
            ports: None,
            problem: None,
            search: None,
        }
    }

    /// The link that was typed, else the one that the form stands for.
    ///
    /// # Errors
    /// A sentence that says what cannot be used and what would be allowed.
    pub fn url(&self) -> Result<LinkUrl, Text> {
        match &self.typed {
            Some(link) => self.read(link),
            None => match self.device {
                Tab::Biss => self.biss.url(),
                Tab::Ssi => self.ssi.url(),
                Tab::Interbus => self.interbus.url(),
                Tab::Hiperdrive => self.hiperdrive.url(),
                Tab::Hiperface | Tab::Signals => self.form.url(),
            },
        }
    }

    /// Why this is no link to the kind of device that is chosen, or the link.
    fn read(&self, link: &str) -> Result<LinkUrl, Text> {
        let url: LinkUrl = link.parse().map_err(|error| target::other(explain::url(&error)))?;
        target::checked(url, |url| self.device.check(url))
    }

    /// A link was typed; the form follows it where it can be used.
    pub(super) fn take(&mut self, link: String) {
        if let Ok(url) = self.read(&link) {
            match self.device {
                Tab::Biss => self.biss = BissForm::from_url(&url),
                Tab::Ssi => self.ssi = SsiForm::from_url(&url),
                Tab::Interbus => self.interbus = InterbusForm::from_url(&url),
                Tab::Hiperdrive => self.hiperdrive = HiperdriveForm::from_url(&url),
                Tab::Hiperface | Tab::Signals => self.form = LinkForm::from_url(&url),
            }
        }
        self.typed = Some(link);
    }

    /// A search for an encoder runs.
    pub fn is_searching(&self) -> bool {
        self.search.as_ref().is_some_and(Search::is_running)
    }

    /// The link as text: as it was typed, else as the form stands for it; empty where it stands for none.
    pub fn link(&self) -> String {
        match &self.typed {
            Some(link) => link.clone(),
            None => self.url().map(|url| url.to_string()).unwrap_or_default(),
        }
    }

    /// What a link to a device of the chosen kind looks like.
    pub fn example(&self) -> &'static str {
        match self.device {
            Tab::Biss if self.biss.is_on_the_bus() => "bridge:/dev/ttyUSB0",
            Tab::Ssi => "bridge:/dev/ttyUSB0",
            Tab::Interbus => "modbus:192.168.1.10",
            Tab::Hiperdrive => "enip:192.168.1.10",
            Tab::Hiperface | Tab::Biss | Tab::Signals => "serial:/dev/ttyUSB0",
        }
    }
}

/// The serial ports, as a task's result; `links` are the links used, the latest first.
pub(super) fn list_ports(services: &Services, links: &[String]) {
    let (ports, links) = (services.world.ports.clone(), links.to_vec());
    services.tasks.run("ports", move || {
        let exists = |path: &str| std::path::Path::new(path).exists();
        super::Action::Done(Done::Ports(ports().map(|ports| offered_ports(&ports, &links, exists))))
    });
}
