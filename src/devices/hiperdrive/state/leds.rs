//! LED explanation: the user selects the LED states seen on the device, and gets their meanings and remedies. No
//! connection is needed.

use crate::app::{Severity, Text};
use crate::devices::hiperdrive::protocol::{
    DriveLedState, LedSubject, NetworkLed, NetworkLedState, PortLedState, Topology,
};
use crate::devices::hiperdrive::state::TEXTS;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leds {
    /// Whether the device is a hub, and not a bus adapter.
    pub hub: bool,
    /// Position of switch S3 of a hub: 0 for all drives, or the number of the drive that the RS485 LED stands for.
    pub s3: u8,
    /// State of the RS485 LED.
    pub drives: DriveLedState,
    /// State of the MS LED.
    pub module: NetworkLedState,
    pub network: NetworkLedState,
    pub port: PortLedState,
}

/// An LED of the device, or the two LEDs of a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Led {
    /// The RS485 LED.
    Drives,
    /// The MS or NS LED.
    Bus(NetworkLed),
    /// The two LEDs of port P1 or P2.
    Port,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LedMeaning {
    pub severity: Severity,
    pub meaning: Text,
    pub remedy: Text,
}

impl Default for Leds {
    /// Creates the LED states of a device without errors.
    fn default() -> Self {
        Leds {
            hub: true,
            s3: 0,
            drives: DriveLedState::Green,
            module: NetworkLedState::Green,
            network: NetworkLedState::Green,
            port: PortLedState::Active,
        }
    }
}

impl Led {
    pub const ALL: [Led; 4] = [Led::Drives, Led::Bus(NetworkLed::Module), Led::Bus(NetworkLed::Network), Led::Port];

    pub const fn name(self) -> &'static str {
        match self {
            Led::Drives => "RS485",
            Led::Bus(lamp) => lamp.name(),
            Led::Port => "P1/P2",
        }
    }
}

impl Leds {
    pub fn for_topology(topology: Topology) -> Self {
        Leds { hub: topology != Topology::Adapter, ..Leds::default() }
    }

    pub const fn led_subject(&self) -> LedSubject {
        match (self.hub, self.s3) {
            (false, _) => LedSubject::Adapter,
            (true, 0) => LedSubject::Drives,
            (true, _) => LedSubject::Drive,
        }
    }

    /// Sets the type of device and the position of S3. An LED whose state is then impossible is switched off.
    pub fn set_device(&mut self, hub: bool, s3: u8) {
        (self.hub, self.s3) = (hub, s3.min(8));
        if self.led_subject().row(self.drives).is_none() {
            self.drives = DriveLedState::Off;
        }
    }

    pub fn toggle(&mut self, lamp: Led) {
        match lamp {
            Led::Drives => {
                let lights: Vec<DriveLedState> = self.led_subject().rows().iter().map(|row| row.light).collect();
                self.drives = next(&lights, self.drives);
            }
            Led::Bus(NetworkLed::Module) => self.module = next(&BUS, self.module),
            Led::Bus(NetworkLed::Network) => self.network = next(&BUS, self.network),
            Led::Port => self.port = next(&[PortLedState::Off, PortLedState::Link, PortLedState::Active], self.port),
        }
    }

    pub fn led_meaning(&self, lamp: Led) -> LedMeaning {
        let (severity, meaning, remedy) = match lamp {
            Led::Drives => drives(self.led_subject(), self.drives),
            Led::Bus(lamp) => {
                network_led_row(lamp, if lamp == NetworkLed::Module { self.module } else { self.network })
            }
            Led::Port => port(self.port),
        };
        LedMeaning { severity, meaning: TEXTS.text(meaning), remedy: TEXTS.text(remedy) }
    }

