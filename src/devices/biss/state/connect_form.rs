//! The connection form for BiSS C encoders. It creates a link, but does not open it.

use crate::app::Text;
use crate::app::connect::form::{FormModel, NoFinder};
use crate::app::connect::parameters::{EnteredValues, Parameters, parameters_without_entry};
use crate::app::connect::target::{
    adapter_network_address, for_adapter, host_and_port, required_entry, split_target, validated_link,
};
use crate::bits::ByteOrder;
use crate::buses::bridge::procedures::SupplyAfterSession;
use crate::buses::bridge::sim as bridge;
use crate::buses::ubicom::protocol::FORMAT;
use crate::devices::biss::jobs::check_link;
use crate::devices::biss::procedures::{
    BusParameters, Echo, FrameParameters, LineParameters, ORDERS, PinParameters, Transport,
};
use crate::devices::biss::sim;
use crate::kinds::attachable_kinds;
use crate::link::{LinkScheme, LinkUrl, PORT_EXAMPLE};
use crate::parameter::{Entry, ParameterGroup as _, ParameterValues, select_entries};
use crate::units::Parity;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BissLinkKind {
    #[default]
    Virtual,
    Pin,
    Bus,
    Replay,
}

/// Values entered in the connection form. An empty entry stands for the default. Entries for other kinds of connection
/// are kept, but do not appear in the link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BissForm {
    pub kind: BissLinkKind,
    /// Whether the virtual encoder is behind a virtual adapter, or the recording was made through an adapter.
    pub behind_adapter: bool,
    /// Whether the link uses a network instead of a local serial port.
    pub network: bool,
    pub port: String,
    pub host: String,
    pub tcp_port: String,
    pub file: String,
    pub parity: Parity,
    /// Byte order of register numbers on the configuration pin, or `None` to detect it.
    pub order: Option<ByteOrder>,
    pub echo: Echo,
    /// Whether the adapter leaves the encoder's supply on after disconnecting.
    pub leave_supply: bool,
    /// Values of all other parameters, as entered.
    pub typed: EnteredValues,
    /// Link parameters that the form cannot show, with their values.
    pub rest: Vec<(String, String)>,
}

/// Link parameter that connects the virtual encoder through a virtual adapter.
const BRIDGE: (&str, &str) = ("bridge", "on");

impl Default for BissForm {
    fn default() -> Self {
        let none = String::new;
        BissForm {
            kind: BissLinkKind::default(),
            behind_adapter: true,
            network: false,
            port: none(),
            host: none(),
            tcp_port: none(),
            file: none(),
            parity: FORMAT.parity,
            order: None,
            echo: Echo::Unknown,
            leave_supply: false,
            typed: EnteredValues::default(),
            rest: Vec::new(),
        }
    }
}

impl FormModel for BissForm {
    type Finder = NoFinder<Self>;

    // By default, the window offers a virtual encoder behind an adapter, so that every feature is available.
    fn default_link() -> LinkUrl {
        let mut url = LinkUrl::simulated();
        url.query.set(BRIDGE.0, BRIDGE.1);
        url
    }

    fn from_url(url: &LinkUrl) -> Self {
        let mut form = BissForm { behind_adapter: false, ..BissForm::default() };
        let target = url.target.as_str();
        let network = match url.scheme {
            LinkScheme::Tcp => Some(target),
            LinkScheme::Bridge => adapter_network_address(target),
            _ => None,
        };
        form.kind = match url.scheme {
            LinkScheme::Sim => BissLinkKind::Virtual,
            LinkScheme::Serial | LinkScheme::Tcp | LinkScheme::Modbus | LinkScheme::Enip => BissLinkKind::Pin,
            LinkScheme::Bridge => BissLinkKind::Bus,
            LinkScheme::Replay => BissLinkKind::Replay,
        };
        if let Some(network) = network {
            form.network = true;
            (form.host, form.tcp_port) = split_target(network);
        } else if form.kind == BissLinkKind::Replay {
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
        if self.uses_bus() { PORT_EXAMPLE.bridge } else { PORT_EXAMPLE.serial }
    }
}

impl BissForm {
    /// Fills in the form field for a parameter. Returns `false` if no field can show the value.
    fn fill_entry(&mut self, name: &str, value: &str) -> bool {
        if name == SupplyAfterSession::LEAVE_SUPPLY_ON.0 {
            self.leave_supply = value == SupplyAfterSession::LEAVE_SUPPLY_ON.1;
            return self.leave_supply;
        }
        match name {
            "bridge" if self.supports_pin_and_bus() => {
                self.behind_adapter = value == BRIDGE.1;
                self.behind_adapter
            }
            "parity" | "order" | "echo" => self.set_choice(name, value),
            _ => self.typed.fill_entry(&self.entries(), name, value),
        }
    }

