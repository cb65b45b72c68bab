//! Parsing item values.

use crate::cli::number::{out_of_range, parse_number};
use crate::cli::{Failure, Result};
use crate::devices::interbus::profile::{Direction, Item, ItemValue};
use crate::devices::interbus::protocol::{Cam, Parameter, Value};

/// Parses the value of an item. A value that no encoder accepts is rejected here with the limits. The plan rejects
/// values that only this encoder does not accept.
pub(super) fn value(item: Item, text: &str) -> Result<ItemValue> {
    Ok(match item {
        Item::Steps | Item::Revolutions | Item::Preset | Item::ZeroShift => {
            let (low, high) = item.parameter().map_or((0, u32::MAX), limits);
            ItemValue::Number(parse_in_range(item, text, low, high)?)
        }
        Item::Shift => ItemValue::Number(parse_in_range(item, text, 0, Value::BITS)?),
        Item::Direction => ItemValue::Direction(direction(item, text)?),
        Item::CamMask(_) => {
            let mask = parse_in_range(item, text, 0, u8::MAX.into())?;
            ItemValue::Mask(u8::try_from(mask).map_err(|_| out_of_range(item, text, 0, u8::MAX.into()))?)
        }
        Item::Cam(..) => {
            let form = || Failure::Usage(format!("{item}: {text:?} is not START..STOP, such as 100..200"));
            let (start, stop) = text.split_once("..").ok_or_else(form)?;
            ItemValue::Cam(Cam { start: parse_edge(item, start)?, stop: parse_edge(item, stop)? })
        }
        Item::Temperature | Item::OperatingTime => {
            return Err(Failure::Usage(format!("{item} is a measured value and cannot be written")));
        }
    })
}

fn limits(parameter: Parameter) -> (u32, u32) {
    let range = parameter.range_with_any_gear();
    (*range.start(), *range.end())
}

fn parse_in_range(item: Item, text: &str, low: u32, high: u32) -> Result<u32> {
    let refused = || out_of_range(item, text, low.into(), high.into());
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{item}: {text:?} is not a number")))?;
    u32::try_from(number).ok().filter(|number| (low..=high).contains(number)).ok_or_else(refused)
}

fn parse_edge(item: Item, text: &str) -> Result<Value> {
    let high = Value::MAX.get();
    Value::new(parse_in_range(item, text, 0, high)?).ok_or_else(|| out_of_range(item, text, 0, high.into()))
}

fn direction(item: Item, text: &str) -> Result<Direction> {
    match (text.parse(), parse_number(text)) {
        (Ok(direction), _) => Ok(direction),
        (Err(_), Some(number)) => u32::try_from(number).ok().and_then(Direction::from_code).ok_or_else(|| {
            out_of_range(item, text, Direction::Clockwise.code().into(), Direction::Counterclockwise.code().into())
        }),
        (Err(error), None) => Err(Failure::Usage(format!("{text:?}: {error}"))),
    }
}
