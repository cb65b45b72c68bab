//! Decoder source for controllers without 64-bit words. A frame is one double word or two, and a position is a 32-bit
//! number.
//!
//! The decoder is available as IEC 61131-3 structured text and as an SCL source file for TIA Portal (S7-1200 and
//! S7-1500).

use std::fmt::Write;

use super::c::possible_flags;
use super::procedure::{Dialect, decoder_statements};
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::range::Range;

/// The reason why a layout has no 32-bit decoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WordWidthError {
    /// The code word of a position exceeds 32 bits.
    #[error("the position has {bits} bits, and a number of the controller 32")]
    Position {
        /// Width of the code word in bits.
        bits: u8,
    },
    /// Calculating the turns and steps of a round axis requires more than 32 bits.
    #[error("the turns of this round axis need numbers of more than 32 bits")]
    RoundAxis,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Language {
    /// The language is IEC 61131-3 structured text.
    StructuredText,
    /// The language is SCL for TIA Portal.
    Scl,
}

const HALF_BITS: u8 = 32;

struct SplitWordDialect {
    language: Language,
    /// Whether a frame needs two 32-bit words.
    is_wide: bool,
}

/// The two halves of a word. A half that is always 0 is `None`.
struct WordHalves {
    high: Option<String>,
    low: Option<String>,
}

/// Returns the source of a structured text function block `SSI_DECODE`, which uses DWORD instead of LWORD.
///
/// # Errors
/// Returns a [`WordWidthError`] if 32 bits are not sufficient.
pub fn structured_text_32(layout: &Layout, title: &str) -> Result<String, WordWidthError> {
    let halves = SplitWordDialect::for_layout(layout, Language::StructuredText)?;
    let mut text = String::new();
    // Writing into a String does not fail.
    let _ = writeln!(text, "(* SSI decoder: {}", to_single_line(title).replace("*)", "* )"));
    let _ = writeln!(text, "   {} IEC 61131-3, 32 bits.", halves.describe_first_bit(layout));
    for (name, flag, meaning) in possible_flags(layout) {
        let _ = writeln!(text, "   flags 16#{:X}: {name}, {}", flag.0, to_single_line(&meaning).replace("*)", "* )"));
    }
    text.push_str("*)\nFUNCTION_BLOCK SSI_DECODE\n");
    let lines = decoder_statements(layout, &halves);
    halves.write_variables(&mut text, &lines, ["    ", "DWORD", "UDINT", "BOOL", "VAR"]);
    for line in lines {
        let _ = writeln!(text, "{line}");
    }
    text.push_str("END_FUNCTION_BLOCK\n");
    Ok(text)
}

/// Returns an SCL source file with a function block `SSI_DECODE`. TIA Portal imports it under *External source files*.
///
/// # Errors
/// Returns a [`WordWidthError`] if 32 bits are not sufficient.
pub fn scl_source(layout: &Layout, title: &str) -> Result<String, WordWidthError> {
    let halves = SplitWordDialect::for_layout(layout, Language::Scl)?;
    let mut text = String::from("FUNCTION_BLOCK \"SSI_DECODE\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\n");
    let lines = decoder_statements(layout, &halves);
    halves.write_variables(&mut text, &lines, ["    ", "DWord", "UDInt", "Bool", "VAR_TEMP"]);
    text.push_str("BEGIN\n");
    let mut comment = |words: &str| {
        let _ = writeln!(text, "    {}", halves.comment_line(words));
    };
    comment(&format!("SSI decoder: {title}"));
    comment(&halves.describe_first_bit(layout));
    for (name, flag, meaning) in possible_flags(layout) {
        comment(&format!("flags 16#{:X}: {name}, {meaning}", flag.0));
    }
    for line in lines {
        let _ = writeln!(text, "    {}", if line.starts_with("//") { line } else { local_variable(&line) });
    }
    text.push_str("END_FUNCTION_BLOCK\n");
    Ok(text)
}

impl SplitWordDialect {
    fn for_layout(layout: &Layout, language: Language) -> Result<Self, WordWidthError> {
        let bits = layout.position_code().bits();
        if bits > HALF_BITS {
            return Err(WordWidthError::Position { bits });
        }
        if let Range::RoundAxis { steps, revolutions } = layout.descriptor().range {
            let (above, below) = (u64::from(revolutions.numerator), u64::from(revolutions.denominator));
            let steps = u64::from(steps);
            // The greatest intermediate values are position × above, and turns × steps × below + above.
            let greatest = (steps * above).checked_add(above).zip(steps.checked_mul(below));
            greatest
                .filter(|(one, other)| (*one).max(*other) <= u64::from(u32::MAX))
                .ok_or(WordWidthError::RoundAxis)?;
        }
        Ok(SplitWordDialect { language, is_wide: layout.clock_count() > HALF_BITS })
    }

    /// Returns a comment about the location of the first bit of a frame.
    fn describe_first_bit(&self, layout: &Layout) -> String {
        let clocks = layout.clock_count();
        let (bit, name) = if self.is_wide { (clocks - 1 - HALF_BITS, "frame_high") } else { (clocks - 1, "frame") };
        format!("{clocks} clocks; the first bit received is bit {bit} of {name}.")
    }

