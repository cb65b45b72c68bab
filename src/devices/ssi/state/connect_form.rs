//! The connection form for an SSI encoder, which is virtual, behind an adapter, or in a recording. The form creates a
//! link but does not open it.

use crate::app::Text;
use crate::app::connect::form::{FormModel, NoFinder};
use crate::app::connect::parameters::{EnteredValues, Parameters, parameters_without_entry};
use crate::app::connect::target::{adapter_network_address, for_adapter, required_entry, split_target, validated_link};
use crate::buses::bridge::procedures::SupplyAfterSession;
use crate::buses::bridge::sim as bridge;
use crate::devices::ssi::jobs::check_link;
use crate::devices::ssi::procedures::LinkParameters;
use crate::devices::ssi::sim::Settings;
use crate::kinds::attachable_kinds;
use crate::link::{LinkScheme, LinkUrl, PORT_EXAMPLE};
use crate::parameter::{Entry, ParameterGroup as _};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SsiLinkKind {
    #[default]
    Virtual,
    Adapter,
    Replay,
}

/// Entries of the connection form. Entries of other connection types are kept, but are not included in the link. An
/// empty entry selects the default.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SsiForm {
    pub kind: SsiLinkKind,
    /// Whether the adapter is connected over a network, rather than at a serial port of this computer.
    pub network: bool,
    pub port: String,
    pub host: String,
    pub tcp_port: String,
    pub file: String,
    /// Whether the adapter leaves the supply of the encoder on when the session ends.
    pub leave_supply: bool,
    pub typed: EnteredValues,
    /// Link parameters without an entry in the form.
    pub rest: Vec<(String, String)>,
}

impl FormModel for SsiForm {
    type Finder = NoFinder<Self>;

    // The clock of the virtual encoder is slow enough for the user to see the bits.
    fn default_link() -> LinkUrl {
        let mut url = LinkUrl::simulated();
        url.query.set("rpm", "6");
        url
    }

    fn from_url(url: &LinkUrl) -> Self {
        let mut form = SsiForm::default();
        let target = url.target.as_str();
        form.kind = match url.scheme {
            LinkScheme::Sim => SsiLinkKind::Virtual,
            LinkScheme::Replay => SsiLinkKind::Replay,
            LinkScheme::Bridge | LinkScheme::Serial | LinkScheme::Tcp | LinkScheme::Modbus | LinkScheme::Enip => {
                SsiLinkKind::Adapter
            }
        };
        if let Some(network) = adapter_network_address(target).filter(|_| url.scheme == LinkScheme::Bridge) {
            form.network = true;
            (form.host, form.tcp_port) = split_target(network);
        } else if form.kind == SsiLinkKind::Replay {
            form.file = target.to_owned();
        } else {
            form.port = target.to_owned();
        }
        form.rest = parameters_without_entry(&url.query, |name, value| form.fill_entry(name, value));
        form
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        validated_link(self.parameters().build_link(self.target()?)?, check_link)
    }

    fn set_file(&mut self, file: String) {
        self.file = file;
    }

    fn example_link(&self) -> &'static str {
        PORT_EXAMPLE.bridge
    }
}

impl SsiForm {
    /// Returns the form's entries for link parameters. Those of a virtual encoder are included if it is selected.
    pub fn entries(&self) -> Vec<Entry> {
        let own = if self.kind == SsiLinkKind::Virtual { Self::virtual_device_entries() } else { Vec::new() };
        [own, LinkParameters::entries()].concat()
    }

    pub fn virtual_device_entries() -> Vec<Entry> {
        [Settings::entries(), bridge::entries()].concat()
    }

    /// Returns the form's entry for the supply voltage, and its entries for the other link parameters.
    pub fn link_entries() -> (Vec<Entry>, Vec<Entry>) {
        LinkParameters::entries().into_iter().partition(|own| own.key == "voltage")
    }

