//! Network settings of a device: its TCP/IP object, the edited values, the effect of switches S1 and S2, and the
//! outcome at the next power-up (reference, section 1). This module sends nothing to the device.

use core::net::Ipv4Addr;

use crate::app::{Severity, Text};
use crate::buses::ethernet_ip::protocol::{AddressError, AddressSource, InterfaceConfiguration};
use crate::devices::hiperdrive::profile::NetworkSettings;
use crate::devices::hiperdrive::protocol::AddressSwitch;
use crate::devices::hiperdrive::state::TEXTS;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    /// Address source, attribute 3 of the TCP/IP object.
    pub source: AddressSource,
    pub address: String,
    pub mask: String,
    /// Default gateway, or empty if there is none.
    pub gateway: String,
    /// Name servers. An empty string stands for none.
    pub name_servers: [String; 2],
    pub domain: String,
}

/// Source of the IP address after the next power-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerUpAddress {
    Fixed(Ipv4Addr),
    Stored(Ipv4Addr),
    /// The stored address is selected, but there is none.
    NothingStored,
    Bootp,
    Dhcp,
    Unknown(u8),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Position {
    /// Switch positions as displayed, such as `0` or `1…96`.
    pub digits: &'static str,
    pub meaning: Text,
    pub is_now: bool,
}

impl Form {
    pub fn from_settings(settings: &NetworkSettings) -> Self {
        let own = &settings.interface;
        let text = |address: Ipv4Addr| if address.is_unspecified() { String::new() } else { address.to_string() };
        Form {
            source: settings.source,
            address: text(own.address),
            mask: text(own.mask),
            gateway: text(own.gateway),
            name_servers: own.name_servers.map(text),
            domain: own.domain.clone(),
        }
    }

    /// Returns whether addresses can be entered, which is the case only for the *stored* source. With other sources, a
    /// server assigns the addresses.
    pub fn are_addresses_editable(&self) -> bool {
        self.source == AddressSource::Stored
    }

    /// Returns the edited settings. The current addresses are kept if a server assigns the addresses.
    ///
    /// # Errors
    /// Returns an error with the reason if an entry is invalid.
    pub fn settings(&self, now: &NetworkSettings) -> Result<NetworkSettings, Text> {
        if !self.are_addresses_editable() {
            return Ok(NetworkSettings { source: self.source, interface: now.interface.clone() });
        }
        let [first, second] = &self.name_servers;
        let interface = InterfaceConfiguration {
            address: required_address("hd_net.address", &self.address)?,
            mask: required_address("hd_net.mask", &self.mask)?,
            gateway: address("hd_net.gateway", &self.gateway)?,
            name_servers: [address("hd_net.name_server", first)?, address("hd_net.name_server", second)?],
            domain: self.domain.trim().to_owned(),
        };
        interface.check_reachable().map_err(|why| address_error_text(&why))?;
        Ok(NetworkSettings { source: self.source, interface })
    }
}

/// Parses an address of four numbers separated by dots. An empty string stands for no address.
fn address(what: &'static str, text: &str) -> Result<Ipv4Addr, Text> {
    match text.trim() {
        "" => Ok(Ipv4Addr::UNSPECIFIED),
        own => own
            .parse()
            .map_err(|_| TEXTS.text("hd_net.no_address").with_text("what", TEXTS.text(what)).with("entry", own)),
    }
}

fn required_address(what: &'static str, text: &str) -> Result<Ipv4Addr, Text> {
    match text.trim() {
        "" => Err(Text::new("entry.missing").with_text("what", TEXTS.text(what))),
        own => address(what, own),
    }
}

