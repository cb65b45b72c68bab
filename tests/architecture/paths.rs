//! Finds paths to modules anywhere in a source file: after `use`, in a type, or in an expression.

/// A path from the crate root, with the line on which it begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Used {
    pub(crate) line: usize,
    pub(crate) path: Vec<String>,
}

/// Returns every path outside comments that begins with `crate`, `super` or `self`, resolved from the given module.
pub(crate) fn paths(module: &[String], text: &str) -> Vec<Used> {
    let code: String = text.lines().map(|line| format!("{}\n", line.split("//").next().unwrap_or_default())).collect();
    let mut found = Vec::new();
    for (word, base) in [
        ("crate::", Vec::new()),
        ("self::", module.to_vec()),
        ("super::", module.split_last().map(|(_, parent)| parent.to_vec()).unwrap_or_default()),
    ] {
        for (at, _) in code.match_indices(word) {
            let before = code[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let line = 1 + code[..at].matches('\n').count();
            let mut rest = &code[at + word.len()..];
            let mut base_here = base.clone();
            while let Some(further) = rest.strip_prefix("super::") {
                base_here.pop();
                rest = further;
            }
            let mut ends = Vec::new();
            read(rest, &[], &mut ends);
            found.extend(ends.into_iter().map(|end| Used { line, path: [base_here.clone(), end].concat() }));
        }
    }
    found
}

/// Collects a path after `before`, with all of its branches, in `ends`. Returns the rest of the text.
fn read<'t>(text: &'t str, before: &[String], ends: &mut Vec<Vec<String>>) -> &'t str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = rest.trim_start_matches([',', ' ', '\n']);
            match rest.strip_prefix('}') {
                Some(behind) => return behind,
                None if rest.is_empty() => return rest,
                None => {}
            }
            let behind = read(rest, before, ends);
            let behind = behind
                .trim_start()
                .strip_prefix("as ")
                .map_or(behind, |name| name.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_'));
            // If something other than a path follows, the list ends, because it was in a macro.
            if behind.len() == rest.len() {
                return behind;
            }
            rest = behind;
        }
    }
    let length = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (name, rest) = text.split_at(length);
    let mut path = before.to_vec();
    if !name.is_empty() && name != "self" {
        path.push(name.to_owned());
    }
    match rest.strip_prefix("::") {
        Some(further) if !name.is_empty() => read(further, &path, ends),
        _ => {
            ends.push(path);
            rest
        }
    }
}

#[test]
fn finds_paths_in_nested_imports() {
    let module: Vec<String> = ["app", "biss", "words"].map(ToOwned::to_owned).to_vec();
    let text = "use crate::link::{Ctx, trace::{\n    self, Trace as T,\n}};\n// use crate::ui::Theme;\nuse super::super::ssi::Form;\n\
                fn a(x: super::Edit) -> self::inner::B { crate::app::explain::biss::words(x) }\n";
    let mut found: Vec<String> =
        paths(&module, text).iter().map(|u| format!("{} {}", u.line, u.path.join("::"))).collect();
    found.sort();
    let expected = [
        "1 link::Ctx",
        "1 link::trace",
        "1 link::trace::Trace",
        "5 app::ssi::Form",
        "6 app::biss::Edit",
        "6 app::biss::words::inner::B",
        "6 app::explain::biss::words",
    ];
    assert_eq!(found, expected);
}
