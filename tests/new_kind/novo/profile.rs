//! Profiles of Novo encoders: comparing them and planning a restore.

use encoder_studio::expected::AllowedValues;
use encoder_studio::profile::{Comparison, Entries, Operation, Plan, Profile, ProfileError, Writer};

use super::protocol::{ITEMS, KIND, Values, name_of};

const WORD: AllowedValues = AllowedValues::whole_range(0, 65_535);

/// A profile with the identity and stored values of an encoder.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NovoProfile {
    pub(crate) serial: u16,
    pub(crate) values: Values,
}

impl Profile for NovoProfile {
    const KIND: &'static str = KIND;

    fn read(entries: &mut Entries) -> Result<Self, ProfileError> {
        let serial = entries.take_required("serial", WORD)?;
        let mut values = Values::default();
        for (item, value) in ITEMS.into_iter().zip(&mut values) {
            *value = entries.take_required(item, WORD)?;
        }
        Ok(NovoProfile { serial, values })
    }
    fn write(&self, writer: &mut Writer) {
        writer.entry("serial", &self.serial.to_string(), "");
        for (item, value) in ITEMS.into_iter().zip(self.values) {
            writer.entry(item, &value.to_string(), "");
        }
    }
    fn compare(&self, other: &Self) -> Comparison {
        let mut comparison = Comparison::default();
        for (item, (own, other)) in ITEMS.into_iter().zip(self.values.into_iter().zip(other.values)) {
            comparison.compare_item(item.to_owned(), Some(own), Some(other));
        }
        comparison
    }
}

/// A change of one item to another value.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Op {
    pub(crate) item: usize,
    pub(crate) from: u16,
    pub(crate) to: u16,
}

impl Op {
    pub(crate) fn name(&self) -> &'static str {
        name_of(self.item)
    }
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        1
    }
}

/// A plan: the serial number and values that were read, and the changes to them.
pub(crate) type NovoPlan = Plan<(u16, Values), Op>;

pub(crate) fn plan(now: &NovoProfile, wanted: &Values) -> NovoPlan {
    let pairs = now.values.into_iter().zip(*wanted).enumerate().filter(|(_, (from, to))| from != to);
    let ops = pairs.map(|(item, (from, to))| Op { item, from, to }).collect();
    Plan { base: (now.serial, now.values), ops }
}
