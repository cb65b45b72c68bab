//! LEDs of a hub, of an adapter and of their network ports (reference 1). Remedies are derived (`D`).

/// State of a two-colour RS485 LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveLight {
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

/// The drive or drives to which an RS485 LED refers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LedSubject {
    /// The drive of a bus adapter, which has no switch S3.
    Adapter,
    /// All drives of a hub whose switch S3 is at 0.
    Drives,
    /// The drive of a hub whose number is set on switch S3. In this position no drive can be moved over the bus.
    Drive,
}

/// Meaning and remedy of a state of the RS485 LED.
#[derive(Clone, Copy, Debug)]
pub struct LedRow {
    /// State of the LED.
    pub light: DriveLight,
    /// Meaning in the manual.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

/// Network LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BusLamp {
    /// MS.
    Module,
    /// NS.
    Network,
}

/// State of a network LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BusLight {
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
    /// Green, red, green.
    Alternating,
}

/// Meaning and remedy of a state of a network LED.
#[derive(Clone, Copy, Debug)]
pub struct BusLedRow {
    /// The LED.
    pub lamp: BusLamp,
    /// State of the LED.
    pub light: BusLight,
    /// Meaning that ODVA defines for the LED on all devices.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

/// State of the two LEDs of a network port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PortLight {
    /// Both are off.
    Off,
    /// Green.
    Link,
    /// Green lit, yellow flashing ten times per second.
    Active,
}

/// Meaning and remedy of a state of the port LEDs.
#[derive(Clone, Copy, Debug)]
pub struct PortLedRow {
    /// State of both LEDs.
    pub light: PortLight,
    /// Meaning in the manual.
    pub meaning: &'static str,
    /// Remedy.
    pub remedy: &'static str,
}

const fn drive(light: DriveLight, meaning: &'static str, remedy: &'static str) -> LedRow {
    LedRow { light, meaning, remedy }
}

const fn port(light: PortLight, meaning: &'static str, remedy: &'static str) -> PortLedRow {
    PortLedRow { light, meaning, remedy }
}

const fn bus(lamp: BusLamp, light: BusLight, meaning: &'static str, remedy: &'static str) -> BusLedRow {
    BusLedRow { lamp, light, meaning, remedy }
}

