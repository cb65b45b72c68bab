//! The connection form and its link. Nothing is opened here; allowed values come from the station and the virtual
//! encoder.

use std::time::Duration;

use super::search::SearchFinder;
use crate::app::Text;
use crate::app::connect::form::FormModel;
use crate::app::connect::parameters::{Parameters, without_entry};
use crate::app::connect::target::{entered, filled, host_and_port, parted, refused};
use crate::devices::hiperface::jobs::check;
use crate::devices::hiperface::procedures::{Echo, LinkParameters, MOST_PERIODS, Station};
use crate::devices::hiperface::protocol::{BROADCAST, DeviceAddress};
use crate::devices::hiperface::sim::{Config, MODELS};
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::forms::with_addresses;
use crate::link::{LinkUrl, Query, Scheme, UrlError};
use crate::sim::ConfigError;
use crate::units::{Baud, CharacterFormat, Parity};
use crate::worker::OpenError;

/// The kind of connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinkKind {
    /// The virtual encoder in this program.
    #[default]
    Virtual,
    /// A serial port.
    Serial,
    /// A serial device server.
    Tcp,
    /// A recorded trace.
    Replay,
}

/// Entries of the connection form. Entries of another kind of link are kept and left out of the link. An empty entry means
/// the default.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkForm {
    pub kind: LinkKind,
    /// Serial port.
    pub port: String,
    /// Name or address of a device server.
    pub host: String,
    pub tcp_port: String,
    /// The recording.
    pub file: String,
    /// Speed.
    pub baud: Baud,
    pub parity: Parity,
    /// `40`, `0x40` or `40h`, always hexadecimal; or `broadcast`.
    pub address: String,
    /// Whether the adapter echoes; unknown: detect it.
    pub echo: Echo,
    /// If set, the encoder's time-out is 44 bits, else 11.
    pub long_timeout: bool,
    /// Milliseconds that a reply may come later than the protocol's worst case.
    pub margin: String,
    /// Periods in a revolution, for a type that is not in the table.
    pub periods: String,
    /// Turns, for a type that is not in the table.
    pub turns: String,
    /// Model of the virtual encoder.
    pub model: String,
    /// Its speed in revolutions per minute.
    pub rpm: String,
    /// Injected faults.
    pub fault: String,
    /// Parameters of the link that have no entry, or a value that their entry cannot show.
    pub rest: Vec<(String, String)>,
}

const BROADCAST_WORD: &str = "broadcast";

impl Default for LinkForm {
    fn default() -> Self {
        let [model, ..] = MODELS;
        LinkForm {
            kind: LinkKind::default(),
            port: String::new(),
            host: String::new(),
            tcp_port: String::new(),
            file: String::new(),
            baud: CharacterFormat::FACTORY.baud,
            parity: CharacterFormat::FACTORY.parity,
            address: address_words(DeviceAddress::FACTORY.byte()),
            echo: Echo::Unknown,
            long_timeout: true,
            margin: String::new(),
            periods: String::new(),
            turns: String::new(),
            model: model.name.to_owned(),
            rpm: String::new(),
            fault: String::new(),
            rest: Vec::new(),
        }
    }
}

impl FormModel for LinkForm {
    type Finder = SearchFinder;

    fn usual() -> LinkUrl {
        LinkUrl::sim()
    }

    fn from_url(url: &LinkUrl) -> Self {
        let mut form = LinkForm::default();
        let target = url.target.clone();
        match url.scheme {
            Scheme::Sim => form.kind = LinkKind::Virtual,
            Scheme::Serial => (form.kind, form.port) = (LinkKind::Serial, target),
            Scheme::Replay => (form.kind, form.file) = (LinkKind::Replay, target),
            // These do not lead to a HIPERFACE encoder.
            Scheme::Bridge | Scheme::Modbus | Scheme::Enip => {}
            Scheme::Tcp => {
                form.kind = LinkKind::Tcp;
                (form.host, form.tcp_port) = parted(&target);
            }
        }
        form.rest = without_entry(&url.query, |name, value| form.take(name, value));
        form
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        let target = self.target()?;
        let url = self.parameters()?.link(target)?;
        check(&url).map_err(|error| self.refused(&url, &error))?;
        Ok(url)
    }

    fn set_file(&mut self, file: String) {
        self.file = file;
    }

    fn example(&self) -> &'static str {
        "serial:/dev/ttyUSB0"
    }
}

