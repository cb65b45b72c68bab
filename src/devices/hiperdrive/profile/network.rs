//! Network settings of a device, stored in the TCP/IP object (CIP class F5h), and their plan (reference, section 1).
//! All settings apply if the address switch is at 0. If it is at 97, only the addresses apply.

use super::{Base, HiperdrivePlan, Op, PlanError};
use crate::buses::ethernet_ip::protocol::{AddressSource, InterfaceConfiguration};
use crate::devices::hiperdrive::protocol::ParameterNumber;

/// Network settings in the TCP/IP object.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct NetworkSettings {
    /// Address source, attribute 3.
    pub source: AddressSource,
    /// Interface configuration, attribute 5.
    pub interface: InterfaceConfiguration,
}

/// Plans a change of the network settings. The addresses are written only if the address source is *stored*, since any
/// other source ignores them. `switch` is parameter 12, if known.
///
/// # Errors
/// Returns an error if the device would be unreachable at these addresses, or if the source is unknown.
pub fn plan_network(
    now: &NetworkSettings,
    switch: Option<i64>,
    wanted: &NetworkSettings,
) -> Result<HiperdrivePlan, PlanError> {
    let mut to = wanted.clone();
    match to.source {
        AddressSource::Stored => to.interface.check_reachable()?,
        AddressSource::Bootp | AddressSource::Dhcp => to.interface = now.interface.clone(),
        AddressSource::Unknown(source) if to.source != now.source => return Err(PlanError::Source(source)),
        AddressSource::Unknown(_) => to.interface = now.interface.clone(),
    }
    if to == *now {
        return Ok(HiperdrivePlan { base: Base::default(), ops: Vec::new() });
    }
    let switch = ParameterNumber::new(SWITCH).zip(switch);
    let base = Base { values: switch.into_iter().collect(), network: Some(now.clone()) };
    Ok(HiperdrivePlan { base, ops: vec![Op::Network { from: now.clone(), to }] })
}

pub(super) const SWITCH: u16 = 12;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buses::ethernet_ip::protocol::AddressError;
    use crate::devices::hiperdrive::profile::{Warning, plan_warnings};
    use crate::devices::hiperdrive::protocol::AddressSwitch;
    use crate::profile::Operation;

    fn settings(source: AddressSource, address: [u8; 4]) -> NetworkSettings {
        let interface = InterfaceConfiguration {
            address: address.into(),
            mask: [255, 255, 255, 0].into(),
            gateway: [0; 4].into(),
            name_servers: [[0; 4].into(); 2],
            domain: String::new(),
        };
        NetworkSettings { source, interface }
    }

    #[test]
    fn writes_addresses_to_stored_settings() {
        let now = settings(AddressSource::Dhcp, [10, 0, 0, 7]);
        let wanted = settings(AddressSource::Stored, [10, 0, 0, 8]);
        let plan = plan_network(&now, Some(0), &wanted).unwrap();
        assert_eq!(plan.ops, [Op::Network { from: now.clone(), to: wanted.clone() }]);
        assert_eq!((plan.ops[0].write_cycles(), plan.base.network.as_ref()), (1, Some(&now)));
        assert_eq!(plan_warnings(&plan), []);
        // No address is written, because DHCP assigns one.
        let plan = plan_network(&wanted, Some(0), &settings(AddressSource::Dhcp, [10, 0, 0, 9])).unwrap();
        let to = NetworkSettings { source: AddressSource::Dhcp, ..wanted.clone() };
        assert_eq!(plan.ops, [Op::Network { from: wanted.clone(), to }]);
        assert!(plan_network(&wanted, Some(0), &wanted).unwrap().is_empty());
        assert!(plan_network(&now, None, &settings(AddressSource::Dhcp, [10, 0, 0, 9])).unwrap().is_empty());
    }

    #[test]
    fn rejects_invalid_and_reports_unused_addresses() {
        let now = settings(AddressSource::Dhcp, [10, 0, 0, 7]);
        let refused = |wanted| plan_network(&now, None, &wanted).unwrap_err();
        let broadcast = AddressError::Broadcast([10, 0, 0, 255].into());
        assert_eq!(refused(settings(AddressSource::Stored, [10, 0, 0, 255])), PlanError::Address(broadcast));
        assert_eq!(refused(settings(AddressSource::Unknown(3), [10, 0, 0, 7])), PlanError::Source(3));
        let plan = plan_network(&now, Some(17), &settings(AddressSource::Bootp, [0; 4])).unwrap();
        let fixed = AddressSwitch::Fixed([192, 168, 1, 17].into());
        assert_eq!(plan_warnings(&plan), [Warning::SwitchDecides(fixed)]);
    }
}