/// Explains why the device would be unreachable with these settings.
pub fn address_error_text(error: &AddressError) -> Text {
    match error {
        AddressError::None => TEXTS.text("hd_net.none"),
        AddressError::Reserved(address) => TEXTS.text("hd_net.reserved").with("address", address),
        AddressError::Mask(mask) => TEXTS.text("hd_net.bad_mask").with("mask", mask),
        AddressError::Network(address) => TEXTS.text("hd_net.is_network").with("address", address),
        AddressError::Broadcast(address) => TEXTS.text("hd_net.is_broadcast").with("address", address),
        AddressError::GatewayOutside { gateway, network, prefix } => {
            TEXTS.text("hd_net.gateway_outside").with("gateway", gateway).with("network", format!("{network}/{prefix}"))
        }
        AddressError::Gateway(gateway) => TEXTS.text("hd_net.bad_gateway").with("gateway", gateway),
        AddressError::Domain(domain) => TEXTS.text("hd_net.bad_domain").with("domain", domain),
    }
}

impl PowerUpAddress {
    /// Returns the address source that results from the switches and the settings. If the switches are unreadable, they
    /// are taken to be at 0, since some devices have none.
    pub fn from_settings(switch: Option<AddressSwitch>, settings: &NetworkSettings) -> Self {
        let stored = match settings.interface.address {
            address if address.is_unspecified() => PowerUpAddress::NothingStored,
            address => PowerUpAddress::Stored(address),
        };
        match switch.unwrap_or(AddressSwitch::Object) {
            AddressSwitch::Fixed(address) => PowerUpAddress::Fixed(address),
            AddressSwitch::Stored => stored,
            AddressSwitch::Bootp => PowerUpAddress::Bootp,
            AddressSwitch::Dhcp => PowerUpAddress::Dhcp,
            AddressSwitch::Object => match settings.source {
                AddressSource::Stored => stored,
                AddressSource::Bootp => PowerUpAddress::Bootp,
                AddressSource::Dhcp => PowerUpAddress::Dhcp,
                AddressSource::Unknown(number) => PowerUpAddress::Unknown(number),
            },
        }
    }

    /// Returns the address after the next power-up, if it is already known.
    pub const fn address(self) -> Option<Ipv4Addr> {
        match self {
            PowerUpAddress::Fixed(address) | PowerUpAddress::Stored(address) => Some(address),
            PowerUpAddress::NothingStored
            | PowerUpAddress::Bootp
            | PowerUpAddress::Dhcp
            | PowerUpAddress::Unknown(_) => None,
        }
    }

    pub fn to_text(self) -> Text {
        match self {
            PowerUpAddress::Fixed(address) => TEXTS.text("hd_net.up_fixed").with("address", address),
            PowerUpAddress::Stored(address) => TEXTS.text("hd_net.up_stored").with("address", address),
            PowerUpAddress::NothingStored => TEXTS.text("hd_net.up_nothing"),
            PowerUpAddress::Bootp => TEXTS.text("hd_net.up_bootp"),
            PowerUpAddress::Dhcp => TEXTS.text("hd_net.up_dhcp"),
            PowerUpAddress::Unknown(number) => TEXTS.text("hd_net.up_unknown").with("number", number),
        }
    }
}

/// Describes the effect of the settings at the next power-up, and what this means for the link. `host` is the current
/// address of the device, if it is numeric.
pub fn consequence_texts(
    switch: Option<AddressSwitch>,
    now: &NetworkSettings,
    wanted: &NetworkSettings,
    host: Option<Ipv4Addr>,
) -> Vec<(Severity, Text)> {
    let after = PowerUpAddress::from_settings(switch, wanted);
    let mut texts = Vec::new();
    let decides = switch.filter(|own| *own != AddressSwitch::Object);
    // At 97, the stored addresses apply regardless of their source.
    let is_lost = decides.is_some_and(|own| own != AddressSwitch::Stored || now.source != wanted.source);
    if let Some(own) = decides.filter(|_| is_lost) {
        texts.push((Severity::Warning, TEXTS.text("hd_net.switch_decides").with("digits", own.number())));
    }
    let severity = match after {
        PowerUpAddress::NothingStored | PowerUpAddress::Unknown(_) => Severity::Warning,
        _ => Severity::Note,
    };
    texts.push((severity, after.to_text()));
    match (host, after.address()) {
        (Some(host), Some(address)) if host != address => {
            texts.push((Severity::Note, TEXTS.text("hd_net.then_at").with("address", address)));
        }
        (Some(_), None) => texts.push((Severity::Note, TEXTS.text("hd_net.then_find"))),
        _ => {}
    }
    if wanted.source == AddressSource::Stored && now.interface != wanted.interface {
        texts.push((Severity::Note, TEXTS.text("hd_net.maybe_now")));
    }
    texts
}

