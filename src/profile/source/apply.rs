//! Applies changes to a text and leaves the rest of it unchanged.

use std::ops::Range;

use super::changes::{Change, PathStep, is_equivalent_value, path_steps};
use super::tree::{Kind, NodePart, SourceNode, read, trailing_comment};

/// Applies the changes in order. Returns `None` if a change does not fit the text.
pub(in crate::profile) fn apply_all(text: &str, changes: &[Change]) -> Option<String> {
    changes.iter().try_fold(text.to_owned(), |text, change| apply_change(&text, change))
}

/// Applies a change. Returns `None` if the change does not fit the text.
pub(in crate::profile) fn apply_change(text: &str, change: &Change) -> Option<String> {
    let root = read(text)?;
    let (last, way) = match change.path.split_last() {
        Some(split) => split,
        None => {
            let to = change.to.as_deref()?;
            return replace_range(text, &root.span, to);
        }
    };
    let within = way.iter().try_fold(&root, |node, step| find_part(text, node, step).map(|part| &part.value))?;
    match (find_part(text, within, last), &change.to) {
        (Some(part), Some(to)) => {
            let own = text.get(part.value.span.clone())?;
            // Elements that are identified only by their index are the same only if their contents are.
            if let (PathStep::At(_), Some(from)) = (last, &change.from)
                && !is_equivalent_value(own, from)
            {
                return None;
            }
            let text = replace_comment(text, part.end, &change.comments)?;
            replace_range(&text, &part.value.span, &indent_value(to, indent_at(&text, part.start()), line_end(&text)))
        }
        (Some(part), None) => remove_entry(text, part),
        (None, Some(to)) => insert_entry(text, within, change, last, to),
        (None, None) => Some(text.to_owned()),
    }
}

/// Returns the value at a path, and the path steps to its preceding siblings, nearest first.
pub(super) fn value_at(text: &str, path: &[PathStep]) -> Option<(String, Vec<PathStep>)> {
    let root = read(text)?;
    let (last, way) = path.split_last()?;
    let within = way.iter().try_fold(&root, |node, step| find_part(text, node, step).map(|part| &part.value))?;
    let part = find_part(text, within, last)?;
    let behind = path_steps(text, within).into_iter().take_while(|step| step != last);
    let mut behind: Vec<PathStep> = behind.collect();
    behind.reverse();
    Some((text.get(part.value.span.clone())?.to_owned(), behind))
}

fn find_part<'n>(text: &str, node: &'n SourceNode, step: &PathStep) -> Option<&'n NodePart> {
    if let PathStep::At(at) = step {
        // An element that has a name is not addressed by its index.
        return if matches!(node.kind, Kind::List(_)) { node.parts().get(*at) } else { None };
    }
    path_steps(text, node).iter().position(|own| own == step).and_then(|at| node.parts().get(at))
}

fn replace_range(text: &str, place: &Range<usize>, by: &str) -> Option<String> {
    Some([text.get(..place.start)?, by, text.get(place.end..)?].concat())
}

/// Replaces the comment that the program wrote after an entry. A comment by the user stays.
fn replace_comment(text: &str, at: usize, comments: &(Option<String>, Option<String>)) -> Option<String> {
    let found = trailing_comment(text, at);
    match (found, comments) {
        (Some((place, own)), (Some(from), to)) if own == from => match to {
            Some(to) => replace_range(text, &place, &format!("// {to}")),
            None => replace_range(text, &(at..place.end), ""),
        },
        _ => Some(text.to_owned()),
    }
}

/// Returns the text without an entry. The whole line is removed if nothing else is on it.
fn remove_entry(text: &str, part: &NodePart) -> Option<String> {
    let before = text.get(..part.start())?;
    let after = part.end;
    let line = before.rfind('\n').map_or(0, |at| at + 1);
    let behind = trailing_comment(text, after).map_or(after, |(place, _)| place.end);
    let rest = text.get(behind..)?;
    let ends = rest.trim_start_matches([' ', '\t', '\r']);
    if before.get(line..)?.trim().is_empty() && ends.starts_with('\n') {
        return replace_range(text, &(line..text.len() - ends.len() + 1), "");
    }
    let blanks = text.get(after..)?.len() - text.get(after..)?.trim_start_matches([' ', '\t']).len();
    if part.comma {
        return replace_range(text, &(part.start()..after + blanks), "");
    }
    // The last entry on a line is removed together with the preceding comma.
    let start = before.trim_end().len();
    let start = if before.get(..start)?.ends_with(',') { start - 1 } else { part.start() };
    replace_range(text, &(start..after), "")
}