    pub fn state_text(&self, lamp: Led) -> Text {
        TEXTS.text(match lamp {
            Led::Drives => match self.drives {
                DriveLedState::Off => "hd_led.off",
                DriveLedState::Green => "hd_led.green",
                DriveLedState::Red => "hd_led.red",
                DriveLedState::RedGreen => "hd_led.red_green",
                DriveLedState::GreenFlashing => "hd_led.green_flashing",
                DriveLedState::RedGreenFlashing => "hd_led.red_green_flashing",
                DriveLedState::Alternating => "hd_led.alternating",
            },
            Led::Bus(lamp) => match if lamp == NetworkLed::Module { self.module } else { self.network } {
                NetworkLedState::Off => "hd_led.off",
                NetworkLedState::Green => "hd_led.green",
                NetworkLedState::GreenFlashing => "hd_led.green_flashing",
                NetworkLedState::Red => "hd_led.red",
                NetworkLedState::RedFlashing => "hd_led.red_flashing",
                NetworkLedState::Alternating => "hd_led.alternating",
            },
            Led::Port => match self.port {
                PortLedState::Off => "hd_led.off",
                PortLedState::Link => "hd_led.green",
                PortLedState::Active => "hd_led.green_yellow",
            },
        })
    }
}

const BUS: [NetworkLedState; 6] = [
    NetworkLedState::Off,
    NetworkLedState::Green,
    NetworkLedState::GreenFlashing,
    NetworkLedState::RedFlashing,
    NetworkLedState::Red,
    NetworkLedState::Alternating,
];

/// Returns the element after `now`, or the first one if `now` is the last.
fn next<T: Copy + PartialEq>(all: &[T], now: T) -> T {
    let at = all.iter().position(|own| *own == now).map_or(0, |at| at + 1);
    all.get(at).or(all.first()).copied().unwrap_or(now)
}

/// Severity, and the message IDs of meaning and remedy. The English messages equal the phrases in the tables of
/// `protocol`.
type Row = (Severity, &'static str, &'static str);

fn drives(subject: LedSubject, light: DriveLedState) -> Row {
    use DriveLedState::{Alternating, Green, GreenFlashing, Off, Red, RedGreen, RedGreenFlashing};
    use LedSubject::{Adapter, Drive, Drives};
    use Severity::{Error, Good, Note, Warning};
    match (subject, light) {
        (Adapter | Drives, Off) => (Error, "hd_led.no_supply", "hd_led.check_supply"),
        (_, Alternating) => (Note, "hd_led.presence", "hd_led.wait"),
        (Adapter, Red) => (Error, "hd_led.adapter_red", "hd_led.adapter_red_do"),
        (Drives, Red) => (Error, "hd_led.hub_red", "hd_led.hub_red_do"),
        (Drive, Red) => (Error, "hd_led.drive_red", "hd_led.drive_red_do"),
        (Adapter | Drive, RedGreen) => (Error, "hd_led.drive_error", "hd_led.drive_error_do"),
        (Drives, RedGreen) => (Error, "hd_led.hub_error", "hd_led.hub_error_do"),
        (Adapter, GreenFlashing) => (Warning, "hd_led.adapter_flashing", "hd_led.adapter_flashing_do"),
        (Drives | Drive, GreenFlashing) => (Warning, "hd_led.hub_flashing", "hd_led.hub_flashing_do"),
        (Adapter, RedGreenFlashing) => (Warning, "hd_led.adapter_both", "hd_led.adapter_both_do"),
        (Drives | Drive, RedGreenFlashing) => (Warning, "hd_led.hub_both", "hd_led.hub_both_do"),
        (Adapter, Green) => (Good, "hd_led.drive_well", "hd_led.nothing"),
        (Drives, Green) => (Good, "hd_led.hub_well", "hd_led.nothing"),
        (Drive, Off) => (Note, "hd_led.absent", "hd_led.absent_do"),
        (Drive, Green) => (Good, "hd_led.drive_well", "hd_led.drive_well_do"),
    }
}

fn network_led_row(lamp: NetworkLed, light: NetworkLedState) -> Row {
    use NetworkLed::{Module, Network};
    use Severity::{Error, Good, Note, Warning};
    match (lamp, light) {
        (Module, NetworkLedState::Off) => (Error, "hd_led.no_supply", "hd_led.check_supply"),
        (Module, NetworkLedState::Green) => (Good, "hd_led.works", "hd_led.nothing"),
        (Module, NetworkLedState::GreenFlashing) => (Note, "hd_led.not_configured", "hd_led.not_configured_do"),
        (Module, NetworkLedState::RedFlashing) => (Warning, "hd_led.minor", "hd_led.minor_do"),
        (Module, NetworkLedState::Red) => (Error, "hd_led.major", "hd_led.major_do"),
        (_, NetworkLedState::Alternating) => (Note, "hd_led.self_test", "hd_led.wait"),
        (Network, NetworkLedState::Off) => (Error, "hd_led.no_address", "hd_led.no_address_do"),
        (Network, NetworkLedState::Green) => (Good, "hd_led.open", "hd_led.nothing"),
        (Network, NetworkLedState::GreenFlashing) => (Note, "hd_led.no_connection", "hd_led.no_connection_do"),
        (Network, NetworkLedState::RedFlashing) => (Warning, "hd_led.timed_out", "hd_led.timed_out_do"),
        (Network, NetworkLedState::Red) => (Error, "hd_led.same_address", "hd_led.same_address_do"),
    }
}

