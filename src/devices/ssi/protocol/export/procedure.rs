//! The decoder for one layout as a list of statements, which follow the steps of [`Layout::decode`]. The list is the
//! same for every target language.

use crate::devices::ssi::protocol::code::{Code, low_bits_mask};
use crate::devices::ssi::protocol::descriptor::GrayCoverage;
use crate::devices::ssi::protocol::layout::{Flags, Layout};
use crate::devices::ssi::protocol::range::{Fraction, Range};

/// Syntax of a target language. A word is an expression for the bits of a frame or some of them. A number is text that
/// is valid in every language.
pub(super) trait Dialect {
    type Word;
    /// Returns the word expression that refers to a variable.
    fn name(&self, name: &'static str) -> Self::Word;
    fn hex(&self, value: u64) -> Self::Word;
    fn and_expression(&self, a: &Self::Word, b: &Self::Word) -> Self::Word;
    fn or_expression(&self, a: &Self::Word, b: &Self::Word) -> Self::Word;
    fn xor(&self, a: &Self::Word, b: &Self::Word) -> Self::Word;
    fn shift_right(&self, a: &Self::Word, bits: u8) -> Self::Word;
    fn shift_left(&self, a: &Self::Word, bits: u8) -> Self::Word;
    fn equal_expression(&self, a: &Self::Word, b: &Self::Word) -> String;
    fn not_equal(&self, a: &Self::Word, b: &Self::Word) -> String;
    /// Converts a word expression to a number expression.
    fn to_number(&self, word: &Self::Word) -> String;
    fn divided_by(&self, number: &str, by: u64) -> String;
    fn remainder(&self, number: &str, by: u64) -> String;
    fn assignment(&self, name: &str, value: &str) -> String;
    /// Returns the statements that assign a word to a variable.
    fn assign_word(&self, name: &'static str, value: &Self::Word) -> Vec<String>;
    fn if_statement(&self, condition: &str, statement: &str) -> String;
    fn comment_line(&self, text: &str) -> String;
    fn negated_condition(&self, condition: &str) -> String;
    fn both_conditions(&self, a: &str, b: &str) -> String;
}

/// Returns the statements of a decoder for a frame in the variable `frame`.
///
/// The statements set the words `word`, `code` and `flags`, the numbers `position`, `turns` and `steps`, and the
/// condition `valid`. `fold` and `digit` are auxiliary words.
pub(super) fn decoder_statements<D: Dialect>(layout: &Layout, dialect: &D) -> Vec<String> {
    let mut writer = Writer { dialect, lines: Vec::new() };
    writer.add_frame_checks(layout);
    writer.add_word(layout);
    writer.code(layout);
    writer.add_position(layout);
    writer.lines
}

struct Writer<'a, D> {
    dialect: &'a D,
    lines: Vec<String>,
}

impl<D: Dialect> Writer<'_, D> {
    fn add_comment(&mut self, text: &str) {
        self.lines.push(self.dialect.comment_line(text));
    }

    fn add_assignment(&mut self, name: &str, number: &str) {
        self.lines.push(self.dialect.assignment(name, number));
    }

    fn set_word(&mut self, name: &'static str, value: &D::Word) {
        self.lines.extend(self.dialect.assign_word(name, value));
    }

    fn add_flag(&mut self, condition: &str, flags: Flags) {
        let raised = self.dialect.or_expression(&self.dialect.name("flags"), &self.dialect.hex(flags.0.into()));
        let raised = self.dialect.assign_word("flags", &raised).join(" ");
        self.lines.push(self.dialect.if_statement(condition, &raised));
    }

    fn any_bit_set(&self, word: &'static str, bits: u64) -> String {
        let d = self.dialect;
        d.not_equal(&d.and_expression(&d.name(word), &d.hex(bits)), &d.hex(0))
    }

    fn equals(&self, word: &'static str, value: u64) -> String {
        self.dialect.equal_expression(&self.dialect.name(word), &self.dialect.hex(value))
    }