    fn set_choice(&mut self, name: &str, value: &str) -> bool {
        let mut pin = PinParameters { parity: self.parity, order: self.order, echo: self.echo, ..Default::default() };
        let is_taken = pin.set_value(name, value).unwrap_or(false);
        (self.parity, self.order, self.echo) = (pin.parity, pin.order, pin.echo);
        is_taken
    }

    pub fn virtual_device_entries() -> Vec<Entry> {
        select_entries(&sim::Config::entries(), &["rpm", "fault"])
    }

    pub fn bus_entries() -> Vec<Entry> {
        BusParameters::entries()
    }

    /// Returns the form entries for the configuration pin, with the baud rate separate from the others.
    pub fn pin_entries() -> (Vec<Entry>, Vec<Entry>) {
        PinParameters::entries().into_iter().partition(|own| own.key == "baud")
    }

    /// Returns the entries for the frame and those for the line. Both apply to every kind of connection.
    pub fn common_entries() -> (Vec<Entry>, Vec<Entry>) {
        (FrameParameters::entries(), LineParameters::entries())
    }

    fn entries(&self) -> Vec<Entry> {
        let own = if self.kind == BissLinkKind::Virtual { Self::virtual_device_entries() } else { Vec::new() };
        let (frame, line) = Self::common_entries();
        [own, Self::bus_entries(), PinParameters::entries(), frame, line].concat()
    }

    /// Returns whether the encoder is connected to the bus of a real or virtual adapter.
    pub fn uses_bus(&self) -> bool {
        self.kind == BissLinkKind::Bus || (self.supports_pin_and_bus() && self.behind_adapter)
    }

    /// Returns whether this kind of link supports both the configuration pin and the bus.
    pub fn supports_pin_and_bus(&self) -> bool {
        matches!(self.kind, BissLinkKind::Virtual | BissLinkKind::Replay)
    }

    fn target(&self) -> Result<(LinkScheme, String), Text> {
        let port = || required_entry(&self.port, "form.port_missing");
        Ok(match self.kind {
            BissLinkKind::Virtual => (LinkScheme::Sim, String::new()),
            BissLinkKind::Pin if self.network => (LinkScheme::Tcp, host_and_port(&self.host, &self.tcp_port)?),
            BissLinkKind::Pin => (LinkScheme::Serial, port()?),
            BissLinkKind::Bus if self.network => (LinkScheme::Bridge, for_adapter(&self.host, &self.tcp_port)?),
            BissLinkKind::Bus => (LinkScheme::Bridge, port()?),
            BissLinkKind::Replay => (LinkScheme::Replay, required_entry(&self.file, "form.file_missing")?),
        })
    }

    fn parameters(&self) -> Parameters {
        let mut parameters = Parameters::default();
        if self.supports_pin_and_bus() && self.behind_adapter {
            parameters.set(BRIDGE.0, BRIDGE.1);
        }
        if self.kind == BissLinkKind::Virtual {
            parameters.add_typed_entries(&Self::virtual_device_entries(), &self.typed);
        }
        if self.uses_bus() {
            parameters.add_typed_entries(&Self::bus_entries(), &self.typed);
            if self.leave_supply {
                parameters.set(SupplyAfterSession::LEAVE_SUPPLY_ON.0, SupplyAfterSession::LEAVE_SUPPLY_ON.1);
            }
        } else {
            parameters.add_typed_entries(&PinParameters::entries(), &self.typed);
            if self.parity != FORMAT.parity {
                parameters.set("parity", self.parity.keyword());
            }
            if self.order.is_some() {
                parameters.set("order", &ORDERS.format_example(&self.order));
            }
            if self.echo != Echo::Unknown {
                parameters.set("echo", &Echo::KEYWORDS.format_example(&self.echo));
            }
        }
        let (frame, line) = Self::common_entries();
        parameters.add_typed_entries(&[frame, line].concat(), &self.typed);
        parameters.add_parameters_without_entry(&self.rest, |name| self.has_parameter(name));
        parameters
    }

