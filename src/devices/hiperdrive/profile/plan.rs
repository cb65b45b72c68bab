//! Operations that change a device, the number of saves they need, and the values on which they are based.

use std::collections::BTreeMap;

use super::{Image, Item, NetworkSettings};
use crate::buses::ethernet_ip::protocol::AddressSource;
use crate::devices::hiperdrive::protocol::drive_parameter::ACKNOWLEDGE;
use crate::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber};
use crate::profile::{ChangedItem, Operation, Plan};

/// A planned write to an adapter or a hub.
pub type HiperdrivePlan = Plan<Base, Op>;

/// Values on which a plan is based: all those that its operations change or depend on. Drive positions are not
/// included, since they can change without a write.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Values by parameter number.
    pub values: BTreeMap<ParameterNumber, i64>,
    /// Network settings, if the plan changes them.
    pub network: Option<NetworkSettings>,
}

impl Base {
    /// Returns the parameter values as an image.
    pub fn image(&self) -> Image {
        Image { values: self.values.clone() }
    }
}

/// Returns the parameters that a plan writes, with their new values.
pub fn written_values(plan: &HiperdrivePlan) -> Image {
    let written = plan.ops.iter().filter_map(|op| match op {
        Op::Write { number, new, .. } => Some((*number, *new)),
        Op::Service(_) | Op::Network { .. } => None,
    });
    Image { values: written.collect() }
}

/// A single operation of a plan.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Writes a parameter and reads it back.
    Write {
        /// Parameter to write.
        number: ParameterNumber,
        /// Old value, if known.
        old: Option<i64>,
        /// New value.
        new: i64,
    },
    /// Executes a service.
    Service(Service),
    /// Writes attribute 3 of the TCP/IP object, then attribute 5. Setting attribute 3 to 0 stores the current address,
    /// so it must come first.
    Network {
        /// Current settings.
        from: NetworkSettings,
        /// New settings.
        to: NetworkSettings,
    },
}

/// A service of a device, started through parameter 47 or 197 (reference, section 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Service {
    /// Parameter 47 = 1: saves the current values of all parameters that can be saved.
    Save,
    /// Parameter 47 = −2: recalls the saved parameters of the adapter or hub, but not those of its drives.
    Recall,
    /// Parameter 47 = −1: restores the factory values of the adapter or hub, but not those of its drives, without
    /// saving them.
    Factory,
    /// Parameter 47 = −3: restores the factory values of all parameters, including DHCP, and saves them.
    FactoryAll,
    /// Parameter 47 = −4: tests for the presence of the drives and resets them.
    Reset,
    /// Parameter 197 = 0: clears the fault of a drive, after a reset (47 = −4) if one is needed.
    Acknowledge(DriveNumber),
}

impl Service {
    /// Returns the value of parameter 47 that starts the service, or `None` for an acknowledgement.
    pub const fn code(self) -> Option<i64> {
        match self {
            Service::Save => Some(1),
            Service::Recall => Some(-2),
            Service::Factory => Some(-1),
            Service::FactoryAll => Some(-3),
            Service::Reset => Some(-4),
            Service::Acknowledge(_) => None,
        }
    }

    /// Returns the service that a value of parameter 47 starts, or `None` if it starts none.
    pub const fn from_code(code: i64) -> Option<Self> {
        match code {
            1 => Some(Service::Save),
            -1 => Some(Service::Factory),
            -2 => Some(Service::Recall),
            -3 => Some(Service::FactoryAll),
            -4 => Some(Service::Reset),
            _ => None,
        }
    }
}

impl HiperdrivePlan {
    /// Removes the final save from the plan. The written values are lost at power-off unless they are saved later.
    pub fn without_save(mut self) -> Self {
        if self.ops.last() == Some(&Op::Service(Service::Save)) {
            self.ops.pop();
        }
        self
    }
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        match self {
            Op::Service(Service::Save | Service::FactoryAll) | Op::Network { .. } => 1,
            // These operations do not save.
            Op::Write { .. } | Op::Service(_) => 0,
        }
    }
}

impl Op {
    /// Returns the name of the changed item. If the item is readable, `read` accepts this name.
    pub fn item_name(&self) -> String {
        match self {
            Op::Write { number, .. } => Item(*number).to_string(),
            Op::Service(Service::Acknowledge(drive)) => ParameterNumber::for_drive(ACKNOWLEDGE, *drive)
                .map_or_else(|| ACKNOWLEDGE.to_string(), |number| Item(number).to_string()),
            Op::Service(_) => Item(ParameterNumber::SAVE).to_string(),
            Op::Network { .. } => "network".to_owned(),
        }
    }

    /// Returns the number of changes as counted in a comparison, where a save does not count.
    pub const fn change_count(&self) -> u64 {
        match self {
            Op::Write { .. } | Op::Network { .. } => 1,
            Op::Service(_) => 0,
        }
    }

    /// Returns the changed items with their old and new values, for the logbook. Their names are the same in all window
    /// languages.
    pub fn changed_items(&self) -> Vec<ChangedItem> {
        let text = |value: &i64| value.to_string();
        let name = |number: ParameterNumber| number.row().map(|row| row.name).unwrap_or_default();
        let service = |code: i16, words: &str| {
            ChangedItem::new_value(ParameterNumber::SAVE, format!("{code} ({words})"))
                .with_manual_name(name(ParameterNumber::SAVE))
        };
        vec![match self {
            Op::Write { number, old, new } => {
                ChangedItem::new(Item(*number), old.as_ref().map(text), Some(text(new))).with_manual_name(name(*number))
            }
            Op::Service(Service::Save) => service(1, "saved"),
            Op::Service(Service::Recall) => service(-2, "own parameters of the device as saved last"),
            Op::Service(Service::Factory) => service(-1, "own parameters of the device from the factory, not saved"),
            Op::Service(Service::FactoryAll) => service(-3, "from the factory with the address by DHCP, saved"),
            Op::Service(Service::Reset) => service(-4, "presence test and reset of the drives"),
            Op::Service(Service::Acknowledge(drive)) => ChangedItem::new(self.item_name(), None, None)
                .with_manual_name(format!("fault of drive {} acknowledged", drive.get())),
            Op::Network { from, to } => {
                ChangedItem::new("network", Some(network_change_note(from)), Some(network_change_note(to)))
            }
        }]
    }
}

fn network_change_note(settings: &NetworkSettings) -> String {
    let NetworkSettings { source, interface } = settings;
    let source = match source {
        AddressSource::Stored => "stored".to_owned(),
        AddressSource::Bootp => "BOOTP".to_owned(),
        AddressSource::Dhcp => "DHCP".to_owned(),
        AddressSource::Unknown(source) => format!("source {source}"),
    };
    format!("{source}, {} mask {} gateway {}", interface.address, interface.mask, interface.gateway)
}
