//! Test support: the tabs of the program, with access to the content of each.

use std::sync::OnceLock;

use encoder_studio::app::connect::{ConnectAction, ConnectDialog};
use encoder_studio::app::{Studio, Tab};
use encoder_studio::devices::hiperdrive::state::{Discovery, DiscoveryAction, DiscoveryFinder};
use encoder_studio::devices::hiperface::procedures::find::FindOptions;
use encoder_studio::devices::hiperface::state::{EncoderSearchForm, Search, SearchAction};
use encoder_studio::devices::{biss, hiperdrive, hiperface, interbus, ssi};
use encoder_studio::kinds::{KINDS, Program};
use encoder_studio::signals;
use encoder_studio::signals::state::Signals;

use crate::novo::NOVO;

pub(crate) const HIPERFACE: Tab = Tab::named("Hiperface");
pub(crate) const BISS: Tab = Tab::named("Biss");
pub(crate) const SSI: Tab = Tab::named("Ssi");
pub(crate) const INTERBUS: Tab = Tab::named("Interbus");
pub(crate) const HIPERDRIVE: Tab = Tab::named("Hiperdrive");
pub(crate) const SIGNALS: Tab = Tab::named("Signals");
/// The tab of the test kind.
pub(crate) const NOVEL: Tab = Tab::named("Novo");

/// Returns the program with the test kind added to its own kinds.
pub(crate) fn with_novo() -> Program {
    static PROGRAM: OnceLock<Program> = OnceLock::new();
    *PROGRAM.get_or_init(|| Program::new(&[KINDS, &[NOVO]].concat(), &[signals::TAB], &[], &[]))
}

/// Access to the content of each tab.
pub(crate) trait Tabs {
    fn hiperface(&self) -> Option<&hiperface::state::Encoder>;
    fn biss(&self) -> Option<&biss::state::Encoder>;
    fn ssi(&self) -> Option<&ssi::state::Encoder>;
    fn interbus(&self) -> Option<&interbus::state::Encoder>;
    fn hiperdrive(&self) -> Option<&hiperdrive::state::HiperdriveDevice>;
    fn signals(&self) -> &Signals;
}

impl Tabs for Studio {
    fn hiperface(&self) -> Option<&hiperface::state::Encoder> {
        self.selected_model()
    }

    fn biss(&self) -> Option<&biss::state::Encoder> {
        self.selected_model()
    }

    fn ssi(&self) -> Option<&ssi::state::Encoder> {
        self.selected_model()
    }

    fn interbus(&self) -> Option<&interbus::state::Encoder> {
        self.selected_model()
    }

    fn hiperdrive(&self) -> Option<&hiperdrive::state::HiperdriveDevice> {
        self.selected_model()
    }

    fn signals(&self) -> &Signals {
        self.tool_as().expect("there is a Signals tab")
    }
}

/// Returns the action that searches for encoders on the line of the form.
pub(crate) fn search_for(options: FindOptions) -> ConnectAction {
    ConnectAction::find::<EncoderSearchForm>(SearchAction::Search(options))
}

/// Returns the action that connects to the encoder with this index in the search results.
pub(crate) fn choose(at: usize) -> ConnectAction {
    ConnectAction::find::<EncoderSearchForm>(SearchAction::Choose(at))
}

/// Returns the action that searches for devices on the network.
pub(crate) fn discover() -> ConnectAction {
    ConnectAction::find::<DiscoveryFinder>(DiscoveryAction::Discover)
}

/// Returns the action that selects the device with this index in the discovery results.
pub(crate) fn choose_answer(at: usize) -> ConnectAction {
    ConnectAction::find::<DiscoveryFinder>(DiscoveryAction::Choose(at))
}

/// Returns the encoder search of a dialog, if any.
pub(crate) fn search(dialog: &ConnectDialog) -> Option<&Search> {
    dialog.finder_as::<EncoderSearchForm>()?.search.as_ref()
}

/// Returns the network discovery of a dialog, if any.
pub(crate) fn discovery(dialog: &ConnectDialog) -> Option<&Discovery> {
    dialog.finder_as::<DiscoveryFinder>()?.discovery.as_ref()
}
