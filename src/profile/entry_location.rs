//! Finds the line and column of a profile entry in the source text, because the parsed values do not contain them.

use std::fmt;

use ron::Value;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// Returns the line and column of an entry's name, counted from 1. Returns `None` if there is no entry at `path`, for
/// example `fields[2].status`.
pub(crate) fn find_location(text: &str, path: &str) -> Option<(usize, usize)> {
    let sought = EntrySearch { path: String::new(), wanted: path };
    let found = ron::Options::default().from_str_seed(text, sought).err()?;
    if found.code != ron::Error::Message(FOUND_MESSAGE.to_owned()) {
        return None;
    }
    // The parser stops after the name, or after the text that follows the name.
    let name = path.rsplit('.').next()?;
    let line = found.span.end.line;
    let before: String = text.lines().nth(line.checked_sub(1)?)?.chars().take(found.span.end.col).collect();
    let at = before.rfind(name).map(|at| before.get(..at).unwrap_or_default().chars().count() + 1);
    Some((line, at.unwrap_or(found.span.end.col)))
}

/// Error message that stops the parser when the entry is found.
const FOUND_MESSAGE: &str = "found";

struct EntrySearch<'w> {
    path: String,
    wanted: &'w str,
}

impl EntrySearch<'_> {
    fn with_path(&self, path: String) -> Self {
        EntrySearch { path, wanted: self.wanted }
    }
}

impl<'de> DeserializeSeed<'de> for EntrySearch<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for EntrySearch<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a RON value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<Value>()? {
            let name = match &key {
                Value::String(name) => name.clone(),
                other => ron::to_string(other).unwrap_or_default(),
            };
            let path = if self.path.is_empty() { name } else { format!("{}.{name}", self.path) };
            if path == self.wanted {
                return Err(A::Error::custom(FOUND_MESSAGE));
            }
            map.next_value_seed(self.with_path(path))?;
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let mut number = 0;
        while seq.next_element_seed(self.with_path(format!("{}[{number}]", self.path)))?.is_some() {
            number += 1;
        }
        Ok(())
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        self.deserialize(deserializer)
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

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_char<E>(self, _: char) -> Result<(), E> {
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

    #[test]
    fn finds_entry_at_any_depth() {
        let text =
            "(\n  a: 1, // b: 2\n  list: [(b: \"b: 3\"), (x: Some((y: {\"z\": 4, 7: 5})), b: 6)],\n  ä: 1, c: 2)";
        let cases = [
            ("a", Some((2, 3))),
            ("list", Some((3, 3))),
            ("list[0].b", Some((3, 11))),
            ("list[1].b", Some((3, 54))),
            ("list[1].x.y", Some((3, 33))),
            ("list[1].x.y.z", Some((3, 38))),
            ("c", Some((4, 9))),
            ("list[2].b", None),
            ("d", None),
        ];
        for (path, place) in cases {
            assert_eq!(find_location(text, path), place, "{path}");
        }
        assert_eq!(find_location("(a: ", "b"), None);
    }
}
