//! Decoder in IEC 61131-3 structured text.

use std::fmt::Write;

use super::c::possible_flags;
use super::procedure::{Dialect, decoder_statements};
use crate::devices::ssi::protocol::layout::Layout;

struct StructuredTextDialect;

impl Dialect for StructuredTextDialect {
    type Word = String;

    fn name(&self, name: &'static str) -> String {
        name.to_owned()
    }

    fn hex(&self, value: u64) -> String {
        format!("LWORD#16#{value:X}")
    }

    fn and_expression(&self, a: &String, b: &String) -> String {
        format!("({a} AND {b})")
    }

    fn or_expression(&self, a: &String, b: &String) -> String {
        format!("({a} OR {b})")
    }

    fn xor(&self, a: &String, b: &String) -> String {
        format!("({a} XOR {b})")
    }

    fn shift_right(&self, a: &String, bits: u8) -> String {
        if bits == 0 { a.to_owned() } else { format!("SHR({a}, {bits})") }
    }

    fn shift_left(&self, a: &String, bits: u8) -> String {
        if bits == 0 { a.to_owned() } else { format!("SHL({a}, {bits})") }
    }

    fn equal_expression(&self, a: &String, b: &String) -> String {
        format!("({a} = {b})")
    }

    fn not_equal(&self, a: &String, b: &String) -> String {
        format!("({a} <> {b})")
    }

    fn to_number(&self, word: &String) -> String {
        format!("LWORD_TO_ULINT({word})")
    }

    fn divided_by(&self, number: &str, by: u64) -> String {
        format!("({number}) / ULINT#{by}")
    }

    fn remainder(&self, number: &str, by: u64) -> String {
        format!("({number}) MOD ULINT#{by}")
    }

    fn assignment(&self, name: &str, value: &str) -> String {
        format!("{name} := {value};")
    }

    fn assign_word(&self, name: &'static str, value: &String) -> Vec<String> {
        vec![self.assignment(name, value)]
    }

    fn if_statement(&self, condition: &str, statement: &str) -> String {
        format!("IF {condition} THEN {statement} END_IF;")
    }

    fn comment_line(&self, text: &str) -> String {
        format!("(* {} *)", text.replace("*)", "* )"))
    }

    fn negated_condition(&self, condition: &str) -> String {
        format!("NOT {condition}")
    }

    fn both_conditions(&self, a: &str, b: &str) -> String {
        format!("({a} AND {b})")
    }
}

/// Returns the source of a structured text function block `SSI_DECODE` for the layout.
pub fn structured_text(layout: &Layout, title: &str) -> String {
    let mut text = String::new();
    let title = title.replace("*)", "* )");
    let clocks = layout.clock_count();
    // Writing into a String cannot fail.
    let _ = writeln!(
        text,
        "(* SSI decoder: {title}\n   {clocks} clocks; the first bit received is bit {} of frame. IEC 61131-3.",
        clocks - 1
    );
    for (name, flag, meaning) in possible_flags(layout) {
        let _ = writeln!(text, "   flags 16#{:X}: {name}, {meaning}", flag.0);
    }
    text.push_str(
        "*)\nFUNCTION_BLOCK SSI_DECODE\nVAR_INPUT\n    frame : LWORD;\nEND_VAR\nVAR_OUTPUT\n    position : ULINT; \
         (* turns and steps as one number *)\n    turns : ULINT;\n    steps : ULINT; (* within the turn *)\n    \
         flags : LWORD;\n    valid : BOOL; (* the position may be used *)\nEND_VAR\nVAR\n    word_ : LWORD;\n    \
         code : LWORD;\n    fold : LWORD;\n    digit : LWORD;\nEND_VAR\n",
    );
    for line in decoder_statements(layout, &StructuredTextDialect) {
        let _ = writeln!(text, "{}", escape_type_names(&line));
    }
    text.push_str("END_FUNCTION_BLOCK\n");
    text
}

/// Renames the variable `word` to `word_`, because `WORD` is a type name in structured text.
fn escape_type_names(line: &str) -> String {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut out = String::new();
    let mut name = String::new();
    let comment = line.starts_with("(*");
    for c in line.chars().chain(std::iter::once('\n')) {
        if is_name(c) {
            name.push(c);
            continue;
        }
        out.push_str(if name == "word" && !comment { "word_" } else { &name });
        name.clear();
        if c != '\n' {
            out.push(c);
        }
    }
    out
}
