//! One-word notation of any frame for the command line, such as `frame,clocks=27,lead=1,mt=12,st=13,code=gray,ones=1`.
//! Names and patterns are not included, because they require a profile.

use super::code::Code;
use super::descriptor::{BitMeaning, ErrorBit, FrameDescriptor, GrayCoverage, Parity, Repeat};
use super::range::{Fraction, Range};
use super::spec::{Setting, SpecError};
use crate::expected::AllowedValues;

const KEY: &str = "frame";

const NAMES: &[&str] = &[
    "clocks",
    "mt",
    "st",
    "steps",
    "turns",
    "revolutions",
    "bits",
    "step",
    "code",
    "over",
    "area",
    "lead",
    "between",
    "shift",
    "inverted",
    "parity",
    "repeat",
    "ones",
    "err",
    "unknown",
];

const UNKNOWN: &str = "BIT";
/// Keys of the bit lists, each with the name of its bits and whether the bits are active at 0.
const BIT_LISTS: [(&str, &str, bool); 3] =
    [("ones", "HIGH", true), ("err", "ERROR", false), ("unknown", UNKNOWN, false)];

impl FrameDescriptor {
    /// Parses a frame given as one word, or returns `None` if the word begins with another keyword.
    ///
    /// By default, the code is binary, the number of clocks is the number of position bits, and all other values are 0.
    ///
    /// # Errors
    /// Returns a [`SpecError`] with the valid values if the word is invalid.
    pub fn parse(text: &str) -> Option<Result<Self, SpecError>> {
        let mut words = text.split(',').map(str::trim);
        words.next().is_some_and(|key| key.eq_ignore_ascii_case(KEY)).then(|| parse(words))
    }

    /// Returns the frame as one word. Patterns, and the names and meanings of error bits, are omitted.
    pub fn spec_text(&self) -> String {
        let own = Self::binary(0, 0);
        let mut words = vec![format!("clocks={}", self.clocks)];
        let mut word = |name: &str, value: Option<String>| words.extend(value.map(|value| format!("{name}={value}")));
        let unless = |is: bool, value: String| (!is).then_some(value);
        match self.range {
            Range::Bits { multiturn, singleturn } => {
                word("mt", unless(multiturn == 0, multiturn.to_string()));
                word("st", Some(singleturn.to_string()));
            }
            Range::Steps { per_turn, turns } => {
                word("steps", Some(per_turn.to_string()));
                word("turns", unless(turns == 1, turns.to_string()));
            }
            Range::RoundAxis { steps, revolutions } => {
                word("steps", Some(steps.to_string()));
                word("revolutions", Some(revolutions.to_string()));
            }
            Range::Length { bits, step_nanometres } => {
                word("bits", Some(bits.to_string()));
                word("step", Some(step_nanometres.to_string()));
            }
        }
        word("code", unless(self.code == own.code, self.code.to_string()));
        word("over", unless(self.coded == own.coded, self.coded.to_string()));
        word("area", unless(self.area == self.clocks, self.area.to_string()));
        word("lead", unless(self.lead == 0, self.lead.to_string()));
        word("between", unless(self.between == 0, self.between.to_string()));
        word("shift", unless(!self.shift_right, "1".to_owned()));
        word("inverted", unless(!self.inverted, "1".to_owned()));
        let parity = |parity: Parity| format!("{}@{}", if parity.even { "even" } else { "odd" }, parity.clock);
        word("parity", self.parity.map(parity));
        word("repeat", self.repeat.map(|repeat| format!("{}+{}", repeat.word, repeat.gap)));
        for (name, called, low) in BIT_LISTS {
            let is_unknown = called == UNKNOWN;
            let listed =
                |bit: &&ErrorBit| bit.active_low == low && (low || bit.name.starts_with(UNKNOWN) == is_unknown);
            let clocks: Vec<String> = self.errors.iter().filter(listed).map(|bit| bit.clock.to_string()).collect();
            word(name, unless(clocks.is_empty(), clocks.join("+")));
        }
        format!("{KEY},{}", words.join(","))
    }
}

