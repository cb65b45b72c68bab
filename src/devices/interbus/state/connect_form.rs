//! Connection form of an INTERBUS encoder, and the link that it produces. This module opens no connection.

use crate::app::Text;
use crate::app::connect::form::{FormModel, NoFinder};
use crate::app::connect::parameters::{EnteredValues, Parameters, parameters_without_entry};
use crate::app::connect::target::{
    format_host_and_optional_port, required_entry, split_host_default_port, validated_link,
};
use crate::devices::interbus::jobs::check_link;
use crate::devices::interbus::procedures::LinkParameters;
use crate::devices::interbus::sim::Config;
use crate::link::{LinkScheme, LinkUrl};
use crate::parameter::{Entry, ParameterGroup as _};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InterbusLinkKind {
    /// Virtual encoder in this process, behind a virtual gateway.
    #[default]
    Virtual,
    Gateway,
    Replay,
}

/// Entries of the connection form. An empty entry means the default. The entries for other connection types are kept,
/// but do not appear in the link.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InterbusForm {
    pub kind: InterbusLinkKind,
    pub host: String,
    /// TCP port. If it is empty, port 502 is used.
    pub tcp_port: String,
    pub file: String,
    /// Entries for the remaining parameters.
    pub typed: EnteredValues,
    /// Whether the first of the two registers contains the low word.
    pub low_first: bool,
    /// Parameters of the link for which the form has no entry.
    pub rest: Vec<(String, String)>,
}

/// Link parameter and value that put the low word first.
const LOW_FIRST: (&str, &str) = ("order", "low-first");
const PORT: &str = "502";

impl FormModel for InterbusForm {
    type Finder = NoFinder<Self>;

    // The window initially offers this virtual encoder, which is a slowly turning machine with cams.
    fn default_link() -> LinkUrl {
        let mut url = LinkUrl::simulated();
        for (name, value) in [("rpm", "6"), ("steps", "3600"), ("revolutions", "1"), ("cams", "demo")] {
            url.query.set(name, value);
        }
        url
    }

    fn from_url(url: &LinkUrl) -> Self {
        let way = match url.scheme {
            LinkScheme::Sim => InterbusLinkKind::Virtual,
            LinkScheme::Replay => InterbusLinkKind::Replay,
            LinkScheme::Modbus | LinkScheme::Bridge | LinkScheme::Serial | LinkScheme::Tcp | LinkScheme::Enip => {
                InterbusLinkKind::Gateway
            }
        };
        let mut form = InterbusForm { kind: way, ..InterbusForm::default() };
        match form.kind {
            InterbusLinkKind::Replay => form.file = url.target.clone(),
            InterbusLinkKind::Gateway => (form.host, form.tcp_port) = split_host_default_port(&url.target, PORT),
            InterbusLinkKind::Virtual => {}
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
        "modbus:192.168.1.10"
    }
}

impl InterbusForm {
    /// Returns the form entries that affect the link. A virtual encoder has additional ones.
    pub fn entries(&self) -> Vec<Entry> {
        let own = if self.kind == InterbusLinkKind::Virtual { Config::entries() } else { Vec::new() };
        [own, LinkParameters::entries()].concat()
    }

    /// Returns the entries that locate the words in the gateway, then the other entries, which are rarely needed.
    pub fn link_entries() -> (Vec<Entry>, Vec<Entry>) {
        LinkParameters::entries().into_iter().partition(|own| ["unit", "input", "output"].contains(&own.key))
    }

    pub fn virtual_device_entries() -> Vec<Entry> {
        Config::entries()
    }

    /// Fills in the input field of a parameter. Returns `false` if no input field can show the value.
    fn fill_entry(&mut self, name: &str, value: &str) -> bool {
        let is_low_first = (name, value) == LOW_FIRST;
        self.low_first |= is_low_first;
        is_low_first || self.typed.fill_entry(&self.entries(), name, value)
    }

    fn target(&self) -> Result<(LinkScheme, String), Text> {
        Ok(match self.kind {
            InterbusLinkKind::Virtual => (LinkScheme::Sim, String::new()),
            InterbusLinkKind::Gateway => (
                LinkScheme::Modbus,
                format_host_and_optional_port(&self.host, "form.gateway_missing", &self.tcp_port, PORT)?,
            ),
            InterbusLinkKind::Replay => (LinkScheme::Replay, required_entry(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Parameters {
        let is_virtual = self.kind == InterbusLinkKind::Virtual;
        let mut parameters = Parameters::default();
        parameters.add_typed_entries(&self.entries(), &self.typed);
        if self.low_first {
            parameters.set(LOW_FIRST.0, LOW_FIRST.1);
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
            "sim:?cams=demo&rpm=6",
            "sim:?rpm=-60&fault=drop:0.01&order=low-first&input=4",
            "modbus:gateway:502",
            "modbus:192.168.1.9:1502?unit=3&input=4&output=6&order=low-first&handshake=500",
            "replay:monday.trace",
        ];
        assert_round_trip(&links, |url| InterbusForm::from_url(url).url());
    }

    #[test]
    fn rejection_names_invalid_entry() {
        let refused = |change: fn(&mut InterbusForm)| {
            let mut form = InterbusForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.kind = InterbusLinkKind::Gateway), "form.gateway_missing");
        assert_eq!(refused(|form| form.kind = InterbusLinkKind::Replay), "form.file_missing");
        assert_eq!(refused(|form| form.typed.set("rpm", "fast")), "form.rpm");
        assert_eq!(refused(|form| form.typed.set("fault", "drop:2")), "form.fault");
        assert_eq!(refused(|form| form.typed.set("unit", "300")), "form.parameter");
        assert_eq!(refused(|form| form.typed.set("input", "x")), "form.parameter");
    }

    #[test]
    fn switching_interface_drops_other_settings() {
        let mut form = InterbusForm::from_url(&"sim:?rpm=60&busy=5&unit=7".parse().unwrap());
        (form.kind, form.host) = (InterbusLinkKind::Gateway, "gate".to_owned());
        assert_eq!(form.url().unwrap().to_string(), "modbus:gate:502?unit=7");
    }
}
