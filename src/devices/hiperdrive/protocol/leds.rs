//! LEDs of a hub, of an adapter and of their network ports (reference, section 1). The remedies are derived (`D`).

/// State of a two-colour RS485 LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveLedState {
    /// Off.
    Off,
    /// Green.
    Green,
    /// Red.
    Red,
    /// Red and green at the same time.
    RedGreen,
    /// Green, flashing twice per second.
    GreenFlashing,
    /// Red and green at the same time, flashing twice per second.
    RedGreenFlashing,
    /// Alternating between red and green, five times per second.
    Alternating,
}

/// The drive or drives that an RS485 LED stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LedSubject {
    /// The drive of a bus adapter, which has no switch S3.
    Adapter,
    /// All drives of a hub whose switch S3 is at 0.
    Drives,
    /// A single drive of a hub, selected with switch S3. With the switch in this position, no drive can be moved over
    /// the bus.
    Drive,
}

/// Meaning and remedy of an RS485 LED state.
#[derive(Clone, Copy, Debug)]
pub struct LedRow {
    /// State of the LED.
    pub light: DriveLedState,
    /// Meaning according to the manual.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

/// Network LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkLed {
    /// Module status LED, MS.
    Module,
    /// Network status LED, NS.
    Network,
}

/// State of a network LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkLedState {
    /// Off.
    Off,
    /// Green.
    Green,
    /// Green, flashing.
    GreenFlashing,
    /// Red.
    Red,
    /// Red, flashing.
    RedFlashing,
    /// Green, then red, then green.
    Alternating,
}

/// Meaning and remedy of a network LED state.
#[derive(Clone, Copy, Debug)]
pub struct NetworkLedRow {
    /// LED to which the row applies.
    pub lamp: NetworkLed,
    /// State of the LED.
    pub light: NetworkLedState,
    /// Meaning that ODVA defines for this LED on all devices.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

/// State of the two LEDs of a network port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PortLedState {
    /// Both LEDs are off.
    Off,
    /// The green LED is lit.
    Link,
    /// The green LED is lit, and the yellow LED flashes ten times per second.
    Active,
}