    /// Returns whether a parameter belongs in a link of this kind. Parameters of other kinds are dropped. Unknown ones
    /// are kept, so that opening the link reports them.
    fn has_parameter(&self, name: &str) -> bool {
        let kind = if self.uses_bus() { Transport::Adapter } else { Transport::ConfigPin };
        let own = |kind: Transport| kind.parameters().contains(&name);
        let (encoder, adapter) =
            (sim::Config::KEYS.contains(&name), bridge::all_setting_names(attachable_kinds()).contains(&name));
        let of_the_virtual = self.kind == BissLinkKind::Virtual && (encoder || (adapter && self.behind_adapter));
        let elsewhere = own(Transport::ConfigPin) || own(Transport::Adapter) || encoder || adapter || name == BRIDGE.0;
        own(kind) || of_the_virtual || !elsewhere
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_round_trip_through_form() {
        for link in [
            "sim:",
            "sim:?bridge=on",
            "sim:?bridge=on&rpm=-500&fault=drop:0.01",
            "sim:?rpm=500&order=high-first&echo=on",
            "serial:/dev/ttyUSB0",
            "serial:COM3?order=low-first&echo=off&margin=200",
            "serial:/dev/ttyUSB0?baud=57600&parity=even&echo=on",
            "tcp:192.168.0.7:4001?baud=9600",
            "tcp:192.168.0.7:4001",
            "tcp:[::1]:4001",
            "bridge:/dev/ttyACM0?clock=2000000",
            "bridge:tcp:adapter:5000",
            // A value that the checkbox cannot represent remains in the link (issue 22.16).
            "bridge:/dev/ttyACM0?leave-supply=on",
            "bridge:tcp:adapter:5000?clock=2000000&leave-supply=on",
            "bridge:/dev/ttyACM0?leave-supply=off",
            // See issue 22.20.
            "bridge:/dev/ttyACM0?mt=12&st=19&crc=0x43",
            "serial:/dev/ttyUSB0?st=14&crc=none",
            "replay:monday.trace",
            "replay:monday.trace?bridge=on&clock=2000000",
            "sim:?bridge=on&noise=0.1&temperature=80",
        ] {
            let url: LinkUrl = link.parse().unwrap();
            assert_eq!(BissForm::from_url(&url).url().unwrap().to_string(), link);
        }
        assert_eq!(BissForm::default_link().to_string(), "sim:?bridge=on");
        assert_eq!(BissForm::default().url().unwrap(), BissForm::default_link());
    }

    #[test]
    fn switching_interface_drops_other_settings() {
        let other = |link: &str, change: fn(&mut BissForm)| {
            let mut form = BissForm::from_url(&link.parse().unwrap());
            change(&mut form);
            form.url().unwrap().to_string()
        };
        let to_pin: fn(&mut BissForm) = |form| (form.kind, form.port) = (BissLinkKind::Pin, "COM3".to_owned());
        assert_eq!(other("sim:?bridge=on&noise=0.1&temperature=80&rpm=5&margin=7", to_pin), "serial:COM3?margin=7");
        assert_eq!(other("bridge:COM3?clock=2000000&voltage=5&leave-supply=on", to_pin), "serial:COM3");
        assert_eq!(
            other("serial:COM3?timeout=50&order=low-first", |form| form.kind = BissLinkKind::Bus),
            "bridge:COM3"
        );
        assert_eq!(other("sim:?bridge=on&noise=0.1&rpm=5", |form| form.behind_adapter = false), "sim:?rpm=5");
    }

    #[test]
    fn names_invalid_entries() {
        let refused = |change: fn(&mut BissForm)| {
            let mut form = BissForm::default();
            change(&mut form);
            form.url().unwrap_err().id()
        };
        assert_eq!(refused(|form| form.kind = BissLinkKind::Pin), "form.port_missing");
        assert_eq!(refused(|form| form.kind = BissLinkKind::Bus), "form.port_missing");
        assert_eq!(refused(|form| (form.kind, form.network) = (BissLinkKind::Bus, true)), "form.host_missing");
        assert_eq!(refused(|form| form.kind = BissLinkKind::Replay), "form.file_missing");
        assert_eq!(refused(|form| form.typed.set("margin", "soon")), "form.margin");
        assert_eq!(refused(|form| form.typed.set("clock", "1")), "form.clock");
        assert_eq!(refused(|form| form.typed.set("rpm", "fast")), "form.rpm");
        assert_eq!(refused(|form| form.typed.set("fault", "drop:2")), "form.fault");
        assert_eq!(refused(|form| form.rest = vec![("motor".to_owned(), "none".to_owned())]), "form.parameter");
        let fast = |form: &mut BissForm| {
            (form.kind, form.port) = (BissLinkKind::Pin, "COM3".into());
            form.typed.set("baud", "fast");
        };
        assert_eq!(refused(fast), "form.parameter");
        assert_eq!(refused(|form| (form.kind, form.port) = (BissLinkKind::Pin, "a?b".to_owned())), "form.characters");
        let colour = |form: &mut BissForm| {
            (form.kind, form.port) = (BissLinkKind::Pin, "COM3".to_owned());
            form.rest = vec![("colour".to_owned(), "green".to_owned())];
        };
        assert_eq!(refused(colour), "form.other");
    }
}
