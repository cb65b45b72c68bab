//! Register names of the kit encoder and descriptions of register values.

use std::sync::LazyLock;

use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::protocol::{
    DecodedValue, Description, Descriptions, Name, PositionFilter, Register, RegisterAddress,
};

static KIT_DESCRIPTION: LazyLock<Option<Description>> =
    LazyLock::new(|| Descriptions::built_in().iter().find(|description| description.identity().is_some()).cloned());

fn register(address: RegisterAddress) -> Option<&'static Register> {
    KIT_DESCRIPTION.as_ref()?.register_at(address)
}

pub(super) fn name(address: RegisterAddress) -> Option<&'static str> {
    let area = || Some(KIT_DESCRIPTION.as_ref()?.area_at(address)?.name.english());
    register(address).map(|register| register.name.english()).or_else(area)
}

/// Describes the bytes read from `address`, if they are exactly one register with a decodable value.
pub(super) fn register_meaning(address: RegisterAddress, bytes: &[u8]) -> Option<String> {
    let register = register(address).filter(|register| register.address == address)?;
    describe_value(register, bytes)
}

/// Describes the value of a register if `range` covers exactly that register.
pub(super) fn describe_register(register: &Register, range: RegisterRange, bytes: &[u8]) -> Option<String> {
    let own = register.address == range.start() && register.width == range.count();
    own.then(|| describe_value(register, bytes)).flatten()
}

pub(super) fn register_quantity(register: &Register, bytes: &[u8]) -> Option<f64> {
    match register.decode(bytes)? {
        DecodedValue::Scaled(value) => Some(value),
        _ => None,
    }
}

/// Returns the keyword of a filter, as accepted by `do biss filter`.
pub(super) fn filter(filter: PositionFilter) -> String {
    match filter {
        PositionFilter::Balanced => "balanced".to_owned(),
        PositionFilter::Dynamic => "dynamic".to_owned(),
        PositionFilter::Unknown(code) => format!("0x{code:02X}"),
    }
}

/// Describes the bytes of a register. Returns `None` for a code of unknown meaning.
fn describe_value(register: &Register, bytes: &[u8]) -> Option<String> {
    let unit = if register.unit.is_empty() { String::new() } else { format!(" {}", register.unit) };
    Some(match register.decode(bytes)? {
        DecodedValue::Number(number) => format!("{number}{unit}"),
        DecodedValue::Hex(_) => return None,
        DecodedValue::Scaled(value) => format!("{value}{unit}"),
        DecodedValue::Bits(bits) if bits.is_empty() => "none".to_owned(),
        DecodedValue::Bits(bits) => {
            let named = |(bit, name): (u8, Option<&Name>)| name.map_or_else(|| format!("bit {bit}"), Name::to_string);
            bits.into_iter().map(named).collect::<Vec<_>>().join(", ")
        }
        DecodedValue::Choice(_, Some(name)) => name.to_string(),
        DecodedValue::Choice(value, None) => format!("unknown (0x{value:02X})"),
        DecodedValue::Text(text) => text,
    })
}