/// Meaning and remedy of a port LED state.
#[derive(Clone, Copy, Debug)]
pub struct PortLedRow {
    /// State of both LEDs.
    pub light: PortLedState,
    /// Meaning according to the manual.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

const fn drive(light: DriveLedState, meaning: &'static str, remedy: &'static str) -> LedRow {
    LedRow { light, meaning, remedy }
}

const fn port(light: PortLedState, meaning: &'static str, remedy: &'static str) -> PortLedRow {
    PortLedRow { light, meaning, remedy }
}

const fn network_led_row(
    lamp: NetworkLed,
    light: NetworkLedState,
    meaning: &'static str,
    remedy: &'static str,
) -> NetworkLedRow {
    NetworkLedRow { lamp, light, meaning, remedy }
}

/// States of the RS485 LED of a bus adapter (manual 4.4).
const ADAPTER_LEDS: [LedRow; 7] = [
    drive(DriveLedState::Off, "no supply voltage", "check the control supply and its fuse"),
    drive(DriveLedState::Alternating, "presence test in progress", "wait until the test has finished"),
    drive(
        DriveLedState::Red,
        "communication error with the requested drive",
        "check the drive's cable and supply, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(DriveLedState::RedGreen, "drive error", "read the errors, correct their causes, then acknowledge them"),
    drive(
        DriveLedState::GreenFlashing,
        "the drive has no error but is not requested",
        "to move the drive, set its parameter 152 to 1",
    ),
    drive(
        DriveLedState::RedGreenFlashing,
        "the drive is not requested and has an error",
        "request the drive (parameter 152 = 1), then read its errors",
    ),
    drive(DriveLedState::Green, "the drive has no errors", "no action needed"),
];

/// States of the RS485 LED of a hub for all drives, with switch S3 at 0 (manual 3.3).
const DRIVES_LEDS: [LedRow; 7] = [
    drive(DriveLedState::Off, "no supply voltage", "check the control supply and its fuse"),
    drive(DriveLedState::Alternating, "presence test in progress", "wait until the test has finished"),
    drive(
        DriveLedState::Red,
        "communication error with a requested drive",
        "set switch S3 to each drive in turn to find the affected one. Check its cable, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(
        DriveLedState::RedGreen,
        "a requested drive has an error",
        "set switch S3 to each drive in turn to find the affected one. Read its errors, correct their causes, then acknowledge them",
    ),
    drive(
        DriveLedState::GreenFlashing,
        "a connected drive is not requested. No drive has an error",
        "set parameter 152 of the drive to 1, or unplug the drive",
    ),
    drive(
        DriveLedState::RedGreenFlashing,
        "a drive that is not requested has an error",
        "request the drive (parameter 152 = 1) and read its errors, or unplug the drive",
    ),
    drive(
        DriveLedState::Green,
        "all requested drives are connected, and no others. No drive has an error",
        "no action needed",
    ),
];

/// States of the RS485 LED of a hub for the drive selected with switch S3 (manual 3.3).
const DRIVE_LEDS: [LedRow; 4] = [
    drive(DriveLedState::Off, "the drive is neither connected nor requested", "to use the drive, plug it in"),
    drive(
        DriveLedState::Red,
        "communication error",
        "check the drive's cable, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(DriveLedState::RedGreen, "drive error", "read the errors, correct their causes, then acknowledge them"),
    drive(
        DriveLedState::Green,
        "the drive has no errors",
        "set switch S3 back to 0; otherwise, the drive cannot be moved over the bus",
    ),
];

/// States of the two LEDs of port P1 or P2.
pub const PORT_LEDS: [PortLedRow; 3] = [
    port(PortLedState::Off, "no network link", "check the cable and the device at its other end"),
    port(PortLedState::Link, "network link without data traffic", "no action needed"),
    port(PortLedState::Active, "network link with data traffic", "no action needed"),
];

/// States of the MS and NS LEDs.
pub const BUS_LEDS: [NetworkLedRow; 12] = [
    network_led_row(
        NetworkLed::Module,
        NetworkLedState::Off,
        "no supply voltage",
        "check the control supply and its fuse",
    ),
    network_led_row(NetworkLed::Module, NetworkLedState::Green, "the device is operating", "no action needed"),
    network_led_row(
        NetworkLed::Module,
        NetworkLedState::GreenFlashing,
        "not configured",
        "open a connection to the device",
    ),
    network_led_row(
        NetworkLed::Module,
        NetworkLedState::RedFlashing,
        "recoverable fault",
        "read the errors and correct their causes",
    ),
    network_led_row(
        NetworkLed::Module,
        NetworkLedState::Red,
        "unrecoverable fault",
        "switch the device off and on again. If the fault remains, have the device repaired",
    ),
    network_led_row(
        NetworkLed::Module,
        NetworkLedState::Alternating,
        "self-test in progress",
        "wait until the test has finished",
    ),
    network_led_row(
        NetworkLed::Network,
        NetworkLedState::Off,
        "no address or no supply",
        "check the switches S1 and S2 and the DHCP server",
    ),
    network_led_row(NetworkLed::Network, NetworkLedState::Green, "a connection is open", "no action needed"),
    network_led_row(
        NetworkLed::Network,
        NetworkLedState::GreenFlashing,
        "no connection",
        "connect to the device, or start the control (PLC)",
    ),
    network_led_row(
        NetworkLed::Network,
        NetworkLedState::RedFlashing,
        "a connection has timed out",
        "check the cables and network switches, then reopen the connection",
    ),
    network_led_row(
        NetworkLed::Network,
        NetworkLedState::Red,
        "another device has the same address",
        "assign a different address to one of them",
    ),
    network_led_row(
        NetworkLed::Network,
        NetworkLedState::Alternating,
        "self-test in progress",
        "wait until the test has finished",
    ),
];

impl LedSubject {
    /// Returns all states of the RS485 LED, each with its meaning and remedy.
    pub const fn rows(self) -> &'static [LedRow] {
        match self {
            LedSubject::Adapter => &ADAPTER_LEDS,
            LedSubject::Drives => &DRIVES_LEDS,
            LedSubject::Drive => &DRIVE_LEDS,
        }
    }

    /// Returns the row of an LED state, or `None` if the manual does not list it.
    pub fn row(self, light: DriveLedState) -> Option<&'static LedRow> {
        self.rows().iter().find(|row| row.light == light)
    }
}

impl NetworkLed {
    /// Returns the label printed beside the LED.
    pub const fn name(self) -> &'static str {
        match self {
            NetworkLed::Module => "MS",
            NetworkLed::Network => "NS",
        }
    }

    /// Returns the row of an LED state.
    pub fn row(self, light: NetworkLedState) -> Option<&'static NetworkLedRow> {
        BUS_LEDS.iter().find(|row| row.lamp == self && row.light == light)
    }
}