fn parse<'a>(words: impl Iterator<Item = &'a str>) -> Result<FrameDescriptor, SpecError> {
    let mut frame =
        FrameDescriptor { code: Code::Binary, coded: GrayCoverage::Position, ..FrameDescriptor::binary(0, 0) };
    let (mut bits, mut steps, mut length) = ((None, None), (None, None, None), (None, None));
    let (mut clocks, mut area) = (None, None);
    for setting in Setting::parse_all(words, NAMES)? {
        let value = setting.value;
        let wrong = |expected| setting.wrong_value(expected);
        match setting.name {
            "clocks" => clocks = Some(setting.parse_u8()?),
            "mt" => bits.0 = Some(setting.parse_u8()?),
            "st" => bits.1 = Some(setting.parse_u8()?),
            "steps" => steps.0 = Some(setting.parse_u32()?),
            "turns" => steps.1 = Some(setting.parse_u32()?),
            "revolutions" => steps.2 = Some(value.parse::<Fraction>().map_err(wrong)?),
            "bits" => length.0 = Some(setting.parse_u8()?),
            "step" => length.1 = Some(setting.parse_u32()?),
            "code" => frame.code = value.parse().map_err(wrong)?,
            "over" => frame.coded = value.parse().map_err(wrong)?,
            "area" => area = Some(setting.parse_u8()?),
            "lead" => frame.lead = setting.parse_u8()?,
            "between" => frame.between = setting.parse_u8()?,
            "shift" => frame.shift_right = setting.parse_switch()?,
            "inverted" => frame.inverted = setting.parse_switch()?,
            "parity" => frame.parity = Some(parity(value).ok_or_else(|| wrong(AllowedValues::ParityBit))?),
            "repeat" => frame.repeat = Some(parse_repetition(value).ok_or_else(|| wrong(AllowedValues::Repetition))?),
            _ => {
                let (_, called, active_low) =
                    BIT_LISTS.iter().find(|(list, ..)| *list == setting.name).ok_or_else(|| setting.unknown_name())?;
                for clock in value.split('+') {
                    let clock = clock.parse().map_err(|_| wrong(AllowedValues::Clocks))?;
                    frame.errors.push(ErrorBit {
                        name: format!("{called}{clock}"),
                        clock,
                        meaning: BitMeaning::Warning,
                        active_low: *active_low,
                        cleared_by_transfer: false,
                    });
                }
            }
        }
    }
    frame.range = match (steps, length.0) {
        ((Some(steps), _, Some(revolutions)), _) => Range::RoundAxis { steps, revolutions },
        ((Some(per_turn), turns, None), _) => Range::Steps { per_turn, turns: turns.unwrap_or(1) },
        (_, Some(bits)) => Range::Length { bits, step_nanometres: length.1.unwrap_or(1000) },
        _ => Range::Bits { multiturn: bits.0.unwrap_or(0), singleturn: bits.1.unwrap_or(0) },
    };
    let own = frame.range.bits().unwrap_or(0).saturating_add(frame.lead).saturating_add(frame.between);
    frame.clocks = clocks.unwrap_or(own);
    frame.area = area.unwrap_or(frame.clocks);
    frame.errors.sort_by_key(|bit| bit.clock);
    Ok(frame)
}

fn parity(value: &str) -> Option<Parity> {
    let (even, clock) = value.split_once('@')?;
    let even = match even {
        "even" => true,
        "odd" => false,
        _ => return None,
    };
    Some(Parity { even, clock: clock.parse().ok()? })
}

fn parse_repetition(value: &str) -> Option<Repeat> {
    let (word, gap) = value.split_once('+')?;
    Some(Repeat { word: word.parse().ok()?, gap: gap.parse().ok()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::Layout;

    fn frame(text: &str) -> FrameDescriptor {
        FrameDescriptor::parse(text).unwrap().unwrap()
    }

    /// An AHM36 in Gray code has 12 and 14 position bits followed by an error bit (reference section 8).
    #[test]
    fn one_word_specifications_parse() {
        let layout = Layout::new(frame("frame,clocks=27,mt=12,st=14,code=gray,err=27,area=26")).unwrap();
        assert_eq!(layout.decode(0x0D9_3EEC).position, 0x123 << 14 | 0x2A5B);
        let inverted = Layout::new(frame("frame,clocks=27,mt=12,st=14,code=gray,err=27,inverted=1,area=26")).unwrap();
        assert_eq!(inverted.decode(!0x0D9_3EEC & 0x7FF_FFFF).position, 0x123 << 14 | 0x2A5B);
        // A frame with a start bit, 4 position bits and odd parity, which is repeated after a zero.
        let twice = Layout::new(frame("frame,clocks=13,lead=1,st=4,ones=1,parity=odd@6,repeat=6+1,area=5")).unwrap();
        let reading = twice.decode(0b1_1001_0011_0010);
        assert_eq!(reading.position, 0b1001, "1 1001 1, 0, and again");
        assert_eq!(reading.flags, crate::devices::ssi::protocol::Flags::NONE);
    }

    #[test]
    fn emitted_specifications_round_trip() {
        for text in [
            "frame,clocks=25,mt=12,st=13,code=gray",
            "frame,clocks=26,mt=12,st=12,code=gray,over=padded,area=25,lead=1,ones=26",
            "frame,clocks=30,mt=12,st=14,between=2,err=29,unknown=30",
            "frame,clocks=12,steps=360,code=gray-excess,lead=3,inverted=1",
            "frame,clocks=24,steps=100,turns=20,area=23,shift=1",
            "frame,clocks=24,steps=100,revolutions=25/2",
            "frame,clocks=26,bits=24,step=500,code=bcd,parity=even@26,ones=1+25",
            "frame,clocks=51,st=25,repeat=25+1",
        ] {
            assert_eq!(frame(text).spec_text(), text);
        }
        assert_eq!(frame("FRAME, st=13").spec_text(), "frame,clocks=13,st=13");
    }

    #[test]
    fn rejects_invalid_specifications() {
        assert_eq!(FrameDescriptor::parse("ahm36,code=gray"), None);
        let said = |text: &str| FrameDescriptor::parse(text).unwrap().unwrap_err().to_string();
        assert!(said("frame,clock=3").starts_with("there is no \"clock\"; names: clocks, mt, st"));
        assert!(said("frame,st").contains("NAME=VALUE"));
        assert!(said("frame,st=300").contains("0 to 255"));
        assert!(said("frame,parity=3").contains("even@CLOCK"));
        assert!(said("frame,repeat=3").contains("25+1"));
        assert!(said("frame,ones=1+x").contains("1+26"));
        assert!(said("frame,inverted=yes").contains("0 or 1"));
        assert_eq!(said("frame,st=3,st=4"), "st is specified twice");
    }
}
