//! Compares two generated texts entry by entry.

use std::fmt;

use ron::Value;
use serde::{Deserialize, Serialize};

use super::tree::{Kind, NodePart, SourceNode, read, trailing_comment};

/// Entries that can identify the elements of a list. The first one that exists is used.
const NAMES: [&str; 7] = ["number", "program", "cam", "bank", "banks", "item", "name"];

/// A step of the path to an entry.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum PathStep {
    /// An entry of a structure, identified by its name.
    Entry(String),
    /// A list element, identified by the name and value of one of its entries.
    Named(String, String),
    /// A list element, identified by its index.
    At(usize),
}

/// A difference between two texts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// Path of the entry.
    pub path: Vec<PathStep>,
    /// Source text on the left, or `None` if the entry does not exist there.
    pub from: Option<String>,
    /// Source text on the right, or `None` if the entry does not exist there.
    pub to: Option<String>,
    /// Preceding siblings on the right, nearest first.
    pub behind: Vec<PathStep>,
    /// Trailing comments on the left and on the right.
    #[serde(default)]
    pub comments: (Option<String>, Option<String>),
    /// Comment lines before the entry on the right.
    #[serde(default)]
    pub heading: Vec<String>,
}

impl Change {
    /// Returns the path as shown in messages, such as `fields[number: 2].status`.
    pub fn location(&self) -> String {
        self.path.iter().enumerate().fold(String::new(), |place, (at, step)| match step {
            PathStep::Entry(name) if at == 0 => name.clone(),
            PathStep::Entry(name) => format!("{place}.{name}"),
            step => format!("{place}[{step}]"),
        })
    }
}

impl fmt::Display for PathStep {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PathStep::Entry(name) => f.write_str(name),
            PathStep::Named(name, value) => write!(f, "{name}: {value}"),
            PathStep::At(at) => write!(f, "{at}"),
        }
    }
}

/// Returns the changes that turn `left` into `right`, or `None` if either cannot be parsed.
pub(in crate::profile) fn find_changes(left: &str, right: &str) -> Option<Vec<Change>> {
    let (from, to) = (read(left)?, read(right)?);
    let mut walk = TreeWalk { left, right, path: Vec::new(), found: Vec::new() };
    walk.compare_parts(&from, &to, (None, None), &[]);
    Some(walk.found)
}

/// Returns whether two simple values are equal, even in a different notation such as `0x10` and `16`.
pub(super) fn is_equivalent_value(one: &str, other: &str) -> bool {
    let value = |text| ron::from_str::<Value>(text).ok();
    one == other || value(one).is_some_and(|own| Some(own) == value(other))
}

/// Returns the path step to each part of a list or structure. Elements without a unique name are identified by their
/// index.
pub(super) fn path_steps(text: &str, node: &SourceNode) -> Vec<PathStep> {
    let slice = |part: &NodePart| part.key.as_ref().and_then(|key| text.get(key.clone()));
    let parts = node.parts();
    if matches!(node.kind, Kind::Entries(_)) {
        return parts.iter().map(|part| PathStep::Entry(slice(part).unwrap_or_default().to_owned())).collect();
    }
    let named: Option<Vec<PathStep>> = parts.iter().map(|part| named_step(text, &part.value)).collect();
    let by_place = || (0..parts.len()).map(PathStep::At).collect();
    match named {
        Some(named) if named.iter().enumerate().all(|(at, step)| !named.iter().skip(at + 1).any(|own| own == step)) => {
            named
        }
        _ => by_place(),
    }
}

fn named_step(text: &str, element: &SourceNode) -> Option<PathStep> {
    let entry = |name: &str| {
        let is_it = |part: &&NodePart| part.key.as_ref().and_then(|key| text.get(key.clone())) == Some(name);
        let part = element.parts().iter().find(is_it)?;
        let value = text.get(part.value.span.clone())?;
        Some(PathStep::Named(name.to_owned(), normalize_value(value)))
    };
    matches!(element.kind, Kind::Entries(_)).then(|| NAMES.into_iter().find_map(entry)).flatten()
}

