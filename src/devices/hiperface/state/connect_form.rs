//! The connection form for HIPERFACE encoders. It creates a link but does not open it.

use super::search::EncoderSearchForm;
use crate::app::Text;
use crate::app::connect::form::FormModel;
use crate::app::connect::parameters::{EnteredValues, Parameters, parameters_without_entry};
use crate::app::connect::target::{
    adapter_network_address, for_adapter, host_and_port, optional_entry, rejection_text, required_entry, split_target,
};
use crate::buses::bridge::procedures::SupplyAfterSession;
use crate::devices::hiperface::jobs::check_link;
use crate::devices::hiperface::procedures::{AdapterParameters, Echo, LinkParameters, MAX_PERIODS};
use crate::devices::hiperface::protocol::{BROADCAST, DeviceAddress};
use crate::devices::hiperface::sim::{Config, MODELS};
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::forms::with_address_range;
use crate::link::{LinkScheme, LinkUrl, PORT_EXAMPLE, UrlError};
use crate::parameter::{Entry, ParameterGroup as _, ParameterValues as _, select_entries};
use crate::sim::ConfigError;
use crate::units::{Baud, CharacterFormat, Parity};
use crate::worker::OpenError;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkKind {
    #[default]
    Virtual,
    Serial,
    Tcp,
    /// An adapter with a serial line.
    Adapter,
    Replay,
}

/// Entries of the connection form. An empty entry selects the default. Entries for other kinds of connection are kept,
/// but they do not become part of the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkForm {
    pub kind: LinkKind,
    /// Whether the adapter is connected over a network instead of a local serial port.
    pub network: bool,
    pub port: String,
    pub host: String,
    pub tcp_port: String,
    pub file: String,
    pub baud: Baud,
    pub parity: Parity,
    /// Address in hexadecimal, such as `40`, `0x40` or `40h`, or the word `broadcast`.
    pub address: String,
    pub echo: Echo,
    /// Whether the encoder's time-out is 44 bits rather than 11 bits.
    pub long_timeout: bool,
    pub model: String,
    /// Whether the adapter leaves the encoder's supply on after disconnecting.
    pub leave_supply: bool,
    /// Values of the remaining parameters, as entered.
    pub typed: EnteredValues,
    /// Names and values of link parameters that have no input field.
    pub rest: Vec<(String, String)>,
}

const BROADCAST_WORD: &str = "broadcast";

impl Default for LinkForm {
    fn default() -> Self {
        let [model, ..] = MODELS;
        LinkForm {
            kind: LinkKind::default(),
            network: false,
            port: String::new(),
            host: String::new(),
            tcp_port: String::new(),
            file: String::new(),
            baud: CharacterFormat::FACTORY.baud,
            parity: CharacterFormat::FACTORY.parity,
            address: address_text(DeviceAddress::FACTORY.byte()),
            echo: Echo::Unknown,
            long_timeout: true,
            model: model.name.to_owned(),
            leave_supply: false,
            typed: EnteredValues::default(),
            rest: Vec::new(),
        }
    }
}

impl FormModel for LinkForm {
    type Finder = EncoderSearchForm;

    fn default_link() -> LinkUrl {
        LinkUrl::simulated()
    }

    fn from_url(url: &LinkUrl) -> Self {
        let mut form = LinkForm::default();
        let target = url.target.clone();
        match url.scheme {
            LinkScheme::Sim => form.kind = LinkKind::Virtual,
            LinkScheme::Serial => (form.kind, form.port) = (LinkKind::Serial, target),
            LinkScheme::Replay => (form.kind, form.file) = (LinkKind::Replay, target),
            // These schemes are not used for HIPERFACE encoders.
            LinkScheme::Modbus | LinkScheme::Enip => {}
            LinkScheme::Bridge => {
                form.kind = LinkKind::Adapter;
                match adapter_network_address(&target) {
                    Some(address) => {
                        form.network = true;
                        (form.host, form.tcp_port) = split_target(address);
                    }
                    None => form.port = target,
                }
            }
            LinkScheme::Tcp => {
                form.kind = LinkKind::Tcp;
                (form.host, form.tcp_port) = split_target(&target);
            }
        }
        form.rest = parameters_without_entry(&url.query, |name, value| form.fill_entry(name, value));
        form
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        let target = self.target()?;
        let url = self.parameters()?.build_link(target)?;
        check_link(&url).map_err(|error| self.link_error_text(&url, &error))?;
        Ok(url)
    }

    fn set_file(&mut self, file: String) {
        self.file = file;
    }

    fn example_link(&self) -> &'static str {
        if self.kind == LinkKind::Adapter { PORT_EXAMPLE.bridge } else { PORT_EXAMPLE.serial }
    }
}

