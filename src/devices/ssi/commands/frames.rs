//! The commands `ssi decode` and `ssi encode`, which decode and encode frames.

use serde_json::{Map, Value as Json, json};

use super::args::{SsiDecodeArgs, SsiEncodeArgs};
use super::layout::select_layout;
use super::source::read_frame_argument;
use crate::cli::number::{out_of_range, parse_number};
use crate::cli::output::{Lines, Output};
use crate::cli::{Failure, Result, Success};
use crate::devices::ssi::protocol::{
    BitMeaning, Flags, FrameFinding, FrameReading, Layout, Location, Role, frame_bits,
};
use crate::devices::ssi::state::explain;

pub(super) fn decode(output: &Output, SsiDecodeArgs { layout: spec, frames }: &SsiDecodeArgs) -> Result {
    let layout = select_layout(output, spec)?.layout;
    // All arguments are checked before any frame is printed.
    let frames: Vec<Vec<u64>> =
        frames.iter().map(|text| read_frame_argument(output, &layout, text)).collect::<Result<_>>()?;
    for frame in frames.into_iter().flatten() {
        let told = DecodedFrame::new(&layout, frame);
        output.show(&told.json(), &told.text())?;
    }
    Ok(Success::Completed)
}

pub(super) struct DecodedFrame<'a> {
    pub(super) layout: &'a Layout,
    pub(super) frame: u64,
    pub(super) reading: FrameReading,
}

impl<'a> DecodedFrame<'a> {
    pub(super) fn new(layout: &'a Layout, frame: u64) -> Self {
        DecodedFrame { layout, frame, reading: layout.decode(frame) }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.layout.is_valid(self.reading)
    }

    /// Returns the position with its location on the shaft or scale, or `None` if the bits do not represent a position.
    pub(super) fn position_location(&self) -> Option<(u64, Location)> {
        let range = self.layout.descriptor().range;
        let is_none = self.reading.flags.contains(Flags::CODE);
        (!is_none).then(|| (self.reading.position, range.locate(self.reading.position)))
    }

    fn bits(&self) -> String {
        frame_bits(self.frame, self.layout.clock_count())
    }

    pub(super) fn finding_names(&self, meaning: BitMeaning) -> Vec<String> {
        let findings = self.layout.to_findings(self.reading);
        findings.iter().filter(|finding| finding.meaning() == meaning).map(name).collect()
    }

    fn json(&self) -> Json {
        let place = self.position_location();
        let mut json = Map::new();
        json.insert("raw_bits".to_owned(), json!(self.bits()));
        json.insert("position".to_owned(), json!(place.map(|(position, _)| position)));
        let (turns, steps, degrees) = match place {
            Some((_, Location::Shaft { turns, steps, degrees })) => (json!(turns), json!(steps), json!(degrees)),
            _ => (Json::Null, Json::Null, Json::Null),
        };
        json.extend([("turns".to_owned(), turns), ("steps".to_owned(), steps), ("degrees".to_owned(), degrees)]);
        if let Some((_, Location::Length { millimetres })) = place {
            json.insert("millimetres".to_owned(), json!(millimetres));
        }
        json.insert("valid".to_owned(), json!(self.is_valid()));
        json.insert("errors".to_owned(), json!(self.finding_names(BitMeaning::Invalid)));
        json.insert("warnings".to_owned(), json!(self.finding_names(BitMeaning::Warning)));
        Json::Object(json)
    }

    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.add_line("frame", fields(self.layout, self.frame));
        match self.position_location() {
            Some((position, Location::Shaft { turns, steps, degrees })) => {
                lines.add_line("position", position);
                lines.add_line("turns", turns).add_line("steps", steps).add_line("degrees", format!("{degrees:.4}"));
            }
            Some((position, Location::Length { millimetres })) => {
                lines.add_line("position", position).add_line("millimetres", format!("{millimetres:.4}"));
            }
            None => {
                lines.add_line("position", "none");
            }
        }
        let findings = self.layout.to_findings(self.reading);
        let told = findings.iter().map(|finding| format!("{}\n", explain::finding_text(finding).terminal_text()));
        lines.text() + &told.collect::<String>()
    }
}

/// Formats the bits in groups, one for each field, such as `MT 000100100011  ST 10101011110000  ERROR 0`.
fn fields(layout: &Layout, frame: u64) -> String {
    let mut words: Vec<(String, String)> = Vec::new();
    for cell in layout.to_cells(frame) {
        let name = match cell.role {
            Role::Zero => "0".to_owned(),
            Role::Multiturn(_) => "MT".to_owned(),
            Role::Singleturn(_) => "ST".to_owned(),
            Role::Position(_) => "P".to_owned(),
            Role::Repetition(_) => "again".to_owned(),
            Role::Error(_) | Role::Parity => layout.role_name(cell.role),
        };
        let bit = if cell.bit { '1' } else { '0' };
        match words.last_mut() {
            Some((last, bits)) if *last == name => bits.push(bit),
            _ => words.push((name, bit.to_string())),
        }
    }
    let words: Vec<String> = words.into_iter().map(|(name, bits)| format!("{name} {bits}")).collect();
    words.join("  ")
}

