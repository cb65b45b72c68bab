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
    drive(DriveLight::Alternating, "presence test", "wait until it has ended"),
    drive(
        DriveLight::Red,
        "communication error of the requested drive",
        "check its cable and its supply, then write 0 to its parameter 197",
    ),
    drive(DriveLight::RedGreen, "drive error", "read its errors, mend the cause, acknowledge"),
    drive(DriveLight::GreenFlashing, "the drive is well, but not requested", "set its parameter 152 to 1 to move it"),
    drive(
        DriveLight::RedGreenFlashing,
        "the drive is not requested, and has an error",
        "request it (parameter 152 = 1) and read its errors",
    ),
    drive(DriveLight::Green, "the drive is well", "nothing"),
];

/// RS485 of a hub with switch S3 at 0: about all drives (manual 3.3).
const DRIVES_LEDS: [LedRow; 7] = [
    drive(DriveLight::Off, "no supply", "check the control supply and its fuse"),
    drive(DriveLight::Alternating, "presence test", "wait until it has ended"),
    drive(
        DriveLight::Red,
        "communication error of a requested drive",
        "turn S3 to each drive to see which; check its cable, then write 0 to its parameter 197",
    ),
    drive(
        DriveLight::RedGreen,
        "drive error of a requested drive",
        "turn S3 to each drive to see which; read its errors, mend the cause, acknowledge",
    ),
    drive(
        DriveLight::GreenFlashing,
        "a drive is there that is not requested; all are well",
        "set its parameter 152 to 1, or take it off",
    ),
    drive(
        DriveLight::RedGreenFlashing,
        "a drive that is not requested has an error",
        "request it (parameter 152 = 1) and read its errors, or take it off",
    ),
    drive(DriveLight::Green, "exactly the requested drives are there, and well", "nothing"),
];

/// RS485 of a hub with switch S3 at a drive's number: about that drive (manual 3.3).
const DRIVE_LEDS: [LedRow; 4] = [
    drive(DriveLight::Off, "the drive is neither there nor requested", "nothing; plug it in to use it"),
    drive(DriveLight::Red, "communication error", "check its cable, then write 0 to its parameter 197"),
    drive(DriveLight::RedGreen, "drive error", "read its errors, mend the cause, acknowledge"),
    drive(DriveLight::Green, "the drive is well", "nothing; turn S3 back to 0, or it does not move from the bus"),
];

/// Both lamps of a port P1 or P2.
pub const PORT_LEDS: [PortLedRow; 3] = [
    port(PortLight::Off, "no link", "check the cable and what is at its other end"),
    port(PortLight::Link, "linked, and nothing is sent", "nothing"),
    port(PortLight::Active, "linked, and data are sent", "nothing"),
];

/// MS and NS.
pub const BUS_LEDS: [BusLedRow; 12] = [
    bus(BusLamp::Module, BusLight::Off, "no supply", "check the control supply and its fuse"),
    bus(BusLamp::Module, BusLight::Green, "the device works", "nothing"),
    bus(BusLamp::Module, BusLight::GreenFlashing, "not configured", "open a connection to it"),
    bus(BusLamp::Module, BusLight::RedFlashing, "a fault that can be mended", "read its errors, mend the cause"),
    bus(BusLamp::Module, BusLight::Red, "a fault that cannot be mended", "switch it off and on; else have it repaired"),
    bus(BusLamp::Module, BusLight::Alternating, "self-test", "wait until it has ended"),
    bus(
        BusLamp::Network,
        BusLight::Off,
        "no address, or no supply",
        "check the switches S1 and S2 and the DHCP server",
    ),
    bus(BusLamp::Network, BusLight::Green, "a connection is open", "nothing"),
    bus(BusLamp::Network, BusLight::GreenFlashing, "no connection", "connect, or let the controller run"),
    bus(
        BusLamp::Network,
        BusLight::RedFlashing,
        "a connection timed out",
        "check cables and switches, then open the connection anew",
    ),
    bus(BusLamp::Network, BusLight::Red, "another device has the same address", "give one of them another address"),
    bus(BusLamp::Network, BusLight::Alternating, "self-test", "wait until it has ended"),
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