/// States of the RS485 LED of a bus adapter (manual 4.4).
const ADAPTER_LEDS: [LedRow; 7] = [
    drive(DriveLight::Off, "no supply", "check the control supply and its fuse"),
    drive(DriveLight::Alternating, "presence test", "wait until it has finished"),
    drive(
        DriveLight::Red,
        "communication error with the requested drive",
        "check the drive's cable and supply, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(DriveLight::RedGreen, "drive error", "read the errors, remove the cause, then acknowledge"),
    drive(
        DriveLight::GreenFlashing,
        "the drive has no error but is not requested",
        "to move the drive, set its parameter 152 to 1",
    ),
    drive(
        DriveLight::RedGreenFlashing,
        "the drive is not requested and has an error",
        "request the drive (parameter 152 = 1), then read its errors",
    ),
    drive(DriveLight::Green, "the drive has no error", "no action needed"),
];

/// States of the RS485 LED of a hub with switch S3 at 0, which apply to all drives (manual 3.3).
const DRIVES_LEDS: [LedRow; 7] = [
    drive(DriveLight::Off, "no supply", "check the control supply and its fuse"),
    drive(DriveLight::Alternating, "presence test", "wait until it has finished"),
    drive(
        DriveLight::Red,
        "communication error with a requested drive",
        "turn S3 to each drive to find the one affected. Check its cable, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(
        DriveLight::RedGreen,
        "error of a requested drive",
        "turn S3 to each drive to find the one affected. Read its errors, remove the cause, then acknowledge",
    ),
    drive(
        DriveLight::GreenFlashing,
        "a connected drive is not requested. No drive has an error",
        "set its parameter 152 to 1, or unplug it",
    ),
    drive(
        DriveLight::RedGreenFlashing,
        "a drive that is not requested has an error",
        "request the drive (parameter 152 = 1) and read its errors, or unplug it",
    ),
    drive(
        DriveLight::Green,
        "the connected drives are exactly the requested ones. No drive has an error",
        "no action needed",
    ),
];

/// States of the RS485 LED of a hub with switch S3 at the number of a drive, which apply to that drive (manual 3.3).
const DRIVE_LEDS: [LedRow; 4] = [
    drive(DriveLight::Off, "the drive is neither connected nor requested", "to use the drive, plug it in"),
    drive(
        DriveLight::Red,
        "communication error",
        "check the drive's cable, then acknowledge its fault (set parameter 197 to 0)",
    ),
    drive(DriveLight::RedGreen, "drive error", "read the errors, remove the cause, then acknowledge"),
    drive(DriveLight::Green, "the drive has no error", "turn S3 back to 0, or the bus cannot move the drive"),
];

/// States of the two LEDs of port P1 or P2.
pub const PORT_LEDS: [PortLedRow; 3] = [
    port(PortLight::Off, "no network link", "check the cable and the device at its other end"),
    port(PortLight::Link, "network link, no data traffic", "no action needed"),
    port(PortLight::Active, "network link, data traffic", "no action needed"),
];

/// States of the MS and NS LEDs.
pub const BUS_LEDS: [BusLedRow; 12] = [
    bus(BusLamp::Module, BusLight::Off, "no supply", "check the control supply and its fuse"),
    bus(BusLamp::Module, BusLight::Green, "the device is operating", "no action needed"),
    bus(BusLamp::Module, BusLight::GreenFlashing, "not configured", "open a connection to the device"),
    bus(BusLamp::Module, BusLight::RedFlashing, "recoverable fault", "read the errors and remove the cause"),
    bus(
        BusLamp::Module,
        BusLight::Red,
        "unrecoverable fault",
        "switch the device off and on. If the fault remains, have it repaired",
    ),
    bus(BusLamp::Module, BusLight::Alternating, "self-test", "wait until it has finished"),
    bus(BusLamp::Network, BusLight::Off, "no address or no supply", "check the switches S1 and S2 and the DHCP server"),
    bus(BusLamp::Network, BusLight::Green, "a connection is open", "no action needed"),
    bus(BusLamp::Network, BusLight::GreenFlashing, "no connection", "connect, or start the control (PLC)"),
    bus(
        BusLamp::Network,
        BusLight::RedFlashing,
        "a connection has timed out",
        "check the cables and network switches, then reopen the connection",
    ),
    bus(
        BusLamp::Network,
        BusLight::Red,
        "another device has the same address",
        "assign a different address to one of them",
    ),
    bus(BusLamp::Network, BusLight::Alternating, "self-test", "wait until it has finished"),
];

impl LedSubject {
    /// Returns all states of the RS485 LED with their meanings and remedies.
    pub const fn rows(self) -> &'static [LedRow] {
        match self {
            LedSubject::Adapter => &ADAPTER_LEDS,
            LedSubject::Drives => &DRIVES_LEDS,
            LedSubject::Drive => &DRIVE_LEDS,
        }
    }

    /// Returns the row of an LED state, or `None` if the manual does not list it.
    pub fn row(self, light: DriveLight) -> Option<&'static LedRow> {
        self.rows().iter().find(|row| row.light == light)
    }
}

impl BusLamp {
    /// Returns the label printed beside the LED.
    pub const fn name(self) -> &'static str {
        match self {
            BusLamp::Module => "MS",
            BusLamp::Network => "NS",
        }
    }

    /// Returns the row of an LED state.
    pub fn row(self, light: BusLight) -> Option<&'static BusLedRow> {
        BUS_LEDS.iter().find(|row| row.lamp == self && row.light == light)
    }
}