fn port(light: PortLedState) -> Row {
    match light {
        PortLedState::Off => (Severity::Error, "hd_led.no_link", "hd_led.no_link_do"),
        PortLedState::Link => (Severity::Note, "hd_led.quiet", "hd_led.nothing"),
        PortLedState::Active => (Severity::Good, "hd_led.data", "hd_led.nothing"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::hiperdrive::protocol::{BUS_LEDS, PORT_LEDS};

    /// Checks that a sentence in the window equals the phrase in the table, except for the capital letter and the full
    /// stop.
    #[track_caller]
    fn same(said: &Text, phrase: &str) {
        let words = said.to_string_in(Language::English);
        assert_eq!(words.trim_end_matches('.').to_lowercase(), phrase.to_lowercase(), "{}", said.id());
        assert!(words.ends_with('.') && words.starts_with(|c: char| c.is_uppercase()), "{words}");
        assert_ne!(words, said.to_string_in(Language::German));
    }

    #[test]
    fn led_texts_match_protocol_tables() {
        for (hub, s3) in [(false, 0), (true, 0), (true, 3)] {
            let mut leds = Leds { hub, s3, ..Leds::default() };
            for row in leds.led_subject().rows() {
                leds.drives = row.light;
                let said = leds.led_meaning(Led::Drives);
                same(&said.meaning, row.meaning);
                same(&said.remedy, row.remedy);
            }
        }
        for row in BUS_LEDS {
            let leds = Leds { module: row.light, network: row.light, ..Leds::default() };
            let said = leds.led_meaning(Led::Bus(row.lamp));
            same(&said.meaning, row.meaning);
            same(&said.remedy, row.remedy);
        }
        for row in PORT_LEDS {
            let said = Leds { port: row.light, ..Leds::default() }.led_meaning(Led::Port);
            same(&said.meaning, row.meaning);
            same(&said.remedy, row.remedy);
        }
    }

    #[test]
    fn click_cycles_through_led_states() {
        for (hub, s3, lights) in [(false, 0, 7), (true, 0, 7), (true, 8, 4)] {
            let mut leds = Leds { hub, s3, ..Leds::default() };
            let mut seen = Vec::new();
            for _ in 0..lights {
                leds.toggle(Led::Drives);
                assert!(leds.led_subject().row(leds.drives).is_some() && !seen.contains(&leds.drives));
                seen.push(leds.drives);
            }
            leds.toggle(Led::Drives);
            assert_eq!(seen.first(), Some(&leds.drives));
        }
        for (lamp, lights) in [(Led::Bus(NetworkLed::Module), 6), (Led::Bus(NetworkLed::Network), 6), (Led::Port, 3)] {
            let mut leds = Leds::default();
            let mut said = Vec::new();
            (0..lights).for_each(|_| {
                leds.toggle(lamp);
                said.push(leds.led_meaning(lamp).meaning);
            });
            said.dedup();
            assert!(said.len() == lights && leds == Leds::default(), "{lamp:?}");
        }
    }

    #[test]
    fn unsupported_led_state_becomes_off() {
        let mut leds = Leds { drives: DriveLedState::Alternating, ..Leds::for_topology(Topology::Hub8) };
        leds.set_device(true, 9);
        assert_eq!((leds.s3, leds.led_subject(), leds.drives), (8, LedSubject::Drive, DriveLedState::Off));
        leds.drives = DriveLedState::Red;
        leds.set_device(false, 8);
        assert_eq!((leds.led_subject(), leds.drives), (LedSubject::Adapter, DriveLedState::Red));
        assert!(!Leds::for_topology(Topology::Adapter).hub);
    }
}
