//! Decoder in C99 that requires only the standard integer types.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::identifier;
use super::procedure::{Dialect, decoder_statements};
use crate::devices::ssi::protocol::layout::{Flags, Layout};

struct CDialect;

impl Dialect for CDialect {
    type Word = String;

    fn name(&self, name: &'static str) -> String {
        name.to_owned()
    }

    fn hex(&self, value: u64) -> String {
        format!("UINT64_C(0x{value:X})")
    }

    fn and_expression(&self, a: &String, b: &String) -> String {
        format!("({a} & {b})")
    }

    fn or_expression(&self, a: &String, b: &String) -> String {
        format!("({a} | {b})")
    }

    fn xor(&self, a: &String, b: &String) -> String {
        format!("({a} ^ {b})")
    }

    fn shift_right(&self, a: &String, bits: u8) -> String {
        if bits == 0 { a.to_owned() } else { format!("({a} >> {bits})") }
    }

    fn shift_left(&self, a: &String, bits: u8) -> String {
        if bits == 0 { a.to_owned() } else { format!("({a} << {bits})") }
    }

    fn equal_expression(&self, a: &String, b: &String) -> String {
        format!("({a} == {b})")
    }

    fn not_equal(&self, a: &String, b: &String) -> String {
        format!("({a} != {b})")
    }

    fn to_number(&self, word: &String) -> String {
        word.to_owned()
    }

    fn divided_by(&self, number: &str, by: u64) -> String {
        format!("({number}) / UINT64_C({by})")
    }

    fn remainder(&self, number: &str, by: u64) -> String {
        format!("({number}) % UINT64_C({by})")
    }

    fn assignment(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }

    fn assign_word(&self, name: &'static str, value: &String) -> Vec<String> {
        vec![self.assignment(name, value)]
    }

    fn if_statement(&self, condition: &str, statement: &str) -> String {
        let condition = condition.strip_prefix('(').and_then(|it| it.strip_suffix(')')).unwrap_or(condition);
        format!("if ({condition}) {statement}")
    }

    fn comment_line(&self, text: &str) -> String {
        format!("/* {} */", text.replace("*/", "* /"))
    }

    fn negated_condition(&self, condition: &str) -> String {
        format!("!{condition}")
    }

    fn both_conditions(&self, a: &str, b: &str) -> String {
        format!("({a} && {b})")
    }
}

/// Returns the source of a function `ssi_decode` for this layout, with the flags that the function can return.
pub fn generate_c99(layout: &Layout, title: &str) -> String {
    let mut text = String::new();
    // The title must not end the comment, begin another or contain a trigraph.
    let title = title.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?");
    let clocks = layout.clock_count();
    // Writing into a String cannot fail.
    let _ = write!(
        text,
        "/* SSI decoder: {title}\n * {clocks} clocks; the first bit received is bit {} of `frame`. C99. */\n\
         #include <stdbool.h>\n#include <stdint.h>\n\n",
        clocks - 1
    );
    for (name, flag, meaning) in possible_flags(layout) {
        let _ = writeln!(text, "#define SSI_{} UINT32_C(0x{:X}) /* {meaning} */", name.to_ascii_uppercase(), flag.0);
    }
    text.push_str(
        "\ntypedef struct {\n    uint64_t position; /* turns and steps as one number */\n    uint64_t turns;\n    \
         uint64_t steps;    /* within the turn */\n    uint32_t flags;    /* SSI_... */\n    bool valid;        \
         /* the position may be used */\n} ssi_reading;\n\nssi_reading ssi_decode(uint64_t frame)\n{\n    \
         uint64_t word, code, position, turns, steps, flags, fold, digit;\n    bool valid;\n",
    );
    for line in decoder_statements(layout, &CDialect) {
        let _ = writeln!(text, "    {line}");
    }
    text.push_str(
        "    (void)fold;\n    (void)digit;\n    return (ssi_reading){ position, turns, steps, (uint32_t)flags, valid };\n}\n",
    );
    text.replace("fold, digit;", "fold = 0, digit = 0;")
}

/// Returns the flags that a frame of the layout can have, each with its name and meaning.
pub(super) fn possible_flags(layout: &Layout) -> Vec<(String, Flags, String)> {
    let descriptor = layout.descriptor();
    let errors = descriptor.errors.iter().enumerate();
    let errors = errors.map(|(at, bit)| (identifier(&bit.name), Flags::error(at), format!("clock {}", bit.clock)));
    let patterns = descriptor.patterns.iter().enumerate();
    let patterns =
        patterns.map(|(at, pattern)| (identifier(&pattern.name), Flags::pattern_flag(at), pattern.name.clone()));
    let form = [
        ("no_code", Flags::CODE, "the bits are no word of the code"),
        ("padding", Flags::PADDING, "a 1 where a 0 belongs"),
        ("parity", Flags::PARITY, "wrong parity"),
        ("repeat", Flags::REPEAT, "the repetition differs"),
        ("ones", Flags::ALL_ONES, "every bit is 1"),
        ("zeros", Flags::ALL_ZEROS, "every bit is 0"),
    ];
    let form = form.into_iter().filter(|(_, flag, _)| match *flag {
        Flags::PARITY => descriptor.parity.is_some(),
        Flags::REPEAT => descriptor.repeat.is_some(),
        _ => true,
    });
    let mut known = BTreeSet::new();
    errors
        .chain(patterns)
        .chain(form.map(|(name, flag, meaning)| (name.to_owned(), flag, meaning.to_owned())))
        .map(|(mut name, flag, meaning)| {
            // Two bits may have the same name.
            while !known.insert(name.clone()) {
                name.push('_');
            }
            (name, flag, meaning)
        })
        .collect()
}
