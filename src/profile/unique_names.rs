//! Names that stand twice in a structure of a profile. The `ron` crate keeps the last of them without a word; in a file
//! edited by hand that would drop the other.

use std::collections::HashSet;
use std::fmt;

use ron::Value;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// Any RON in which no structure has a name twice; the content itself is not kept.
pub(super) struct UniqueNames;

impl<'de> Deserialize<'de> for UniqueNames {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Walk)
    }
}

struct Walk;

impl<'de> Visitor<'de> for Walk {
    type Value = UniqueNames;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a RON value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<UniqueNames, A::Error> {
        let mut seen = HashSet::new();
        while let Some(key) = map.next_key::<Value>()? {
            let name = match &key {
                Value::String(name) => name.clone(),
                other => ron::to_string(other).unwrap_or_default(),
            };
            if !seen.insert(key) {
                return Err(A::Error::custom(format_args!("{name} stands twice")));
            }
            map.next_value::<UniqueNames>()?;
        }
        Ok(UniqueNames)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<UniqueNames, A::Error> {
        while seq.next_element::<UniqueNames>()?.is_some() {}
        Ok(UniqueNames)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<UniqueNames, D::Error> {
        UniqueNames::deserialize(deserializer)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<UniqueNames, D::Error> {
        UniqueNames::deserialize(deserializer)
    }

    fn visit_none<E>(self) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_unit<E>(self) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_bool<E>(self, _: bool) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_char<E>(self, _: char) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_i64<E>(self, _: i64) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_u64<E>(self, _: u64) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_f64<E>(self, _: f64) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_str<E>(self, _: &str) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }

    fn visit_bytes<E>(self, _: &[u8]) -> Result<UniqueNames, E> {
        Ok(UniqueNames)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, twice: Option<&str>) {
        let found = ron::from_str::<UniqueNames>(text).err().map(|error| error.code.to_string());
        assert_eq!(found, twice.map(|name| format!("{name} stands twice")), "{text}");
    }

    #[test]
    fn names_are_unique_within_a_structure() {
        check("(a: 1, b: (a: -1, b: \"x\"), c: [(a: 1.5), (a: 'c')], d: Some(()), e: true, f: None)", None);
        check("()", None);
        check("(a: 1, a: 1)", Some("a"));
        check("(a: [(b: 1), (b: 1, c: [], b: 2)])", Some("b"));
        check("{\"a\": 1, \"a\": 2}", Some("a"));
        check("{158: 1, \"158\": 1, 160: 1, 0x9E: 2}", Some("158"));
        check("(a: Some((b: 1, b: 1)))", Some("b"));
    }
}