pub fn switch_positions(switch: Option<AddressSwitch>) -> [Position; 5] {
    let row = |digits, meaning, is_now| Position { digits, meaning: TEXTS.text(meaning), is_now };
    let at = |own: AddressSwitch| switch == Some(own);
    [
        row("0", "hd_net.switch_object", at(AddressSwitch::Object)),
        row("1…96", "hd_net.switch_fixed", matches!(switch, Some(AddressSwitch::Fixed(_)))),
        row("97", "hd_net.switch_stored", at(AddressSwitch::Stored)),
        row("98", "hd_net.switch_bootp", at(AddressSwitch::Bootp)),
        row("99", "hd_net.switch_dhcp", at(AddressSwitch::Dhcp)),
    ]
}

pub fn source(own: AddressSource) -> Text {
    match own {
        AddressSource::Stored => TEXTS.text("hd_net.source_stored"),
        AddressSource::Bootp => TEXTS.text("hd_net.source_bootp"),
        AddressSource::Dhcp => TEXTS.text("hd_net.source_dhcp"),
        AddressSource::Unknown(number) => TEXTS.text("hd_net.source_unknown").with("number", number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    fn settings(source: AddressSource, address: &str) -> NetworkSettings {
        let own = |text: &str| text.parse().unwrap();
        let interface = InterfaceConfiguration {
            address: own(address),
            mask: own("255.255.255.0"),
            gateway: Ipv4Addr::UNSPECIFIED,
            name_servers: [Ipv4Addr::UNSPECIFIED; 2],
            domain: String::new(),
        };
        NetworkSettings { source, interface }
    }

    /// The switches select one of five address sources (manual, section 5).
    #[test]
    fn switches_select_address_source() {
        let stored = Ipv4Addr::new(10, 0, 0, 7);
        let sources = [AddressSource::Stored, AddressSource::Bootp, AddressSource::Dhcp, AddressSource::Unknown(7)];
        let with = |digits: u8| {
            sources.map(|own| PowerUpAddress::from_settings(AddressSwitch::parse(digits), &settings(own, "10.0.0.7")))
        };
        let object =
            [PowerUpAddress::Stored(stored), PowerUpAddress::Bootp, PowerUpAddress::Dhcp, PowerUpAddress::Unknown(7)];
        assert_eq!(with(0), object);
        assert_eq!(with(12), [PowerUpAddress::Fixed(Ipv4Addr::new(192, 168, 1, 12)); 4]);
        assert_eq!(with(97), [PowerUpAddress::Stored(stored); 4]);
        assert_eq!(with(98), [PowerUpAddress::Bootp; 4]);
        assert_eq!(with(99), [PowerUpAddress::Dhcp; 4]);
        // A device may have no switches.
        assert_eq!(sources.map(|own| PowerUpAddress::from_settings(None, &settings(own, "10.0.0.7"))), object);
        let empty = settings(AddressSource::Stored, "0.0.0.0");
        assert_eq!(PowerUpAddress::from_settings(AddressSwitch::parse(0), &empty), PowerUpAddress::NothingStored);
    }

    #[test]
    fn checks_settings_before_planning() {
        let now = settings(AddressSource::Dhcp, "10.0.0.7");
        let form = |address: &str, mask: &str, gateway: &str| {
            let form = Form { source: AddressSource::Stored, ..Form::from_settings(&now) };
            let [address, mask, gateway] = [address, mask, gateway].map(ToOwned::to_owned);
            Form { address, mask, gateway, ..form }.settings(&now).map_err(|text| text.id())
        };
        assert_eq!(form("10.0.0.7", "255.255.255.0", ""), Ok(settings(AddressSource::Stored, "10.0.0.7")));
        let typed = form(" 192.168.1.50 ", "255.255.255.0", "192.168.1.1").unwrap();
        assert_eq!(typed.interface.gateway, Ipv4Addr::new(192, 168, 1, 1));
        for (address, mask, gateway, id) in [
            ("", "255.255.255.0", "", "entry.missing"),
            ("10.0.0.7", "", "", "entry.missing"),
            ("10.0.0", "255.255.255.0", "", "hd_net.no_address"),
            ("10.0.0.256", "255.255.255.0", "", "hd_net.no_address"),
            ("10.0.0.7", "/24", "", "hd_net.no_address"),
            ("0.0.0.0", "255.255.255.0", "", "hd_net.none"),
            ("127.0.0.1", "255.255.255.0", "", "hd_net.reserved"),
            ("10.0.0.7", "255.0.255.0", "", "hd_net.bad_mask"),
            ("10.0.0.0", "255.255.255.0", "", "hd_net.is_network"),
            ("10.0.0.255", "255.255.255.0", "", "hd_net.is_broadcast"),
            ("10.0.0.7", "255.255.255.0", "10.0.1.1", "hd_net.gateway_outside"),
            ("10.0.0.7", "255.255.255.0", "10.0.0.7", "hd_net.bad_gateway"),
        ] {
            assert_eq!(form(address, mask, gateway), Err(id), "{address} {mask} {gateway}");
        }
        // A server assigns the address, so an invalid entry does not matter.
        let dhcp = Form { address: "nonsense".to_owned(), ..Form::from_settings(&now) };
        assert_eq!(dhcp.settings(&now), Ok(now.clone()));
        let named = Form { source: AddressSource::Stored, domain: "two words".to_owned(), ..Form::from_settings(&now) };
        assert_eq!(named.settings(&now).unwrap_err().id(), "hd_net.bad_domain");
    }

    #[test]
    fn shows_consequences_before_writing() {
        let now = settings(AddressSource::Dhcp, "10.0.0.7");
        let host = Some(Ipv4Addr::new(10, 0, 0, 7));
        let ids = |digits: u8, wanted: &NetworkSettings| {
            let texts = consequence_texts(AddressSwitch::parse(digits), &now, wanted, host);
            for (_, text) in &texts {
                for language in [Language::English, Language::German] {
                    let words = text.to_string_in(language);
                    assert!(words != text.id() && !words.contains('{'), "{words}");
                }
            }
            texts.iter().map(|(_, text)| text.id()).collect::<Vec<_>>()
        };
        let same = settings(AddressSource::Stored, "10.0.0.7");
        let other = settings(AddressSource::Stored, "10.0.0.8");
        assert_eq!(ids(0, &same), ["hd_net.up_stored"]);
        assert_eq!(ids(0, &other), ["hd_net.up_stored", "hd_net.then_at", "hd_net.maybe_now"]);
        assert_eq!(ids(0, &settings(AddressSource::Bootp, "10.0.0.7")), ["hd_net.up_bootp", "hd_net.then_find"]);
        let fixed = ["hd_net.switch_decides", "hd_net.up_fixed", "hd_net.then_at", "hd_net.maybe_now"];
        assert_eq!(ids(12, &other), fixed);
        assert_eq!(
            ids(97, &other),
            ["hd_net.switch_decides", "hd_net.up_stored", "hd_net.then_at", "hd_net.maybe_now"]
        );
        assert_eq!(ids(99, &same), ["hd_net.switch_decides", "hd_net.up_dhcp", "hd_net.then_find"]);
    }

    #[test]
    fn switch_table_marks_current_position() {
        let now = |digits: u8| {
            let rows = switch_positions(AddressSwitch::parse(digits));
            rows.into_iter().filter(|row| row.is_now).map(|row| row.digits).collect::<Vec<_>>()
        };
        assert_eq!([0, 1, 96, 97, 98, 99].map(now), [["0"], ["1…96"], ["1…96"], ["97"], ["98"], ["99"]].map(Vec::from));
        assert!(switch_positions(None).iter().all(|row| !row.is_now));
    }
}
