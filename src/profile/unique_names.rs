//! Detects names that occur twice in a structure. The `ron` crate keeps only the last one, which would silently drop an
//! entry from a file edited by hand.

use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt;

use ron::Value;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// A visitor that rejects duplicate names in the structures of any RON document and discards everything else.
#[derive(Clone, Copy)]
pub(super) struct UniqueNames<'t> {
    /// First duplicate name, if any.
    pub(super) twice: &'t RefCell<Option<String>>,
}

impl<'de> DeserializeSeed<'de> for UniqueNames<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for UniqueNames<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a RON value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut seen = HashSet::new();
        while let Some(key) = map.next_key::<Value>()? {
            let name = match &key {
                Value::String(name) => name.clone(),
                other => ron::to_string(other).unwrap_or_default(),
            };
            if !seen.insert(key) {
                *self.twice.borrow_mut() = Some(name);
                return Err(A::Error::custom("a name appears twice"));
            }
            map.next_value_seed(self)?;
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while seq.next_element_seed(self)?.is_some() {}
        Ok(())
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_none<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_char<E>(self, _: char) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_bytes<E>(self, _: &[u8]) -> Result<(), E> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, twice: Option<&str>) {
        let found = RefCell::default();
        let result = ron::Options::default().from_str_seed(text, UniqueNames { twice: &found });
        assert_eq!(result.is_err(), twice.is_some(), "{text}");
        assert_eq!(found.into_inner().as_deref(), twice, "{text}");
    }

    #[test]
    fn structure_names_are_unique() {
        check("(a: 1, b: (a: -1, b: \"x\"), c: [(a: 1.5), (a: 'c')], d: Some(()), e: true, f: None)", None);
        check("()", None);
        check("(a: 1, a: 1)", Some("a"));
        check("(a: [(b: 1), (b: 1, c: [], b: 2)])", Some("b"));
        check("{\"a\": 1, \"a\": 2}", Some("a"));
        check("{158: 1, \"158\": 1, 160: 1, 0x9E: 2}", Some("158"));
        check("(a: Some((b: 1, b: 1)))", Some("b"));
    }
}