    /// Writes the variable declarations of the function block. An auxiliary variable is declared only if a statement
    /// uses it.
    fn write_variables(
        &self,
        text: &mut String,
        lines: &[String],
        [indent, word, number, truth, auxiliary]: [&str; 5],
    ) {
        let mut section = |kind: &str, rows: &[(String, &str)]| {
            let _ = writeln!(text, "{kind}");
            for (name, own) in rows {
                let _ = writeln!(text, "{indent}{name} : {own};");
            }
            text.push_str("END_VAR\n");
        };
        let halves = |name: &str| match self.is_wide {
            true => vec![(format!("{name}_high"), word), (format!("{name}_low"), word)],
            false => vec![(name.to_owned(), word)],
        };
        let own = |name: &str, kind| (name.to_owned(), kind);
        section("VAR_INPUT", &halves("frame"));
        let numbers = ["position", "turns", "steps"].map(|name| own(name, number));
        section("VAR_OUTPUT", &[&numbers[..], &[own("flags", word), own("valid", truth)]].concat());
        let words = if self.is_wide { halves("word") } else { vec![own("word_", word)] };
        let next = if self.is_wide { vec![own("next_low", word)] } else { Vec::new() };
        let single = ["code", "digit"].map(|name| own(name, word));
        let all = [words, halves("fold"), next, single.to_vec()].concat();
        let is_used = |name: &str| lines.iter().any(|line| uses_name(line, name));
        let used: Vec<(String, &str)> = all.into_iter().filter(|(name, _)| is_used(name)).collect();
        section(auxiliary, &used);
    }

    fn call_expression(&self, function: &str, value: &str, bits: u8) -> String {
        match self.language {
            Language::StructuredText => format!("{function}({value}, {bits})"),
            Language::Scl => format!("{function}(IN := {value}, N := {bits})"),
        }
    }

    fn shifted_right(&self, half: Option<&String>, bits: u8) -> Option<String> {
        match bits {
            0 => half.cloned(),
            HALF_BITS.. => None,
            _ => half.map(|half| self.call_expression("SHR", half, bits)),
        }
    }

    fn shifted_left(&self, half: Option<&String>, bits: u8) -> Option<String> {
        match bits {
            0 => half.cloned(),
            HALF_BITS.. => None,
            _ => half.map(|half| self.call_expression("SHL", half, bits)),
        }
    }

    fn half_names(&self, name: &str) -> (Option<String>, String) {
        match name {
            "frame" | "word" | "fold" if self.is_wide => (Some(format!("{name}_high")), format!("{name}_low")),
            // WORD is a type name in structured text.
            "word" => (None, "word_".to_owned()),
            _ => (None, name.to_owned()),
        }
    }
}

/// Joins two half-word expressions with an operator. An expression that is `None` is zero and is omitted.
fn join_terms(a: Option<String>, b: Option<String>, operator: &str) -> Option<String> {
    match (a, b) {
        (Some(a), Some(b)) => Some(format!("({a} {operator} {b})")),
        (one, other) => one.or(other),
    }
}

fn half_constant(value: u64) -> Option<String> {
    (value != 0).then(|| format!("DWORD#16#{value:X}"))
}

const ALL: &str = "DWORD#16#FFFFFFFF";
const NONE: &str = "DWORD#16#0";

fn or_expression(a: Option<&String>, b: Option<&String>) -> Option<String> {
    match (a?, b?) {
        (own, all) | (all, own) if all == ALL => Some(own.clone()),
        (a, b) => Some(format!("({a} AND {b})")),
    }
}

impl WordHalves {
    /// Returns an expression that compares two words half by half. A half that is zero in both words is omitted.
    fn compare_expression(&self, other: &WordHalves, operator: &str, between: &str, none: &str) -> String {
        let halves = [(&self.high, &other.high), (&self.low, &other.low)].into_iter();
        let halves = halves.filter(|(a, b)| a.is_some() || b.is_some());
        let text = |half: &Option<String>| half.clone().unwrap_or_else(|| NONE.to_owned());
        let parts: Vec<String> = halves.map(|(a, b)| format!("({} {operator} {})", text(a), text(b))).collect();
        match parts.as_slice() {
            [] => none.to_owned(),
            [one] => one.clone(),
            more => format!("({})", more.join(between)),
        }
    }
}

impl Dialect for SplitWordDialect {
    type Word = WordHalves;

    fn name(&self, name: &'static str) -> WordHalves {
        let (high, low) = self.half_names(name);
        WordHalves { high, low: Some(low) }
    }

    fn hex(&self, value: u64) -> WordHalves {
        WordHalves { high: half_constant(value >> HALF_BITS), low: half_constant(value & u64::from(u32::MAX)) }
    }

    fn and_expression(&self, a: &WordHalves, b: &WordHalves) -> WordHalves {
        WordHalves {
            high: or_expression(a.high.as_ref(), b.high.as_ref()),
            low: or_expression(a.low.as_ref(), b.low.as_ref()),
        }
    }