    fn add_frame_checks(&mut self, layout: &Layout) {
        let d = self.dialect;
        let all = low_bits_mask(layout.clock_count());
        self.add_comment("the frame as it was sent");
        self.set_word("word", &d.and_expression(&d.name("frame"), &d.hex(all)));
        self.set_word("flags", &d.hex(0));
        self.add_flag(&self.equals("word", all), Flags::ALL_ONES);
        self.add_flag(&self.equals("word", 0), Flags::ALL_ZEROS);
        for (index, pattern) in layout.patterns.iter().enumerate() {
            self.add_flag(&self.equals("word", *pattern), Flags::pattern_flag(index));
        }
        if layout.descriptor().inverted {
            self.set_word("word", &d.xor(&d.name("word"), &d.hex(all)));
        }
        if let Some(repeat) = layout.descriptor().repeat {
            self.add_comment("its repetition");
            let behind = layout.clock_count() - repeat.word;
            let first = d.shift_left(&d.shift_right(&d.name("word"), behind), behind);
            self.set_word(
                "fold",
                &d.xor(&d.or_expression(&first, &d.shift_right(&first, repeat.word + repeat.gap)), &d.name("word")),
            );
            let again = low_bits_mask(repeat.word) << behind >> (repeat.word + repeat.gap);
            self.add_flag(&self.any_bit_set("fold", again), Flags::REPEAT);
            self.add_flag(&self.any_bit_set("fold", all & !again), Flags::PADDING);
            self.set_word("word", &d.shift_right(&d.name("word"), behind));
        }
    }

    fn add_word(&mut self, layout: &Layout) {
        let d = self.dialect;
        let descriptor = layout.descriptor();
        if let Some(parity) = descriptor.parity {
            self.add_comment("parity");
            let (bit, before) = layout.parity;
            self.set_word("fold", &d.and_expression(&d.name("word"), &d.hex(bit | before)));
            for bits in [32, 16, 8, 4, 2, 1] {
                self.set_word("fold", &d.xor(&d.name("fold"), &d.shift_right(&d.name("fold"), bits)));
            }
            let odd = u64::from(parity.even);
            self.add_flag(
                &d.equal_expression(&d.and_expression(&d.name("fold"), &d.hex(1)), &d.hex(odd)),
                Flags::PARITY,
            );
        }
        if descriptor.coded == GrayCoverage::AreaAndErrors {
            self.decode_inner_gray(layout);
        }
        for (index, (bit, own)) in layout.errors.iter().zip(&descriptor.errors).enumerate() {
            self.add_comment(&own.name);
            let level = if own.active_low { 0 } else { *bit };
            self.add_flag(
                &d.equal_expression(&d.and_expression(&d.name("word"), &d.hex(*bit)), &d.hex(level)),
                Flags::error(index),
            );
        }
        if descriptor.shift_right {
            self.add_comment("back by the clock by which it comes later");
            let top = low_bits_mask(1) << (descriptor.area - 1) << layout.behind_area;
            self.add_flag(&self.any_bit_set("word", top), Flags::PADDING);
            let area = low_bits_mask(descriptor.area) << layout.behind_area;
            let moved =
                d.and_expression(&d.shift_left(&d.and_expression(&d.name("word"), &d.hex(area)), 1), &d.hex(area));
            self.set_word(
                "word",
                &d.or_expression(&moved, &d.and_expression(&d.name("word"), &d.hex(low_bits_mask(layout.behind_area)))),
            );
        }
        if descriptor.coded == GrayCoverage::Area {
            self.decode_inner_gray(layout);
            if descriptor.shift_right {
                self.set_word("word", &d.and_expression(&d.name("word"), &d.hex(!(1 << layout.behind_area))));
            }
        }
        if layout.zeros != 0 {
            self.add_comment("what is always 0");
            self.add_flag(&self.any_bit_set("word", layout.zeros), Flags::PADDING);
        }
    }

    /// Adds statements that convert a Gray code occupying only a part of the word.
    fn decode_inner_gray(&mut self, layout: &Layout) {
        let d = self.dialect;
        let (bits, behind) = layout.gray;
        self.add_comment("Gray, zeros included");
        self.set_word("fold", &d.and_expression(&d.shift_right(&d.name("word"), behind), &d.hex(low_bits_mask(bits))));
        self.gray_to_binary("fold", bits);
        let rest = d.and_expression(&d.name("word"), &d.hex(!(low_bits_mask(bits) << behind)));
        self.set_word("word", &d.or_expression(&d.shift_left(&d.name("fold"), behind), &rest));
    }

