//! What is lit at a hub, an adapter and their network plug (reference 1). Remedies are derived (`D`).

/// A lamp RS485 of two colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveLight {
    /// Dark.
    Off,
    /// Green.
    Green,
    /// Red.
    Red,
    /// Red and green at once.
    RedGreen,
    /// Green, twice a second.
    GreenFlashing,
    /// Red and green at once, twice a second.
    RedGreenFlashing,
    /// Red, green, red, five times a second.
    Alternating,
}

/// What a lamp RS485 is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LedSubject {
    /// The drive of a bus adapter, which has no switch S3.
    Adapter,
    /// All drives of a hub: its switch S3 is at 0.
    Drives,
    /// The drive of a hub at whose number S3 is. From the bus none moves then.
    Drive,
}

/// What the lamp RS485 says, and what to do.
#[derive(Clone, Copy, Debug)]
pub struct LedRow {
    /// What is lit.
    pub light: DriveLight,
    /// What it says, as the manual has it.
    pub meaning: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

/// The lamps of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BusLamp {
    /// MS.
    Module,
    /// NS.
    Network,
}

/// What such a lamp shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BusLight {
    /// Dark.
    Off,
    /// Green.
    Green,
    /// Green, on and off.
    GreenFlashing,
    /// Red.
    Red,
    /// Red, on and off.
    RedFlashing,
    /// Green, red, green.
    Alternating,
}

/// What a lamp of the network says, and what to do.
#[derive(Clone, Copy, Debug)]
pub struct BusLedRow {
    /// Which lamp.
    pub lamp: BusLamp,
    /// What it shows.
    pub light: BusLight,
    /// What it says, as ODVA has it for all devices.
    pub meaning: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

/// What the two lamps of a network port show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PortLight {
    /// Both are dark.
    Off,
    /// Green.
    Link,
    /// Green, and yellow ten times a second.
    Active,
}

/// What the lamps of a network port say, and what to do.
#[derive(Clone, Copy, Debug)]
pub struct PortLedRow {
    /// What they show.
    pub light: PortLight,
    /// What they say, as the manual has it.
    pub meaning: &'static str,
    /// What to do.
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

/// RS485 of a bus adapter (manual 4.4).
const ADAPTER_LEDS: [LedRow; 7] = [
    drive(DriveLight::Off, "no supply", "check the control supply and its fuse"),
    drive(DriveLight::Alternating, "presence test", "wait until it has finished"),
    drive(
        DriveLight::Red,
        "communication error with the requested drive",
        "check the drive's cable and supply, then write 0 to its parameter 197",
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

/// RS485 of a hub with switch S3 at 0: about all drives (manual 3.3).
const DRIVES_LEDS: [LedRow; 7] = [
    drive(DriveLight::Off, "no supply", "check the control supply and its fuse"),
    drive(DriveLight::Alternating, "presence test", "wait until it has finished"),
    drive(
        DriveLight::Red,
        "communication error with a requested drive",
        "turn S3 to each drive to find the one affected. Check its cable, then write 0 to its parameter 197",
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

/// RS485 of a hub with switch S3 at a drive's number: about that drive (manual 3.3).
const DRIVE_LEDS: [LedRow; 4] = [
    drive(DriveLight::Off, "the drive is neither connected nor requested", "to use the drive, plug it in"),
    drive(DriveLight::Red, "communication error", "check the drive's cable, then write 0 to its parameter 197"),
    drive(DriveLight::RedGreen, "drive error", "read the errors, remove the cause, then acknowledge"),
    drive(DriveLight::Green, "the drive has no error", "turn S3 back to 0, or the bus cannot move the drive"),
];

/// Both lamps of a port P1 or P2.
pub const PORT_LEDS: [PortLedRow; 3] = [
    port(PortLight::Off, "no network link", "check the cable and the device at its other end"),
    port(PortLight::Link, "network link, no data traffic", "no action needed"),
    port(PortLight::Active, "network link, data traffic", "no action needed"),
];

/// MS and NS.
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
    /// What a lamp RS485 may show, and what it says.
    pub const fn rows(self) -> &'static [LedRow] {
        match self {
            LedSubject::Adapter => &ADAPTER_LEDS,
            LedSubject::Drives => &DRIVES_LEDS,
            LedSubject::Drive => &DRIVE_LEDS,
        }
    }

    /// What it says; `None` for what the manual does not have.
    pub fn row(self, light: DriveLight) -> Option<&'static LedRow> {
        self.rows().iter().find(|row| row.light == light)
    }
}

impl BusLamp {
    /// As it is printed beside the lamp.
    pub const fn name(self) -> &'static str {
        match self {
            BusLamp::Module => "MS",
            BusLamp::Network => "NS",
        }
    }

    /// What it says.
    pub fn row(self, light: BusLight) -> Option<&'static BusLedRow> {
        BUS_LEDS.iter().find(|row| row.lamp == self && row.light == light)
    }
}