impl LinkForm {
    /// Returns the names of the virtual encoder models, starting with the default.
    pub fn model_names() -> impl Iterator<Item = &'static str> {
        MODELS.iter().map(|model| model.name)
    }

    /// Returns the virtual encoder's parameters for which the form has a text entry.
    pub fn virtual_device_entries() -> Vec<Entry> {
        select_entries(&Config::entries(), &["rpm", "fault"])
    }

    pub fn link_entries() -> Vec<Entry> {
        LinkParameters::entries()
    }

    pub fn adapter_entries() -> Vec<Entry> {
        AdapterParameters::entries()
    }

    /// Returns the parameters for which the form has a text entry.
    fn entries(&self) -> Vec<Entry> {
        let own = match self.kind {
            LinkKind::Virtual => Self::virtual_device_entries(),
            LinkKind::Adapter => Self::adapter_entries(),
            LinkKind::Serial | LinkKind::Tcp | LinkKind::Replay => Vec::new(),
        };
        [own, Self::link_entries()].concat()
    }

    /// Fills in the input field for a parameter. Returns `false` if there is no input field for the value.
    fn fill_entry(&mut self, name: &str, value: &str) -> bool {
        if (name, self.kind) == ("model", LinkKind::Virtual) {
            value.clone_into(&mut self.model);
            return true;
        }
        if (name, self.kind) == (SupplyAfterSession::LEAVE_SUPPLY_ON.0, LinkKind::Adapter) {
            self.leave_supply = value == SupplyAfterSession::LEAVE_SUPPLY_ON.1;
            return self.leave_supply;
        }
        self.typed.fill_entry(&self.entries(), name, value) || self.set_choice(name, value)
    }

    fn set_choice(&mut self, name: &str, value: &str) -> bool {
        let (baud, parity, echo, long_timeout) = (self.baud, self.parity, self.echo, self.long_timeout);
        let mut link = LinkParameters { baud, parity, echo, long_timeout, ..LinkParameters::default() };
        let is_taken = link.set_value(name, value).unwrap_or(false);
        (self.baud, self.parity, self.echo, self.long_timeout) = (link.baud, link.parity, link.echo, link.long_timeout);
        if is_taken && name == "address" {
            self.address = address_text(link.address);
        }
        is_taken
    }

    fn target(&self) -> Result<(LinkScheme, String), Text> {
        match self.kind {
            LinkKind::Virtual => Ok((LinkScheme::Sim, String::new())),
            LinkKind::Adapter if self.network => Ok((LinkScheme::Bridge, for_adapter(&self.host, &self.tcp_port)?)),
            LinkKind::Adapter => Ok((LinkScheme::Bridge, required_entry(&self.port, "form.port_missing")?)),
            LinkKind::Serial => Ok((LinkScheme::Serial, required_entry(&self.port, "form.port_missing")?)),
            LinkKind::Replay => Ok((LinkScheme::Replay, required_entry(&self.file, "form.file_missing")?)),
            LinkKind::Tcp => Ok((LinkScheme::Tcp, host_and_port(&self.host, &self.tcp_port)?)),
        }
    }

    fn parameters(&self) -> Result<Parameters, Text> {
        let usual = LinkForm::default();
        let mut parameters = Parameters::default();
        if self.kind == LinkKind::Virtual {
            if optional_entry(&self.model).is_some_and(|model| model != usual.model) {
                parameters.entry("model", &self.model);
            }
            parameters.add_typed_entries(&Self::virtual_device_entries(), &self.typed);
        }
        if self.kind == LinkKind::Adapter {
            parameters.add_typed_entries(&Self::adapter_entries(), &self.typed);
            if self.leave_supply {
                parameters.set(SupplyAfterSession::LEAVE_SUPPLY_ON.0, SupplyAfterSession::LEAVE_SUPPLY_ON.1);
            }
        }
        if self.baud != usual.baud {
            parameters.set("baud", &self.baud.to_string());
        }
        if self.parity != usual.parity {
            parameters.set("parity", self.parity.keyword());
        }
        let address = self.address_byte()?;
        if address != DeviceAddress::FACTORY.byte() {
            parameters.set("address", &format!("0x{address:02X}"));
        }
        if self.echo != Echo::Unknown {
            parameters.set("echo", &Echo::KEYWORDS.format_example(&self.echo));
        }
        if !self.long_timeout {
            parameters.set("timeout", "11");
        }
        parameters.add_typed_entries(&Self::link_entries(), &self.typed);
        parameters.add_remaining(&self.rest, self.kind == LinkKind::Virtual, (LinkParameters::KEYS, Config::KEYS));
        Ok(parameters)
    }

    fn address_byte(&self) -> Result<u8, Text> {
        let entry = self.address.trim();
        if entry.is_empty() {
            return Ok(DeviceAddress::FACTORY.byte());
        }
        if entry.eq_ignore_ascii_case(BROADCAST_WORD) {
            return Ok(BROADCAST);
        }
        let digits = entry.strip_prefix("0x").or_else(|| entry.strip_prefix("0X")).unwrap_or(entry);
        let digits = digits.strip_suffix(['h', 'H']).unwrap_or(digits);
        u8::from_str_radix(digits, 16).map_err(|_| with_address_range(TEXTS.text("form.address")).with("value", entry))
    }

    fn link_error_text(&self, url: &LinkUrl, error: &OpenError) -> Text {
        let (OpenError::Url(UrlError::Value { name, value, .. })
        | OpenError::Sim(ConfigError::Value { key: name, value, .. })) = error
        else {
            return rejection_text(url, error);
        };
        let id = match name.as_str() {
            "address" => {
                let of_the_virtual = matches!(error, OpenError::Sim(_));
                let id = if of_the_virtual { "form.address_virtual" } else { "form.address" };
                return with_address_range(TEXTS.text(id)).with("value", self.address.trim());
            }
            "model" => {
                let models = Self::model_names().collect::<Vec<_>>().join(", ");
                return TEXTS.text("form.model").with("value", value).with("models", models);
            }
            "periods" => "form.periods",
            "turns" if self.typed.get("periods").trim().is_empty() => "form.turns_alone",
            "turns" => "form.turns",
            _ => return rejection_text(url, error),
        };
        TEXTS.text(id).with("value", value).with("most", MAX_PERIODS)
    }
}

fn address_text(address: u8) -> String {
    if address == BROADCAST { BROADCAST_WORD.to_owned() } else { format!("{address:02X}") }
}

#[cfg(test)]
mod tests;