    fn gray_to_binary(&mut self, name: &'static str, bits: u8) {
        let d = self.dialect;
        for shift in [1, 2, 4, 8, 16, 32].into_iter().filter(|shift| *shift < bits) {
            self.set_word(name, &d.xor(&d.name(name), &d.shift_right(&d.name(name), shift)));
        }
    }

    fn code(&mut self, layout: &Layout) {
        let d = self.dialect;
        let coding = layout.position_code();
        self.add_comment("the position's bits");
        let part = |part: &crate::devices::ssi::protocol::layout::BitSegment| {
            d.shift_left(
                &d.and_expression(&d.shift_right(&d.name("word"), part.in_word), &d.hex(part.mask)),
                part.in_code,
            )
        };
        let [high, low] = &layout.parts;
        let code = if high.mask == 0 { part(low) } else { d.or_expression(&part(high), &part(low)) };
        self.set_word("code", &code);
        if matches!(coding.code(), Code::Gray | Code::GrayExcess) {
            self.add_comment("Gray");
            self.gray_to_binary("code", coding.bits());
        }
        self.add_assignment("position", &d.to_number(&d.name("code")));
        match coding.code() {
            Code::Binary | Code::Gray => {}
            Code::GrayExcess => {
                let offset = coding.offset();
                self.add_flag(&format!("{} < {offset}", "position"), Flags::CODE);
                self.add_assignment("position", &format!("position - {offset}"));
            }
            Code::Bcd => {
                self.add_comment("BCD");
                self.add_assignment("position", "0");
                for digit in (0..coding.bits() / 4).rev() {
                    self.set_word("digit", &d.and_expression(&d.shift_right(&d.name("code"), 4 * digit), &d.hex(0xF)));
                    self.add_flag(&format!("{} > 9", d.to_number(&d.name("digit"))), Flags::CODE);
                    self.add_assignment("position", &format!("position * 10 + {}", d.to_number(&d.name("digit"))));
                }
            }
        }
        if coding.last_position() < low_bits_mask(coding.bits()) || coding.code() == Code::Bcd {
            self.add_flag(&format!("position > {}", coding.last_position()), Flags::CODE);
            let none = d.assignment("position", "0");
            self.lines.push(d.if_statement(&self.any_bit_set("flags", Flags::CODE.0.into()), &none));
        }
        if layout.loses_lowest_bit() {
            self.add_assignment("position", &format!("position - {}", d.remainder("position", 2)));
        }
    }

    fn add_position(&mut self, layout: &Layout) {
        let d = self.dialect;
        let per_turn = match layout.descriptor().range {
            Range::Bits { singleturn, .. } => Some(1_u64 << singleturn),
            Range::Steps { per_turn, .. } => Some(u64::from(per_turn)),
            Range::RoundAxis { steps, revolutions: Fraction { numerator, denominator } } => {
                self.add_comment(&format!("{steps} steps over {numerator}/{denominator} turns"));
                let turn = u64::from(steps) * u64::from(denominator);
                self.add_assignment("turns", &d.divided_by(&format!("position * {numerator}"), turn));
                let first = d.divided_by(&format!("turns * {turn} + {}", numerator - 1), numerator.into());
                self.add_assignment("steps", &format!("position - {first}"));
                None
            }
            Range::Length { step_nanometres, .. } => {
                self.add_comment(&format!("a length in steps of {step_nanometres} nm"));
                self.add_assignment("turns", "0");
                self.add_assignment("steps", "position");
                None
            }
        };
        if let Some(per_turn) = per_turn {
            self.add_comment("turns and steps within one");
            self.add_assignment("turns", &d.divided_by("position", per_turn));
            self.add_assignment("steps", &d.remainder("position", per_turn));
        }
        let form = Flags::CODE.union(Flags::PADDING).union(Flags::PARITY).union(Flags::REPEAT);
        let none = (0..layout.errors.len()).fold(form, |all, index| all.union(Flags::error(index)));
        let stuck = Flags::ALL_ONES.union(Flags::ALL_ZEROS);
        let invalid = self.any_bit_set("flags", layout.invalid_flags().0.into());
        let no_position =
            d.both_conditions(&self.any_bit_set("flags", stuck.0.into()), &self.any_bit_set("flags", none.0.into()));
        self.add_comment("an error, or a line that is stuck");
        self.add_assignment(
            "valid",
            &d.both_conditions(&d.negated_condition(&invalid), &d.negated_condition(&no_position)),
        );
    }
}