/// Returns the text with a new entry inserted after its predecessor.
fn insert_entry(text: &str, within: &SourceNode, change: &Change, last: &PathStep, to: &str) -> Option<String> {
    if matches!(within.kind, Kind::Plain) || matches!(last, PathStep::At(_)) {
        return None;
    }
    let key = match last {
        PathStep::Entry(name) => format!("{name}: "),
        _ => String::new(),
    };
    let (end, parts) = (line_end(text), within.parts());
    let anchor = change.behind.iter().find_map(|step| find_part(text, within, step));
    let open = within.span.start + text.get(within.span.clone())?.find(['(', '[', '{'])? + 1;
    let first_line = text.get(open..parts.first().map_or(within.span.end, NodePart::start))?;
    let stands_in_lines = first_line.contains('\n') || parts.is_empty();
    let comma_before = anchor.is_some_and(|part| !part.comma);
    if !stands_in_lines {
        let more = format!("{key}{}", to_single_line(to)?);
        return match anchor {
            Some(part) if comma_before => replace_range(text, &(part.end..part.end), &format!(", {more}")),
            Some(part) => replace_range(text, &(part.end..part.end), &format!(" {more},")),
            None => replace_range(text, &(open..open), &format!("{more}, ")),
        };
    }
    let indent = match parts.first() {
        Some(first) => indent_at(text, first.start()).to_owned(),
        None => format!("{}    ", indent_at(text, within.span.start)),
    };
    let heading: String = change.heading.iter().map(|line| format!("{end}{indent}// {line}")).collect();
    let comment = change.comments.1.as_ref().map(|comment| format!(" // {comment}")).unwrap_or_default();
    let line = format!("{heading}{end}{indent}{key}{},{comment}", indent_value(to, &indent, end));
    let place = match anchor {
        Some(part) => trailing_comment(text, part.end).map_or(part.end, |(place, _)| place.end),
        None => open + text.get(open..)?.len() - skip_comment(text.get(open..)?).len(),
    };
    let follows = text.get(place..)?.lines().next().unwrap_or_default();
    let close = match follows.trim() {
        "" => String::new(),
        // Any text that follows on the same line would become part of the new comment.
        _ if parts.is_empty() => format!("{end}{}", indent_at(text, within.span.start)),
        _ => format!("{end}{indent}"),
    };
    let text = replace_range(text, &(place..place), &format!("{line}{close}"))?;
    match anchor.filter(|_| comma_before) {
        Some(part) => replace_range(&text, &(part.end..part.end), ","),
        None => Some(text),
    }
}

/// Skips a comment that directly follows an opening bracket.
fn skip_comment(text: &str) -> &str {
    match trailing_comment(text, 0) {
        Some((place, _)) => text.get(place.end..).unwrap_or_default(),
        None => text,
    }
}

/// Returns the indentation of the line at the given offset.
fn indent_at(text: &str, at: usize) -> &str {
    let line = text.get(..at).unwrap_or_default().rfind('\n').map_or(0, |at| at + 1);
    let line = text.get(line..).unwrap_or_default();
    line.get(..line.len() - line.trim_start_matches([' ', '\t']).len()).unwrap_or_default()
}

/// Adapts the indentation of a multi-line value to its new position.
fn indent_value(value: &str, indent: &str, end: &str) -> String {
    let mut lines = value.lines();
    let first = lines.next().unwrap_or_default().to_owned();
    let rest: Vec<&str> = lines.collect();
    // The last line contains the closing bracket, which has the same indentation as the first line.
    let own = rest.last().map_or(0, |line| line.len() - line.trim_start().len());
    rest.into_iter().fold(first, |all, line| format!("{all}{end}{indent}{}", line.get(own..).unwrap_or(line.trim())))
}

/// Joins a multi-line value into one line, or returns `None` if it contains a comment.
fn to_single_line(value: &str) -> Option<String> {
    if !value.contains('\n') {
        return Some(value.to_owned());
    }
    let plain = super::tree::comments_in(value).is_empty();
    plain.then(|| value.lines().map(str::trim).collect::<Vec<_>>().join(" "))
}

fn line_end(text: &str) -> &'static str {
    if text.contains("\r\n") { "\r\n" } else { "\n" }
}