impl LinkForm {
    /// Returns the virtual encoders to choose from, the usual one first.
    pub fn models() -> impl Iterator<Item = &'static str> {
        MODELS.iter().map(|model| model.name)
    }

    /// Fills in the entry of a parameter; returns false if no entry can show it.
    fn take(&mut self, name: &str, value: &str) -> bool {
        let entry = match name {
            "margin" => &mut self.margin,
            "periods" => &mut self.periods,
            "turns" => &mut self.turns,
            "model" if self.kind == LinkKind::Virtual => &mut self.model,
            "rpm" if self.kind == LinkKind::Virtual => &mut self.rpm,
            "fault" if self.kind == LinkKind::Virtual => &mut self.fault,
            _ => return self.take_choice(name, value),
        };
        value.clone_into(entry);
        true
    }

    fn take_choice(&mut self, name: &str, value: &str) -> bool {
        let Ok(query) = format!("{name}={value}").parse::<Query>() else { return false };
        let Ok(station) = Station::from_query(&query, Duration::ZERO) else { return false };
        match name {
            "baud" => self.baud = station.format.baud,
            "parity" => self.parity = station.format.parity,
            "address" => self.address = address_words(station.address),
            "echo" => self.echo = station.line.echo,
            "timeout" => self.long_timeout = station.long_timeout,
            _ => return false,
        }
        true
    }

    fn target(&self) -> Result<(Scheme, String), Text> {
        match self.kind {
            LinkKind::Virtual => Ok((Scheme::Sim, String::new())),
            LinkKind::Serial => Ok((Scheme::Serial, entered(&self.port, "form.port_missing")?)),
            LinkKind::Replay => Ok((Scheme::Replay, entered(&self.file, "form.file_missing")?)),
            LinkKind::Tcp => Ok((Scheme::Tcp, host_and_port(&self.host, &self.tcp_port)?)),
        }
    }

    fn parameters(&self) -> Result<Parameters, Text> {
        let usual = LinkForm::default();
        let mut parameters = Parameters::default();
        if self.kind == LinkKind::Virtual {
            if filled(&self.model).is_some_and(|model| model != usual.model) {
                parameters.entry("model", &self.model);
            }
            parameters.decimal("rpm", &self.rpm);
            parameters.entry("fault", &self.fault);
        }
        if self.baud != usual.baud {
            parameters.set("baud", &self.baud.to_string());
        }
        if self.parity != usual.parity {
            parameters.set("parity", self.parity.word());
        }
        let address = self.address_byte()?;
        if address != DeviceAddress::FACTORY.byte() {
            parameters.set("address", &format!("0x{address:02X}"));
        }
        match self.echo {
            Echo::Unknown => {}
            Echo::On => parameters.set("echo", "on"),
            Echo::Off => parameters.set("echo", "off"),
        }
        if !self.long_timeout {
            parameters.set("timeout", "11");
        }
        parameters.entry("margin", &self.margin);
        parameters.entry("periods", &self.periods);
        parameters.entry("turns", &self.turns);
        // Parameters of a virtual encoder do not apply to the others.
        parameters.rest(&self.rest, |name| self.kind == LinkKind::Virtual || !virtual_only(name));
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
        u8::from_str_radix(digits, 16).map_err(|_| with_addresses(TEXTS.text("form.address")).with("value", entry))
    }

    fn refused(&self, url: &LinkUrl, error: &OpenError) -> Text {
        let (OpenError::Url(UrlError::Value { name, value, .. })
        | OpenError::Sim(ConfigError::Value { key: name, value, .. })) = error
        else {
            return refused(url, error);
        };
        let id = match name.as_str() {
            "address" => {
                let of_the_virtual = matches!(error, OpenError::Sim(_));
                let id = if of_the_virtual { "form.address_virtual" } else { "form.address" };
                return with_addresses(TEXTS.text(id)).with("value", self.address.trim());
            }
            "model" => {
                let models = Self::models().collect::<Vec<_>>().join(", ");
                return TEXTS.text("form.model").with("value", value).with("models", models);
            }
            "periods" => "form.periods",
            "turns" if self.periods.trim().is_empty() => "form.turns_alone",
            "turns" => "form.turns",
            _ => return refused(url, error),
        };
        TEXTS.text(id).with("value", value).with("most", MOST_PERIODS)
    }
}

fn address_words(address: u8) -> String {
    if address == BROADCAST { BROADCAST_WORD.to_owned() } else { format!("{address:02X}") }
}

fn virtual_only(name: &str) -> bool {
    Config::KEYS.contains(&name) && !LinkParameters::KEYS.contains(&name)
}

#[cfg(test)]
mod tests;