    fn or_expression(&self, a: &WordHalves, b: &WordHalves) -> WordHalves {
        WordHalves {
            high: join_terms(a.high.clone(), b.high.clone(), "OR"),
            low: join_terms(a.low.clone(), b.low.clone(), "OR"),
        }
    }

    fn xor(&self, a: &WordHalves, b: &WordHalves) -> WordHalves {
        WordHalves {
            high: join_terms(a.high.clone(), b.high.clone(), "XOR"),
            low: join_terms(a.low.clone(), b.low.clone(), "XOR"),
        }
    }

    fn shift_right(&self, a: &WordHalves, bits: u8) -> WordHalves {
        if bits >= HALF_BITS {
            return WordHalves { high: None, low: self.shifted_right(a.high.as_ref(), bits - HALF_BITS) };
        }
        let crossing = if bits == 0 { None } else { self.shifted_left(a.high.as_ref(), HALF_BITS - bits) };
        WordHalves {
            high: self.shifted_right(a.high.as_ref(), bits),
            low: join_terms(self.shifted_right(a.low.as_ref(), bits), crossing, "OR"),
        }
    }

    fn shift_left(&self, a: &WordHalves, bits: u8) -> WordHalves {
        if bits >= HALF_BITS {
            return WordHalves { high: self.shifted_left(a.low.as_ref(), bits - HALF_BITS), low: None };
        }
        let crossing = if bits == 0 { None } else { self.shifted_right(a.low.as_ref(), HALF_BITS - bits) };
        WordHalves {
            high: join_terms(self.shifted_left(a.high.as_ref(), bits), crossing, "OR"),
            low: self.shifted_left(a.low.as_ref(), bits),
        }
    }

    fn equal_expression(&self, a: &WordHalves, b: &WordHalves) -> String {
        a.compare_expression(b, "=", " AND ", "TRUE")
    }

    fn not_equal(&self, a: &WordHalves, b: &WordHalves) -> String {
        a.compare_expression(b, "<>", " OR ", "FALSE")
    }

    fn to_number(&self, word: &WordHalves) -> String {
        format!("DWORD_TO_UDINT({})", word.low.as_deref().unwrap_or(NONE))
    }

    fn divided_by(&self, number: &str, by: u64) -> String {
        format!("({number}) / UDINT#{by}")
    }

    fn remainder(&self, number: &str, by: u64) -> String {
        format!("({number}) MOD UDINT#{by}")
    }

    fn assignment(&self, name: &str, value: &str) -> String {
        format!("{name} := {value};")
    }

    /// Returns the statements that assign a word. A variable without an upper half has at most 32 bits, so the upper
    /// half of the value is always 0.
    fn assign_word(&self, name: &'static str, value: &WordHalves) -> Vec<String> {
        let text = |half: &Option<String>| half.clone().unwrap_or_else(|| NONE.to_owned());
        match self.half_names(name) {
            (None, own) => vec![self.assignment(&own, &text(&value.low))],
            (Some(high), low) => {
                let (upper, lower) = (text(&value.high), text(&value.low));
                // The new value of a half may depend on both old halves, so the order of the assignments matters.
                if !uses_name(&upper, &low) {
                    vec![self.assignment(&low, &lower), self.assignment(&high, &upper)]
                } else if !uses_name(&lower, &high) {
                    vec![self.assignment(&high, &upper), self.assignment(&low, &lower)]
                } else {
                    vec![
                        self.assignment("next_low", &lower),
                        self.assignment(&high, &upper),
                        self.assignment(&low, "next_low"),
                    ]
                }
            }
        }
    }

    fn if_statement(&self, condition: &str, statement: &str) -> String {
        format!("IF {condition} THEN {statement} END_IF;")
    }

    fn comment_line(&self, text: &str) -> String {
        match self.language {
            Language::StructuredText => format!("(* {} *)", to_single_line(text).replace("*)", "* )")),
            // Some versions of TIA Portal read a source file as ASCII.
            Language::Scl => format!("// {}", to_single_line(text).replace(|c: char| !c.is_ascii(), "_")),
        }
    }

    fn negated_condition(&self, condition: &str) -> String {
        format!("NOT {condition}")
    }

    fn both_conditions(&self, a: &str, b: &str) -> String {
        format!("({a} AND {b})")
    }
}

/// Returns whether a line contains the variable `name` as a complete identifier.
fn uses_name(line: &str, name: &str) -> bool {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    line.split(|c| !is_name(c)).any(|word| word == name)
}

fn to_single_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

/// Prefixes local variables with `#`, as SCL requires. In the generated code only variables start with a lowercase
/// letter.
fn local_variable(line: &str) -> String {
    let mut out = String::new();
    let mut word = String::new();
    for c in line.chars().chain(std::iter::once('\n')) {
        if c.is_ascii_alphanumeric() || c == '_' {
            word.push(c);
            continue;
        }
        if word.starts_with(|c: char| c.is_ascii_lowercase()) {
            out.push('#');
        }
        out.push_str(&word);
        word.clear();
        if c != '\n' {
            out.push(c);
        }
    }
    out
}