pub(super) fn name(finding: &FrameFinding) -> String {
    match finding {
        FrameFinding::Error { name, .. } | FrameFinding::Pattern { name, .. } => name.clone(),
        FrameFinding::StuckHigh { .. } => "line stuck high".to_owned(),
        FrameFinding::StuckLow { .. } => "line stuck low".to_owned(),
        FrameFinding::Code => "invalid code".to_owned(),
        FrameFinding::Padding => "format mismatch".to_owned(),
        FrameFinding::Parity => "parity".to_owned(),
        FrameFinding::Repeat => "repetition".to_owned(),
    }
}

pub(super) fn encode(output: &Output, arguments: &SsiEncodeArgs) -> Result {
    let layout = select_layout(output, &arguments.layout)?.layout;
    let position = position(&layout, arguments)?;
    let errors = &layout.descriptor().errors;
    let mut flags = Flags::NONE;
    for name in &arguments.errors {
        let Some(index) = errors.iter().position(|bit| bit.name.eq_ignore_ascii_case(name)) else {
            let known: Vec<&str> = errors.iter().map(|bit| bit.name.as_str()).collect();
            let known = if known.is_empty() { "this layout has none".to_owned() } else { known.join(", ") };
            return Err(Failure::Usage(format!("there is no error bit {name:?}: {known}")));
        };
        flags = flags.union(Flags::error(index));
    }
    let last = layout.position_code().last_position();
    let frame =
        layout.encode(position, flags).ok_or_else(|| out_of_range_failure("position", &position.to_string(), last))?;
    if layout.loses_lowest_bit() && position % 2 == 1 {
        output.print_message(
            "Shifting to the right pushes the lowest bit out: the frame is that of the position before.",
        );
    }
    let clocks = usize::from(layout.clock_count());
    let bits = format!("{frame:0clocks$b}");
    let hex = format!("{frame:0digits$X}", digits = clocks.div_ceil(4));
    let mut lines = Lines::default();
    lines.add_line("bits", &bits).add_line("hex", &hex).add_line("frame", fields(&layout, frame));
    output.show(&json!({ "bits": bits, "hex": hex }), &lines.text())?;
    Ok(Success::Completed)
}

/// Returns the position given by `--position`, or by `--turns` and `--steps`. If both are given, they must agree.
fn position(layout: &Layout, arguments: &SsiEncodeArgs) -> Result<u64> {
    let last = layout.position_code().last_position();
    let range = layout.descriptor().range;
    let SsiEncodeArgs { position, turns, steps, .. } = arguments;
    let named = position.as_deref().map(|text| parse_up_to("position", text, last)).transpose()?;
    let of_shaft = turns.is_some() || steps.is_some();
    match (named, range.locate(named.unwrap_or(last))) {
        (_, Location::Length { .. }) if of_shaft => {
            Err(Failure::Usage("a length has no turns and steps; give --position".to_owned()))
        }
        (Some(position), Location::Shaft { turns: own_turns, steps: own_steps, .. }) => {
            for (what, text, own) in [("turns", turns, own_turns), ("steps", steps, own_steps)] {
                let Some(text) = text else { continue };
                if parse_up_to(what, text, u64::MAX)? != own {
                    return Err(Failure::Usage(format!(
                        "--position {position} is turn {own_turns}, step {own_steps}, and not --{what} {text}: give one of them"
                    )));
                }
            }
            Ok(position)
        }
        (Some(position), Location::Length { .. }) => Ok(position),
        (None, Location::Length { .. }) => Err(Failure::Usage("give --position".to_owned())),
        (None, Location::Shaft { turns: most, .. }) => {
            let turns = turns.as_deref().map_or(Ok(0), |text| parse_up_to("turns", text, most))?;
            // The last step of this turn is the one before the next turn, or the last position of the range.
            let begins = range.position(turns, 0).unwrap_or(0);
            let next = range.position(turns + 1, 0).map_or(last, |next| next - 1);
            let steps = steps.as_deref();
            let text = steps.ok_or_else(|| Failure::Usage("give --position, or --steps".to_owned()))?;
            Ok(begins + parse_up_to("steps", text, next - begins)?)
        }
    }
}

fn parse_up_to(what: &str, text: &str, last: u64) -> Result<u64> {
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("--{what}: {text:?} is not a number")))?;
    u64::try_from(number).ok().filter(|number| *number <= last).ok_or_else(|| out_of_range_failure(what, text, last))
}

fn out_of_range_failure(what: &str, text: &str, last: u64) -> Failure {
    out_of_range(what, text, 0, i64::try_from(last).unwrap_or(i64::MAX))
}
