//! A RON syntax tree with source locations, for text that the `ron` crate has already parsed. If this parser returns
//! `None`, the whole file is rewritten.

use std::ops::Range;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct SourceNode {
    /// Range of the value in the source text. For `Some(…)`, only its content is included.
    pub(super) span: Range<usize>,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// A number, a string, an identifier or a tuple.
    Plain,
    /// A list, `[…]`.
    List(Vec<NodePart>),
    /// A structure or map, `(name: …)` or `{key: …}`.
    Entries(Vec<NodePart>),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct NodePart {
    pub(super) key: Option<Range<usize>>,
    pub(super) value: SourceNode,
    /// End of the value, including any comma after it.
    pub(super) end: usize,
    pub(super) comma: bool,
}

impl NodePart {
    pub(super) fn start(&self) -> usize {
        self.key.as_ref().map_or(self.value.span.start, |key| key.start)
    }
}

impl SourceNode {
    pub(super) fn parts(&self) -> &[NodePart] {
        match &self.kind {
            Kind::Plain => &[],
            Kind::List(parts) | Kind::Entries(parts) => parts,
        }
    }
}

/// Parses a text, or returns `None` if it contains unsupported syntax.
pub(super) fn read(text: &str) -> Option<SourceNode> {
    let mut reader = TreeReader { text, at: 0 };
    reader.skip_blanks();
    while reader.take_sign("#!") {
        reader.at += reader.remaining().find(']')? + 1;
        reader.skip_blanks();
    }
    let node = reader.value()?;
    reader.skip_blanks();
    reader.remaining().is_empty().then_some(node)
}

pub(super) fn comments_in(text: &str) -> Vec<&str> {
    let mut reader = TreeReader { text, at: 0 };
    let mut found = Vec::new();
    while !reader.remaining().is_empty() {
        let before = reader.at;
        if let Some(comment) = reader.read_comment() {
            found.push(comment);
        } else if reader.skip_literal().is_none() {
            reader.at = before + reader.remaining().chars().next().map_or(1, char::len_utf8);
        }
    }
    found
}

/// Returns the comment that follows a position on the same line, with its range.
pub(super) fn trailing_comment(text: &str, at: usize) -> Option<(Range<usize>, &str)> {
    let rest = text.get(at..)?;
    let blanks = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let mut reader = TreeReader { text, at: at + blanks };
    if !reader.remaining().starts_with("//") {
        return None;
    }
    let comment = reader.read_comment()?;
    Some((at + blanks..reader.at, comment))
}

struct TreeReader<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> TreeReader<'t> {
    fn remaining(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn take_sign(&mut self, sign: &str) -> bool {
        let takes = self.remaining().starts_with(sign);
        if takes {
            self.at += sign.len();
        }
        takes
    }

    fn skip_blanks(&mut self) {
        loop {
            self.at += self.remaining().len() - self.remaining().trim_start().len();
            if self.read_comment().is_none() {
                return;
            }
        }
    }

    fn read_comment(&mut self) -> Option<&'t str> {
        let rest = self.remaining();
        if let Some(line) = rest.strip_prefix("//") {
            // A carriage return is part of the line ending.
            let line = line.lines().next().unwrap_or_default();
            self.at += 2 + line.len();
            return Some(line.trim());
        }
        rest.strip_prefix("/*")?;
        let (mut depth, mut at) = (1, 2);
        while depth > 0 {
            let inside = rest.get(at..).filter(|inside| !inside.is_empty())?;
            let (step, deeper) = match inside {
                _ if inside.starts_with("/*") => (2, 1),
                _ if inside.starts_with("*/") => (2, -1),
                _ => (inside.chars().next().map_or(1, char::len_utf8), 0),
            };
            at += step;
            depth += deeper;
        }
        self.at += at;
        rest.get(2..at.saturating_sub(2)).map(str::trim)
    }

    /// Skips a string or character literal, which may contain any character.
    fn skip_literal(&mut self) -> Option<()> {
        let rest = self.remaining();
        let plain = rest.strip_prefix('b').unwrap_or(rest);
        if let Some(raw) = plain.strip_prefix('r') {
            let hashes = raw.len() - raw.trim_start_matches('#').len();
            let inside = raw.get(hashes..)?.strip_prefix('"')?;
            let end = format!("\"{}", "#".repeat(hashes));
            let length = inside.find(&end)? + end.len();
            self.at += rest.len() - inside.len() + length;
            return Some(());
        }
        let quote = plain.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
        let mut escaped = false;
        for (at, sign) in plain.char_indices().skip(1) {
            if !escaped && sign == quote {
                self.at += rest.len() - plain.len() + at + 1;
                return Some(());
            }
            escaped = !escaped && sign == '\\';
        }
        None
    }

    fn read_word(&mut self) -> Option<&'t str> {
        let rest = self.remaining();
        let ends = |c: char| c.is_whitespace() || "()[]{},:\"'".contains(c) || c == '/';
        let length = rest.find(ends).unwrap_or(rest.len());
        self.at += length;
        rest.get(..length).filter(|word| !word.is_empty())
    }

    fn value(&mut self) -> Option<SourceNode> {
        let start = self.at;
        let kind = match self.remaining().chars().next()? {
            '[' => Kind::List(self.read_parts('[', ']')?.0),
            '{' => Kind::Entries(self.read_parts('{', '}')?.0),
            '(' => self.read_bracketed()?,
            _ if self.skip_literal().is_some() => Kind::Plain,
            _ => {
                let word = self.read_word()?;
                let before = self.at;
                self.skip_blanks();
                match self.remaining().starts_with('(') {
                    true if word == "Some" => return self.read_wrapped(),
                    true => self.read_bracketed()?,
                    false => {
                        self.at = before;
                        Kind::Plain
                    }
                }
            }
        };
        Some(SourceNode { span: start..self.at, kind })
    }

    /// Parses the content of parentheses as a structure, or as a single value if it is a tuple.
    fn read_bracketed(&mut self) -> Option<Kind> {
        let (parts, named) = self.read_parts('(', ')')?;
        Some(if named || parts.is_empty() { Kind::Entries(parts) } else { Kind::Plain })
    }

    fn read_wrapped(&mut self) -> Option<SourceNode> {
        self.take_sign("(");
        self.skip_blanks();
        let node = self.value()?;
        self.skip_blanks();
        if self.take_sign(",") {
            self.skip_blanks();
        }
        self.take_sign(")").then_some(node)
    }

    /// Parses the values between brackets and returns whether they have keys.
    fn read_parts(&mut self, open: char, close: char) -> Option<(Vec<NodePart>, bool)> {
        self.at += open.len_utf8();
        let (mut parts, mut named) = (Vec::new(), false);
        loop {
            self.skip_blanks();
            if self.remaining().starts_with(close) {
                self.at += close.len_utf8();
                return Some((parts, named));
            }
            let first = self.value()?;
            let behind = self.at;
            self.skip_blanks();
            let (key, value) = if self.take_sign(":") {
                named = true;
                self.skip_blanks();
                (Some(first.span), self.value()?)
            } else {
                self.at = behind;
                (None, first)
            };
            let mut end = self.at;
            self.skip_blanks();
            let comma = self.take_sign(",");
            if comma {
                end = self.at;
            } else if !self.remaining().starts_with(close) {
                return None;
            }
            parts.push(NodePart { key, value, end, comma });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slices(text: &str) -> Vec<(String, String)> {
        let node = read(text).unwrap();
        let slice = |range: &Range<usize>| text.get(range.clone()).unwrap().to_owned();
        let key = |part: &NodePart| part.key.as_ref().map(slice).unwrap_or_default();
        node.parts().iter().map(|part| (key(part), slice(&part.value.span))).collect()
    }

    #[test]
    fn locates_entries_between_comments() {
        let text = "#![enable(implicit_some)]\n// head\n( a: 1, // \"one\n /* b: /* 2 */ */ b : \"x, \\\" y\", c: r#\"(\"#,\r\n d: Some(( e: 'x' )), f: (1, 2), g: [1, 2,], h: {158: -5})\n// end";
        let own = [
            ("a", "1"),
            ("b", "\"x, \\\" y\""),
            ("c", "r#\"(\"#"),
            ("d", "( e: 'x' )"),
            ("f", "(1, 2)"),
            ("g", "[1, 2,]"),
            ("h", "{158: -5}"),
        ];
        assert_eq!(slices(text), own.map(|(key, value)| (key.to_owned(), value.to_owned())));
        assert_eq!(comments_in(text), ["head", "\"one", "b: /* 2 */", "end"]);
    }

    #[test]
    fn invalid_text_yields_no_tree() {
        for text in ["", "(a: 1", "(a: )", "(a 1)", "(a: 1) b", "(a: \"x)", "[1 2]"] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