/// Normalises the notation of a value. For example, `0x10` and `16` become the same text.
fn normalize_value(value: &str) -> String {
    ron::from_str::<Value>(value).ok().and_then(|value| ron::to_string(&value).ok()).unwrap_or_else(|| value.to_owned())
}

struct TreeWalk<'t> {
    left: &'t str,
    right: &'t str,
    path: Vec<PathStep>,
    found: Vec<Change>,
}

impl TreeWalk<'_> {
    fn compare_parts(
        &mut self,
        from: &SourceNode,
        to: &SourceNode,
        parts: (Option<&NodePart>, Option<&NodePart>),
        behind: &[PathStep],
    ) {
        let (own, other) = (path_steps(self.left, from), path_steps(self.right, to));
        let same_kind = match (&from.kind, &to.kind) {
            (Kind::Entries(_), Kind::Entries(_)) => true,
            (Kind::List(_), Kind::List(_)) => is_same_order(&own, &other),
            _ => false,
        };
        let (left, right) = (self.left.get(from.span.clone()), self.right.get(to.span.clone()));
        if same_kind {
            self.compare_children(from, to, &own, &other);
        } else if left != right {
            self.record_change(parts, (left, right), behind);
        }
    }

    fn compare_children(&mut self, from: &SourceNode, to: &SourceNode, own: &[PathStep], other: &[PathStep]) {
        for (step, part) in own.iter().zip(from.parts()).filter(|(step, _)| !other.contains(step)) {
            self.path.push(step.clone());
            self.record_change((Some(part), None), (self.left.get(part.value.span.clone()), None), &[]);
            self.path.pop();
        }
        for (at, (step, part)) in other.iter().zip(to.parts()).enumerate() {
            let behind: Vec<PathStep> = other.iter().take(at).rev().cloned().collect();
            let before = own.iter().zip(from.parts()).find(|(own, _)| *own == step).map(|(_, part)| part);
            self.path.push(step.clone());
            match before {
                Some(before) => self.compare_parts(&before.value, &part.value, (Some(before), Some(part)), &behind),
                None => {
                    self.record_change((None, Some(part)), (None, self.right.get(part.value.span.clone())), &behind)
                }
            }
            self.path.pop();
        }
    }

    fn record_change(
        &mut self,
        (left, right): (Option<&NodePart>, Option<&NodePart>),
        (from, to): (Option<&str>, Option<&str>),
        behind: &[PathStep],
    ) {
        let comment = |text: &str, part: Option<&NodePart>| {
            part.and_then(|part| trailing_comment(text, part.end)).map(|(_, comment)| comment.to_owned())
        };
        self.found.push(Change {
            path: self.path.clone(),
            from: from.map(ToOwned::to_owned),
            to: to.map(ToOwned::to_owned),
            behind: behind.to_vec(),
            comments: (comment(self.left, left), comment(self.right, right)),
            heading: right.map(|part| comments_above(self.right, part.start())).unwrap_or_default(),
        });
    }
}

/// Returns whether the elements that both sides have in common are in the same order. If any element is identified by
/// its index, both sides must also have the same length.
fn is_same_order(own: &[PathStep], other: &[PathStep]) -> bool {
    let common = |these: &[PathStep], those: &[PathStep]| -> Vec<PathStep> {
        these.iter().filter(|step| those.contains(step)).cloned().collect()
    };
    let by_place = |steps: &[PathStep]| steps.iter().any(|step| matches!(step, PathStep::At(_)));
    let is_same = common(own, other) == common(other, own);
    is_same && (!by_place(own) && !by_place(other) || own.len() == other.len())
}

/// Returns the comments on the lines directly above the given offset.
fn comments_above(text: &str, at: usize) -> Vec<String> {
    let before = text.get(..at).unwrap_or_default();
    let own_line = before.rfind('\n').map_or(0, |at| at + 1);
    let above = before.get(..own_line).unwrap_or_default();
    let mut lines: Vec<String> = above
        .lines()
        .rev()
        .map(str::trim)
        .take_while(|line| line.starts_with("//"))
        .map(|line| line.trim_start_matches('/').trim().to_owned())
        .collect();
    lines.reverse();
    lines
}