    /// Fills in the entry for a parameter. Returns `false` if the form has no such entry.
    fn fill_entry(&mut self, name: &str, value: &str) -> bool {
        if name == SupplyAfterSession::LEAVE_SUPPLY_ON.0 {
            self.leave_supply = value == SupplyAfterSession::LEAVE_SUPPLY_ON.1;
            return self.leave_supply;
        }
        self.typed.fill_entry(&self.entries(), name, value)
    }

    fn target(&self) -> Result<(LinkScheme, String), Text> {
        Ok(match self.kind {
            SsiLinkKind::Virtual => (LinkScheme::Sim, String::new()),
            SsiLinkKind::Adapter if self.network => (LinkScheme::Bridge, for_adapter(&self.host, &self.tcp_port)?),
            SsiLinkKind::Adapter => (LinkScheme::Bridge, required_entry(&self.port, "form.port_missing")?),
            SsiLinkKind::Replay => (LinkScheme::Replay, required_entry(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Parameters {
        let is_virtual = self.kind == SsiLinkKind::Virtual;
        let mut parameters = Parameters::default();
        parameters.add_typed_entries(&self.entries(), &self.typed);
        if self.leave_supply {
            parameters.set(SupplyAfterSession::LEAVE_SUPPLY_ON.0, SupplyAfterSession::LEAVE_SUPPLY_ON.1);
        }
        parameters.add_remaining(
            &self.rest,
            is_virtual,
            (LinkParameters::KEYS, &bridge::all_setting_names(attachable_kinds())),
        );
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::connect::parameters::tests::assert_round_trip;

    #[test]
    fn links_round_trip_through_form() {
        let links = [
            "sim:",
            "sim:?rpm=6",
            "sim:?ssi=ahm36,code=gray&rpm=-60&fault=drop:0.01&clock=1000000",
            "bridge:/dev/ttyACM0",
            "bridge:/dev/ttyACM0?voltage=24&margin=200",
            // A value that the check box cannot represent stays in the link (issue 22.16).
            "bridge:/dev/ttyACM0?voltage=24&leave-supply=on",
            "bridge:/dev/ttyACM0?voltage=24&leave-supply=off",
            "bridge:tcp:adapter:5000?clock=1500000&pause=30",
            "replay:monday.trace",
        ];
        assert_round_trip(&links, |url| SsiForm::from_url(url).url());
        assert_eq!(SsiForm::default_link().to_string(), "sim:?rpm=6");
    }

    #[test]
    fn rejection_names_invalid_entry() {
        let refused = |change: fn(&mut SsiForm)| {
            let mut form = SsiForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.kind = SsiLinkKind::Adapter), "form.port_missing");
        assert_eq!(refused(|form| (form.kind, form.network) = (SsiLinkKind::Adapter, true)), "form.host_missing");
        assert_eq!(refused(|form| form.kind = SsiLinkKind::Replay), "form.file_missing");
        assert_eq!(refused(|form| form.typed.set("margin", "soon")), "form.margin");
        assert_eq!(refused(|form| form.typed.set("rpm", "fast")), "form.rpm");
        assert_eq!(refused(|form| form.typed.set("fault", "drop:2")), "form.fault");
        assert_eq!(refused(|form| form.typed.set("ssi", "atm61")), "form.parameter");
        assert_eq!(refused(|form| form.typed.set("voltage", "48")), "form.parameter");
    }

    #[test]
    fn switching_interface_drops_other_settings() {
        let mut form = SsiForm::from_url(&"sim:?rpm=60&noise=0.1&margin=7&clock=1000000".parse().unwrap());
        (form.kind, form.port) = (SsiLinkKind::Adapter, "COM3".to_owned());
        assert_eq!(form.url().unwrap().to_string(), "bridge:COM3?margin=7&clock=1000000");
        // The link has parameters for which the form has no entry.
        let mut form = SsiForm::from_url(&"bridge:COM3?rpm=60".parse().unwrap());
        form.kind = SsiLinkKind::Virtual;
        form.typed.set("rpm", "6");
        assert_eq!(form.url().unwrap().to_string(), "sim:?rpm=6");
    }
}
