//! The connection form for HIPERDRIVE devices and the link that results from it. This module opens no connection.

use super::discovery::DiscoveryFinder;
use crate::app::Text;
use crate::app::connect::form::FormModel;
use crate::app::connect::parameters::{EnteredValues, Parameters, parameters_without_entry};
use crate::app::connect::target::{
    format_host_and_optional_port, required_entry, split_host_default_port, validated_link,
};
use crate::devices::hiperdrive::jobs::check_link;
use crate::devices::hiperdrive::procedures::LinkParameters;
use crate::devices::hiperdrive::sim::Config;
use crate::link::{LinkScheme, LinkUrl};
use crate::parameter::{Entry, ParameterGroup as _};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HiperdriveLinkKind {
    #[default]
    Virtual,
    Network,
    Replay,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VirtualHub {
    #[default]
    Adapter,
    Four,
    Eight,
}

/// Entries in the connection form. An empty entry stands for the default. Entries for other types of connection are
/// kept but not included in the link.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HiperdriveForm {
    pub kind: HiperdriveLinkKind,
    pub hub: VirtualHub,
    pub host: String,
    /// TCP port, or empty for 44818.
    pub tcp_port: String,
    pub file: String,
    /// Whether the high byte of process data comes first.
    pub big_endian: bool,
    pub typed: EnteredValues,
    /// Link parameters that have no input field in the form.
    pub rest: Vec<(String, String)>,
}

/// Name of the byte order parameter, and the value that is not the default.
const BIG_ENDIAN: (&str, &str) = ("order", "big");
const PORT: &str = "44818";

impl VirtualHub {
    const fn keyword(self) -> Option<&'static str> {
        match self {
            VirtualHub::Adapter => None,
            VirtualHub::Four => Some("4"),
            VirtualHub::Eight => Some("8"),
        }
    }

    fn from_word(word: &str) -> Option<Self> {
        [VirtualHub::Four, VirtualHub::Eight].into_iter().find(|hub| hub.keyword() == Some(word))
    }
}

impl FormModel for HiperdriveForm {
    type Finder = DiscoveryFinder;

    // The window initially offers a virtual adapter.
    fn default_link() -> LinkUrl {
        LinkUrl::simulated()
    }

    fn from_url(url: &LinkUrl) -> Self {
        let way = match url.scheme {
            LinkScheme::Sim => HiperdriveLinkKind::Virtual,
            LinkScheme::Replay => HiperdriveLinkKind::Replay,
            LinkScheme::Enip | LinkScheme::Modbus | LinkScheme::Bridge | LinkScheme::Serial | LinkScheme::Tcp => {
                HiperdriveLinkKind::Network
            }
        };
        let mut form = HiperdriveForm { kind: way, ..HiperdriveForm::default() };
        match form.kind {
            HiperdriveLinkKind::Replay => form.file = url.target.clone(),
            HiperdriveLinkKind::Network => (form.host, form.tcp_port) = split_host_default_port(&url.target, PORT),
            HiperdriveLinkKind::Virtual => {}
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
        "enip:192.168.1.10"
    }
}

impl HiperdriveForm {
    /// Returns the parameters that can be entered: those of the link, and those of the virtual device if one is
    /// selected.
    pub fn entries(&self) -> Vec<Entry> {
        let own = if self.kind == HiperdriveLinkKind::Virtual { Config::entries() } else { Vec::new() };
        [own, LinkParameters::entries()].concat()
    }

    /// Returns the input field for the setpoint interval, followed by the input fields that are rarely used.
    pub fn link_entries() -> (Vec<Entry>, Vec<Entry>) {
        LinkParameters::entries().into_iter().partition(|own| own.key == "rpi")
    }

    /// Returns the input fields for the virtual device. An adapter has only one drive, so it has no field for occupied
    /// ports.
    pub fn virtual_device_entries(&self) -> Vec<Entry> {
        let has = |own: &Entry| own.key != "drives" || self.hub != VirtualHub::Adapter;
        Config::entries().into_iter().filter(has).collect()
    }

    /// Fills in the input field for a parameter. Returns `false` if there is no field that can show the value.
    fn fill_entry(&mut self, name: &str, value: &str) -> bool {
        if (name, self.kind) == ("hub", HiperdriveLinkKind::Virtual) {
            let hub = VirtualHub::from_word(value);
            self.hub = hub.unwrap_or(self.hub);
            return hub.is_some();
        }
        let is_big_endian = (name, value) == BIG_ENDIAN;
        self.big_endian |= is_big_endian;
        is_big_endian || self.typed.fill_entry(&self.entries(), name, value)
    }

    fn target(&self) -> Result<(LinkScheme, String), Text> {
        Ok(match self.kind {
            HiperdriveLinkKind::Virtual => (LinkScheme::Sim, String::new()),
            HiperdriveLinkKind::Network => (
                LinkScheme::Enip,
                format_host_and_optional_port(&self.host, "form.device_missing", &self.tcp_port, PORT)?,
            ),
            HiperdriveLinkKind::Replay => (LinkScheme::Replay, required_entry(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Parameters {
        let is_virtual = self.kind == HiperdriveLinkKind::Virtual;
        let mut parameters = Parameters::default();
        if is_virtual {
            parameters.entry("hub", self.hub.keyword().unwrap_or_default());
        }
        parameters.add_typed_entries(&self.entries(), &self.typed);
        if self.big_endian {
            parameters.set(BIG_ENDIAN.0, BIG_ENDIAN.1);
        }
        parameters.add_remaining(&self.rest, is_virtual, (LinkParameters::KEYS, Config::KEYS));
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
            "sim:?hub=4",
            "sim:?hub=8&drives=1,0,1&rpi=20&order=big&seed=7",
            "sim:?order=little",
            "enip:192.168.1.5:44818",
            "enip:192.168.1.5:50123?rpi=5&order=big&udp=2222&timeout=250",
            "replay:monday.trace",
        ];
        assert_round_trip(&links, |url| HiperdriveForm::from_url(url).url());
    }

    #[test]
    fn names_invalid_entries() {
        let refused = |change: fn(&mut HiperdriveForm)| {
            let mut form = HiperdriveForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.kind = HiperdriveLinkKind::Network), "form.device_missing");
        assert_eq!(refused(|form| form.kind = HiperdriveLinkKind::Replay), "form.file_missing");
        assert_eq!(refused(|form| form.typed.set("rpi", "4")), "form.parameter");
        assert_eq!(refused(|form| form.typed.set("drives", "2")), "form.parameter");
        assert_eq!(refused(|form| form.typed.set("timeout", "x")), "form.parameter");
    }

    #[test]
    fn switching_interface_drops_other_settings() {
        let mut form = HiperdriveForm::from_url(&"sim:?hub=4&seed=5&rpi=20".parse().unwrap());
        (form.kind, form.host) = (HiperdriveLinkKind::Network, "192.168.1.5".to_owned());
        assert_eq!(form.url().unwrap().to_string(), "enip:192.168.1.5:44818?rpi=20");
    }
}
